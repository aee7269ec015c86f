//! One feather alone, turned by hand under a light of its own, with its barb lattice and a cursor that reads its coverage.

use super::{
    fields::{number, row_of},
    state::Inspector,
};
use crate::{
    anatomy::{Feather, Side},
    groom::{Card, CardGeometry, FeathersOf, PlumageCards},
    maths::Footprint,
    maths::query::{Coverage, ErrorBudget, feather_coverage},
    parameter::Parameter,
    render::FeatherQuality,
};
use bevy::{
    asset::RenderAssetUsages,
    camera::{
        Exposure, RenderTarget, ScalingMode,
        visibility::{NoFrustumCulling, RenderLayers},
    },
    mesh::{Indices, PrimitiveTopology},
    prelude::*,
    render::render_resource::{PipelineCache, TextureFormat},
};
use bevy_egui::{EguiContexts, EguiTextureHandle, PrimaryEguiContext, egui};
use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::Duration,
};

/// The layer that only the preview's camera and light see.
const LAYER: usize = 30;
/// Size of the picture in pixels; the card is one unit long on it.
const SIZE: UVec2 = UVec2::new(240, 320);
/// Height of the view in lengths of the feather.
const HEIGHT: f32 = 1.15;
/// Most barbs drawn over the picture.
const MAX_LINES: usize = 160;

const ANGLE: Parameter = Parameter::degrees(-180.0, 180.0);
const HEIGHT_OF_LIGHT: Parameter = Parameter::degrees(-90.0, 90.0);
const FOOTPRINT: Parameter = Parameter::new("\u{b5}m", 0.1, 20_000.0).logarithmic();

/// The preview and how it is looked at.
#[derive(Resource, Debug)]
pub struct Preview {
    /// Turn about the rachis and about the horizontal, radians.
    pub turn: Vec2,
    /// Direction of the light: azimuth and height, degrees.
    pub light: Vec2,
    /// The barbs are drawn over the picture.
    pub lattice: bool,
    /// Standard deviation of the cursor's footprint, micrometres.
    pub footprint_um: f32,
    image: Option<Handle<Image>>,
    shown: Option<Shown>,
    /// What the picture was last drawn for, and what is left of the time it is drawn.
    drawn: Option<(Vec2, Vec2)>,
    awake: (u32, Duration),
}

/// What the card of the preview was made for: feather, its aspect, and the color that the bird gives it.
type Shown = (AssetId<Feather>, f32, [f32; 3]);

/// Frames and time that the picture is drawn after a change, and after the last pipeline has been compiled.
const AWAKE: (u32, Duration) = (4, Duration::from_millis(500));

/// Whether the renderer waits for pipelines; the render world writes it.
#[derive(Resource, Clone, Debug, Default)]
pub(super) struct Compiling(Arc<AtomicBool>);

/// Tells the main world about pipelines under way.
pub(super) fn watch_pipelines(cache: Res<PipelineCache>, compiling: Res<Compiling>) {
    let waiting = cache.waiting_pipelines().next().is_some();
    compiling.0.store(waiting, Ordering::Relaxed);
}

impl Default for Preview {
    fn default() -> Self {
        Self {
            turn: Vec2::ZERO,
            light: Vec2::new(35.0, 45.0),
            lattice: false,
            footprint_um: 100.0,
            image: None,
            shown: None,
            drawn: None,
            awake: AWAKE,
        }
    }
}

/// The card of the preview.
#[derive(Component)]
pub(super) struct PreviewCard;

/// Its light.
#[derive(Component)]
pub(super) struct PreviewLight;

/// Its camera.
#[derive(Component)]
pub(super) struct PreviewCamera;

impl Preview {
    /// The picture for egui, once there is one.
    pub(super) fn texture(&self, contexts: &mut EguiContexts) -> Option<egui::TextureId> {
        let image = self.image.as_ref()?;
        Some(
            contexts
                .image_id(image)
                .unwrap_or_else(|| contexts.add_image(EguiTextureHandle::Strong(image.clone()))),
        )
    }

