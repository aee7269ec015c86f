//! Shadows between the fibres of a vane: which share of a fibre that the eye sees is reached by a light.
//!
//! Masking seen from the light. Fibres lie in three storeys as rays find them in the explicit curves: distal barbules rest on
//! proximal ones, a barb stands out of both. What the eye sees of the lower barbules it sees through the gaps of the upper ones;
//! whether the light comes through the same gap is the overlap of two gratings, one shifted against the other by the parallax of
//! the storeys.
//!
//! What the lights of a pixel share is in [`VaneEye`]; a light is a [`VaneRay`], and each part asks for what reaches it.
//!
//! Where on a fibre light enters and where it comes out again is not independent. Light of the mirror lobes (R, TRT, TRcT) enters
//! and leaves at one place, known from eye and light: the normal half way between them, or a little before and behind it where a
//! core inside reflects. It arrives if that place is both seen and lit, and then counts by as much as the eye sees less of the rest
//! ([`VaneLight::mirror`]). Light of the medulla and light that passes through comes out anywhere ([`VaneLight::even`]), up to
//! what it remembers of its place: along the fibre ([`VaneLight::along`], [`grating_frequency`]) and around it
//! ([`VaneLight::place`]). Judged by a path tracer of explicit fibres, `docs/accuracy.md`.

use super::{
    masking::{Storey, Storeys, VaneShape, barb_hidden, storeys, vane_shape},
    vane::Vane,
};
use crate::maths::functions::{Real, clamp};

/// Least `|direction . normal|`.
const LEAST_FACING: f64 = 1e-3;

/// Where mirror lobes leave a fibre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MirrorPlace<T> {
    /// Azimuthal roughness in radians, which spreads the place.
    pub blur: T,
    /// Places of entry and exit, as shares of the way from the normal half way to the direction itself: 0 for a reflection
    /// at the surface, [`mirror_retreat`] for a core.
    pub retreat: T,
}

/// The fibres of one part as the eye sees them: barbs, upper or lower barbules. What only others need is 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartEye<T> {
    /// Unit vector to the eye in their cross-section: across, along the normal (at least 0).
    pub across: [T; 2],
    /// Middle of what the eye sees of the circle, over pi/4 for whole silhouettes.
    pub middle: [T; 2],
    /// Neighbors hide what lies farther than this many radii below the ray through the axis.
    pub reach: T,
    /// Silhouette over period, at least 1.
    pub wide: T,
    /// Barbules: gap between two barbs at their height, ends in barb periods.
    pub gap: [T; 2],
    /// One over its width.
    pub per_gap: T,
    /// Barbs: share of the silhouette that the barbules beside it leave open, 0..1. Lower barbules: gap between the upper ones over
    /// their period.
    pub open: T,
    /// Lower barbules: where the upper ones are projected on their axis, in periods.
    pub shift: T,
    /// Amplitude of the upper grating's shadow there, over half of `open`.
    pub ripple: T,
}

/// How an eye lies to the storeys of a vane: what the lights of a pixel share. Upper and lower: as the eye sees them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VaneEye<T> {
    /// The vane.
    pub shape: VaneShape<T>,
    /// The eye sees the front: distal barbules lie over proximal ones.
    pub distal_above: bool,
    /// The storeys as the eye meets them.
    pub storeys: Storeys<T>,
    /// Where mirror lobes leave barbs and barbules.
    pub mirrors: [MirrorPlace<T>; 2],
    /// Barbs, upper and lower barbules.
    pub parts: [PartEye<T>; 3],
}

/// How a light lies to the storeys of a vane that an eye sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VaneRay<T> {
    /// Component along the feather, and cosine to the front normal.
    pub along: T,
    /// See [`Self::along`].
    pub facing: T,
    /// Shines on the side that the eye does not see.
    pub beyond: bool,
    /// The storeys as the light meets them.
    pub storeys: Storeys<T>,
    /// The barbules that the eye meets first.
    pub upper: Storey<T>,
    /// The others.
    pub lower: Storey<T>,
}

/// What of a light reaches the fibres of one part that an eye sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VaneLight<T> {
    /// Factor on mirror lobes, 0 and more: above 1 where the eye sees little of a fibre but the place that mirrors.
    pub mirror: T,
    /// The same where the pixel sees a place on the fibre and not its whole silhouette.
    pub lit: T,
    /// Share of the light for lobes that forget their place, 0..1.
    pub even: T,
    /// What `even` gains on lower barbules for light that comes out beside the place where it entered.
    pub along: T,
    /// Cosine between the middle of what is seen and of what is lit, over what it is for whole silhouettes turned likewise: that of
    /// the angle between eye and light where nothing is shaded.
    pub place: T,
}

