//! Where on the skin the tracts are, and where along them a place is.

use bevy::math::Vec3;

use crate::body::{Body, Parts};
use crate::species::{BareFace, EyeRim, FaceLines, Tract};

/// Width of the rim of a naked face on which nothing grows, mm: feathers there would come through the coat.
const RIM: f32 = 5.0;

/// Where the breast begins before the front edge of the folded wing, mm on the macaw: feathers rooted nearer lie below the wing.
const LAP: f32 = 11.0;

/// How far from the plumage over the folded arm the skin still belongs to it, in radii of the humerus.
const OVER_ARM: f32 = 1.1;

/// Tract at a point of the skin.
pub fn classify(body: &Body, p: Vec3) -> Tract {
    let s = body.species;
    let q = Vec3::new(p.x.abs(), p.y, p.z);
    let parts = body.parts(q);
    let arcs = s.arcs;
    let naked = bare(body, q);
    let rim = matches!(s.bare, BareFace::Patch(_)) && bare_distance(body, q) > -RIM;
    if eye_rim(body, q, naked) || naked && rim {
        return Tract::EyeRing;
    }
    if naked {
        return Tract::Bare;
    }
    if let Some(disc) = s.disc {
        let share = disc.share(q);
        if share < 1.0 + disc.ruff {
            return if share < 1.0 {
                Tract::Disc
            } else {
                Tract::Ruff
            };
        }
    }
    let core = parts.trunk.distance.min(parts.head.distance);
    // The top of the knee belongs to the thigh: its feathers run down over it.
    let leg = match nearest_leg(body, &parts) {
        1 if q.y > s.joint("tibia_L").y - 0.4 * s.legs[0][1] => 0,
        leg => leg,
    };
    // Between the thighs the belly runs on to the tail.
    let between = parts.trunk.arc < arcs.ventral[0]
        && parts.trunk.angle > 122.0
        && q.x < 0.5 * s.joint("femur_L").x;
    if !between
        && parts.legs[leg].0 < core - 3.0
        && parts.legs[leg].0 < parts.wing
        && q.y < arcs.leg_top
    {
        return [Tract::Femoral, Tract::Crural, Tract::Tarsal][leg];
    }
    if parts.wing + 0.25 * s.arm[0] < core {
        return wing(body, q);
    }
    let joint = s.joint("head");
    if q.y > arcs.head_plane - 0.15 * (joint.z - q.z) {
        let u = q.z - joint.z;
        let angle = parts.head.angle;
        if lore(body, q) {
            return Tract::Lore;
        }
        // Behind the cheeks the nape runs on into the hind neck.
        let behind = parts.trunk.angle < 88.0 && u < -6.0 * s.scale.sqrt();
        return if u < arcs.nape && (angle < arcs.head_angles[0] || behind) {
            Tract::Nape
        } else if u >= arcs.nape && angle < arcs.head_angles[1] {
            Tract::Crown
        } else {
            Tract::Cheek
        };
    }
    let (arc, theta) = (parts.trunk.arc, parts.trunk.angle);
    let [tail, rump, back, mantle] = arcs.dorsal;
    let [vent, belly] = arcs.ventral;
    // Beside the back stand the scapulars.
    let beside = theta > 62.0 || arc > arcs.scapulars;
    let [arm, front] = body.shoulder(q);
    if beside && arm < (OVER_ARM * s.arm[0]).min(front) {
        return Tract::Shoulder;
    }
    if arc >= mantle {
        // The plumage before the folded wing is no hind neck, as high up as it may lie.
        let before = front < OVER_ARM * s.arm[0];
        return if theta < arcs.neck && before {
            Tract::Mantle
        } else if theta < arcs.neck {
            Tract::NeckDorsal
        } else {
            Tract::NeckVentral
        };
    }
    if arc < tail {
        return if theta < 88.0 {
            Tract::TailUpper
        } else {
            Tract::TailUnder
        };
    }
    if theta < 62.0 {
        let scapular = theta > 40.0 && arc < arcs.scapulars;
        return match arc {
            a if a < rump => Tract::Rump,
            a if a < back => Tract::Back,
            _ if scapular => Tract::ScapularMantle,
            _ => Tract::Mantle,
        };
    }
    // Breast feathers lie over the wing's front edge; what the wing covers lies below it.
    if theta > 102.0 && arc > belly {
        return if body.before_wing(q) > LAP * s.scale {
            Tract::Breast
        } else {
            Tract::Side
        };
    }
    if theta > 122.0 {
        return if arc > vent {
            Tract::Belly
        } else {
            Tract::Vent
        };
    }
    // The mantle closes the shoulder, where the folded patagium leaves the trunk.
    if arc > arcs.scapulars - 18.0 * s.scale && theta < 84.0 {
        return Tract::Mantle;
    }
    // What lies above the folded wing hangs down over its upper edge.
    if arc > side(body) && theta < 102.0 {
        return if body.before_wing(q) > 0.0 {
            Tract::Breast
        } else {
            Tract::Side
        };
    }
    Tract::Flank
}

