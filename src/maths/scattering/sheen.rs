//! Sheen of dense barbules: the linearly transformed cosine of Zeltner et al. 2022, volume variant.

use crate::maths::functions::{Real, clamp, real};
use crate::maths::vector::dot;
use std::sync::OnceLock;

/// Entries along each axis of the sheen table.
pub const SHEEN_TABLE_SIZE: usize = 32;

/// The table, `[cos theta_o][alpha]`, both axes k/31: (aInv, bInv, R, 0), ready for a 32 x 32 RGBA texture whose x is alpha.
pub fn sheen_table() -> &'static [[f32; 4]] {
    static TABLE: OnceLock<Vec<[f32; 4]>> = OnceLock::new();
    TABLE.get_or_init(|| {
        include_bytes!("tables/sheen_volume.bin")
            .chunks_exact(12)
            .map(|b| {
                let value = |i: usize| f32::from_le_bytes([b[i], b[i + 1], b[i + 2], b[i + 3]]);
                [value(0), value(4), value(8), 0.0]
            })
            .collect()
    })
}

/// (aInv, bInv, R) at cos theta_o in 0..1 and roughness `alpha` (clamped to 0.1..1), bilinear.
pub fn sheen_lookup<T: Real>(cos_o: T, alpha: T) -> [T; 3] {
    let size = SHEEN_TABLE_SIZE;
    let place = |x: T| {
        let x = x * real((size - 1) as f64);
        let i = x.floor().min(real((size - 2) as f64));
        (i.to_usize().unwrap_or(0), x - i)
    };
    let (i, fi) = place(clamp(cos_o, T::zero(), T::one()));
    let (j, fj) = place(clamp(alpha, real(0.1), T::one()));
    let at = |i: usize, j: usize, k: usize| real::<T>(f64::from(sheen_table()[i * size + j][k]));
    std::array::from_fn(|k| {
        let low = at(i, j, k) + (at(i, j + 1, k) - at(i, j, k)) * fj;
        let high = at(i + 1, j, k) + (at(i + 1, j + 1, k) - at(i + 1, j, k)) * fj;
        low + (high - low) * fi
    })
}

/// One roughness as a function of cos theta_o = k/31, for a material that keeps alpha fixed: 32 vec4s (aInv, bInv, R, 0).
pub fn sheen_row(alpha: f32) -> [[f32; 4]; SHEEN_TABLE_SIZE] {
    std::array::from_fn(|k| {
        let v = sheen_lookup(k as f32 / (SHEEN_TABLE_SIZE - 1) as f32, alpha);
        [v[0], v[1], v[2], 0.0]
    })
}

/// Sheen BRDF times cos(theta_i) for strength 1, per steradian. `ltc` is (aInv, bInv, R) at the eye's cosine; directions and
/// `normal` (on the eye's side) in one frame. 0 unless eye and light are above the surface.
pub fn sheen_evaluate<T: Real>(ltc: [T; 3], normal: [T; 3], omega_o: [T; 3], omega_i: [T; 3]) -> T {
    let (zero, one) = (T::zero(), T::one());
    let (a, b, r) = (ltc[0], ltc[1], ltc[2]);
    let (cos_o, z) = (dot(normal, omega_o), dot(normal, omega_i));
    if !(cos_o > zero && z > zero && a >= real(1e-4) && r >= real(1e-5)) {
        return zero;
    }
    // x: the eye's direction laid into the surface. Seen from straight above the lobe is round and any x will do.
    let flat = [
        omega_o[0] - normal[0] * cos_o,
        omega_o[1] - normal[1] * cos_o,
        omega_o[2] - normal[2] * cos_o,
    ];
    let length = dot(flat, flat).max(zero).sqrt();
    let x = if length > real(1e-6) {
        dot(flat, omega_i) / length
    } else {
        zero
    };
    let y2 = (one - x * x - z * z).max(zero);
    let u = a * x + b * z;
    let q = u * u + a * a * y2 + z * z;
    r * z * a * a / (real::<T>(std::f64::consts::PI) * q * q).max(real(1e-12))
}

/// Share of light that the sheen of `strength` takes from the layer under it, 0..1: multiply the base by `1 - sheen_albedo`.
pub fn sheen_albedo<T: Real>(ltc: [T; 3], strength: T) -> T {
    clamp(
        clamp(strength, T::zero(), T::one()) * ltc[2],
        T::zero(),
        T::one(),
    )
}

/// Color of the fibres that stand out of the vane and make the sheen: their surface reflects 15.7 % without color (the mean over
/// the width of a keratin fibre seen at one radian; docs/book/scattering.md#sheen), the rest has the feather's color. White
/// stays white; a black feather keeps a sixth of the strength.
pub fn sheen_tint<T: Real>(albedo: [T; 3]) -> [T; 3] {
    let surface = real::<T>(0.157);
    albedo.map(|a| surface + (T::one() - surface) * clamp(a, T::zero(), T::one()))
}
