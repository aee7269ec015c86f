//! The shape of one strand.

use crate::maths::functions::{Real, clamp, real};
use crate::maths::vector::{cross, dot};

/// Least cosine between the eye and the normal that a path is corrected for.
pub const LEAST_COSINE: f64 = 0.02;
/// Least segments of a drawn strand.
pub const LEAST_SEGMENTS: u32 = 2;
/// Most segments of a drawn strand.
pub const MOST_SEGMENTS: u32 = 12;
/// Least cosine between a strand's direction and the normal of the skin: it never grows into it.
const LEAST_RISE: f64 = 0.1;
/// Nodes and weights of the five-point Gauss rule on 0..1, for the length of a curve.
const NODES: [(f64, f64); 5] = [
    (0.046_910_077_030_668, 0.118_463_442_528_094_5),
    (0.230_765_344_947_158_5, 0.239_314_335_249_683_2),
    (0.5, 0.284_444_444_444_444_4),
    (0.769_234_655_052_841_5, 0.239_314_335_249_683_2),
    (0.953_089_922_969_332, 0.118_463_442_528_094_5),
];

/// How a strand leaves the skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrandShape<T> {
    /// Root, in the space of the mesh.
    pub root: [T; 3],
    /// Unit normal of the skin there.
    pub normal: [T; 3],
    /// Unit direction of the groom's lay, any direction that does not point into the skin.
    pub lay: [T; 3],
    /// How far the tip follows the lay: 0 stands up, 1 lies in it.
    pub bend: T,
    /// Length along the curve.
    pub length: T,
    /// Unit direction of gravity.
    pub gravity: [T; 3],
    /// Angle in radians that gravity turns the tip by.
    pub sag: T,
}

fn add<T: Real>(a: [T; 3], b: [T; 3], factor: T) -> [T; 3] {
    [
        a[0] + b[0] * factor,
        a[1] + b[1] * factor,
        a[2] + b[2] * factor,
    ]
}

fn unit_or<T: Real>(a: [T; 3], other: [T; 3]) -> [T; 3] {
    let length = dot(a, a).sqrt();
    if length > real(1e-6) {
        a.map(|x| x / length)
    } else {
        other
    }
}

/// Turns the unit vector `d` towards the unit vector `goal` by `angle`, no further than to the goal.
fn turn<T: Real>(d: [T; 3], goal: [T; 3], angle: T) -> [T; 3] {
    let cos = clamp(dot(d, goal), -T::one(), T::one());
    let across = add(goal, d, -cos);
    let sin = dot(across, across).sqrt();
    // Straight down already, or straight up, where no side is the nearer one.
    if sin < real(1e-4) || angle <= T::zero() {
        return d;
    }
    let angle = angle.min(sin.atan2(cos));
    let (s, c) = angle.sin_cos();
    add(d.map(|x| x * c), across, s / sin)
}

/// Direction of the strand at height `z` (0 to 1).
fn direction<T: Real>(shape: &StrandShape<T>, z: T) -> [T; 3] {
    let blend = clamp(shape.bend * z, T::zero(), T::one());
    let mixed = add(
        shape.normal.map(|x| x * (T::one() - blend)),
        shape.lay,
        blend,
    );
    let d = unit_or(mixed, shape.normal);
    let d = turn(d, shape.gravity, shape.sag * z * z);
    let rise = dot(d, shape.normal);
    let least = real::<T>(LEAST_RISE);
    if rise >= least {
        return d;
    }
    let along = unit_or(add(d, shape.normal, -rise), shape.normal);
    let flat = (T::one() - least * least).sqrt();
    unit_or(
        add(along.map(|x| x * flat), shape.normal, least),
        shape.normal,
    )
}

/// Control points of the strand's cubic Bezier curve; its length is `shape.length`.
pub fn strand_curve<T: Real>(shape: &StrandShape<T>) -> [[T; 3]; 4] {
    let third = real::<T>(1.0 / 3.0);
    let two = third + third;
    let zero = [T::zero(); 3];
    let middle = direction(shape, two).map(|x| x * two);
    let tip = add(middle, direction(shape, T::one()), third);
    let curve = [zero, shape.normal.map(|x| x * third), middle, tip];
    let length = NODES.iter().fold(T::zero(), |sum, (s, weight)| {
        let t = velocity(&curve, real(*s));
        sum + dot(t, t).sqrt() * real(*weight)
    });
    let scale = shape.length / length.max(real(1e-3));
    curve.map(|p| add(shape.root, p, scale))
}

