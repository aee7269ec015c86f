//! Times WGSL functions on the GPU by timestamp queries.

use std::borrow::Cow;

/// Lanes of a workgroup: the pixels of a tile of 8 by 8.
pub const LANES: usize = 64;
/// Numbers of a case: nine of the cell, five of the footprint.
pub const CASE: usize = 14;
/// Outputs of a workgroup.
const OUTPUT: usize = LANES;

/// What every method's function `measured(cell, local)` is wrapped in. A workgroup is a tile of a picture whose pixels have the
/// case's footprint; every repetition is the tile to the right of the last. Nothing can be taken out of the loop, because the
/// footprint and the masking shift change in it.
const FRAME: &str = "
struct Run { repeat: u32, case_stride: u32, pad_x: u32, pad_y: u32 }
@group(0) @binding(0) var<storage, read> input: array<f32>;
@group(0) @binding(1) var<storage, read_write> output: array<f32>;
@group(0) @binding(2) var<uniform> run: Run;
@group(0) @binding(3) var picture: texture_2d<f32>;
@group(0) @binding(4) var smooth_sampler: sampler;

fn moved(cell: Cell, at: Local, right: f32, up: f32) -> Local {
    var local = at;
    let du = 2.0 * sqrt(at.variance) * right;
    let u = at.u + du;
    let k = floor(u);
    local.u = u - k;
    let tau = at.tau + at.slope * du + 2.0 * sqrt(at.conditional) * up - k * cell.e_root;
    local.tau = tau - floor(tau + 0.5);
    return local;
}

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_id) lane: vec3<u32>) {
    let index = 8u * lane.y + lane.x;
    let a = 14u * (group.x * run.case_stride + run.pad_x * index);
    var cell = Cell(input[a], input[a + 1u], input[a + 2u], input[a + 3u], input[a + 4u], input[a + 5u], input[a + 6u],
        input[a + 7u], input[a + 8u]);
    let at = Local(input[a + 9u], input[a + 10u], input[a + 11u], input[a + 12u], input[a + 13u]);
    var sum = 0.0;
    for (var i = 0u; i < run.repeat; i++) {
        let across = select(f32(lane.x) - 3.5, 0.0, run.pad_x == 1u);
        let up = select(f32(lane.y) - 3.5, 0.0, run.pad_x == 1u);
        let local = moved(cell, at, across + 8.0 * f32(i), up);
        let w = measured(cell, local);
        sum += w.x + w.y + w.z;
        cell.s_d += 0.001;
    }
    output[64u * group.x + index] = sum;
}
";

/// A GPU whose passes can be timed.
pub struct Gpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
    /// Name of the adapter.
    pub name: String,
    queries: wgpu::QuerySet,
    layout: wgpu::BindGroupLayout,
    picture: wgpu::TextureView,
    sampler: wgpu::Sampler,
}

/// A method compiled for the GPU.
pub struct Kernel(wgpu::ComputePipeline);

/// How the cases are spread over the lanes.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Spread {
    /// A tile per case.
    Tile,
    /// A case per lane.
    Lane,
}

