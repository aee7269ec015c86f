//! The lay of the plumage: a tangent direction at every node of the skin, interpolated from guides.

use super::{asset::Guide, nearest::PointTree, skin::SkinMesh};
use bevy::math::{Quat, Vec3};

/// Guide segments blended at a node.
const NEAREST: usize = 8;
/// Passes of smoothing over the node graph.
const SMOOTHING: usize = 8;
/// Lay where no guide says otherwise: towards the ground and the tail (glTF axes).
pub const DEFAULT_LAY: Vec3 = Vec3::new(0.0, -0.6, -0.8);

/// Sine of the angle between the default lay and the skin's normal below which feathers turn outwards.
const PARTED: f32 = 0.9;
/// Distance from the middle at which they do so wholly, over the skin's diagonal.
const BESIDE: f32 = 0.05;
/// Reach of the smoothing of a lay without guides, over the skin's diagonal.
const EVEN: f32 = 0.04;

/// One short piece of a guide.
struct Stroke {
    middle: Vec3,
    direction: Vec3,
    normal: Vec3,
}

/// Projects a direction into the plane of a unit normal; unit length, or `None` if nothing is left.
pub fn tangent(direction: Vec3, normal: Vec3) -> Option<Vec3> {
    (direction - normal * direction.dot(normal)).try_normalize()
}

/// Unit tangent of the lay at each node. `unit`: metres per unit of the guides.
///
/// Each node blends the eight nearest guide strokes by 1/(d^3 + e^3) (docs/book/birds.md#lay). A stroke is carried from
/// the normal of the skin below it to the node's normal, and counts less the more these differ: so the upper face of a wing
/// does not follow the guides of the lower.
pub fn lay_field<'a>(
    skin: &SkinMesh,
    guides: impl Iterator<Item = &'a Guide>,
    unit: f32,
) -> Vec<Vec3> {
    let strokes = strokes(skin, guides, unit);
    let (low, high) = extent(skin);
    let middle = 0.5 * (low.x + high.x);
    let side = (BESIDE * (high - low).length()).max(f32::MIN_POSITIVE);
    let default = |node: Vec3, normal: Vec3| {
        let flat = DEFAULT_LAY - normal * DEFAULT_LAY.dot(normal);
        // Where the skin faces the lay (the front edge of a wing) feathers would point away from a line, and leave it bare: there
        // they turn outwards, as marginal coverts do. Not so on the forehead, where the line is no longer than a point.
        let out = Vec3::X * ((node.x - middle) / side).clamp(-1.0, 1.0);
        let turned = flat + out * (PARTED - flat.length()).max(0.0);
        tangent(turned, normal)
            .or_else(|| tangent(Vec3::NEG_Y, normal))
            .unwrap_or_else(|| normal.any_orthonormal_vector())
    };
    if strokes.is_empty() {
        let nodes = skin.nodes.iter().zip(&skin.normals);
        let mut field: Vec<Vec3> = nodes
            .map(|(node, normal)| default(*node, *normal))
            .collect();
        let reach = EVEN * (high - low).length() / skin.mean_edge().max(f32::MIN_POSITIVE);
        smooth(skin, &mut field, (reach * reach).clamp(8.0, 400.0) as usize);
        follow_mask(skin, &mut field);
        return field;
    }
    let tree = PointTree::new(strokes.iter().map(|stroke| stroke.middle));
    let near = (skin.mean_edge() * 0.5).powi(3);
    let mut field: Vec<Vec3> = skin
        .nodes
        .iter()
        .zip(&skin.normals)
        .map(|(node, &normal)| {
            let found = tree.nearest(*node, NEAREST);
            let sum = found.into_iter().fold(Vec3::ZERO, |sum, found| {
                let stroke = &strokes[found.number as usize];
                let facing = (0.5 + 0.5 * stroke.normal.dot(normal)).clamp(0.02, 1.0);
                // Carried round more than a quarter turn a direction means nothing (over the chin it would come out reversed).
                let carried = if stroke.normal.dot(normal) > 0.3 {
                    Quat::from_rotation_arc(stroke.normal, normal) * stroke.direction
                } else {
                    stroke.direction
                };
                sum + carried * (facing * facing / (found.squared.powf(1.5) + near))
            });
            tangent(sum, normal).unwrap_or_else(|| default(*node, normal))
        })
        .collect();
    smooth(skin, &mut field, SMOOTHING);
    follow_mask(skin, &mut field);
    field
}

/// Where a mask says how feathers lie it has the last word.
fn follow_mask(skin: &SkinMesh, field: &mut [Vec3]) {
    for (node, lay) in skin.mask_lay() {
        if let Some(lay) = tangent(lay, skin.normals[node]) {
            field[node] = lay;
        }
    }
}

