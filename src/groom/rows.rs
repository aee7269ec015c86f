//! Rows of feathers on bones: frames between stations, one *fan joint* per feather.
//!
//! A flight feather is not carried by the skin: its root rides on one bone while it turns with a blend of several. So each gets
//! a joint of its own, which [`super::fan`] moves every frame.

use super::{
    asset::{JointWeight, Row, Station},
    card::Card,
    drape::{Shaft, arc},
    lay::tangent,
    leaf::{Leaf, vary},
    skin::{SkinMesh, SurfacePoint},
};
use crate::maths::seed::{Stream, mix, name_hash};
use bevy::math::{Mat3, Mat4, Quat, Vec3};

/// A joint that carries one feather of a row.
#[derive(Clone, Debug, PartialEq)]
pub struct FanJoint {
    /// Row, side and number: `primaries_L_3`.
    pub name: String,
    /// Root of the feather in bind pose, model space, metres.
    pub root: Vec3,
    /// Frame in bind pose: x to the right of the front face, y along the rachis, z its normal.
    pub frame: Quat,
    /// Joints that carry the root; weights sum to 1 (empty: the model itself).
    pub ride: Vec<(u16, f32)>,
    /// Joints whose rotation it follows; weights sum to 1 (empty: those that carry it).
    pub follow: Vec<(u16, f32)>,
}

impl FanJoint {
    /// Model to joint in bind pose: the entry of the skin's inverse bind poses.
    pub fn inverse_bind(&self) -> Mat4 {
        Mat4::from_rotation_translation(self.frame, self.root).inverse()
    }
}

/// What the rows need to know of the bird.
pub struct RowContext<'a> {
    /// Skin, for roots whose joints are unknown.
    pub skin: &'a SkinMesh,
    /// Names of the body's joints.
    pub joints: &'a [String],
    /// Metres per unit.
    pub unit: f32,
    /// Seed of the bird.
    pub seed: u64,
    /// Index of the row as a region.
    pub region: u16,
    /// Number of fan joints there are already, body joints included.
    pub first_joint: usize,
}

/// Turns a left joint's name into the right one's: `wing_L`, `wing_L.001` and `Wing_L_end`, not `wing_Lower`.
pub fn mirror_name(name: &str) -> String {
    let mut out = String::with_capacity(name.len());
    let mut rest = name;
    while let Some(at) = rest.find("_L") {
        let after = &rest[at + 2..];
        out.push_str(&rest[..at]);
        out.push_str(
            if after
                .chars()
                .next()
                .is_none_or(|c| !c.is_ascii_alphabetic())
            {
                "_R"
            } else {
                "_L"
            },
        );
        rest = after;
    }
    out + rest
}

fn blend_names(
    stations: (&Station, &Station),
    t: f32,
    pick: fn(&Station) -> &Vec<JointWeight>,
    mirrored: bool,
) -> Vec<(String, f32)> {
    let mut list: Vec<(String, f32)> = Vec::new();
    for (station, share) in [(stations.0, 1.0 - t), (stations.1, t)] {
        let weights = pick(station);
        let total: f32 = weights.iter().map(|ride| ride.weight).sum();
        for JointWeight { joint, weight } in weights {
            let value = weight * share / total.max(f32::MIN_POSITIVE);
            if value <= 0.0 || !value.is_finite() {
                continue;
            }
            let name = if mirrored {
                mirror_name(joint)
            } else {
                joint.clone()
            };
            match list.iter_mut().find(|(known, _)| *known == name) {
                Some((_, sum)) => *sum += value,
                None => list.push((name, value)),
            }
        }
    }
    list
}

