//! A feather as plain geometry: every fibre where it lies in the canonical plane, asked point by point. Shares no code with the
//! evaluators, and is what Monte Carlo and dense sampling average.

use super::sweep::between;
use bevy_plumage::maths::query::{Component, Vane, barb_strip, storeys, vane_shape};
use rand_pcg::Pcg64Mcg;

/// One vane by the numbers of Table 1 of Chen et al. 2026; lengths in feather lengths, angles in radians.
#[derive(Clone, Copy, Debug)]
pub struct PlainVane {
    /// N_b, barbs per feather length of rachis.
    pub barb_count: f64,
    /// Angle of the barbs to the rachis.
    pub alpha_b: f64,
    /// Angle of the barbules to the barb.
    pub alpha_bl: f64,
    /// Distance of neighboring barbules along the barb.
    pub spacing: f64,
    /// Barb, distal barbule, proximal barbule.
    pub radii: [f64; 3],
}

impl PlainVane {
    /// A vane with everything drawn at random.
    pub fn random(random: &mut Pcg64Mcg) -> Self {
        let barb_count = between(random, 80.0, 400.0);
        let alpha_b = between(random, 20.0, 70.0).to_radians();
        let alpha_bl = between(random, 20.0, 65.0).to_radians();
        let p_b = alpha_b.sin() / barb_count;
        let spacing = p_b / between(random, 2.0, 15.0);
        let radii = [
            p_b * between(random, 0.03, 0.2),
            spacing * between(random, 0.05, 0.3),
            spacing * between(random, 0.05, 0.3),
        ];
        Self {
            barb_count,
            alpha_b,
            alpha_bl,
            spacing,
            radii,
        }
    }

    /// What the evaluators are told.
    pub fn vane(&self) -> Vane<f64> {
        let [b, d, p] = self.radii;
        let p_b = self.alpha_b.sin() / self.barb_count;
        Vane::new(p_b, self.spacing, self.alpha_b, self.alpha_bl, b, d, p)
    }

    /// What lies at a point of the left vane (x < 0) seen along `view` (towards the eye), and how far from its middle, -1..1.
    pub fn hit(&self, point: [f64; 2], view: [f64; 3]) -> (Component, f64) {
        let normal = |angle: f64| [angle.cos(), angle.sin()];
        let n_b = normal(self.alpha_b);
        let s = point[0] * n_b[0] + point[1] * n_b[1];
        let p_b = self.alpha_b.sin() / self.barb_count;
        // How wide the strips are is not this module's business, but where they lie is.
        let vane = self.vane();
        let length = view.iter().map(|x| x * x).sum::<f64>().sqrt();
        let shape = vane_shape(&vane);
        let seen = storeys(&shape, view.map(|x| x / length));
        let strip = barb_strip(&shape, &seen);
        let far = seen.silhouette.min(strip.width).min(p_b);
        let middle = (far - 0.5 * strip.width) * -seen.slope.signum();
        let nearest = (s / p_b).round() as i64;
        for k in [0, -1, 1].map(|o| nearest + o) {
            let root = [0.0, k as f64 / self.barb_count];
            if let Some(h) = on_fibre(point, root, n_b, [0.5 * strip.width, middle], None) {
                return (Component::Barb, h);
            }
        }
        let below = (s / p_b).floor();
        let period = self.spacing * self.alpha_bl.sin();
        let lift = 0.5 * (self.radii[1] + self.radii[2]);
        let upper_is_distal = view[2] >= 0.0;
        let family = |k: f64, angle: f64, height: f64, distal: bool| {
            let root = [0.0, k / self.barb_count];
            let n = normal(angle);
            let towards = view[0] * n[0] + view[1] * n[1];
            let share = if distal == upper_is_distal {
                strip.first
            } else {
                strip.second
            };
            // An axis above the plane is projected away from the eye.
            let strip = [0.5 * period * share, -height * towards / view[2]];
            on_fibre(point, root, n, strip, Some(period))
        };
        let distal = family(below, self.alpha_b - self.alpha_bl, lift, true);
        let proximal = family(below + 1.0, self.alpha_b + self.alpha_bl, -lift, false);
        let found = [(Component::Distal, distal), (Component::Proximal, proximal)];
        let order = if view[2] >= 0.0 { [0, 1] } else { [1, 0] };
        order
            .iter()
            .find_map(|i| found[*i].1.map(|h| (found[*i].0, h)))
            .unwrap_or((Component::None, 0.0))
    }
}

