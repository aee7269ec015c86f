//! Seeds and the few distributions the groom needs. Every feather draws from its own stream, so that the number of feathers
//! placed before it changes nothing.

use bevy::math::Vec3;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Mixes two words into one (the finaliser of SplitMix64; Steele, Lea and Flood 2014).
pub fn mix(a: u64, b: u64) -> u64 {
    let mut z = a ^ b
        .wrapping_mul(0x9e37_79b9_7f4a_7c15)
        .wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Hash of a name (FNV-1a, 64 bit), finished by [`mix`].
pub fn name_hash(seed: u64, name: &str) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for byte in name.bytes() {
        hash = (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
    }
    mix(seed, hash)
}

/// Hash of a place, on a lattice of `cell` metres.
pub fn place_hash(seed: u64, place: Vec3, cell: f32) -> u64 {
    let lattice = |x: f32| (x / cell).round() as i64 as u64;
    mix(
        mix(mix(seed, lattice(place.x)), lattice(place.y)),
        lattice(place.z),
    )
}

/// A stream of random numbers of one feather or one region.
pub struct Stream(Pcg64Mcg);

impl Stream {
    /// The stream of this seed.
    pub fn new(seed: u64) -> Self {
        Self(Pcg64Mcg::seed_from_u64(seed))
    }

    /// Uniform in 0..1, 24 bits.
    pub fn uniform(&mut self) -> f32 {
        (self.0.next_u32() >> 8) as f32 * (1.0 / 16_777_216.0)
    }

    /// Near-normal with standard deviation 1, cut at 3.46: the sum of four uniforms, scaled. The cut keeps feathers from
    /// extremes that would stick out of the coat.
    pub fn normal(&mut self) -> f32 {
        let sum = self.uniform() + self.uniform() + self.uniform() + self.uniform();
        (sum - 2.0) * 1.732_050_8
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_has_unit_variance() {
        let mut stream = Stream::new(7);
        let draws: Vec<f32> = (0..20_000).map(|_| stream.normal()).collect();
        let mean = draws.iter().sum::<f32>() / draws.len() as f32;
        let variance = draws.iter().map(|x| (x - mean).powi(2)).sum::<f32>() / draws.len() as f32;
        assert!(mean.abs() < 0.03, "{mean}");
        assert!((variance - 1.0).abs() < 0.03, "{variance}");
    }

    #[test]
    fn hashes_differ_by_name_place_and_seed() {
        assert_ne!(name_hash(1, "mantle"), name_hash(1, "breast"));
        assert_ne!(name_hash(1, "mantle"), name_hash(2, "mantle"));
        assert_ne!(place_hash(1, Vec3::X, 0.001), place_hash(1, Vec3::Y, 0.001));
        assert_eq!(
            place_hash(1, Vec3::X, 0.001),
            place_hash(1, Vec3::X * 1.0001, 0.001)
        );
    }
}
