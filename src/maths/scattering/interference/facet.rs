//! The lobe of a side that mirrors: facets about a flat section (docs/book/iridescence.md#lobe). Twin of `interference.wgsl`.

use super::super::FibreShading;
use super::{SeenTable, StackLook, StackTable};
use crate::maths::functions::{Real, clamp, error_function, real, smooth_step};
use crate::maths::vector::dot;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// sqrt(2/pi).
const MEAN_DEVIATION: f64 = 0.797_884_560_802_865_4;
/// How far the cosine at which a node's color is taken lies towards that of the light that leaves (docs/book/iridescence.md#lobe).
const BRIGHT: f64 = 0.667;
/// How far past the edge both sides mix, in the z of the facet's normal.
const EDGE: f64 = 0.1;

/// How the facets of a side lie: in azimuth as the normals of an ellipse, along the fibre with a normal deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facets<T> {
    /// Minor over major axis of the ellipse, 0.05..1; the minor axis is the local z.
    pub flatness: T,
    /// Standard deviation of the slope along the fibre in radians, 0.03..0.35.
    pub slope: T,
    /// How much of the stack the inner side has, 0..1.
    pub back: T,
}

/// What the lights of a pixel share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FacetEye<T> {
    /// The facets.
    pub facets: Facets<T>,
    /// To the eye, in the side's frame.
    pub omega: [T; 3],
    /// Area of the facets that the eye sees, in its projection; the fibre's major axis is 1.
    pub area: T,
    /// Share of light that the facets reflect, linear RGB, 0..1: the albedo of the lobe.
    pub energy: [T; 3],
    /// Factor on the thickness of the stack.
    pub scale: T,
}

/// A sampled direction of the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FacetSample<T> {
    /// Direction to the light, in the side's frame.
    pub direction: [T; 3],
    /// Density per steradian with which it was chosen.
    pub pdf: T,
}

fn sq<T: Real>(x: T) -> T {
    x * x
}

/// A direction of a fibre's frame in that of a side which rises out of the vane and then leans; both as (sine, cosine), the lean's sine
/// positive towards local +y.
pub fn facet_turn<T: Real>(omega: [T; 3], rise: (T, T), lean: (T, T)) -> [T; 3] {
    let [x, y, z] = omega;
    let (along, up) = (x * rise.1 + z * rise.0, z * rise.1 - x * rise.0);
    [along, y * lean.1 - up * lean.0, up * lean.1 + y * lean.0]
}

/// Density of the facets' normals per steradian, per unit length of the fibre and of its major axis.
pub fn facet_density<T: Real>(facets: &Facets<T>, normal: [T; 3]) -> T {
    let across = (sq(normal[1]) + sq(normal[2])).max(real(1e-12));
    let a2 = sq(facets.flatness);
    let hit = clamp((sq(normal[1]) + a2 * sq(normal[2])) / across, a2, T::one());
    let t = clamp(normal[0], -T::one(), T::one()).asin() / facets.slope;
    let slope = (-real::<T>(0.5) * t * t).exp() / (facets.slope * real((2.0 * PI).sqrt()));
    real::<T>(0.5) * a2 / (hit * hit.sqrt()) * slope / across.sqrt()
}

/// Mean of the absolute value of a normal variable.
fn mean_absolute<T: Real>(mean: T, deviation: T) -> T {
    let z = mean / deviation.max(real(1e-6)) * real(FRAC_1_SQRT_2);
    mean * error_function(z) + real::<T>(MEAN_DEVIATION) * deviation * (-z * z).exp()
}

/// How much of the stack facets have of whose light the share `outer` comes from the outer side.
pub fn facet_share<T: Real>(facets: &Facets<T>, outer: T) -> T {
    facets.back + (T::one() - facets.back) * outer
}

/// Color of facets that have this share of the stack; the rest is bare keratin.
pub fn facet_color<T: Real>(look: &StackLook<T>, share: T) -> [T; 3] {
    look.color.map(|c| look.bare + (c - look.bare) * share)
}

