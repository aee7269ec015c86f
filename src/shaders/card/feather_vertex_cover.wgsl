// What both vanes of a LIT card stop, found at its vertices and interpolated: it depends on the eye and the vane's frame, which turn little
// from vertex to vertex, and on how far the barbules hook, which a fragment asks.
#define_import_path bevy_plumage::feather_vertex_cover
#import bevy_plumage::{
    anatomy::LOOSE_BARBULES,
    feather_bindings::{feather_at, feather_base, rachis_at, shape_at},
    feather_cover::frame_of,
    feather_data as data,
    feather_io::FeatherVertex,
    masking::VaneShape,
    query_feather::mean_opacity,
}

// Share of the card's width by which the shaft may lie beside its middle, so that a vane ends where the vertices of the middle are.
const STRAIGHT: f32 = 0.06;
// Share of the width, from the middle, within which both vanes meet.
const EDGE: f32 = 0.25;

// Which vanes a vertex speaks for: both, or the right (or the left) one.
struct Met {
    both: bool,
    right: bool,
}

// Both vanes end at the shaft, one at an edge: there the other one, of which next to nothing shows unless the shaft is bent, counts as
// the same.
fn vanes_at(base: u32, uv: vec2<f32>) -> Met {
    let bent = abs(rachis_at(base, uv.y).x - 0.5) > STRAIGHT;
    return Met(bent || abs(uv.x - 0.5) < EDGE, uv.x > 0.5);
}

// The vertex with what the vanes stop there.
fn cover_vertex(placed: FeatherVertex) -> FeatherVertex {
    var out = placed;
#ifdef ONLY_LIT
    if (data::lod_class(placed.card.w) != data::CARD_LIT) {
        return out;
    }
    let base = feather_base(data::card_feather(placed.card.x));
    let eye = frame_of(placed).local_eye;
    let met = vanes_at(base, placed.uv.xy);
    var closed = 0.0;
    for (var i = 0u; i < 2u; i++) {
        if (met.both || i == 0u) {
            let right = select(met.right, i == 1u, met.both);
            let shape = shape_at(base + select(data::LEFT_VANE, data::RIGHT_VANE, right));
            let view = eye * vec3(select(1.0, -1.0, right), 1.0, 1.0);
            closed = mean_opacity(shape, 1.0, view);
            // Hardly another number for the other vane.
            out.world_normal.w = mean_opacity(shape, LOOSE_BARBULES, view) / max(closed, 1e-3);
        }
        if (i == 0u) {
            out.uv.z = closed;
        } else {
            out.uv.w = closed;
        }
    }
#endif
    return out;
}
