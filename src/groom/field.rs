//! What is needed to fill one region with follicles: the lay, the place between its ends, its paint.

use super::{
    asset::{Dab, Region, painted},
    skin::{SkinMesh, SurfacePoint},
};
use bevy::math::Vec3;

/// The follicle of one feather.
#[derive(Clone, Copy, Debug)]
pub struct Follicle {
    /// Place on the skin.
    pub at: SurfacePoint,
    /// Its position.
    pub position: Vec3,
    /// Place between the cranial (0) and the caudal (1) end of the region.
    pub phi: f32,
}

/// What is needed to fill one region.
pub struct Field<'a> {
    /// The skin.
    pub skin: &'a SkinMesh,
    /// Lay at the nodes.
    pub lay: &'a [Vec3],
    /// Arc length at the nodes, where the skin has no phi.
    pub arc: &'a [f32],
    /// Triangles of the region.
    pub triangles: &'a [u32],
    /// Whether a triangle is the region's.
    pub mask: &'a [bool],
    range: (f32, f32),
    paint: &'a [Dab],
    unit: f32,
}

/// Least and largest factor that paint leaves on the number of feathers.
const PAINTED: (f32, f32) = (0.02, 4.0);
/// Density of a mask below which no feather grows.
const LEAST: f32 = 0.01;

impl<'a> Field<'a> {
    /// Prepares a region; finds the range of phi on it.
    pub fn new(
        skin: &'a SkinMesh,
        lay: &'a [Vec3],
        arc: &'a [f32],
        triangles: &'a [u32],
        mask: &'a [bool],
    ) -> Self {
        let mut field = Self {
            skin,
            lay,
            arc,
            triangles,
            mask,
            range: (0.0, 1.0),
            paint: &[],
            unit: 1.0,
        };
        let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
        for &triangle in triangles {
            for bary in [Vec3::X, Vec3::Y, Vec3::Z] {
                let value = field.raw(SurfacePoint { triangle, bary });
                (low, high) = (low.min(value), high.max(value));
            }
        }
        if high > low {
            field.range = (low, high);
        }
        field
    }

    /// With touches of a brush, in units of `unit` metres.
    pub fn painted(self, paint: &'a [Dab], unit: f32) -> Self {
        Self {
            paint,
            unit,
            ..self
        }
    }

    /// Factor of paint and masks on the number of feathers at a follicle.
    fn density(&self, follicle: &Follicle) -> f32 {
        let own = self.skin.mask_density(follicle.at);
        if self.paint.is_empty() {
            return own;
        }
        let (density, _) = painted(self.paint, (follicle.position / self.unit).to_array());
        own * density.clamp(PAINTED.0, PAINTED.1)
    }

    /// Whether a mask wants feathers at a point at all.
    pub(super) fn wants(&self, at: SurfacePoint) -> bool {
        self.skin.mask_density(at) > LEAST
    }

    /// Whether anything changes the number of feathers.
    fn is_uneven(&self) -> bool {
        !self.paint.is_empty() || self.skin.has_density_mask()
    }

    /// Relative spacing of the region's feathers at a follicle.
    pub(super) fn spacing(&self, region: &Region, follicle: &Follicle) -> f32 {
        spacing(region, follicle.phi) / self.density(follicle).max(LEAST).sqrt()
    }

    /// How many times the feathers of an unpainted region the paint asks for.
    pub fn paint_scale(&self, region: &Region) -> f64 {
        if !self.is_uneven() {
            return 1.0;
        }
        let (mut plain, mut asked) = (0.0, 0.0);
        for &triangle in self.triangles {
            let places = self.skin.mask_places(triangle);
            let area = f64::from(self.skin.areas[triangle as usize]) / places.len() as f64;
            for place in places {
                let place = self.follicle(place);
                let weight = area / f64::from(spacing(region, place.phi)).powi(2);
                plain += weight;
                asked += weight * f64::from(self.density(&place));
            }
        }
        if plain > 0.0 { asked / plain } else { 1.0 }
    }

    fn raw(&self, point: SurfacePoint) -> f32 {
        self.skin.phi(point).unwrap_or_else(|| {
            let [a, b, c] = self
                .skin
                .corner_nodes(point.triangle)
                .map(|node| self.arc.get(node).copied().unwrap_or(0.0));
            a * point.bary.x + b * point.bary.y + c * point.bary.z
        })
    }

    /// Phi of a point, 0..1. The skin's own where it has one, else the arc length along the lay, scaled to the region.
    pub fn phi(&self, point: SurfacePoint) -> f32 {
        let value = self.raw(point);
        if self.skin.tract_phi.is_empty() {
            ((value - self.range.0) / (self.range.1 - self.range.0)).clamp(0.0, 1.0)
        } else {
            value
        }
    }

    /// Smallest and largest phi on the region.
    pub fn phi_range(&self) -> (f32, f32) {
        if self.skin.tract_phi.is_empty() {
            (0.0, 1.0)
        } else {
            self.range
        }
    }

    /// The follicle at a point.
    pub fn follicle(&self, at: SurfacePoint) -> Follicle {
        Follicle {
            at,
            position: self.skin.position(at),
            phi: self.phi(at),
        }
    }
}

/// Relative spacing of feathers at phi: the geometric mean of length and width.
fn spacing(region: &Region, phi: f32) -> f32 {
    (region.length.at(phi) * region.width.at(phi))
        .max(0.0)
        .sqrt()
        .max(f32::MIN_POSITIVE)
}
