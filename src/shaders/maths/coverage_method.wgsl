#define_import_path bevy_plumage::coverage_method

// How a vane's coverage of a footprint is found: by the cheapest evaluator within the budget. The feature `comparison` has other
// methods in this module's place.

#import bevy_plumage::masking::{Vane, Cell}
#import bevy_plumage::footprint::{Footprint}
#import bevy_plumage::query::{LOD_MEAN, reduce, vane_coverage}
#import bevy_plumage::query_split::{averages}

// Whether a footprint that a line cuts has to be resolved into parts.
fn resolves_parts(cell: Cell, vane: Vane, footprint: Footprint, lod: u32, threshold: f32) -> bool {
    return lod != LOD_MEAN && !averages(reduce(cell, vane, footprint), threshold);
}

// (barb, distal, proximal) coverage of a footprint over the left vane, or of a part of one.
fn part_coverage(cell: Cell, vane: Vane, footprint: Footprint, lod: u32, threshold: f32) -> vec3<f32> {
    return vane_coverage(cell, vane, footprint, lod, threshold);
}
