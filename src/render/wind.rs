//! Wind and ruffle: what bends cards about their roots (twin of `shaders/wind.wgsl`; amounts after the bird study, section 5).

use super::{material::FeatherMaterial, pack::MAX_REGIONS};
use crate::groom::{Groom, PlumageCards};
use bevy::{
    asset::RenderAssetUsages,
    prelude::*,
    render::{render_resource::BufferUsages, storage::ShaderBuffer},
};

/// The air over the whole world; still by default. Cards bend in the vertex function, in every pass alike.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Resource, Default)]
pub struct Wind {
    /// Where the air moves to; any length.
    pub direction: Vec3,
    /// Steady speed, m/s, 0..40 (a breeze: 1.2).
    pub speed: f32,
    /// Speed that gusts add at most, m/s, 0..40 (3).
    pub gusts: f32,
    /// Size of an eddy, metres, 0.01..10; a gust is four eddies long.
    pub eddy: f32,
    /// How often an eddy changes, 1/s, 0..10.
    pub frequency: f32,
}

impl Default for Wind {
    fn default() -> Self {
        Self {
            direction: Vec3::X,
            speed: 0.0,
            gusts: 0.0,
            eddy: 0.4,
            frequency: 0.7,
        }
    }
}

impl Wind {
    /// A wind towards `direction` at `speed` m/s with gusts of as much again.
    pub fn new(direction: Vec3, speed: f32) -> Self {
        Self {
            direction,
            speed,
            gusts: speed,
            ..Self::default()
        }
    }

    fn rows(&self, regions: usize) -> [[f32; 4]; 2] {
        let direction = self.direction.try_normalize().unwrap_or(Vec3::X);
        let finite = |x: f32, low: f32, high: f32| {
            if x.is_finite() {
                x.clamp(low, high)
            } else {
                low
            }
        };
        [
            direction.extend(finite(self.speed, 0.0, 40.0)).to_array(),
            [
                finite(self.gusts, 0.0, 40.0),
                finite(self.eddy, 0.01, 10.0),
                finite(self.frequency, 0.0, 10.0),
                regions as f32,
            ],
        ]
    }
}

/// How far a bird ruffles its feathers; put it beside `Plumage`. Without it nothing is ruffled.
#[derive(Component, Clone, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default)]
pub struct Ruffle {
    /// Of the whole coat, 0 (flat) to 1 (45 degrees for feathers of no stiffness, nothing for flight feathers). A bird that shakes
    /// itself raises them by 10 to 14 degrees, 0.3; one that fluffs itself up in the cold as far as they go.
    pub amount: f32,
    /// Of single regions of the groom by name, 0..1, in place of `amount`.
    pub regions: Vec<(String, f32)>,
}

/// Angle by which a soft feather turns about its root when it is ruffled as far as it goes, radians.
pub const RUFFLE_LIFT: f32 = 45.0 * std::f32::consts::PI / 180.0;
/// Yaw to either side of a feather ruffled as far as it goes, radians: 2 degrees where it is raised by 14.
pub const RUFFLE_YAW: f32 = 6.0 * std::f32::consts::PI / 180.0;

/// How a feather of `stiffness` 0..1 answers the wind: (compliance in rad s^2 m^-2.5, largest angle of the tip in radians:
/// 14 degrees for the softest, 8 for a contour feather, 1.5 for a flight feather).
pub fn wind_response(stiffness: f32) -> (f32, f32) {
    let s = stiffness.clamp(0.0, 1.0);
    let limit = 1.5 + 12.5 * (1.0 - s) * (1.0 - s);
    (1f32.to_radians() / s.max(0.1), limit.to_radians())
}

/// Rows of one bird: wind, then (lift, compliance, limit, yaw) of every region.
fn motion_rows(
    wind: &Wind,
    ruffle: Option<&Ruffle>,
    groom: Option<&Groom>,
    count: usize,
) -> Vec<[f32; 4]> {
    let mut rows = wind.rows(count).to_vec();
    for index in 0..count {
        let region = groom.and_then(|groom| groom.regions.get(index));
        let is_row = groom.is_some_and(|groom| index >= groom.regions.len());
        let stiffness = if is_row {
            1.0
        } else {
            region.map_or(0.5, |region| region.stiffness)
        };
        let (compliance, limit) = wind_response(stiffness);
        let amount = ruffle.map_or(0.0, |ruffle| {
            let named = region.and_then(|region| {
                let mut known = ruffle.regions.iter();
                known.find(|(name, _)| *name == region.name)
            });
            let amount = named.map_or(ruffle.amount, |(_, amount)| *amount);
            if amount.is_finite() {
                amount.clamp(0.0, 1.0)
            } else {
                0.0
            }
        }) * (1.0 - stiffness.clamp(0.0, 1.0));
        rows.push([RUFFLE_LIFT * amount, compliance, limit, RUFFLE_YAW * amount]);
    }
    rows
}

