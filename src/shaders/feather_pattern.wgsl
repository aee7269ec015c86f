// A fixed pattern that turns coverage into holes or MSAA samples without flicker: the same pixel and card, the same value.
#define_import_path bevy_plumage::feather_pattern

// Integer hash (PCG, O'Neill 2014).
fn hash(value: u32) -> u32 {
    let state = value * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

// In (0, 1): interleaved gradient noise (Jimenez 2014) shifted by the card, so that stacked cards are not holed alike.
fn pattern_threshold(pixel: vec2<f32>, card: u32) -> f32 {
    let gradient = fract(52.9829189 * fract(dot(floor(pixel), vec2(0.06711056, 0.00583715))));
    let shift = f32(hash(card) >> 8u) / 16777216.0;
    return clamp(fract(gradient + shift), 0.002, 0.998);
}
