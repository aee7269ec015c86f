//! Time of one fibre and one light by each evaluator, on the CPU (criterion) and on the GPU (timestamps of a compute pass).
#![allow(missing_docs)]

use bevy_plumage::maths::scattering::*;
use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use plumage_tests::gpu;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::{borrow::Cow, hint::black_box};

/// Nodes of the quadrature over h.
const NODES: usize = 64;

fn fibre() -> Fibre {
    Fibre {
        kind: FibreKind::Structural { core_radius: 0.5 },
        azimuthal_roughness: 0.3,
        ..Fibre::default()
    }
}

fn directions(count: usize) -> Vec<[f32; 3]> {
    let mut random = Pcg64Mcg::seed_from_u64(3);
    (0..count)
        .map(|_| {
            let z = 2.0 * random.random::<f32>() - 1.0;
            let (s, c) = (std::f32::consts::TAU * random.random::<f32>()).sin_cos();
            let r = (1.0 - z * z).sqrt();
            [r * c, r * s, z]
        })
        .collect()
}

/// K of one light by the midpoint rule over h: attenuation, exit angle and a wrapped Gaussian per lobe and node.
fn quadrature(
    p: &FibreParameters<f32>,
    color: &FibreColor<f32>,
    o: [f32; 3],
    i: [f32; 3],
) -> [f32; 3] {
    let cos = |d: [f32; 3]| (d[1] * d[1] + d[2] * d[2]).sqrt();
    let phi = i[1].atan2(i[2]) - o[1].atan2(o[2]);
    let beta = p.azimuthal_roughness;
    let m = [Lobe::R, Lobe::TT, Lobe::TRT, Lobe::TRcT].map(|lobe| {
        let eye = fold(o[0].asin() - lobe_shift(lobe, p.tilt, p.eta)).sin_cos();
        let width = lobe_width(lobe, p.longitudinal_roughness, p.eta);
        longitudinal(eye, (i[0], cos(i)), width)
    });
    let mut sum = [0.0; 3];
    for k in 0..NODES {
        let c = crossing(p.eta, cos(o), 2.0 * (k as f32 + 0.5) / NODES as f32 - 1.0);
        for (lobe, kind) in [Lobe::R, Lobe::TT, Lobe::TRT, Lobe::TRcT]
            .into_iter()
            .enumerate()
        {
            let x = phi - exit_angle(kind, &c, p.core);
            let x = x - std::f32::consts::TAU * (x / std::f32::consts::TAU).round();
            let d = (-0.5 * (x / beta).powi(2)).exp() / (beta * 2.506_628_3);
            for (ch, sum) in sum.iter_mut().enumerate() {
                let core = Some((p.core, color.core[ch]));
                let a = attenuation(&c, core, (0.0, 0.0), color.absorption[ch]);
                *sum += a[lobe] * d * m[lobe] / NODES as f32;
            }
        }
    }
    sum
}

