//! A small software rasteriser: shaded pictures of the skinned bird and its rows, to judge the rig by eye.

use std::path::Path;

use bevy::math::{Mat4, Quat, Vec3};
use bevy_plumage::groom::{Groom, JointWeight, Row, Station};
use image::{Rgb, RgbImage};

use crate::idle;
use crate::model::Model;
use crate::skeleton::{Pose, Skeleton};
use crate::species::Species;

/// A triangle with one color (sRGB 0..1).
pub struct Face {
    /// Corners.
    pub points: [Vec3; 3],
    /// Color.
    pub color: [f32; 3],
}

fn to_srgb(c: f32) -> f32 {
    if c <= 0.0031308 {
        12.92 * c
    } else {
        1.055 * c.powf(1.0 / 2.4) - 0.055
    }
}

/// Skinned triangles of the model.
fn skinned(model: &Model, matrices: &[Mat4], faces: &mut Vec<Face>, lighten: f32) {
    for part in &model.parts {
        let p = &part.primitive;
        let place: Vec<Vec3> = p
            .vertices
            .iter()
            .map(|v| {
                (0..4)
                    .map(|k| {
                        matrices[v.binding.0[k] as usize].transform_point3(v.position)
                            * v.binding.1[k]
                    })
                    .sum()
            })
            .collect();
        for t in &p.triangles {
            let color = std::array::from_fn(|c| {
                let mean = t
                    .iter()
                    .map(|i| p.vertices[*i as usize].color[c])
                    .sum::<f32>()
                    / 3.0;
                to_srgb(mean) * if part.skin { lighten } else { 1.0 }
            });
            faces.push(Face {
                points: t.map(|i| place[i as usize]),
                color,
            });
        }
    }
}

/// Weighted blend of joint rotations, as the groom module does it.
pub fn blended(
    skeleton: &Skeleton,
    rotations: &[Quat],
    follow: &[JointWeight],
    right: bool,
) -> Quat {
    let mut sum = Quat::from_xyzw(0.0, 0.0, 0.0, 0.0);
    let mut first: Option<Quat> = None;
    for JointWeight { joint, weight, .. } in follow {
        let name = if right {
            joint.replace("_L", "_R")
        } else {
            joint.clone()
        };
        let mut q = rotations[skeleton.index(&name)];
        let reference = *first.get_or_insert(q);
        if q.dot(reference) < 0.0 {
            q = -q;
        }
        sum += q * *weight;
    }
    if sum.length_squared() > 1e-12 {
        sum.normalize()
    } else {
        Quat::IDENTITY
    }
}

/// Interpolated place `t` of a row.
fn station(row: &Row, t: f32) -> (Station, f32) {
    let k = row
        .stations
        .partition_point(|s| s.at <= t + 1e-6)
        .clamp(1, row.stations.len() - 1);
    let (a, b) = (&row.stations[k - 1], &row.stations[k]);
    let u = ((t - a.at) / (b.at - a.at).max(1e-6)).clamp(0.0, 1.0);
    let mix = |x: [f32; 3], y: [f32; 3]| Vec3::from(x).lerp(Vec3::from(y), u).to_array();
    let blend = |x: &[JointWeight], y: &[JointWeight]| {
        let scaled = |w: &JointWeight, by: f32| JointWeight::new(w.joint.clone(), w.weight * by);
        let mut out: Vec<_> = x.iter().map(|w| scaled(w, 1.0 - u)).collect();
        for w in y {
            match out.iter_mut().find(|known| known.joint == w.joint) {
                Some(slot) => slot.weight += w.weight * u,
                None => out.push(scaled(w, u)),
            }
        }
        out
    };
    let mut station = Station::new(
        t,
        mix(a.root, b.root),
        mix(a.direction, b.direction),
        mix(a.normal, b.normal),
    );
    station.ride = blend(&a.ride, &b.ride);
    station.follow = blend(&a.follow, &b.follow);
    (station, u)
}

/// One posed feather of a row.
pub struct Posed {
    /// Root.
    pub root: Vec3,
    /// Rachis.
    pub direction: Vec3,
    /// Front normal.
    pub normal: Vec3,
    /// Length.
    pub length: f32,
    /// Width.
    pub width: f32,
}

fn lifted(q: Quat, direction: [f32; 3], normal: [f32; 3], flip: Vec3, degrees: f32) -> Vec3 {
    let a = degrees.to_radians();
    let d = (Vec3::from(direction) * flip).normalize_or_zero() * a.cos();
    q * (d + (Vec3::from(normal) * flip).normalize_or_zero() * a.sin())
}

