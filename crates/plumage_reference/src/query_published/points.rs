//! Point supersampling: the point query at samples of the footprint.

use bevy_plumage::maths::functions::{Real, wrap};
use bevy_plumage::maths::query::{
    point::{Component, cell_point},
    vane::{Cell, Local},
};

/// Fractions of 2^32 by which the two coordinates of a sample advance: the additive recurrence on the plastic number.
const ADVANCE: [u32; 2] = [3_242_174_889, 2_447_445_414];

/// Sample `index` of a standard normal in two dimensions: a low-discrepancy point through the Box-Muller transform.
pub fn sample<T: Real>(index: u32) -> [T; 2] {
    let [a, b] = ADVANCE.map(|step| {
        let bits = index
            .wrapping_add(1)
            .wrapping_mul(step)
            .wrapping_add(1 << 31);
        // 24 bits are exact in single precision; the half keeps the logarithm finite.
        (T::of(f64::from(bits >> 8)) + T::of(0.5)) / T::of(16_777_216.0)
    });
    let radius = (T::of(-2.0) * a.ln()).max(T::zero()).sqrt();
    [
        radius * bevy_plumage::maths::functions::cosine_turns(b),
        radius * bevy_plumage::maths::functions::sine_turns(b),
    ]
}

/// `[barb, upper, lower]` as shares of `count` point queries (at least one) at samples of the footprint.
pub fn points<T: Real>(cell: &Cell<T>, local: &Local<T>, count: u32) -> [T; 3] {
    let count = count.max(1);
    let (sigma_u, sigma) = (local.variance.sqrt(), local.conditional.sqrt());
    // The upper family is the proximal one seen from the back.
    let upper = if cell.side < T::zero() {
        Component::Proximal
    } else {
        Component::Distal
    };
    let mut hits = [0u32; 3];
    for i in 0..count {
        let [a, b] = sample::<T>(i);
        let u = local.u + sigma_u * a;
        let k = u.floor();
        let tau = wrap(local.tau + local.slope * (u - local.u) + sigma * b - k * cell.e_root);
        match cell_point(cell, u - k, tau).component {
            Component::Barb => hits[0] += 1,
            hit if hit == upper => hits[1] += 1,
            Component::Distal | Component::Proximal => hits[2] += 1,
            Component::None | Component::Rachis => {}
        }
    }
    hits.map(|n| T::of(f64::from(n) / f64::from(count)))
}
