//! The far field of a fibre as a cosine series per lobe, tabulated over the eye's inclination
//! (docs/book/scattering.md#around-the-fibre-the-far-field-as-a-cosine-series).
//!
//! Absorption and azimuthal roughness are applied at run time, so one table serves every color of a fibre.

use super::{
    Fibre, FibreKind, FibreParameters, Lobe, MEDULLA_PLACE, attenuation, crossing, exit_angle,
    fibre_parameters, gamma_fit, medulla_shape,
};
use crate::maths::{Real, gauss_legendre};

/// Harmonics stored per lobe: enough for an azimuthal roughness of 0.2 at an error of 1 %.
pub const FIBRE_HARMONICS: usize = 8;
/// Rows of a table: cos theta_o from 0.02 to 1, evenly.
pub const FIBRE_ROWS: usize = 16;
/// vec4s in one row.
///
/// | vec4 | contents |
/// |---|---|
/// | 0 | energy without absorption of R, TT, TRT and of TRcT (core reflectance 1) or the medulla |
/// | 1 | k t and t of TT, k t and t of TRT |
/// | 2 | pigment: k t and t of the medulla's light, a1, a2; structural: share c of round trips |
/// | 3, 4 | structural: shape of TRcT; pigment: m1, and how fast light forgets its place around and along the fibre, in 3.xyz |
/// | 5, 6 | shape of R |
/// | 7, 8 | shape of TT without absorption |
/// | 9, 10 | shape of TT at absorption 2 |
/// | 11, 12 | shape of TRT at absorption 0.5 |
///
/// A shape is the ratio c_n / c_0 of the cosine coefficients for n = 1..8, two vec4s.
pub const FIBRE_ROW_VEC4S: usize = 13;
/// vec4s of a fibre's parameters ([`FibreTable::pack_parameters`]).
pub const FIBRE_PARAMETER_VEC4S: usize = 7;

/// One row, or a mixture of two.
pub type FibreRow<T> = [[T; 4]; FIBRE_ROW_VEC4S];

/// Absorption at which the second shape of TT is taken.
pub(crate) const SECOND_SHAPE: f64 = 2.0;
/// Nodes per panel of h: exact to 1e-6 for eight harmonics.
const NODES: usize = 48;
const FIRST_COS: f64 = 0.02;

/// Table of one fibre for the whole range of eye inclinations.
#[derive(Clone, Debug, PartialEq)]
pub struct FibreTable {
    /// The rows, [`FIBRE_ROWS`] of them.
    pub rows: Vec<FibreRow<f64>>,
    /// The three vec4s that [`fibre_parameters`] unpacks.
    pub parameters: [[f64; 4]; 3],
}

impl FibreTable {
    /// Builds the table of `fibre`. Values out of range are clamped, NaN to the lower bound. About a millisecond.
    pub fn build(fibre: &Fibre) -> Self {
        let shape = Section::new(fibre);
        let nodes = gauss_legendre(NODES);
        let rows: Vec<_> = (0..FIBRE_ROWS)
            .map(|r| {
                shape.row(
                    FIRST_COS + (1.0 - FIRST_COS) * r as f64 / (FIBRE_ROWS - 1) as f64,
                    &nodes,
                )
            })
            .collect();
        let head = &rows[FIBRE_ROWS - 1];
        let (kt, t) = own_color(head, shape.structural);
        let parameters = [
            [
                f64::from(fibre.longitudinal_roughness),
                f64::from(fibre.azimuthal_roughness),
                f64::from(fibre.tilt),
                f64::from(fibre.aspect),
            ],
            [
                shape.eta,
                f64::from(u8::from(shape.structural)),
                shape.radius,
                head[0][0],
            ],
            [
                kt,
                t,
                shape.scattering,
                if shape.structural { head[2][0] } else { 0.0 },
            ],
        ];
        Self { rows, parameters }
    }

    /// The parameters, unpacked in double precision.
    pub fn fibre(&self) -> FibreParameters<f64> {
        let [a, b, c] = self.parameters;
        fibre_parameters(a, b, c)
    }

