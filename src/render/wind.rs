//! Wind and ruffle as an app sets them, and the buffer of each bird that tells its cards, together with the pose that it wears (the
//! maths: [`crate::maths::wind`]).

use super::{lights::WorldLights, material::FeatherMaterial, pack::MAX_REGIONS};
use crate::{
    groom::{CardRegion, FeathersOf, PlumageCards, Worn},
    maths::wind::{Breeze, RUFFLE_LIFT, RUFFLE_YAW, wind_response},
};
use bevy::{
    asset::RenderAssetUsages,
    prelude::*,
    render::{render_resource::BufferUsages, storage::ShaderBuffer},
};

/// The air over the whole world; still by default. How far it lifts a card is found once a frame, so cards bend alike in every pass.
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

    /// The same with a direction of length 1 and every number finite and in its range, as the shaders take it.
    pub fn breeze(&self) -> Breeze<f32> {
        let finite = |x: f32, low: f32, high: f32| {
            if x.is_finite() {
                x.clamp(low, high)
            } else {
                low
            }
        };
        let direction = self.direction.try_normalize().unwrap_or(Vec3::X);
        Breeze {
            direction: direction.to_array(),
            speed: finite(self.speed, 0.0, 40.0),
            gusts: finite(self.gusts, 0.0, 40.0),
            eddy: finite(self.eddy, 0.01, 10.0),
            frequency: finite(self.frequency, 0.0, 10.0),
        }
    }

    fn rows(&self, regions: usize) -> [[f32; 4]; 2] {
        let breeze = self.breeze();
        let [x, y, z] = breeze.direction;
        [
            [x, y, z, breeze.speed],
            [breeze.gusts, breeze.eddy, breeze.frequency, regions as f32],
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

impl Ruffle {
    /// Share, 0..1, by which the feathers of a region are raised: all of it only for feathers of no stiffness.
    pub(crate) fn share(&self, region: &CardRegion) -> f32 {
        let named = self.regions.iter().find(|(name, _)| *name == region.name);
        let amount = named.map_or(self.amount, |(_, amount)| *amount);
        if amount.is_finite() {
            amount.clamp(0.0, 1.0) * (1.0 - region.stiffness())
        } else {
            0.0
        }
    }
}

/// First rows of the table, after those of the wind.
pub(super) mod motion {
    use super::super::lights::VERTEX_LIGHTS;

    /// Shares of the poses after the first; and what a unit of height is, metres, how far the bird is on the way between poses.
    pub const WORN: usize = 2;
    /// Lights.
    pub const LIGHTS: usize = WORN + 2;
    /// Regions.
    pub const REGIONS: usize = LIGHTS + VERTEX_LIGHTS;
}

/// A bird in the first pose.
const STILL: [[f32; 4]; 2] = [[0.0; 4]; 2];

fn worn_rows(worn: &Worn) -> [[f32; 4]; 2] {
    let [_, further @ ..] = worn.wear.shares;
    [further, [worn.poses.reach, worn.wear.between, 0.0, 0.0]]
}

/// Rows of one bird: wind, the poses that it wears, lights, then (lift, compliance, limit, yaw) of every region.
fn motion_rows(
    wind: &Wind,
    worn: [[f32; 4]; 2],
    lights: &WorldLights,
    ruffle: Option<&Ruffle>,
    regions: &[CardRegion],
) -> Vec<[f32; 4]> {
    let row = |region: &CardRegion| {
        let (compliance, limit) = wind_response(region.stiffness());
        let share = ruffle.map_or(0.0, |ruffle| ruffle.share(region));
        [RUFFLE_LIFT * share, compliance, limit, RUFFLE_YAW * share]
    };
    let regions = &regions[..regions.len().min(MAX_REGIONS as usize)];
    let mut rows = wind.rows(regions.len().max(1)).to_vec();
    rows.extend(worn);
    rows.extend(lights.rows().map(|row| row.to_array()));
    rows.extend(regions.iter().map(row));
    if regions.is_empty() {
        rows.push(row(&CardRegion {
            name: String::new(),
            stiffness: 0.5,
        }));
    }
    rows
}

/// The buffer of a bird in still air.
pub(super) fn still_motion(cards: &PlumageCards) -> ShaderBuffer {
    let rows = motion_rows(
        &Wind::default(),
        STILL,
        &WorldLights::default(),
        None,
        &cards.regions,
    );
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
    /// Whether the air moved in the frame before.
    blew: bool,
    /// Whether the bird had a [`Ruffle`].
    ruffled: bool,
    /// Whether the frame before was like this one.
    settled: bool,
}

impl Motion {
    /// Whether the air moves.
    fn blows(&self) -> bool {
        self.now[0][3] + self.now[1][0] > 0.0
    }

    /// Whether cards are lifted, or were in the frame before.
    pub(super) fn lifts(&self) -> bool {
        self.blows() || self.blew
    }

    /// Heights of the worn pose, where neither wind nor ruffle move a feather.
    pub(super) fn still(&self) -> Option<Vec4> {
        let flat = |row: &[f32; 4]| row[0] == 0.0 && row[3] == 0.0;
        let still = !self.blows() && self.now[motion::REGIONS..].iter().all(flat);
        let [shares, unit] = [0, 1].map(|row| self.now[motion::WORN + row]);
        still.then(|| Vec4::from_array(shares) * unit[0])
    }
}

/// Writes a bird's buffer when its wind, ruffle, lights or worn pose have changed, and once more a frame later, when the change is the past. The
/// bind group stays.
pub(super) fn move_feathers(
    mut commands: Commands,
    wind: Res<Wind>,
    lights: Res<WorldLights>,
    ruffles: Query<Ref<Ruffle>>,
    mut birds: Query<(
        Entity,
        Ref<PlumageCards>,
        Option<&FeathersOf>,
        Ref<MeshMaterial3d<FeatherMaterial>>,
        Option<Ref<Worn>>,
        Option<&mut Motion>,
    )>,
    materials: Res<Assets<FeatherMaterial>>,
    mut buffers: ResMut<Assets<ShaderBuffer>>,
) {
    for (entity, cards, of, material, worn, motion) in &mut birds {
        let ruffle = ruffles.get(FeathersOf::owner(of, entity)).ok();
        let moved = wind.is_changed()
            || lights.is_changed()
            || cards.is_changed()
            || material.is_changed()
            || worn.as_ref().is_some_and(Ref::is_changed)
            || ruffle.as_ref().is_some_and(Ref::is_changed);
        let rests = |motion: &Mut<Motion>| motion.settled && motion.ruffled == ruffle.is_some();
        if !moved && motion.as_ref().is_some_and(rests) {
            continue;
        }
        let Some(material) = materials.get(material.id()) else {
            continue;
        };
        let worn = worn.map_or(STILL, |worn| worn_rows(&worn));
        let now = motion_rows(&wind, worn, &lights, ruffle.as_deref(), &cards.regions);
        let ruffled = ruffle.is_some();
        let buffer = material.motion.id();
        let mut known = motion.filter(|motion| motion.buffer == buffer);
        if let Some(motion) = &mut known
            && motion.settled
            && motion.now == now
        {
            motion.ruffled = ruffled;
            continue;
        }
        let before = known.as_ref().map_or(&now, |motion| &motion.now);
        if let Some(mut asset) = buffers.get_mut(buffer) {
            asset.data = Some(bytes(&now, before));
        }
        match known {
            Some(mut motion) => {
                motion.settled = motion.now == now;
                motion.blew = motion.blows();
                motion.now = now;
                motion.ruffled = ruffled;
            }
            None => {
                commands.entity(entity).insert(Motion {
                    buffer,
                    now,
                    blew: false,
                    ruffled,
                    settled: true,
                });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::wind::wind_velocity;

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
            let air = |wind: &Wind, place: Vec3, time: f32| {
                Vec3::from(wind_velocity(&wind.breeze(), place.to_array(), time))
            };
            let later = air(&slow, place + direction * (3.0 * 0.5), 4.5);
            let now = air(&slow, place, 4.0);
            assert!((later - now).length() < 1e-3, "{now} {later}");
            let speed = air(&wind, place, 4.0).length();
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
        let region = CardRegion {
            name: String::new(),
            stiffness: f32::NAN,
        };
        let rows = motion_rows(
            &wild,
            STILL,
            &WorldLights::default(),
            Some(&ruffle),
            &vec![region; 4],
        );
        assert_eq!(rows.len(), 10);
        assert!(rows.iter().flatten().all(|x| x.is_finite()), "{rows:?}");
    }
}
