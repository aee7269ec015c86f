//! One feather twice: drawn by the plugin off screen in linear color, and cast as explicit curves. Shared by the test and
//! the example `explicit_curves`.

use crate::app::{DrawingApp, frames, screenshot};
use bevy::{
    asset::RenderAssetUsages,
    camera::{Exposure, Hdr, RenderTarget, ScalingMode, visibility::NoFrustumCulling},
    core_pipeline::tonemapping::{DebandDither, Tonemapping},
    light::GlobalAmbientLight,
    mesh::{Indices, PrimitiveTopology},
    prelude::*,
    render::{
        render_resource::{TextureFormat, TextureUsages},
        settings::WgpuSettings,
    },
};
use bevy_plumage::groom::{Card, CardGeometry, PlumageCards};
use bevy_plumage::prelude::*;
use plumage_reference::curves::{CurveCamera, CurveOptions, CurveShader, Curves};
use rayon::prelude::*;

/// Region color of the card, linear RGB, as ten bits a channel hold it.
pub const TINT: [f64; 3] = [0.55, 0.09, 0.04];
/// Brings exposure times illuminance to 1.
const EXPOSURE: Exposure = Exposure { ev100: 9.7 };

/// A picture: linear RGB, premultiplied, for a light of irradiance 1.
pub type Picture = Vec<[f64; 3]>;

/// What is looked at and from where, in card space (units of the feather's length, see `plumage_reference::curves`).
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// Side of the square picture in pixels.
    pub size: u32,
    /// Side of a pixel, feather lengths.
    pub pixel: f64,
    /// Middle of the picture on the card.
    pub target: [f64; 2],
    /// Towards the eye.
    pub eye: [f64; 3],
    /// Towards the light.
    pub light: [f64; 3],
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let l = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    v.map(|x| x / l)
}

impl View {
    /// The reference's camera.
    pub fn camera(&self) -> CurveCamera {
        let [x, y] = self.target;
        let eye = unit(self.eye);
        CurveCamera::looking_at(
            [x + 2.0 * eye[0], y + 2.0 * eye[1], 2.0 * eye[2]],
            [x, y, 0.0],
            [0.0, 1.0, 0.0],
            self.pixel,
            true,
            [self.size; 2],
        )
    }
}

/// Ten-bit square roots, as a card stores its tint.
pub fn stored_tint() -> [f64; 3] {
    TINT.map(|t| ((t.sqrt() * 1023.0).round() / 1023.0).powi(2))
}

