//! A Bevy app that renders off screen, for tests of whole pictures.

use crate::{gpu, headless, wait};
use bevy::{
    camera::{Exposure, Hdr, RenderTarget},
    core_pipeline::tonemapping::Tonemapping,
    light::EnvironmentMapLight,
    mesh::{
        Indices, PrimitiveTopology, VertexAttributeValues,
        skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    },
    prelude::*,
    render::{
        RenderApp, RenderPlugin,
        diagnostic::RenderDiagnosticsPlugin,
        pipelined_rendering::PipelinedRenderingPlugin,
        render_resource::{PipelineCache, PollType, TextureFormat, TextureUsages},
        renderer::RenderDevice,
        settings::{RenderCreation, WgpuSettings},
        view::screenshot::{Screenshot, ScreenshotCaptured},
    },
    time::TimeUpdateStrategy,
};
use bevy_plumage::groom::PlumageCards;
use bevy_plumage::prelude::*;
use std::{
    sync::{Arc, Mutex},
    time::Duration,
};

/// Side of the test pictures.
pub const SIZE: u32 = 96;

/// One frame of an app, drawn [`gpu::together`] and finished; fails if the renderer has stopped.
pub fn frame(app: &mut App) {
    let _together = gpu::together();
    app.update();
    let device = app.world().resource::<RenderDevice>();
    let _ = device.wgpu_device().poll(PollType::Wait {
        submission_index: None,
        timeout: None,
    });
    assert!(app.should_exit().is_none(), "the renderer stopped");
}

/// Whether pipelines wait for their shaders, which load beside the frames.
pub fn compiles(app: &App) -> bool {
    let render_world = app.get_sub_app(RenderApp).unwrap().world();
    let cache = render_world.resource::<PipelineCache>();
    cache.waiting_pipelines().next().is_some()
}

/// Whether cards wait for their material, as they do for the image of a feather.
fn waits_for_material(app: &mut App) -> bool {
    let mut bare = app.world_mut().query_filtered::<&PlumageCards, (
        Without<MeshMaterial3d<FeatherMaterial>>,
        Without<MeshMaterial3d<StandardMaterial>>,
    )>();
    bare.iter(app.world()).any(|worn| !worn.cards.is_empty())
}

/// `count` frames after the last in which a material or a pipeline was not there yet: what has changed is drawn.
pub fn frames(app: &mut App, count: u32) {
    let mut still = 0;
    while still < count {
        wait::until("a material or a pipeline", || {
            frame(app);
            let waits = compiles(app) || waits_for_material(app);
            still = if waits { 0 } else { still + 1 };
            (!waits).then_some(())
        });
    }
}

/// Asks for what the next frame draws to `image`; a worker thread hands it over some frames later.
fn ask(app: &mut App, image: Handle<Image>) -> Arc<Mutex<Option<Image>>> {
    let got: Arc<Mutex<Option<Image>>> = Arc::default();
    let keep = got.clone();
    app.world_mut()
        .spawn(Screenshot::image(image))
        .observe(move |shot: On<ScreenshotCaptured>| {
            *keep.lock().unwrap() = Some(shot.image.clone());
        });
    got
}

/// What the next frame draws to `image`. Reading it back takes further frames.
pub fn screenshot(app: &mut App, image: Handle<Image>) -> Image {
    let got = ask(app, image);
    wait::until("the picture", || {
        frame(app);
        got.lock().unwrap().take()
    })
}

/// An app with a device of its own, which is made and dropped [`gpu::alone`].
#[derive(Deref, DerefMut)]
pub struct DrawingApp(App);

impl DrawingApp {
    /// Off screen, with the plugins of this package, one frame after the other and pipelines compiled when they are first asked
    /// for; `build` has a hand in it before it starts. None where [`gpu::device`] is.
    pub fn start(settings: WgpuSettings, build: impl FnOnce(&mut App)) -> Option<Self> {
        gpu::device()?;
        let render = RenderPlugin {
            synchronous_pipeline_compilation: true,
            render_creation: RenderCreation::Automatic(Box::new(settings)),
            ..default()
        };
        let _alone = gpu::alone();
        let mut app = App::new();
        app.add_plugins((
            headless::plugins(render).disable::<PipelinedRenderingPlugin>(),
            PlumagePlugins,
        ))
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(
            16,
        )))
        .insert_resource(ClearColor(Color::BLACK));
        build(&mut app);
        headless::finish(&mut app);
        Some(Self(app))
    }
}

impl Drop for DrawingApp {
    fn drop(&mut self) {
        let _alone = gpu::alone();
        self.0 = App::empty();
    }
}

/// An app with an off-screen camera that looks along -z at the origin.
pub struct Stage {
    /// The app.
    pub app: DrawingApp,
    /// What the camera draws to.
    pub image: Handle<Image>,
    /// The camera.
    pub camera: Entity,
    /// Width and height of the pictures.
    pub size: (u32, u32),
}

impl Stage {
    /// None where [`gpu::device`] is.
    pub fn new() -> Option<Self> {
        Self::sized(SIZE, SIZE)
    }

    /// The same with pictures of another size.
    pub fn sized(width: u32, height: u32) -> Option<Self> {
        Self::custom(WgpuSettings::default(), (width, height), |_| {})
    }

    /// With these settings of the device, and an app that `build` has had a hand in before it starts.
    pub fn with(settings: WgpuSettings, build: impl FnOnce(&mut App)) -> Option<Self> {
        Self::custom(settings, (SIZE, SIZE), build)
    }