fn lights(c: &mut Criterion) {
    let table = FibreTable::build(&fibre());
    let [a, b, d, ..] = table.pack_parameters();
    let p = fibre_parameters(a, b, d);
    let o = [0.3, 0.4, 0.866_025_4_f32];
    let row = table
        .row(f64::from((1.0 - o[0] * o[0]).sqrt()))
        .map(|v| v.map(|x| x as f32));
    let albedo = [0.6, 0.3, 0.1];
    let set = directions(512);
    let mut next = (0..set.len()).cycle();
    let mut group = c.benchmark_group("one light");
    let mut bench = |name: &str, f: &dyn Fn([f32; 3]) -> [f32; 3]| {
        group.bench_function(name, |bencher| {
            bencher.iter_batched(
                || set[next.next().unwrap_or(0)],
                |light| black_box(f(light)),
                BatchSize::SmallInput,
            );
        });
    };
    let color = fibre_color(&p, albedo);
    bench("quadrature, 64 nodes", &|i| quadrature(&p, &color, o, i));
    let full = fibre_shading(&p, &row, albedo, o, 0.0, 8);
    bench("series, 8 terms", &|i| fibre_evaluate(&full, i));
    let three = fibre_shading(&p, &row, albedo, o, 0.0, MEAN_TERMS);
    bench("three terms", &|i| fibre_evaluate(&three, i));
    let near = fibre_near(&p, &row, albedo, o, 0.0, 8, fibre_window(0.2, 0.3));
    bench("near field", &|i| fibre_near_evaluate(&near, i));
    group.finish();
    c.bench_function("prepare a pixel: series", |b| {
        b.iter(|| fibre_shading(&p, &row, black_box(albedo), o, 0.0, 8))
    });
    c.bench_function("prepare a pixel: near field", |b| {
        b.iter(|| {
            fibre_near(
                &p,
                &row,
                black_box(albedo),
                o,
                0.0,
                8,
                fibre_window(0.2, 0.3),
            )
        })
    });
    let exact = fibre_shading(
        &table.fibre(),
        &table.row(0.95),
        [0.6, 0.3, 0.1],
        [0.3, 0.4, 0.866],
        0.0,
        8,
    );
    let mut random = Pcg64Mcg::seed_from_u64(4);
    c.bench_function("one sample (double precision)", |b| {
        b.iter(|| fibre_sample(&exact, [0; 4].map(|_| random.random::<f64>())))
    });
    c.bench_function("build a table", |b| {
        b.iter(|| FibreTable::build(black_box(&fibre())))
    });
    on_gpu(&table);
}

/// Lights per thread and threads of a run on the GPU.
const LIGHTS: u32 = 32;
const THREADS: u32 = 65_536;

/// What all kernels share: one fibre per thread, its lights on a spiral.
const SHARED: &str = "
#import bevy_plumage::scattering as scattering
#import bevy_plumage::scattering_near as near
#import bevy_plumage::scattering_sample as sample
@group(0) @binding(0) var<storage, read> input: array<vec4<f32>>;
@group(0) @binding(1) var<storage, read_write> output: array<vec4<f32>>;

fn light_of(thread: u32, k: u32) -> vec3<f32> {
    let n = f32((thread * 7919u + k * 104729u) % 4093u) / 4093.0;
    let a = 2.3999632 * f32(k) + f32(thread & 1023u);
    let z = 2.0 * n - 1.0;
    let r = sqrt(1.0 - z * z);
    return vec3<f32>(r * cos(a), r * sin(a), z);
}

fn row_at(thread: u32) -> scattering::FibreRow {
    let place = scattering::fibre_row_at(0.3 + 0.7 * f32(thread & 255u) / 255.0);
    var low: array<vec4<f32>, 13>;
    var high: array<vec4<f32>, 13>;
    for (var k = 0u; k < 13u; k++) {
        low[k] = input[7u + place.index * 13u + k];
        high[k] = input[20u + place.index * 13u + k];
    }
    return scattering::fibre_row_mix(low, high, place.fraction);
}

fn eye_of(thread: u32) -> vec3<f32> {
    let c = 0.3 + 0.7 * f32(thread & 255u) / 255.0;
    return vec3<f32>(sqrt(1.0 - c * c), 0.6 * c, 0.8 * c);
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    var packed: array<vec4<f32>, 7>;
    for (var k = 0u; k < 7u; k++) {
        packed[k] = input[k];
    }
    let p = scattering::fibre_parameters(packed);
    let row = row_at(id.x);
    let albedo = vec3<f32>(0.6, 0.3, 0.1);
    let eye = eye_of(id.x);
    var sum = vec3<f32>(0.0);
    PREPARE
    for (var k = 0u; k < LIGHTS_U; k++) {
        let light = light_of(id.x, k);
        EVALUATE
    }
    output[id.x] = vec4<f32>(sum, 1.0);
}
";

/// The midpoint rule on the GPU, for one structural fibre.
const QUADRATURE: &str = "
fn gauss(x_in: f32, beta: f32) -> f32 {
    let x = x_in - 6.2831853 * round(x_in / 6.2831853);
    return exp(-0.5 * x * x / (beta * beta)) / (beta * 2.5066283);
}