/// A feather of `assets/feathers`.
pub fn feather(name: &str) -> Feather {
    let path = crate::asset(&format!("feathers/{name}.feather.ron"));
    let read = std::fs::read_to_string(&path);
    let text = read.unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    ron::from_str(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// Two independent pictures of the explicit curves, `samples` squared rays a pixel each.
pub fn references(
    feather: &Feather,
    curves: &Curves,
    view: &View,
    options: CurveOptions,
    samples: u32,
) -> [Picture; 2] {
    let mut shader = CurveShader::new(feather, stored_tint(), options);
    shader.lights = vec![(unit(view.light), [1.0; 3])];
    let camera = view.camera();
    [7, 8].map(|seed| {
        (0..view.size)
            .into_par_iter()
            .flat_map_iter(|row| camera.row(curves, &shader, row, samples, seed))
            .map(|p| [p[0], p[1], p[2]])
            .collect()
    })
}

/// How far the plugin's picture is from the reference.
#[derive(Clone, Copy, Debug)]
pub struct Difference {
    /// Root mean square of the difference over the pixels and channels where either shows anything, without the reference's own
    /// sampling noise: the mean product of the differences to two independent references.
    pub rmse: f64,
    /// Mean of the reference over the same.
    pub mean: f64,
    /// 99.9th percentile of the reference: the range.
    pub range: f64,
    /// Mean difference over the mean.
    pub bias: f64,
}

/// Mean of two pictures.
pub fn middle([a, b]: &[Picture; 2]) -> Picture {
    let pairs = a.iter().zip(b);
    pairs
        .map(|(a, b)| [0, 1, 2].map(|c| 0.5 * (a[c] + b[c])))
        .collect()
}

impl Difference {
    /// Compares linear pictures.
    pub fn of(shown: &Picture, references: &[Picture; 2]) -> Self {
        let reference = middle(references);
        let lit = |p: &[f64; 3]| p.iter().sum::<f64>() > 1e-5;
        let [first, second] = references;
        let mut values = Vec::new();
        let (mut square, mut bias) = (0.0, 0.0);
        for (i, p) in shown.iter().enumerate() {
            if !lit(p) && !lit(&reference[i]) {
                continue;
            }
            for c in 0..3 {
                square += (p[c] - first[i][c]) * (p[c] - second[i][c]);
                bias += p[c] - reference[i][c];
                values.push(reference[i][c]);
            }
        }
        let n = values.len().max(1) as f64;
        let mean = values.iter().sum::<f64>() / n;
        values.sort_by(f64::total_cmp);
        let range = values
            .get(values.len() * 999 / 1000)
            .copied()
            .unwrap_or(0.0);
        Self {
            rmse: (square / n).max(0.0).sqrt(),
            mean,
            range,
            bias: bias / n / mean.max(1e-12),
        }
    }

    /// RMSE over the reference's range.
    pub fn of_range(&self) -> f64 {
        self.rmse / self.range.max(1e-12)
    }

    /// RMSE over the reference's mean.
    pub fn of_mean(&self) -> f64 {
        self.rmse / self.mean.max(1e-12)
    }
}

/// The plugin's side: an app with one flat card, an orthographic camera and one light.
pub struct Studio {
    app: DrawingApp,
    image: Handle<Image>,
    camera: Entity,
    light: Entity,
    size: u32,
}

impl Studio {
    /// An app that draws `feather` on a card one metre long, `size` pixels square; None where [`crate::gpu::device`] is.
    pub fn new(feather: Feather, size: u32, settings: FeatherSettings) -> Option<Self> {
        let mut app = DrawingApp::start(WgpuSettings::default(), |app| {
            app.insert_resource(GlobalAmbientLight {
                brightness: 0.0,
                ..default()
            });
        })?;
        let world = app.world_mut();
        let mut image = Image::new_target_texture(size, size, TextureFormat::Rgba16Float, None);
        image.texture_descriptor.usage |= TextureUsages::COPY_SRC;
        let image = world.resource_mut::<Assets<Image>>().add(image);
        let camera = world
            .spawn((
                Camera3d::default(),
                Hdr,
                Msaa::Sample4,
                Tonemapping::None,
                DebandDither::Disabled,
                EXPOSURE,
                RenderTarget::Image(image.clone().into()),
            ))
            .id();
        let light = world
            .spawn(DirectionalLight {
                illuminance: 1.0 / EXPOSURE.exposure(),
                shadow_maps_enabled: false,
                ..default()
            })
            .id();
        let aspect = feather.aspect;
        let handle = world.resource_mut::<Assets<Feather>>().add(feather);
        let mesh = world.resource_mut::<Assets<Mesh>>().add(card_mesh(aspect));
        let owner = world.spawn_empty().id();
        let quality = FeatherQuality {
            transparency: FeatherTransparency::Blend,
            settings,
        };
        world.entity_mut(owner).insert((
            Mesh3d(mesh),
            Transform::IDENTITY,
            Visibility::default(),
            NoFrustumCulling,
            quality,
            PlumageCards::new(
                [card(aspect)],
                [CardGeometry {
                    first_vertex: 0,
                    vertex_count: 4,
                }],
                vec![handle],
            ),
        ));
        Some(Self {
            app,
            image,
            camera,
            light,
            size,
        })
    }

    /// Bytes that the plugin holds on the GPU for this feather and its card.
    pub fn bytes(&self) -> u64 {
        self.app.world().resource::<PlumageMemory>().total()
    }

    /// The plugin's picture of `view`, whose size is that of the studio.
    pub fn picture(&mut self, view: &View) -> Picture {
        assert_eq!(view.size, self.size);
        let vector = |v: [f64; 3]| Vec3::from_array(v.map(|x| x as f32));
        let target = vector([view.target[0], view.target[1], 0.0]);
        let side = (f64::from(view.size) * view.pixel) as f32;
        let world = self.app.world_mut();
        world.entity_mut(self.camera).insert((
            Transform::from_translation(target + 2.0 * vector(unit(view.eye)))
                .looking_at(target, Vec3::Y),
            Projection::Orthographic(OrthographicProjection {
                scaling_mode: ScalingMode::Fixed {
                    width: side,
                    height: side,
                },
                near: 0.01,
                far: 10.0,
                ..OrthographicProjection::default_3d()
            }),
        ));
        let up = if view.light[0].abs() + view.light[2].abs() > 1e-3 {
            Vec3::Y
        } else {
            Vec3::X
        };
        world
            .entity_mut(self.light)
            .insert(Transform::from_translation(vector(view.light)).looking_at(Vec3::ZERO, up));
        frames(&mut self.app, 4);
        let image = screenshot(&mut self.app, self.image.clone());
        (0..self.size * self.size)
            .map(|i| {
                let color = image
                    .get_color_at(i % self.size, i / self.size)
                    .unwrap()
                    .to_linear();
                [color.red, color.green, color.blue].map(f64::from)
            })
            .collect()
    }
}

fn card(aspect: f32) -> Card {
    Card {
        root: Vec3::ZERO,
        along: Vec3::Y,
        normal: Vec3::Z,
        center: Vec3::Y * 0.5,
        radius: 0.5 * 1.0_f32.hypot(aspect) * 1.1,
        length: 1.0,
        width: aspect,
        joints: [0; 4],
        weights: [1.0, 0.0, 0.0, 0.0],
        feather: 0,
        region: 0,
        layer: 0.0,
        tint: TINT.map(|t| t as f32),
        seed: 1,
        turn: 0.0,
        mirrored: false,
    }
}

fn card_mesh(aspect: f32) -> Mesh {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let place = |[u, v]: [f32; 2]| [(u - 0.5) * aspect, v, 0.0];
    Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::default(),
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, corners.map(place).to_vec())
    .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, vec![[0.0, 0.0, 1.0]; 4])
    .with_inserted_attribute(Mesh::ATTRIBUTE_TANGENT, vec![[0.0, 1.0, 0.0, -1.0]; 4])
    .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, corners.to_vec())
    .with_inserted_attribute(Mesh::ATTRIBUTE_UV_1, vec![[0.0_f32, 0.0]; 4])
    .with_inserted_indices(Indices::U32(vec![0, 1, 2, 0, 2, 3]))
}

