//! sRGB, linear light and Oklab.

use bevy::color::{LinearRgba, Oklaba, Srgba};

/// sRGB 0..1 to linear.
pub(super) fn linear(value: f32) -> f32 {
    Srgba::gamma_function(value.max(0.0))
}

/// Linear to sRGB, cut to 0..1.
pub(super) fn encoded(value: f32) -> f32 {
    Srgba::gamma_function_inverse(value.clamp(0.0, 1.0))
}

/// Oklab of linear RGB: lightness, a, b.
pub(super) fn oklab([red, green, blue]: [f32; 3]) -> [f32; 3] {
    let lab = Oklaba::from(LinearRgba::rgb(red, green, blue));
    [lab.lightness, lab.a, lab.b]
}

/// Linear color of a baked texel, its tint share filled with `tint` (sRGB).
pub(super) fn tinted(texel: &[u8], tint: [f32; 3]) -> [f32; 3] {
    let share = f32::from(texel[3]) / 255.0;
    std::array::from_fn(|i| {
        let own = f32::from(texel[i]) / 255.0;
        linear(own + (tint[i] - own) * share)
    })
}
