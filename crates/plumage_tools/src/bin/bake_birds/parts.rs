//! Hard parts: bill, eyes, lids, feet, claws, as swept tubes.

use bevy::math::{Quat, Vec3};

use crate::skeleton::Skeleton;
use crate::species::{Species, linear};
use crate::weights::Binding;

/// A vertex of a primitive.
#[derive(Clone, Copy, Debug)]
pub struct Vertex {
    /// Position, mm.
    pub position: Vec3,
    /// Unit normal.
    pub normal: Vec3,
    /// Texture coordinates.
    pub uv: [f32; 2],
    /// Tract number and place along it.
    pub tract: [f32; 2],
    /// Linear color.
    pub color: [f32; 3],
    /// Joints and weights.
    pub binding: Binding,
}

/// One primitive.
#[derive(Clone, Debug, Default)]
pub struct Primitive {
    /// Vertices.
    pub vertices: Vec<Vertex>,
    /// Triangles.
    pub triangles: Vec<[u32; 3]>,
}

/// One ring of a tube.
pub struct Ring {
    centre: Vec3,
    across: Vec3,
    up: Vec3,
    color: [f32; 3],
    binding: Binding,
    keel: f32,
}

fn rigid(joint: usize) -> Binding {
    ([joint as u16, 0, 0, 0], [1.0, 0.0, 0.0, 0.0])
}

fn blend(a: usize, b: usize, t: f32) -> Binding {
    ([a as u16, b as u16, 0, 0], [1.0 - t, t, 0.0, 0.0])
}

fn mix(a: [f32; 3], b: [f32; 3], t: f32) -> [f32; 3] {
    std::array::from_fn(|i| a[i] + (b[i] - a[i]) * t.clamp(0.0, 1.0))
}

impl Primitive {
    /// Adds a closed tube through rings; `sides` vertices round each.
    pub fn tube(
        &mut self,
        rings: &[Ring],
        sides: usize,
        paint: impl Fn(usize, f32, [f32; 3]) -> [f32; 3],
    ) {
        let base = self.vertices.len() as u32;
        let stride = sides as u32 + 1;
        for (i, r) in rings.iter().enumerate() {
            for j in 0..=sides {
                let a = std::f32::consts::TAU * j as f32 / sides as f32;
                // A keel sharpens the top of the section.
                let lift = 1.0 + r.keel * a.cos().max(0.0).powi(4);
                let offset = r.across * a.sin() + r.up * (a.cos() * lift);
                self.vertices.push(Vertex {
                    position: r.centre + offset,
                    normal: Vec3::Y,
                    uv: [j as f32 / sides as f32, i as f32 / (rings.len() - 1) as f32],
                    tract: [0.0, 0.0],
                    color: paint(i, a, r.color),
                    binding: r.binding,
                });
            }
        }
        for i in 0..rings.len() as u32 - 1 {
            for j in 0..sides as u32 {
                let a = base + i * stride + j;
                let b = a + stride;
                self.triangles.push([a, b, a + 1]);
                self.triangles.push([a + 1, b, b + 1]);
            }
        }
        for (end, flip) in [(0, false), (rings.len() - 1, true)] {
            let centre = self.vertices.len() as u32;
            let mut v = self.vertices[(base + end as u32 * stride) as usize];
            v.position = rings[end].centre;
            self.vertices.push(v);
            for j in 0..sides as u32 {
                let a = base + end as u32 * stride + j;
                self.triangles.push(if flip {
                    [centre, a + 1, a]
                } else {
                    [centre, a, a + 1]
                });
            }
        }
        self.orient(base);
    }

