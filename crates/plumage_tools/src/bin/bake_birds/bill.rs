//! The bill: two horny halves swept through slices in profile, and the fleshy rim of the gape.

use std::f32::consts::{PI, TAU};

use bevy::math::{Vec2, Vec3};

use crate::body::Body;
use crate::maps::{Maps, Strip, Texel, cloud, ease, mix, noise};
use crate::skeleton::Skeleton;
use crate::species::{Bill, Slice, Species, linear};
use crate::tube::{Primitive, Ring, rigid};

/// Strips of its texture: upper half, lower half, gape.
const STRIPS: [Strip; 3] = [
    Strip { v: [0.0, 0.58] },
    Strip { v: [0.60, 0.88] },
    Strip { v: [0.90, 1.0] },
];
/// Width and height of its texture.
const SIZE: [u32; 2] = [256, 512];
/// Rings along the upper half, and vertices round each.
const UPPER: [usize; 2] = [56, 56];
/// Rings along the lower half, and vertices round each.
const LOWER: [usize; 2] = [28, 32];
/// Cosine from the ridge of the cutting edge; below it lies the palate.
const EDGE: f32 = -0.35;

/// The bill with its texture.
pub fn bill(species: &Species, skeleton: &Skeleton, body: &Body) -> (Primitive, Maps) {
    let b = &species.bill;
    let maps = Maps::paint(
        SIZE,
        &STRIPS,
        |strip, [u, v]| match strip {
            0 => upper(b, v, u),
            1 => lower(b, v, u),
            _ => flesh(b, v, u),
        },
        |strip, v| match strip {
            0 => span(b.upper, v),
            1 => span(b.lower, v),
            _ => [PI * (b.gape_size[0] + b.gape_size[1]), gape_length(b.gape)],
        },
    );
    let mut out = Primitive::default();
    let joint = rigid(skeleton.index("upper_bill"));
    let sections = sweep(b.upper, UPPER[0]).map(|ring| Ring {
        ridge: b.ridge,
        boxy: 0.45,
        binding: joint,
        ..ring
    });
    out.tube(&sections.collect::<Vec<_>>(), UPPER[1], STRIPS[0].v);
    let joint = rigid(skeleton.index("jaw"));
    let sections = sweep(b.lower, LOWER[0]).map(|ring| Ring {
        binding: joint,
        ..ring
    });
    out.tube(&sections.collect::<Vec<_>>(), LOWER[1], STRIPS[1].v);
    gape(&mut out, skeleton, b, body);
    out.tint(&maps);
    (out, maps)
}

/// Middle of a slice's height, (z, y).
fn middle(slice: &Slice) -> Vec2 {
    Vec2::new(slice[0] + slice[2], slice[1] + slice[3]) * 0.5
}

/// Share of the length at every slice, and the length in mm.
fn places(slices: &[Slice]) -> (Vec<f32>, f32) {
    let mut sum = 0.0;
    let mut at = vec![0.0];
    for pair in slices.windows(2) {
        sum += middle(&pair[0]).distance(middle(&pair[1]));
        at.push(sum);
    }
    (at.iter().map(|d| d / sum).collect(), sum)
}

/// The slice at a share of the length, on a smooth curve through all of them.
fn slice_at(slices: &[Slice], at: &[f32], f: f32) -> Slice {
    let last = slices.len() - 1;
    let k = at.partition_point(|a| *a <= f).clamp(1, last) - 1;
    let width = at[k + 1] - at[k];
    let t = (f - at[k]) / width;
    std::array::from_fn(|i| {
        let y = |j: usize| slices[j][i];
        let slope = |j: usize| {
            let (a, b) = (j.saturating_sub(1), (j + 1).min(last));
            (y(b) - y(a)) / (at[b] - at[a])
        };
        let (a, b, c, d) = (y(k), y(k + 1), slope(k) * width, slope(k + 1) * width);
        let (t2, t3) = (t * t, t * t * t);
        (2.0 * t3 - 3.0 * t2 + 1.0) * a
            + (t3 - 2.0 * t2 + t) * c
            + (3.0 * t2 - 2.0 * t3) * b
            + (t3 - t2) * d
    })
}

/// Rings through slices, closer to each other towards the tip.
fn sweep(slices: &[Slice], count: usize) -> impl Iterator<Item = Ring> {
    let (at, _) = places(slices);
    (0..count).map(move |i| {
        let f = 1.0 - (1.0 - i as f32 / (count - 1) as f32).powf(1.25);
        let s = slice_at(slices, &at, f);
        let m = middle(&s);
        Ring::round(
            Vec3::new(0.0, m.y, m.x),
            Vec3::X * (0.5 * s[4]),
            Vec3::new(0.0, s[1] - s[3], s[0] - s[2]) * 0.5,
            f,
            rigid(0),
        )
    })
}

/// Girth at a share of the length, and the length; mm.
fn span(slices: &[Slice], f: f32) -> [f32; 2] {
    let (at, length) = places(slices);
    let s = slice_at(slices, &at, f);
    let height = Vec2::new(s[0] - s[2], s[1] - s[3]).length();
    [0.5 * PI * (s[4] + height), length]
}

