//! Strokes on the bird: guides drawn and moved, density and length painted.

use super::{
    draw::{Inspector, Tab},
    panels::Tool,
    pick::{Pointer, Posed},
    skin::{Hit, Vertices, cast},
};
use crate::groom::{Dab, Groom, Guide, Plumage, PlumageCards, PlumageOutput};
use bevy::prelude::*;

/// Points closer than this share of the stroke's length are left out.
const SPACING: f32 = 0.02;

/// A stroke under way, in the groom's units and model space.
#[derive(Default)]
pub(super) struct Stroke {
    points: Vec<Vec3>,
    /// Guide and point being moved.
    moved: Option<(usize, usize)>,
    gesture: u64,
}

/// Guide and point of a groom nearest to `place` within `reach`, all in the groom's units.
pub fn nearest_guide_point(groom: &Groom, place: Vec3, reach: f32) -> Option<(usize, usize)> {
    let mut best = None;
    for (g, guide) in groom.guides.iter().enumerate() {
        for (p, point) in guide.points.iter().enumerate() {
            let distance = Vec3::from_array(*point).distance(place);
            if distance <= reach && best.is_none_or(|(_, least)| distance < least) {
                best = Some(((g, p), distance));
            }
        }
    }
    best.map(|(at, _)| at)
}

/// A guide through the points of a stroke, thinned to what bends it; `None` for a stroke without length.
pub fn guide_through(points: &[Vec3], mirror: bool) -> Option<Guide> {
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
        mirror,
        regions: Vec::new(),
    })
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

/// The place on the skin under the pointer, in the groom's units, and where it is in the world.
fn place_on_skin(
    ray: Ray3d,
    posed: &Posed,
    mesh: &Mesh3d,
    entity: Entity,
    unit: f32,
) -> Option<Vec3> {
    let mesh = posed.meshes.get(mesh)?;
    let hit: Hit = cast(ray, mesh, &posed.pose(entity)?)?;
    let vertices = Vertices::of(mesh)?;
    Some(hit.blend(|i| vertices.bind(i)) / unit.max(1e-9))
}

/// Follows a drag on the bird with the tool chosen.
pub(super) fn stroke_by_mouse(
    mut inspector: ResMut<Inspector>,
    pointer: Pointer,
    posed: Posed,
    buttons: Option<Res<ButtonInput<MouseButton>>>,
    mut stroke: Local<Stroke>,
    birds: Query<(&Plumage, &PlumageOutput)>,
    parents: Query<&ChildOf, With<PlumageCards>>,
    skins: Query<&Mesh3d, Without<PlumageCards>>,
    grooms: Res<Assets<Groom>>,
) {
    let tool = inspector.groom_panel.tool;
    if !inspector.open || inspector.tab != Tab::Groom || tool == Tool::Pick {
        return;
    }
    let Some(buttons) = buttons else {
        return;
    };
    let Some((plumage, output)) = inspector.bird.and_then(|bird| birds.get(bird).ok()) else {
        return;
    };
    let id = plumage.groom.id();
    let Some(unit) = grooms.get(id).map(|groom| groom.unit) else {
        return;
    };
    let place = || {
        let skin = parents.get(output.0).ok()?.parent();
        place_on_skin(pointer.ray()?, &posed, skins.get(skin).ok()?, skin, unit)
    };
    if buttons.just_pressed(MouseButton::Left) {
        *stroke = Stroke {
            gesture: inspector.next_gesture(),
            ..Stroke::default()
        };
        if tool == Tool::Move
            && let (Some(place), Some(document)) = (place(), inspector.grooms.get(id))
        {
            let reach = inspector.groom_panel.radius;
            stroke.moved = nearest_guide_point(document.present(), place, reach);
        }
    }
    if buttons.pressed(MouseButton::Left)
        && let Some(place) = place()
    {
        stroke.points.push(place);
        apply(&mut inspector, id, tool, &stroke, place);
    }
    if buttons.just_released(MouseButton::Left) {
        if tool == Tool::Draw
            && let Some(guide) = guide_through(&stroke.points, inspector.groom_panel.mirror)
            && let Some(mut groom) = inspector.grooms.get(id).map(|d| d.present().clone())
        {
            groom.guides.push(guide);
            inspector.grooms.edit(id, groom, stroke.gesture);
        }
        *stroke = Stroke::default();
    }
}

/// What the tool does at a place while the button is down.
fn apply(inspector: &mut Inspector, id: AssetId<Groom>, tool: Tool, stroke: &Stroke, place: Vec3) {
    let Some(mut groom) = inspector.grooms.get(id).map(|d| d.present().clone()) else {
        return;
    };
    let (radius, factor) = (inspector.groom_panel.radius, inspector.groom_panel.factor);
    let dab = |density, length| Dab {
        at: place.to_array(),
        radius,
        density,
        length,
    };
    match (tool, stroke.moved) {
        (Tool::Density, _) => paint(&mut groom, dab(factor, 1.0)),
        (Tool::Length, _) => paint(&mut groom, dab(1.0, factor.max(0.05))),
        (Tool::Move, Some((guide, point))) => {
            if let Some(point) = groom
                .guides
                .get_mut(guide)
                .and_then(|guide| guide.points.get_mut(point))
            {
                *point = place.to_array();
            }
        }
        _ => return,
    }
    inspector.grooms.edit(id, groom, stroke.gesture);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stroke_becomes_a_guide() {
        let points: Vec<Vec3> = (0..500).map(|i| Vec3::X * i as f32 * 0.01).collect();
        let guide = guide_through(&points, true).unwrap();
        assert!(guide.points.len() > 10 && guide.points.len() < 60);
        assert!(guide.mirror);
        assert_eq!(guide_through(&[Vec3::ONE; 3], false), None);
        assert_eq!(guide_through(&[Vec3::ONE], false), None);
    }
}
