//! Joint weights of the skin.

use bevy::math::Vec3;

use crate::body::Body;
use crate::maps::ease;
use crate::nets::Surface;
use crate::skeleton::Skeleton;

/// Four joints and their weights; the weights sum to one.
pub type Binding = ([u16; 4], [f32; 4]);

/// Joint indices that the rules need.
struct Names {
    hips: usize,
    chest: usize,
    chain: [usize; 6],
    tail: usize,
    sides: [Side; 2],
}

struct Side {
    scap: usize,
    wing: [usize; 4],
    propat: usize,
    leg: [usize; 4],
}

impl Names {
    fn new(s: &Skeleton) -> Self {
        let side = |e: &str| Side {
            scap: s.index(&format!("scap_{e}")),
            wing: ["humerus", "ulna", "hand", "digit"].map(|n| s.index(&format!("{n}_{e}"))),
            propat: s.index(&format!("propat_{e}")),
            leg: ["femur", "tibia", "tarsus", "foot"].map(|n| s.index(&format!("{n}_{e}"))),
        };
        Self {
            hips: s.index("hips"),
            chest: s.index("chest"),
            chain: ["chest", "neck1", "neck2", "neck3", "neck4", "head"].map(|n| s.index(n)),
            tail: s.index("tail"),
            sides: [side("L"), side("R")],
        }
    }
}

/// Weights of every vertex of the skin.
pub fn bind(body: &Body, skeleton: &Skeleton, surface: &Surface) -> Vec<Binding> {
    let names = Names::new(skeleton);
    let n = skeleton.joints.len();
    let mut dense: Vec<Vec<f32>> = surface
        .points
        .iter()
        .map(|p| raw(body, skeleton, &names, n, *p))
        .collect();
    let mut neighbors = vec![Vec::<u32>::new(); surface.points.len()];
    for t in &surface.triangles {
        for i in 0..3 {
            neighbors[t[i] as usize].push(t[(i + 1) % 3]);
        }
    }
    for _ in 0..4 {
        let old = dense.clone();
        for (i, w) in dense.iter_mut().enumerate() {
            let share = 0.5 / neighbors[i].len().max(1) as f32;
            for (j, v) in w.iter_mut().enumerate() {
                *v = 0.5 * old[i][j]
                    + neighbors[i]
                        .iter()
                        .map(|k| old[*k as usize][j])
                        .sum::<f32>()
                        * share;
            }
        }
    }
    dense.iter().map(|w| strongest(w)).collect()
}

/// The four strongest weights, normalised.
pub fn strongest(dense: &[f32]) -> Binding {
    let mut order: Vec<usize> = (0..dense.len()).collect();
    order.sort_by(|a, b| dense[*b].total_cmp(&dense[*a]).then(a.cmp(b)));
    let mut joints = [0; 4];
    let mut weights = [0.0; 4];
    let total: f32 = order.iter().take(4).map(|i| dense[*i]).sum();
    for (slot, i) in order.iter().take(4).enumerate() {
        if dense[*i] > 1e-4 * total {
            joints[slot] = *i as u16;
            weights[slot] = dense[*i] / total;
        }
    }
    let sum: f32 = weights.iter().sum();
    if sum <= 0.0 {
        return ([0; 4], [1.0, 0.0, 0.0, 0.0]);
    }
    (joints, weights.map(|w| w / sum))
}

fn raw(body: &Body, skeleton: &Skeleton, names: &Names, n: usize, p: Vec3) -> Vec<f32> {
    let s = body.species;
    let mut w = vec![0.0; n];
    let q = Vec3::new(p.x.abs(), p.y, p.z);
    let side = &names.sides[usize::from(p.x < 0.0)];
    let parts = body.parts(q);
    let arc = parts.trunk.arc;

    // Core: tail, hips, chest and the chain to the head.
    let tail = 1.0 - ease(0.1 * s.arcs.dorsal[0], 1.1 * s.arcs.dorsal[0], arc);
    let chest = ease(s.rigid[0], s.rigid[1], arc);
    w[names.tail] = tail;
    w[names.hips] = (1.0 - tail) * (1.0 - chest);
    let chain_arcs = names
        .chain
        .map(|j| body.trunk.hit(skeleton.joints[j].position).arc);
    let mut carried = chest * (1.0 - tail);
    for i in 1..6 {
        let half = 0.5 * (chain_arcs[i] - chain_arcs[i - 1]).max(4.0);
        let further = ease(chain_arcs[i] - half, chain_arcs[i] + half, arc);
        w[names.chain[i - 1]] += carried * (1.0 - further);
        carried *= further;
    }
    w[names.chain[5]] += carried;
    // The head is rigid: everything above its plane, chin included.
    let joint = s.joint("head");
    let plane = s.arcs.head_plane - 0.15 * (joint.z - q.z);
    let front = ease(joint.z + 8.0 * s.scale, joint.z + 30.0 * s.scale, q.z);
    let reach = 10.0 * s.scale.sqrt();
    let head = ease(
        plane - reach - front * reach,
        plane + reach * (1.0 - front),
        q.y,
    );
    for v in &mut w {
        *v *= 1.0 - head;
    }
    w[names.chain[5]] += head;

    let core = parts.trunk.distance.min(parts.head.distance);
    legs(body, names, side, &parts.legs, core, q, &mut w);
    // The swell before the wing goes with the chest where the wing's skin reaches it, so that the breast stays smooth over the folded wrist.
    let trunk = body.trunk_in_plumage(q, parts.trunk.distance);
    let swollen = trunk.min(parts.head.distance);
    wing(
        body,
        names,
        side,
        parts.wing,
        swollen,
        parts.trunk.angle,
        q,
        &mut w,
    );
    w
}