    /// The row at an inclination of the eye, interpolated.
    pub fn row(&self, cos_theta: f64) -> FibreRow<f64> {
        let (i, f) = fibre_row_at(cos_theta);
        fibre_row_mix(&self.rows[i], &self.rows[i + 1], f)
    }

    /// For the GPU: [`FIBRE_ROWS`] times [`FIBRE_ROW_VEC4S`] vec4s, row after row.
    pub fn pack_rows(&self) -> Vec<[f32; 4]> {
        self.rows
            .iter()
            .flatten()
            .map(|v| v.map(|x| x as f32))
            .collect()
    }

    /// For the GPU: the three vec4s that [`fibre_parameters`] unpacks, then what follows from them, of R, TT, TRT and TRcT each: sine
    /// and cosine of the longitudinal shift, one over the square of the longitudinal roughness, and what makes its term's integral 1.
    pub fn pack_parameters(&self) -> [[f32; 4]; FIBRE_PARAMETER_VEC4S] {
        let p = self.fibre();
        let [a, b, c] = self.parameters;
        [
            a,
            b,
            c,
            p.shift.map(|(sine, _)| sine),
            p.shift.map(|(_, cosine)| cosine),
            p.spread.map(|spread| spread.inverse),
            p.spread.map(|spread| spread.scale),
        ]
        .map(|v| v.map(|x| x as f32))
    }
}

/// Index of the lower row (0..=[`FIBRE_ROWS`] - 2) and fraction towards the next, for cos theta_o.
pub fn fibre_row_at<T: Real>(cos_theta: T) -> (usize, T) {
    let last = crate::maths::real::<T>((FIBRE_ROWS - 1) as f64);
    let first = crate::maths::real::<T>(FIRST_COS);
    let x = crate::maths::functions::clamp(
        (cos_theta - first) / (T::one() - first) * last,
        T::zero(),
        last,
    );
    let i = x.floor().min(last - T::one());
    (i.to_usize().unwrap_or(0), x - i)
}

/// Mixes two rows: energies linearly, everything else weighted by the energy of its lobe, so that an empty lobe on one side
/// does not pull the shape of the other.
pub fn fibre_row_mix<T: Real>(a: &FibreRow<T>, b: &FibreRow<T>, fraction: T) -> FibreRow<T> {
    let mix = |x: T, y: T, f: T| x + (y - x) * f;
    let mut f = [fraction; 4];
    for lobe in 0..4 {
        let upper = b[0][lobe] * fraction;
        let sum = a[0][lobe] * (T::one() - fraction) + upper;
        if sum > crate::maths::real(1e-9) {
            f[lobe] = upper / sum;
        }
    }
    let mut out = *a;
    for (v, (x, y)) in out
        .iter_mut()
        .zip(a.iter().zip(b))
        .enumerate()
        .map(|(i, (o, p))| ((i, o), p))
    {
        let (i, o) = v;
        let fractions = match i {
            0 => [fraction; 4],
            1 => [f[1], f[1], f[2], f[2]],
            2..=4 => [f[3]; 4],
            5 | 6 => [f[0]; 4],
            7..=10 => [f[1]; 4],
            _ => [f[2]; 4],
        };
        for k in 0..4 {
            o[k] = mix(x[k], y[k], fractions[k]);
        }
    }
    out
}

/// The cross-section of a fibre with every parameter within its range.
struct Section {
    eta: f64,
    structural: bool,
    radius: f64,
    scattering: f64,
    tau: f64,
    g: f64,
}

/// Cosine coefficients of one lobe: `[n]` for n = 0..=8.
type Coefficients = [f64; FIBRE_HARMONICS + 1];