    /// Turns the triangles that begin at `base` outward and computes smooth normals (welded by position).
    fn orient(&mut self, base: u32) {
        let mut volume = 0.0;
        for t in self.triangles.iter().filter(|t| t[0] >= base) {
            let [a, b, c] = t.map(|i| self.vertices[i as usize].position);
            volume += a.dot(b.cross(c));
        }
        if volume < 0.0 {
            for t in self.triangles.iter_mut().filter(|t| t[0] >= base) {
                t.swap(1, 2);
            }
        }
        let mut sums = std::collections::HashMap::<[i32; 3], Vec3>::new();
        let key = |p: Vec3| (p * 64.0).round().as_ivec3().to_array();
        for t in self.triangles.iter().filter(|t| t[0] >= base) {
            let p = t.map(|i| self.vertices[i as usize].position);
            let n = (p[1] - p[0]).cross(p[2] - p[0]);
            for q in p {
                *sums.entry(key(q)).or_default() += n;
            }
        }
        for v in &mut self.vertices[base as usize..] {
            v.normal = sums
                .get(&key(v.position))
                .copied()
                .unwrap_or(Vec3::Y)
                .normalize_or(Vec3::Y);
        }
    }

    /// Adds the mirror image of everything so far, with joints renamed by `swap`.
    pub fn mirror(&mut self, swap: impl Fn(u16) -> u16) {
        let n = self.vertices.len() as u32;
        let flip = Vec3::new(-1.0, 1.0, 1.0);
        for i in 0..n as usize {
            let mut v = self.vertices[i];
            v.position *= flip;
            v.normal *= flip;
            v.binding.0 = v.binding.0.map(&swap);
            self.vertices.push(v);
        }
        for i in 0..self.triangles.len() {
            let [a, b, c] = self.triangles[i];
            self.triangles.push([a + n, c + n, b + n]);
        }
    }
}

/// Joint on the other side.
pub fn other_side(skeleton: &Skeleton, joint: u16) -> u16 {
    let name = &skeleton.joints[joint as usize].name;
    name.strip_suffix("_L")
        .map_or(joint, |stem| skeleton.index(&format!("{stem}_R")) as u16)
}

/// The bill, both halves.
pub fn bill(species: &Species, skeleton: &Skeleton) -> Primitive {
    let b = &species.bill;
    let mut out = Primitive::default();
    let [base, tip, lower, cere] = b.colors.map(linear);
    let [drop, straight, radius, turn, power] = b.upper_curve;
    let length = straight + radius * turn.to_radians();
    let n = 48;
    let mut centre = Vec3::new(0.0, b.upper_at[0], b.upper_at[1]);
    let mut previous = 0.0;
    let heading = |u: f32| -(drop.to_radians() + ((u - straight) / radius).max(0.0));
    let joint = skeleton.index("upper_bill");
    let mut rings = Vec::new();
    for i in 0..n {
        // Closer rings towards the tip, where the curve is tight.
        let f = 1.0 - (1.0 - i as f32 / (n - 1) as f32).powf(1.25);
        let u = f * length;
        let a = heading(0.5 * (u + previous));
        centre += Vec3::new(0.0, a.sin(), a.cos()) * (u - previous);
        previous = u;
        let a = heading(u);
        let taper = f.powf(power);
        let half = |k: usize| 0.5 * (b.upper_base[k] * (1.0 - taper) + b.upper_tip[k] * taper);
        let horn = mix(base, tip, (f - b.dark[0]) / b.dark[1]);
        let color = match b.cere {
            true if u < straight => cere,
            true => mix(cere, horn, (u - straight) / 2.0),
            false => horn,
        };
        rings.push(Ring {
            centre,
            across: Vec3::X * half(1),
            up: Vec3::new(0.0, a.cos(), -a.sin()) * half(0),
            color,
            binding: rigid(joint),
            keel: 0.10,
        });
    }
    let count = rings.len() as f32;
    out.tube(&rings, 48, |i, a, c| {
        let f = i as f32 / (count - 1.0);
        let dark = linear(0x1F1C1A);
        let side = a.sin().abs();
        if b.wedge && a.cos() < -0.1 {
            return mix(c, dark, (-a.cos() - 0.12 - 0.32 * (0.8 - f).max(0.0)) * 6.0);
        }
        let spot = ((f - b.nostril[0]) / 0.05).powi(2) + ((a.cos() - b.nostril[1]) / 0.14).powi(2);
        if side > 0.3 && spot < 1.0 { dark } else { c }
    });

    let [h, w, len] = b.lower_base;
    let joint = skeleton.index("jaw");
    let rings: Vec<Ring> = (-3..14)
        .map(|i| {
            // The first rings close the base inside the head.
            let hidden = (-i).max(0) as f32 / 3.0;
            let inside = (1.0 - hidden * hidden).max(0.02).sqrt();
            let back = 0.45 * len * hidden;
            let f = i.max(0) as f32 / 13.0;
            let drop = b.lower_axis[0] * f + b.lower_axis[1] * f * f;
            Ring {
                centre: Vec3::new(
                    0.0,
                    b.lower_at[0] + drop + 0.3 * back,
                    b.lower_at[1] + len * f - back,
                ),
                across: Vec3::X * (0.5 * w * inside * (1.0 - b.lower_taper[1] * f * f)),
                up: Vec3::Y * (0.5 * h * inside * (1.0 - b.lower_taper[0] * f * f)),
                color: if b.cere {
                    mix(cere, lower, (f - 0.3) * 6.0)
                } else {
                    lower
                },
                binding: rigid(joint),
                keel: 0.0,
            }
        })
        .collect();
    out.tube(&rings, 20, |_, _, c| c);
    gape(&mut out, skeleton, b.gape, cere);
    out
}

