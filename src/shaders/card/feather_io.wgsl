// What the vertex stage takes, and what it hands to the fragment stage of the color, depth and shadow passes.
#define_import_path bevy_plumage::feather_io
#import bevy_plumage::feather_data as data

// The same locations in every pass, see FeatherMaterial::specialize.
struct CardVertex {
    @builtin(instance_index) instance_index: u32,
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) uv: vec2<f32>,
    // x: card, less at its left edge and more at its right one (EDGE_MARK).
    @location(3) uv_b: vec2<f32>,
    @location(4) tangent: vec4<f32>,
#ifdef SKINNED
    @location(5) joint_indices: vec4<u32>,
    @location(6) joint_weights: vec4<f32>,
#endif
#ifdef WORN_POSES
    // What the vertex keeps of the poses, see `raised_heights` and `raised_window`.
    @location(7) raised: vec4<u32>,
#endif
}

struct FeatherVertex {
    // Depth prepass and color pass must agree to the last bit.
    @invariant @builtin(position) position: vec4<f32>,
    @location(0) world_position: vec4<f32>,
    // w: share of the way from the card's left edge to its right one.
    @location(1) world_normal: vec4<f32>,
    @location(2) uv: vec2<f32>,
    // Direction of the rachis; w: sign of the bitangent.
    @location(3) world_tangent: vec4<f32>,
    // Feather bits, tint, seed, class and number of the card (data::card_bits).
    @location(4) @interpolate(flat) card: vec4<u32>,
    @location(5) @interpolate(flat) instance_index: u32,
#ifdef VISIBILITY_RANGE_DITHER
    @location(6) @interpolate(flat) visibility_range_dither: i32,
#endif
#ifdef LIT_VERTICES
    // What both vanes make of light, see VaneResponse; w of the first: of the mirrored sky; w of the second: direction to the first light;
    // w of the others: what a black shaft makes of the lights (left) and of the sky in front and behind (right).
    @location(7) left_first: vec4<f32>,
    @location(8) left_second: vec4<f32>,
    @location(9) left_front: vec4<f32>,
    @location(10) left_back: vec4<f32>,
    @location(11) right_first: vec4<f32>,
    @location(12) right_second: vec4<f32>,
    @location(13) right_front: vec4<f32>,
    @location(14) right_back: vec4<f32>,
    // What the paint of the shaft adds.
    @location(15) shaft: vec4<f32>,
#endif
#ifdef PREPASS_PIPELINE
#ifdef MOTION_VECTOR_PREPASS
    @location(7) previous_world_position: vec4<f32>,
#endif
#ifdef UNCLIPPED_DEPTH_ORTHO_EMULATION
    @location(8) unclipped_depth: f32,
#endif
#endif
}

// Class of the fragment's card: a constant where the pipeline draws one class only.
fn class_of(in: FeatherVertex) -> u32 {
#ifdef ONLY_MEAN
    return data::CARD_MEAN;
#else ifdef ONLY_FAR
    return data::CARD_FAR;
#else
    return data::lod_class(in.card.w);
#endif
}
