//! How long a GPU works at a frame: from the first of its passes to the end of the last, shadow maps included. (Bevy's diagnostics time
//! passes one by one, and those of shadow maps not at all.)

use bevy::{
    ecs::system::SystemParam,
    prelude::*,
    render::{
        GpuResourceAppExt, RenderApp,
        render_resource::{
            Buffer, BufferDescriptor, BufferUsages, CommandEncoder, CommandEncoderDescriptor,
            MapMode, PollType, WgpuFeatures,
        },
        renderer::{
            PendingCommandBuffers, RenderDevice, RenderGraph, RenderGraphSystems, RenderQueue,
        },
    },
};
use wgpu::{QUERY_SIZE, QuerySet, QuerySetDescriptor, QueryType};

/// Times every frame where the device can; see [`seconds`].
pub struct GpuClockPlugin;

/// Timestamps of a frame's begin and end.
#[derive(Resource)]
struct GpuClock(Option<Stamps>);

struct Stamps {
    queries: QuerySet,
    resolved: Buffer,
    read: Buffer,
    /// Nanoseconds of a tick.
    period: f32,
}

const BYTES: u64 = 2 * QUERY_SIZE as u64;

impl FromWorld for GpuClock {
    fn from_world(world: &mut World) -> Self {
        let device = world.resource::<RenderDevice>();
        let needed = WgpuFeatures::TIMESTAMP_QUERY | WgpuFeatures::TIMESTAMP_QUERY_INSIDE_ENCODERS;
        if !device.features().contains(needed) {
            return Self(None);
        }
        let buffer = |usage| {
            device.create_buffer(&BufferDescriptor {
                label: Some("gpu_clock"),
                size: BYTES,
                usage,
                mapped_at_creation: false,
            })
        };
        Self(Some(Stamps {
            queries: device.wgpu_device().create_query_set(&QuerySetDescriptor {
                label: Some("gpu_clock"),
                ty: QueryType::Timestamp,
                count: 2,
            }),
            resolved: buffer(BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC),
            read: buffer(BufferUsages::COPY_DST | BufferUsages::MAP_READ),
            period: world.resource::<RenderQueue>().get_timestamp_period(),
        }))
    }
}

impl Plugin for GpuClockPlugin {
    fn build(&self, _app: &mut App) {}

    fn finish(&self, app: &mut App) {
        let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
            return;
        };
        render_app.init_gpu_resource::<GpuClock>().add_systems(
            RenderGraph,
            (
                begin
                    .after(RenderGraphSystems::Begin)
                    .before(RenderGraphSystems::Render),
                end.after(RenderGraphSystems::Render)
                    .before(RenderGraphSystems::Submit),
            ),
        );
    }
}

/// What records the commands of a stamp: between those of the frame.
#[derive(SystemParam)]
struct Recorder<'w> {
    clock: Res<'w, GpuClock>,
    device: Res<'w, RenderDevice>,
    pending: ResMut<'w, PendingCommandBuffers>,
}

impl Recorder<'_> {
    fn record(&mut self, commands: impl FnOnce(&Stamps, &mut CommandEncoder)) {
        let Some(stamps) = &self.clock.0 else {
            return;
        };
        let mut encoder = self
            .device
            .create_command_encoder(&CommandEncoderDescriptor::default());
        commands(stamps, &mut encoder);
        self.pending.push([encoder.finish()]);
    }
}

fn begin(mut recorder: Recorder) {
    recorder.record(|stamps, encoder| encoder.write_timestamp(&stamps.queries, 0));
}

fn end(mut recorder: Recorder) {
    recorder.record(|stamps, encoder| {
        encoder.write_timestamp(&stamps.queries, 1);
        encoder.resolve_query_set(&stamps.queries, 0..2, &stamps.resolved, 0);
        encoder.copy_buffer_to_buffer(&stamps.resolved, 0, &stamps.read, 0, BYTES);
    });
}

/// GPU seconds of the last frame, which the GPU must have finished. `None`: the device has no clock.
pub fn seconds(app: &App) -> Option<f64> {
    let world = app.get_sub_app(RenderApp)?.world();
    let stamps = world.get_resource::<GpuClock>()?.0.as_ref()?;
    stamps.read.slice(..).map_async(MapMode::Read, |_| ());
    let all = PollType::Wait {
        submission_index: None,
        timeout: None,
    };
    let device = world.resource::<RenderDevice>().wgpu_device();
    device.poll(all).ok()?;
    let ticks: Vec<u64> = {
        let bytes = stamps.read.slice(..).get_mapped_range();
        let (ticks, _) = bytes.as_chunks::<8>();
        ticks.iter().copied().map(u64::from_le_bytes).collect()
    };
    stamps.read.unmap();
    let spent = ticks[1].saturating_sub(ticks[0]);
    Some(spent as f64 * f64::from(stamps.period) * 1e-9)
}
