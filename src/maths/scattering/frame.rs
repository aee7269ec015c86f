//! The frame of a fibre.

use crate::maths::functions::{Real, clamp, real};
use crate::maths::vector::{cross, dot};

/// A direction in the frame of a fibre: x along `tangent`, z the normal made orthogonal to it, y = z cross x.
///
/// `tangent` and `normal` need not be unit vectors; parallel or zero ones give a defined frame.
pub fn fibre_local<T: Real>(tangent: [T; 3], normal: [T; 3], omega: [T; 3]) -> [T; 3] {
    let x = unit(tangent, [T::one(), T::zero(), T::zero()]);
    let d = dot(x, normal);
    let raw = [
        normal[0] - x[0] * d,
        normal[1] - x[1] * d,
        normal[2] - x[2] * d,
    ];
    // A normal along the tangent: any direction across will do.
    let spare = if x[0].abs() < real(0.7) {
        [T::one(), T::zero(), T::zero()]
    } else {
        [T::zero(), T::one(), T::zero()]
    };
    let z = unit(
        raw,
        unit(cross(cross(x, spare), x), [T::zero(), T::zero(), T::one()]),
    );
    let y = cross(z, x);
    [dot(omega, x), dot(omega, y), dot(omega, z)]
}

fn unit<T: Real>(a: [T; 3], otherwise: [T; 3]) -> [T; 3] {
    let l2 = dot(a, a);
    if l2 > real(1e-12) {
        let s = T::one() / l2.sqrt();
        [a[0] * s, a[1] * s, a[2] * s]
    } else {
        otherwise
    }
}

/// (sin, cos) of the inclination and the unit azimuth (y, z) of a local direction; azimuth 0 along the fibre.
pub(super) fn polar<T: Real>(omega: [T; 3]) -> ((T, T), [T; 2]) {
    let across = omega[1] * omega[1] + omega[2] * omega[2];
    let c = across.max(T::zero()).sqrt();
    let azimuth = if across > real(1e-12) {
        [omega[1] / c, omega[2] / c]
    } else {
        [T::zero(), T::one()]
    };
    (
        (clamp(omega[0], -T::one(), T::one()), c.min(T::one())),
        azimuth,
    )
}
