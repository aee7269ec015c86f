//! What a face is made of: bill, brow, naked skin, facial disc.

use std::f32::consts::TAU;

use bevy::math::{Vec2, Vec3};

/// Both halves of a bill, mm.
#[derive(Clone, Copy, Debug)]
pub struct Bill {
    /// Upper: centre of its base (y, z).
    pub upper_at: [f32; 2],
    /// Upper: base height and width.
    pub upper_base: [f32; 2],
    /// Upper: height and width at the tip.
    pub upper_tip: [f32; 2],
    /// Upper: start direction below horizontal, degrees; straight length; arc radius; turn in degrees; taper exponent.
    pub upper_curve: [f32; 5],
    /// Lower: centre of its base (y, z).
    pub lower_at: [f32; 2],
    /// Lower: base height and width, length.
    pub lower_base: [f32; 3],
    /// Lower: linear and quadratic drop of the axis over its length.
    pub lower_axis: [f32; 2],
    /// Colors of base, tip, lower jaw and cere.
    pub colors: [u32; 4],
    /// Share of the length at which the base's color begins to give way to the tip's, and over which it does.
    pub dark: [f32; 2],
    /// A cere covers the straight part and the base of the lower jaw.
    pub cere: bool,
    /// A black wedge runs from the gape along the lower edge.
    pub wedge: bool,
    /// Place of the nostril: share of the length, cosine from the ridge.
    pub nostril: [f32; 2],
    /// Lower: shares of height and width lost towards the tip.
    pub lower_taper: [f32; 2],
    /// Fleshy rim of the gape on the left, points from the bill backwards; empty without one.
    pub gape: &'static [[f32; 3]],
}

/// A ridge above the eye: a cone beside the eye's centre, mm.
#[derive(Clone, Copy, Debug)]
pub struct Brow {
    /// Front end, from the eye's centre.
    pub from: [f32; 3],
    /// Hind end, from the eye's centre.
    pub to: [f32; 3],
    /// Radii at both ends.
    pub radii: [f32; 2],
    /// Smooth-union radius.
    pub blend: f32,
}

/// Naked skin of the face, seen from the side.
#[derive(Clone, Copy, Debug)]
pub enum BareFace {
    /// None.
    Feathered,
    /// From the bill to behind the eye.
    Patch(Patch),
    /// Round the base of the bill.
    Cere(Cere),
}

/// A rectangle with rounded corners in (z, y), mm.
#[derive(Clone, Copy, Debug)]
pub struct Rounded {
    /// Centre (z, y).
    pub at: [f32; 2],
    /// Half width and height.
    pub half: [f32; 2],
    /// Radius of the corners.
    pub radius: f32,
}

/// A rounded patch round the eye, joined to a rim round the bill.
#[derive(Clone, Copy, Debug)]
pub struct Patch {
    /// The patch.
    pub patch: Rounded,
    /// How far it leans forward per mm below a height, and that height.
    pub slant: [f32; 2],
    /// How far it sinks per mm before a z, and that z.
    pub droop: [f32; 2],
    /// The rim.
    pub rim: Rounded,
    /// Smooth-union radius of both.
    pub blend: f32,
}

/// A disc round the base of the bill.
#[derive(Clone, Copy, Debug)]
pub struct Cere {
    /// Centre (z, y).
    pub at: [f32; 2],
    /// Radius in the middle plane.
    pub radius: f32,
    /// Radius lost per square of the distance from the middle plane, 1/mm.
    pub taper: f32,
    /// It begins at this z.
    pub ahead: f32,
}

/// Naked rim of the eye.
#[derive(Clone, Copy, Debug)]
pub enum EyeRim {
    /// Naked skin within so many radii of the eye.
    OnBareSkin(f32),
    /// All skin within so many radii of the eye.
    Round(f32),
    /// An ellipse seen from the side.
    Oval {
        /// Half height and half length, mm.
        half: [f32; 2],
        /// How far its centre lies before the eye's, mm.
        ahead: f32,
        /// It lies beyond this x, mm.
        beyond: f32,
    },
}

/// Skin between eye and bill that carries bristles, relative to the eye's centre, mm.
#[derive(Clone, Copy, Debug)]
pub struct LoreArea {
    /// It begins so far before the eye.
    pub ahead: f32,
    /// It ends so far below it.
    pub low: f32,
    /// It ends so far above it.
    pub high: f32,
    /// It lies beyond this x.
    pub beyond: f32,
}

/// Facial disc: one lobe round each eye, whose feathers point away from the lobe's centre, and the ruff that bounds it. Distances
/// run over the face and, where it turns back, over the side of the head; mm.
#[derive(Clone, Copy, Debug)]
pub struct Disc {
    /// Centre of the left lobe.
    pub centre: [f32; 3],
    /// Reach upwards, sideways, downwards.
    pub reach: [f32; 3],
    /// Share of the reach upwards that is lost at the middle line: the notch of the heart.
    pub notch: f32,
    /// Width of the ruff as a share of the reach.
    pub ruff: f32,
}

impl Disc {
    /// Distance from the lobe's centre over the reach there; 1 where the ruff begins. `q.x` is not negative.
    pub fn share(&self, q: Vec3) -> f32 {
        let [up, side, down] = self.reach;
        let [x, y, z] = self.centre;
        let height = q.y - y;
        // Below, both lobes run together to a point: the heart.
        let low = (-height / down).clamp(0.0, 1.0);
        let at = Vec2::new(q.x - x * (1.0 - low), height);
        let along = at.normalize_or(Vec2::X);
        let inward = (1.0 - q.x / x).max(0.0);
        let tall = if height > 0.0 {
            up * (1.0 - self.notch * inward * inward)
        } else {
            down
        };
        let reach = (along.x / side).hypot(along.y / tall).recip();
        (at.length() + (z - q.z).max(0.0)) / reach
    }

    /// Direction of the lay at a point: away from the lobe's centre; along the middle line, where both lobes meet, away from the bill.
    pub fn lay(&self, p: Vec3) -> Vec3 {
        let [x, y, z] = self.centre;
        let away = (Vec3::new(p.x.abs(), p.y, p.z) - Vec3::new(x, y, z)).normalize_or(Vec3::Y);
        let middle = Vec3::Y * if p.y > y - 0.4 * x { 1.0 } else { -1.0 };
        let lay = middle.lerp(away, (p.x.abs() / (0.6 * x)).min(1.0));
        Vec3::new(lay.x * if p.x < 0.0 { -1.0 } else { 1.0 }, lay.y, lay.z)
    }

    /// Points before the left lobe and its ruff, in rings.
    pub fn points(&self) -> impl Iterator<Item = Vec3> {
        const RINGS: [(f32, u32); 5] = [(0.35, 8), (0.55, 12), (0.75, 16), (0.95, 20), (1.15, 24)];
        let [up, side, down] = self.reach;
        let [x, y, z] = self.centre;
        RINGS.into_iter().flat_map(move |(share, count)| {
            (0..count).filter_map(move |i| {
                let (sine, cosine) = (TAU * (i as f32 + 0.5) / count as f32).sin_cos();
                let tall = if sine > 0.0 { up } else { down };
                let p = Vec3::new(x + share * side * cosine, y + share * tall * sine, z);
                (p.x > 0.15 * x).then_some(p)
            })
        })
    }
}