impl Section {
    fn new(fibre: &Fibre) -> Self {
        let eta = crate::maths::functions::clamp(f64::from(fibre.eta), 1.05, 3.0);
        match fibre.kind {
            FibreKind::Structural { core_radius } => Self {
                eta,
                structural: true,
                radius: crate::maths::functions::clamp(f64::from(core_radius), 0.0, 0.999_999),
                scattering: 0.0,
                tau: 0.0,
                g: 0.0,
            },
            FibreKind::Pigment {
                medulla_radius,
                scattering,
                anisotropy,
            } => {
                let radius = crate::maths::functions::clamp(f64::from(medulla_radius), 0.05, 0.999);
                let tau = crate::maths::functions::clamp(f64::from(scattering), 0.0, 16.0);
                let g = crate::maths::functions::clamp(f64::from(anisotropy), 0.0, 0.95);
                Self {
                    eta,
                    structural: false,
                    radius,
                    scattering: tau / radius,
                    tau,
                    g,
                }
            }
        }
    }

    /// Coefficients of R, TT, TRT, TRcT at one absorption.
    fn coefficients(
        &self,
        cos_theta: f64,
        absorption: f64,
        nodes: &[(f64, f64)],
    ) -> [Coefficients; 4] {
        let sin2 = 1.0 - cos_theta * cos_theta;
        let eta_projected = (self.eta * self.eta - sin2).sqrt() / cos_theta;
        // The integrands have a kink or a jump where rays begin to miss the inner cylinder.
        let split = (self.radius * eta_projected).min(1.0).asin();
        let core = self.structural.then_some((self.radius, 1.0));
        let medulla = if self.structural {
            (0.0, 0.0)
        } else {
            (self.radius, self.scattering)
        };
        let mut out = [[0.0; FIBRE_HARMONICS + 1]; 4];
        for (from, to) in [(0.0, split), (split, std::f64::consts::FRAC_PI_2)] {
            let half = 0.5 * (to - from);
            if half < 1e-12 {
                continue;
            }
            for &(x, w) in nodes {
                let gamma = from + half * (x + 1.0);
                let c = crossing(self.eta, cos_theta, gamma.sin());
                let a = attenuation(&c, core, medulla, absorption);
                let weight = w * half * gamma.cos();
                for (lobe, &amount) in [Lobe::R, Lobe::TT, Lobe::TRT, Lobe::TRcT].iter().zip(&a) {
                    if amount <= 0.0 {
                        continue;
                    }
                    let cos = exit_angle(*lobe, &c, self.radius).cos();
                    let (mut now, mut before) = (1.0, cos);
                    for o in &mut out[*lobe as usize] {
                        *o += weight * amount * now;
                        (now, before) = (2.0 * cos * now - before, now);
                    }
                }
            }
        }
        out
    }

    fn row(&self, cos_theta: f64, nodes: &[(f64, f64)]) -> FibreRow<f64> {
        let clear = self.coefficients(cos_theta, 0.0, nodes);
        let thin = self.coefficients(cos_theta, 0.5, nodes);
        let dense = self.coefficients(cos_theta, SECOND_SHAPE, nodes);
        let mut row = [[0.0; 4]; FIBRE_ROW_VEC4S];
        row[0] = [clear[0][0], clear[1][0], clear[2][0], clear[3][0]];
        let fit = |lobe: usize| {
            let e = clear[lobe][0];
            if e < 1e-9 {
                return (0.0, 1.0);
            }
            gamma_fit(0.5, thin[lobe][0] / e, SECOND_SHAPE, dense[lobe][0] / e)
        };
        let (tt, trt) = (fit(1), fit(2));
        row[1] = [tt.0, tt.1, trt.0, trt.1];
        if self.structural {
            set_shape(&mut row, 3, &clear[3]);
            row[2][0] = self.round_trips(cos_theta, clear[3][0], nodes);
        } else {
            let e = 1.0 - clear[0][0] - clear[1][0] - clear[2][0];
            row[0][3] = e.max(0.0);
            let m = medulla_shape(self.radius, self.tau, self.g, cos_theta);
            let (kt, t) = gamma_fit(0.2, m.ln_color[0].exp(), 1.0, m.ln_color[1].exp());
            row[2] = [kt, t, m.a1, m.a2];
            row[3][0] = m.m1;
            row[3][1] = forgetting(kt, t, m.place[0]);
            row[3][2] = forgetting(kt, t, m.place[1]);
        }
        set_shape(&mut row, 5, &clear[0]);
        set_shape(&mut row, 7, &clear[1]);
        set_shape(
            &mut row,
            9,
            if dense[1][0] > 1e-9 * clear[1][0] {
                &dense[1]
            } else {
                &clear[1]
            },
        );
        set_shape(&mut row, 11, &thin[2]);
        row
    }
}