    fn rotation(&self) -> Quat {
        Quat::from_rotation_x(self.turn.y) * Quat::from_rotation_y(self.turn.x)
    }

    /// Where a point of the card is on the picture, 0..1 from the upper left.
    pub fn project(&self, uv: Vec2, aspect: f32) -> Vec2 {
        let place = self.rotation() * Vec3::new((uv.x - 0.5) * aspect, uv.y - 0.5, 0.0);
        let width = HEIGHT * SIZE.x as f32 / SIZE.y as f32;
        Vec2::new(0.5 + place.x / width, 0.5 - place.y / HEIGHT)
    }

    /// The point of the card under a point of the picture; `None` beside the card or on a card seen from its edge.
    pub fn uv_at(&self, point: Vec2, aspect: f32) -> Option<Vec2> {
        let width = HEIGHT * SIZE.x as f32 / SIZE.y as f32;
        let back = self.rotation().inverse();
        let origin = back * Vec3::new((point.x - 0.5) * width, (0.5 - point.y) * HEIGHT, 0.0);
        let direction = back * Vec3::Z;
        if direction.z.abs() < 1e-3 {
            return None;
        }
        let place = origin - direction * (origin.z / direction.z);
        let uv = Vec2::new(place.x / aspect.max(1e-6) + 0.5, place.y + 0.5);
        (uv.cmpge(Vec2::ZERO).all() && uv.cmple(Vec2::ONE).all()).then_some(uv)
    }

    /// The eye in the frame of the card: across, along, out of the front.
    pub fn view(&self) -> Vec3 {
        self.rotation().inverse() * Vec3::Z
    }
}

/// Coverage of a round footprint at a place of the card; nothing where there is no vane.
pub fn coverage_at(
    feather: &Feather,
    uv: Vec2,
    sigma_um: f32,
    view: Vec3,
) -> Option<Coverage<f32>> {
    let (curve, _) = feather.rachis.spline().at(f64::from(uv.y));
    let x = (uv.x - curve as f32) * feather.aspect;
    let side = if x < 0.0 { Side::Left } else { Side::Right };
    let root = uv.y - x.abs() / feather.vane(side).alpha_b().tan().max(1e-3);
    let on_shaft = x.abs() <= feather.r_r(uv.y);
    let on_vane = root >= feather.contour.start && x.abs() <= feather.contour.reach(side, root);
    if !on_shaft && !on_vane {
        return None;
    }
    let footprint = Footprint::round([x, uv.y], feather.from_um(sigma_um));
    Some(feather_coverage(
        &feather.query_vane(Side::Left),
        &feather.query_vane(Side::Right),
        feather.r_r(uv.y),
        &footprint,
        view.to_array(),
        &ErrorBudget::default(),
    ))
}

