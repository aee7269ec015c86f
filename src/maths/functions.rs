//! Functions of one variable that the evaluators are made of. Twin of `math.wgsl`.

use num_traits::Float;

/// `f32` or `f64`.
pub trait Real: Float {
    /// The nearest value to a literal.
    fn of(x: f64) -> Self;
}

/// A constant in the working precision.
#[inline]
pub fn real<T: Real>(value: f64) -> T {
    T::of(value)
}

impl Real for f32 {
    fn of(x: f64) -> Self {
        x as f32
    }
}

impl Real for f64 {
    fn of(x: f64) -> Self {
        x
    }
}

/// `x` between `low` and `high`; `low` for a NaN.
pub fn clamp<T: Real>(x: T, low: T, high: T) -> T {
    x.max(low).min(high)
}

/// Hermite step from 0 at `low` to 1 at `high`; a plain step where they meet.
pub fn smooth_step<T: Real>(low: T, high: T, x: T) -> T {
    let t = clamp(
        (x - low) / (high - low).max(T::of(1e-6)),
        T::zero(),
        T::one(),
    );
    t * t * (T::of(3.0) - T::of(2.0) * t)
}

/// Fractional part, in [0, 1).
pub fn fraction<T: Real>(x: T) -> T {
    x - x.floor()
}

/// `x` minus the nearest integer, in [-1/2, 1/2).
pub fn wrap<T: Real>(x: T) -> T {
    x - (x + T::of(0.5)).floor()
}

/// `sin(2 pi x)`. Error 6e-8 before rounding: a polynomial, because the precision of a GPU's own sine is not specified well enough
/// for both sides to agree.
pub fn sine_turns<T: Real>(x: T) -> T {
    // Fold into a quarter turn either side of zero, where the series to degree eleven is enough.
    let y = wrap(x);
    let half = T::of(0.5);
    let f = if y > T::of(0.25) {
        half - y
    } else if y < T::of(-0.25) {
        -half - y
    } else {
        y
    };
    let z = f * f;
    f * (T::of(core::f64::consts::TAU)
        + z * (T::of(-41.341_702)
            + z * (T::of(81.605_25)
                + z * (T::of(-76.705_86) + z * (T::of(42.058_69) + z * T::of(-15.094_643))))))
}

/// `cos(2 pi x)`, likewise.
pub fn cosine_turns<T: Real>(x: T) -> T {
    sine_turns(x + T::of(0.25))
}

/// Arc sine of `x` in [0, 1], radians (Abramowitz and Stegun 4.4.46), absolute error 2e-8 before rounding.
pub fn arc_sine<T: Real>(x: T) -> T {
    let p = [
        -0.001_262_491_1,
        0.006_670_090_1,
        -0.017_088_125_6,
        0.030_891_881,
        -0.050_174_304_6,
        0.088_978_987_4,
        -0.214_598_801_6,
        1.570_796_305,
    ]
    .into_iter()
    .fold(T::zero(), |sum, c| sum * x + T::of(c));
    T::of(core::f64::consts::FRAC_PI_2) - (T::one() - x).max(T::zero()).sqrt() * p
}

/// Error function (Abramowitz and Stegun 7.1.26), absolute error below 1.5e-7.
pub fn error_function<T: Real>(x: T) -> T {
    let a = x.abs();
    let t = T::one() / (T::one() + T::of(0.327_591_1) * a);
    let p = ((((T::of(1.061_405_429) * t - T::of(1.453_152_027)) * t + T::of(1.421_413_741)) * t
        - T::of(0.284_496_736))
        * t
        + T::of(0.254_829_592))
        * t;
    let y = T::one() - p * (-a * a).exp();
    if x < T::zero() { -y } else { y }
}

/// Standard normal density.
pub fn normal_density<T: Real>(z: T) -> T {
    T::of(0.398_942_28) * (T::of(-0.5) * z * z).exp()
}

/// Standard normal distribution function.
pub fn normal_distribution<T: Real>(z: T) -> T {
    T::of(0.5) + T::of(0.5) * error_function(z * T::of(core::f64::consts::FRAC_1_SQRT_2))
}

/// [`normal_distribution`] within 2e-5, for shares of a footprint: a logistic function of an odd polynomial
/// (docs/book/fits/special_functions.py). `normal_share(-z)` completes it to 1.
pub fn normal_share<T: Real>(z: T) -> T {
    let x = clamp(z, T::of(-8.0), T::of(8.0));
    let s = x * x;
    let power =
        x * (T::of(-2.301_727_13) + s * (T::of(-0.106_177_326) + s * T::of(0.000_911_244_969)));
    T::one() / (T::one() + power.exp2())
}

/// What [`staircase`] needs of a variance, computed once per width.
#[derive(Clone, Copy, Debug)]
pub struct Width<T> {
    /// `1 / sqrt(2 v)` where the nearest step alone matters, else 0.
    pub sharp: T,
    /// First Fourier damping `exp(-2 pi^2 v)`; 0 where nothing is left of it.
    pub damping: T,
}

/// Largest variance for which the nearest step alone is used: error of either side of the seam below 6e-5
/// (docs/book/fits/special_functions.py).
const SHARP_VARIANCE: f64 = 0.0145;
/// Variance from which the staircase is a straight line within 8e-5.
const FLAT_VARIANCE: f64 = 0.42;