/// Rate per radius of path at which light forgets its place, from the share that remembers at the absorption of
/// [`MEDULLA_PLACE`]. A path of length L remembers with chance exp(-rate L); lengths are those of the gamma law (`kt`, `t`), so
/// forgetting acts like absorption, and the darker the fibre, the shorter the paths that are left and the more they remember.
fn forgetting(kt: f64, t: f64, share: f64) -> f64 {
    let (k, t) = ((kt / t.max(1e-4)).max(1e-3), t.max(1e-4));
    let grown = (-share.clamp(1e-3, 0.999).ln() / k).min(20.0).exp_m1();
    ((1.0 / t + MEDULLA_PLACE.0) * grown).min(1e4)
}

impl Section {
    /// c of `R (1 - c)/(1 - c R)`, the sum of the round trips between core and surface, fitted at R = 1/2
    /// (docs/book/scattering.md#color-from-an-albedo).
    fn round_trips(&self, cos_theta: f64, white: f64, nodes: &[(f64, f64)]) -> f64 {
        if white < 1e-9 {
            return 0.0;
        }
        let half = self.mean(cos_theta, nodes, Some((self.radius, 0.5)))[3] / white;
        // half = (1 - c)/(2 - c)
        crate::maths::functions::clamp((1.0 - 2.0 * half) / (1.0 - half), 0.0, 0.9)
    }

    /// Mean attenuation over the width, without absorption.
    fn mean(&self, cos_theta: f64, nodes: &[(f64, f64)], core: Option<(f64, f64)>) -> [f64; 4] {
        let sin2 = 1.0 - cos_theta * cos_theta;
        let eta_projected = (self.eta * self.eta - sin2).sqrt() / cos_theta;
        let split = (self.radius * eta_projected).min(1.0).asin();
        let mut out = [0.0; 4];
        for (from, to) in [(0.0, split), (split, std::f64::consts::FRAC_PI_2)] {
            let half = 0.5 * (to - from);
            for &(x, w) in nodes {
                let gamma: f64 = from + half * (x + 1.0);
                let c = crossing(self.eta, cos_theta, gamma.sin());
                let a = attenuation(&c, core, (0.0, 0.0), 0.0);
                for (o, a) in out.iter_mut().zip(a) {
                    *o += w * half * gamma.cos() * a;
                }
            }
        }
        out
    }
}

fn set_shape(row: &mut FibreRow<f64>, at: usize, c: &Coefficients) {
    for n in 0..FIBRE_HARMONICS {
        row[at + n / 4][n % 4] = if c[0] > 1e-12 { c[n + 1] / c[0] } else { 0.0 };
    }
}

/// k t and t of the whole color that absorption gives the fibre at theta_o = 0 (docs/book/scattering.md#color-from-an-albedo).
fn own_color(row: &FibreRow<f64>, structural: bool) -> (f64, f64) {
    let light = |sigma: f64| {
        let medulla = if structural {
            0.0
        } else {
            row[0][3] * super::gamma_transmittance(row[2][0], row[2][1], sigma)
        };
        row[0][1] * super::gamma_transmittance(row[1][0], row[1][1], sigma)
            + row[0][2] * super::gamma_transmittance(row[1][2], row[1][3], sigma)
            + medulla
    };
    let clear = light(0.0);
    if clear < 1e-9 {
        (0.0, 1.0)
    } else {
        gamma_fit(0.2, light(0.2) / clear, 1.0, light(1.0) / clear)
    }
}
