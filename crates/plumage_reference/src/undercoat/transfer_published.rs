//! Transfer as Kloetzli 2005 prints it, for comparison (docs/book/undercoat.md#transfer).

use bevy_plumage::maths::undercoat::harmonics::HARMONICS;
use bevy_plumage::maths::undercoat::transfer::{Rays, Skin, TransferSettings};

/// Textures of the paper's volume: 7 of four channels for each of its 32 shells.
pub const TEXTURES: u32 = 224;

/// The paper's way to bake: random rays, and light through the animal.
pub fn settings(count: u32, seed: u64) -> TransferSettings {
    TransferSettings {
        count,
        rays: Rays::Random(seed),
        skin: Skin::Clear,
        sine: false,
    }
}

/// Factor by which the paper's Eq. (6) makes each basis function too large: its normalisation takes the sign of m along, which turns
/// (l - |m|)! / (l + |m|)! over.
pub fn printed_excess() -> [f64; HARMONICS] {
    std::array::from_fn(|i| {
        let l = (i as f64).sqrt().floor() as i64;
        let m = i as i64 - l * (l + 1);
        if m >= 0 {
            return 1.0;
        }
        ((l + m + 1)..=(l - m)).map(|k| k as f64).product()
    })
}

/// Coefficients of a function by Eq. (7) as printed: the plain mean over `rays`, without the factor 4 pi.
pub fn printed_coefficients(
    rays: &[[f64; 3]],
    value: impl Fn([f64; 3]) -> f64,
) -> [f64; HARMONICS] {
    let mut sum = [0.0; HARMONICS];
    for ray in rays {
        let v = value(*ray);
        for (sum, y) in sum
            .iter_mut()
            .zip(bevy_plumage::maths::undercoat::harmonics::harmonics(*ray))
        {
            *sum += v * y / rays.len() as f64;
        }
    }
    sum
}

/// The 28 channels of the paper's seven textures of one shell: 25 harmonics and three that are free.
pub fn lookups(cell: &[f32; HARMONICS]) -> [[f32; 4]; 7] {
    std::array::from_fn(|t| std::array::from_fn(|k| cell.get(4 * t + k).copied().unwrap_or(0.0)))
}

/// The paper's reconstruction: the dot product of seven texture look-ups with seven vectors of light coefficients.
pub fn reconstruct(cell: &[[f32; 4]; 7], light: &[[f32; 4]; 7]) -> f32 {
    cell.iter()
        .flatten()
        .zip(light.iter().flatten())
        .map(|(a, b)| a * b)
        .sum()
}
