//! What is drawn over the bird: guides, the brush, the feather picked.

use super::{
    mirror::MirrorPlane,
    panels::Tool,
    pick::{Pointer, Posed},
    skin::{Pose, Vertices, triangles},
    state::Inspector,
    stroke::place_on_skin,
};
use crate::groom::{Groom, Guide, Plumage, PlumageCards, PlumageParts, PointTree};
use bevy::{platform::collections::HashMap, prelude::*};
use bevy_egui::{EguiContexts, egui};

const GUIDE: egui::Color32 = egui::Color32::from_rgb(255, 214, 64);
const STROKE: egui::Color32 = egui::Color32::from_rgb(90, 255, 140);
const PICKED: egui::Color32 = egui::Color32::from_rgb(80, 255, 255);
const BRUSH: egui::Color32 = egui::Color32::WHITE;

/// Guides on the skin: for every point the vertex that it moves with.
#[derive(Default)]
pub(super) struct Carried {
    mesh: Option<AssetId<Mesh>>,
    unit: f32,
    guides: Vec<Guide>,
    /// Lines of (place in bind pose in metres, vertex), mirror images among them.
    lines: Vec<Vec<(Vec3, u32)>>,
}

impl Carried {
    /// Finds the vertices anew if the guides or the mesh have changed.
    fn follow(&mut self, id: AssetId<Mesh>, vertices: &Vertices, groom: &Groom) {
        if self.mesh == Some(id) && self.unit == groom.unit && self.guides == groom.guides {
            return;
        }
        self.mesh = Some(id);
        self.unit = groom.unit;
        self.guides.clone_from(&groom.guides);
        self.lines.clear();
        let tree = tree_of(vertices);
        let carry = |point: Vec3| {
            let nearest = tree.nearest(point, 1);
            (point, nearest.first().map_or(0, |near| near.number))
        };
        for guide in &groom.guides {
            let line = || {
                guide
                    .points
                    .iter()
                    .map(|point| Vec3::from_array(*point) * groom.unit)
            };
            self.lines.push(line().map(carry).collect());
            if guide.mirror {
                let image = line().map(|point| carry(MirrorPlane::MODEL.image(point)));
                self.lines.push(image.collect());
            }
        }
    }
}

fn tree_of(vertices: &Vertices) -> PointTree {
    PointTree::new(vertices.positions().iter().copied().map(Vec3::from_array))
}

