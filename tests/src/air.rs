//! Wind and ruffle on the vertices of a coat, as the vertex function of the cards applies them.

use bevy::math::{Affine3A, Vec3};
use bevy_plumage::{
    Wind,
    groom::{Card, Groom},
    maths::wind::{
        Breeze, RUFFLE_LIFT, RUFFLE_YAW, turned_by, wind_lift, wind_response, wind_velocity,
    },
};

/// What moves the feathers of a bird apart from its joints.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Air {
    /// As `Ruffle::amount`.
    pub ruffle: f32,
    /// Wind.
    pub wind: Wind,
}

/// The same as it acts on one coat at one time.
pub struct Blown {
    breeze: Breeze<f32>,
    time: f32,
    /// Lift, yaw, compliance and limit of every region and row.
    regions: Vec<[f32; 4]>,
}

impl Air {
    /// Whether nothing moves.
    pub fn is_still(&self) -> bool {
        self.ruffle <= 0.0 && self.wind.speed + self.wind.gusts <= 0.0
    }

    /// At a time, seconds, on the coat of a groom.
    pub fn blown(&self, groom: &Groom, time: f32) -> Blown {
        let regions = groom.regions.iter().map(|region| region.stiffness);
        let rows = groom.rows.iter().map(|_| 1.0);
        let of = |stiffness: f32| {
            let share = self.ruffle.clamp(0.0, 1.0) * (1.0 - stiffness);
            let (compliance, limit) = wind_response(stiffness);
            [RUFFLE_LIFT * share, RUFFLE_YAW * share, compliance, limit]
        };
        Blown {
            breeze: self.wind.breeze(),
            time,
            regions: regions.chain(rows).map(of).collect(),
        }
    }
}

impl Blown {
    /// Where a vertex at share `along` of its card's length goes, in bind pose, and how far its card is turned, radians. `carry`: what
    /// the joints do to it; `held`: how far, 0..1, stiffer feathers hold it down.
    pub fn place(
        &self,
        card: &Card,
        along: f32,
        place: Vec3,
        carry: Affine3A,
        held: f32,
    ) -> (Vec3, f32) {
        let [lift, yaw, compliance, limit] = self.regions[usize::from(card.region)];
        let mut tip = 0.0;
        if self.breeze.speed + self.breeze.gusts > 0.0 {
            let root = carry.transform_point3(card.root).to_array();
            let lay = carry.transform_vector3(card.along);
            let stretch = lay.length().max(1.0e-9);
            tip = wind_lift(
                wind_velocity(&self.breeze, root, self.time),
                (lay / stretch).to_array(),
                carry
                    .transform_vector3(card.normal)
                    .normalize_or_zero()
                    .to_array(),
                stretch * card.length,
                compliance,
                limit,
            );
        }
        let aside = yaw * ((card.seed & 0xffff) as f32 / 32767.5 - 1.0);
        let raising = card.along.cross(card.normal);
        let whole = (raising * lift + card.normal * aside) * (1.0 - held);
        let turn = whole + raising * (0.5 * along * tip);
        let place =
            card.root + Vec3::from(turned_by((place - card.root).to_array(), turn.to_array()));
        (place, (whole + raising * tip).length())
    }
}
