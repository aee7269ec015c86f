//! Shadows between the fibres of a vane: which share of a fibre that the eye sees is reached by a light.
//!
//! Masking seen from the light. Fibres lie in three storeys as rays find them in [`crate::curves`]: distal barbules rest on
//! proximal ones, a barb stands out of both. What the eye sees of the lower barbules it sees through the gaps of the upper ones;
//! whether the light comes through the same gap is the overlap of two gratings, one shifted against the other by the parallax of
//! the storeys and blurred by the width of the fibre between them: a Fourier series of which three terms are kept. Compared with
//! traced shadows by a test; the scattering study (6.3) has fibres shade neighbours of their own family alone.

use super::{
    math::{Real, clamp},
    vane::Vane,
};

/// Terms of the overlap of two gratings.
const RIPPLES: usize = 3;
/// Least `|direction . normal|`.
const LEAST_FACING: f64 = 1e-3;

/// How a direction, the eye's or a light's, lies to the storeys of a vane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VaneSight<T> {
    /// Cosine to the front normal.
    pub facing: T,
    /// Gap between two barbs at the height of the storey that is nearer to this direction: ends in barb periods.
    pub near_gap: [T; 2],
    /// The same at the farther storey.
    pub far_gap: [T; 2],
    /// Share of the width of shaft and barb that the fibres beside them leave open, 0..1.
    pub open: [T; 2],
    /// Width over period of the barbules that the eye sees above, and of those below; above 1 they shade each other.
    pub wide: [T; 2],
    /// Where the upper barbules are projected on the axis of the lower, in their periods.
    pub shift: T,
    /// Amplitudes of the upper grating's shadow on a lower barbule.
    pub ripples: [T; RIPPLES],
}

/// `sin(x) / x`.
fn sinc<T: Real>(x: T) -> T {
    if x.abs() < T::of(1e-3) {
        return T::one() - x * x / T::of(6.0);
    }
    x.sin() / x
}

/// Describes `direction` (canonical frame of the left vane: x, y, front normal; unit). `hooked`: breadth over height of the
/// barbules, 0..1; loose ones stand on edge. `distal_above`: the eye sees the front, so distal barbules lie over proximal ones; the
/// same for the eye and every light.
pub fn vane_sight<T: Real>(
    vane: &Vane<T>,
    hooked: T,
    direction: [T; 3],
    distal_above: bool,
) -> VaneSight<T> {
    let (zero, one, half) = (T::zero(), T::one(), T::of(0.5));
    let [x, y, facing] = direction;
    let n = facing.abs().max(T::of(LEAST_FACING));
    let (s, t) = (
        x * vane.cos_b + y * vane.sin_b,
        y * vane.cos_b - x * vane.sin_b,
    );
    // Distance of the two storeys of barbules; the lit side of a fibre is above its axis.
    let storey = vane.r_bd + vane.r_bp;
    let lift = half * storey;
    let lit = half * lift;
    let slope = s.abs() / n;
    let long = vane.r_b * (one + slope * slope).sqrt();
    // Barbs, cut off at a height.
    let gap = |height: T| {
        let far = (long - height * slope).max(vane.r_b);
        let [below, above] = if s > zero {
            [far, vane.r_b]
        } else {
            [vane.r_b, far]
        };
        let low = above / vane.p_b;
        [low, (one - below / vane.p_b).max(low)]
    };
    let barb_above = |height: T| {
        let [low, high] = gap(height);
        ((one - (high - low)) * vane.p_b / (long + long).max(T::of(1e-9))).min(one)
    };
    // Normals of the barbules in (s, t), their axes, and the direction in these.
    let (c, b) = (vane.cos_bl, vane.sin_bl);
    let (distal, proximal) = (s * c - t * b, s * c + t * b);
    let (upper, lower, upper_radius, lower_radius) = if distal_above {
        (distal, proximal, vane.r_bd, vane.r_bp)
    } else {
        (proximal, distal, vane.r_bp, vane.r_bd)
    };
    let period = vane.p_bl().max(T::of(1e-9));
    let wide = |across: T, radius: T| {
        let slope = across / n;
        (radius + radius) * (hooked * hooked + slope * slope).sqrt() / period
    };
    let wide = [wide(upper, upper_radius), wide(lower, lower_radius)];
    let stacked = if (facing >= zero) == distal_above {
        wide
    } else {
        [wide[1], wide[0]]
    };
    let [first, second] = stacked.map(|w| w.min(one));
    let barb = first * barb_above(lift + lit + lit)
        + (one - first) * (second * barb_above(lit + lit - lift) + one - second);
    let rachis = half + half * (n / (one - y * y).max(n * n).sqrt()).min(one);
    // The lower fibre's lit side in periods of the upper grating: its middle, and half its breadth.
    let cosine = c * c - b * b;
    let sine = T::of(2.0) * c * b;
    let length = (lower * lower + n * n).sqrt();
    let along = if distal_above {
        s * b - t * c
    } else {
        s * b + t * c
    };
    let middle = T::of(std::f64::consts::FRAC_PI_4) * lower_radius * along * sine / length;
    let breadth = lower_radius / period * (hooked * cosine * n + lower * upper / n).abs() / length;
    let half_width = (half * wide[0]).min(half);
    let ripples = std::array::from_fn(|k| {
        let w = T::of(std::f64::consts::TAU * (k + 1) as f64);
        T::of(2.0) * half_width * sinc(w * half_width) * sinc(w * breadth)
    });
    VaneSight {
        facing,
        near_gap: gap(lift + lit),
        far_gap: gap(lit - lift),
        open: [rachis, barb],
        wide,
        shift: (storey * upper / n - middle) / period,
        ripples,
    }
}