/// Arc at which the flank, which covers the lower edge of the folded wing, gives way to the side below it.
fn side(body: &Body) -> f32 {
    let [vent, belly] = body.species.arcs.ventral;
    0.5 * (vent + belly)
}

fn nearest_leg(body: &Body, parts: &Parts) -> usize {
    let n = if body.species.feathered_tarsus { 3 } else { 2 };
    (0..n)
        .min_by(|a, b| parts.legs[*a].0.total_cmp(&parts.legs[*b].0))
        .unwrap_or(0)
}

fn eye_rim(body: &Body, q: Vec3, naked: bool) -> bool {
    let eye = body.species.joint("eye_L");
    let within = |radii: f32| (q - eye).length() < radii * body.species.eye[0];
    match body.species.eye_rim {
        EyeRim::OnBareSkin(radii) => naked && within(radii),
        EyeRim::Round(radii) => within(radii),
        EyeRim::Oval {
            half,
            ahead,
            beyond,
        } => {
            !naked
                && ((q.y - eye.y) / half[0]).hypot((q.z - eye.z - ahead) / half[1]) < 1.0
                && q.x > beyond
        }
    }
}

fn bare(body: &Body, q: Vec3) -> bool {
    bare_distance(body, q) < 0.0
}

/// How far a point lies outside the naked skin of the face, mm; negative inside. `q.x` is not negative.
pub fn bare_distance(body: &Body, q: Vec3) -> f32 {
    match body.species.bare {
        BareFace::Feathered => f32::MAX,
        BareFace::Patch(patch) => patch.distance(q.z, q.y),
        BareFace::Cere(cere) => {
            let radius = cere.radius - cere.taper * q.x * q.x;
            ((q.z - cere.at[0]).hypot(q.y - cere.at[1]) - radius).max(cere.ahead - q.z)
        }
    }
}

fn lore(body: &Body, q: Vec3) -> bool {
    let eye = body.species.joint("eye_L");
    body.species.lore.is_some_and(|lore| {
        q.z > eye.z + lore.ahead
            && q.y > eye.y - lore.low
            && q.y < eye.y + lore.high
            && q.x > lore.beyond
    })
}

/// Chord share up to which the upper marginal coverts reach round the leading edge.
const EDGE: f32 = 0.09;

fn wing(body: &Body, q: Vec3) -> Tract {
    let c = body.wing.chord(q);
    // Marginal coverts wrap round the leading edge from below, so that no parting shows along it.
    let facing = body.normal(q).dot(body.wing.normal);
    let upper = facing > 0.0 || c < EDGE;
    // Behind the humerus no remiges stand: small coverts reach the trailing edge.
    let [shoulder, elbow, wrist, ..] = body.wing.points;
    let humerus = crate::body::cone(q, shoulder, elbow, [0.0, 0.0]);
    let inner = humerus.1 < 0.72 && humerus.0 < crate::body::cone(q, elbow, wrist, [0.0, 0.0]).0;
    let on_hand = body.wing.flat(q).x > body.wing.flat(body.wing.points[2]).x;
    // The tip of the last digit carries only flight feathers: small ones would stand off it.
    let tip = body.wing.points[4];
    if (q - wrist).dot(tip - wrist) > 0.92 * (tip - wrist).length_squared() {
        return if upper {
            Tract::CovertUpper
        } else {
            Tract::CovertUnder
        };
    }
    if upper {
        match c {
            c if c < 0.22 => Tract::MarginalUpper,
            c if c < if inner {
                1.1
            } else if on_hand {
                0.3
            } else {
                0.74
            } =>
            {
                Tract::LesserUpper
            }
            _ if facing > 0.4 && q.distance(elbow) < 0.42 * wrist.distance(elbow) => Tract::Elbow,
            _ => Tract::CovertUpper,
        }
    } else {
        match c {
            // Below the hand none is so long that it would stick out before the folded wing.
            c if c < if on_hand { 0.78 } else { 0.25 } => Tract::MarginalUnder,
            c if inner || c < 0.78 => Tract::LesserUnder,
            _ => Tract::CovertUnder,
        }
    }
}