/// Feathers of a row in a pose.
pub fn pose_row(
    skeleton: &Skeleton,
    matrices: &[Mat4],
    rotations: &[Quat],
    row: &Row,
    right: bool,
) -> Vec<Posed> {
    let n = row.lengths.len();
    let flip = if right {
        Vec3::new(-1.0, 1.0, 1.0)
    } else {
        Vec3::ONE
    };
    (0..n)
        .map(|i| {
            let t = if n > 1 {
                i as f32 / (n - 1) as f32
            } else {
                0.0
            };
            let (s, _) = station(row, t);
            let q = blended(skeleton, rotations, &s.follow, right);
            let at = Vec3::from(s.root) * flip;
            let total: f32 = s.ride.iter().map(|r| r.weight).sum();
            let root = s
                .ride
                .iter()
                .map(|w| {
                    let name = if right {
                        w.joint.replace("_L", "_R")
                    } else {
                        w.joint.clone()
                    };
                    matrices[skeleton.index(&name)].transform_point3(at) * (w.weight / total)
                })
                .sum();
            Posed {
                root,
                direction: lifted(q, s.direction, s.normal, flip, row.lift.at(t)),
                normal: q * (Vec3::from(s.normal) * flip).normalize_or_zero(),
                length: row.lengths[i],
                width: row.width.at(t),
            }
        })
        .collect()
}

