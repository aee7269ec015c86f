// What the vertex stage hands to the fragment stage.
#define_import_path bevy_plumage::feather_io

struct FeatherVertex {
    @builtin(position) position: vec4<f32>,
    @location(0) world_position: vec4<f32>,
    @location(1) world_normal: vec3<f32>,
    @location(2) uv: vec2<f32>,
    // Direction of the rachis; w: sign of the bitangent.
    @location(3) world_tangent: vec4<f32>,
    // Feather bits, tint, seed, (class | card << 3).
    @location(4) @interpolate(flat) card: vec4<u32>,
    @location(5) @interpolate(flat) instance_index: u32,
}

struct FeatherPrepassVertex {
    @builtin(position) position: vec4<f32>,
    @location(0) uv: vec2<f32>,
    // Feather bits, card.
    @location(1) @interpolate(flat) card: vec2<u32>,
#ifdef UNCLIPPED_DEPTH_ORTHO_EMULATION
    @location(6) unclipped_depth: f32,
#endif
}
