//! A crude scatter of the groom's regions, for the preview only: random roots, straight cards along the lay.

use bevy::math::{Mat4, Vec3};
use bevy_plumage::groom::{Groom, Region, Select};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg32;

use crate::body::Body;
use crate::model::Model;
use crate::plumage;
use crate::preview::Face;
use crate::species::Species;

fn selected(select: &Select, tract: u32) -> bool {
    match select {
        Select::Tract(t) => *t == tract,
        Select::Any(all) => all.iter().any(|s| selected(s, tract)),
        _ => false,
    }
}

/// Cards of all regions in a pose, rigid at their roots.
pub fn cards(species: &Species, model: &Model, groom: &Groom, matrices: &[Mat4]) -> Vec<Face> {
    let body = Body::new(species);
    let mut faces = Vec::new();
    let mut random = Pcg32::seed_from_u64(7);
    for region in &groom.regions {
        region_cards(
            species,
            &body,
            model,
            region,
            matrices,
            &mut random,
            &mut faces,
        );
    }
    faces
}

fn region_cards(
    species: &Species,
    body: &Body,
    model: &Model,
    region: &Region,
    matrices: &[Mat4],
    random: &mut Pcg32,
    faces: &mut Vec<Face>,
) {
    let skin = &model.parts[0].primitive;
    let mut total = 0.0;
    let mut cumulative = Vec::new();
    for t in &skin.triangles {
        let v = t.map(|i| &skin.vertices[i as usize]);
        if !selected(&region.select, v[0].tract[0] as u32) {
            continue;
        }
        total += 0.5
            * (v[1].position - v[0].position)
                .cross(v[2].position - v[0].position)
                .length();
        cumulative.push((total, *t));
    }
    let mut unit = || (random.next_u32() >> 8) as f32 / (1u32 << 24) as f32;
    // Best of several candidates spreads the roots.
    let mut roots: Vec<Vec3> = Vec::new();
    for _ in 0..region.count {
        let mut best: Option<(f32, Vec3, [u32; 3])> = None;
        for _ in 0..6 {
            let target = unit() * total;
            let k = cumulative
                .partition_point(|c| c.0 < target)
                .min(cumulative.len().saturating_sub(1));
            let Some((_, t)) = cumulative.get(k) else {
                return;
            };
            let p = t.map(|i| skin.vertices[i as usize].position);
            let (u, v) = (unit().sqrt(), unit());
            let q = p[0] * (1.0 - u) + p[1] * (u * (1.0 - v)) + p[2] * (u * v);
            let d = roots
                .iter()
                .map(|r| r.distance_squared(q))
                .fold(f32::MAX, f32::min);
            if best.is_none_or(|b| d > b.0) {
                best = Some((d, q, *t));
            }
        }
        let Some((_, q, t)) = best else { return };
        roots.push(q);
        let v = &skin.vertices[t[0] as usize];
        let phi = v.tract[1];
        let along = plumage::lay(species, body, q);
        let normal = body.normal(q);
        let lift = region.lift.at(phi).to_radians();
        let length = region.length.at(phi) * (0.94 + 0.12 * unit());
        let width = region.width.at(phi);
        let shade = 0.9 + 0.2 * unit();
        let color = std::array::from_fn(|c| {
            ((region.tint.0[c] + (region.tint.1[c] - region.tint.0[c]) * phi) * shade).min(1.0)
        });
        let across = normal.cross(along);
        let place = |p: Vec3| -> Vec3 {
            (0..4)
                .map(|k| matrices[v.binding.0[k] as usize].transform_point3(p) * v.binding.1[k])
                .sum()
        };
        // Follows the skin a little: three steps, each projected, then mixed with the straight line.
        let mut line = vec![q];
        let steps = 4;
        let mut at = q;
        let mut step = along * (length / steps as f32);
        for i in 1..=steps {
            let d = plumage::lay(species, body, at);
            let next = body.project(at + d * (length / steps as f32), 1);
            let onward = next - at;
            step = if onward.dot(step) > 0.5 * onward.length() * step.length() {
                onward
            } else {
                step
            };
            at += step;
            let f = i as f32 / steps as f32;
            let straight = q + (along * lift.cos() + normal * lift.sin()) * (length * f);
            let height = (0.6 + region.layer * 0.0015) * species.scale.sqrt() + f;
            line.push((at + body.normal(at) * height).lerp(straight, region.stiffness * f));
        }
        for i in 0..steps {
            let half = |k: usize| {
                let f = k as f32 / steps as f32;
                0.5 * width
                    * (0.45 + 0.55 * (f * 3.0).min(1.0))
                    * (1.0 - 0.75 * (f - 0.7).max(0.0) / 0.3)
            };
            let (a, b) = (half(i), half(i + 1));
            let quad = [
                line[i] - across * a,
                line[i] + across * a,
                line[i + 1] + across * b,
                line[i + 1] - across * b,
            ]
            .map(place);
            faces.push(Face {
                points: [quad[0], quad[1], quad[2]],
                color,
            });
            faces.push(Face {
                points: [quad[0], quad[2], quad[3]],
                color,
            });
        }
    }
}
