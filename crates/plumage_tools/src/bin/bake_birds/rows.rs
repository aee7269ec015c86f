//! Rows of flight feathers and their coverts: frames in bind pose, and the joints that fan them.

use bevy::math::{Quat, Vec3};
use bevy_plumage::groom::{JointWeight, Row, Segments, Span, Station, Tint};

use crate::body::Body;
use crate::species::{RowLook, Species, srgb};
use crate::wing::WingPlane;

type Weights = Vec<JointWeight>;

/// Builds rows for one bird.
pub struct Builder<'a> {
    species: &'a Species,
    body: &'a Body<'a>,
    bind: WingPlane,
    /// Secondaries proper as a share of secondaries and tertials.
    ulna_share: f32,
}

fn joint(name: &str, weight: f32) -> JointWeight {
    JointWeight::new(name, (weight * 1e4).round() / 1e4)
}

fn round(v: Vec3, digits: f32) -> [f32; 3] {
    v.to_array().map(|c| (c * digits).round() / digits)
}

fn station(
    at: f32,
    root: Vec3,
    direction: Vec3,
    normal: Vec3,
    ride: Weights,
    follow: Weights,
) -> Station {
    let mut station = Station::new(
        at,
        round(root, 100.0),
        round(direction, 1e5),
        round(normal, 1e5),
    );
    station.ride = ride;
    station.follow = follow;
    station
}

impl<'a> Builder<'a> {
    /// Prepares the bind frame.
    pub fn new(species: &'a Species, body: &'a Body<'a>) -> Self {
        let count = |name: &str| {
            let row = species.rows.iter().find(|look| look.name == name);
            row.map_or(0.0, |look| look.count as f32)
        };
        let (secondaries, tertials) = (count("secondaries"), count("tertials"));
        Self {
            species,
            body,
            bind: WingPlane::bind(species),
            ulna_share: secondaries / (secondaries + tertials),
        }
    }

    /// All rows.
    pub fn rows(&self) -> Vec<Row> {
        let mut rows: Vec<Row> = self.species.rows.iter().map(|l| self.row(l)).collect();
        rows.extend(self.tail_coverts());
        rows
    }

    fn row(&self, look: &RowLook) -> Row {
        let n = look.count;
        let [primaries, secondaries, rectrices] = &self.species.lengths;
        let lengths = match look.name {
            "primaries" => primaries.clone(),
            "secondaries" => secondaries[..n].to_vec(),
            "tertials" => secondaries[secondaries.len() - n..].to_vec(),
            "rectrices" => rectrices.clone(),
            _ => ramp(look.length, n),
        };
        let stations = (0..n)
            .map(|i| {
                let t = i as f32 / (n - 1) as f32;
                let (root, direction, normal, ride, follow) = self.frame(look.name, t, i);
                station(
                    t,
                    root,
                    direction.normalize(),
                    normal.normalize(),
                    ride,
                    follow,
                )
            })
            .collect();
        // Proximal over distal, coverts over remiges.
        let layer = match look.name {
            "primaries" => Span(719., 710.),
            "secondaries" => Span(720., 735.),
            "tertials" => Span(736., 740.),
            "alula" => Span(830., 835.),
            "rectrices" => Span(109., 100.),
            "primary_coverts" => Span(809., 800.),
            "greater_coverts" => Span(810., 825.),
            "median_primary" => Span(909., 900.),
            "median_secondary" => Span(910., 925.),
            "under_primary" | "under_secondary" => Span(800., 820.),
            "axillaries" => Span(950., 960.),
            name => match lesser(name) {
                Some(number) => Span(910. + 20. * number, 925. + 20. * number),
                None => Span(900., 920.),
            },
        };
        let mut row = Row::new(look.name, lengths, stations);
        row.feather = template(self.species, look.feather);
        row.width = Span(look.width.0, look.width.1);
        row.mirror = true;
        // Seen from the front, tip up, the leading vane of a left feather is the left one only under the wing.
        row.handed = look.name.starts_with("under") || look.name == "axillaries";
        row.lift = Span(look.bend.0, look.bend.0);
        row.camber = look.bend.1;
        row.curl = look.bend.2;
        row.layer = layer;
        row.segments = Segments::new(look.segments.0, look.segments.1);
        row.tint = Tint(srgb(look.tint.0), srgb(look.tint.1));
        row.jitter.length = 0.012;
        row.jitter.width = 0.03;
        row.jitter.yaw = 0.5;
        row.jitter.roll = 0.7;
        row.jitter.lift = 0.3;
        row.jitter.hue = 1.0;
        row.jitter.value = 0.03;
        row
    }