/// Unit azimuth (y, z) of a direction.
fn azimuth_of<T: Real>(omega: [T; 3]) -> [T; 2] {
    let across = (sq(omega[1]) + sq(omega[2])).sqrt();
    if across > real(1e-6) {
        [omega[1] / across, omega[2] / across]
    } else {
        [T::zero(), T::one()]
    }
}

/// What of the eye the nodes of [`facet_node`] need.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FacetView<T> {
    /// Sine and cosine of the parametric angle of the ellipse where its normal looks at the eye.
    pub turn: [T; 2],
    /// Width of the ellipse as the eye sees it from broadside, in half major axes.
    pub width: T,
    /// Mean cosine of a facet of that angle, over the slopes.
    pub seen: T,
    /// Deviation of the cosine.
    pub deviation: T,
}

/// The view of an eye at `omega_o`.
pub fn facet_view<T: Real>(facets: &Facets<T>, omega_o: [T; 3]) -> FacetView<T> {
    let a = facets.flatness;
    let o = azimuth_of(omega_o);
    let width = (sq(a * o[0]) + sq(o[1])).sqrt().max(real(1e-6));
    let across = (sq(omega_o[1]) + sq(omega_o[2])).sqrt();
    FacetView {
        turn: [a * o[0] / width, o[1] / width],
        width,
        seen: (-real::<T>(0.5) * sq(facets.slope)).exp() * width * across,
        // Its own damping is left out, which keeps the energy below 1.01.
        deviation: facets.slope * omega_o[0].abs(),
    }
}

/// Facets at a parametric angle (sine, cosine) from the one that looks at the eye: their mean cosine, and their area in the eye's
/// projection for an angle of 1.
pub fn facet_node<T: Real>(facets: &Facets<T>, view: &FacetView<T>, (sin, cos): (T, T)) -> [T; 2] {
    let [y, z] = facet_normal(facets, view, sin, cos);
    let size = (sq(y) + sq(z)).sqrt().max(real(1e-6));
    let mean = view.seen * cos / size;
    let facing = mean_absolute(mean, view.deviation).max(real(1e-6));
    // Between the mean over the facets and that over the light that leaves them: reflectance is steep at grazing incidence.
    let bright = (sq(mean) + sq(view.deviation)) / facing;
    let cosine = facing + (bright - facing) * real(BRIGHT);
    [cosine.min(T::one()), size * facing]
}

/// The normal (y, z) of the ellipse at a parametric angle from the one that looks at the eye; not of unit length.
fn facet_normal<T: Real>(facets: &Facets<T>, view: &FacetView<T>, sin: T, cos: T) -> [T; 2] {
    let [sin_o, cos_o] = view.turn;
    [
        facets.flatness * (sin_o * cos + cos_o * sin),
        cos_o * cos - sin_o * sin,
    ]
}

/// Prepares a side for the lights of one pixel; `omega_o` to the eye, in the side's frame, `scale`: factor on the stack's thickness.
pub fn facet_eye<T: Real>(
    facets: &Facets<T>,
    seen: &SeenTable,
    table: &StackTable,
    scale: T,
    omega_o: [T; 3],
) -> FacetEye<T> {
    let seen = seen.seen(facets, table.row(scale), omega_o);
    let mut energy = seen.energy;
    if facets.back < T::one() {
        let look = StackLook {
            color: energy,
            ..table.look(seen.facing, scale)
        };
        energy = facet_color(&look, facet_share(facets, seen.outer));
    }
    FacetEye {
        facets: *facets,
        omega: omega_o,
        area: seen.area,
        energy: energy.map(|e| clamp(e, T::zero(), T::one())),
        scale,
    }
}