/// Place along a tract, 0 at its cranial end to 1 at its caudal end.
pub fn phi(body: &Body, tract: Tract, p: Vec3) -> f32 {
    let s = body.species;
    let q = Vec3::new(p.x.abs(), p.y, p.z);
    let parts = body.parts(q);
    let arcs = s.arcs;
    let [tail, rump, back, mantle] = arcs.dorsal;
    let [vent, belly] = arcs.ventral;
    let arc = |from: f32, to: f32| (from - parts.trunk.arc) / (from - to);
    let front = s.head[5][0];
    let joint = s.joint("head").z;
    let neck_end = s.trunk[12][0];
    let c = || body.wing.chord(q);
    let value = match tract {
        Tract::Bare | Tract::Lore | Tract::EyeRing => match s.naked.and_then(|face| face.lines) {
            // Rows of feathers stand on the lines.
            Some(lines) => {
                let from = q - s.joint("eye_L");
                (lines.line(from.z, from.y) + 0.5) / FaceLines::COUNT
            }
            None => (front - q.z) / 40.0,
        },
        Tract::Disc => s.disc.map_or(0.0, |disc| disc.share(q)),
        Tract::Ruff => s.disc.map_or(0.0, |disc| (disc.share(q) - 1.0) / disc.ruff),
        Tract::Crown => (front - q.z) / (front - joint - arcs.nape),
        Tract::Nape => (joint + arcs.nape - q.z) / 34.0 / s.scale.sqrt(),
        Tract::Cheek => {
            // Longest where it overhangs the neck, below as well as behind.
            let low = (q.y - arcs.head_plane) / (1.1 * (s.joint("eye_L").y - arcs.head_plane));
            let behind = (q.z - joint - arcs.nape) / (front - joint - arcs.nape);
            1.0 - low.min(behind)
        }
        Tract::NeckDorsal | Tract::NeckVentral => arc(neck_end, mantle),
        Tract::Mantle | Tract::ScapularMantle | Tract::Shoulder => arc(mantle, back),
        Tract::Back => arc(back, rump),
        Tract::Rump => arc(rump, tail),
        Tract::Breast => arc(mantle, belly),
        Tract::Belly => arc(belly, vent),
        Tract::Vent => arc(vent, tail),
        Tract::Flank => arc(belly, tail),
        Tract::Side => arc(mantle, side(body)),
        Tract::TailUpper | Tract::TailUnder => arc(tail, -0.6 * tail),
        Tract::Femoral => {
            let low = s.joint("tibia_L").y - s.legs[0][1];
            (arcs.leg_top - q.y) / (arcs.leg_top - low)
        }
        Tract::Crural => parts.legs[1].1,
        Tract::Tarsal => parts.legs[2].1,
        Tract::MarginalUpper => {
            let facing = body.normal(q).dot(body.wing.normal);
            (c() * facing.signum() + EDGE) / (0.25 + EDGE)
        }
        Tract::MarginalUnder => (c() - EDGE) / (0.25 - EDGE),
        Tract::LesserUpper => (c() - 0.22) / 0.52,
        Tract::LesserUnder => (c() - 0.25) / 0.53,
        Tract::CovertUpper | Tract::CovertUnder | Tract::Elbow => (c() - 0.74) / 0.26,
    };
    if value.is_finite() {
        value.clamp(0.0, 1.0)
    } else {
        0.0
    }
}
