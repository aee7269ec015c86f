//! The groom of a bird: regions from the tables, rows, and guides sampled from an analytic lay field.

use bevy::math::{Mat4, Vec3};
use bevy_plumage::groom::{
    Groom, Guide, JointPose, KeyPose, Placement, Region, Segments, Select, Span, Tint,
};

use crate::body::Body;
use crate::idle;
use crate::model::Model;
use crate::preview;
use crate::rows::{Builder, template};
use crate::skeleton::{Joint, Skeleton};
use crate::species::{Limb, Species, Tract, TractRow, srgb};
use crate::tract;
use crate::wing::WingPlane;

/// Guides on the left half.
const GUIDES: usize = 240;

/// Builds the groom.
pub fn groom(species: &Species, model: &Model) -> Groom {
    let body = Body::new(species);
    let regions = species
        .tracts
        .iter()
        .map(|t| {
            let mut region = Region::new(t.name);
            region.select = select(t);
            region.feather = template(species, t.feather);
            region.count = t.count;
            if t.rows > 0 {
                region.placement = Placement::Rows(t.rows);
            }
            region.length = Span(t.length.0, t.length.1);
            region.width = Span(t.width.0, t.width.1);
            region.lift = Span(t.lift.0, t.lift.1);
            region.camber = t.camber;
            region.curl = t.curl;
            region.stiffness = t.stiffness;
            region.layer = t.layer;
            region.segments = Segments::new(t.segments.0, t.segments.1);
            region.tint = Tint(srgb(t.tint.0), srgb(t.tint.1));
            // One feather hardly differs from the next.
            region.jitter.yaw = 2.0;
            region.jitter.roll = 2.0;
            region.jitter.lift = 0.6;
            region.jitter.hue = 1.0;
            region.jitter.value = t.variety;
            region.down = is_downy(t.name).then(|| species.down.into());
            region
        })
        .collect();
    let mut groom = Groom::default();
    groom.name = species.title.to_string();
    groom.feathers = species
        .templates
        .iter()
        .map(|t| format!("../feathers/{}_{t}.feather.ron", species.prefix).into())
        .collect();
    groom.regions = regions;
    groom.guides = guides(species, &body, model);
    groom.rows = Builder::new(species, &body).rows();
    groom.poses = key_poses(species, &model.skeleton);
    groom
}

/// What of the skin a scattered tract grows on.
fn select(row: &TractRow) -> Select {
    let tracts = match row.on {
        [one] => Select::Tract(*one as u32),
        many => Select::Any(many.iter().map(|t| Select::Tract(*t as u32)).collect()),
    };
    let digit = Select::Joints(["digit_L", "digit_R"].map(String::from).into());
    match row.limb {
        Limb::Whole => tracts,
        Limb::Arm => Select::Every(vec![tracts, Select::Not(vec![digit])]),
        Limb::Digit => Select::Every(vec![tracts, digit]),
    }
}

/// The poses in which the coat is settled: at rest, with the wing stretched, half-way there, and as modelled, with open wings.
fn key_poses(species: &Species, skeleton: &Skeleton) -> Vec<KeyPose> {
    let round = |x: f32| (x * 1.0e5).round() * 1.0e-5;
    let pose = |(name, time): (&str, f32)| {
        let matrices = skeleton.matrices(&idle::pose(species, skeleton, time));
        let joints = skeleton.joints.iter().zip(matrices);
        let place = |(joint, matrix): (&Joint, Mat4)| {
            let (_, rotation, translation) = matrix.to_scale_rotation_translation();
            JointPose {
                joint: joint.name.clone(),
                rotation: rotation.to_array().map(round),
                translation: translation.to_array().map(round),
            }
        };
        KeyPose {
            name: name.into(),
            joints: joints.map(place).collect(),
        }
    };
    let clip = [
        ("rest", 0.0),
        ("stretch", species.motion.stretched),
        ("half-way", species.motion.half_way),
    ];
    let open = KeyPose {
        name: "open".into(),
        joints: Vec::new(),
    };
    clip.map(pose).into_iter().chain([open]).collect()
}

/// Feathers at density 1.
pub fn count(groom: &Groom) -> usize {
    let scattered: u32 = groom.regions.iter().map(|r| r.count).sum();
    let rows: usize = groom
        .rows
        .iter()
        .map(|r| r.lengths.len() * if r.mirror { 2 } else { 1 })
        .sum();
    scattered as usize + rows
}