    /// Root, direction, normal, ride and follow of a feather at place `t` of a row.
    fn frame(&self, name: &str, t: f32, index: usize) -> (Vec3, Vec3, Vec3, Weights, Weights) {
        let n = self.bind.normal;
        let s = self.species.scale;
        // Planes of the closed stack, innermost on top.
        let step = 0.2 * s;
        match name {
            "primaries" => {
                let number = 1.0 + 9.0 * t;
                let (root, ride) = self.hand_point(number, 0.6);
                let direction = self.bind.direction(self.bind.primary(number));
                (
                    root - n * (step * (index as f32 + 10.0)),
                    direction,
                    self.tilt(direction, 2.5),
                    ride,
                    self.primary_follow(number),
                )
            }
            // Tertials go on where the secondaries end; behind the elbow they curve down onto the rump.
            "secondaries" | "tertials" => {
                let remiges = &self.species.lengths[1];
                let last = remiges.len() - 1;
                let place = if name == "tertials" {
                    (self.ulna_share * remiges.len() as f32).round() as usize + index
                } else {
                    index
                };
                let share = place as f32 / last as f32;
                let (root, ride) = self.arm_point(share, 1.0);
                let direction = self
                    .bind
                    .direction(self.bind.secondary(share, self.species).0);
                (
                    root + n * (step * (place as f32 - 6.0)),
                    direction,
                    self.tilt(direction, 2.0),
                    ride,
                    self.secondary_follow(share),
                )
            }
            "alula" => {
                let from = self.species.joint("alula_L");
                let along = self.bind.direction(self.bind.azimuths[2]);
                let root = self.body.project(
                    from + along * (3.0 * s * (3.0 - index as f32)) + n * (4.0 * s),
                    3,
                ) + n * (0.4 * s * index as f32);
                let direction = self.bind.direction(self.bind.azimuths[2] + 15.0 - 7.0 * t);
                (
                    root,
                    direction,
                    n,
                    vec![joint("alula_L", 1.0)],
                    vec![joint("alula_L", 1.0)],
                )
            }
            "primary_coverts" | "median_primary" | "under_primary" | "under_median_primary" => {
                let number = 1.0 + 9.0 * t;
                let (back, side) = match name {
                    "primary_coverts" => (0.75, 1.0),
                    "median_primary" => (0.0, 1.0),
                    "under_primary" => (0.35, -1.0),
                    _ => (0.0, -1.0),
                };
                let (point, ride) = self.hand_point(number, back);
                // The coverts of the primaries come out of the trailing skin, so that the folded hand stays below the forearm's.
                let root = match name {
                    "primary_coverts" => point + n * (1.0 * s),
                    _ => self.on_skin(point, side),
                };
                let azimuth = self.bind.primary(number) - 3.0;
                let direction = self.bind.direction(azimuth);
                (root, direction, n * side, ride, self.primary_follow(number))
            }
            "greater_coverts"
            | "median_secondary"
            | "under_secondary"
            | "under_median_secondary" => {
                let (back, side) = match name {
                    "greater_coverts" => (0.72, 1.0),
                    "median_secondary" => (0.4, 1.0),
                    "under_secondary" => (0.72, -1.0),
                    _ => (0.4, -1.0),
                };
                let (point, ride) = self.arm_point(t, back);
                let root = self.on_skin(point, side);
                let azimuth = self.bind.secondary(t, self.species).0 - 4.0;
                let direction = self.bind.direction(azimuth);
                let follow = self.secondary_follow(t);
                (
                    root,
                    direction,
                    self.tilt(direction, 2.0 * side) * side,
                    ride,
                    follow,
                )
            }
            // Rows that spread from the wrist over the patagium, the first along the ulna, the last next to the leading edge.
            _ if lesser(name).is_some() => {
                let number = lesser(name).unwrap_or(1.0);
                let (across, along) = ((number - 0.8) / 5.0, 0.06 + 0.92 * t);
                let [shoulder, elbow, wrist, ..] = self.bind.points;
                let at_shoulder = across * along;
                let point =
                    shoulder * at_shoulder + elbow * (along - at_shoulder) + wrist * (1.0 - along);
                let direction = self
                    .bind
                    .direction(self.bind.secondary(t, self.species).0 - 4.0);
                (
                    self.on_skin(point, 1.0),
                    direction,
                    self.tilt(direction, 2.0),
                    vec![
                        joint("propat_L", at_shoulder),
                        joint("ulna_L", 1.0 - at_shoulder),
                    ],
                    self.secondary_follow(t),
                )
            }
            "axillaries" => {
                let [shoulder, elbow, ..] = self.bind.points;
                let along = shoulder.lerp(elbow, 0.12 + 0.8 * t);
                let behind =
                    self.bind.direction(self.bind.azimuths[0] + 90.0) * (0.6 * self.species.arm[0]);
                let root = self.on_skin(along + behind, -1.0);
                let direction = self.bind.direction(80.0 + 15.0 * (1.0 - t));
                let follow = vec![joint("humerus_L", 0.15), joint("ulna_L", 0.85)];
                (root, direction, -n, vec![joint("humerus_L", 1.0)], follow)
            }
            _ => self.rectrix(index),
        }
    }

