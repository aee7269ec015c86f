//! Random footprints in strata of scale, aspect and orientation (docs/book/range_queries.md#the-sweep).

use bevy_plumage::maths::query::{Cell, Local};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

/// One case of the sweep.
pub struct Case {
    pub cell: Cell<f64>,
    pub local: Local<f64>,
    /// Stratum of the major axis, 0..8: 0.01 p_bl to 10 p_b.
    pub scale: usize,
    /// Stratum of the aspect ratio, 0..5: round, then doubling to 16.
    pub aspect: usize,
}

/// A random number in `low..high`.
pub fn between(random: &mut Pcg64Mcg, low: f64, high: f64) -> f64 {
    low + (high - low) * random.random::<f64>()
}

/// A random vane's cell; `masked`: with unequal widths, shifts and windows as masking makes them.
/// Also returns d_bl over p_b and sin(alpha_bl).
pub fn random_cell(random: &mut Pcg64Mcg, masked: bool) -> (Cell<f64>, f64, f64) {
    let alpha_bl = between(random, 25.0, 60.0).to_radians();
    let alpha_b = between(random, 15.0, 70.0).to_radians();
    let ratio = (between(random, 2f64.ln(), 30f64.ln())).exp();
    let kappa = ratio / alpha_bl.tan();
    let e_root = ratio / alpha_b.tan();
    let e_root = e_root - e_root.round();
    let r = between(random, 0.02, 0.2);
    let h = between(random, 0.12, 0.46);
    let mut cell = Cell {
        kappa,
        e_root,
        v_low: r,
        v_high: 1.0 - r,
        h_d: h,
        h_p: h,
        s_d: 0.0,
        s_p: 0.0,
        side: 1.0,
    };
    if masked {
        cell.h_d = between(random, 0.1, 0.49);
        cell.h_p = between(random, 0.1, 0.49);
        let open = between(random, 0.1, 0.95);
        cell.v_low = between(random, 0.0, 1.0 - open);
        cell.v_high = cell.v_low + open;
        cell.s_d = between(random, -0.5, 0.5);
        cell.s_p = between(random, -0.5, 0.5);
    }
    (cell, 1.0 / ratio, alpha_bl.sin())
}

/// A footprint in cell units from its axes (standard deviations, unit p_b) and the direction of the major one from s.
pub fn local(u: f64, tau: f64, major: f64, minor: f64, angle: f64, spacing: f64) -> Local<f64> {
    let (sin, cos) = angle.sin_cos();
    let (a, b) = (major * major, minor * minor);
    let ss = a * cos * cos + b * sin * sin;
    let st = (a - b) * cos * sin;
    Local {
        u,
        tau,
        variance: ss.max(1e-10),
        slope: st / ss / spacing,
        conditional: (a * b / ss / (spacing * spacing)).max(1e-8),
    }
}

/// `count` cases.
pub fn cases(random: &mut Pcg64Mcg, count: usize, masked: bool) -> Vec<Case> {
    (0..count)
        .map(|i| {
            let (cell, spacing, sin_bl) = random_cell(random, masked);
            let scale = i % 8;
            let aspect = (i / 8) % 5;
            let least = (0.01 * spacing * sin_bl).ln();
            let most = 10f64.ln();
            let major =
                (least + (most - least) * (scale as f64 + random.random::<f64>()) / 8.0).exp();
            let ratio = if aspect == 0 {
                1.0
            } else {
                2f64.powf(aspect as f64 - random.random::<f64>())
            };
            let angle = if random.random::<f64>() < 0.5 {
                between(random, 0.0, std::f64::consts::PI)
            } else {
                let alpha_bl = sin_bl.asin();
                let along = std::f64::consts::FRAC_PI_2;
                [along, 0.0, along - alpha_bl, along + alpha_bl][random.random_range(0..4)]
                    + between(random, -0.02, 0.02)
            };
            let u = random.random::<f64>();
            let tau = between(random, -0.5, 0.5);
            Case {
                cell,
                local: local(u, tau, major, major / ratio, angle, spacing),
                scale,
                aspect,
            }
        })
        .collect()
}

/// The cell in single precision.
pub fn cell_f32(c: &Cell<f64>) -> Cell<f32> {
    let [kappa, e_root, v_low, v_high, h_d, h_p, s_d, s_p, side] = [
        c.kappa, c.e_root, c.v_low, c.v_high, c.h_d, c.h_p, c.s_d, c.s_p, c.side,
    ]
    .map(|x| x as f32);
    Cell {
        kappa,
        e_root,
        v_low,
        v_high,
        h_d,
        h_p,
        s_d,
        s_p,
        side,
    }
}

/// The footprint in single precision.
pub fn local_f32(l: &Local<f64>) -> Local<f32> {
    let [u, tau, variance, slope, conditional] =
        [l.u, l.tau, l.variance, l.slope, l.conditional].map(|x| x as f32);
    Local {
        u,
        tau,
        variance,
        slope,
        conditional,
    }
}

/// Root mean square, 99th percentile and maximum.
pub fn statistics(errors: &[f64]) -> [f64; 3] {
    let mut sorted = errors.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len().max(1);
    let rms = (sorted.iter().map(|e| e * e).sum::<f64>() / n as f64).sqrt();
    let p99 = sorted
        .get((n * 99 / 100).min(n - 1))
        .copied()
        .unwrap_or(0.0);
    [rms, p99, sorted.last().copied().unwrap_or(0.0)]
}

/// Largest difference of three coverages; infinite where one is not a number.
pub fn difference(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter()
        .zip(&b)
        .map(|(x, y)| (x - y).abs())
        .fold(
            0.0,
            |m: f64, e| if e.is_nan() { f64::INFINITY } else { m.max(e) },
        )
}
