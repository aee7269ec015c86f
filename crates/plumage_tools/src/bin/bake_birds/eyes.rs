//! Eyes, their lids, and the ridge above them.

use std::f32::consts::TAU;

use bevy::math::{Quat, Vec2, Vec3};

use crate::body::Body;
use crate::maps::{Maps, Strip, Texel, cloud, ease, mix, noise};
use crate::skeleton::Skeleton;
use crate::species::{Ledge, Species, linear};
use crate::tube::{Primitive, Ring, Vertex, other_side, rigid};

/// Half the angle of the sphere that is drawn, radians; the rest lies in the head.
const BALL: f32 = 1.45;
/// Rings from the middle of an eye outwards, and vertices round each.
const GRID: [usize; 2] = [20, 40];
/// Rings of the lids outwards, and vertices round each.
const LIDS: [usize; 2] = [12, 48];
/// Strips of the lids' texture: the lids, the ledge above.
const STRIPS: [Strip; 2] = [Strip { v: [0.0, 0.6] }, Strip { v: [0.62, 1.0] }];

/// Direction the left eye looks. Its ball and its lids lie about the joints of the lids.
pub fn gaze(species: &Species) -> Vec3 {
    Vec3::from_array(species.gaze).normalize()
}

/// Axis the lids turn about: positive turns lift the lower lid.
pub fn lid_axis(species: &Species) -> Vec3 {
    Vec3::Y.cross(gaze(species)).normalize() * -1.0
}

/// Directions to the side and up, seen along the gaze of the left eye.
fn frame(species: &Species) -> [Vec3; 2] {
    let axis = gaze(species);
    let up = Vec3::Y.reject_from(axis).normalize();
    [up.cross(axis), up]
}

/// Both eyes with their texture: a view of the iris along the gaze, up is v = 0.
pub fn eyes(species: &Species, skeleton: &Skeleton) -> (Primitive, Maps) {
    let strip = Strip { v: [0.0, 1.0] };
    let width = 2.0 * species.eye[0];
    let maps = Maps::paint(
        [256, 256],
        &[strip],
        |_, [u, v]| iris(species, Vec2::new(2.0 * u - 1.0, 1.0 - 2.0 * v)),
        |_, _| [width; 2],
    );
    let mut out = Primitive::default();
    let centre = species.joint("lid_lo_L");
    let axis = gaze(species);
    let [side, up] = frame(species);
    let joint = rigid(skeleton.index("eye_L"));
    for i in 0..=GRID[0] {
        let a = BALL * (i as f32 / GRID[0] as f32).max(1e-3);
        // The cornea bulges before the iris.
        let radius = species.eye[0] * (1.0 + 0.02 * ease(species.lid_edge, 0.0, a));
        for j in 0..=GRID[1] {
            let (s, c) = (TAU * j as f32 / GRID[1] as f32).sin_cos();
            let flat = Vec2::new(s, c) * a.sin();
            let at = side * flat.x + up * flat.y + axis * a.cos();
            out.vertices.push(Vertex::new(
                centre + at * radius,
                [0.5 + 0.5 * flat.x, 0.5 - 0.5 * flat.y],
                joint,
            ));
        }
    }
    out.quads(0, GRID[0] + 1, GRID[1] + 1);
    out.finish(0);
    out.tint(&maps);
    out.mirror(|j| other_side(skeleton, j));
    (out, maps)
}

/// The eye at a place seen along the gaze, in its radii.
fn iris(species: &Species, at: Vec2) -> Texel {
    let [iris, ..] = species.bare_colors.map(linear);
    let r = at.length();
    let (s, c) = at.x.atan2(at.y).sin_cos();
    let pupil = species.eye[1] / species.eye[0];
    let rim = species.lid_edge.sin();
    let fibre =
        noise([9.0 * s, 9.0 * c, 1.5 * r], 5) + 0.6 * noise([23.0 * s, 23.0 * c, 2.0 * r], 6);
    let depth = (r - pupil) / (rim - pupil).max(0.05);
    // Darker next to the pupil and to the white of the eye.
    let inner = mix(iris, linear(0x2A1D12), 0.45);
    let mut color = mix(inner, iris, ease(0.0, 0.35, depth + 0.06 * fibre));
    color = color.map(|x| x * (0.92 + 0.11 * fibre));
    color = mix(color, linear(0x1A1410), ease(0.86, 1.02, depth));
    color = mix(linear(0x040404), color, ease(-0.03, 0.03, r - pupil));
    // The upper lid shades the ball below it.
    let shade = ease(0.25, 1.0, at.y / rim) * 0.65 + 0.35 * ease(0.85, 1.0, r / rim);
    Texel {
        color: color.map(|x| x * (1.0 - 0.75 * shade)),
        height: 0.0,
        roughness: 0.16,
        open: 1.0 - 0.6 * shade,
    }
}