fn quadrature(p: scattering::FibreParameters, albedo: vec3<f32>, o: vec3<f32>, light: vec3<f32>) -> vec3<f32> {
    let color = scattering::fibre_color(p, albedo);
    let cos_o = length(o.yz);
    let sin_square = 1.0 - cos_o * cos_o;
    let inner = cos_o / sqrt(p.eta * p.eta - sin_square);
    let path = 2.0 / sqrt(1.0 - sin_square / (p.eta * p.eta));
    let phi = atan2(light.y, light.z) - atan2(o.y, o.z);
    let i = vec2<f32>(light.x, length(light.yz));
    let e = vec2<f32>(o.x, cos_o);
    var m: vec4<f32>;
    for (var k = 0u; k < 4u; k++) {
        m[k] = scattering::longitudinal_with(e, i, p.inverse[k], p.scale[k]);
    }
    var sum = vec3<f32>(0.0);
    for (var k = 0u; k < 64u; k++) {
        let h = 2.0 * (f32(k) + 0.5) / 64.0 - 1.0;
        let gamma = asin(h);
        let offset = h * inner;
        let gamma_t = asin(offset);
        let f = scattering::fresnel(cos_o * sqrt(1.0 - h * h), p.eta);
        let enter = (1.0 - f) * (1.0 - f);
        sum += f * gauss(phi - 2.0 * gamma, p.azimuthal_roughness) * m.x;
        if abs(offset) < p.core {
            let angle = 2.0 * (gamma - gamma_t + asin(offset / p.core));
            sum += enter * color.core / (1.0 - f * color.core) * gauss(phi - angle, p.azimuthal_roughness) * m.w;
        } else {
            let t = exp(-color.absorption * path * sqrt(1.0 - offset * offset));
            sum += enter * t * gauss(phi - 2.0 * (gamma - gamma_t) + 3.1415927, p.azimuthal_roughness) * m.y;
            sum += enter * f * t * t / (1.0 - f * t) * gauss(phi - 2.0 * gamma + 4.0 * gamma_t, p.azimuthal_roughness) * m.z;
        }
    }
    return sum / 64.0;
}
";

/// Name, preparation and evaluation of the kernels.
const KERNELS: [(&str, &str, &str); 6] = [
    ("no light (overhead)", "", "sum += light;"),
    (
        "series, 8 terms",
        "let s = scattering::fibre_shading(p, row, albedo, eye, 0.0, 8u);",
        "sum += scattering::fibre_evaluate(s, light);",
    ),
    (
        "quadrature, 64 nodes",
        "",
        "sum += quadrature(p, albedo, eye, light);",
    ),
    (
        "three terms",
        "let s = scattering::fibre_shading(p, row, albedo, eye, 0.0, 3u);",
        "sum += scattering::fibre_evaluate(s, light);",
    ),
    (
        "near field",
        "let s = near::fibre_near(p, row, albedo, eye, 0.0, 8u, near::fibre_window(0.2, 0.3));",
        "sum += near::fibre_near_evaluate(s, light);",
    ),
    (
        "one sample",
        "let s = scattering::fibre_shading(p, row, albedo, eye, 0.0, 8u); let chooser = sample::fibre_sampler(s);",
        "sum += sample::fibre_sample(s, chooser, fract(vec4<f32>(light, light.x + light.y) * 17.0)).weight;",
    ),
];