/// Draws the picture, its controls and what the cursor reads.
pub(super) fn preview_panel(
    ui: &mut egui::Ui,
    preview: &mut Preview,
    feather: Option<&Feather>,
    texture: Option<egui::TextureId>,
) {
    let Some((feather, texture)) = feather.zip(texture) else {
        ui.label("No feather to show.");
        return;
    };
    ui.strong(&feather.name);
    let width = ui.available_width().min(SIZE.x as f32 * 1.5);
    let size = egui::vec2(width, width * SIZE.y as f32 / SIZE.x as f32);
    let picture = egui::Image::new((texture, size)).sense(egui::Sense::click_and_drag());
    let response = ui.add(picture).on_hover_cursor(egui::CursorIcon::Crosshair);
    let dragged = response.drag_delta();
    if response.dragged() {
        preview.turn += Vec2::new(dragged.x, dragged.y) * 0.01;
        preview.turn.y = preview.turn.y.clamp(-1.5, 1.5);
    }
    if response.double_clicked() {
        preview.turn = Vec2::ZERO;
    }
    let rect = response.rect;
    let place = |point: Vec2| {
        egui::pos2(
            rect.left() + point.x * rect.width(),
            rect.top() + point.y * rect.height(),
        )
    };
    if preview.lattice {
        let painter = ui.painter_at(rect);
        let stroke = egui::Stroke::new(0.7, egui::Color32::from_rgb(255, 220, 80));
        for [root, tip] in barb_lines(feather) {
            let ends = [root, tip].map(|uv| place(preview.project(uv, feather.aspect)));
            painter.line_segment(ends, stroke);
        }
    }
    ui.weak("Drag to turn it; a double click turns it back.");
    ui.checkbox(&mut preview.lattice, "barbs over the picture");
    for (name, hint, value, parameter) in [
        (
            "light from",
            "Azimuth of the light, 0 in front",
            &mut preview.light.x,
            ANGLE,
        ),
        (
            "light above",
            "Height of the light",
            &mut preview.light.y,
            HEIGHT_OF_LIGHT,
        ),
        (
            "footprint",
            "Standard deviation of the Gaussian that the cursor reads",
            &mut preview.footprint_um,
            FOOTPRINT,
        ),
    ] {
        ui.spacing_mut().slider_width = 80.0;
        row_of(ui, 78.0, 0, name, hint, |ui| {
            number(ui, value, Some(parameter))
        });
    }
    let under = response.hover_pos().and_then(|position| {
        let point = Vec2::new(
            (position.x - rect.left()) / rect.width(),
            (position.y - rect.top()) / rect.height(),
        );
        preview.uv_at(point, feather.aspect)
    });
    let Some(uv) = under else {
        ui.weak("Move over the feather to read its coverage.");
        return;
    };
    ui.monospace(format!("u {:.3}  v {:.3}", uv.x, uv.y));
    match coverage_at(feather, uv, preview.footprint_um, preview.view()) {
        Some(coverage) => {
            for (name, weight) in [
                ("rachis", coverage.rachis),
                ("barb", coverage.barb),
                ("distal", coverage.distal),
                ("proximal", coverage.proximal),
                ("behind", coverage.transmission()),
            ] {
                ui.monospace(format!("{name:9}{weight:.4}"));
            }
        }
        None => {
            ui.weak("beside the vane");
        }
    }
}

/// Barbs as lines from root to rim on the card, every n-th of them.
pub fn barb_lines(feather: &Feather) -> Vec<[Vec2; 2]> {
    let spline = feather.rachis.spline();
    let mut lines = Vec::new();
    for (side, sign) in [(Side::Left, -1.0), (Side::Right, 1.0)] {
        let vane = feather.vane(side);
        let step = (vane.barb_count as usize / (MAX_LINES / 2)).max(1);
        let cot = 1.0 / vane.alpha_b().tan().max(1e-3);
        for barb in (0..vane.barb_count.max(0.0) as usize).step_by(step) {
            let root = barb as f32 / vane.barb_count;
            let reach = feather.contour.reach(side, root);
            if root < feather.contour.start || reach <= 0.0 {
                continue;
            }
            let uv = |x: f32, y: f32| {
                let curve = spline.at(f64::from(y.min(1.0))).0 as f32;
                Vec2::new(sign * x / feather.aspect + curve, y)
            };
            lines.push([uv(0.0, root), uv(reach, root + reach * cot)]);
        }
    }
    lines
}