/// Strip that the shaft hides: half width and centre along its normal.
fn hidden_strip(radius: f64, towards: f64, view_n: f64) -> [f64; 2] {
    let t = towards.abs() / view_n.abs();
    let q = (1.0 + t * t).sqrt();
    [
        0.5 * radius * (1.0 + q),
        -towards.signum() * 0.5 * radius * (q - 1.0),
    ]
}

/// Signed distance from a fibre through `root` with unit normal `normal`, over its masked half width; `None` outside.
fn on_fibre(
    point: [f64; 2],
    root: [f64; 2],
    normal: [f64; 2],
    [half, centre]: [f64; 2],
    period: Option<f64>,
) -> Option<f64> {
    let half = half.min(period.map_or(f64::INFINITY, |p| 0.5 * p));
    let mut d = (point[0] - root[0]) * normal[0] + (point[1] - root[1]) * normal[1] - centre;
    if let Some(p) = period {
        d -= (d / p).round() * p;
    }
    (d.abs() < half).then_some(d / half)
}

/// A whole feather: two vanes, the shaft, and how far each barb reaches (`|x|` by its root's height; 0 below the vane).
pub struct PlainFeather<'a> {
    pub vanes: [PlainVane; 2],
    pub rachis_radius: f64,
    pub reach: &'a dyn Fn(bool, f64) -> f64,
}

impl PlainFeather<'_> {
    /// What lies at a point; `view` towards the eye.
    pub fn hit(&self, point: [f64; 2], view: [f64; 3]) -> Component {
        let [half, centre] = hidden_strip(self.rachis_radius, view[0], view[2]);
        if (point[0] - centre).abs() <= half {
            return Component::Rachis;
        }
        let right = point[0] > centre;
        let side = if right { -1.0 } else { 1.0 };
        let vane = &self.vanes[usize::from(right)];
        let mirrored = [side * point[0], point[1]];
        let root = point[1] + mirrored[0] / vane.alpha_b.tan();
        if -mirrored[0] > (self.reach)(right, root) {
            return Component::None;
        }
        vane.hit(mirrored, [side * view[0], view[1], view[2]]).0
    }
}

/// Shares of none, rachis, barb, distal, proximal over `count` low-discrepancy samples of a standard normal, each carried to
/// its point by `place`.
pub fn dense_shares(
    count: u32,
    place: impl Fn([f64; 2]) -> [f64; 2],
    hit: impl Fn([f64; 2]) -> Component,
) -> [f64; 5] {
    let mut counts = [0u32; 5];
    for i in 0..count {
        // Additive recurrence on the plastic number, then Box-Muller.
        let at = |step: f64| (0.5 + f64::from(i + 1) * step).fract();
        let (a, b) = (
            at(0.754_877_666_246_692_8).max(1e-12),
            at(0.569_840_290_998_053_3),
        );
        let r = (-2.0 * a.ln()).sqrt();
        let (sin, cos) = (std::f64::consts::TAU * b).sin_cos();
        counts[hit(place([r * cos, r * sin])) as usize] += 1;
    }
    counts.map(|n| f64::from(n) / f64::from(count))
}

/// Lower triangular root of a covariance.
pub fn covariance_root(c: [f64; 3]) -> [f64; 3] {
    let l = c[0].max(1e-30).sqrt();
    let m = c[1] / l;
    [l, m, (c[2] - m * m).max(0.0).sqrt()]
}