    /// Bind normal rolled a little about the rachis, so that neighbors lie like roof tiles.
    fn tilt(&self, direction: Vec3, degrees: f32) -> Vec3 {
        Quat::from_axis_angle(direction, degrees.to_radians()) * self.bind.normal
    }

    /// Root on the hand for primary `number`; `back` 1 is the trailing skin edge, 0 the bone axis.
    fn hand_point(&self, number: f32, back: f32) -> (Vec3, Weights) {
        let [_, _, wrist, knuckle, tip] = self.bind.points;
        let (point, digit) = if number <= 7.0 {
            (wrist.lerp(knuckle, 0.06 + 0.94 * (number - 1.0) / 6.0), 0.0)
        } else {
            (knuckle.lerp(tip, 0.26 * (number - 7.0)), 1.0)
        };
        let behind =
            self.bind.direction(self.bind.azimuths[2] + 90.0) * (self.species.arm[2] * back);
        let ride = if digit > 0.0 {
            vec![joint("digit_L", 1.0)]
        } else {
            vec![joint("hand_L", 1.0)]
        };
        (point + behind, ride)
    }

    /// Root behind the ulna (shares up to the last secondary) or behind the elbow (tertials).
    fn arm_point(&self, share: f32, back: f32) -> (Vec3, Weights) {
        let [shoulder, elbow, wrist, ..] = self.bind.points;
        let reach = (0.5 * self.species.arm[1] + self.species.arm[4]) * back;
        let behind = self.bind.direction(self.bind.azimuths[1] + 90.0);
        if share <= self.ulna_share {
            let f = 0.94 - 0.86 * share / self.ulna_share;
            let w = ((0.2 - f) / 0.4).clamp(0.0, 0.3);
            (
                elbow.lerp(wrist, f) + behind * reach,
                vec![joint("ulna_L", 1.0 - w), joint("humerus_L", w)],
            )
        } else {
            let f = (share - self.ulna_share) / (1.0 - self.ulna_share);
            let start = elbow.lerp(wrist, 0.08);
            let end = elbow.lerp(shoulder, 0.12);
            let w = 0.3 + 0.15 * f;
            (
                start.lerp(end, f) + behind * (reach * (1.0 - 0.25 * f)),
                vec![joint("ulna_L", 1.0 - w), joint("humerus_L", w)],
            )
        }
    }

