//! Bare tarsi, toes and claws.

use std::f32::consts::{PI, TAU};

use bevy::math::Vec3;

use crate::maps::{Maps, Strip, Texel, cloud, ease, mix, noise, plates};
use crate::skeleton::Skeleton;
use crate::species::{Species, linear};
use crate::tube::{Primitive, Ring, blend, other_side, rigid};

/// Strips of the feet's texture: toes, tarsus.
const STRIPS: [Strip; 2] = [Strip { v: [0.0, 0.62] }, Strip { v: [0.64, 1.0] }];
/// Plates round a toe.
const ROUND: f32 = 14.0;

/// Path of one toe: points wrapped round the perch, root to claw.
fn toe_path(species: &Species, toe: usize, share: f32) -> (Vec3, Vec3) {
    let foot = species.joint("foot_L");
    let radius = species.perch + species.toe_radius[0] * (1.0 - 0.3 * share);
    let sign = if species.backward[toe] { -1.0 } else { 1.0 };
    let top = species.perch_top;
    let start = foot.z.atan2(foot.y - top + species.perch);
    let angle = start + sign * share * species.toes[toe] / (species.perch + species.toe_radius[0]);
    let x = foot.x + species.splay[toe] * share;
    let outward = Vec3::new(0.0, angle.cos(), angle.sin());
    (
        Vec3::new(x, top - species.perch, 0.0) + outward * radius,
        outward,
    )
}

/// Bind positions of the joints (a, b) of toes I..IV.
pub fn toe_joints(species: &Species) -> [[Vec3; 2]; 4] {
    std::array::from_fn(|t| [toe_path(species, t, 0.08).0, toe_path(species, t, 0.55).0])
}

/// Tarsi and toes with their texture.
pub fn feet(species: &Species, skeleton: &Skeleton) -> (Primitive, Maps) {
    let ankle = species.joint("tarsus_L");
    let foot = species.joint("foot_L");
    let toe = species.toes.iter().sum::<f32>() / 4.0;
    let girth = [
        PI * (species.toe_radius[0] + species.toe_radius[1]),
        TAU * species.legs[2][1],
    ];
    let lengths = [toe, ankle.distance(foot)];
    let maps = Maps::paint(
        [128, 256],
        &STRIPS,
        |strip, uv| scutes(species, uv, lengths[strip] / girth[strip], strip == 0),
        |strip, _| [girth[strip], lengths[strip]],
    );
    let mut out = Primitive::default();
    let (tarsus, foot_joint) = (skeleton.index("tarsus_L"), skeleton.index("foot_L"));
    let axis = (foot - ankle).normalize();
    let across = Vec3::X.reject_from(axis).normalize();
    let up = axis.cross(across);
    // The front of the tarsus is the top of its texture.
    let up = if up.z < 0.0 { -up } else { up };
    let [r0, r1] = species.legs[2];
    let from = if species.feathered_tarsus { 0.8 } else { -0.15 };
    let n = 14;
    let rings: Vec<Ring> = (0..n)
        .map(|i| {
            let share = i as f32 / (n - 1) as f32;
            let f = from + (1.04 - from) * share;
            let r = (r0 + (r1 - r0) * f) * if species.feathered_tarsus { 0.8 } else { 1.0 };
            Ring::round(
                ankle.lerp(foot, f),
                across * r,
                up * r,
                share,
                blend(tarsus, foot_joint, ((f - 0.8) / 0.25).clamp(0.0, 1.0)),
            )
        })
        .collect();
    out.tube(&rings, 16, STRIPS[1].v);
    for toe in 0..4 {
        let a = skeleton.index(&format!("toe{}a_L", toe + 1));
        let b = skeleton.index(&format!("toe{}b_L", toe + 1));
        let n = 24;
        let rings: Vec<Ring> = (0..n)
            .map(|i| {
                let f = i as f32 / (n - 1) as f32;
                let (centre, outward) = toe_path(species, toe, f);
                // Pads between the joints, and a knob from which the claw grows.
                let pad = 1.0 + 0.09 * (f * 3.0 * TAU).cos();
                let r = (species.toe_radius[0]
                    + (species.toe_radius[1] - species.toe_radius[0]) * f)
                    * pad;
                let r = r * if i == n - 1 { 0.7 } else { 1.0 };
                let binding = if f < 0.1 {
                    blend(foot_joint, a, f * 10.0)
                } else {
                    blend(a, b, ((f - 0.45) / 0.2).clamp(0.0, 1.0))
                };
                Ring::round(centre, Vec3::X * r, outward * r, f, binding)
            })
            .collect();
        out.tube(&rings, 16, STRIPS[0].v);
    }
    out.tint(&maps);
    out.mirror(|j| other_side(skeleton, j));
    (out, maps)
}