/// Shares of rachis, barbs, distal and proximal barbules that the light reaches of what the eye sees, 0..1 each.
pub fn vane_shadow<T: Real>(
    eye: &VaneSight<T>,
    light: &VaneSight<T>,
    distal_above: bool,
) -> [T; 4] {
    let (zero, one, two) = (T::zero(), T::one(), T::of(2.0));
    let together = |a: [T; 2], b: [T; 2]| {
        let both = a[1].min(b[1]) - a[0].max(b[0]);
        clamp(both / (a[1] - a[0]).max(T::of(1e-6)), zero, one)
    };
    let own = |wide: T| one / wide.max(one);
    let same_side = (eye.facing >= zero) == (light.facing >= zero);
    let (upper, lower) = if same_side {
        let [closed, shaded] = [eye, light].map(|sight| sight.wide[0].min(one));
        // cos of the multiples of one angle.
        let first = (T::of(std::f64::consts::TAU) * (light.shift - eye.shift)).cos();
        let second = two * first * first - one;
        let cosines: [T; RIPPLES] = [first, second, two * first * second - first];
        let mut both = (one - closed) * (one - shaded);
        for (k, cosine) in cosines.into_iter().enumerate() {
            both = both + two * eye.ripples[k] * light.ripples[k] * cosine;
        }
        let through = clamp(both / (one - closed).max(T::of(1e-3)), zero, one);
        (
            own(light.wide[0]) * together(eye.near_gap, light.near_gap),
            own(light.wide[1]) * through * together(eye.far_gap, light.far_gap),
        )
    } else {
        let through = (one - light.wide[1]).max(zero);
        (
            own(light.wide[0]) * through * together(eye.near_gap, light.far_gap),
            own(light.wide[1]) * together(eye.far_gap, light.near_gap),
        )
    };
    let [rachis, barb] = light.open;
    if distal_above {
        [rachis, barb, upper, lower]
    } else {
        [rachis, barb, lower, upper]
    }
}

/// Mean of [`vane_shadow`] over light from the eye's side and from the other, for an eye on the normal: what a fibre keeps of light
/// from all around, each direction counted by the fibre's breadth towards it. `fronts`: does the eye see the front?
pub fn mean_shadow(vane: &Vane<f64>, fronts: bool) -> [[f64; 4]; 2] {
    const DIRECTIONS: usize = 512;
    let towards = if fronts { 1.0 } else { -1.0 };
    let eye = vane_sight(vane, 1.0, [0.0, 0.0, towards], fronts);
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let (c, s) = (vane.cos_bl, vane.sin_bl);
    let mut sums = [[[0.0; 2]; 4]; 2];
    for i in 0..DIRECTIONS {
        let z = 1.0 - 2.0 * (i as f64 + 0.5) / DIRECTIONS as f64;
        let r = (1.0 - z * z).sqrt();
        let (sin, cos) = (golden * i as f64).sin_cos();
        let d = [r * cos, r * sin, z];
        let seen = vane_shadow(&eye, &vane_sight(vane, 1.0, d, fronts), fronts);
        let (across, along) = (
            d[0] * vane.cos_b + d[1] * vane.sin_b,
            d[1] * vane.cos_b - d[0] * vane.sin_b,
        );
        // Cosines to the fibres' axes.
        let axes = [d[1], along, across * s + along * c, along * c - across * s];
        let side = &mut sums[usize::from((z > 0.0) != fronts)];
        for part in 0..4 {
            let breadth = (1.0 - axes[part] * axes[part]).max(0.0).sqrt();
            side[part][0] += breadth * seen[part];
            side[part][1] += breadth;
        }
    }
    sums.map(|side| side.map(|[sum, weight]| sum / weight.max(1e-12)))
}