    /// The skin above (`side` 1) or below (-1) a point of the wing plane.
    fn on_skin(&self, point: Vec3, side: f32) -> Vec3 {
        let n = self.bind.normal * side;
        // March from outside: the nearest surface point of an inner point might be the wrong face.
        let mut p = point + n * (1.6 * self.species.arm[0]);
        for _ in 0..24 {
            let d = self.body.distance(p);
            if d < 0.1 {
                break;
            }
            p -= n * d.min((p - point).dot(n).max(0.0));
        }
        p + n * (0.3 * self.species.scale)
    }

    /// From the law of the opening hand: the share `w` of the ulna falls from P1 to P10.
    fn primary_follow(&self, number: f32) -> Weights {
        let w = 0.04 + (0.432 - 0.04) * ((10.0 - number) / 9.0).max(0.0).powf(0.9);
        vec![joint("hand_L", 1.0 - w), joint("ulna_L", w)]
    }

    /// Weights of hand, ulna and chest that best give the folded and the spread frame of a secondary or tertial.
    fn secondary_follow(&self, share: f32) -> Weights {
        let (fitted, _) = self.fit(share);
        vec![
            joint("hand_L", fitted[0]),
            joint("ulna_L", fitted[1]),
            joint("chest", fitted[2]),
        ]
    }

    /// Fitted weights, and the angles (degrees) by which they miss the folded and the spread frame.
    pub fn fit(&self, share: f32) -> ([f32; 3], [f32; 2]) {
        let rest = self.bind.secondary(share, self.species).0;
        let poses = [self.species.fold, self.species.spread].map(|pose| {
            let plane = WingPlane::new(self.species, pose);
            let (azimuth, roll) = plane.secondary(share, self.species);
            let target = plane.feather(&self.bind, azimuth, rest, roll);
            let [_, ulna, hand] = plane.rotations(&self.bind);
            (target, [hand, ulna, Quat::IDENTITY])
        });
        let miss = |w: [f32; 3], pose: &(Quat, [Quat; 3])| {
            let mut sum = Quat::from_xyzw(0.0, 0.0, 0.0, 0.0);
            for (q, v) in pose.1.iter().zip(w) {
                let q = if q.dot(pose.1[0]) < 0.0 { -*q } else { *q };
                sum += q * v;
            }
            sum.normalize().angle_between(pose.0).to_degrees()
        };
        let mut best = (f32::MAX, [1.0, 0.0, 0.0]);
        let steps = 50;
        for i in 0..=steps {
            for j in 0..=steps - i {
                let w = [i, j, steps - i - j].map(|k| k as f32 / steps as f32);
                let cost = 3.0 * miss(w, &poses[0]).powi(2) + miss(w, &poses[1]).powi(2);
                if cost < best.0 {
                    best = (cost, w);
                }
            }
        }
        (best.1, [miss(best.1, &poses[0]), miss(best.1, &poses[1])])
    }

    fn tail_axes(&self) -> (Vec3, Vec3) {
        let slope = self.species.tail[0].to_radians();
        let back = Vec3::new(0.0, -slope.sin(), -slope.cos());
        (back, Vec3::X.cross(back))
    }