/// `sin(x) / x`.
fn sinc<T: Real>(x: T) -> T {
    if x.abs() < T::of(1e-3) {
        return T::one() - x * x / T::of(6.0);
    }
    x.sin() / x
}

/// How far from the normal half way between eye and light a mirror core of radius `core` (over the fibre's, refractive index
/// `eta`) lets light in and out, as a share of the angle to either: the limit of small angles, within 0.03 up to a right angle.
pub fn mirror_retreat<T: Real>(core: T, eta: T) -> T {
    (T::one() - core) / (eta * core + T::one() - core)
}

/// Spatial frequency, in radians per radius of the lower fibres, of the upper barbules' shadow along a lower barbule.
pub fn grating_frequency<T: Real>(vane: &Vane<T>, distal_above: bool) -> T {
    let radius = if distal_above { vane.r_bp } else { vane.r_bd };
    let sine = T::of(2.0) * vane.cos_bl * vane.sin_bl;
    T::of(std::f64::consts::TAU) * radius * sine / vane.p_bl().max(T::of(1e-9))
}

/// Describes the eye at `direction` (canonical frame of the left vane: x, y, front normal; unit). `mirrors`: of barbs and barbules.
pub fn vane_eye<T: Real>(
    vane: &Vane<T>,
    direction: [T; 3],
    mirrors: [MirrorPlace<T>; 2],
) -> VaneEye<T> {
    let shape = vane_shape(vane);
    let storeys = storeys(&shape, direction);
    VaneEye {
        shape,
        distal_above: direction[2] >= T::zero(),
        storeys,
        mirrors,
        parts: [
            barb_eye(&shape, &storeys),
            upper_eye(&shape, &storeys),
            lower_eye(&shape, &storeys),
        ],
    }
}

/// Fibres to which the eye lies at `across` in their cross-section, silhouette over period `wide`.
fn part_eye<T: Real>(across: [T; 2], wide: T) -> PartEye<T> {
    let (zero, one) = (T::zero(), T::one());
    let (reach, own) = family_reach(wide);
    PartEye {
        across,
        middle: family_middle(across, own, one),
        reach,
        wide: wide.max(one),
        gap: [zero; 2],
        per_gap: zero,
        open: zero,
        shift: zero,
        ripple: zero,
    }
}

/// The barbs as the eye sees them.
pub fn barb_eye<T: Real>(shape: &VaneShape<T>, storeys: &Storeys<T>) -> PartEye<T> {
    let long = storeys.silhouette + storeys.silhouette;
    let across = barb_section(storeys, T::one());
    let open = barb_open(shape, storeys);
    PartEye {
        open,
        middle: family_middle(across, open, T::one()),
        ..part_eye(across, long * shape.per_barb)
    }
}

/// The barbules that the eye meets first.
pub fn upper_eye<T: Real>(shape: &VaneShape<T>, storeys: &Storeys<T>) -> PartEye<T> {
    let [upper, _] = storeys.layers;
    let gap = barb_gap(shape, storeys, T::of(1.5));
    PartEye {
        gap,
        per_gap: T::one() / (gap[1] - gap[0]).max(T::of(1e-6)),
        ..part_eye(cross_section(upper.slope, T::one()), upper.wide)
    }
}

/// The barbules that the eye sees through the gaps of the others.
pub fn lower_eye<T: Real>(shape: &VaneShape<T>, storeys: &Storeys<T>) -> PartEye<T> {
    let [upper, lower] = storeys.layers;
    let gap = barb_gap(shape, storeys, T::of(-0.5));
    let open = (T::one() - upper.wide).max(T::zero());
    let (shift, ripple) = grating(shape, &upper, &lower);
    PartEye {
        gap,
        per_gap: T::one() / (gap[1] - gap[0]).max(T::of(1e-6)),
        open,
        shift,
        ripple: (ripple + ripple) / open.max(T::of(1e-3)),
        ..part_eye(cross_section(lower.slope, T::one()), lower.wide)
    }
}

/// Describes a light at `direction`, in the same frame.
pub fn vane_ray<T: Real>(eye: &VaneEye<T>, direction: [T; 3]) -> VaneRay<T> {
    let storeys = storeys(&eye.shape, direction);
    let beyond = (direction[2] >= T::zero()) != eye.distal_above;
    let [first, second] = storeys.layers;
    VaneRay {
        along: direction[1],
        facing: direction[2],
        beyond,
        storeys,
        upper: if beyond { second } else { first },
        lower: if beyond { first } else { second },
    }
}