/// The rims of the eyes, the two lids of each, opened into the head, and the ledges above; with their texture.
pub fn lids(species: &Species, skeleton: &Skeleton, body: &Body) -> (Primitive, Maps) {
    let radius = species.eye[0];
    let ledge = species.ledge;
    let maps = Maps::paint(
        [256, 128],
        &STRIPS,
        |strip, [u, v]| match strip {
            0 => rim(species, u, v),
            _ => horny(ledge.map_or(0, |l| l.color), u, v),
        },
        |strip, _| match strip {
            0 => [TAU * radius, 0.9 * radius],
            _ => [12.0, 22.0],
        },
    );
    let mut out = Primitive::default();
    let head = rigid(skeleton.index("head"));
    let base = out.vertices.len() as u32;
    let edge = |angle: f32| ring_of_lid(species, body, angle);
    for j in 0..=LIDS[1] {
        let u = j as f32 / LIDS[1] as f32;
        for (k, p) in edge(TAU * u).into_iter().enumerate() {
            let v = STRIPS[0].v[1] * k as f32 / (LIDS[0] - 1) as f32;
            out.vertices.push(Vertex::new(p, [u, v], head));
        }
    }
    out.quads(base, LIDS[1] + 1, LIDS[0]);
    out.finish(base);
    let centre = species.joint("lid_lo_L");
    for (joint, degrees, opening) in [("lid_lo_L", -118.0_f32, 0.95), ("lid_up_L", 112.0, 0.75)] {
        let open = Quat::from_axis_angle(lid_axis(species), degrees.to_radians()) * gaze(species);
        let joint = rigid(skeleton.index(joint));
        cap(&mut out, centre, open, 1.03 * radius, opening, joint);
    }
    if let Some(ledge) = ledge {
        sweep_ledge(&mut out, centre, &ledge, head);
    }
    out.tint(&maps);
    out.mirror(|j| other_side(skeleton, j));
    (out, maps)
}

/// Points of the lids outwards at an angle round the eye, from under the rim over its edge to the skin.
fn ring_of_lid(species: &Species, body: &Body, angle: f32) -> [Vec3; LIDS[0]] {
    let centre = species.joint("lid_lo_L");
    let axis = gaze(species);
    let [side, up] = frame(species);
    let (s, c) = angle.sin_cos();
    let out = side * s + up * c;
    let radius = species.eye[0];
    let edge = species.lid_edge;
    let on = |a: f32, r: f32| centre + (axis * a.cos() + out * a.sin()) * (r * radius);
    let reach = species.lid_reach;
    std::array::from_fn(|k| match k {
        0 => on(edge + 0.02, 0.985),
        1 => on(edge, 1.03),
        2 => on(edge + 0.03, 1.075),
        _ => {
            let share = (k - 2) as f32 / (LIDS[0] - 3) as f32;
            let a = edge + 0.03 + share * 0.55;
            let shell = on(a, 1.08 - 0.03 * share);
            let flat = radius * (edge.sin() + share * (reach - edge.sin()));
            let ground = body.project(centre + out * flat + axis * (0.4 * radius), 4);
            let lift = 0.4 - 0.9 * share * share;
            let ground = ground + body.normal(ground) * lift;
            shell.lerp(ground, ease(0.0, 0.8, share))
        }
    })
}

/// The lid's skin: a dark wet edge, beads along it, wrinkles round the eye. `v` from the edge outwards.
fn rim(species: &Species, u: f32, v: f32) -> Texel {
    let skin = linear(species.lids);
    let [.., edge] = species.lid_colors.map(linear);
    let [middle, _] = species.lid_colors.map(linear);
    let (s, c) = (TAU * u).sin_cos();
    let wrinkle = (v * 26.0 + 2.2 * noise([3.0 * s, 3.0 * c, 4.0 * v], 7)).sin();
    let crease = noise([14.0 * s, 14.0 * c, 3.0 * v], 8);
    let beads = (TAU * u * 30.0).sin().max(0.0) * ease(0.12, 0.2, v) * ease(0.42, 0.3, v);
    let wet = ease(0.2, 0.1, v);
    let tone = 0.92 + 0.07 * wrinkle + 0.06 * crease;
    let color = mix(middle, skin, ease(0.3, 0.75, v + 0.06 * crease)).map(|x| x * tone);
    Texel {
        color: mix(color, edge, ease(0.27, 0.16, v)),
        height: 0.10 * wrinkle * ease(0.2, 0.4, v) + 0.08 * crease + 0.14 * beads,
        roughness: 0.65 - 0.2 * wet,
        open: 1.0 - 0.5 * ease(0.12, 0.0, v) - 0.12 * (0.5 - 0.5 * wrinkle),
    }
}

