//! The hybrid fur technique as published (Andersen et al., *Hybrid fur rendering*), kept so that every chart compares with it.
//!
//! | what | source | ours |
//! |---|---|---|
//! | [`printed_sub_index`] | Eq. 1 as printed | - |
//! | [`floor_index`] | Eq. 1 with a product for the exponent, Eq. 2 | [`prism_index`](super::prism::prism_index) |
//! | [`global_index`] | Eq. 3 | [`prism_element`](super::prism::prism_element) |
//! | [`step_walk`] | Sec. 3.2, ray marching in a fragment shader | [`walk`](bevy_plumage::maths::undercoat::walk::walk) |
//! | [`kajiya_kay_diffuse`] | Kajiya and Kay with the usual `1/pi` | [`kajiya_kay_diffuse`](bevy_plumage::maths::undercoat::light::kajiya_kay_diffuse) |

use bevy_plumage::maths::Real;
use bevy_plumage::maths::{
    undercoat::shell::{NO_LINK, Shell},
    vector::{add, cross, dot, scale, sub},
};

/// Eq. 1 as printed: the distance ratio of barycentric coordinate `lambda`, to the power of `2^level`, rounded down. It is 0
/// everywhere but at `lambda = 0`.
pub fn printed_sub_index<T: Real>(lambda: T, level: u32) -> i64 {
    let power = T::of(f64::from(1u32 << level.min(12)));
    let ratio = (T::one() - lambda).max(T::zero());
    ratio.powf(power).floor().to_i64().unwrap_or(0)
}

/// Eq. 2, with Eq. 1 read as a product with `2^level`. On edges and corners of cells it may be any number, negative ones included.
pub fn floor_index<T: Real>(lambda: [T; 3], level: u32) -> i64 {
    let n = T::of(f64::from(1u32 << level.min(12)));
    let [i0, i1, i2] = lambda.map(|l| ((T::one() - l) * n).floor().to_i64().unwrap_or(0));
    i0 * (1 + i0) + (i1 - i2)
}

/// Eq. 3: unique only while every prism has the same level.
pub fn global_index(prism: u64, layers: u64, layer: u64, level: u32, index: u64) -> u64 {
    ((prism * layers + layer) << (2 * level.min(12))) + index
}

/// Diffuse Kajiya-Kay with the usual factor: it sends on pi times what it receives.
pub fn kajiya_kay_diffuse<T: Real>(albedo: T, cos: T) -> T {
    let sine = (T::one() - cos * cos).max(T::zero()).sqrt();
    albedo * sine * T::of(core::f64::consts::FRAC_1_PI)
}

/// Place of a point in a prism with ruled walls: barycentric coordinates in the layer through the point, and the height. The layer is
/// found by Newton's method on the triangle between bottom and top.
pub fn prism_place<T: Real>(corners: &[[T; 3]; 6], point: [T; 3], guess: T) -> [T; 4] {
    let layer =
        |z: T| [0, 1, 2].map(|k: usize| add(corners[k], scale(sub(corners[k + 3], corners[k]), z)));
    let off = |z: T| {
        let [p, q, r] = layer(z);
        dot(cross(sub(q, p), sub(r, p)), sub(point, p))
    };
    let mut z = guess;
    for _ in 0..3 {
        let step = T::of(1e-3);
        let slope = (off(z + step) - off(z - step)) / (step + step);
        if slope.abs() < T::of(1e-30) {
            break;
        }
        z = (z - off(z) / slope).max(T::of(-2.0)).min(T::of(3.0));
    }
    let [p, q, r] = layer(z);
    let n = cross(sub(q, p), sub(r, p));
    let square = dot(n, n).max(T::of(1e-36));
    let w = sub(point, p);
    let second = dot(cross(w, sub(r, p)), n) / square;
    let third = dot(cross(sub(q, p), w), n) / square;
    [T::one() - second - third, second, third, z]
}

/// The published walk: steps of equal length from `start` in prism `first`, each located in the prism it falls into, over at most eight
/// neighbors a step. `visit` sees prism and place of every step. The length inside the shell, in steps, comes back.
pub fn step_walk<T: Real>(
    shell: &Shell,
    first: u32,
    start: [T; 3],
    direction: [T; 3],
    step: T,
    mut visit: impl FnMut(u32, [T; 4]),
) -> u32 {
    let mut prism = first;
    let mut height = T::one();
    for i in 0..4096u32 {
        let way = step * (T::of(f64::from(i)) + T::of(0.5));
        let point = add(start, scale(direction, way));
        let mut found = None;
        for _ in 0..8 {
            let place = prism_place(&shell.corners(prism as usize), point, height);
            let (side, least) = (0..3).fold((0, place[0]), |best, k| {
                if place[k] < best.1 {
                    (k, place[k])
                } else {
                    best
                }
            });
            if least >= T::zero() {
                found = Some(place);
                break;
            }
            // The edge across from the corner whose coordinate is negative: bc, ac, ab.
            let link = shell.prisms[prism as usize].links[[1, 2, 0][side]];
            if link == NO_LINK {
                break;
            }
            prism = link / 4;
        }
        match found {
            Some(place) if place[3] >= T::zero() && place[3] <= T::one() => {
                height = place[3];
                visit(prism, place);
            }
            _ => return i,
        }
    }
    4096
}