fn legs(
    body: &Body,
    names: &Names,
    side: &Side,
    legs: &[(f32, f32); 3],
    core: f32,
    q: Vec3,
    w: &mut [f32],
) {
    let s = body.species;
    let reach = s.blend[0];
    let near = legs[0].0.min(legs[1].0).min(if s.feathered_tarsus {
        legs[2].0
    } else {
        f32::MAX
    });
    let share = ease(-reach, reach, core - near) * (1.0 - ease(0.0, 40.0, q.y - s.arcs.leg_top));
    if share <= 0.0 {
        return;
    }
    let mut own = [0.0; 4];
    // Along the limb: hips give way to the femur, then each joint to the next.
    let knee = ease(
        -0.6 * s.legs[0][1],
        0.6 * s.legs[0][1],
        legs[0].0 - legs[1].0,
    );
    let femur = ease(0.1, 0.6, legs[0].1);
    own[0] = (1.0 - knee) * femur;
    let ankle = if s.feathered_tarsus {
        ease(
            -0.6 * s.legs[1][1],
            0.6 * s.legs[1][1],
            legs[1].0 - legs[2].0,
        )
    } else {
        ease(0.9, 1.1, legs[1].1)
    };
    let top = 0.2 * (1.0 - ease(0.0, 0.4, legs[1].1));
    own[1] = knee * (1.0 - ankle) * (1.0 - top);
    own[2] = knee * ankle;
    let foot = ease(0.85, 1.0, legs[2].1) * own[2];
    own[3] = foot;
    own[2] -= foot;
    let used: f32 = own.iter().sum();
    for v in w.iter_mut() {
        *v *= 1.0 - share;
    }
    for (j, v) in side.leg.iter().zip(own) {
        w[*j] += share * v;
    }
    w[names.hips] += share * (1.0 - used);
}

fn wing(
    body: &Body,
    names: &Names,
    side: &Side,
    distance: f32,
    core: f32,
    angle: f32,
    q: Vec3,
    w: &mut [f32],
) {
    let s = body.species;
    let [shoulder, elbow, wrist, knuckle, tip] = body.wing.points;
    let reach = s.shoulder_reach;
    let nearer = core - distance;
    // The back stays with the chest: only skin that is clearly on the arm follows it there.
    let dorsal = 1.0 - ease(50.0, 85.0, angle);
    let share = ease(-0.35 * reach, 0.35 * reach, nearer)
        * (1.0 - dorsal * (1.0 - ease(0.0, 0.4 * reach, nearer)));
    if share <= 0.0 {
        return;
    }
    let mut own = vec![0.0; w.len()];
    let radii = [s.arm[0], s.arm[1], s.arm[2], 0.8 * s.arm[2]];
    let bones = [
        (shoulder, elbow),
        (elbow, wrist),
        (wrist, knuckle),
        (knuckle, tip),
    ];
    for (i, (a, b)) in bones.iter().enumerate() {
        let d = crate::body::cone(q, *a, *b, [0.0, 0.0]).0;
        let v = (1.0 - (d - radii[i]).max(0.0) / (1.2 * radii[i] + 6.0)).max(0.0);
        own[side.wing[i]] += v * v;
    }
    // The patagium is a sheet between shoulder, elbow and wrist that stays flat while it folds. The ulna hardly turns within the
    // wing's plane; the helper joint at the shoulder does not turn in it at all.
    let flat = body.wing.flat(q);
    let [fs, fe, fw] = [shoulder, elbow, wrist].map(|p| body.wing.flat(p));
    let area = (fe - fs).perp_dot(fw - fs);
    let b = (flat - fs).perp_dot(fw - fs) / area;
    let c = (fe - fs).perp_dot(flat - fs) / area;
    let inside = ease(0.0, 0.12, (1.0 - b - c).min(b).min(c) + 0.06);
    let sheet = inside * (1.0 - (own[side.wing[0]] + own[side.wing[1]]).min(1.0));
    let at_shoulder = (1.0 - b - c).clamp(0.0, 1.0);
    own[side.propat] += sheet * at_shoulder;
    own[side.wing[1]] += sheet * (1.0 - at_shoulder);
    // The strip behind the ulna holds the roots of the secondaries and goes with that bone.
    let [e, r] = body.wing.strip.map(|p| body.wing.flat(p));
    let along = ((flat - fe).dot(fw - fe) / (fw - fe).length_squared()).clamp(-1.0, 2.0);
    let behind = (fw - fe).perp_dot(flat - fe) > 0.0 && (e - fe).perp_dot(r - fe) != 0.0;
    if behind {
        let strip = ease(-0.05, 0.15, along) * (1.0 - ease(0.85, 1.05, along));
        for v in &mut own {
            *v *= 1.0 - strip;
        }
        own[side.wing[1]] += strip;
    }
    let sum: f32 = own.iter().sum();
    if sum <= 1e-4 {
        own[side.wing[0]] = 1.0;
    } else {
        own.iter_mut().for_each(|v| *v /= sum);
    }
    // Over the shoulder the chest keeps its hold.
    let off = q.distance(shoulder) / reach;
    let hold = (1.0 - ease(0.2, 1.0, off)) * s.shoulder_hold;
    for v in &mut own {
        *v *= 1.0 - hold;
    }
    own[names.chest] += 0.5 * hold;
    own[side.scap] += 0.5 * hold;
    for (v, o) in w.iter_mut().zip(own) {
        *v = *v * (1.0 - share) + o * share;
    }
}
