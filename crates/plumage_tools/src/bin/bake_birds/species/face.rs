//! What a face is made of: bill, brow, naked skin, facial disc.

use std::f32::consts::TAU;

use bevy::math::{Vec2, Vec3};

/// A slice through one half of a bill: place (z, y) of its upper and of its lower edge in the middle plane, and its width; mm.
pub type Slice = [f32; 5];

/// Both halves of a bill, mm.
#[derive(Clone, Copy, Debug)]
pub struct Bill {
    /// Middle of the upper half's base (y, z), from which the plumage of the head lies away.
    pub upper_at: [f32; 2],
    /// Upper half, base to tip: the upper edge is the ridge (culmen), the lower one cuts (tomium).
    pub upper: &'static [Slice],
    /// Lower half, base to tip.
    pub lower: &'static [Slice],
    /// Share of the width that the ridge lacks.
    pub ridge: f32,
    /// Colors of base, tip, lower jaw and cere.
    pub colors: [u32; 4],
    /// Share of the length at which the base's color begins to give way to the tip's, and over which it does.
    pub dark: [f32; 2],
    /// Share of the upper half's length that a cere covers, and of the lower half's that its skin does.
    pub cere: [f32; 2],
    /// A black wedge along the cutting edge: share of the height at the base, share of the length at which it ends.
    pub wedge: [f32; 2],
    /// Place of the nostril: share of the length, angle from the ridge in degrees; its half length and half height, mm.
    pub nostril: [f32; 4],
    /// Growth rings on the upper half, and their height, mm.
    pub rings: [f32; 2],
    /// Fleshy rim of the gape on the left, points from the bill backwards; empty without one.
    pub gape: &'static [[f32; 3]],
    /// Half width and half height of that rim, mm.
    pub gape_size: [f32; 2],
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

/// A patch with rounded corners, seen from the side.
#[derive(Clone, Copy, Debug)]
pub struct Patch {
    /// Corners (z, y) of a convex outline, mm, from the bill's top over the eye backwards and down.
    pub corners: &'static [[f32; 2]],
    /// By how much the patch reaches beyond them: the radius of its corners, mm.
    pub radius: f32,
}

impl Patch {
    /// Distance of a point (z, y) from the patch, negative inside it.
    pub fn distance(&self, z: f32, y: f32) -> f32 {
        let p = Vec2::new(z, y);
        let corners = self.corners.iter().map(|c| Vec2::from_array(*c));
        let next = corners.clone().cycle().skip(1);
        let (mut nearest, mut beyond) = (f32::MAX, f32::MIN);
        for (a, b) in corners.zip(next) {
            let side = b - a;
            let t = ((p - a).dot(side) / side.length_squared()).clamp(0.0, 1.0);
            nearest = nearest.min(p.distance(a + side * t));
            beyond = beyond.max((p - a).perp_dot(side) / side.length());
        }
        (if beyond > 0.0 { nearest } else { -nearest }) - self.radius
    }
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

/// The sheet of naked skin over the face, which carries its texture.
#[derive(Clone, Copy, Debug)]
pub struct Naked {
    /// z of a vertical axis within the head, from which the face is seen in all directions, mm.
    pub axis: f32,
    /// How far the sheet reaches round from straight ahead, degrees.
    pub turn: f32,
    /// Its upper and lower end, y in mm.
    pub height: [f32; 2],
    /// How far it reaches under the feathers round it, mm.
    pub fringe: f32,
    /// Width of its wrinkles, mm.
    pub wrinkle: f32,
    /// Color of its folds.
    pub blush: u32,
    /// How far from the rim short feathers begin, mm.
    pub edge: f32,
    /// Color of these.
    pub coat: u32,
    /// Lines of tiny feathers round the eye.
    pub lines: Option<FaceLines>,
}

/// Lines of tiny feathers on naked skin.
#[derive(Clone, Copy, Debug)]
pub struct FaceLines {
    /// Distance of the first from the eye's centre, mm.
    pub first: f32,
    /// Distance from one to the next, mm.
    pub pitch: f32,
    /// Their color.
    pub color: u32,
}

impl FaceLines {
    /// How many lines there are.
    pub const COUNT: f32 = 5.0;

    /// Number of the line at (z, y) from the eye's centre, 0 at the first: ovals, flatter than circles.
    pub fn line(&self, z: f32, y: f32) -> f32 {
        ((0.8 * z).hypot(1.05 * y) - self.first) / self.pitch
    }
}

/// A ledge of skin and bone above the eye, which shades it.
#[derive(Clone, Copy, Debug)]
pub struct Ledge {
    /// Front end, middle, hind end, from the eye's centre, mm.
    pub path: [[f32; 3]; 3],
    /// Half width outwards and half thickness, mm.
    pub half: [f32; 2],
    /// How far it falls per mm outwards.
    pub droop: f32,
    /// Its color.
    pub color: u32,
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
