//! Geometry and attenuation of the lobes of one fibre, given where on the fibre the eye looks (h).
//!
//! Everything is evaluated at the angle of the eye, theta_o, which keeps the white furnace exact
//! (docs/book/scattering.md#what-is-shaded-with). The series of inner reflections are closed, so that no energy is lost (decision
//! 5).

use crate::maths::functions::{Real, clamp, real};

/// The lobes of a fibre. Structural fibres use the first four, pigment fibres R, TT, TRT and the medulla.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(usize)]
pub enum Lobe {
    /// Reflection at the surface, never colored.
    R = 0,
    /// Light through the fibre, beside the core.
    TT = 1,
    /// Light reflected once (and more often: the series is closed) inside, beside the core.
    TRT = 2,
    /// Light reflected by the mirror core, including later round trips between core and surface.
    TRcT = 3,
    /// Light scattered in the medulla (TTs and TRTs of Yan et al. 2017 together). Shares the slot of TRcT.
    Medulla = 4,
}

/// Unpolarised reflectance of a smooth dielectric, `cos_in` = cosine on the outside, `eta` = inside over outside.
///
/// Result in 0..1; 1 at grazing incidence.
pub fn fresnel<T: Real>(cos_in: T, eta: T) -> T {
    let one = T::one();
    let c = clamp(cos_in.abs(), T::zero(), one);
    let sin2_t = (one - c * c) / (eta * eta);
    if sin2_t >= one {
        return one;
    }
    let t = (one - sin2_t).sqrt();
    let s = (c - eta * t) / (c + eta * t);
    let p = (eta * c - t) / (eta * c + t);
    (s * s + p * p) * real(0.5)
}

/// One refraction into the fibre, in the cross-section and along the axis (docs/book/scattering.md#geometry).
#[derive(Clone, Copy, Debug)]
pub struct Crossing<T> {
    /// Azimuth of the surface normal at the hit, from the azimuth of the eye: asin h.
    pub gamma: T,
    /// Angle inside, in the cross-section: asin(h / eta').
    pub gamma_t: T,
    /// Distance of the inner ray from the axis, |h / eta'| with the sign of h.
    pub offset: T,
    /// Cosine of the angle between the inner ray and the cross-section.
    pub cos_inside: T,
    /// Fresnel reflectance at the hit; also at every later one.
    pub fresnel: T,
}

/// Refraction of the ray of the eye at height `h` in -1..1, cos theta_o in 0..1.
pub fn crossing<T: Real>(eta: T, cos_theta: T, h: T) -> Crossing<T> {
    let one = T::one();
    let cos_theta = clamp(cos_theta, real(1e-3), one);
    let h = clamp(h, -one, one);
    let sin2 = one - cos_theta * cos_theta;
    // Bravais: the index of the projected problem grows towards grazing.
    let eta_projected = (eta * eta - sin2).max(real(1e-6)).sqrt() / cos_theta;
    let offset = h / eta_projected;
    let cos_gamma = (one - h * h).max(T::zero()).sqrt();
    Crossing {
        gamma: h.asin(),
        gamma_t: clamp(offset, -one, one).asin(),
        offset,
        cos_inside: (one - sin2 / (eta * eta)).max(real(1e-6)).sqrt(),
        fresnel: fresnel(cos_theta * cos_gamma, eta),
    }
}

/// Azimuth in which the central ray of a lobe leaves, relative to the eye; not wrapped (docs/book/scattering.md#geometry).
///
/// `core` is the radius of the mirror core and matters for TRcT only. The medulla has no direction: 0.
pub fn exit_angle<T: Real>(lobe: Lobe, c: &Crossing<T>, core: T) -> T {
    let two = real::<T>(2.0);
    match lobe {
        Lobe::R => two * c.gamma,
        Lobe::TT => two * (c.gamma - c.gamma_t) - real(std::f64::consts::PI),
        Lobe::TRT => two * c.gamma - real::<T>(4.0) * c.gamma_t,
        Lobe::TRcT => {
            let at_core = clamp(c.offset / core.max(real(1e-9)), -T::one(), T::one()).asin();
            two * (c.gamma - c.gamma_t + at_core)
        }
        Lobe::Medulla => T::zero(),
    }
}

/// Does a ray that entered at this crossing meet a core of radius `core`? Inner reflections never change the answer.
pub fn meets_core<T: Real>(c: &Crossing<T>, core: T) -> bool {
    c.offset.abs() < core
}

/// Share of the power that leaves in R, TT, TRT and TRcT (docs/book/scattering.md#geometry), each 0..1.
///
/// `core` is `Some((radius, reflectance))` for a mirror core; `medulla` is `(radius, scattering per radius of the fibre)`,
/// (0, 0) for none: scattering takes light out of TT and TRT. `absorption` is per fibre radius, in cortex and medulla alike.
/// Without absorption and with a reflectance of 1 the sum is 1, less what the medulla scatters.
pub fn attenuation<T: Real>(
    c: &Crossing<T>,
    core: Option<(T, T)>,
    medulla: (T, T),
    absorption: T,
) -> [T; 4] {
    let (zero, one, two) = (T::zero(), T::one(), real::<T>(2.0));
    let f = c.fresnel;
    let through = (one - f) * (one - f);
    // (1 - F T) may reach 0 only where the numerator does so faster.
    let open = |t: T| (one - f * t).max(real(1e-6));
    let cos_t = (one - c.offset * c.offset).max(zero).sqrt();
    if let Some((radius, reflectance)) = core
        && meets_core(c, radius)
    {
        let stop = (radius * radius - c.offset * c.offset).max(zero).sqrt();
        let length = two * (cos_t - stop).max(zero) / c.cos_inside;
        let t = reflectance * (-absorption * length).exp();
        return [f, zero, zero, through * t / open(t)];
    }
    let (radius, scattering) = medulla;
    let inside = (radius * radius - c.offset * c.offset).max(zero).sqrt();
    let t = (-two * (absorption * cos_t + scattering * inside) / c.cos_inside).exp();
    [f, through * t, through * f * t * t / open(t), zero]
}