/// Half way between eye and light: the normal of the facets that mirror one into the other, and the cosine of incidence on them.
fn half_way<T: Real>(omega_o: [T; 3], omega_i: [T; 3]) -> ([T; 3], T) {
    let sum: [T; 3] = std::array::from_fn(|i| omega_o[i] + omega_i[i]);
    let length = dot(sum, sum).sqrt();
    let scale = T::one() / length.max(real(1e-6));
    (sum.map(|x| x * scale), length * real(0.5))
}

/// K = S cos(theta_i) of the facets for light from `omega_i`, in the side's frame: linear RGB per steradian, at least 0.
pub fn facet_evaluate<T: Real>(eye: &FacetEye<T>, table: &StackTable, omega_i: [T; 3]) -> [T; 3] {
    let (normal, cosine) = half_way(eye.omega, omega_i);
    if cosine < real(1e-4) {
        return [T::zero(); 3];
    }
    let density = facet_density(&eye.facets, normal) / (real::<T>(4.0) * eye.area);
    let outer = smooth_step(real(-EDGE), real(EDGE), normal[2]);
    let look = table.look(cosine, eye.scale);
    facet_color(&look, facet_share(&eye.facets, outer)).map(|c| c * density)
}

/// What the stack reflects does not enter: the fibre's own surface reflection gives way to the facets, and its other lobes get what they
/// leave.
pub fn facet_let_in<T: Real>(shading: &mut FibreShading<T>, energy: [T; 3]) {
    let surface = shading.energy[0];
    let entering: [T; 3] = std::array::from_fn(|c| {
        (T::one() - energy[c]).max(T::zero()) / (T::one() - surface[c]).max(real(1e-3))
    });
    shading.energy[0] = [T::zero(); 3];
    for lobe in &mut shading.energy[1..] {
        *lobe = std::array::from_fn(|c| lobe[c] * entering[c]);
    }
}

/// Density of [`facet_sample`] at a direction, per steradian.
pub fn facet_pdf<T: Real>(eye: &FacetEye<T>, omega_i: [T; 3]) -> T {
    let (normal, cosine) = half_way(eye.omega, omega_i);
    if cosine < real(1e-4) {
        return T::zero();
    }
    let (o, n) = (azimuth_of(eye.omega), azimuth_of(normal));
    let width = facet_view(&eye.facets, eye.omega).width;
    let facing = (o[0] * n[0] + o[1] * n[1]).abs();
    facet_density(&eye.facets, normal) * facing / (real::<T>(4.0) * cosine * width)
}

/// Samples a direction of the light: a facet by what is seen of it without its slope, then the slope. `u`: around, and two along.
///
/// None where the density vanishes.
pub fn facet_sample<T: Real>(eye: &FacetEye<T>, u: [T; 3]) -> Option<FacetSample<T>> {
    let one = T::one();
    let view = facet_view(&eye.facets, eye.omega);
    let sin = clamp(u[0] + u[0] - one, -one, one);
    let cos = (one - sq(sin)).max(T::zero()).sqrt();
    let [y, z] = facet_normal(&eye.facets, &view, sin, cos);
    let scale = one / (sq(y) + sq(z)).sqrt().max(real(1e-6));
    // Box and Muller 1958.
    let radius = (-real::<T>(2.0) * u[1].max(real(1e-7)).ln())
        .max(T::zero())
        .sqrt();
    let slope = eye.facets.slope * radius * (real::<T>(2.0 * PI) * u[2]).cos();
    let (sin_l, cos_l) = slope.sin_cos();
    let mut normal = [sin_l, cos_l * y * scale, cos_l * z * scale];
    let mut cosine = dot(normal, eye.omega);
    if cosine < T::zero() {
        // The facet across from it is as likely, and this one is seen.
        normal = normal.map(|x| -x);
        cosine = -cosine;
    }
    let direction = std::array::from_fn(|i| (cosine + cosine) * normal[i] - eye.omega[i]);
    let pdf = facet_pdf(eye, direction);
    (cos_l > T::zero() && pdf > real(1e-12) && pdf.is_finite())
        .then_some(FacetSample { direction, pdf })
}