/// Waxy horn: growth rings across, fine furrows along, worn patches. `f` along, `u` round from the ridge.
fn horn(color: [f32; 3], rings: [f32; 2], f: f32, u: f32) -> Texel {
    let (s, c) = (TAU * u).sin_cos();
    let worn = cloud([2.2 * s, 2.2 * c, 5.0 * f], 11);
    // Rings lie back towards the cutting edges and are of uneven width.
    let place = rings[0] * (f - 0.05 * c) + 0.5 * noise([s, c, 2.5 * f], 23);
    let step = place.rem_euclid(1.0);
    let ring = ease(0.0, 0.75, step) * ease(1.0, 0.9, step);
    let furrow = noise([16.0 * s, 16.0 * c, 3.0 * f], 31);
    let flake = ease(0.15, 0.4, cloud([3.0 * s, 3.0 * c, 9.0 * f], 41));
    let pale = 0.9 + 0.06 * worn + 0.05 * ring + 0.03 * furrow + 0.04 * flake;
    Texel {
        color: color.map(|x| x * pale),
        height: rings[1] * (0.8 * ring + 0.12 * furrow + 0.35 * flake + 0.3 * worn),
        roughness: (0.46 + 0.10 * worn + 0.08 * flake).clamp(0.3, 0.7),
        open: 1.0,
    }
}

/// Soft skin: lumps and grains.
fn skin(color: [f32; 3], f: f32, u: f32, grain: f32) -> Texel {
    let (s, c) = (TAU * u).sin_cos();
    let lump = cloud([3.0 * s, 3.0 * c, 14.0 * f], 53);
    let fine = noise([22.0 * s, 22.0 * c, 70.0 * f], 61);
    Texel {
        color: color.map(|x| x * (0.9 + 0.13 * lump + 0.05 * fine)),
        height: grain * (lump + 0.35 * fine),
        roughness: 0.55 + 0.08 * lump,
        open: 1.0,
    }
}

/// The upper half.
fn upper(b: &Bill, f: f32, u: f32) -> Texel {
    let [base, tip, lower, cere] = b.colors.map(linear);
    let around = TAU * u;
    let (s, c) = around.sin_cos();
    let rough = cloud([2.5 * s, 2.5 * c, 6.0 * f], 71);
    let dark = (f + 0.05 * rough - 0.03 * c - b.dark[0]) / b.dark[1];
    let mut texel = horn(mix(base, tip, ease(0.0, 1.0, dark)), b.rings, f, u);
    // Streaks of dirt and wear run along it.
    let streak = ease(
        0.05,
        0.7,
        noise([5.0 * s, 5.0 * c, 1.6 * f], 73) + 0.5 * rough,
    );
    texel.color = mix(
        texel.color,
        linear(0x9A8262).map(|x| x * texel.color[1] * 1.6),
        0.4 * streak,
    );
    // Horn is stained where it grows out.
    texel.color = mix(
        texel.color,
        texel.color.map(|x| 0.6 * x),
        0.5 * ease(b.cere[0] + 0.14, b.cere[0], f),
    );
    let [height, end] = b.wedge;
    if height > 0.0 {
        // Share of the height above the cutting edge.
        let above = (c - EDGE) / (1.0 - EDGE);
        let rim = height * (1.0 - f / end).max(0.0).powf(0.8) + 0.06;
        let black = ease(0.022, -0.022, above - rim - 0.06 * rough);
        texel.color = mix(texel.color, lower.map(|x| x * (1.0 + 0.3 * rough)), black);
    }
    if c < EDGE {
        texel.color = texel.color.map(|x| 0.55 * x);
        texel.open = 0.6;
    }
    // The cere's edge swings forward below the nostril.
    let edge = b.cere[0] - 0.035 * (2.0 * around).cos() + 0.012 * rough;
    let soft = ease(edge + 0.012, edge - 0.012, f);
    if soft > 0.0 {
        let wax = skin(cere, f, u, 0.16);
        texel.color = mix(texel.color, wax.color, soft);
        texel.height = texel.height * (1.0 - soft) + (wax.height + 0.45) * soft;
        texel.roughness += (wax.roughness - texel.roughness) * soft;
        // Where it meets the horn lies a groove.
        let seam = (-((f - edge) / 0.012).powi(2)).exp();
        texel.open *= 1.0 - 0.45 * seam;
        texel.color = texel.color.map(|x| x * (1.0 - 0.35 * seam));
    }
    nostril(b, f, around, texel)
}

/// Adds the nostril: a hole with a rim.
fn nostril(b: &Bill, f: f32, around: f32, mut texel: Texel) -> Texel {
    let [at, angle, long, high] = b.nostril;
    let [girth, length] = span(b.upper, at);
    let turn = (around.min(TAU - around) - angle.to_radians()) / TAU * girth;
    let along = (f - at) * length;
    // It slants down and forward.
    let p = Vec2::from_angle(-0.7).rotate(Vec2::new(along, turn));
    let d = (p.x / long).hypot(p.y / high);
    let hole = ease(1.15, 0.8, d);
    texel.color = mix(texel.color, linear(0x17110E), hole);
    texel.open *= 1.0 - 0.8 * hole;
    texel.height += 0.3 * ease(2.0, 1.1, d) - 0.9 * hole;
    texel
}