/// Where the comparison is made: near (a barbule is several pixels wide), at the switch from resolved to averaged barbules,
/// far (the whole feather), all three from above, and obliquely at the switch. The light is to be filled in.
pub fn distances(feather: &Feather, size: u32) -> [(&'static str, View); 4] {
    use bevy_plumage::anatomy::Side;
    let x = -0.1 + f64::from(feather.rachis.curve[4] - 0.5) * f64::from(feather.aspect);
    let spacing = f64::from(feather.d_bl(Side::Left));
    let view = |pixel: f64, target: [f64; 2], eye: [f64; 3]| View {
        size,
        pixel,
        target,
        eye,
        light: [0.0, 0.0, 1.0],
    };
    let above = [0.0, 0.0, 1.0];
    [
        ("near", view(0.12 * spacing, [x, 0.6], above)),
        // Half a pixel's deviation reaches the chooser's 0.524 periods.
        ("switch", view(1.05 * spacing, [x, 0.6], above)),
        ("far", view(1.1 / f64::from(size), [0.0, 0.52], above)),
        ("oblique", view(0.7 * spacing, [x, 0.6], [0.7, -0.5, 0.8])),
    ]
}

/// Four lights: over the eye's shoulder, from the side, from the tip and low, from behind.
pub fn lights() -> [(&'static str, [f64; 3]); 4] {
    [
        ("front", [0.3, 0.4, 1.0]),
        ("side", [-1.0, 0.1, 0.5]),
        ("low", [0.2, 1.0, 0.25]),
        ("behind", [0.3, 0.2, -1.0]),
    ]
}
