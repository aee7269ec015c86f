//! The medulla's scattered light: direction of the lobe and its color from a baked table.
//!
//! Its energy needs no table: what does not leave in R, TT or TRT is scattered
//! (docs/book/scattering.md#the-medulla-of-pigment-fibres). The table is made by `cargo run -p plumage_tools --bin bake_tables`, a path tracer
//! of the double cylinder.

use std::sync::OnceLock;

/// Sample points of the table: radius of the medulla, optical depth of its radius, Henyey-Greenstein g, cos theta_o.
pub const MEDULLA_AXES: (&[f64], &[f64], &[f64], &[f64]) = (
    &[0.3, 0.5, 0.65, 0.8, 0.95],
    &[0.25, 0.5, 1.0, 2.0, 4.0, 8.0],
    &[0.0, 0.3, 0.6, 0.85],
    &[0.08, 0.35, 0.65, 1.0],
);

/// Numbers in the table: every combination of the axes, last axis fastest, times five values.
pub const MEDULLA_TABLE_LENGTH: usize = 5 * 6 * 4 * 4 * 5;

/// What the table of places was taken at: absorption per fibre radius, and radians per radius of the wave along the fibre.
pub const MEDULLA_PLACE: (f64, f64) = (0.5, 1.6);

/// Shape and color of the medulla's lobe for one direction of the eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MedullaShape {
    /// Mean of cos phi: positive is back towards the eye.
    pub a1: f64,
    /// Mean of cos 2 phi.
    pub a2: f64,
    /// Mean of sin theta_i for theta_o > 0: negative is forward.
    pub m1: f64,
    /// ln of the color at absorption 0.2 and 1 per fibre radius.
    pub ln_color: [f64; 2],
    /// How far light leaves from where it entered, at the absorption of [`MEDULLA_PLACE`]: mean cosine of the angle around the
    /// fibre, and of its wave along the fibre. Both 0 where light comes out anywhere, 1 where it comes out at its entry.
    pub place: [f64; 2],
}

/// Seven values per cell: those of `medulla.bin`, then those of `medulla_place.bin`.
fn table() -> &'static [[f32; 7]] {
    static TABLE: OnceLock<Vec<[f32; 7]>> = OnceLock::new();
    TABLE.get_or_init(|| {
        let read = |bytes: &[u8]| -> Vec<f32> {
            bytes
                .chunks_exact(4)
                .map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
                .collect()
        };
        let shapes = read(include_bytes!("tables/medulla.bin"));
        let places = read(include_bytes!("tables/medulla_place.bin"));
        shapes
            .chunks_exact(5)
            .zip(places.chunks_exact(2))
            .map(|(s, p)| [s[0], s[1], s[2], s[3], s[4], p[0], p[1]])
            .collect()
    })
}

/// Cell and fraction of `x` on a rising axis, clamped to its ends.
fn place(axis: &[f64], x: f64) -> (usize, f64) {
    let x = x.max(axis[0]).min(axis[axis.len() - 1]);
    let i = axis
        .windows(2)
        .take_while(|w| x > w[1])
        .count()
        .min(axis.len() - 2);
    (i, (x - axis[i]) / (axis[i + 1] - axis[i]))
}

/// Looks the table up, linear in every axis (logarithmic in `tau`), clamped to its range.
///
/// `kappa`: radius of the medulla over the fibre's; `tau`: optical depth of scattering along the medulla's radius; `g`: mean
/// cosine; `cos_theta`: of the eye's inclination. A reduced depth tau (1 - g) below 0.2 is raised to it: the two-term shape
/// does not hold there.
pub fn medulla_shape(kappa: f64, tau: f64, g: f64, cos_theta: f64) -> MedullaShape {
    let (kappas, taus, gs, cosines) = MEDULLA_AXES;
    let g = g.clamp(0.0, 0.95);
    let tau = tau
        .max(0.2 / (1.0 - g))
        .clamp(taus[0], taus[taus.len() - 1]);
    let log_taus: Vec<f64> = taus.iter().map(|t| t.log2()).collect();
    let places = [
        place(kappas, kappa),
        place(&log_taus, tau.log2()),
        place(gs, g),
        place(cosines, cos_theta),
    ];
    let sizes = [kappas.len(), taus.len(), gs.len(), cosines.len()];
    let mut out = [0.0; 7];
    for corner in 0..16_usize {
        let (mut weight, mut index) = (1.0, 0);
        for axis in 0..4 {
            let (i, f) = places[axis];
            let upper = corner >> axis & 1;
            weight *= if upper == 1 { f } else { 1.0 - f };
            index = index * sizes[axis] + i + upper;
        }
        for (k, o) in out.iter_mut().enumerate() {
            *o += weight * f64::from(table().get(index).map_or(0.0, |cell| cell[k]));
        }
    }
    MedullaShape {
        a1: out[0],
        a2: out[1],
        m1: out[2].clamp(-0.25, 0.25),
        ln_color: [out[3].min(0.0), out[4].min(0.0)],
        place: [out[5].clamp(0.0, 1.0), out[6].clamp(0.0, 1.0)],
    }
}