/// Number of regions that a bird's cards name, at least 1.
fn region_count(cards: &PlumageCards) -> usize {
    let most = cards.cards.iter().map(|card| card.region).max();
    (usize::from(most.unwrap_or(0)) + 1).min(MAX_REGIONS as usize)
}

/// The buffer of a bird in still air.
pub(super) fn still_motion(cards: &PlumageCards) -> ShaderBuffer {
    let rows = motion_rows(&Wind::default(), None, None, region_count(cards));
    let mut buffer = ShaderBuffer::new(&bytes(&rows, &rows), RenderAssetUsages::default());
    buffer.buffer_description.label = Some("feather_motion");
    buffer.buffer_description.usage = BufferUsages::STORAGE | BufferUsages::COPY_DST;
    buffer
}

fn bytes(now: &[[f32; 4]], before: &[[f32; 4]]) -> Vec<u8> {
    let rows = now.iter().chain(before).flatten();
    rows.flat_map(|value| value.to_le_bytes()).collect()
}

/// What a bird's buffer holds, now and a frame ago.
#[derive(Component)]
pub(super) struct Motion {
    buffer: AssetId<ShaderBuffer>,
    now: Vec<[f32; 4]>,
    settled: bool,
}

/// Writes a bird's buffer when its wind or ruffle has changed, and once more a frame later, when the change is the past. The
/// bind group stays.
pub(super) fn move_feathers(
    mut commands: Commands,
    wind: Res<Wind>,
    grooms: Res<Assets<Groom>>,
    ruffles: Query<&Ruffle>,
    mut birds: Query<(
        Entity,
        &PlumageCards,
        &MeshMaterial3d<FeatherMaterial>,
        Option<&mut Motion>,
    )>,
    materials: Res<Assets<FeatherMaterial>>,
    mut buffers: ResMut<Assets<ShaderBuffer>>,
) {
    for (entity, cards, material, motion) in &mut birds {
        let Some(material) = materials.get(material.id()) else {
            continue;
        };
        let now = motion_rows(
            &wind,
            ruffles.get(cards.owner).ok(),
            grooms.get(&cards.groom),
            region_count(cards),
        );
        let buffer = material.motion.id();
        let known = motion.filter(|motion| motion.buffer == buffer);
        if let Some(motion) = &known
            && motion.settled
            && motion.now == now
        {
            continue;
        }
        let before = known.as_ref().map_or(&now, |motion| &motion.now);
        if let Some(mut asset) = buffers.get_mut(buffer) {
            asset.data = Some(bytes(&now, before));
        }
        match known {
            Some(mut motion) => {
                motion.settled = motion.now == now;
                motion.now = now;
            }
            None => {
                commands.entity(entity).insert(Motion {
                    buffer,
                    now,
                    settled: true,
                });
            }
        }
    }
}

/// Share of a gust that small eddies make.
const EDDY_SHARE: f32 = 0.3;
/// A gust is this many eddies long.
const GUST_CELLS: f32 = 4.0;
/// Share of the opening that wind along the lay presses flat.
const PRESSING: f32 = 0.1;
/// Largest angle downwards over that upwards: the body is in the way.
const FLATTENING: f32 = 0.25;

fn lattice_value(point: IVec3) -> f32 {
    let [x, y, z] = point.to_array().map(|c| c as u32);
    let mixed =
        x.wrapping_add(1_664_525u32.wrapping_mul(y.wrapping_add(1_013_904_223u32.wrapping_mul(z))));
    let state = mixed.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (((word >> 22) ^ word) >> 8) as f32 / 16_777_216.0
}

/// Value noise in 0..1, smooth, one lattice cell per unit.
pub fn value_noise(p: Vec3) -> f32 {
    let base = p.floor();
    let f = p - base;
    let s = f * f * (Vec3::splat(3.0) - 2.0 * f);
    let i = base.clamp(Vec3::splat(-1e9), Vec3::splat(1e9)).as_ivec3();
    let mix = |a: f32, b: f32, t: f32| a * (1.0 - t) + b * t;
    let edge = |y: i32, z: i32| {
        let at = |x: i32| lattice_value(i + IVec3::new(x, y, z));
        mix(at(0), at(1), s.x)
    };
    mix(
        mix(edge(0, 0), edge(1, 0), s.y),
        mix(edge(0, 1), edge(1, 1), s.y),
        s.z,
    )
}

