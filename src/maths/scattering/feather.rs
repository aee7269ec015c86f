//! The whole feather: a plain sum over the fibres that a footprint sees (Chen et al. 2026, Eq. 35, without its cosines).

use super::{FibreShading, fibre_evaluate, fibre_local};
use crate::maths::functions::Real;

/// One of rachis, barbs, distal and proximal barbules, prepared for a pixel.
#[derive(Clone, Copy, Debug)]
pub struct FeatherPart<T> {
    /// Share of the footprint that shows this part, 0..1; the four of a feather sum to at most 1.
    pub weight: T,
    /// Share of what is seen of this part that the light reaches, 0..1 ([`crate::maths::query::vane_shadow`]).
    pub reached: T,
    /// Direction of the fibre towards its tip, in the frame of the directions passed to [`feather_bsdf`].
    pub tangent: [T; 3],
    /// The fibre and the eye.
    pub shading: FibreShading<T>,
}

/// Feather BSDF times |cos(theta_i)|, linear RGB per steradian: what a light's irradiance across its beam is multiplied with.
///
/// `normal` is the front of the feather (not flipped), `omega_i` towards the light; both sides of the card scatter. What is
/// not covered, `1 - sum of weights`, is transparency and not part of the result.
pub fn feather_bsdf<T: Real>(
    parts: &[FeatherPart<T>; 4],
    normal: [T; 3],
    omega_i: [T; 3],
) -> [T; 3] {
    let mut sum = [T::zero(); 3];
    for part in parts {
        if part.weight.is_nan() || part.weight <= T::zero() {
            continue;
        }
        let local = fibre_local(part.tangent, normal, omega_i);
        let k = fibre_evaluate(&part.shading, local);
        for c in 0..3 {
            sum[c] = sum[c] + part.weight * part.reached * k[c];
        }
    }
    sum
}