/// What of light from a direction the vane catches, per area of the vane: its coverage times the cosine to the normal.
pub fn vane_caught<T: Real>(shape: &VaneShape<T>, storeys: &Storeys<T>, facing: T) -> T {
    let one = T::one();
    let long = storeys.silhouette + storeys.silhouette;
    let open = storeys.layers.iter().fold(
        (one - long * shape.per_barb).max(T::zero()),
        |open, storey| open * (one - storey.wide.min(one)),
    );
    facing.abs() * (one - open)
}

/// Unit vector to a direction in the cross-section of fibres that it meets with `slope`; `up`: 1, or -1 for light from beyond.
fn cross_section<T: Real>(slope: T, up: T) -> [T; 2] {
    let scale = T::one() / (T::one() + slope * slope).sqrt();
    [slope * scale, up * scale]
}

/// [`cross_section`] of the barbs.
fn barb_section<T: Real>(storeys: &Storeys<T>, up: T) -> [T; 2] {
    [storeys.slope, up].map(|x| x * storeys.per_root)
}

/// Radii below the ray through the axis from which on neighbors hide a fibre, and the share of its silhouette that they leave.
fn family_reach<T: Real>(wide: T) -> (T, T) {
    let inverse = T::one() / wide.max(T::of(1e-3));
    (inverse + inverse - T::one(), inverse.min(T::one()))
}

/// Middle of what a direction meets of a fibre of which it meets the share `own`, so that the cosine between two of them stands for
/// all harmonics of what the medulla remembers (docs/book/light_between_fibres.md).
fn family_middle<T: Real>([x, y]: [T; 2], own: T, up: T) -> [T; 2] {
    let tilt = (T::one() - own) * T::of(4.0 * std::f64::consts::FRAC_1_PI);
    [
        x * (T::of(0.74) + T::of(0.34) * up),
        y + up * tilt * x.abs(),
    ]
}

/// Gap between two barbs at a height above the middle of the vane in lifts, in barb periods.
fn barb_gap<T: Real>(shape: &VaneShape<T>, storeys: &Storeys<T>, height: T) -> [T; 2] {
    let one = T::one();
    let beside = storeys.silhouette - height * shape.lift * storeys.slope.abs();
    let near = shape.barb * shape.per_barb;
    let far = (beside * shape.per_barb).max(near);
    let [below, above] = if storeys.slope > T::zero() {
        [far, near]
    } else {
        [near, far]
    };
    [above, (one - below).max(above)]
}

/// Share of a barb's silhouette that the barbules beside it leave open, 0..1.
fn barb_open<T: Real>(shape: &VaneShape<T>, storeys: &Storeys<T>) -> T {
    let [upper, lower] = barb_hidden(shape, storeys);
    let long = (storeys.silhouette + storeys.silhouette).max(T::of(1e-9));
    let width = (long - upper - lower).min(shape.vane.p_b);
    clamp(width / long, T::zero(), T::one())
}

/// The upper grating on the axis of the lower barbules: its place there in periods, and the amplitude of its shadow.
fn grating<T: Real>(shape: &VaneShape<T>, upper: &Storey<T>, lower: &Storey<T>) -> (T, T) {
    let (one, half) = (T::one(), T::of(0.5));
    let (c, b) = (shape.vane.cos_bl, shape.vane.sin_bl);
    let cosine = c * c - b * b;
    let radius = lower.family.radius / (one + lower.slope * lower.slope).sqrt();
    // The lower fibre's lit side in periods of the upper grating: its middle, and half its breadth. Both slopes are across their own
    // family.
    let middle = T::of(std::f64::consts::FRAC_PI_4) * radius * (upper.slope - cosine * lower.slope);
    let breadth = radius * (shape.vane.hooked * cosine + lower.slope * upper.slope).abs();
    let turn = T::of(std::f64::consts::TAU);
    let shift = ((shape.lift + shape.lift) * upper.slope - middle) * shape.per_barbule;
    let amplitude = (turn * (half * upper.wide).min(half)).sin()
        * T::of(std::f64::consts::FRAC_1_PI)
        * sinc(turn * breadth * shape.per_barbule);
    (shift, amplitude)
}

