//! Colors as the list names them.

use bevy::color::{Hsva, Srgba};

/// Weights of linear sRGB in luminance.
pub const LUMINANCE: [f32; 3] = [0.2126, 0.7152, 0.0722];

/// Hue in degrees, saturation and value.
pub fn hsv([r, g, b]: [f32; 3]) -> [f32; 3] {
    let color = Hsva::from(Srgba::rgb(r, g, b));
    [color.hue, color.saturation, color.value]
}

/// Yellow or orange in the dark.
pub fn is_olive(p: [f32; 3]) -> bool {
    let [h, s, v] = hsv(p);
    (25.0..75.0).contains(&h) && s > 0.3 && (0.15..0.5).contains(&v)
}

/// Between violet and crimson.
pub fn is_mauve(p: [f32; 3]) -> bool {
    let [h, s, v] = hsv(p);
    (270.0..345.0).contains(&h) && s > 0.25 && v > 0.15
}
