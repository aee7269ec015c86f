//! Light on the fibres of a coat: what one fibre sends on, how much light reaches it, and what multiple scattering adds.
//!
//! A step of the march with extinction `n D s(o)` (`s` is [`extinction_sine`]) sends `n D s(o) L` towards the eye, where `L` is the sum
//! over lights of irradiance times [`kajiya_kay_diffuse`] plus [`kajiya_kay_specular`], times [`multiple_scattering`]; that `L` is the
//! `source` of [`March::add`](super::march::March::add). Twin: `down_light.wgsl`. Numbers: docs/book/undercoat.md#light.

use super::march::extinction_sine;
use crate::maths::functions::{Real, clamp};

/// Integral of [`extinction_sine`] over the sphere of directions: pi^2 for parallel fibres, 4 pi for random ones.
pub fn kajiya_kay_norm<T: Real>(spread: T) -> T {
    let e = clamp(spread, T::zero(), T::one());
    let q = (T::one() - e * e).sqrt();
    // asin(q) / q, with its series where q vanishes; asin(q) = atan(q / e) keeps the precision near q = 1.
    let arc = if q < T::of(1e-2) {
        T::one() + q * q * T::of(1.0 / 6.0)
    } else {
        q.atan2(e) / q
    };
    T::of(core::f64::consts::TAU) * (e + arc)
}

/// Diffuse part of the Kajiya-Kay phase function, per steradian: with the eye's sine already in the extinction, it sends on exactly
/// `albedo` of what it blocks. `cos` is the cosine between the light and the fibre.
///
/// For parallel fibres it is `albedo sin / pi^2`; the usual `1/pi` creates 3.14 times the energy.
pub fn kajiya_kay_diffuse<T: Real>(albedo: T, cos: T, spread: T) -> T {
    albedo * extinction_sine(cos, spread) / kajiya_kay_norm(spread)
}

/// `sqrt(pi) Gamma((p+1)/2) / Gamma(p/2+1)`: the integral of `cos^p` over half a turn, within 2.4 % for p >= 1
/// (docs/book/fits/columns.py).
fn cosine_power_integral<T: Real>(p: T) -> T {
    (T::of(core::f64::consts::TAU) / (p + T::of(0.5))).sqrt()
}

/// Specular part of the Kajiya-Kay phase function, per steradian, that sends on `albedo` of what the fibre blocks (less for wide lobes
/// near the fibre's axis, never more). `eye` and `light` are the cosines of the two directions, both away from the fibre, to its
/// tangent; `power` >= 1.
pub fn kajiya_kay_specular<T: Real>(albedo: T, power: T, eye: T, light: T) -> T {
    let p = clamp(power, T::one(), T::of(1e4));
    let eye = clamp(eye, -T::one(), T::one());
    let light = clamp(light, -T::one(), T::one());
    let sin_eye = (T::one() - eye * eye).sqrt();
    let sin_light = (T::one() - light * light).sqrt();
    // cos(theta_o - theta_r), theta_r = pi - theta_i: on the mirror cone the cosines are opposite.
    let mirror = (sin_eye * sin_light - eye * light).max(T::zero());
    let square = sin_light * sin_light;
    let norm = T::of(core::f64::consts::TAU)
        * cosine_power_integral(p)
        * ((p + T::one()) * square + light * light)
        / (p + T::of(2.0));
    albedo * sin_light * mirror.powf(p) / norm.max(T::of(1e-6))
}

/// Phase function of a white Lambertian cylinder, per steradian of the eye's direction, its integral 1: back-lit and front-lit
/// coats differ. `sine` is the eye's sine to the fibre, `phi` the angle between eye and light around the fibre, 0 (light behind the
/// eye) to pi.
///
/// It contains the eye's sine: divide by [`extinction_sine`] where the extinction already has it.
pub fn cylinder_phase<T: Real>(sine: T, phi: T) -> T {
    let pi = T::of(core::f64::consts::PI);
    let phi = clamp(phi.abs(), T::zero(), pi);
    sine * (phi.sin() + (pi - phi) * phi.cos()) / (T::of(4.0) * pi)
}

/// Middle and width of step `i` of `count`, as shares of the way to the light, growing quadratically: near fibres count more.
pub fn light_step<T: Real>(i: u32, count: u32) -> (T, T) {
    let n = T::of(f64::from(count.max(1)));
    let square = |i: u32| {
        let x = T::of(f64::from(i)) / n;
        x * x
    };
    let (from, to) = (square(i), square(i + 1));
    (T::of(0.5) * (from + to), to - from)
}