    fn custom(
        settings: WgpuSettings,
        (width, height): (u32, u32),
        build: impl FnOnce(&mut App),
    ) -> Option<Self> {
        let mut app = DrawingApp::start(settings, |app| {
            app.add_plugins(RenderDiagnosticsPlugin);
            build(app);
        })?;
        let mut image =
            Image::new_target_texture(width, height, TextureFormat::Rgba8UnormSrgb, None);
        image.texture_descriptor.usage |= TextureUsages::COPY_SRC;
        let image = app.world_mut().resource_mut::<Assets<Image>>().add(image);
        let light = EnvironmentMapLight {
            intensity: 1000.0,
            ..EnvironmentMapLight::solid_color(
                &mut app.world_mut().resource_mut::<Assets<Image>>(),
                Color::WHITE,
            )
        };
        let camera = app
            .world_mut()
            .spawn((
                Camera3d::default(),
                Hdr,
                Msaa::Sample4,
                Tonemapping::None,
                Exposure { ev100: 9.7 },
                RenderTarget::Image(image.clone().into()),
                Transform::from_xyz(0.0, 0.0, 0.5).looking_at(Vec3::ZERO, Vec3::Y),
                light,
            ))
            .id();
        app.world_mut().spawn((
            DirectionalLight {
                illuminance: 2000.0,
                shadow_maps_enabled: true,
                ..default()
            },
            Transform::from_xyz(0.5, 1.0, 1.0).looking_at(Vec3::ZERO, Vec3::Y),
        ));
        Some(Self {
            app,
            image,
            camera,
            size: (width, height),
        })
    }

    /// One frame, finished on the GPU; fails if the renderer has stopped.
    pub fn frame(&mut self) {
        frame(&mut self.app);
    }

    /// [`frames`] of the app.
    pub fn frames(&mut self, count: u32) {
        frames(&mut self.app, count);
    }

    /// Frames until every bird is ready and drawn; fails if one cannot be groomed.
    pub fn settle(&mut self) {
        // An edit of an asset is told in the frame after it.
        self.frame();
        wait::until("the groom", || {
            self.frame();
            let mut states = self.app.world_mut().query::<&PlumageState>();
            let mut all_ready = true;
            for state in states.iter(self.app.world()) {
                assert_eq!(state.error, None, "a bird without feathers");
                all_ready &= state.is_ready();
            }
            all_ready.then_some(())
        });
        // Mesh, material and pipelines come one after the other.
        self.frames(4);
    }

    /// The next frame. The camera rests while it is read back: for cameras that jump from picture to picture.
    pub fn still(&mut self) -> Image {
        let got = ask(&mut self.app, self.image.clone());
        self.frame();
        let awake = |stage: &mut Self, is: bool| {
            if let Some(mut camera) = stage.app.world_mut().get_mut::<Camera>(stage.camera) {
                camera.is_active = is;
            }
        };
        awake(self, false);
        let image = wait::until("the picture", || {
            let image = got.lock().unwrap().take();
            if image.is_none() {
                self.frame();
            }
            image
        });
        awake(self, true);
        image
    }

    /// The picture of the next frame, linear RGB rows.
    pub fn picture(&mut self) -> Vec<[f32; 3]> {
        let image = self.image.clone();
        let image = screenshot(&mut self.app, image);
        let (width, height) = self.size;
        let pixel = |i: u32| {
            let color = image
                .get_color_at(i % width, i / width)
                .unwrap()
                .to_linear();
            [color.red, color.green, color.blue]
        };
        (0..width * height).map(pixel).collect()
    }

    /// A skinned square of 0.2 m facing the camera, on one joint.
    pub fn spawn_skin(&mut self) -> Entity {
        let n = 9u32;
        let place = |i: u32| (i as f32 / (n - 1) as f32 - 0.5) * 0.2;
        let positions: Vec<[f32; 3]> = (0..n * n)
            .map(|i| [place(i % n), place(i / n), 0.0])
            .collect();
        let count = positions.len();
        let mut indices = Vec::new();
        for y in 0..n - 1 {
            for x in 0..n - 1 {
                let k = y * n + x;
                indices.extend([k, k + 1, k + n + 1, k, k + n + 1, k + n]);
            }
        }
        let mesh = Mesh::new(PrimitiveTopology::TriangleList, default())
            .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
            .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, vec![[0.0, 0.0, 1.0]; count])
            .with_inserted_attribute(
                Mesh::ATTRIBUTE_JOINT_INDEX,
                VertexAttributeValues::Uint16x4(vec![[0; 4]; count]),
            )
            .with_inserted_attribute(
                Mesh::ATTRIBUTE_JOINT_WEIGHT,
                vec![[1.0, 0.0, 0.0, 0.0]; count],
            )
            .with_inserted_indices(Indices::U32(indices));
        let world = self.app.world_mut();
        let mesh = world.resource_mut::<Assets<Mesh>>().add(mesh);
        let inverse_bindposes = world
            .resource_mut::<Assets<SkinnedMeshInverseBindposes>>()
            .add(SkinnedMeshInverseBindposes::from(vec![Mat4::IDENTITY]));
        let joint = world.spawn((Transform::IDENTITY, Name::new("joint"))).id();
        world
            .spawn((
                Mesh3d(mesh),
                Transform::IDENTITY,
                Visibility::default(),
                SkinnedMesh {
                    inverse_bindposes,
                    joints: vec![joint],
                },
            ))
            .add_child(joint)
            .id()
    }
}