impl RowContext<'_> {
    /// Finds joints by name; names not in the skin go to `missing`. Weights sum to 1, or the list is empty.
    fn resolve(&self, names: Vec<(String, f32)>, missing: &mut Vec<String>) -> Vec<(u16, f32)> {
        let mut list = Vec::new();
        for (name, weight) in names {
            match self.joints.iter().position(|joint| *joint == name) {
                Some(joint) => list.push((joint as u16, weight)),
                None if self.joints.is_empty() || missing.contains(&name) => {}
                None => missing.push(name),
            }
        }
        let total: f32 = list.iter().map(|(_, weight)| weight).sum();
        list.iter_mut().for_each(|(_, weight)| *weight /= total);
        list
    }

    fn nearest_skin(&self, root: Vec3) -> Vec<(u16, f32)> {
        let near = (0..self.skin.positions.len()).min_by(|&a, &b| {
            self.skin.positions[a]
                .distance_squared(root)
                .total_cmp(&self.skin.positions[b].distance_squared(root))
        });
        let weights = near.and_then(|vertex| self.skin.weights.get(vertex));
        weights
            .into_iter()
            .flat_map(|(joints, weights)| joints.iter().copied().zip(*weights))
            .filter(|(_, w)| *w > 0.0)
            .collect()
    }

    /// The skin below each point of a shaft, as far as there is skin within a feather's width.
    fn skin_below(&self, points: &[Vec3], normals: &[Vec3], width: f32) -> Vec<SurfacePoint> {
        let below = points.iter().zip(normals).map_while(|(point, normal)| {
            let below = self.skin.nearest(*point, *normal)?;
            let distance = self.skin.position(below).distance(*point);
            (distance <= width).then_some(below)
        });
        below.collect()
    }

    /// Feathers and fan joints of one row, both sides. Joint names that the skin lacks are added to `missing`; such a root
    /// rides on the skin nearest to it.
    pub fn build(&self, row: &Row, missing: &mut Vec<String>) -> (Vec<Leaf>, Vec<FanJoint>) {
        let (mut leaves, mut fans) = (Vec::new(), Vec::new());
        let sides: &[bool] = if row.mirror { &[false, true] } else { &[false] };
        for &mirrored in sides {
            for number in 0..row.lengths.len() {
                let (leaf, fan) = self.feather(
                    row,
                    number,
                    mirrored,
                    self.first_joint + fans.len(),
                    missing,
                );
                leaves.push(leaf);
                fans.push(fan);
            }
        }
        (leaves, fans)
    }

    fn feather(
        &self,
        row: &Row,
        number: usize,
        mirrored: bool,
        joint: usize,
        missing: &mut Vec<String>,
    ) -> (Leaf, FanJoint) {
        let count = row.lengths.len();
        let t = if count > 1 {
            number as f32 / (count - 1) as f32
        } else {
            0.0
        };
        let after = row
            .stations
            .iter()
            .position(|station| station.at >= t)
            .unwrap_or(row.stations.len() - 1)
            .max(1);
        let (a, b) = (&row.stations[after - 1], &row.stations[after]);
        let local = ((t - a.at) / (b.at - a.at)).clamp(0.0, 1.0);
        let mix3 = |x: [f32; 3], y: [f32; 3]| Vec3::from_array(x).lerp(Vec3::from_array(y), local);
        let unit3 = |x: [f32; 3]| Vec3::from_array(x).normalize_or(Vec3::Z);
        let along = mix3(unit3(a.direction).into(), unit3(b.direction).into())
            .normalize_or(unit3(a.direction));
        let normal = mix3(unit3(a.normal).into(), unit3(b.normal).into());
        let normal = tangent(normal, along).unwrap_or_else(|| along.any_orthonormal_vector());
        let side_name = if !row.mirror {
            ""
        } else if mirrored {
            "_R"
        } else {
            "_L"
        };
        let name = format!("{}{side_name}_{number}", row.name);
        let seed = mix(
            name_hash(self.seed, &row.name),
            mix(number as u64, u64::from(mirrored)),
        );
        let mut draw = Stream::new(seed);
        let jitter = row.jitter;
        let length = row.lengths[number] * self.unit * (1.0 + jitter.length * draw.normal());
        let width = row.width.at(t) * self.unit * (1.0 + jitter.width * draw.normal());
        let yaw = (jitter.yaw * draw.normal()).to_radians();
        let roll = (jitter.roll * draw.normal()).to_radians();
        let lift = (row.lift.at(t) + jitter.lift * draw.normal()).to_radians();
        let (hue, value) = (jitter.hue * draw.normal(), jitter.value * draw.normal());
        // The stack is centred on the stations' plane; it rises with the layer.
        let rank = number as f32 - 0.5 * (count - 1) as f32;
        let step = row.offset
            * self.unit
            * if row.layer.1 < row.layer.0 {
                -rank
            } else {
                rank
            };
        let mut root = mix3(a.root, b.root) * self.unit + normal * step;
        let turned = Quat::from_axis_angle(normal, yaw) * along;
        let mut along = (turned * lift.cos() + normal * lift.sin()).normalize_or(along);
        let mut normal =
            Quat::from_axis_angle(along, roll) * tangent(normal, along).unwrap_or(normal);
        if mirrored {
            let flip = Vec3::new(-1.0, 1.0, 1.0);
            (root, along, normal) = (root * flip, along * flip, normal * flip);
        }
        let ride = self.resolve(blend_names((a, b), local, |s| &s.ride, mirrored), missing);
        let ride = if ride.is_empty() {
            self.nearest_skin(root)
        } else {
            ride
        };
        let follow = self.resolve(blend_names((a, b), local, |s| &s.follow, mirrored), missing);
        let follow = if follow.is_empty() {
            ride.clone()
        } else {
            follow
        };
        let frame =
            Quat::from_mat3(&Mat3::from_cols(along.cross(normal), along, normal)).normalize();
        let segments = usize::from(row.segments.along).clamp(1, 64);
        let curl = row.curl.to_radians();
        let points: Vec<Vec3> = (0..=segments)
            .map(|i| root + arc(along, normal, curl, length, i as f32 / segments as f32))
            .collect();
        let normals: Vec<Vec3> = (0..=segments)
            .map(|i| {
                Quat::from_axis_angle(along.cross(normal), -curl * i as f32 / segments as f32)
                    * normal
            })
            .collect();
        let weights = if self.joints.is_empty() {
            ([0; 4], [0.0; 4])
        } else {
            ([joint as u16, 0, 0, 0], [1.0, 0.0, 0.0, 0.0])
        };
        let card = Card {
            root,
            along,
            normal,
            center: root,
            radius: length,
            length,
            width,
            joints: weights.0,
            weights: weights.1,
            feather: row.feather,
            region: self.region,
            layer: row.layer.at(t),
            tint: vary(row.tint, t, hue, value),
            seed: (seed >> 32) as u32,
            // Seen from the front with the tip up, the leading vane of a left wing's feather is on the right.
            turn: 0.0,
            mirrored: if row.mirror {
                mirrored == row.handed
            } else {
                false
            },
        };
        let below = self.skin_below(&points, &normals, width);
        let shaft = Shaft {
            heights: Vec::new(),
            points,
            normals,
            below,
            across: 0.0,
        };
        let columns = usize::from(row.segments.across).clamp(1, 16);
        let leaf = Leaf {
            card,
            shaft,
            weights: vec![weights],
            camber: row.camber,
            columns,
            raised: Vec::new(),
            raised_further: Vec::new(),
            windows: Vec::new(),
            held: 0.0,
        };
        (
            leaf,
            FanJoint {
                name,
                root,
                frame,
                ride,
                follow,
            },
        )
    }
}