/// The fleshy rim of the gape.
fn gape(out: &mut Primitive, skeleton: &Skeleton, path: &[[f32; 3]], color: [f32; 3]) {
    let path: Vec<Vec3> = path.iter().map(|p| Vec3::from_array(*p)).collect();
    if path.len() < 2 {
        return;
    }
    let last = path.len() - 1;
    let binding = rigid(skeleton.index("head"));
    for side in [1.0, -1.0] {
        let flip = Vec3::new(side, 1.0, 1.0);
        let rings: Vec<Ring> = (0..=4 * last)
            .map(|i| {
                let at = i as f32 / 4.0;
                let k = (at as usize).min(last - 1);
                let centre = path[k].lerp(path[k + 1], at - k as f32);
                let along = (path[k + 1] - path[k]).normalize();
                let across = along.cross(Vec3::Y).normalize();
                let thin = 1.0 - 0.75 * (at / last as f32).powi(4);
                Ring {
                    centre: centre * flip,
                    across: across * flip * (1.7 * thin),
                    up: Vec3::Y * (2.1 * thin),
                    color,
                    binding,
                    keel: 0.0,
                }
            })
            .collect();
        out.tube(&rings, 12, |_, _, c| c);
    }
}

/// Direction the left eye looks.
pub fn gaze(species: &Species) -> Vec3 {
    Vec3::from_array(species.gaze).normalize()
}

/// Axis the lids turn about: positive turns lift the lower lid.
pub fn lid_axis(species: &Species) -> Vec3 {
    Vec3::Y.cross(gaze(species)).normalize() * -1.0
}

/// A cap of a sphere: rings of growing angle about `axis`.
fn cap(
    out: &mut Primitive,
    centre: Vec3,
    axis: Vec3,
    radius: f32,
    opening: f32,
    binding: Binding,
    paint: impl Fn(f32) -> [f32; 3],
    steps: usize,
) {
    let side = axis.any_orthonormal_vector();
    let up = axis.cross(side);
    let rings: Vec<Ring> = (0..=steps)
        .map(|i| {
            let a = (opening * i as f32 / steps as f32).max(0.02);
            Ring {
                centre: centre + axis * (radius * a.cos()),
                across: side * (radius * a.sin()),
                up: up * (radius * a.sin()),
                color: paint(a),
                binding,
                keel: 0.0,
            }
        })
        .collect();
    out.tube(&rings, 24, |_, _, c| c);
}

