//! Runs a WGSL function over an array on the GPU and reads the results back.
//!
//! A test hands over the shader files it needs (what they import is found by its name), a text that imports from them and defines
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
use std::{
    borrow::Cow,
    io::Write,
    sync::{OnceLock, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard},
};

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

/// Text of a shader of the library or of the references, by the name of its file.
pub fn shader_source(file: &str) -> String {
    const ROOMS: [&str; 5] = [
        "src/shaders/maths",
        "src/shaders/card",
        "src/shaders/undercoat",
        "src/shaders/comparison",
        "crates/plumage_reference/shaders",
    ];
    let path = ROOMS
        .map(|room| crate::root().join(room).join(file))
        .into_iter()
        .find(|path| path.exists())
        .unwrap_or_else(|| panic!("no shader {file} in {ROOMS:?}"));
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

/// Composes shader files (names in `src/shaders`, any order), what they import and a text with an entry point into one validated
/// module.
///
/// Panics with naga's own message where a file does not compile: that is the test's failure.
pub fn compose(files: &[&str], text: &str) -> naga::Module {
    let mut sources: Vec<(String, String)> = Vec::new();
    let mut wanted: Vec<String> = files.iter().map(|file| (*file).to_owned()).collect();
    while let Some(file) = wanted.pop() {
        if sources.iter().any(|(known, _)| *known == file) {
            continue;
        }
        let source = shader_source(&file);
        wanted.extend(header(&source).1.iter().filter_map(|path| {
            // A file is named as the last part of its import path.
            let rest = path.strip_prefix("bevy_plumage::")?;
            Some(format!("{}.wgsl", rest.split("::").next()?))
        }));
        sources.push((file, source));
    }
    let named = sources
        .iter()
        .map(|(file, source)| (file.as_str(), source.clone()));
    compose_sources(named.collect(), text)
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

/// The environment variable that says, as `1`, that this machine has no GPU: what needs one is then skipped, with a word on stderr.
pub const NO_GPU: &str = "PLUMAGE_NO_GPU";

/// What the tests of the GPU do: run on what `find` finds, or be skipped (`None`) where `told`, the value of [`NO_GPU`], is `1`.
///
/// Without an adapter they fail, unless they are told: a driver that does not work must not look like a test that passes.
pub fn decide<T>(
    told: Option<&str>,
    find: impl FnOnce() -> Result<T, String>,
) -> Result<Option<T>, String> {
    match told {
        Some("1") => Ok(None),
        None | Some("" | "0") => find().map(Some).map_err(|cause| {
            format!(
                "no usable GPU adapter: {cause}. Install a Vulkan driver (Mesa's lavapipe needs no GPU), or set {NO_GPU}=1 to skip \
                 what needs one"
            )
        }),
        Some(value) => Err(format!("{NO_GPU} is `{value}`, allowed are 0 and 1")),
    }
}

/// Held while devices are made or dropped, shared while they draw.
static DEVICES: RwLock<()> = RwLock::new(());

/// While it is held, no other thread makes, drops or drives a device: for one that makes or drops its own.
///
/// Loaders of Vulkan up to 1.4.341 free what they know of a device without the lock under which other threads search it
/// (KhronosGroup/Vulkan-Loader, issue 2018): a test that begins as another ends may find its heap corrupted.
pub fn alone() -> RwLockWriteGuard<'static, ()> {
    DEVICES.write().unwrap_or_else(PoisonError::into_inner)
}

/// While it is held, no other thread makes or drops a device: for one that drives its own.
pub fn together() -> RwLockReadGuard<'static, ()> {
    DEVICES.read().unwrap_or_else(PoisonError::into_inner)
}

/// A device that tests may use.
pub struct Gpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
    name: String,
}

fn find() -> Result<Gpu, String> {
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
    let adapter =
        pollster::block_on(instance.request_adapter(&options)).map_err(|e| e.to_string())?;
    let info = adapter.get_info();
    let description = wgpu::DeviceDescriptor {
        required_limits: adapter.limits(),
        ..Default::default()
    };
    let (device, queue) = pollster::block_on(adapter.request_device(&description))
        .map_err(|e| format!("{}: {e}", info.name))?;
    Ok(Gpu {
        device,
        queue,
        name: format!("{} ({:?})", info.name, info.device_type),
    })
}

/// The device, shared by the tests of one binary. Everything that needs a GPU comes here first.
///
/// `None`, said on stderr, where [`NO_GPU`] is set.
///
/// # Panics
/// Without a usable adapter.
pub fn device() -> Option<&'static Gpu> {
    static DEVICE: OnceLock<Result<Option<Gpu>, String>> = OnceLock::new();
    let decided = DEVICE.get_or_init(|| {
        let _alone = alone();
        decide(std::env::var(NO_GPU).ok().as_deref(), find)
    });
    match decided {
        Ok(Some(gpu)) => Some(gpu),
        Ok(None) => {
            let test = std::thread::current();
            let test = test.name().unwrap_or("a thread");
            // Past the capture of a test that passes.
            let _ = writeln!(std::io::stderr(), "{test}: skipped, {NO_GPU} is set");
            None
        }
        Err(message) => panic!("{message}"),
    }
}

/// Name of the adapter, for messages.
pub fn adapter_name() -> Option<&'static str> {
    device().map(|gpu| gpu.name.as_str())
}

/// Evaluates `text`'s `evaluate(i)` for `i` in `0..count` and returns the `output_length` values of `output`.
///
/// `None` as in [`device`]; a shader that does not compile panics either way.
pub fn run(
    files: &[&str],
    text: &str,
    input: &[f32],
    count: usize,
    output_length: usize,
) -> Option<Vec<f32>> {
    let module = compose(files, &format!("{text}\n{FRAME}"));
    let Gpu { device, queue, .. } = device()?;
    let _together = together();
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_an_adapter_tests_fail_unless_they_are_told() {
        let none = || Err::<(), _>("no driver".to_owned());
        let one = || Ok::<_, String>("a device");
        for told in [None, Some(""), Some("0")] {
            assert_eq!(decide(told, one), Ok(Some("a device")));
            let message = decide(told, none).unwrap_err();
            assert!(
                message.contains("no driver") && message.contains("PLUMAGE_NO_GPU=1"),
                "{message}"
            );
        }
        // Told, they do not even look.
        let looked = || -> Result<(), String> { panic!("looked for an adapter") };
        assert_eq!(decide(Some("1"), looked), Ok(None));
        // A value that means nothing skips nothing.
        assert!(decide(Some("yes"), one).is_err());
    }
}