/// Unit direction of the lay at a point of the skin, tangent to it.
pub fn lay(species: &Species, body: &Body, p: Vec3) -> Vec3 {
    let parts = body.parts(p);
    let (trunk, head) = (parts.trunk, parts.head);
    let tract = tract::classify(body, p);
    let side = if p.x.abs() < 3.0 { 0.0 } else { p.x.signum() };
    let mut d = -trunk.spine;
    match tract {
        Tract::Crown | Tract::Nape | Tract::Cheek | Tract::Bare | Tract::Lore | Tract::EyeRing => {
            let bill = species.bill.upper_at;
            let source = Vec3::new(0.0, bill[0] - 14.0, bill[1] + 6.0);
            let away = (p - source).normalize_or(Vec3::NEG_Z);
            let u = head.arc - species.joint("head").z;
            let size = species.scale.sqrt();
            let w = ((4.0 * size - u) / (22.0 * size)).clamp(0.0, 1.0);
            d = away.lerp(d, w);
            // Round the eye the plumage parts like a stream round a pillar.
            let mut eye = species.joint("eye_L");
            eye.x *= side;
            let r = (p - eye).reject_from(body.normal(p));
            let radius = 1.4 * species.eye[0];
            let near = radius * radius / r.length_squared().max(radius * radius);
            let out = r.normalize_or_zero();
            d += near * (d - 2.0 * d.dot(out) * out);
        }
        Tract::Disc | Tract::Ruff => {
            if let Some(disc) = species.disc {
                d = disc.lay(p);
            }
        }
        Tract::Femoral => {
            // Forward over the knee, down the thigh and into the lay of the crus.
            let phi = tract::phi(body, tract, p);
            d = Vec3::new(0.0, -1.0, 0.4 - 0.6 * phi);
        }
        Tract::Crural | Tract::Tarsal => {
            let knee = if tract == Tract::Crural {
                "tibia_L"
            } else {
                "tarsus_L"
            };
            let ankle = if tract == Tract::Crural {
                "tarsus_L"
            } else {
                "foot_L"
            };
            let along = (species.joint(ankle) - species.joint(knee)).normalize();
            d = along.lerp(Vec3::NEG_Y, 0.35);
            d.x = 0.0;
        }
        Tract::TailUpper | Tract::TailUnder => {
            let slope = species.tail[0].to_radians();
            d = Vec3::new(0.12 * side, -slope.sin(), -slope.cos());
        }
        Tract::LesserUpper
        | Tract::MarginalUpper
        | Tract::CovertUpper
        | Tract::Elbow
        | Tract::LesserUnder
        | Tract::MarginalUnder
        | Tract::CovertUnder => d = wing_lay(species, body, tract, p),
        Tract::Breast => {
            // At its sides the breast closes over the front edge of the folded wing.
            let reach = 45.0 * species.scale;
            let near = 1.0 - (body.before_wing(p.abs()) / reach).clamp(0.0, 1.0);
            d -= body.before() * (0.6 * near);
            d.x += side * 0.18 * (1.0 - near);
        }
        _ => {
            // Scapulars fan out over the folded wing.
            d.x += side
                * match tract {
                    Tract::ScapularMantle | Tract::Shoulder => 0.30,
                    _ if trunk.angle < 60.0 || trunk.angle > 120.0 => 0.18,
                    _ => 0.0,
                };
        }
    }
    let n = body.normal(p);
    d.reject_from(n)
        .try_normalize()
        .unwrap_or_else(|| (-trunk.spine).reject_from(n).normalize_or(Vec3::NEG_Y))
}

/// On the wing the lay runs from the leading edge to the trailing one, turning with the remiges behind it.
fn wing_lay(species: &Species, body: &Body, tract: Tract, p: Vec3) -> Vec3 {
    let q = Vec3::new(p.x.abs(), p.y, p.z);
    let wing = &body.wing;
    let [shoulder, elbow, wrist, _, tip] = wing.points.map(|v| wing.flat(v));
    let at = wing.flat(q);
    let hand = ((at - wrist).dot(tip - wrist) / (tip - wrist).length_squared()).clamp(0.0, 1.0);
    let inner =
        ((at - elbow).dot(wrist - elbow) / (wrist - elbow).length_squared()).clamp(0.0, 1.0);
    let arm = wing.secondary(1.0 - inner, species).0;
    let remex = if hand > 0.0 {
        wing.primary(1.0 + 9.0 * hand)
    } else {
        arm
    };
    let reach = (at - shoulder).length() / (wrist - shoulder).length();
    let across = wing.azimuths[1] + 90.0;
    // Next to the leading edge straight across, next to the remiges with them.
    let c = wing.chord(q);
    // On the hand half-way between its bone and the remiges: skin does not turn with them when the wrist folds.
    let azimuth = if hand > 0.0 {
        let along = wing.azimuths[2];
        along + (remex - along) * (1.0 - 0.55 * (hand / 0.2).min(1.0))
    } else {
        // Part of the way to where the folded remiges point: they turn further than the skin of the forearm.
        let folded = WingPlane::new(species, species.fold);
        let share = 1.0 - inner;
        let lag =
            folded.secondary(share, species).0 - folded.azimuths[1] - (arm - wing.azimuths[1]);
        across + (remex - across) * (0.7 + 0.3 * c) + 0.3 * lag * inner
    };
    let mut d = wing.direction(azimuth.max(40.0 * reach.min(1.0)));
    if tract == Tract::MarginalUpper {
        // Round the leading edge from below; what runs along the hand may stay.
        let edge = wing.direction(wing.azimuths[2]);
        let along = d.project_onto_normalized(edge) * (species.hand_lay * (hand / 0.2).min(1.0));
        let n = body.normal(q);
        let across = d - along;
        d = along + across * n.dot(wing.normal) - wing.normal * n.dot(across);
    }
    Vec3::new(d.x * if p.x < 0.0 { -1.0 } else { 1.0 }, d.y, d.z)
}