/// Both eyes.
pub fn eyes(species: &Species, skeleton: &Skeleton) -> Primitive {
    let mut out = Primitive::default();
    let [iris, ..] = species.bare_colors.map(linear);
    let [radius, pupil] = species.eye;
    let edge = (pupil / radius).asin();
    let ring = 0.92;
    let paint = |a: f32| {
        if a < edge {
            linear(0x050505)
        } else if a < ring {
            mix(mix(iris, linear(0x303030), 0.35), iris, (a - edge) / 0.25)
        } else {
            mix(iris, linear(0x201A16), (a - ring) / 0.1)
        }
    };
    let centre = species.joint("eye_L");
    cap(
        &mut out,
        centre,
        gaze(species),
        radius,
        3.1,
        rigid(skeleton.index("eye_L")),
        paint,
        40,
    );
    out.mirror(|j| other_side(skeleton, j));
    out
}

/// Lid rims and the two lids of each eye, opened into the head.
pub fn lids(species: &Species, skeleton: &Skeleton) -> Primitive {
    let mut out = Primitive::default();
    let centre = species.joint("eye_L");
    let axis = gaze(species);
    let r = species.eye[0];
    let skin = linear(species.lids);
    // A torus round the visible part.
    let side = axis.any_orthonormal_vector();
    let up = axis.cross(side);
    let angle = 1.05_f32;
    let thick = 0.13 * r;
    let base = out.vertices.len() as u32;
    let (n, m) = (32, 8);
    for i in 0..n {
        let a = std::f32::consts::TAU * i as f32 / n as f32;
        let radial = side * a.cos() + up * a.sin();
        let ring = centre + axis * (r * angle.cos()) + radial * (r * angle.sin());
        for j in 0..m {
            let b = std::f32::consts::TAU * j as f32 / m as f32;
            let normal = radial * b.cos() + axis * b.sin();
            out.vertices.push(Vertex {
                position: ring + normal * thick,
                normal,
                uv: [i as f32 / n as f32, j as f32 / m as f32],
                tract: [0.0, 0.0],
                color: mix(skin, [0.0; 3], 0.25),
                binding: rigid(skeleton.index("head")),
            });
        }
    }
    for i in 0..n as u32 {
        for j in 0..m as u32 {
            let v = |i: u32, j: u32| base + (i % n as u32) * m as u32 + j % m as u32;
            out.triangles.push([v(i, j), v(i + 1, j), v(i + 1, j + 1)]);
            out.triangles.push([v(i, j), v(i + 1, j + 1), v(i, j + 1)]);
        }
    }
    let turn = lid_axis(species);
    for (joint, degrees, opening) in [("lid_lo_L", -118.0_f32, 0.95), ("lid_up_L", 112.0, 0.75)] {
        let open = Quat::from_axis_angle(turn, degrees.to_radians()) * axis;
        cap(
            &mut out,
            centre,
            open,
            r * 1.06,
            opening,
            rigid(skeleton.index(joint)),
            |_| skin,
            8,
        );
    }
    out.mirror(|j| other_side(skeleton, j));
    out
}

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

