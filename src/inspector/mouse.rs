//! What the mouse does on a bird: clicks pick, drags follow the tool chosen.

use super::{
    mirror::MirrorPlane,
    panels::Tool,
    pick::{Picked, Pointer, Posed, describe, pick_card},
    skin::Vertices,
    state::Inspector,
    stroke::{
        SAME, Stroke, add_guide, guide_through, move_point, nearest_guide_point, paint,
        place_on_skin,
    },
};
use crate::{
    anatomy::Feather,
    groom::{Dab, FeathersOf, Groom, Plumage, PlumageCards, PlumageParts},
    render::FeatherMaterial,
};
use bevy::{
    platform::collections::HashMap,
    prelude::*,
    tasks::{AsyncComputeTaskPool, Task, TaskPool, block_on},
};

/// A click without a drag picks, unless a tool takes it.
pub(super) fn pick_by_mouse(
    mut inspector: ResMut<Inspector>,
    pointer: Pointer,
    posed: Posed,
    buttons: Option<Res<ButtonInput<MouseButton>>>,
    mut pressed_at: Local<Option<Ray3d>>,
    birds: Query<
        (Entity, &PlumageCards, &FeathersOf, &Mesh3d),
        With<MeshMaterial3d<FeatherMaterial>>,
    >,
    feathers: Res<Assets<Feather>>,
    grooms: Res<Assets<Groom>>,
) {
    let Some(buttons) = buttons.filter(|_| inspector.open && !inspector.takes_drags()) else {
        return;
    };
    if buttons.just_pressed(MouseButton::Left) {
        *pressed_at = pointer.ray();
    }
    if !buttons.just_released(MouseButton::Left) {
        return;
    }
    let Some((ray, start)) = pointer.ray().zip(pressed_at.take()) else {
        return;
    };
    if ray.direction.dot(*start.direction) < 0.99999 {
        // A drag turned the camera.
        return;
    }
    let mut nearest: Option<(f32, Picked)> = None;
    for (entity, worn, of, mesh) in &birds {
        let (Some(mesh), Some(pose)) = (posed.meshes.get(mesh), posed.pose(entity)) else {
            continue;
        };
        let assets: Vec<_> = worn.all_feathers().map(|f| feathers.get(f)).collect();
        let Some((card, uv, distance)) = pick_card(ray, worn, mesh, &pose, &assets) else {
            continue;
        };
        let record = &worn.cards[card];
        let Some(feather) = worn.feather_of(record) else {
            continue;
        };
        if nearest.as_ref().is_none_or(|(d, _)| distance < *d) {
            let name = feathers
                .get(feather)
                .map_or_else(String::new, |feather| feather.name.clone());
            let text = describe(record, card, grooms.get(&worn.groom), &name);
            let picked = Picked {
                bird: of.0,
                card,
                uv,
                feather: feather.id(),
                text,
            };
            nearest = Some((distance, picked));
        }
    }
    if let Some((_, picked)) = nearest {
        // The groom panel shows where it grows.
        let groom = birds
            .iter()
            .find(|(_, _, of, _)| of.0 == picked.bird)
            .and_then(|(_, worn, _, _)| {
                let region = usize::from(worn.cards.get(picked.card)?.region);
                Some((region, grooms.get(&worn.groom)?.regions.len()))
            });
        if let Some((region, regions)) = groom {
            match region.checked_sub(regions) {
                Some(row) => inspector.groom_panel.row = row,
                None => inspector.groom_panel.region = region,
            }
        }
        inspector.choose(picked);
    } else {
        inspector.picked = None;
    }
}

/// Mirror planes of meshes in metres with the size of the mesh, found in the background.
#[derive(Default)]
pub(super) struct Planes {
    found: HashMap<AssetId<Mesh>, Option<(MirrorPlane, f32)>>,
    search: Option<(AssetId<Mesh>, Task<Option<(MirrorPlane, f32)>>)>,
}

impl Planes {
    /// Begins to look for the plane of a mesh.
    fn look_for(&mut self, id: AssetId<Mesh>, mesh: &Mesh) {
        let under_way = self.search.as_ref().is_some_and(|(of, _)| *of == id);
        if under_way || self.found.contains_key(&id) {
            return;
        }
        let points: Vec<Vec3> = Vertices::of(mesh)
            .map(|vertices| vertices.positions().iter().map(|p| (*p).into()).collect())
            .unwrap_or_default();
        let pool = AsyncComputeTaskPool::get_or_init(TaskPool::new);
        let task = pool.spawn(async move {
            let plane = MirrorPlane::find(&points)?;
            let size = points.iter().fold(0.0_f32, |size, p| size.max(p.length()));
            Some((plane, size))
        });
        self.search = Some((id, task));
    }

