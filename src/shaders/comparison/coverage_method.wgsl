#define_import_path bevy_plumage::coverage_method

// How a vane's coverage of a footprint is found: as `maths/coverage_method.wgsl` does, in whose place this is, or by the method that
// a shader definition names.

#import bevy_plumage::masking::{Vane, Cell}
#import bevy_plumage::footprint::{Footprint}
#import bevy_plumage::query::{LOD_MEAN, reduce, vane_coverage}
#import bevy_plumage::query_published::{PUBLISHED_POINTS, PUBLISHED_SWITCH, PublishedMethod, published_vane_coverage}
#import bevy_plumage::query_split::{averages}

// Point queries per footprint.
const SUPERSAMPLES: u32 = 1024u;

// Whether a footprint that a line cuts has to be resolved into parts.
fn resolves_parts(cell: Cell, vane: Vane, footprint: Footprint, lod: u32, threshold: f32) -> bool {
#ifdef PUBLISHED_COVERAGE
    return false;
#else
    return lod != LOD_MEAN && !averages(reduce(cell, vane, footprint), threshold);
#endif
}

// (barb, distal, proximal) coverage of a footprint over the left vane, or of a part of one.
fn part_coverage(cell: Cell, vane: Vane, footprint: Footprint, lod: u32, threshold: f32) -> vec3<f32> {
#ifdef PUBLISHED_COVERAGE
    // Whatever the LOD pass says of the card: sixteen nodes near, orders 1 and 2 far.
    return published_vane_coverage(cell, vane, footprint, PublishedMethod(PUBLISHED_SWITCH, 1u, 16u, 1, 2));
#else ifdef SUPERSAMPLED_COVERAGE
    return published_vane_coverage(cell, vane, footprint, PublishedMethod(PUBLISHED_POINTS, SUPERSAMPLES, 16u, 1, 2));
#else
    return vane_coverage(cell, vane, footprint, lod, threshold);
#endif
}
