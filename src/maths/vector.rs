//! Vectors of three components in either precision.

use super::Real;

pub fn add<T: Real>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub fn sub<T: Real>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub fn scale<T: Real>(a: [T; 3], s: T) -> [T; 3] {
    a.map(|x| x * s)
}

pub fn dot<T: Real>(a: [T; 3], b: [T; 3]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn cross<T: Real>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// Unit length; `fallback` where there is none.
pub fn normalize<T: Real>(a: [T; 3], fallback: [T; 3]) -> [T; 3] {
    let length = dot(a, a).sqrt();
    if length > T::of(1e-18) && length.is_finite() {
        scale(a, T::one() / length)
    } else {
        fallback
    }
}

pub fn of<T: Real>(a: [f32; 3]) -> [T; 3] {
    a.map(|x| T::of(f64::from(x)))
}
