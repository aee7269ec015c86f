#define_import_path bevy_plumage::down_fragments

// Virtual fragments: a march gathered into slabs of equal opacity. Twin of crates/plumage_reference/src/undercoat/fragments.rs,
// where the comments are.

const MOST_FRAGMENTS: u32 = 8u;

// A transparent surface in a pixel: straight radiance, opacity, depth.
struct Fragment {
    color: vec3<f32>,
    alpha: f32,
    depth: f32,
}

// A march being gathered.
struct Slabs {
    // Per slab: premultiplied radiance, and the sum of depth times opacity.
    light: array<vec4<f32>, 8>,
    transmittance: array<f32, 8>,
    count: u32,
    whole: f32,
    opacity: f32,
}

// Begins a march of `count` slabs (1 to 8) through an expected optical depth.
fn slabs(count: u32, optical_depth: f32) -> Slabs {
    var out: Slabs;
    for (var i = 0u; i < MOST_FRAGMENTS; i++) {
        out.light[i] = vec4(0.0);
        out.transmittance[i] = 1.0;
    }
    out.count = clamp(count, 1u, MOST_FRAGMENTS);
    out.whole = max(1.0 - exp(-max(optical_depth, 0.0)), 1e-6);
    out.opacity = 0.0;
    return out;
}

// Adds a step, front to back.
fn slab_add(march: ptr<function, Slabs>, radiance: vec3<f32>, alpha: f32, depth: f32) {
    let count = (*march).count;
    var rest = 1.0 - clamp(alpha, 0.0, 1.0);
    for (var k = 0u; k < count; k++) {
        let before = 1.0 - (*march).opacity;
        let place = (*march).opacity * f32(count) / (*march).whole;
        let index = min(u32(place), count - 1u);
        let passed = (*march).whole * (f32(index + 1u) / f32(count));
        let end = select(1.0 - passed, 0.0, index + 1u == count);
        let part = max(rest, min(end / max(before, 1e-6), 1.0));
        let done = part <= rest;
        let share = (*march).transmittance[index] * (1.0 - part);
        (*march).light[index] += share * vec4(radiance, depth);
        (*march).transmittance[index] *= part;
        (*march).opacity = select(passed * 1.0000005, 1.0 - before * part, done);
        if done {
            return;
        }
        rest = rest / max(part, 1e-6);
    }
}

// The fragment of one slab; its opacity is 0 where nothing fell into it.
fn slab_fragment(march: ptr<function, Slabs>, slab: u32) -> Fragment {
    let index = min(slab, MOST_FRAGMENTS - 1u);
    let alpha = 1.0 - (*march).transmittance[index];
    if alpha <= 1e-6 {
        return Fragment(vec3(0.0), 0.0, 0.0);
    }
    let light = (*march).light[index] / alpha;
    return Fragment(light.xyz, alpha, light.w);
}