/// Strokes along the lay, spread evenly (farthest-point order) over the left half of the skin.
fn guides(species: &Species, body: &Body, model: &Model) -> Vec<Guide> {
    let points: Vec<Vec3> = model.parts[0]
        .primitive
        .vertices
        .iter()
        .map(|v| v.position)
        .filter(|p| p.x > 0.3 * species.cell)
        .collect();
    let mut distance = vec![f32::MAX; points.len()];
    // Small features (head, face) want denser guides than the wing.
    let density = |p: Vec3| {
        if p.y > species.arcs.head_plane {
            2.2
        } else {
            1.0
        }
    };
    let mut next = 0;
    let mut chosen = Vec::new();
    for _ in 0..GUIDES.min(points.len()) {
        chosen.push(points[next]);
        let at = points[next];
        let mut best = (-1.0, 0);
        for (i, p) in points.iter().enumerate() {
            distance[i] = distance[i].min(p.distance(at));
            let value = distance[i] * density(*p);
            if value > best.0 {
                best = (value, i);
            }
        }
        next = best.1;
    }
    // Two rings round the eye, where the lay turns fastest.
    let eye = species.joint("eye_L");
    for (radius, n) in [(1.55, 8), (2.3, 10)] {
        for k in 0..n {
            let a = std::f32::consts::TAU * (k as f32 + 0.5) / n as f32;
            let r = radius * species.eye[0];
            let around = eye + Vec3::new(2.0, r * a.sin(), r * a.cos());
            chosen.push(body.project(around, 3));
        }
    }
    if let Some(disc) = species.disc {
        chosen.extend(disc.points().map(|p| body.project(p, 3)));
    }
    chosen
        .into_iter()
        .map(|start| {
            let step = 4.0 * species.scale.sqrt();
            let mut points = vec![start];
            for _ in 0..2 {
                let p = points[points.len() - 1];
                let half = body.project(p + lay(species, body, p) * (0.5 * step), 1);
                points.push(body.project(p + lay(species, body, half) * step, 1));
            }
            let round = |v: Vec3| v.to_array().map(|c| (c * 100.0).round() / 100.0);
            let mut guide = Guide::new(points.into_iter().map(round).collect::<Vec<_>>());
            guide.mirror = true;
            guide
        })
        .collect()
}

/// Prints what the folded rows do: azimuths, tips against the tail, and how well the weights fit.
pub fn report(species: &Species, model: &Model, groom: &Groom) {
    let body = Body::new(species);
    let builder = Builder::new(species, &body);
    let worst = (0..=10)
        .map(|i| builder.fit(i as f32 / 10.0).1)
        .fold([0.0_f32; 2], |a, b| [a[0].max(b[0]), a[1].max(b[1])]);
    println!(
        "  secondaries miss the folded frame by {:.1} degrees at most, the spread one by {:.1}",
        worst[0], worst[1]
    );
    let skeleton = &model.skeleton;
    let pose = idle::pose(species, skeleton, 0.0);
    let (matrices, rotations) = (skeleton.matrices(&pose), skeleton.rotations(&pose));
    let slope = species.tail[0].to_radians();
    let back = Vec3::new(0.0, -slope.sin(), -slope.cos());
    let dorsal = Vec3::X.cross(back);
    let tail = species.joint("tail");
    for name in ["primaries", "secondaries", "greater_coverts", "rectrices"] {
        let Some(row) = groom.rows.iter().find(|r| r.name == name) else {
            continue;
        };
        let posed = preview::pose_row(skeleton, &matrices, &rotations, row, false);
        let tips: Vec<String> = posed
            .iter()
            .map(|f| {
                let tip = f.root + f.direction * f.length;
                format!(
                    "({:.0} {:.0} {:.0})",
                    tip.x,
                    (tip - tail).dot(dorsal),
                    (tip - tail).dot(back)
                )
            })
            .collect();
        println!(
            "  folded {name}: tips (x, above tail, beyond tail root) {}",
            tips.join(" ")
        );
    }
}

/// Whether down grows below the feathers of a tract: not on the face, the wings and the feet.
fn is_downy(name: &str) -> bool {
    const BARE: [&str; 16] = [
        "disc",
        "eye_rays",
        "ruff",
        "face_lines",
        "lore",
        "face",
        "scapulars",
        "shoulder",
        "shoulder_side",
        "lesser_upper",
        "elbow",
        "marginal_upper",
        "marginal_hand",
        "lesser_under",
        "marginal_under",
        "tarsal",
    ];
    !BARE.contains(&name)
}