/// The lower half; skin covers its base where it has any.
fn lower(b: &Bill, f: f32, u: f32) -> Texel {
    let [_, _, lower, cere] = b.colors.map(linear);
    let (s, c) = (TAU * u).sin_cos();
    let dull = cloud([2.5 * s, 2.5 * c, 6.0 * f], 83);
    let mut texel = horn(
        lower.map(|x| x * (1.1 + 0.5 * dull)),
        [0.8 * b.rings[0], b.rings[1]],
        f,
        u,
    );
    texel.roughness = (texel.roughness + 0.08).min(0.75);
    let soft = ease(0.03, -0.03, f - b.cere[1] - 0.02 * dull);
    if b.cere[1] > 0.0 {
        let wax = skin(cere, f, u, 0.16);
        texel.color = mix(texel.color, wax.color, soft);
        texel.height = texel.height * (1.0 - soft) + (wax.height + 0.3) * soft;
        texel.roughness += (wax.roughness - texel.roughness) * soft;
    }
    texel
}

/// The rim of the gape, with a furrow where the mouth closes.
fn flesh(b: &Bill, f: f32, u: f32) -> Texel {
    let cere = linear(b.colors[3]);
    // Towards the cheek it loses its color.
    let color = mix(cere, linear(0x6E5330), ease(0.3, 0.9, f));
    let mut texel = skin(color, f, u, 0.14);
    let fold = (-((u - 0.25).abs().min((u - 0.75).abs()) / 0.03).powi(2)).exp();
    texel.height -= 0.5 * fold;
    texel.open = 1.0 - 0.5 * fold;
    texel.color = mix(texel.color, linear(0x6E4A1C), 0.75 * fold);
    texel
}

/// Length of the rim of the gape, mm.
fn gape_length(path: &[[f32; 3]]) -> f32 {
    path.windows(2)
        .map(|p| Vec3::from_array(p[0]).distance(Vec3::from_array(p[1])))
        .sum()
}

/// The fleshy rim of the gape: it leaves the bill, lies down on the cheek and runs out in its feathers.
fn gape(out: &mut Primitive, skeleton: &Skeleton, b: &Bill, body: &Body) {
    let path: Vec<Vec3> = b.gape.iter().map(|p| Vec3::from_array(*p)).collect();
    if path.len() < 2 {
        return;
    }
    let last = path.len() - 1;
    let binding = rigid(skeleton.index("head"));
    let [wide, tall] = b.gape_size;
    for side in [1.0, -1.0] {
        let flip = Vec3::new(side, 1.0, 1.0);
        let rings: Vec<Ring> = (0..=6 * last)
            .map(|i| {
                let at = i as f32 / 6.0;
                let k = (at as usize).min(last - 1);
                let off = path[k].lerp(path[k + 1], at - k as f32);
                let along = (path[k + 1] - path[k]).normalize();
                let across = along.cross(Vec3::Y).normalize();
                let share = at / last as f32;
                let thin = 1.0 - 0.92 * share;
                let skin = body.project(off, 4);
                let centre = off.lerp(
                    skin + body.normal(skin) * (0.9 * wide * (1.0 - 1.6 * share.powi(2))),
                    ease(0.1, 0.5, share),
                );
                Ring::round(
                    centre * flip,
                    across * flip * (wide * thin),
                    Vec3::Y * (tall * thin),
                    share,
                    binding,
                )
            })
            .collect();
        out.tube(&rings, 16, STRIPS[2].v);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slices_are_met_and_the_way_between_is_smooth() {
        for species in crate::species::all() {
            for slices in [species.bill.upper, species.bill.lower] {
                let (at, length) = places(slices);
                for (slice, f) in slices.iter().zip(&at) {
                    for (a, b) in slice.iter().zip(slice_at(slices, &at, *f)) {
                        assert!((a - b).abs() < 1e-3, "{}", species.name);
                    }
                }
                let rings: Vec<_> = sweep(slices, 60).collect();
                for pair in rings.windows(2) {
                    let step = pair[0].centre.distance(pair[1].centre);
                    assert!(step < 0.06 * length, "{}: {step}", species.name);
                }
            }
        }
    }

    #[test]
    fn the_macaws_wedge_is_black_below_and_its_horn_pale_above() {
        let bill = crate::species::all()[0].bill;
        let side = 0.24;
        let bright = |f: f32, u: f32| upper(&bill, f, u).color[1];
        assert!(bright(0.3, 0.06) > 0.4);
        assert!(bright(0.2, side + 0.08) < 0.05);
        assert!(bright(0.97, 0.05) < 0.05, "the tip is dark");
    }
}