    /// The plane of a mesh; waits for it if need be.
    fn of(&mut self, id: AssetId<Mesh>) -> Option<(MirrorPlane, f32)> {
        if let Some((of, task)) = self.search.take_if(|(of, _)| *of == id) {
            self.found.insert(of, block_on(task));
        }
        self.found.get(&id).copied().flatten()
    }
}

/// Follows a drag on the bird with the tool chosen.
pub(super) fn stroke_by_mouse(
    mut inspector: ResMut<Inspector>,
    pointer: Pointer,
    posed: Posed,
    buttons: Option<Res<ButtonInput<MouseButton>>>,
    mut planes: Local<Planes>,
    birds: Query<(&Plumage, &PlumageParts)>,
    parents: Query<&ChildOf, With<PlumageCards>>,
    skins: Query<&Mesh3d, Without<PlumageCards>>,
    grooms: Res<Assets<Groom>>,
) {
    if !inspector.takes_drags() {
        return;
    }
    let tool = inspector.groom_panel.tool;
    let found = inspector.bird.and_then(|bird| birds.get(bird).ok());
    let Some((plumage, card_mesh)) =
        found.and_then(|(plumage, parts)| Some((plumage, *parts.first()?)))
    else {
        return;
    };
    let id = plumage.groom.id();
    let Some(unit) = grooms.get(id).map(|groom| groom.unit.max(1e-9)) else {
        return;
    };
    let Some((skin, mesh)) = parents
        .get(card_mesh)
        .ok()
        .and_then(|child| Some((child.parent(), skins.get(child.parent()).ok()?)))
    else {
        return;
    };
    if let Some(shape) = posed.meshes.get(mesh) {
        planes.look_for(mesh.id(), shape);
    }
    let Some(buttons) = buttons else {
        return;
    };
    let place = || Some(place_on_skin(pointer.ray()?, &posed, mesh, skin)?.0 / unit);
    if buttons.just_pressed(MouseButton::Left) {
        inspector.groom_panel.note = None;
        inspector.stroke = Stroke {
            gesture: inspector.next_gesture(),
            ..Stroke::default()
        };
        if place().is_some() && inspector.groom_panel.mirror {
            inspector.stroke.mirror = planes
                .of(mesh.id())
                .map(|(plane, size)| (plane.scaled(1.0 / unit), SAME * size / unit));
            if inspector.stroke.mirror.is_none() {
                inspector.groom_panel.note =
                    Some("The bird has no mirror plane: this side only".into());
            }
        }
        if tool == Tool::Move
            && let (Some(place), Some(document)) = (place(), inspector.grooms.get(id))
        {
            let reach = inspector.groom_panel.radius;
            inspector.stroke.moved = nearest_guide_point(document.present(), place, reach);
        }
    }
    if buttons.pressed(MouseButton::Left)
        && let Some(place) = place()
    {
        inspector.stroke.points.push(place);
        apply(&mut inspector, id, tool, place);
    }
    if buttons.just_released(MouseButton::Left) {
        let stroke = std::mem::take(&mut inspector.stroke);
        if tool == Tool::Draw
            && let Some(guide) = guide_through(&stroke.points)
            && let Some(mut groom) = inspector.grooms.get(id).map(|d| d.present().clone())
        {
            add_guide(&mut groom, guide, stroke.mirror);
            inspector.grooms.edit(id, groom, stroke.gesture);
        }
    }
}

/// What the tool does at a place while the button is down.
fn apply(inspector: &mut Inspector, id: AssetId<Groom>, tool: Tool, place: Vec3) {
    let Some(mut groom) = inspector.grooms.get(id).map(|d| d.present().clone()) else {
        return;
    };
    let (radius, factor) = (inspector.groom_panel.radius, inspector.groom_panel.factor);
    let stroke = &inspector.stroke;
    let dab = |density, length| Dab {
        at: place.to_array(),
        radius,
        density,
        length,
    };
    let dab = match (tool, stroke.moved) {
        (Tool::Density, _) => dab(factor, 1.0),
        (Tool::Length, _) => dab(1.0, factor.max(0.05)),
        (Tool::Move, Some(grab)) => {
            move_point(&mut groom, grab, place, stroke.mirror);
            let gesture = stroke.gesture;
            inspector.grooms.edit(id, groom, gesture);
            return;
        }
        _ => return,
    };
    paint(&mut groom, dab);
    if let Some((plane, _)) = stroke.mirror {
        let at = plane.image(place);
        // On the middle line the two are one.
        if at.distance(place) > 0.25 * radius {
            paint(
                &mut groom,
                Dab {
                    at: at.to_array(),
                    ..dab
                },
            );
        }
    }
    let gesture = stroke.gesture;
    inspector.grooms.edit(id, groom, gesture);
}
