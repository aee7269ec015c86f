//! What lies behind the subject, out of focus: discs of confusion on slow noise, hung on the camera.

use super::{
    Args,
    camera::Orbit,
    noise::{Dice, fractal},
    setting::Setting,
    sky::half_float,
};
use bevy::{
    asset::RenderAssetUsages,
    light::{NotShadowCaster, NotShadowReceiver},
    prelude::*,
    render::render_resource::{Extent3d, TextureDimension, TextureFormat},
};

/// Rows of the picture: nothing in it is finer than a twentieth of its height.
const ROWS: usize = 256;
/// Distance behind the subject, metres.
const BEHIND: f32 = 3.0;
/// Half width of each of the two boxes that blur it, shares of the height.
const BLUR: f32 = 0.02;

/// An unsharp landscape; linear RGB as the camera's film sees it.
#[derive(Clone, Copy, Debug)]
pub struct Backdrop {
    /// Depths, middle tones and lights.
    pub colors: [Vec3; 3],
    /// Number of discs, and the most that one covers of what is behind it.
    pub discs: (u32, f32),
    /// Gaps in the leaves through which the sky shines.
    pub gaps: bool,
    /// Ridges of hills under a sky, one behind another, before which the discs lie; 0: leaves all over.
    pub ridges: u32,
}

/// Haze over the furthest ridge; the nearest has none.
const HAZE: f32 = 0.75;

/// What hangs on a camera and fills its picture.
#[derive(Component, Clone, Copy, Debug)]
pub enum Hung {
    /// Metres behind the subject.
    Behind(f32),
    /// At a share of the way to it.
    Before(f32),
}

impl Backdrop {
    fn paint(&self, width: usize, seed: u32) -> Vec<Vec3> {
        let mut dice = Dice(seed);
        let [dark, middle, light] = self.colors;
        let unit = ROWS as f32;
        let shift = Vec3::splat(seed as f32);
        let mut picture: Vec<Vec3> = (0..width * ROWS)
            .map(|i| {
                let p = Vec3::new((i % width) as f32, (i / width) as f32, 0.0) / unit;
                let slow = 0.5 + 0.9 * fractal(p * 2.2 + shift, 3);
                let finer = 0.5 + 0.9 * fractal(p * 5.0 + shift + 9.0, 2);
                let glow = finer * (0.85 - 0.6 * p.y) - 0.15;
                dark.lerp(middle, slow.clamp(0.0, 1.0))
                    .lerp(light, 0.6 * glow.clamp(0.0, 1.0))
            })
            .collect();
        self.paint_ridges(&mut picture, width);
        let (count, strength) = self.discs;
        for i in 0..count {
            let radius =
                unit * (0.05 - 0.022 * i as f32 / count as f32) * (0.7 + 0.6 * dice.roll());
            let (x, y) = (dice.roll() * width as f32, dice.roll() * unit);
            let gap = self.gaps && dice.roll() > 0.975 - 0.03 * (1.0 - y / unit);
            let color = if gap {
                Vec3::new(0.34, 0.39, 0.36) * (0.5 + dice.roll())
            } else {
                let tone = dark.lerp(light * (0.8 + 0.9 * dice.roll()), dice.roll().powf(1.5));
                tone * Vec3::new(0.8 + 0.5 * dice.roll(), 1.0, 0.7 + 0.5 * dice.roll())
            };
            let cover = strength * (0.2 + 0.8 * dice.roll());
            disc(&mut picture, width, Vec2::new(x, y), radius, (color, cover));
        }
        let reach = (BLUR * unit) as usize;
        for _ in 0..2 {
            picture = blurred(&picture, width, reach);
        }
        picture
    }

    /// A sky that pales towards the horizon, and ridges, the nearer the darker.
    fn paint_ridges(&self, picture: &mut [Vec3], width: usize) {
        let [dark, middle, light] = self.colors;
        let warm = light * Vec3::new(1.12, 1.0, 0.86);
        let unit = ROWS as f32;
        for (i, pixel) in picture.iter_mut().enumerate().filter(|_| self.ridges > 0) {
            let (x, y) = ((i % width) as f32 / unit, (i / width) as f32 / unit);
            let cloud = 1.0 + 0.16 * fractal(Vec3::new(1.3 * x, 4.0 * y, 2.0), 3);
            *pixel = middle.lerp(warm, (1.6 * y).min(1.0)) * cloud;
            for ridge in 0..self.ridges {
                let near = (ridge + 1) as f32 / self.ridges as f32;
                let shape = fractal(Vec3::new(1.1 * x * (1.5 - 0.5 * near), 7.0 * near, 4.0), 4);
                let crest = 0.40 + 0.42 * near + 0.20 * shape - 0.12 * near * x;
                let below = ((y - crest) / 0.01).clamp(0.0, 1.0);
                let ground = dark * (1.0 + 0.5 * fractal(Vec3::new(5.0 * x, 9.0 * y, near), 3));
                *pixel = pixel.lerp(ground.lerp(warm, HAZE * (1.0 - near)), below);
            }
        }
    }
}

