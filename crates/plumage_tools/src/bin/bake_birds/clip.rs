//! Cuts the skin where the color of its tracts changes, so that such borders are smooth lines.

use std::collections::HashMap;

use bevy::math::Vec3;

use crate::body::Body;
use crate::nets::Surface;
use crate::species::Tract;
use crate::tract;

/// Splits edges inside a region at their middles, so that it gets four times the triangles.
pub fn refine(body: &Body, surface: &mut Surface, inside: impl Fn(Vec3) -> bool) {
    let mut cuts: HashMap<(u32, u32), Option<u32>> = HashMap::new();
    let mut out = Vec::with_capacity(surface.triangles.len() * 3 / 2);
    for t in std::mem::take(&mut surface.triangles) {
        let mut cut = |a: u32, b: u32| {
            let key = (a.min(b), a.max(b));
            *cuts.entry(key).or_insert_with(|| {
                let p = surface.points[a as usize].midpoint(surface.points[b as usize]);
                inside(p).then(|| {
                    surface.points.push(body.project(p, 2));
                    surface.points.len() as u32 - 1
                })
            })
        };
        let m = [cut(t[0], t[1]), cut(t[1], t[2]), cut(t[2], t[0])];
        let count = m.iter().flatten().count();
        // Turn the corner that the cases below name first to the front.
        let first = (0..3)
            .find(|i| {
                if count == 1 {
                    m[*i].is_some()
                } else {
                    m[(*i + 1) % 3].is_none()
                }
            })
            .unwrap_or(0);
        let [a, b, c] = [0, 1, 2].map(|i| t[(first + i) % 3]);
        match [0, 1, 2].map(|i| m[(first + i) % 3]) {
            [Some(ab), Some(bc), Some(ca)] => {
                out.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]])
            }
            [Some(ab), None, Some(ca)] => out.extend([[a, ab, ca], [ab, b, c], [ab, c, ca]]),
            [Some(ab), None, None] => out.extend([[a, ab, c], [ab, b, c]]),
            _ => out.push(t),
        }
    }
    surface.triangles = out;
}

/// Splits triangles that span two colors; returns one tract per triangle of the new surface.
pub fn clip(body: &Body, surface: &mut Surface) -> Vec<Tract> {
    let skin = |t: Tract| body.species.skin_color(t);
    let class: Vec<Tract> = surface
        .points
        .iter()
        .map(|p| tract::classify(body, *p))
        .collect();
    let mut cuts: HashMap<(u32, u32), u32> = HashMap::new();
    let mut out: Vec<([u32; 3], Tract)> = Vec::with_capacity(surface.triangles.len() * 5 / 4);
    for t in std::mem::take(&mut surface.triangles) {
        let own = t.map(|i| class[i as usize]);
        let k = own.map(skin);
        let mut cut = |a: u32, b: u32, surface: &mut Surface| {
            let key = (a.min(b), a.max(b));
            *cuts.entry(key).or_insert_with(|| {
                let p = crossing(
                    body,
                    surface.points[key.0 as usize],
                    surface.points[key.1 as usize],
                );
                surface.points.push(p);
                surface.points.len() as u32 - 1
            })
        };
        if k[0] == k[1] && k[1] == k[2] {
            out.push((t, own[0]));
        } else if let Some(odd) = (0..3).find(|i| k[(i + 1) % 3] == k[(i + 2) % 3]) {
            let [a, b, c] = [t[odd], t[(odd + 1) % 3], t[(odd + 2) % 3]];
            let (ab, ca) = (cut(a, b, surface), cut(c, a, surface));
            let rest = own[(odd + 1) % 3];
            out.extend([
                ([a, ab, ca], own[odd]),
                ([ab, b, c], rest),
                ([ab, c, ca], rest),
            ]);
        } else {
            let [ab, bc, ca] = [
                cut(t[0], t[1], surface),
                cut(t[1], t[2], surface),
                cut(t[2], t[0], surface),
            ];
            out.extend([
                ([t[0], ab, ca], own[0]),
                ([t[1], bc, ab], own[1]),
                ([t[2], ca, bc], own[2]),
                ([ab, bc, ca], own[0]),
            ]);
        }
    }
    // The centre decides between tracts of one color; a corner decides the color.
    let tracts = out
        .iter()
        .map(|(t, corner)| {
            let centre = t.iter().map(|i| surface.points[*i as usize]).sum::<Vec3>() / 3.0;
            let middle = tract::classify(body, centre);
            if skin(middle) == skin(*corner) {
                middle
            } else {
                *corner
            }
        })
        .collect();
    surface.triangles = out.into_iter().map(|(t, _)| t).collect();
    tracts
}

/// Where the tract of `a` ends on the edge to `b`, kept off the ends.
fn crossing(body: &Body, a: Vec3, b: Vec3) -> Vec3 {
    let color = |p: Vec3| body.species.skin_color(tract::classify(body, p));
    let own = color(a);
    let (mut low, mut high) = (0.0_f32, 1.0_f32);
    for _ in 0..8 {
        let middle = 0.5 * (low + high);
        if color(a.lerp(b, middle)) == own {
            low = middle;
        } else {
            high = middle;
        }
    }
    body.project(a.lerp(b, (0.5 * (low + high)).clamp(0.08, 0.92)), 1)
}
