//! Runs a WGSL function over an array on the GPU and reads the results back.
//!
//! A test hands over the shader files it needs (in any order), a text that imports from them and defines
//! `fn evaluate(i: u32)`, and the input. The text reads `input[...]` and writes `output[...]`, both arrays of `f32`:
//!
//! ```ignore
//! let files = ["math.wgsl"];
//! let text = "#import bevy_plumage::math::{error_function}\n
//!             fn evaluate(i: u32) { output[i] = error_function(input[i]); }";
//! let Some(result) = run(&files, text, &input, input.len(), input.len()) else { return };
//! ```

use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga_oil::compose::{ComposableModuleDescriptor, Composer, NagaModuleDescriptor};
use std::{borrow::Cow, path::PathBuf, sync::OnceLock};

/// What every text is wrapped in: the two buffers and the entry point.
const FRAME: &str = "
struct HarnessSize { count: u32, pad_x: u32, pad_y: u32, pad_z: u32 }
@group(0) @binding(0) var<storage, read> input: array<f32>;
@group(0) @binding(1) var<storage, read_write> output: array<f32>;
@group(0) @binding(2) var<uniform> harness_size: HarnessSize;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < harness_size.count {
        evaluate(id.x);
    }
}
";

/// Text of a file in `src/shaders`.
pub fn shader_source(file: &str) -> String {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("src/shaders")
        .join(file);
    std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// The `#define_import_path` of a module, and the modules it imports.
fn header(source: &str) -> (String, Vec<String>) {
    let mut name = String::new();
    let mut imports = Vec::new();
    for line in source.lines().map(str::trim) {
        if let Some(rest) = line.strip_prefix("#define_import_path") {
            name = rest.trim().to_owned();
        } else if let Some(rest) = line.strip_prefix("#import") {
            let path = rest.trim().split('{').next().unwrap_or("");
            imports.push(path.trim().trim_end_matches("::").to_owned());
        }
    }
    (name, imports)
}

/// Composes shader files (names in `src/shaders`, any order) and a text with an entry point into one validated module.
///
/// Panics with naga's own message where a file does not compile: that is the test's failure.
pub fn compose(files: &[&str], text: &str) -> naga::Module {
    compose_sources(files.iter().map(|f| (*f, shader_source(f))).collect(), text)
}

/// The same from texts, each with a name for messages.
pub fn compose_sources(mut waiting: Vec<(&str, String)>, text: &str) -> naga::Module {
    let mut composer = Composer::default();
    while !waiting.is_empty() {
        // A module can be added once those it imports are there (an import may name an item of a module too).
        let ready = waiting.iter().position(|(_, source)| {
            header(source).1.iter().all(|path| {
                !waiting.iter().any(|(_, other)| {
                    let name = header(other).0;
                    path == &name || path.starts_with(&format!("{name}::"))
                })
            })
        });
        let (file, source) =
            waiting.remove(ready.expect("shader files import each other in a circle"));
        let added = composer
            .add_composable_module(ComposableModuleDescriptor {
                source: &source,
                file_path: file,
                ..Default::default()
            })
            .map(|_| ());
        if let Err(e) = added {
            panic!("{file}: {}", e.emit_to_string(&composer));
        }
    }
    let made = composer.make_naga_module(NagaModuleDescriptor {
        source: text,
        file_path: "test entry",
        ..Default::default()
    });
    let module = made.unwrap_or_else(|e| panic!("{}", e.emit_to_string(&composer)));
    if let Err(e) = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module)
    {
        panic!("composed module: {e:?}");
    }
    module
}

/// The adapter's device, shared by the tests of one binary; `None` if this machine has no adapter.
fn device() -> Option<&'static (wgpu::Device, wgpu::Queue, String)> {
    static DEVICE: OnceLock<Option<(wgpu::Device, wgpu::Queue, String)>> = OnceLock::new();
    DEVICE
        .get_or_init(|| {
            let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
                backends: wgpu::Backends::all(),
                flags: wgpu::InstanceFlags::default(),
                memory_budget_thresholds: Default::default(),
                backend_options: Default::default(),
                display: None,
            });
            let options = wgpu::RequestAdapterOptions {
                power_preference: wgpu::PowerPreference::HighPerformance,
                ..Default::default()
            };
            let adapter = pollster::block_on(instance.request_adapter(&options)).ok()?;
            let info = adapter.get_info();
            let limits = adapter.limits();
            let description = wgpu::DeviceDescriptor {
                required_limits: limits,
                ..Default::default()
            };
            let (device, queue) = pollster::block_on(adapter.request_device(&description)).ok()?;
            Some((
                device,
                queue,
                format!("{} ({:?})", info.name, info.device_type),
            ))
        })
        .as_ref()
}