/// Broad plates over the upper side, small ones at the sides and below; `v` along, `shape` length over girth.
fn scutes(species: &Species, [u, v]: [f32; 2], shape: f32, toe: bool) -> Texel {
    let skin = linear(species.bare_colors[2]);
    let (s, c) = (TAU * u).sin_cos();
    let rough = cloud([1.5 * s, 1.5 * c, 4.0 * v * shape], 101);
    let wave = 0.3 * noise([1.5 * s, 1.5 * c, 4.0 * v * shape], 103);
    // Each plate laps over the next: it rises to its lower edge.
    let count = 0.65 * ROUND * shape;
    let place = v * count + wave + 0.06 * c;
    let step = place.rem_euclid(1.0);
    let broad = ease(0.0, 0.35, step) * ease(1.0, 0.88, step);
    let [small, tone] = plates([u * ROUND, v * ROUND * shape], ROUND as i32, 105);
    let top = ease(0.1, 0.3, c + 0.25 * noise([2.0 * s, 2.0 * c, 5.0 * v], 107));
    let height = small + (broad - small) * top;
    let tone = tone + (noise([0.0, 0.0, place.floor() * 1.7], 109) * 0.5 + 0.5 - tone) * top;
    // Dust lies in the furrows, the pads below are worn.
    let dust = linear(0x8C8478);
    let mut color = skin.map(|x| x * (0.62 + 0.42 * height + 0.22 * (tone - 0.5) + 0.18 * rough));
    color = mix(
        color,
        dust,
        0.22 * (1.0 - height) * ease(-0.2, 0.6, rough + 0.4),
    );
    if toe {
        color = mix(color, skin.map(|x| 1.25 * x), 0.4 * ease(-0.5, -0.9, c));
    }
    Texel {
        color,
        height: 0.3 * height + 0.12 * rough,
        roughness: (0.70 - 0.06 * height + 0.06 * rough).clamp(0.55, 0.85),
        open: 0.55 + 0.45 * height,
    }
}

/// Claws with their texture.
pub fn claws(species: &Species, skeleton: &Skeleton) -> (Primitive, Maps) {
    let strip = Strip { v: [0.0, 1.0] };
    let length = species.claws.iter().sum::<f32>() / 4.0;
    let horn = linear(species.bare_colors[3]);
    let maps = Maps::paint(
        [64, 128],
        &[strip],
        |_, uv| worn(horn, uv),
        |_, _| [3.0 * species.toe_radius[1], length],
    );
    let mut out = Primitive::default();
    for toe in 0..4 {
        let b = skeleton.index(&format!("toe{}b_L", toe + 1));
        let (root, outward) = toe_path(species, toe, 0.97);
        let sign = if species.backward[toe] { -1.0 } else { 1.0 };
        // Starts along the toe, curls off and down round an arc of 75 degrees.
        let tangent = Vec3::X.cross(outward) * sign;
        let sweep = 1.3_f32;
        let radius = species.claws[toe] / sweep;
        let rings: Vec<Ring> = (0..14)
            .map(|i| {
                let f = i as f32 / 13.0;
                let a = f * sweep;
                let lift = 0.35 * species.toe_radius[1];
                let centre = root + outward * lift + tangent * (radius * a.sin())
                    - outward * (radius * (1.0 - a.cos()) * 0.8);
                let r = 0.78 * species.toe_radius[1] * (1.0 - 0.93 * f.powf(1.3));
                let along = (tangent * a.cos() - outward * a.sin() * 0.8).normalize();
                let side = along.cross(Vec3::X).normalize();
                // The ridge lies on the outer side of the bend.
                let side = if side.dot(outward) < 0.0 { -side } else { side };
                let mut ring = Ring::round(centre, Vec3::X * r * 0.8, side * r, f, rigid(b));
                (ring.ridge, ring.boxy) = (0.2, 0.3);
                ring
            })
            .collect();
        out.tube(&rings, 14, strip.v);
    }
    out.tint(&maps);
    out.mirror(|j| other_side(skeleton, j));
    (out, maps)
}

/// Horn of a claw: paler and dusty at its root, furrowed along, scratched.
fn worn(horn: [f32; 3], [u, v]: [f32; 2]) -> Texel {
    let (s, c) = (TAU * u).sin_cos();
    let furrow = noise([7.0 * s, 7.0 * c, 2.0 * v], 111);
    let scratch = noise([3.0 * s, 3.0 * c, 26.0 * v], 113);
    let rough = cloud([2.0 * s, 2.0 * c, 5.0 * v], 115);
    let root = ease(0.35, 0.0, v + 0.1 * rough);
    let color = mix(
        horn,
        linear(0x6B6259),
        0.45 * root + 0.12 * ease(0.1, 0.6, rough),
    );
    Texel {
        color: color.map(|x| x * (1.0 + 0.25 * furrow + 0.1 * scratch)),
        height: 0.05 * furrow + 0.03 * scratch + 0.06 * rough,
        roughness: (0.5 + 0.12 * rough + 0.12 * root).clamp(0.4, 0.75),
        open: 1.0 - 0.4 * ease(0.08, 0.0, v),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn toes_are_plates_with_furrows_and_dull() {
        let eagle = &crate::species::all()[1];
        let along = |u: f32| {
            let texels = (0..400).map(move |i| scutes(eagle, [u, i as f32 / 400.0], 1.2, true));
            texels.collect::<Vec<_>>()
        };
        for u in [0.0, 0.3, 0.5] {
            let line = along(u);
            let range = |value: fn(&Texel) -> f32| {
                let v = line.iter().map(value);
                (
                    v.clone().fold(f32::MAX, f32::min),
                    v.fold(f32::MIN, f32::max),
                )
            };
            let height = range(|t| t.height);
            assert!(height.1 - height.0 > 0.2, "{height:?}");
            let rough = range(|t| t.roughness);
            assert!(rough.0 >= 0.55 && rough.1 <= 0.85, "{rough:?}");
        }
    }
}
