// Where on a barb or on the shaft a pixel looks: the footprint across the fibre, for the near field.
#define_import_path bevy_plumage::feather_near
#import bevy_plumage::{
    feather_bindings::{feather_at, rachis_at, settings},
    feather_data as data,
    footprint::{Footprint, mirrored},
    masking::{mask_rachis, mask_vane, storeys, vane_shape},
    math::wrap,
    query::reduce,
    scattering_near::near_deviation,
}

// Mean and deviation of the footprint across the shaft and across the nearest barb, in half widths of the strip that shows;
// deviation -1: the far field serves.
struct NearFootprint {
    rachis: vec2<f32>,
    barb: vec2<f32>,
}

fn near_place(mean: f32, deviation: f32) -> vec2<f32> {
    return vec2(mean, near_deviation(deviation, settings.threshold));
}

// `local_eye`: to the eye in the card's frame; `v`: height along the shaft.
fn near_footprint(base: u32, v: f32, footprint: Footprint, local_eye: vec3<f32>, right: bool) -> NearFootprint {
    var near: NearFootprint;
    let edges = mask_rachis(rachis_at(base, v).z, local_eye);
    let half = max(0.5 * abs(edges.y - edges.x), 1e-6);
    near.rachis = near_place((footprint.mean.x - 0.5 * (edges.x + edges.y)) / half, sqrt(max(footprint.covariance.x, 0.0)) / half);

    let slot = base + select(data::LEFT_VANE, data::RIGHT_VANE, right);
    let vane = data::vane_unpack(feather_at(slot), feather_at(slot + 1u), feather_at(slot + 2u));
    let eye = local_eye * vec3(select(1.0, -1.0, right), 1.0, 1.0);
    let cell = mask_vane(vane, eye);
    var leftward = footprint;
    if (right) { leftward = mirrored(footprint); }
    let local = reduce(cell, vane, leftward);
    // The barb's silhouette, in periods, about its axis.
    let silhouette = max(storeys(vane_shape(vane), eye).silhouette / vane.p_b, 1e-4);
    // Seen from behind, phases run the other way.
    near.barb = near_place(cell.side * wrap(local.u) / silhouette, sqrt(local.variance) / silhouette);
    return near;
}