fn cards(
    groom: &Groom,
    skeleton: &Skeleton,
    pose: &Pose,
    matrices: &[Mat4],
    faces: &mut Vec<Face>,
) {
    let rotations = skeleton.rotations(pose);
    for row in &groom.rows {
        for right in [false, true] {
            if right && !row.mirror {
                continue;
            }
            let n = row.lengths.len();
            for (i, f) in pose_row(skeleton, matrices, &rotations, row, right)
                .iter()
                .enumerate()
            {
                let t = i as f32 / (n.max(2) - 1) as f32;
                let across = f.normal.cross(f.direction).normalize_or_zero();
                let shade = 0.92 + 0.16 * (i % 2) as f32;
                let color = std::array::from_fn(|c| {
                    ((row.tint.0[c] + (row.tint.1[c] - row.tint.0[c]) * t) * shade).min(1.0)
                });
                let half = |v: f32| {
                    let tip = ((1.0 - v) / 0.18).clamp(0.0, 1.0);
                    0.5 * f.width * (0.25 + 0.75 * (v / 0.15).min(1.0)) * tip.sqrt()
                };
                let steps = 10;
                for k in 0..steps {
                    let (a, b) = (k as f32 / steps as f32, (k + 1) as f32 / steps as f32);
                    let p = |v: f32, s: f32| {
                        f.root + f.direction * (f.length * v) + across * (s * half(v))
                    };
                    let quad = [p(a, -1.0), p(a, 1.0), p(b, 1.0), p(b, -1.0)];
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
    }
}

/// Draws the faces seen along `-from`, fitted to `height` pixels.
pub fn draw(faces: &[Face], from: Vec3, size: u32, window: Option<(Vec3, f32)>) -> RgbImage {
    let f = from.normalize();
    let up = if f.y.abs() > 0.95 { Vec3::Z } else { Vec3::Y };
    let r = up.cross(f).normalize();
    let u = f.cross(r);
    let view = |p: Vec3| Vec3::new(p.dot(r), p.dot(u), p.dot(f));
    let (mut low, mut high) = (Vec3::splat(f32::MAX), Vec3::splat(f32::MIN));
    for face in faces {
        for p in face.points {
            low = low.min(view(p));
            high = high.max(view(p));
        }
    }
    if let Some((centre, radius)) = window {
        low = view(centre) - Vec3::splat(radius);
        high = view(centre) + Vec3::splat(radius);
    }
    let extent = (high.x - low.x).max(high.y - low.y).max(1.0);
    let scale = size as f32 * 0.96 / extent;
    let middle = 0.5 * (low + high);
    let mut image = RgbImage::from_pixel(size, size, Rgb([236, 236, 236]));
    let mut depth = vec![f32::MIN; (size * size) as usize];
    let light = (r * 0.4 + u * 0.75 + f * 0.5).normalize();
    let half = 0.5 * size as f32;
    for face in faces {
        let p = face.points.map(view).map(|v| {
            Vec3::new(
                (v.x - middle.x) * scale + half,
                half - (v.y - middle.y) * scale,
                v.z,
            )
        });
        let area = (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[2].x - p[0].x) * (p[1].y - p[0].y);
        if area.abs() < 1e-6 {
            continue;
        }
        let n = (face.points[1] - face.points[0])
            .cross(face.points[2] - face.points[0])
            .normalize_or_zero();
        let n = if n.dot(f) < 0.0 { -n } else { n };
        let shade = 0.35 + 0.5 * n.dot(light).max(0.0) + 0.25 * n.dot(f).max(0.0);
        let rgb = Rgb(face
            .color
            .map(|c| (255.0 * (c * shade).clamp(0.0, 1.0)) as u8));
        let limit = size as f32 - 1.0;
        let range = |k: fn(&Vec3) -> f32| {
            let v = p.each_ref().map(k);
            let lo = v
                .iter()
                .copied()
                .fold(f32::MAX, f32::min)
                .floor()
                .clamp(0.0, limit);
            let hi = v
                .iter()
                .copied()
                .fold(f32::MIN, f32::max)
                .ceil()
                .clamp(0.0, limit);
            (lo as u32, hi as u32)
        };
        let ((x0, x1), (y0, y1)) = (range(|v| v.x), range(|v| v.y));
        for y in y0..=y1 {
            for x in x0..=x1 {
                let (cx, cy) = (x as f32 + 0.5, y as f32 + 0.5);
                let w =
                    |a: Vec3, b: Vec3| ((b.x - a.x) * (cy - a.y) - (b.y - a.y) * (cx - a.x)) / area;
                let (c, a, b) = (w(p[0], p[1]), w(p[1], p[2]), w(p[2], p[0]));
                if a < 0.0 || b < 0.0 || c < 0.0 {
                    continue;
                }
                let z = a * p[0].z + b * p[1].z + c * p[2].z;
                let slot = &mut depth[(y * size + x) as usize];
                if z > *slot {
                    *slot = z;
                    image.put_pixel(x, y, rgb);
                }
            }
        }
    }
    image
}

/// Writes the sheets of one bird: body alone and with rows, in bind, folded, stretched and spread pose. (The whole coat is what
/// the `groom_preview` example draws.)
pub fn sheets(species: &Species, model: &Model, groom: &Groom, dir: &Path) -> Result<(), String> {
    let skeleton = &model.skeleton;
    let bind = skeleton.bind();
    let middle = species.motion.stretched;
    let mut spread = skeleton.bind();
    idle::set_wings(species, skeleton, &mut spread, [species.spread; 2]);
    let poses = [
        ("bind", bind),
        ("fold", idle::pose(species, skeleton, 0.0)),
        ("mid", idle::pose(species, skeleton, middle)),
        ("spread", spread),
    ];
    let views = [
        Vec3::X,
        Vec3::Z,
        Vec3::new(0.75, 0.25, 0.75),
        Vec3::Y,
        Vec3::NEG_Z,
        Vec3::new(0.7, 0.35, -0.75),
        Vec3::new(0.3, -0.8, 0.5),
        Vec3::new(0.25, 0.85, -0.55),
    ];
    for (name, pose) in &poses {
        let matrices = skeleton.matrices(pose);
        for (level, suffix) in ["", "_rows"].iter().enumerate() {
            let mut faces = Vec::new();
            skinned(model, &matrices, &mut faces, 1.6);
            if level > 0 {
                cards(groom, skeleton, pose, &matrices, &mut faces);
            }
            let size = 480;
            let mut sheet = RgbImage::new(size * 4, size * 2);
            for (i, v) in views.iter().enumerate() {
                let picture = draw(&faces, *v, size, None);
                image::imageops::replace(
                    &mut sheet,
                    &picture,
                    (i as u32 % 4 * size).into(),
                    (i as u32 / 4 * size).into(),
                );
            }
            let file = dir.join(format!("{}_{name}{}.png", species.name, suffix));
            sheet
                .save(&file)
                .map_err(|e| format!("{}: {e}", file.display()))?;
            if *name == "fold" && level == 0 {
                let centre = species.joint("head") + Vec3::new(0.0, 10.0, 25.0);
                let radius = species.head.iter().map(|s| s[2]).fold(0.0, f32::max);
                let mut sheet = RgbImage::new(size * 4, size);
                for (i, v) in [views[0], views[2], views[1], Vec3::new(0.5, -0.4, 0.8)]
                    .iter()
                    .enumerate()
                {
                    let picture = draw(&faces, *v, size, Some((centre, radius)));
                    image::imageops::replace(&mut sheet, &picture, (i as u32 * size).into(), 0);
                }
                let file = dir.join(format!("{}_head.png", species.name));
                sheet
                    .save(&file)
                    .map_err(|e| format!("{}: {e}", file.display()))?;
                let centre = species.joint("foot_L") * Vec3::new(0.0, 1.0, 1.0);
                let mut sheet = RgbImage::new(size * 3, size);
                for (i, v) in [views[0], views[2], views[1]].iter().enumerate() {
                    let picture = draw(&faces, *v, size, Some((centre, radius)));
                    image::imageops::replace(&mut sheet, &picture, (i as u32 * size).into(), 0);
                }
                let file = dir.join(format!("{}_feet.png", species.name));
                sheet
                    .save(&file)
                    .map_err(|e| format!("{}: {e}", file.display()))?;
            }
        }
    }
    Ok(())
}
