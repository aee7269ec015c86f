//! Barbs that cling together in clumps, with gaps between them that open towards the outline.

use super::{Contour, Side};
use crate::{
    maths::seed::{Stream, mix},
    parameter::Parameter,
};
use bevy::reflect::{Reflect, std_traits::ReflectDefault};
use serde::{Deserialize, Serialize};

/// Clumps of barbs. The gap between two of them is a notch in the outline: `size` of the clump wide at the ends of the barbs, it narrows
/// to nothing `depth` of the barb further in.
#[derive(Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[reflect(Default, Clone, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct Clumps {
    /// Number of clumps per vane, 0..64; fewer than two leave the vane whole.
    #[reflect(@Parameter::new("", 0.0, 64.0))]
    pub count: u32,
    /// Width of a gap at the ends of the barbs, as a share of a clump and its gap, 0..1.
    #[reflect(@Parameter::share())]
    pub size: f32,
    /// How far a gap goes in along the barb, as a share of the barb, 0..1.
    #[reflect(@Parameter::share())]
    pub depth: f32,
    /// Shape of a gap, 0.25..4: 1 is a wedge, less opens late, like barbs that part near their ends, more is a slot.
    #[reflect(@Parameter::new("", 0.25, 4.0))]
    pub falloff: f32,
    /// How much more the barbs of the tip clump, 0..4: depth goes with this power of the share of the vane's height. 0: all alike.
    #[reflect(@Parameter::new("", 0.0, 4.0))]
    pub tip_bias: f32,
    /// How uneven the clumps are, 0..1.
    #[reflect(@Parameter::share())]
    pub variation: f32,
    /// Seed of what is uneven.
    pub seed: u32,
}

impl Default for Clumps {
    fn default() -> Self {
        Self {
            count: 0,
            size: 0.3,
            depth: 0.5,
            falloff: 1.0,
            tip_bias: 1.0,
            variation: 0.5,
            seed: 1,
        }
    }
}

/// A gap between two clumps, as a share of the vane's height: its middle, half its width, and how much deeper or shallower it is.
struct Gap {
    middle: f32,
    half: f32,
    share: f32,
}

impl Clumps {
    pub(super) fn is_default(&self) -> bool {
        *self == Self::default()
    }

    fn gaps(&self, side: Side) -> Vec<Gap> {
        let mut stream = Stream::new(mix(u64::from(self.seed), side as u64));
        let variation = self.variation.clamp(0.0, 1.0);
        let mut uneven = || variation * (2.0 * stream.uniform() - 1.0);
        let pitch = 1.0 / self.count.clamp(1, 64) as f32;
        (1..self.count.min(64))
            .map(|i| Gap {
                middle: pitch * (i as f32 + 0.4 * uneven()),
                half: 0.5 * pitch * self.size.clamp(0.0, 1.0) * (1.0 + 0.5 * uneven()),
                share: 1.0 - 0.5 * uneven().abs(),
            })
            .collect()
    }
}

impl Contour {
    /// Outline with clumps: `reach *= 1 - depth (1 - |d| / half)^(1 / falloff)` at a distance `d` from the middle of a gap.
    pub fn clumped(&self, clumps: &Clumps) -> Self {
        let mut result = self.clone();
        let falloff = clumps.falloff.clamp(0.25, 4.0).recip();
        for side in [Side::Left, Side::Right] {
            let gaps = clumps.gaps(side);
            let values = match side {
                Side::Left => &mut result.left,
                Side::Right => &mut result.right,
            };
            let last = values.len().saturating_sub(1).max(1) as f32;
            for (i, value) in values.iter_mut().enumerate() {
                let height = i as f32 / last;
                let bias = height.powf(clumps.tip_bias.clamp(0.0, 4.0));
                // A row of the table is never stepped over.
                let open = gaps.iter().map(|gap| {
                    let half = gap.half.max(1.0 / last);
                    let inside = 1.0 - (height - gap.middle).abs() / half;
                    gap.share * inside.max(0.0).powf(falloff)
                });
                let depth = clumps.depth.clamp(0.0, 1.0) * bias * open.fold(0.0, f32::max);
                *value *= 1.0 - depth;
            }
        }
        result
    }
}