/// Spawns what the preview needs and keeps it up to date; without a renderer there is none.
pub(super) fn update_preview(
    mut commands: Commands,
    mut preview: ResMut<Preview>,
    inspector: Res<Inspector>,
    time: Res<Time<Real>>,
    compiling: Res<Compiling>,
    mut events: MessageReader<AssetEvent<Feather>>,
    worn: Query<(&PlumageCards, &FeathersOf)>,
    server: Res<AssetServer>,
    feathers: Res<Assets<Feather>>,
    images: Option<ResMut<Assets<Image>>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut cards: Query<(Entity, &mut Transform), With<PreviewCard>>,
    mut lights: Query<&mut Transform, (With<PreviewLight>, Without<PreviewCard>)>,
    mut cameras: Query<&mut Camera, With<PreviewCamera>>,
    contexts: Query<(), With<PrimaryEguiContext>>,
) {
    // The panels belong on the app's camera: ours comes after it.
    let Some(mut images) = images.filter(|_| !contexts.is_empty()) else {
        return;
    };
    if preview.image.is_none() {
        let image = images.add(Image::new_target_texture(
            SIZE.x,
            SIZE.y,
            TextureFormat::Rgba8UnormSrgb,
            None,
        ));
        spawn_stage(&mut commands, &image);
        preview.image = Some(image);
    }
    let edited = events.read().any(
        |event| matches!(event, AssetEvent::Modified { id } if Some(*id) == inspector.feather),
    );
    let look = (preview.turn, preview.light);
    let compiling = compiling.0.load(Ordering::Relaxed);
    if edited || compiling || preview.drawn != Some(look) {
        preview.drawn = Some(look);
        preview.awake = AWAKE;
    }
    // Most of the time the picture stays as it is, and costs nothing.
    let active = inspector.open && preview.awake != (0, Duration::ZERO);
    preview.awake.0 = preview.awake.0.saturating_sub(1);
    preview.awake.1 = preview.awake.1.saturating_sub(time.delta());
    for mut camera in &mut cameras {
        if camera.is_active != active {
            camera.is_active = active;
        }
    }
    let (azimuth, height) = (preview.light.x.to_radians(), preview.light.y.to_radians());
    let from = Quat::from_rotation_y(azimuth) * Quat::from_rotation_x(-height) * Vec3::Z;
    for mut light in &mut lights {
        light.set_if_neq(Transform::from_translation(from).looking_at(Vec3::ZERO, Vec3::Y));
    }
    let rotation = preview.rotation();
    for (_, mut card) in &mut cards {
        card.set_if_neq(Transform::from_rotation(rotation));
    }
    let Some((id, feather)) = inspector
        .feather
        .and_then(|id| Some((id, feathers.get(id)?)))
    else {
        return;
    };
    let shown = (id, feather.aspect, tint_of(&inspector, id, &worn));
    if preview.shown == Some(shown) {
        return;
    }
    let Some(handle) = server.get_id_handle(id) else {
        return;
    };
    preview.shown = Some(shown);
    preview.awake = AWAKE;
    for (entity, _) in &cards {
        commands.entity(entity).despawn();
    }
    let mut quality = FeatherQuality::default();
    quality.settings.shelter = 0.0;
    commands.spawn((
        PreviewCard,
        Mesh3d(meshes.add(card_mesh(feather.aspect))),
        Transform::from_rotation(rotation),
        RenderLayers::layer(LAYER),
        NoFrustumCulling,
        quality,
        PlumageCards::new(
            [card(feather.aspect, shown.2)],
            [CardGeometry {
                first_vertex: 0,
                vertex_count: 4,
            }],
            vec![handle],
        ),
    ));
}

/// The color that the bird gives a feather: the picked card's, or the first one's that wears it.
fn tint_of(
    inspector: &Inspector,
    id: AssetId<Feather>,
    worn: &Query<(&PlumageCards, &FeathersOf)>,
) -> [f32; 3] {
    let Some((worn, of)) = worn.iter().find(|(_, of)| Some(of.0) == inspector.bird) else {
        return [0.3; 3];
    };
    let wears = |card: &&Card| {
        worn.feather_of(card)
            .is_some_and(|feather| feather.id() == id)
    };
    inspector
        .picked
        .as_ref()
        .filter(|picked| picked.bird == of.0)
        .and_then(|picked| worn.cards.get(picked.card))
        .filter(wears)
        .or_else(|| worn.cards.iter().find(wears))
        .map_or([0.3; 3], |card| card.tint)
}