/// Point of the curve at `s` in 0..=1.
pub fn strand_point<T: Real>(curve: &[[T; 3]; 4], s: T) -> [T; 3] {
    let r = T::one() - s;
    let three = real::<T>(3.0);
    let p = curve[0].map(|x| x * r * r * r);
    let p = add(p, curve[1], three * r * r * s);
    let p = add(p, curve[2], three * r * s * s);
    add(p, curve[3], s * s * s)
}

fn velocity<T: Real>(curve: &[[T; 3]; 4], s: T) -> [T; 3] {
    let r = T::one() - s;
    let three = real::<T>(3.0);
    let side = |i: usize| add(curve[i + 1], curve[i], -T::one());
    let v = side(0).map(|x| x * three * r * r);
    let v = add(v, side(1), real::<T>(6.0) * r * s);
    add(v, side(2), three * s * s)
}

/// Unit tangent of the curve at `s`, towards the tip; `fallback` for a curve without length.
pub fn strand_tangent<T: Real>(curve: &[[T; 3]; 4], s: T, fallback: [T; 3]) -> [T; 3] {
    unit_or(velocity(curve, s), fallback)
}

/// Segments for a strand of `pixels` on screen that may be `tolerance` pixels off: `bend` as in [`StrandShape`].
///
/// A chord is off by 0.42 bend / n^2 of the length: docs/book/fits/strand_chords.py.
pub fn strand_segments<T: Real>(bend: T, pixels: T, tolerance: T) -> T {
    let wanted = real::<T>(0.42) * bend.abs() * pixels.max(T::zero()) / tolerance.max(real(1e-3));
    clamp(
        wanted.sqrt().ceil(),
        real(f64::from(LEAST_SEGMENTS)),
        real(f64::from(MOST_SEGMENTS)),
    )
}

/// Radius at `s` from the root (0) to the tip (1) of a strand that is `root` wide at the root.
pub fn strand_radius<T: Real>(root: T, s: T) -> T {
    root * clamp(T::one() - s, T::zero(), T::one()).powf(real(0.7))
}

/// Opacity along the strand: the hair fades towards its tip as `exp(-fade s)`; 2 to 4 look soft.
pub fn strand_alpha<T: Real>(fade: T, s: T) -> T {
    (-(fade.max(T::zero()) * clamp(s, T::zero(), T::one()))).exp()
}

/// Light that the undercoat lets through to a point of a strand: `column` is the optical depth above it, straight up, and `cos`
/// the cosine between the light and the normal.
pub fn strand_shadow<T: Real>(column: T, cos: T) -> T {
    if cos <= T::zero() {
        return T::zero();
    }
    (-(column.max(T::zero()) / cos.max(real(LEAST_COSINE)))).exp()
}

/// Unit direction across a ribbon that faces the eye; `view` points from the strand to the eye. A strand seen end-on, whose
/// side is not defined, turns smoothly to `right`, the camera's own (the cross product below 0.05).
pub fn strand_side<T: Real>(tangent: [T; 3], view: [T; 3], right: [T; 3]) -> [T; 3] {
    let side = cross(tangent, view);
    let length = dot(side, side).sqrt();
    let share = clamp(length / real(0.05), T::zero(), T::one());
    if share >= T::one() {
        return side.map(|x| x / length);
    }
    // Whichever way `right` is nearer, so that the blend never passes through zero.
    let sign = if dot(side, right) < T::zero() {
        -T::one()
    } else {
        T::one()
    };
    let near = unit_or(side, right.map(|x| x * sign));
    let mixed = add(near.map(|x| x * share), right, sign * (T::one() - share));
    unit_or(mixed, right)
}

/// What is drawn of a strand that is narrower than a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ribbon<T> {
    /// Half width in the units of the radius.
    pub half_width: T,
    /// Factor of the opacity that keeps the covered area.
    pub coverage: T,
}

/// Half width and coverage of a ribbon of `radius`, where one pixel is `pixel` wide: never narrower than a pixel, and then as much
/// more transparent.
pub fn strand_ribbon<T: Real>(radius: T, pixel: T) -> Ribbon<T> {
    let half = real::<T>(0.5) * pixel.max(real(1e-12));
    let radius = radius.max(T::zero());
    Ribbon {
        half_width: radius.max(half),
        coverage: (radius / half).min(T::one()),
    }
}
