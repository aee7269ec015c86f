//! Strokes on the bird: guides drawn and moved, density and length painted.

use super::{
    mirror::MirrorPlane,
    pick::Posed,
    skin::{Hit, Vertices, cast},
};
use crate::groom::{Dab, Groom, Guide};
use bevy::prelude::*;

/// Points closer than this share of the stroke's length are left out.
const SPACING: f32 = 0.02;
/// How far from each other two points may be that are each other's mirror image, in sizes of the bird.
pub(super) const SAME: f32 = 0.004;

/// A stroke under way, in the groom's units and model space.
#[derive(Default)]
pub(super) struct Stroke {
    /// The points so far.
    pub(super) points: Vec<Vec3>,
    /// What is being moved.
    pub(super) moved: Option<Grab>,
    /// The mirror plane, and the distance at which points count as each other's image.
    pub(super) mirror: Option<(MirrorPlane, f32)>,
    pub(super) gesture: u64,
}

/// A point of a guide.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grab {
    /// Index of the guide.
    pub guide: usize,
    /// Index of its point.
    pub point: usize,
    /// The point's mirror image (x negated) is meant, on the other side of a bird whose guide has the `mirror` flag.
    pub image: bool,
}

/// The point of a groom's guides, or its mirror image, nearest to `place` within `reach`, all in the groom's units.
pub fn nearest_guide_point(groom: &Groom, place: Vec3, reach: f32) -> Option<Grab> {
    let mut best: Option<(Grab, f32)> = None;
    for (g, guide) in groom.guides.iter().enumerate() {
        for (p, point) in guide.points.iter().enumerate() {
            let at = Vec3::from_array(*point);
            let sides: &[bool] = if guide.mirror {
                &[false, true]
            } else {
                &[false]
            };
            for &image in sides {
                let side = if image {
                    MirrorPlane::MODEL.image(at)
                } else {
                    at
                };
                let distance = side.distance(place);
                if distance <= reach && best.is_none_or(|(_, least)| distance < least) {
                    let grab = Grab {
                        guide: g,
                        point: p,
                        image,
                    };
                    best = Some((grab, distance));
                }
            }
        }
    }
    best.map(|(at, _)| at)
}

/// A guide through the points of a stroke, thinned to what bends it; `None` for a stroke without length.
pub fn guide_through(points: &[Vec3]) -> Option<Guide> {
    let length: f32 = points.windows(2).map(|w| w[0].distance(w[1])).sum();
    if length.is_nan() || length <= 0.0 {
        return None;
    }
    let mut kept = vec![points[0]];
    for point in &points[1..] {
        if kept
            .last()
            .is_none_or(|last| last.distance(*point) >= SPACING * length)
        {
            kept.push(*point);
        }
    }
    if kept.len() < 2 {
        return None;
    }
    Some(Guide {
        points: kept.iter().map(Vec3::to_array).collect(),
        mirror: false,
        regions: Vec::new(),
    })
}

/// Adds a guide, and with a mirror plane its mirror image: by the flag where the plane is that of the flag (x = 0 to within
/// `tolerance` at the guide), else as a guide of its own. All in the groom's units.
pub fn add_guide(groom: &mut Groom, mut guide: Guide, mirror: Option<(MirrorPlane, f32)>) {
    let Some((plane, tolerance)) = mirror else {
        groom.guides.push(guide);
        return;
    };
    let reach = guide
        .points
        .iter()
        .map(|point| Vec3::from_array(*point).length())
        .fold(0.0, f32::max);
    guide.mirror = plane.is_model(reach, tolerance);
    let image = Guide {
        points: guide
            .points
            .iter()
            .map(|point| plane.image(Vec3::from_array(*point)).to_array())
            .collect(),
        ..guide.clone()
    };
    let flagged = guide.mirror;
    groom.guides.push(guide);
    if !flagged {
        groom.guides.push(image);
    }
}

/// Moves a point of a guide; with a mirror plane also the same point of the guide that is its mirror image, if there is one.
pub fn move_point(groom: &mut Groom, grab: Grab, place: Vec3, mirror: Option<(MirrorPlane, f32)>) {
    let place = if grab.image {
        MirrorPlane::MODEL.image(place)
    } else {
        place
    };
    let Some(guide) = groom.guides.get(grab.guide) else {
        return;
    };
    let partner = mirror
        .filter(|_| !guide.mirror)
        .and_then(|(plane, tolerance)| {
            let is_image = |other: &Guide| {
                other.points.len() == guide.points.len()
                    && other.points.iter().zip(&guide.points).all(|(a, b)| {
                        let image = plane.image(Vec3::from_array(*b));
                        image.distance(Vec3::from_array(*a)) <= tolerance
                    })
            };
            let found = groom.guides.iter().position(is_image)?;
            Some((found, plane.image(place))).filter(|_| found != grab.guide)
        });
    for (guide, place) in [(grab.guide, place)].into_iter().chain(partner) {
        if let Some(point) = groom
            .guides
            .get_mut(guide)
            .and_then(|guide| guide.points.get_mut(grab.point))
        {
            *point = place.to_array();
        }
    }
}

/// Paints: a dab on top of one that lies within a quarter of its radius replaces it.
pub fn paint(groom: &mut Groom, dab: Dab) {
    let place = Vec3::from_array(dab.at);
    groom.paint.retain(|old| {
        let same = (old.density == 1.0) == (dab.density == 1.0);
        !same || Vec3::from_array(old.at).distance(place) > 0.25 * dab.radius
    });
    groom.paint.push(dab);
}

/// The place on the skin under the pointer in bind pose, metres, and where it is in the world.
pub(super) fn place_on_skin(
    ray: Ray3d,
    posed: &Posed,
    mesh: &Mesh3d,
    entity: Entity,
) -> Option<(Vec3, Vec3)> {
    let mesh = posed.meshes.get(mesh)?;
    let hit: Hit = cast(ray, mesh, &posed.pose(entity)?)?;
    let vertices = Vertices::of(mesh)?;
    Some((hit.blend(|i| vertices.bind(i)), ray.get_point(hit.distance)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stroke_becomes_a_guide() {
        let points: Vec<Vec3> = (0..500).map(|i| Vec3::X * i as f32 * 0.01).collect();
        let guide = guide_through(&points).unwrap();
        assert!(guide.points.len() > 10 && guide.points.len() < 60);
        assert_eq!(guide_through(&[Vec3::ONE; 3]), None);
        assert_eq!(guide_through(&[Vec3::ONE]), None);
    }
}
