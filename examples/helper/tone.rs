//! Tone curves on the processor, for pictures that are averaged before they are developed. The renderer applies the same ones.

use bevy::{core_pipeline::tonemapping::Tonemapping, prelude::*};

/// Weights of linear sRGB in luminance.
const LUMINANCE: Vec3 = Vec3::new(0.2126, 0.7152, 0.0722);

/// What the film shows, linear RGB 0..1, of an exposed `color` in linear RGB; `saturation` is a factor after the curve. Curves other
/// than the two of the scenes only cut off.
pub fn develop(color: Vec3, tone: Tonemapping, saturation: f32) -> Vec3 {
    let color = color.max(Vec3::ZERO);
    let shown = match tone {
        Tonemapping::KhronosPbrNeutral => neutral(color),
        Tonemapping::AcesFitted => aces(color),
        _ => color,
    };
    let shown = shown.clamp(Vec3::ZERO, Vec3::ONE);
    let luma = Vec3::splat(shown.dot(LUMINANCE));
    (luma + (shown - luma) * saturation).clamp(Vec3::ZERO, Vec3::ONE)
}

/// The neutral curve of Khronos (PBR Neutral Tone Mapper, 2024): colors stay up to 0.76, then pale slowly.
fn neutral(color: Vec3) -> Vec3 {
    let (start, paling) = (0.8 - 0.04, 0.15);
    let low = color.min_element();
    let toe = if low < 0.08 {
        low - 6.25 * low * low
    } else {
        0.04
    };
    let color = color - toe;
    let peak = color.max_element();
    if peak < start {
        return color;
    }
    let rest = 1.0 - start;
    let squeezed = 1.0 - rest * rest / (peak + rest - start);
    let share = 1.0 - 1.0 / (paling * (peak - squeezed) + 1.0);
    (color * (squeezed / peak)).lerp(Vec3::splat(squeezed), share)
}

/// Hill's fit of the ACES output transform.
fn aces(color: Vec3) -> Vec3 {
    let rows = |m: [[f32; 3]; 3], v: Vec3| Vec3::from_array(m.map(|row| v.dot(Vec3::from(row))));
    let v = rows(
        [
            [0.59719, 0.35458, 0.04823],
            [0.07600, 0.90834, 0.01566],
            [0.02840, 0.13383, 0.83777],
        ],
        color,
    );
    let a = v * (v + 0.024_578_6) - 0.000_090_537;
    let b = v * (0.983_729 * v + 0.432_951) + 0.238_081;
    rows(
        [
            [1.60475, -0.53108, -0.07367],
            [-0.10208, 1.10813, -0.00605],
            [-0.00327, -0.07276, 1.07602],
        ],
        a / b,
    )
}