/// Prepares a variance (unit: period squared, > 0) for [`staircase`].
pub fn width<T: Real>(variance: T) -> Width<T> {
    if variance < T::of(SHARP_VARIANCE) {
        let v = variance.max(T::of(1e-12));
        Width {
            sharp: T::one() / (v + v).sqrt(),
            damping: T::zero(),
        }
    } else if variance <= T::of(FLAT_VARIANCE) {
        Width {
            sharp: T::zero(),
            damping: (T::of(-19.739_208_8) * variance).exp(),
        }
    } else {
        Width {
            sharp: T::zero(),
            damping: T::zero(),
        }
    }
}

/// Smoothed staircase: the integral of a Gaussian of variance `v` and mean 0, wrapped on a circle of length 1, extended by
/// `staircase(x + 1) = staircase(x) + 1`. The mass of all intervals `[p + j, q + j]` is `staircase(q) - staircase(p)`.
pub fn staircase<T: Real>(x: T, w: Width<T>) -> T {
    if w.sharp > T::zero() {
        let n = (x + T::of(0.5)).floor();
        return n + T::of(0.5) * error_function((x - n) * w.sharp);
    }
    if w.damping <= T::zero() {
        return x;
    }
    let q = w.damping;
    let s = sine_turns(x);
    let c = T::of(2.0) * cosine_turns(x);
    let d = q * q;
    let e = d * d;
    let g = e * e;
    let sum = q
        + e * c * T::of(0.5)
        + g * q * (c * c - T::one()) * T::of(1.0 / 3.0)
        + g * g * c * (c * c - T::of(2.0)) * T::of(0.25);
    x + s * T::of(core::f64::consts::FRAC_1_PI) * sum
}

/// First, second and third derivative of [`staircase`].
pub fn staircase_derivatives<T: Real>(x: T, w: Width<T>) -> [T; 3] {
    if w.sharp > T::zero() {
        let y = (x - (x + T::of(0.5)).floor()) * w.sharp;
        let density = T::of(0.564_189_58) * w.sharp * (-y * y).exp();
        let third = (T::of(4.0) * y * y - T::of(2.0)) * w.sharp * w.sharp * density;
        return [density, T::of(-2.0) * y * w.sharp * density, third];
    }
    if w.damping <= T::zero() {
        return [T::one(), T::zero(), T::zero()];
    }
    let q = w.damping;
    let s = sine_turns(x);
    let c = T::of(2.0) * cosine_turns(x);
    let r = c * c;
    let d = q * q;
    let e = d * d;
    let g = e * e;
    let first = T::one()
        + q * c
        + e * (r - T::of(2.0))
        + g * q * c * (r - T::of(3.0))
        + g * g * (r * r - T::of(4.0) * r + T::of(2.0));
    let second = T::of(-4.0 * core::f64::consts::PI)
        * s
        * (q + T::of(2.0) * e * c
            + T::of(3.0) * g * q * (r - T::one())
            + T::of(4.0) * g * g * c * (r - T::of(2.0)));
    let third = T::of(-4.0 * core::f64::consts::PI * core::f64::consts::PI)
        * (q * c
            + T::of(4.0) * e * (r - T::of(2.0))
            + T::of(9.0) * g * q * c * (r - T::of(3.0))
            + T::of(16.0) * g * g * (r * r - T::of(4.0) * r + T::of(2.0)));
    [first, second, third]
}

/// The four phases at which two trains of half widths `h_d`, `h_p` begin and stop overlapping: `f(x+e)+f(x-e)-f(x+g)-f(x-g)`.
fn corners<T: Real>(x: T, h_d: T, h_p: T, f: impl Fn(T) -> T) -> T {
    let e = h_d - h_p;
    let g = h_d + h_p;
    f(fraction(x + e)) + f(fraction(x - e)) - f(fraction(x + g)) - f(fraction(x - g))
}

/// Length of the overlap of two trains of arcs on a circle of length 1 (half widths `h_d`, `h_p` in 0..1/2) whose centres are
/// `x` apart: their autocorrelation series, summed through Bernoulli polynomials.
pub fn overlap<T: Real>(x: T, h_d: T, h_p: T) -> T {
    T::of(4.0) * h_d * h_p + T::of(0.5) * corners(x, h_d, h_p, |y| y * (y - T::one()))
}

/// Zero-mean integral of [`overlap`] minus its mean.
pub fn overlap_integral<T: Real>(x: T, h_d: T, h_p: T) -> T {
    let cubic = |y: T| {
        let y = y - T::of(0.5);
        y * (y * y - T::of(0.25))
    };
    T::of(1.0 / 6.0) * corners(x, h_d, h_p, cubic)
}

/// Zero-mean integral of [`overlap_integral`].
pub fn overlap_second_integral<T: Real>(x: T, h_d: T, h_p: T) -> T {
    T::of(1.0 / 24.0) * corners(x, h_d, h_p, |y| (y * (y - T::one())) * (y * (y - T::one())))
}

/// Zero-mean integral of [`overlap_second_integral`].
pub fn overlap_third_integral<T: Real>(x: T, h_d: T, h_p: T) -> T {
    T::of(1.0 / 120.0)
        * corners(x, h_d, h_p, |y| {
            let z = y * (y - T::one());
            z * (y - T::of(0.5)) * (z - T::of(1.0 / 3.0))
        })
}

/// `max(y, 0)` averaged over a box of half width `w` around `y`.
pub fn smooth_positive<T: Real>(y: T, w: T) -> T {
    if y >= w {
        y
    } else if y <= -w {
        T::zero()
    } else {
        (y + w) * (y + w) / (T::of(4.0) * w)
    }
}