    fn rectrix(&self, index: usize) -> (Vec3, Vec3, Vec3, Weights, Weights) {
        let (back, dorsal) = self.tail_axes();
        let i = index as f32 + 1.0;
        let share = (i - 0.5) / 5.5;
        let yaw = (self.species.tail[1] * share).to_radians();
        let direction = back * yaw.cos() + Vec3::X * yaw.sin();
        let normal = Quat::from_axis_angle(direction, (-3.0 * i).to_radians()) * dorsal;
        let s = self.species.scale;
        let root = self.species.joint("tail")
            + back * (4.0 * s)
            + Vec3::X * (2.2 * s * (i - 0.5))
            + dorsal * (0.8 * s * (3.0 - i));
        let follow = vec![joint("tail", 1.0 - share), joint("tail_fan_L", share)];
        (root, direction, normal, vec![joint("tail", 1.0)], follow)
    }

    fn tail_coverts(&self) -> Vec<Row> {
        let coverts = self.species.tail_coverts;
        let (back, dorsal) = self.tail_axes();
        let s = self.species.scale.sqrt();
        let mut out = Vec::new();
        for (k, side) in [1.0_f32, -1.0].into_iter().enumerate() {
            let rows = coverts.rows[k];
            for (j, &n) in rows.iter().enumerate() {
                let t = j as f32 / (rows.len() - 1) as f32;
                let length = coverts.length[k].0 + (coverts.length[k].1 - coverts.length[k].0) * t;
                let width = coverts.width.0 + (coverts.width.1 - coverts.width.0) * t;
                let centre = self.species.joint("tail") - back * ((2.0 + 26.0 * t) * s);
                let half = (0.38 + 0.22 * t) * self.species.trunk[0][5];
                let stations = (0..n)
                    .map(|i| {
                        let u = i as f32 / (n - 1) as f32;
                        // Odd rows stand in the gaps of even ones.
                        let x = half * (u + if j % 2 == 0 { 0.04 } else { 0.12 }) / 1.12;
                        let around = (x / half * 1.2).min(1.35);
                        let out_dir = dorsal * (side * around.cos()) + Vec3::X * around.sin();
                        let mut p = centre + out_dir * self.species.trunk[1][4];
                        for _ in 0..24 {
                            p -= out_dir * (0.8 * self.body.distance(p).max(0.0));
                        }
                        let yaw = 0.10 * x / half;
                        let direction = (back + Vec3::X * yaw - out_dir * 0.05).normalize();
                        let normal = out_dir.reject_from(direction).normalize();
                        let weights = |hips: f32| {
                            vec![joint("tail", 1.0 - hips * t), joint("hips", hips * t)]
                        };
                        station(u, p, direction, normal, weights(0.6), weights(0.3))
                    })
                    .collect();
                let tint = Tint(srgb(coverts.tint[k]), srgb(coverts.tint[k]));
                let name = format!("{}_tail_coverts_{}", ["upper", "under"][k], j + 1);
                let mut row = Row::new(name, vec![length; n], stations);
                row.feather = template(self.species, coverts.feather[k]);
                row.width = Span(width, width);
                row.mirror = true;
                row.lift = Span(4.0, 4.0);
                row.camber = 0.05;
                row.curl = 5.0;
                row.layer = Span(200.0 + 20.0 * j as f32, 205.0 + 20.0 * j as f32);
                row.segments = Segments::new(5, 2);
                row.tint = tint;
                out.push(row);
            }
        }
        out
    }
}

/// Number of a row of lesser coverts, `lesser_1` next to the ulna.
fn lesser(name: &str) -> Option<f32> {
    name.strip_prefix("lesser_")?.parse().ok()
}

fn ramp(ends: (f32, f32), n: usize) -> Vec<f32> {
    (0..n)
        .map(|i| ends.0 + (ends.1 - ends.0) * i as f32 / (n.max(2) - 1) as f32)
        .collect()
}

/// Number of a template in the groom's feather list.
pub fn template(species: &Species, name: &str) -> u16 {
    species
        .templates
        .iter()
        .position(|t| *t == name)
        .unwrap_or(0) as u16
}
