//! How far behind the nearest feather another one may lie and still be seen, because it lies over it in the coat's order.

use super::functions::{Real, clamp, real, smooth_step};

/// Depth within which a feather comes before the nearest, in the unit of `window`. `window`: the same where it is widest; `facing`:
/// cosine between the eye and the front face; `along`: share of the length, 0 at the root.
///
/// None on back faces: from below the nearest is the right one. None at the root, which lies in the skin.
pub fn order_reach<T: Real>(window: T, facing: T, along: T) -> T {
    let front = clamp(real::<T>(4.0) * facing, T::zero(), T::one());
    window * front * smooth_step(real(0.05), real(0.3), along)
}