fn spawn_stage(commands: &mut Commands, image: &Handle<Image>) {
    commands.spawn((
        PreviewCamera,
        Camera3d::default(),
        Camera {
            order: -1,
            clear_color: Color::srgb(0.16, 0.17, 0.18).into(),
            ..default()
        },
        RenderTarget::Image(image.clone().into()),
        Projection::Orthographic(OrthographicProjection {
            scaling_mode: ScalingMode::FixedVertical {
                viewport_height: HEIGHT,
            },
            near: -4.0,
            far: 4.0,
            ..OrthographicProjection::default_3d()
        }),
        Transform::from_xyz(0.0, 0.0, 2.0),
        Exposure { ev100: 11.4 },
        Msaa::Sample4,
        AmbientLight {
            brightness: 1500.0,
            ..default()
        },
        RenderLayers::layer(LAYER),
    ));
    commands.spawn((
        PreviewLight,
        DirectionalLight {
            illuminance: 23_000.0,
            ..default()
        },
        RenderLayers::layer(LAYER),
    ));
}

fn card(aspect: f32, tint: [f32; 3]) -> Card {
    Card {
        root: Vec3::NEG_Y * 0.5,
        along: Vec3::Y,
        normal: Vec3::Z,
        center: Vec3::ZERO,
        radius: 0.5 * 1.0_f32.hypot(aspect),
        length: 1.0,
        width: aspect,
        joints: [0; 4],
        weights: [1.0, 0.0, 0.0, 0.0],
        feather: 0,
        region: 0,
        layer: 0.0,
        tint,
        seed: 1,
        turn: 0.0,
        mirrored: false,
    }
}

/// A flat card, one unit long, with the attributes of feather cards.
fn card_mesh(aspect: f32) -> Mesh {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let positions: Vec<[f32; 3]> = corners
        .iter()
        .map(|[u, v]| [(u - 0.5) * aspect, v - 0.5, 0.0])
        .collect();
    Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::default(),
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
    .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, vec![[0.0, 0.0, 1.0]; 4])
    .with_inserted_attribute(Mesh::ATTRIBUTE_TANGENT, vec![[0.0, 1.0, 0.0, -1.0]; 4])
    .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, corners.to_vec())
    .with_inserted_attribute(Mesh::ATTRIBUTE_UV_1, vec![[0.0, 0.0]; 4])
    .with_inserted_indices(Indices::U32(vec![0, 1, 2, 0, 2, 3]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::anatomy;

    #[test]
    fn the_cursor_reads_where_it_points() {
        let mut preview = Preview::default();
        for turn in [Vec2::ZERO, Vec2::new(0.7, -0.4), Vec2::new(3.0, 0.2)] {
            preview.turn = turn;
            for uv in [Vec2::new(0.2, 0.1), Vec2::new(0.9, 0.95), Vec2::splat(0.5)] {
                let back = preview.uv_at(preview.project(uv, 0.3), 0.3).unwrap();
                assert!(back.distance(uv) < 1e-4, "{uv} {back}");
            }
        }
        preview.turn = Vec2::new(std::f32::consts::FRAC_PI_2, 0.0);
        assert_eq!(preview.uv_at(Vec2::splat(0.5), 0.3), None);
    }

    #[test]
    fn the_shaft_the_vane_and_the_air_beside_it() {
        let feather = anatomy::primary();
        let (curve, _) = feather.rachis.spline().at(0.5);
        let shaft = coverage_at(&feather, Vec2::new(curve as f32, 0.5), 1.0, Vec3::Z).unwrap();
        assert!(shaft.rachis > 0.9);
        let vane = Vec2::new(curve as f32 + 0.15, 0.5);
        let vane = coverage_at(&feather, vane, 5000.0, Vec3::Z).unwrap();
        assert!(vane.barb > 0.05 && vane.transmission() < 0.9);
        assert_eq!(coverage_at(&feather, Vec2::ZERO, 100.0, Vec3::Z), None);
    }
}
