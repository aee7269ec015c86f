//! sRGB, linear light and Oklab.

/// sRGB 0..1 to linear (IEC 61966-2-1).
pub(super) fn linear(value: f32) -> f32 {
    if value <= 0.04045 {
        value.max(0.0) / 12.92
    } else {
        ((value + 0.055) / 1.055).powf(2.4)
    }
}

/// Linear to sRGB, cut to 0..1.
pub(super) fn encoded(value: f32) -> f32 {
    let value = value.clamp(0.0, 1.0);
    if value <= 0.003_130_8 {
        value * 12.92
    } else {
        1.055 * value.powf(1.0 / 2.4) - 0.055
    }
}

/// Oklab of linear RGB (Ottosson 2020, "A perceptual color space for image processing").
pub(super) fn oklab([r, g, b]: [f32; 3]) -> [f32; 3] {
    let l = (0.412_221_46 * r + 0.536_332_55 * g + 0.051_445_995 * b).cbrt();
    let m = (0.211_903_5 * r + 0.680_699_5 * g + 0.107_396_96 * b).cbrt();
    let s = (0.088_302_46 * r + 0.281_718_85 * g + 0.629_978_7 * b).cbrt();
    [
        0.210_454_26 * l + 0.793_617_8 * m - 0.004_072_047 * s,
        1.977_998_5 * l - 2.428_592_2 * m + 0.450_593_7 * s,
        0.025_904_037 * l + 0.782_771_77 * m - 0.808_675_77 * s,
    ]
}

/// Linear colour of a baked texel, its tint share filled with `tint` (sRGB).
pub(super) fn tinted(texel: &[u8], tint: [f32; 3]) -> [f32; 3] {
    let share = f32::from(texel[3]) / 255.0;
    std::array::from_fn(|i| {
        let own = f32::from(texel[i]) / 255.0;
        linear(own + (tint[i] - own) * share)
    })
}