/// Draws what the tool at hand needs, and the outline of the feather picked.
pub(super) fn draw_overlay(
    mut contexts: EguiContexts,
    inspector: Res<Inspector>,
    pointer: Pointer,
    posed: Posed,
    mut carried: Local<Carried>,
    birds: Query<(&Plumage, &PlumageParts)>,
    worn: Query<(&PlumageCards, &Mesh3d, Option<&ChildOf>)>,
    skins: Query<&Mesh3d, Without<PlumageCards>>,
) -> Result {
    if !inspector.open {
        return Ok(());
    }
    let context = contexts.ctx_mut()?.clone();
    let found = inspector.bird.and_then(|bird| birds.get(bird).ok());
    let Some((plumage, card_mesh)) =
        found.and_then(|(plumage, parts)| Some((plumage, *parts.first()?)))
    else {
        return Ok(());
    };
    let Some((camera, eye)) = pointer.view() else {
        return Ok(());
    };
    let Ok((cards, cards_mesh, parent)) = worn.get(card_mesh) else {
        return Ok(());
    };
    let painter = context.layer_painter(egui::LayerId::background());
    let screen = |world: Vec3| {
        let place = camera.world_to_viewport(eye, world).ok()?;
        Some(egui::pos2(place.x, place.y))
    };
    if let Some(picked) = &inspector.picked
        && Some(picked.bird) == inspector.bird
        && let (Some(mesh), Some(pose)) = (posed.meshes.get(cards_mesh), posed.pose(card_mesh))
    {
        for [a, b] in outline(cards, picked.card, mesh, &pose) {
            if let Some((a, b)) = screen(a).zip(screen(b)) {
                painter.line_segment([a, b], egui::Stroke::new(1.5, PICKED));
            }
        }
    }
    if !inspector.takes_drags() {
        return Ok(());
    }
    let Some((skin, mesh)) =
        parent.and_then(|child| Some((child.parent(), skins.get(child.parent()).ok()?)))
    else {
        return Ok(());
    };
    let Some(groom) = inspector
        .grooms
        .get(plumage.groom.id())
        .map(|d| d.present())
    else {
        return Ok(());
    };
    let (Some(shape), Some(pose)) = (posed.meshes.get(mesh), posed.pose(skin)) else {
        return Ok(());
    };
    let Some(vertices) = Vertices::of(shape) else {
        return Ok(());
    };
    let tool = inspector.groom_panel.tool;
    if matches!(tool, Tool::Draw | Tool::Move) {
        carried.follow(mesh.id(), &vertices, groom);
        let normals = shape
            .try_attribute_option(Mesh::ATTRIBUTE_NORMAL)
            .ok()
            .flatten()
            .and_then(|values| values.as_float3());
        let seen = |(place, vertex): (Vec3, u32)| {
            let map = vertices.map(&pose, vertex);
            let world = map.transform_point3(place);
            let normal = normals
                .and_then(|normals| normals.get(vertex as usize))
                .map_or(Vec3::ZERO, |normal| map.transform_vector3((*normal).into()));
            // Those on the far side of the bird are hidden.
            let facing = normal.dot(eye.translation() - world) >= 0.0;
            facing.then(|| screen(world)).flatten()
        };
        for line in &carried.lines {
            let places: Vec<_> = line.iter().map(|point| seen(*point)).collect();
            draw_line(&painter, &places, GUIDE, tool == Tool::Move);
        }
    }
    if let Some((_, world)) = pointer
        .ray()
        .and_then(|ray| place_on_skin(ray, &posed, mesh, skin))
        && tool != Tool::Draw
    {
        let reach = inspector.groom_panel.radius * groom.unit;
        let rim = screen(world).zip(screen(world + eye.right() * reach));
        if let Some((middle, rim)) = rim {
            painter.circle_stroke(middle, middle.distance(rim), egui::Stroke::new(1.5, BRUSH));
        }
    }
    if tool == Tool::Draw && !inspector.stroke.points.is_empty() {
        let tree = tree_of(&vertices);
        let places: Vec<_> = inspector
            .stroke
            .points
            .iter()
            .map(|point| {
                let place = *point * groom.unit;
                let nearest = tree.nearest(place, 1);
                let map = vertices.map(&pose, nearest.first()?.number);
                screen(map.transform_point3(place))
            })
            .collect();
        draw_line(&painter, &places, STROKE, false);
    }
    Ok(())
}

/// A line through the places that are seen, with a head at its tip, and with dots to take hold of.
fn draw_line(
    painter: &egui::Painter,
    places: &[Option<egui::Pos2>],
    color: egui::Color32,
    dots: bool,
) {
    let stroke = egui::Stroke::new(1.5, color);
    for pair in places.windows(2) {
        if let Some((a, b)) = pair[0].zip(pair[1]) {
            painter.line_segment([a, b], stroke);
        }
    }
    if dots {
        for place in places.iter().flatten() {
            painter.circle_filled(*place, 2.5, color);
        }
    }
    if let [.., Some(before), Some(tip)] = places {
        let back = (*before - *tip).normalized() * 6.0;
        for side in [0.5_f32, -0.5] {
            painter.line_segment(
                [*tip, *tip + egui::emath::Rot2::from_angle(side) * back],
                stroke,
            );
        }
    }
}

/// The edges of a card that belong to one triangle only, in the world.
fn outline(cards: &PlumageCards, card: usize, mesh: &Mesh, pose: &Pose) -> Vec<[Vec3; 2]> {
    let (Some(geometry), Some(vertices)) = (cards.geometry.get(card), Vertices::of(mesh)) else {
        return Vec::new();
    };
    let own = geometry.first_vertex..geometry.first_vertex + geometry.vertex_count;
    let mut edges: HashMap<(u32, u32), u32> = HashMap::default();
    for [a, b, c] in triangles(mesh) {
        if own.contains(&a) {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *edges.entry((from.min(to), from.max(to))).or_default() += 1;
            }
        }
    }
    let at = |index| vertices.posed(pose, index);
    edges
        .into_iter()
        .filter(|(_, triangles)| *triangles == 1)
        .map(|((a, b), _)| [at(a), at(b)])
        .collect()
}