impl Gpu {
    /// The first adapter with timestamps; `None` without one.
    pub fn open() -> Option<Self> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..Default::default()
        };
        let adapter = pollster::block_on(instance.request_adapter(&options)).ok()?;
        let info = adapter.get_info();
        let description = wgpu::DeviceDescriptor {
            required_features: wgpu::Features::TIMESTAMP_QUERY,
            required_limits: adapter.limits(),
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&description)).ok()?;
        let queries = device.create_query_set(&wgpu::QuerySetDescriptor {
            label: None,
            ty: wgpu::QueryType::Timestamp,
            count: 2,
        });
        let layout = layout(&device);
        let picture = picture(&device, &queue);
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            address_mode_u: wgpu::AddressMode::Repeat,
            address_mode_v: wgpu::AddressMode::Repeat,
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        });
        Some(Self {
            device,
            queue,
            name: info.name,
            queries,
            layout,
            picture,
            sampler,
        })
    }

    /// Compiles shader sources and a text that defines `measured(cell: Cell, local: Local) -> vec3<f32>`.
    pub fn kernel(&self, sources: Vec<(&str, String)>, text: &str) -> Kernel {
        let module = plumage_tests::gpu::compose_sources(sources, &format!("{text}\n{FRAME}"));
        let shader = self
            .device
            .create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some("query"),
                source: wgpu::ShaderSource::Naga(Cow::Owned(module)),
            });
        let layout = self
            .device
            .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: None,
                bind_group_layouts: &[Some(&self.layout)],
                immediate_size: 0,
            });
        Kernel(
            self.device
                .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                    label: Some("query"),
                    layout: Some(&layout),
                    module: &shader,
                    entry_point: Some("main"),
                    compilation_options: Default::default(),
                    cache: None,
                }),
        )
    }

    /// Seconds of one dispatch over the cases ([`CASE`] numbers each), and what each lane has added up.
    pub fn run(
        &self,
        kernel: &Kernel,
        input: &[f32],
        repeat: u32,
        spread: Spread,
    ) -> (f64, Vec<f32>) {
        let lanes = if spread == Spread::Lane { LANES } else { 1 };
        let groups = input.len() / CASE / lanes;
        let buffer = |size: usize, usage| {
            self.device.create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size: size as u64,
                usage,
                mapped_at_creation: false,
            })
        };
        use wgpu::BufferUsages as Usage;
        let bytes: Vec<u8> = input.iter().flat_map(|x| x.to_le_bytes()).collect();
        let size = groups.max(1) * OUTPUT * 4;
        let input_buffer = buffer(bytes.len().max(4), Usage::STORAGE | Usage::COPY_DST);
        let output_buffer = buffer(size, Usage::STORAGE | Usage::COPY_SRC);
        let run_buffer = buffer(16, Usage::UNIFORM | Usage::COPY_DST);
        let ticks_buffer = buffer(16, Usage::QUERY_RESOLVE | Usage::COPY_SRC);
        let read_buffer = buffer(size + 16, Usage::MAP_READ | Usage::COPY_DST);
        self.queue.write_buffer(&input_buffer, 0, &bytes);
        let run = [repeat, lanes as u32, u32::from(spread == Spread::Lane), 0];
        let run: Vec<u8> = run.iter().flat_map(|x| x.to_le_bytes()).collect();
        self.queue.write_buffer(&run_buffer, 0, &run);
        let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
        let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &self.layout,
            entries: &[
                entry(0, input_buffer.as_entire_binding()),
                entry(1, output_buffer.as_entire_binding()),
                entry(2, run_buffer.as_entire_binding()),
                entry(3, wgpu::BindingResource::TextureView(&self.picture)),
                entry(4, wgpu::BindingResource::Sampler(&self.sampler)),
            ],
        });
        let mut encoder = self.device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: None,
                timestamp_writes: Some(wgpu::ComputePassTimestampWrites {
                    query_set: &self.queries,
                    beginning_of_pass_write_index: Some(0),
                    end_of_pass_write_index: Some(1),
                }),
            });
            pass.set_pipeline(&kernel.0);
            pass.set_bind_group(0, &group, &[]);
            pass.dispatch_workgroups(groups as u32, 1, 1);
        }
        encoder.resolve_query_set(&self.queries, 0..2, &ticks_buffer, 0);
        encoder.copy_buffer_to_buffer(&output_buffer, 0, &read_buffer, 0, size as u64);
        encoder.copy_buffer_to_buffer(&ticks_buffer, 0, &read_buffer, size as u64, 16);
        self.queue.submit([encoder.finish()]);
        let slice = read_buffer.slice(..);
        slice.map_async(wgpu::MapMode::Read, |_| {});
        let _ = self.device.poll(wgpu::PollType::Wait {
            submission_index: None,
            timeout: None,
        });
        let data = slice.get_mapped_range();
        let (values, ticks) = data.split_at(size);
        let (ticks, _) = ticks.as_chunks::<8>();
        let (values, _) = values.as_chunks::<4>();
        let [from, to] = [ticks[0], ticks[1]].map(u64::from_le_bytes);
        let seconds =
            to.saturating_sub(from) as f64 * f64::from(self.queue.get_timestamp_period()) * 1e-9;
        let values = values.iter().map(|b| f32::from_le_bytes(*b)).collect();
        (seconds, values)
    }
}

fn layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty,
        count: None,
    };
    let buffer = |ty| wgpu::BindingType::Buffer {
        ty,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    let storage = |read_only| buffer(wgpu::BufferBindingType::Storage { read_only });
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: None,
        entries: &[
            entry(0, storage(true)),
            entry(1, storage(false)),
            entry(2, buffer(wgpu::BufferBindingType::Uniform)),
            entry(
                3,
                wgpu::BindingType::Texture {
                    sample_type: wgpu::TextureSampleType::Float { filterable: true },
                    view_dimension: wgpu::TextureViewDimension::D2,
                    multisampled: false,
                },
            ),
            entry(
                4,
                wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
            ),
        ],
    })
}

/// A picture of 512 by 512 with all its mip levels, for the price of a texture fetch.
fn picture(device: &wgpu::Device, queue: &wgpu::Queue) -> wgpu::TextureView {
    let size = wgpu::Extent3d {
        width: 512,
        height: 512,
        depth_or_array_layers: 1,
    };
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size,
        mip_level_count: 10,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8Unorm,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for level in 0..10u32 {
        let side = 512u32 >> level;
        let texels: Vec<u8> = (0..side * side)
            .flat_map(|i| (i.wrapping_mul(2_654_435_761) ^ level).to_le_bytes())
            .collect();
        queue.write_texture(
            wgpu::TexelCopyTextureInfo {
                texture: &texture,
                mip_level: level,
                origin: wgpu::Origin3d::ZERO,
                aspect: wgpu::TextureAspect::All,
            },
            &texels,
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(4 * side),
                rows_per_image: None,
            },
            wgpu::Extent3d {
                width: side,
                height: side,
                depth_or_array_layers: 1,
            },
        );
    }
    texture.create_view(&Default::default())
}
