#define_import_path bevy_plumage::math

// Functions of one variable that the range query is made of. Twin of src/maths/functions.rs, where the comments are.

const PI: f32 = 3.14159265358979;

// What `staircase` needs of a variance: 1 / sqrt(2 v) for narrow ones (else 0), first Fourier damping for wide ones (else 0).
struct Width {
    sharp: f32,
    damping: f32,
}

// Hermite step from 0 at `low` to 1 at `high`; a plain step where they meet.
fn smooth_step(low: f32, high: f32, x: f32) -> f32 {
    let t = clamp((x - low) / max(high - low, 1e-6), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

// `x` minus the nearest integer, in [-1/2, 1/2).
fn wrap(x: f32) -> f32 {
    return x - floor(x + 0.5);
}

// sin(2 pi x), by a polynomial: the precision of the built-in is not specified well enough.
fn sine_turns(x: f32) -> f32 {
    let y = wrap(x);
    var f = y;
    if y > 0.25 {
        f = 0.5 - y;
    } else if y < -0.25 {
        f = -0.5 - y;
    }
    let z = f * f;
    return f * (6.2831853 + z * (-41.341702 + z * (81.60525 + z * (-76.70586 + z * (42.05869 + z * -15.094643)))));
}

// cos(2 pi x).
fn cosine_turns(x: f32) -> f32 {
    return sine_turns(x + 0.25);
}

// Arc sine of `x` in [0, 1] (Abramowitz and Stegun 4.4.46).
fn arc_sine(x: f32) -> f32 {
    var p = -0.0012624911 * x + 0.0066700901;
    p = ((p * x - 0.0170881256) * x + 0.030891881) * x - 0.0501743046;
    p = ((p * x + 0.0889789874) * x - 0.2145988016) * x + 1.570796305;
    return 1.57079633 - sqrt(max(1.0 - x, 0.0)) * p;
}

// Error function, Abramowitz and Stegun 7.1.26, absolute error below 1.5e-7 plus rounding.
fn error_function(x: f32) -> f32 {
    let a = abs(x);
    let t = 1.0 / (1.0 + 0.3275911 * a);
    let p = ((((1.061405429 * t - 1.453152027) * t + 1.421413741) * t - 0.284496736) * t + 0.254829592) * t;
    let y = 1.0 - p * exp(-a * a);
    return select(y, -y, x < 0.0);
}

// Standard normal density.
fn normal_density(z: f32) -> f32 {
    return 0.39894228 * exp(-0.5 * z * z);
}

// Standard normal distribution function.
fn normal_distribution(z: f32) -> f32 {
    return 0.5 + 0.5 * error_function(z * 0.70710678);
}

// The same within 2e-5, for shares of a footprint.
fn normal_share(z: f32) -> f32 {
    let x = clamp(z, -8.0, 8.0);
    let s = x * x;
    return 1.0 / (1.0 + exp2(x * (-2.30172713 + s * (-0.106177326 + s * 0.000911244969))));
}

// Prepares a variance (period squared, > 0) for `staircase`.
fn width(variance: f32) -> Width {
    if variance < 0.0145 {
        let v = max(variance, 1e-12);
        return Width(1.0 / sqrt(v + v), 0.0);
    }
    return Width(0.0, select(0.0, exp(-19.7392088 * min(variance, 0.5)), variance <= 0.42));
}

// Integral of a wrapped Gaussian: the mass of all intervals [p + j, q + j] is staircase(q) - staircase(p).
fn staircase(x: f32, w: Width) -> f32 {
    if w.sharp > 0.0 {
        let n = floor(x + 0.5);
        return n + 0.5 * error_function((x - n) * w.sharp);
    }
    if w.damping <= 0.0 {
        return x;
    }
    let q = w.damping;
    let s = sine_turns(x);
    let c = 2.0 * cosine_turns(x);
    let d = q * q;
    let e = d * d;
    let g = e * e;
    let sum = q + e * c * 0.5 + g * q * (c * c - 1.0) * (1.0 / 3.0) + g * g * c * (c * c - 2.0) * 0.25;
    return x + s * (1.0 / PI) * sum;
}

// First, second and third derivative of `staircase`.
fn staircase_derivatives(x: f32, w: Width) -> vec3<f32> {
    if w.sharp > 0.0 {
        let y = (x - floor(x + 0.5)) * w.sharp;
        let density = 0.56418958 * w.sharp * exp(-y * y);
        return density * vec3(1.0, -2.0 * y * w.sharp, (4.0 * y * y - 2.0) * w.sharp * w.sharp);
    }
    if w.damping <= 0.0 {
        return vec3(1.0, 0.0, 0.0);
    }
    let q = w.damping;
    let s = sine_turns(x);
    let c = 2.0 * cosine_turns(x);
    let r = c * c;
    let d = q * q;
    let e = d * d;
    let g = e * e;
    let first = 1.0 + q * c + e * (r - 2.0) + g * q * c * (r - 3.0) + g * g * (r * r - 4.0 * r + 2.0);
    let second = -4.0 * PI * s * (q + 2.0 * e * c + 3.0 * g * q * (r - 1.0) + 4.0 * g * g * c * (r - 2.0));
    let third = -4.0 * PI * PI
        * (q * c + 4.0 * e * (r - 2.0) + 9.0 * g * q * c * (r - 3.0) + 16.0 * g * g * (r * r - 4.0 * r + 2.0));
    return vec3(first, second, third);
}

// Phases at which two trains of half widths h_d, h_p begin and stop overlapping, in [0, 1): x + e, x - e, x + g, x - g.
fn corners(x: f32, h_d: f32, h_p: f32) -> vec4<f32> {
    let e = h_d - h_p;
    let g = h_d + h_p;
    return fract(vec4(x + e, x - e, x + g, x - g));
}

// Sum over the corners with the signs + + - -.
fn corner_sum(f: vec4<f32>) -> f32 {
    return f.x + f.y - f.z - f.w;
}

// Length of the overlap of two trains of arcs on a circle of length 1 whose centres are `x` apart.
fn overlap(x: f32, h_d: f32, h_p: f32) -> f32 {
    let y = corners(x, h_d, h_p);
    return 4.0 * h_d * h_p + 0.5 * corner_sum(y * (y - 1.0));
}

// Zero-mean integral of `overlap` minus its mean.
fn overlap_integral(x: f32, h_d: f32, h_p: f32) -> f32 {
    let y = corners(x, h_d, h_p) - 0.5;
    return (1.0 / 6.0) * corner_sum(y * (y * y - 0.25));
}

// Zero-mean integral of `overlap_integral`.
fn overlap_second_integral(x: f32, h_d: f32, h_p: f32) -> f32 {
    let y = corners(x, h_d, h_p);
    let z = y * (y - 1.0);
    return (1.0 / 24.0) * corner_sum(z * z);
}

// Zero-mean integral of `overlap_second_integral`.
fn overlap_third_integral(x: f32, h_d: f32, h_p: f32) -> f32 {
    let y = corners(x, h_d, h_p);
    let z = y * (y - 1.0);
    return (1.0 / 120.0) * corner_sum(z * (y - 0.5) * (z - 1.0 / 3.0));
}

// max(y, 0) averaged over a box of half width `w` around `y`.
fn smooth_positive(y: f32, w: f32) -> f32 {
    if y >= w {
        return y;
    }
    if y <= -w {
        return 0.0;
    }
    return (y + w) * (y + w) / (4.0 * w);
}