/// Skin of the ledge: rough and scaly.
fn horny(color: u32, u: f32, v: f32) -> Texel {
    let (s, c) = (TAU * u).sin_cos();
    let rough = cloud([2.0 * s, 2.0 * c, 6.0 * v], 17);
    let fine = noise([8.0 * s, 8.0 * c, 24.0 * v], 18);
    Texel {
        color: linear(color).map(|x| x * (0.9 + 0.3 * rough + 0.1 * fine)),
        height: 0.25 * rough + 0.06 * fine,
        roughness: 0.9,
        open: 1.0,
    }
}

/// A ledge above an eye: thin at both ends, its outer edge down.
fn sweep_ledge(out: &mut Primitive, eye: Vec3, ledge: &Ledge, head: crate::weights::Binding) {
    let path = ledge.path.map(|p| eye + Vec3::from_array(p));
    let count = 16;
    let rings: Vec<Ring> = (0..=count)
        .map(|i| {
            let t = i as f32 / count as f32;
            // A parabola through the three points.
            let weights = [
                (1.0 - t) * (1.0 - 2.0 * t),
                4.0 * t * (1.0 - t),
                t * (2.0 * t - 1.0),
            ];
            let slopes = [4.0 * t - 3.0, 4.0 - 8.0 * t, 4.0 * t - 1.0];
            let sum = |w: [f32; 3]| path[0] * w[0] + path[1] * w[1] + path[2] * w[2];
            let along = sum(slopes).normalize();
            let outward = Vec3::new(1.0, -ledge.droop, 0.0)
                .reject_from(along)
                .normalize();
            let size = (1.0 - (2.0 * t - 1.0).powi(4)).max(0.02).sqrt();
            Ring::round(
                sum(weights),
                outward * (ledge.half[0] * size),
                outward.cross(along) * (ledge.half[1] * size),
                t,
                head,
            )
        })
        .collect();
    out.tube(&rings, 20, STRIPS[1].v);
}

/// A lid: a cap of a sphere about `axis`, `opening` radians wide.
fn cap(
    out: &mut Primitive,
    centre: Vec3,
    axis: Vec3,
    radius: f32,
    opening: f32,
    binding: crate::weights::Binding,
) {
    let side = axis.any_orthonormal_vector();
    let up = axis.cross(side);
    let steps = 8;
    let rings: Vec<Ring> = (0..=steps)
        .map(|i| {
            let share = i as f32 / steps as f32;
            let a = (opening * share).max(0.02);
            Ring::round(
                centre + axis * (radius * a.cos()),
                side * (radius * a.sin()),
                up * (radius * a.sin()),
                share,
                binding,
            )
        })
        .collect();
    // The outer skin of the lids' texture.
    out.tube(&rings, 24, [0.55, 0.6]);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pupil_is_dark_and_the_macaws_iris_pale_round_it() {
        let macaw = &crate::species::all()[0];
        let pupil = iris(macaw, Vec2::new(0.0, -0.1)).color[1];
        let ring = iris(macaw, Vec2::new(0.0, -0.55)).color[1];
        assert!(pupil < 0.01 && ring > 0.3, "{pupil} {ring}");
    }

    #[test]
    fn lids_lie_over_the_ball_and_run_out_under_the_skin() {
        for species in crate::species::all() {
            let body = Body::new(&species);
            let centre = species.joint("lid_lo_L");
            for k in 0..12 {
                let ring = ring_of_lid(&species, &body, TAU * k as f32 / 12.0);
                assert!(ring[2].distance(centre) > 1.05 * species.eye[0]);
                let outer = body.distance(ring[LIDS[0] - 1]);
                assert!(outer < 0.3, "{}: {outer} mm above the skin", species.name);
            }
        }
    }
}
