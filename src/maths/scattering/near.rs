//! Near field: the part of a fibre's width that a narrow footprint sees (the h window of Chen et al. 2026, Eq. 35).
//!
//! The window's own cosine and sine series take the place of the table's: the integral over h is cut into segments even in asin h,
//! each with its exact turn of the exit angle. The integral is linear in h, so the mean over the width of the fibre is the far
//! field.

use super::evaluate::{Odd, evaluate_with};
use super::flat::{ROUND, flat_normal};
use super::lobes::meets_core;
use super::{
    Crossing, FIBRE_HARMONICS, FIBRE_SERIES, FibreLobes, FibreParameters, FibreRow, FibreShading,
    Lobe, attenuation, crossing, exit_angle, fibre_color, fibre_shading, fresnel,
    gamma_transmittance,
};
use crate::maths::functions::{Real, clamp, real};

/// Most segments of a window.
pub const NEAR_SEGMENTS: usize = 20;
/// Widest segment in radians of asin h.
const SEGMENT: f64 = 0.16;
/// Least segments of a Gaussian window, and its half width in standard deviations.
const GAUSSIAN_SEGMENTS: f64 = 4.0;
const REACH: f64 = 2.5;
/// Terms times blur that a window's series needs: 0.1 %
/// (docs/book/scattering.md#around-the-fibre-the-far-field-as-a-cosine-series).
const NEAR_TERMS: f64 = 2.4;

/// A fibre prepared for a pixel that sees a part of its width.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FibreNear<T> {
    /// Energies and even series of the window; everything else as in the far field.
    pub shading: FibreShading<T>,
    /// Factors of sin n phi, in the order of [`FibreShading::series`].
    pub odd: [[T; FIBRE_HARMONICS]; FIBRE_SERIES],
}

/// Heights that a pixel sees: `low..high` within -1..1, weighted by a Gaussian.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FibreWindow<T> {
    /// Least h.
    pub low: T,
    /// Greatest h.
    pub high: T,
    /// Centre of the footprint in h.
    pub mean: T,
    /// One over its standard deviation in h; 0 weighs all heights alike.
    pub sharpness: T,
}

impl<T: Real> FibreWindow<T> {
    /// All heights of `low..high` alike; the whole fibre is -1..1.
    pub fn even(low: T, high: T) -> Self {
        let low = clamp(low, -T::one(), T::one());
        Self {
            low,
            high: clamp(high, low, T::one()),
            mean: T::zero(),
            sharpness: T::zero(),
        }
    }
}

/// What a Gaussian footprint sees of a fibre. `mean` and `deviation` are those of the footprint across the fibre, in half widths
/// of it. The mean of the windows of even footprints is the whole width.
pub fn fibre_window<T: Real>(mean: T, deviation: T) -> FibreWindow<T> {
    let one = T::one();
    let d = clamp(deviation, real(1e-3), real(1e3));
    // From further away only the edge is seen.
    let m = clamp(mean, -one - d, one + d);
    let reach = d * real(REACH);
    let low = clamp(m - reach, -one, one - reach.min(real(0.02)));
    FibreWindow {
        low,
        high: clamp(m + reach, low + reach.min(real(0.02)), one),
        mean: m,
        sharpness: one / d,
    }
}

/// Sums over the window, for one series: energy per channel and the coefficients of cos and sin.
#[derive(Clone, Copy)]
struct Sums<T> {
    even: [T; FIBRE_HARMONICS + 1],
    odd: [T; FIBRE_HARMONICS],
}

impl<T: Real> Sums<T> {
    fn new() -> Self {
        Self {
            even: [T::zero(); FIBRE_HARMONICS + 1],
            odd: [T::zero(); FIBRE_HARMONICS],
        }
    }

    /// Adds `amount` spread evenly over the angles `phi` +- `half`.
    fn add(&mut self, amount: T, phi: T, half: T) {
        self.even[0] = self.even[0] + amount;
        let (sin, cos) = phi.sin_cos();
        let (step_sin, step_cos) = half.sin_cos();
        let (mut s, mut c) = (sin, cos);
        let (mut hs, mut hc) = (step_sin, step_cos);
        for n in 0..FIBRE_HARMONICS {
            let x = real::<T>((n + 1) as f64) * half;
            let spread = if x > real(1e-3) { hs / x } else { T::one() };
            self.even[n + 1] = self.even[n + 1] + amount * spread * c;
            self.odd[n] = self.odd[n] + amount * spread * s;
            (s, c) = (s * cos + c * sin, c * cos - s * sin);
            (hs, hc) = (hs * step_cos + hc * step_sin, hc * step_cos - hs * step_sin);
        }
    }

