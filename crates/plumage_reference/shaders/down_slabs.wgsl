#define_import_path bevy_plumage::down_slabs

// Opacity of the shells that draw a tile layer by layer. Twin of crates/plumage_reference/src/undercoat/slabs.rs, where the
// comments are.

const LEAST_COSINE: f32 = 0.02;

// Opacity of a slab between the optical depths of the columns above its two faces.
fn slab_alpha(low: f32, high: f32, cosine: f32) -> f32 {
    let path = 1.0 / clamp(abs(cosine), LEAST_COSINE, 1.0);
    return 1.0 - exp(-(max(low - high, 0.0) * path));
}

// Number of shells of a coat that is `thickness` pixels high seen from the side.
fn shell_count(thickness: f32, sine: f32, layers: u32) -> f32 {
    let most = f32(max(layers, 1u));
    let wanted = ceil(thickness * clamp(sine, 0.35, 1.0) / 1.5);
    return clamp(wanted, min(4.0, most), min(32.0, most));
}

// The paper's opacity of a shell.
fn published_alpha(extinction: f32, shells: f32) -> f32 {
    return 1.0 - exp(-(max(extinction, 0.0) / max(shells, 1.0)));
}