/// The box around the skin.
fn extent(skin: &SkinMesh) -> (Vec3, Vec3) {
    let nodes = || skin.nodes.iter().copied();
    (
        nodes().fold(Vec3::INFINITY, Vec3::min),
        nodes().fold(Vec3::NEG_INFINITY, Vec3::max),
    )
}

fn smooth(skin: &SkinMesh, field: &mut Vec<Vec3>, passes: usize) {
    let mut next = field.clone();
    for _ in 0..passes {
        for (node, value) in next.iter_mut().enumerate() {
            let ring = skin.neighbors(node);
            let mean = ring
                .iter()
                .fold(Vec3::ZERO, |sum, &other| sum + field[other as usize])
                / ring.len().max(1) as f32;
            *value = tangent(field[node] + mean, skin.normals[node]).unwrap_or(field[node]);
        }
        std::mem::swap(field, &mut next);
    }
}

/// Cuts the guides into strokes no longer than a few triangles, and finds the skin's normal below each.
fn strokes<'a>(skin: &SkinMesh, guides: impl Iterator<Item = &'a Guide>, unit: f32) -> Vec<Stroke> {
    let step = skin.mean_edge() * 2.0;
    let mut strokes = Vec::new();
    for guide in guides {
        let sides: &[f32] = if guide.mirror { &[1.0, -1.0] } else { &[1.0] };
        for side in sides {
            let flip = Vec3::new(*side, 1.0, 1.0) * unit;
            for pair in guide.points.windows(2) {
                let (a, b) = (
                    Vec3::from_array(pair[0]) * flip,
                    Vec3::from_array(pair[1]) * flip,
                );
                let Some(direction) = (b - a).try_normalize() else {
                    continue;
                };
                let count = ((b - a).length() / step).ceil().clamp(1.0, 64.0) as usize;
                for i in 0..count {
                    let middle = a.lerp(b, (i as f32 + 0.5) / count as f32);
                    strokes.push(Stroke {
                        middle,
                        direction,
                        normal: Vec3::ZERO,
                    });
                }
            }
        }
    }
    let tree = PointTree::new(skin.nodes.iter().copied());
    for stroke in &mut strokes {
        let Some(node) = tree.nearest(stroke.middle, 1).first().copied() else {
            continue;
        };
        stroke.normal = skin.normals[node.number as usize];
        stroke.direction = tangent(stroke.direction, stroke.normal).unwrap_or(stroke.direction);
    }
    strokes
}

/// Arc length along the lay at each node: the function whose slope is closest to the lay (least squares over the edges of the
/// node graph, solved by conjugate gradients). It orders feathers from head to tail where the mesh brings no phi of its own.
pub fn arc_length(skin: &SkinMesh, field: &[Vec3]) -> Vec<f32> {
    let count = skin.nodes.len();
    let apply = |x: &[f32]| -> Vec<f32> {
        (0..count)
            .map(|i| {
                skin.neighbors(i)
                    .iter()
                    .map(|&j| x[i] - x[j as usize])
                    .sum()
            })
            .collect()
    };
    let target: Vec<f32> = (0..count)
        .map(|i| {
            let edges = skin.neighbors(i).iter();
            -edges
                .map(|&j| {
                    (skin.nodes[j as usize] - skin.nodes[i]).dot(field[i] + field[j as usize]) * 0.5
                })
                .sum::<f32>()
        })
        .collect();
    let dot = |a: &[f32], b: &[f32]| {
        a.iter()
            .zip(b)
            .map(|(x, y)| f64::from(*x) * f64::from(*y))
            .sum::<f64>()
    };
    let mut x: Vec<f32> = skin
        .nodes
        .iter()
        .map(|node| node.dot(DEFAULT_LAY))
        .collect();
    let image = apply(&x);
    let mut residual: Vec<f32> = target.iter().zip(&image).map(|(b, a)| b - a).collect();
    let mut search = residual.clone();
    let mut energy = dot(&residual, &residual);
    let enough = energy * 1.0e-8;
    for _ in 0..400 {
        if energy <= enough || energy < f64::MIN_POSITIVE {
            break;
        }
        let image = apply(&search);
        let curvature = dot(&search, &image);
        if curvature.is_nan() || curvature <= 0.0 {
            break;
        }
        let step = (energy / curvature) as f32;
        for i in 0..count {
            x[i] += step * search[i];
            residual[i] -= step * image[i];
        }
        let next = dot(&residual, &residual);
        let keep = (next / energy) as f32;
        energy = next;
        search
            .iter_mut()
            .zip(&residual)
            .for_each(|(s, r)| *s = r + keep * *s);
    }
    x
}