/// Runs every kernel between two timestamps and prints the time of one light, preparation of the pixel shared by all of them.
fn on_gpu(table: &FibreTable) {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let options = wgpu::RequestAdapterOptions {
        power_preference: wgpu::PowerPreference::HighPerformance,
        ..Default::default()
    };
    let Ok(adapter) = pollster::block_on(instance.request_adapter(&options)) else {
        println!("no GPU adapter: nothing measured there");
        return;
    };
    let info = adapter.get_info();
    if !adapter.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
        println!("{}: no timestamps", info.name);
        return;
    }
    let description = wgpu::DeviceDescriptor {
        required_features: wgpu::Features::TIMESTAMP_QUERY,
        required_limits: adapter.limits(),
        ..Default::default()
    };
    let (device, queue) =
        pollster::block_on(adapter.request_device(&description)).expect("a device");
    println!(
        "\non the GPU, {} ({:?}), {LIGHTS} lights a pixel:",
        info.name, info.device_type
    );
    let mut words = Vec::new();
    for v in table.pack_parameters().iter().chain(&table.pack_rows()) {
        words.extend(v.iter().flat_map(|x| x.to_le_bytes()));
    }
    let buffer = |size: u64, usage| {
        device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size,
            usage,
            mapped_at_creation: false,
        })
    };
    let input = buffer(
        words.len() as u64,
        wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
    );
    queue.write_buffer(&input, 0, &words);
    let output = buffer(u64::from(THREADS) * 16, wgpu::BufferUsages::STORAGE);
    let resolved = buffer(
        16,
        wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
    );
    let read = buffer(
        16,
        wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
    );
    let queries = device.create_query_set(&wgpu::QuerySetDescriptor {
        label: None,
        ty: wgpu::QueryType::Timestamp,
        count: 2,
    });
    let files = [
        "math.wgsl",
        "scattering.wgsl",
        "scattering_azimuth.wgsl",
        "scattering_near.wgsl",
        "scattering_sample.wgsl",
    ];
    let mut overhead = 0.0;
    let mut series = 0.0;
    for (name, prepare, evaluate) in KERNELS {
        let text = format!("{SHARED}{QUADRATURE}")
            .replace("PREPARE", prepare)
            .replace("EVALUATE", evaluate)
            .replace("LIGHTS_U", &format!("{LIGHTS}u"));
        let shader = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: None,
            source: wgpu::ShaderSource::Naga(Cow::Owned(gpu::compose(&files, &text))),
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: None,
            layout: None,
            module: &shader,
            entry_point: Some("main"),
            compilation_options: Default::default(),
            cache: None,
        });
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[
                wgpu::BindGroupEntry {
                    binding: 0,
                    resource: input.as_entire_binding(),
                },
                wgpu::BindGroupEntry {
                    binding: 1,
                    resource: output.as_entire_binding(),
                },
            ],
        });
        // The best of a few runs: the first one warms up.
        let mut best = f64::INFINITY;
        for _ in 0..5 {
            let mut encoder = device.create_command_encoder(&Default::default());
            {
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                    label: None,
                    timestamp_writes: Some(wgpu::ComputePassTimestampWrites {
                        query_set: &queries,
                        beginning_of_pass_write_index: Some(0),
                        end_of_pass_write_index: Some(1),
                    }),
                });
                pass.set_pipeline(&pipeline);
                pass.set_bind_group(0, &group, &[]);
                pass.dispatch_workgroups(THREADS / 64, 1, 1);
            }
            encoder.resolve_query_set(&queries, 0..2, &resolved, 0);
            encoder.copy_buffer_to_buffer(&resolved, 0, &read, 0, 16);
            queue.submit([encoder.finish()]);
            let slice = read.slice(..);
            slice.map_async(wgpu::MapMode::Read, |result| result.expect("timestamps"));
            device
                .poll(wgpu::PollType::Wait {
                    submission_index: None,
                    timeout: None,
                })
                .expect("the GPU finishes");
            let ticks: Vec<u64> = slice
                .get_mapped_range()
                .chunks_exact(8)
                .map(|b| u64::from_le_bytes(b.try_into().unwrap_or_default()))
                .collect();
            read.unmap();
            let elapsed =
                ticks[1].saturating_sub(ticks[0]) as f64 * f64::from(queue.get_timestamp_period());
            best = best.min(elapsed / f64::from(LIGHTS * THREADS));
        }
        if evaluate == "sum += light;" {
            overhead = best;
        }
        let own = (best - overhead).max(0.0);
        if name.starts_with("series") {
            series = own;
        }
        let ratio = if series > 0.0 {
            format!(", {:.2} of the series", own / series)
        } else {
            String::new()
        };
        println!("  {name}: {own:.3} ns a light{ratio}");
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20).measurement_time(std::time::Duration::from_secs(1));
    targets = lights
}
criterion_main!(benches);