/// Way to the top of the coat from height `z` (0..=1) along a direction with the cosine `mu` to the normal, in heights of the coat.
/// `curvature` is that of the skin times the coat's height, 0 for a flat one. At most 64.
///
/// Below the horizon of a flat coat, and where the skin is in the way, it is 64.
pub fn light_exit<T: Real>(z: T, mu: T, curvature: T) -> T {
    let far = T::of(64.0);
    let (one, two) = (T::one(), T::of(2.0));
    let z = clamp(z, T::zero(), one);
    let mu = clamp(mu, -one, one);
    let k = clamp(curvature, T::zero(), one);
    let here = one + z * k;
    let sine = (one - mu * mu) * here * here;
    // The sphere through the skin, in radii of it.
    let blocked = if k > T::zero() {
        sine <= one && mu < T::zero()
    } else {
        mu <= T::zero()
    };
    if blocked {
        return far;
    }
    let root = ((one + k) * (one + k) - sine).max(T::zero()).sqrt();
    let sum = (root + here * mu).max(T::of(1e-6));
    if mu > T::zero() {
        ((one - z) * (two + (one + z) * k) / sum).min(far)
    } else {
        // Past the nearest point and up again: no cancellation here.
        ((root - here * mu) / k).min(far)
    }
}

/// Mean visibility of a uniform sky under the column depth `column` (over the cosine average: exponential integral E2). Error
/// 0.015 (docs/book/fits/columns.py).
pub fn sky_visibility<T: Real>(column: T) -> T {
    let c = column.max(T::zero());
    (-c).exp() / (T::one() + T::of(1.0071) * c + T::of(0.488) * c.sqrt())
}

/// Irradiance of a uniform sky under the column depth `column`, over that of the open sky (2 E3). Error 0.0065
/// (docs/book/fits/columns.py).
pub fn sky_irradiance<T: Real>(column: T) -> T {
    let c = column.max(T::zero());
    (T::of(-0.8745) * c).exp() / (T::one() + T::of(0.9206) * c)
}

/// Mean visibility of a uniform sky between fibres along the normal; `column` is what they block of a ray across them, per
/// height. Error 0.006 up to a column of 8 (docs/book/fits/columns.py).
pub fn aligned_visibility<T: Real>(column: T) -> T {
    let c = column.max(T::zero());
    T::one() / (T::one() + T::of(1.8585) * c + T::of(0.7816) * c * c + T::of(0.4527) * c.sqrt())
}

/// Transmittance of the mean column: `column` optical depth above, light at the cosine `mu`; 0 below the horizon.
pub fn column_transmittance<T: Real>(column: T, mu: T) -> T {
    if mu <= T::zero() {
        return T::zero();
    }
    (-clamp(column, T::zero(), T::of(1e4)) / clamp(mu, T::of(1e-3), T::one())).exp()
}

/// Chandrasekhar's H for isotropic scattering with the single-scattering albedo `albedo`, by Hapke's approximation of 2002 (error
/// below 1 %; the one of 1981, up to 4 %; docs/book/fits/columns.py).
pub fn scattering_h<T: Real>(mu: T, albedo: T) -> T {
    let x = clamp(mu, T::of(1e-4), T::one());
    let albedo = clamp(albedo, T::zero(), T::one());
    let root = (T::one() - albedo).sqrt();
    let r = (T::one() - root) / (T::one() + root);
    let log = ((T::one() + x) / x).ln();
    let half = T::of(0.5);
    T::one() / (T::one() - albedo * x * (r + (half - r * x) * log))
}

/// The albedo to use in [`scattering_h`] over a skin of reflectance `skin`, for a coat of the given vertical optical depth: light
/// leaks into a dark skin through a thin coat (docs/book/fits/coat_photons.py).
pub fn scattering_albedo<T: Real>(albedo: T, skin: T, depth: T) -> T {
    let dark = T::one() - clamp(skin, T::zero(), T::one());
    clamp(albedo, T::zero(), T::one())
        * (T::one() - T::of(0.13) * dark * (-depth.max(T::zero())).exp())
}

/// Single scattering times this is single and multiple scattering: `H(eye) H(light)`, per color channel (`albedo` from
/// [`scattering_albedo`]). `eye` and `light` are cosines to the normal of the skin; 0.5 for a sky.
pub fn multiple_scattering<T: Real>(eye: T, light: T, albedo: T) -> T {
    scattering_h(eye, albedo) * scattering_h(light, albedo)
}