fn disc(picture: &mut [Vec3], width: usize, at: Vec2, radius: f32, (color, cover): (Vec3, f32)) {
    let soft = 0.16 * radius;
    let range = |c: f32, limit: usize| {
        let reach = radius + soft;
        (c - reach).max(0.0) as usize..((c + reach + 1.0) as usize).min(limit)
    };
    for y in range(at.y, ROWS) {
        for x in range(at.x, width) {
            let d = at.distance(Vec2::new(x as f32, y as f32));
            let inside = ((radius + 0.5 * soft - d) / soft).clamp(0.0, 1.0);
            // A lens draws the rim of a disc a little brighter than its middle.
            let rim = 1.0 + 0.18 * (d / radius).min(1.0).powi(6);
            let pixel = &mut picture[y * width + x];
            *pixel = pixel.lerp(color * rim, cover * inside);
        }
    }
}

fn blurred(picture: &[Vec3], width: usize, reach: usize) -> Vec<Vec3> {
    let pass = |source: &[Vec3], step: (usize, usize)| -> Vec<Vec3> {
        (0..source.len())
            .map(|i| {
                let (x, y) = (i % width, i / width);
                let sum: Vec3 = (0..=2 * reach)
                    .map(|k| {
                        let u = (x + k * step.0)
                            .saturating_sub(reach * step.0)
                            .min(width - 1);
                        let v = (y + k * step.1)
                            .saturating_sub(reach * step.1)
                            .min(ROWS - 1);
                        source[v * width + u]
                    })
                    .sum();
                sum / (2 * reach + 1) as f32
            })
            .collect()
    };
    pass(&pass(picture, (1, 0)), (0, 1))
}

/// Hangs the backdrop of the scene behind the subject of every camera.
pub fn hang(
    mut commands: Commands,
    args: Res<Args>,
    setting: Res<Setting>,
    cameras: Query<Entity, With<Orbit>>,
    mut images: ResMut<Assets<Image>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let Some(backdrop) = setting.backdrop else {
        return;
    };
    let aspect = args.size.0 as f32 / args.size.1 as f32;
    let width = ((ROWS as f32 * aspect) as usize).clamp(16, 4 * ROWS);
    let data = backdrop
        .paint(width, 5)
        .into_iter()
        .flat_map(|color| color.extend(1.0).to_array())
        .flat_map(|value| half_float(value).to_le_bytes())
        .collect();
    let image = images.add(Image::new(
        Extent3d {
            width: width as u32,
            height: ROWS as u32,
            depth_or_array_layers: 1,
        },
        TextureDimension::D2,
        data,
        TextureFormat::Rgba16Float,
        RenderAssetUsages::RENDER_WORLD,
    ));
    for camera in &cameras {
        let hung = Hung::Behind(BEHIND);
        let picture = sheet(
            hung,
            aspect,
            &image,
            AlphaMode::Opaque,
            &mut meshes,
            &mut materials,
        );
        commands.entity(camera).with_child(picture);
    }
}

/// A picture as wide as `aspect` times its height, which hangs on a camera and throws and receives no shadow.
pub fn sheet(
    hung: Hung,
    aspect: f32,
    image: &Handle<Image>,
    alpha_mode: AlphaMode,
    meshes: &mut Assets<Mesh>,
    materials: &mut Assets<StandardMaterial>,
) -> impl Bundle {
    (
        hung,
        Mesh3d(meshes.add(Rectangle::new(aspect, 1.0))),
        MeshMaterial3d(materials.add(StandardMaterial {
            base_color_texture: Some(image.clone()),
            alpha_mode,
            unlit: true,
            ..default()
        })),
        Transform::default(),
        NotShadowCaster,
        NotShadowReceiver,
    )
}

/// Keeps what hangs on a camera in its picture, wherever it stands and through whatever lens it looks.
pub fn fit(
    cameras: Query<(&Transform, &Projection, &Orbit, &Children), Without<Hung>>,
    mut hung: Query<(&Hung, &mut Transform)>,
) {
    for (transform, lens, orbit, children) in &cameras {
        let Projection::Perspective(lens) = lens else {
            continue;
        };
        let distance = transform.translation.distance(orbit.target);
        let mut all = hung.iter_many_mut(children);
        while let Some((hung, mut place)) = all.fetch_next() {
            let away = match *hung {
                Hung::Behind(metres) => distance + metres,
                Hung::Before(share) => distance * share,
            };
            // A little larger than the picture, which a jittered camera moves.
            let tall = 2.1 * away * (0.5 * lens.fov).tan();
            let fitted = Transform::from_xyz(0.0, 0.0, -away).with_scale(Vec3::splat(tall));
            place.set_if_neq(fitted);
        }
    }
}