    fn damped(&self, blur: T, harmonics: u32) -> ([T; FIBRE_HARMONICS], [T; FIBRE_HARMONICS]) {
        let mut out = ([T::zero(); FIBRE_HARMONICS], [T::zero(); FIBRE_HARMONICS]);
        if self.even[0] <= real(1e-9) {
            return out;
        }
        for n in 0..(harmonics as usize).min(FIBRE_HARMONICS) {
            let k = real::<T>((n + 1) as f64) * blur;
            let factor = (k * k * real(-0.5)).exp() * real(2.0) / self.even[0];
            out.0[n] = self.even[n + 1] * factor;
            out.1[n] = self.odd[n] * factor;
        }
        out
    }
}

/// Prepares a fibre of which the pixel sees the heights in `window` (see [`fibre_window`]); the other arguments as for
/// [`fibre_shading`].
///
/// h is positive towards azimuth 90 degrees from the eye's: along (y, z) = (cos phi_o, -sin phi_o).
pub fn fibre_near<T: Real>(
    p: &FibreParameters<T>,
    row: &FibreRow<T>,
    albedo: [T; 3],
    omega_o: [T; 3],
    dark_back: T,
    harmonics: u32,
    window: FibreWindow<T>,
) -> FibreNear<T> {
    let (zero, one) = (T::zero(), T::one());
    let mut s = fibre_shading(p, row, albedo, omega_o, dark_back, harmonics);
    let color = fibre_color(p, albedo);
    let low = clamp(window.low, -one, one);
    let high = clamp(window.high, low, one);
    let (from, to) = (low.asin(), high.asin());
    let least = if window.sharpness > zero {
        real(GAUSSIAN_SEGMENTS)
    } else {
        one
    };
    let count = ((to - from) / real(SEGMENT)).ceil().max(least);
    let count = count.to_usize().unwrap_or(1).clamp(1, NEAR_SEGMENTS);
    let step = (to - from) / real(count as f64);

    let mut sums = [Sums::new(); FIBRE_SERIES];
    let mut energy = [[zero; 3]; 4];
    let mut width = zero;
    let core = if p.structural { p.core } else { zero };
    // 1 / eta': offset of the inner ray over h.
    let inner = crossing(p.eta, s.cos_eye, one).offset;
    // Where rays begin to miss the core.
    let edge = clamp(core / inner.max(real(1e-6)), zero, one).asin();
    for i in 0..count {
        let a = from + step * real(i as f64);
        let b = a + step;
        for (a, b) in [
            (a, b.min(-edge)),
            (a.max(-edge), b.min(edge)),
            (a.max(edge), b),
        ] {
            if b - a < real(1e-6) {
                continue;
            }
            let middle = (a + b) * real(0.5);
            let off = (middle.sin() - window.mean) * window.sharpness;
            let weight = (b.sin() - a.sin()) * (off * off * real(-0.5)).exp().max(real(1e-4));
            width = width + weight;
            let c = crossing(p.eta, s.cos_eye, middle.sin());
            add_segment(
                p,
                &s,
                &color,
                &c,
                inner,
                (a, b),
                weight,
                &mut sums,
                &mut energy,
            );
        }
    }
    let inverse = one / width.max(real(1e-9));
    let entering = entering(p, row, &s);
    let scale = [inverse, inverse * entering, inverse * entering];
    for (lobe, scale) in scale.into_iter().enumerate() {
        s.energy[lobe] = energy[lobe].map(|e| e * scale);
    }
    s.energy[3] = std::array::from_fn(|ch| {
        let own = if p.structural {
            one
        } else {
            gamma_transmittance(row[2][0], row[2][1], color.absorption[ch])
        };
        energy[3][ch] * scale[1] * own
    });
    // What the mean over h smooths in the far field would ring here: blur to what the terms can show.
    let harmonics = harmonics.clamp(1, FIBRE_HARMONICS as u32);
    let least = real::<T>(NEAR_TERMS) / real(f64::from(harmonics));
    for blur in &mut s.blur {
        *blur = blur.max(least);
    }
    let mut odd = [[zero; FIBRE_HARMONICS]; FIBRE_SERIES];
    for (k, sum) in sums.iter().enumerate() {
        (s.series[k], odd[k]) = sum.damped(s.blur[k], harmonics);
    }
    FibreNear { shading: s, odd }
}