/// The normal half way between eye and light in a cross-section.
struct Halfway<T> {
    normal: [T; 2],
    cosine: T,
    sine: T,
}

fn halfway<T: Real>(eye: [T; 2], light: [T; 2]) -> Halfway<T> {
    let sum = [eye[0] + light[0], eye[1] + light[1]];
    let square = sum[0] * sum[0] + sum[1] * sum[1];
    let scale = T::one() / square.max(T::of(1e-12)).sqrt();
    Halfway {
        normal: [sum[0] * scale, sum[1] * scale],
        cosine: T::of(0.5) * square * scale,
        sine: (light[0] * eye[1] - light[1] * eye[0]) * scale,
    }
}

/// How much of the place where a mirror lobe enters and leaves is both seen and lit within its family, and the scale by which a point
/// between the normal half way and a direction is on the circle.
fn family_within<T: Real>(
    eye: &PartEye<T>,
    light: [T; 2],
    reach: T,
    up: T,
    half: &Halfway<T>,
    mirror: MirrorPlace<T>,
) -> (T, T) {
    let (zero, one) = (T::zero(), T::one());
    let (retreat, rest) = (mirror.retreat, one - mirror.retreat);
    let square = rest * rest + retreat * (retreat + (rest + rest) * half.cosine);
    let scale = one / square.max(T::of(1e-12)).sqrt();
    // How far down from the ray through the axis the place is, and how far roughness spreads it.
    let side = rest * scale * half.sine;
    let spread = (mirror.blur * (rest * half.cosine + retreat) * scale).max(T::of(1e-3));
    let seen = eye.reach - if eye.across[0] < zero { -side } else { side };
    let lit = reach - up * if light[0] < zero { side } else { -side };
    let depth = seen.min(lit) / spread;
    (clamp(T::of(0.5) + depth, zero, one), scale)
}

/// Share of light along `storeys` that reaches a point of a barb between its barbules: `point` on the unit circle, (across the barb,
/// up); `up` is 1 if it is counted towards the side of the direction, else -1.
fn barb_reached<T: Real>(shape: &VaneShape<T>, storeys: &Storeys<T>, point: [T; 2], up: T) -> T {
    let one = T::one();
    let slope = storeys.slope;
    let across = if slope < T::zero() {
        -point[0]
    } else {
        point[0]
    };
    // Where the ray passes the flank.
    let foot = shape.barb * (up * point[1] + (one - across) / slope.abs().max(T::of(1e-4)));
    let open = |storey: &Storey<T>, axis: T| {
        one - storey.blocks((foot - axis) * storey.family.inverse, shape.vane.hooked)
    };
    open(&storeys.layers[0], shape.lift) * open(&storeys.layers[1], -shape.lift)
}

/// Share of a gap between barbs that the light sees as well, at a height in lifts.
fn between_barbs<T: Real>(
    shape: &VaneShape<T>,
    eye: &PartEye<T>,
    ray: &VaneRay<T>,
    height: T,
) -> T {
    let [low, high] = eye.gap;
    let light = barb_gap(shape, &ray.storeys, height);
    let both = high.min(light[1]) - low.max(light[0]);
    clamp(both * eye.per_gap, T::zero(), T::one())
}

impl<T: Real> VaneRay<T> {
    fn up(&self) -> T {
        if self.beyond { -T::one() } else { T::one() }
    }
}

/// What of a light reaches the shaft that an eye sees.
pub fn shaft_light<T: Real>(ray: &VaneRay<T>) -> VaneLight<T> {
    let (one, half) = (T::one(), T::of(0.5));
    let n = ray.facing.abs().max(T::of(LEAST_FACING));
    let open = half + half * (n / (one - ray.along * ray.along).max(n * n).sqrt()).min(one);
    VaneLight {
        mirror: open,
        lit: open,
        even: open,
        along: T::zero(),
        place: one,
    }
}

