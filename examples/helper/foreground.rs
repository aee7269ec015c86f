//! What stands before the subject, far out of focus: blades as soft shapes in a picture hung on the camera. A lens sampled a few times
//! would draw such things as so many copies.

use super::{
    Args,
    backdrop::{Hung, sheet},
    camera::Orbit,
    setting::Setting,
};
use bevy::{
    asset::RenderAssetUsages,
    prelude::*,
    render::render_resource::{Extent3d, TextureDimension, TextureFormat},
};

/// Rows of the picture: its softest edges need no more.
const ROWS: u32 = 192;
/// Share of the way to the subject at which it hangs.
const BEFORE: f32 = 0.55;

/// Width over height of the picture that blades are placed in; wider ones stretch them.
const FOUR_TO_THREE: f32 = 4.0 / 3.0;

/// A leaf or a blade of grass out of focus; places in heights of the picture from its middle, x to the right, y up.
#[derive(Clone, Copy, Debug)]
pub struct Blade {
    /// Where it begins and ends.
    pub ends: [Vec2; 2],
    /// How far it bends to the left of that line, and half its greatest width.
    pub bend_width: Vec2,
    /// Half the width of its edge: the disc of confusion.
    pub blur: f32,
    /// Linear RGB as the film sees it, at its beginning and at its end.
    pub colors: [Vec3; 2],
}

impl Blade {
    /// Color and opacity at a place.
    fn at(&self, place: Vec2) -> (Vec3, f32) {
        let [start, end] = self.ends;
        let along = end - start;
        let length = along.length().max(1.0e-3);
        let axis = along / length;
        let off = place - start;
        let t = off.dot(axis) / length;
        let inside = t.clamp(0.0, 1.0);
        let bow = 4.0 * self.bend_width.x * inside * (1.0 - inside);
        let across = off.dot(axis.perp()) - bow;
        // Widest before the middle, pointed at its tip.
        let half = self.bend_width.y * 1.9 * inside.powf(0.6) * (1.0 - inside).powf(0.8);
        let beyond = length * (t - inside).abs();
        let distance = Vec2::new((across.abs() - half).max(0.0), beyond).length();
        let depth = if distance > 0.0 {
            -distance
        } else {
            half - across.abs()
        };
        let soft = (0.5 + 0.5 * depth / self.blur).clamp(0.0, 1.0);
        // A pale rib along the middle, as unsharp as the rest.
        let rib = 1.0 + 0.25 * (-(across / (0.5 * self.blur)).powi(2)).exp();
        let [first, last] = self.colors;
        (
            first.lerp(last, inside) * rib,
            soft * soft * (3.0 - 2.0 * soft),
        )
    }
}

fn byte(value: f32) -> u8 {
    (255.0 * value.clamp(0.0, 1.0)).round() as u8
}

/// Hangs the blades of the scene before every camera.
pub fn hang(
    mut commands: Commands,
    args: Res<Args>,
    setting: Res<Setting>,
    cameras: Query<Entity, With<Orbit>>,
    mut images: ResMut<Assets<Image>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let blades = setting.blades;
    if blades.is_empty() {
        return;
    }
    let aspect = args.size.0 as f32 / args.size.1 as f32;
    let width = ((ROWS as f32 * aspect) as u32).clamp(16, 4 * ROWS);
    let data = (0..width * ROWS)
        .flat_map(|i| {
            let pixel = Vec2::new((i % width) as f32 + 0.5, (i / width) as f32 + 0.5);
            let place = Vec2::new(
                FOUR_TO_THREE * (pixel.x / width as f32 - 0.5),
                0.5 - pixel.y / ROWS as f32,
            );
            // Colors go on where nothing is drawn, lest edges darken.
            let (mut sum, mut weight, mut clear) = (Vec3::ZERO, 0.0, 1.0);
            for blade in blades {
                let (color, cover) = blade.at(place);
                sum += color * (cover + 1.0e-4);
                weight += cover + 1.0e-4;
                clear *= 1.0 - cover;
            }
            let color = sum / weight;
            let shown = Color::linear_rgb(color.x, color.y, color.z).to_srgba();
            [shown.red, shown.green, shown.blue, 1.0 - clear].map(byte)
        })
        .collect();
    let image = images.add(Image::new(
        Extent3d {
            width,
            height: ROWS,
            depth_or_array_layers: 1,
        },
        TextureDimension::D2,
        data,
        TextureFormat::Rgba8UnormSrgb,
        RenderAssetUsages::RENDER_WORLD,
    ));
    for camera in &cameras {
        let hung = Hung::Before(BEFORE);
        let picture = sheet(
            hung,
            aspect,
            &image,
            AlphaMode::Blend,
            &mut meshes,
            &mut materials,
        );
        commands.entity(camera).with_child(picture);
    }
}
