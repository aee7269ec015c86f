#define_import_path bevy_plumage::down_tier

// Shares of the undercoat's tiers and the node of the far table. Twin of src/maths/undercoat/tier.rs, where the comments are.

const FAR_SIZE: u32 = 8u;

struct TierMix {
    near: f32,
    middle: f32,
    far: f32,
    steps: f32,
    mip: f32,
    rim: f32,
}

fn tier_ramp(thickness: f32, limit: f32) -> f32 {
    let x = clamp((thickness - limit) / (max(limit, 1e-3) * 0.35) + 0.5, 0.0, 1.0);
    return x * x * (3.0 - x - x);
}

fn tier_mix(thickness: f32, px: vec2<f32>) -> TierMix {
    let near = tier_ramp(thickness, px.x);
    let above = tier_ramp(thickness, min(px.y, px.x * 0.7));
    return TierMix(
        near,
        above - near,
        1.0 - above,
        14.0 + 2.0 * near,
        1.0 - near,
        clamp(thickness / max(px.y, 1e-3), 0.0, 1.0),
    );
}

// Coordinate of a cosine in the far table, 0..=FAR_SIZE - 1.
fn far_node(cosine: f32) -> f32 {
    return sqrt(clamp((cosine - 0.08) / 0.92, 0.0, 1.0)) * f32(FAR_SIZE - 1u);
}