/// Velocity of the air at a place and time (seconds), m/s. Gusts travel with it.
pub fn wind_velocity(wind: &Wind, position: Vec3, time: f32) -> Vec3 {
    let direction = wind.direction.try_normalize().unwrap_or(Vec3::X);
    let carried = position - direction * ((wind.speed + 0.5 * wind.gusts) * time);
    let eddy = carried / wind.eddy.max(1e-3);
    let turned = eddy + Vec3::Y * (wind.frequency * time);
    let gust =
        (1.0 - EDDY_SHARE) * value_noise(eddy / GUST_CELLS) + EDDY_SHARE * value_noise(turned);
    direction * (wind.speed + wind.gusts * gust)
}

/// Angle in radians by which the tip of a feather lifts off (below 0: is pressed down), at most `limit` up and a quarter of it down. Wind
/// against the lay (`along`) opens the coat, wind along it presses it flat. `length` in metres, `wind` in m/s; compliance and
/// limit from [`wind_response`].
pub fn wind_lift(
    wind: Vec3,
    along: Vec3,
    normal: Vec3,
    length: f32,
    compliance: f32,
    limit: f32,
) -> f32 {
    let against = along.dot(wind);
    let under = normal.dot(wind);
    let opening = (-against).max(0.0) + under.max(0.0);
    let pressing = against.max(0.0) + (-under).max(0.0);
    let drive =
        compliance * length.max(0.0).sqrt() * (opening * opening - PRESSING * pressing * pressing);
    let most = if drive < 0.0 {
        FLATTENING * limit
    } else {
        limit
    };
    most * drive / (most + drive.abs()).max(1e-9)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wind_against_the_lay_opens_and_never_past_the_limit() {
        for stiffness in [0.0, 0.3, 0.7, 1.0] {
            let (compliance, limit) = wind_response(stiffness);
            let mut last = 0.0;
            for speed in [0.5, 1.0, 3.0, 10.0, 40.0] {
                let lift = |wind| wind_lift(wind, Vec3::X, Vec3::Z, 0.04, compliance, limit);
                let open = lift(-Vec3::X * speed);
                assert!(open > last && open < limit, "{stiffness} {speed}: {open}");
                let flat = lift(Vec3::X * speed);
                assert!(flat < 0.0 && flat > -FLATTENING * limit, "{flat}");
                last = open;
            }
        }
        // A contour feather of 40 mm in a gust of 3 m/s: a few degrees.
        let (compliance, limit) = wind_response(0.3);
        let lift = wind_lift(-3.0 * Vec3::X, Vec3::X, Vec3::Z, 0.04, compliance, limit);
        assert!((1.0..8.0).contains(&lift.to_degrees()), "{lift}");
    }

    #[test]
    fn gusts_travel_with_the_wind() {
        let wind = Wind::new(Vec3::new(1.0, 0.0, 1.0), 2.0);
        let slow = Wind {
            frequency: 0.0,
            ..wind
        };
        let direction = wind.direction.normalize();
        for step in 0..20 {
            let place = Vec3::new(0.1 * step as f32, 0.2, -0.3);
            let later = wind_velocity(&slow, place + direction * (3.0 * 0.5), 4.5);
            let now = wind_velocity(&slow, place, 4.0);
            assert!((later - now).length() < 1e-3, "{now} {later}");
            let speed = wind_velocity(&wind, place, 4.0).length();
            assert!((2.0..=4.0).contains(&speed), "{speed}");
        }
    }

    #[test]
    fn bad_winds_are_clamped() {
        let wild = Wind {
            direction: Vec3::NAN,
            speed: f32::NAN,
            gusts: f32::INFINITY,
            eddy: -1.0,
            frequency: f32::NAN,
        };
        let rows = wild.rows(3);
        assert!(rows.iter().flatten().all(|x| x.is_finite()), "{rows:?}");
        let ruffle = Ruffle {
            amount: f32::NAN,
            ..default()
        };
        let rows = motion_rows(&wild, Some(&ruffle), None, 4);
        assert_eq!(rows.len(), 6);
        assert!(rows.iter().flatten().all(|x| x.is_finite()), "{rows:?}");
    }
}