/// Bare tarsi and toes.
pub fn feet(species: &Species, skeleton: &Skeleton) -> Primitive {
    let mut out = Primitive::default();
    let [_, _, skin, _] = species.bare_colors.map(linear);
    let ankle = species.joint("tarsus_L");
    let foot = species.joint("foot_L");
    let (tarsus, foot_joint) = (skeleton.index("tarsus_L"), skeleton.index("foot_L"));
    let axis = (foot - ankle).normalize();
    let across = Vec3::X.reject_from(axis).normalize();
    let up = axis.cross(across);
    let [r0, r1] = species.legs[2];
    let from = if species.feathered_tarsus { 0.8 } else { -0.15 };
    let n = 14;
    let rings: Vec<Ring> = (0..n)
        .map(|i| {
            let f = from + (1.04 - from) * i as f32 / (n - 1) as f32;
            let knob = 1.0 + 0.05 * if i % 2 == 0 { 1.0 } else { -1.0 };
            let r = (r0 + (r1 - r0) * f) * if species.feathered_tarsus { 0.8 } else { 1.0 } * knob;
            Ring {
                centre: ankle.lerp(foot, f),
                across: across * r,
                up: up * r,
                color: mix(skin, [0.0; 3], if i % 2 == 0 { 0.0 } else { 0.25 }),
                binding: blend(tarsus, foot_joint, ((f - 0.8) / 0.25).clamp(0.0, 1.0)),
                keel: 0.0,
            }
        })
        .collect();
    out.tube(&rings, 12, |_, _, c| c);
    for toe in 0..4 {
        let a = skeleton.index(&format!("toe{}a_L", toe + 1));
        let b = skeleton.index(&format!("toe{}b_L", toe + 1));
        let n = 20;
        let rings: Vec<Ring> = (0..n)
            .map(|i| {
                let f = i as f32 / (n - 1) as f32;
                let (centre, outward) = toe_path(species, toe, f);
                let pad = 1.0 + 0.09 * (f * 3.0 * std::f32::consts::TAU).cos();
                let scale = if i % 2 == 0 { 0.97 } else { 1.03 };
                let r = (species.toe_radius[0]
                    + (species.toe_radius[1] - species.toe_radius[0]) * f)
                    * pad
                    * scale;
                let r = r * if i == n - 1 { 0.7 } else { 1.0 };
                let binding = if f < 0.1 {
                    blend(foot_joint, a, f * 10.0)
                } else {
                    blend(a, b, ((f - 0.45) / 0.2).clamp(0.0, 1.0))
                };
                Ring {
                    centre,
                    across: Vec3::X * r,
                    up: outward * r,
                    color: mix(skin, [0.0; 3], if i % 2 == 0 { 0.0 } else { 0.3 }),
                    binding,
                    keel: 0.0,
                }
            })
            .collect();
        out.tube(&rings, 12, |_, _, c| c);
    }
    out.mirror(|j| other_side(skeleton, j));
    out
}

/// Claws.
pub fn claws(species: &Species, skeleton: &Skeleton) -> Primitive {
    let mut out = Primitive::default();
    let horn = linear(species.bare_colors[3]);
    for toe in 0..4 {
        let b = skeleton.index(&format!("toe{}b_L", toe + 1));
        let (root, outward) = toe_path(species, toe, 0.97);
        let sign = if species.backward[toe] { -1.0 } else { 1.0 };
        // Starts along the toe, curls off and down round an arc of 75 degrees.
        let tangent = Vec3::X.cross(outward) * sign;
        let length = species.claws[toe];
        let sweep = 1.3_f32;
        let radius = length / sweep;
        let rings: Vec<Ring> = (0..10)
            .map(|i| {
                let f = i as f32 / 9.0;
                let a = f * sweep;
                let lift = 0.35 * species.toe_radius[1];
                let centre = root + outward * lift + tangent * (radius * a.sin())
                    - outward * (radius * (1.0 - a.cos()) * 0.8);
                let r = 0.78 * species.toe_radius[1] * (1.0 - 0.93 * f.powf(1.3));
                let along = (tangent * a.cos() - outward * a.sin() * 0.8).normalize();
                Ring {
                    centre,
                    across: Vec3::X * r * 0.8,
                    up: along.cross(Vec3::X).normalize() * r,
                    color: mix(horn, [0.2; 3], 0.15 * (1.0 - f)),
                    binding: rigid(b),
                    keel: 0.0,
                }
            })
            .collect();
        out.tube(&rings, 10, |_, _, c| c);
    }
    out.mirror(|j| other_side(skeleton, j));
    out
}