/// Name of the adapter, for messages.
pub fn adapter_name() -> Option<&'static str> {
    device().map(|(_, _, name)| name.as_str())
}

/// Evaluates `text`'s `evaluate(i)` for `i` in `0..count` and returns the `output_length` values of `output`.
///
/// `None`, with a message, where the machine has no GPU adapter at all; a shader that does not compile panics either way.
pub fn run(
    files: &[&str],
    text: &str,
    input: &[f32],
    count: usize,
    output_length: usize,
) -> Option<Vec<f32>> {
    let module = compose(files, &format!("{text}\n{FRAME}"));
    let Some((device, queue, _)) = device() else {
        eprintln!(
            "skipped: no GPU adapter on this machine (install a Vulkan driver, e.g. Mesa's lavapipe)"
        );
        return None;
    };
    assert!(
        count.div_ceil(64) <= 65_535,
        "too many items for one dispatch: {count}"
    );
    let shader = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("test"),
        source: wgpu::ShaderSource::Naga(Cow::Owned(module)),
    });
    let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer {
            ty,
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    };
    let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: None,
        entries: &[
            entry(0, wgpu::BufferBindingType::Storage { read_only: true }),
            entry(1, wgpu::BufferBindingType::Storage { read_only: false }),
            entry(2, wgpu::BufferBindingType::Uniform),
        ],
    });
    let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &[Some(&layout)],
        immediate_size: 0,
    });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some("test"),
        layout: Some(&pipeline_layout),
        module: &shader,
        entry_point: Some("main"),
        compilation_options: Default::default(),
        cache: None,
    });
    let buffer = |size: usize, usage| {
        device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: size as u64,
            usage,
            mapped_at_creation: false,
        })
    };
    let bytes: Vec<u8> = input.iter().flat_map(|x| x.to_le_bytes()).collect();
    let output_size = output_length.max(1) * 4;
    let input_buffer = buffer(
        bytes.len().max(4),
        wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
    );
    let output_buffer = buffer(
        output_size,
        wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
    );
    let size_buffer = buffer(
        16,
        wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
    );
    let read_buffer = buffer(
        output_size,
        wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
    );
    queue.write_buffer(&input_buffer, 0, &bytes);
    let mut size = [0u8; 16];
    size[..4].copy_from_slice(&(count as u32).to_le_bytes());
    queue.write_buffer(&size_buffer, 0, &size);
    let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &layout,
        entries: &[
            wgpu::BindGroupEntry {
                binding: 0,
                resource: input_buffer.as_entire_binding(),
            },
            wgpu::BindGroupEntry {
                binding: 1,
                resource: output_buffer.as_entire_binding(),
            },
            wgpu::BindGroupEntry {
                binding: 2,
                resource: size_buffer.as_entire_binding(),
            },
        ],
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &bind_group, &[]);
        pass.dispatch_workgroups((count as u32).div_ceil(64).max(1), 1, 1);
    }
    encoder.copy_buffer_to_buffer(&output_buffer, 0, &read_buffer, 0, output_size as u64);
    queue.submit([encoder.finish()]);
    let slice = read_buffer.slice(..);
    slice.map_async(wgpu::MapMode::Read, |result| {
        result.expect("the result buffer maps")
    });
    device
        .poll(wgpu::PollType::Wait {
            submission_index: None,
            timeout: None,
        })
        .expect("the GPU finishes");
    let data = slice.get_mapped_range();
    let (chunks, _) = data.as_chunks::<4>();
    Some(
        chunks
            .iter()
            .take(output_length)
            .map(|b| f32::from_le_bytes(*b))
            .collect(),
    )
}