/// What a flat fibre lets in over what a round one does.
fn entering<T: Real>(p: &FibreParameters<T>, row: &FibreRow<T>, s: &FibreShading<T>) -> T {
    if p.aspect < real(ROUND) {
        (T::one() - s.energy[0][0]) / (T::one() - row[0][0]).max(real(1e-6))
    } else {
        T::one()
    }
}

fn add_segment<T: Real>(
    p: &FibreParameters<T>,
    s: &FibreShading<T>,
    color: &super::FibreColor<T>,
    c: &Crossing<T>,
    inner: T,
    (a, b): (T, T),
    weight: T,
    sums: &mut [Sums<T>; FIBRE_SERIES],
    energy: &mut [[T; 3]; 4],
) {
    let (zero, one, half) = (T::zero(), T::one(), real::<T>(0.5));
    let turn = (b - a) * half;
    // Ends of the segment inside the fibre; the exit angles are sums of these.
    let (oa, ob) = (a.sin() * inner, b.sin() * inner);
    let refracted = (clamp(ob, -one, one).asin() - clamp(oa, -one, one).asin()) * half;
    let surface = if p.aspect < real(ROUND) {
        let across = flat_normal(s, c.gamma);
        fresnel(s.cos_eye * across, p.eta)
    } else {
        c.fresnel
    };
    sums[0].add(
        surface * weight,
        exit_angle(Lobe::R, c, zero),
        (turn + turn).abs(),
    );
    for e in &mut energy[0] {
        *e = *e + surface * weight;
    }
    let core = p.structural.then_some((p.core, one));
    let medulla = if p.structural {
        (zero, zero)
    } else {
        (p.core, p.scattering)
    };
    if p.structural && meets_core(c, p.core) {
        let at = |o: T| clamp(o / p.core.max(real(1e-9)), -one, one).asin();
        let on_core = (at(ob) - at(oa)) * half;
        // The mean of the ends: the turn at the core is steep where rays just touch it.
        let middle = (at(oa) + at(ob)) * half;
        let direct = real::<T>(2.0) * (c.gamma - c.gamma_t + middle);
        let spread = (turn - refracted + on_core) * real(2.0);
        let clear = attenuation(c, core, medulla, zero)[3];
        sums[4].add(clear * weight, direct, spread.abs());
        for (e, r) in energy[3].iter_mut().zip(color.core) {
            *e = *e + attenuation(c, Some((p.core, r)), medulla, zero)[3] * weight;
        }
        return;
    }
    let through = (turn - refracted) * real(2.0);
    let returned = (turn - refracted - refracted) * real(2.0);
    let clear = attenuation(c, None, medulla, zero);
    let thin = attenuation(c, None, medulla, half);
    let dense = attenuation(c, None, medulla, real(super::table::SECOND_SHAPE));
    let tt = exit_angle(Lobe::TT, c, zero);
    sums[1].add(clear[1] * weight, tt, through.abs());
    sums[2].add(dense[1] * weight, tt, through.abs());
    sums[3].add(
        thin[2] * weight,
        exit_angle(Lobe::TRT, c, zero),
        returned.abs(),
    );
    let scattered = if p.structural {
        zero
    } else {
        (one - clear[0] - clear[1] - clear[2]).max(zero)
    };
    for (ch, absorption) in color.absorption.into_iter().enumerate() {
        let t = attenuation(c, None, medulla, absorption);
        energy[1][ch] = energy[1][ch] + t[1] * weight;
        energy[2][ch] = energy[2][ch] + t[2] * weight;
        energy[3][ch] = energy[3][ch] + scattered * weight;
    }
}

/// K = S cos(theta_i) of the window for light from `omega_i` (in the fibre's frame), linear RGB per steradian, at least 0.
pub fn fibre_near_evaluate<T: Real>(near: &FibreNear<T>, omega_i: [T; 3]) -> [T; 3] {
    fibre_near_lobes(near, omega_i).sum()
}

/// The same by how the light moves inside the fibre.
pub fn fibre_near_lobes<T: Real>(near: &FibreNear<T>, omega_i: [T; 3]) -> FibreLobes<T> {
    evaluate_with(&near.shading, Odd::Some(&near.odd), omega_i)
}