/// What of a light reaches the barbs that an eye sees.
pub fn barb_light<T: Real>(eye: &VaneEye<T>, ray: &VaneRay<T>) -> VaneLight<T> {
    let (shape, mirror, up) = (&eye.shape, eye.mirrors[0], ray.up());
    let part = &eye.parts[0];
    let light = barb_section(&ray.storeys, up);
    let long = ray.storeys.silhouette + ray.storeys.silhouette;
    let (reach, own) = family_reach(long * shape.per_barb);
    let half = halfway(part.across, light);
    let (within, scale) = family_within(part, light, reach, up, &half, mirror);
    let towards = |direction: [T; 2]| {
        [0, 1].map(|i| scale * (half.normal[i] + (direction[i] - half.normal[i]) * mirror.retreat))
    };
    let seen = barb_reached(shape, &eye.storeys, towards(part.across), T::one());
    let mut lit = barb_reached(shape, &ray.storeys, towards(light), up);
    let mut both = lit * seen;
    // Eye and light over the same flank look through the same gaps.
    if !ray.beyond && eye.storeys.slope * ray.storeys.slope > T::zero() {
        both = lit.min(seen);
        lit = (lit / seen.max(T::of(1e-4))).min(T::one());
    }
    VaneLight {
        mirror: within * both / part.open.max(T::of(1e-3)),
        lit: within * lit,
        even: barb_open(shape, &ray.storeys),
        along: T::zero(),
        place: dot2(part.middle, family_middle(light, own, up)),
    }
}

/// What of a light reaches the barbules that an eye meets first.
pub fn upper_light<T: Real>(eye: &VaneEye<T>, ray: &VaneRay<T>) -> VaneLight<T> {
    let up = ray.up();
    let part = &eye.parts[1];
    let light = cross_section(ray.upper.slope, up);
    let (reach, own) = family_reach(ray.upper.wide);
    let half = halfway(part.across, light);
    let (within, _) = family_within(part, light, reach, up, &half, eye.mirrors[1]);
    let height = T::of(if ray.beyond { -0.5 } else { 1.5 });
    let mut gap = between_barbs(&eye.shape, part, ray, height);
    if ray.beyond {
        gap = gap * (T::one() - ray.lower.wide).max(T::zero());
    }
    let mirror = within * part.wide * gap;
    VaneLight {
        mirror,
        lit: mirror,
        even: own * gap,
        along: T::zero(),
        place: dot2(part.middle, family_middle(light, own, up)),
    }
}

/// What of a light reaches the barbules that an eye sees through the gaps of the others.
pub fn lower_light<T: Real>(eye: &VaneEye<T>, ray: &VaneRay<T>) -> VaneLight<T> {
    let (zero, one, half) = (T::zero(), T::one(), T::of(0.5));
    let (shape, up) = (&eye.shape, ray.up());
    let part = &eye.parts[2];
    let light = cross_section(ray.lower.slope, up);
    let (reach, own) = family_reach(ray.lower.wide);
    let between = halfway(part.across, light);
    let (within, _) = family_within(part, light, reach, up, &between, eye.mirrors[1]);
    let height = T::of(if ray.beyond { 1.5 } else { -0.5 });
    let gap = between_barbs(shape, part, ray, height);
    let (mut through, mut even, mut along) = (one, one, zero);
    if !ray.beyond {
        // From the very same place: the overlap of two gaps.
        let gaps = [part.open, (one - ray.upper.wide).max(zero)];
        let height = shape.lift + shape.lift - ray.lower.family.radius * between.normal[1];
        let shift = height * (ray.upper.slope - eye.storeys.layers[0].slope) * shape.per_barbule;
        let shift = (shift - (shift + half).floor()).abs();
        let (mean, least) = (half * (gaps[0] + gaps[1]), gaps[0].min(gaps[1]));
        let overlap = |shift: T| clamp(mean - shift, zero, least);
        let sum = overlap(shift) + overlap(one - shift);
        through = (sum / gaps[0].max(T::of(1e-3))).min(one);
        even = gaps[1];
        let (place, ripple) = grating(shape, &ray.upper, &ray.lower);
        let turn = (T::of(std::f64::consts::TAU) * (place - part.shift)).cos();
        along = own * gap * part.ripple * ripple * turn;
    }
    let mirror = within * part.wide * through * gap;
    VaneLight {
        mirror,
        lit: mirror,
        even: own * even * gap,
        along,
        place: dot2(part.middle, family_middle(light, own, up)),
    }
}

fn dot2<T: Real>(a: [T; 2], b: [T; 2]) -> T {
    a[0] * b[0] + a[1] * b[1]
}

/// What of a light reaches the fibres that an eye sees: rachis, barbs, distal and proximal barbules.
pub fn vane_shadow<T: Real>(eye: &VaneEye<T>, ray: &VaneRay<T>) -> [VaneLight<T>; 4] {
    let (upper, lower) = (upper_light(eye, ray), lower_light(eye, ray));
    let (distal, proximal) = if eye.distal_above {
        (upper, lower)
    } else {
        (lower, upper)
    };
    [shaft_light(ray), barb_light(eye, ray), distal, proximal]
}
