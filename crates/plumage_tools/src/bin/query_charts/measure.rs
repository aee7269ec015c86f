//! Errors and costs of every method over the sweep.

use crate::{
    gpu::{self, Gpu, Kernel, Spread},
    methods::{self, Family, Method, Wgsl},
};
use bevy_plumage::maths::query::{Cell, Evaluator, Local};
use plumage_reference::coverage;
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use std::{hint::black_box, time::Instant};

/// Strata of the sweep: major axis from 0.01 barbule to 10 barb periods, and aspect ratio 1, to 2, 4, 8, 16.
pub const SCALES: usize = 8;
pub const ASPECTS: usize = 5;
/// Cases of the sweep, half of them masked, on seeds that nothing was tuned on.
const CASES: usize = 2400;
const SEEDS: [u64; 2] = [90_417, 55_213];
/// Rounds of timing on the GPU (a multiple on the CPU, interleaved over the methods); the fastest counts.
const ROUNDS: usize = 3;
/// Seconds per query from which a method is slow: it is timed once, and this many cases of a group stand for all.
const SLOW: f64 = 3e-4;
const SAMPLE: usize = 4;
/// Seconds that one measurement takes at least, that a dispatch should take, and that it may be expected to take at most.
const LEAST: f64 = 4e-4;
const DISPATCH: f64 = 8e-3;
const DISPATCH_MOST: f64 = 0.5;

/// Cases of one stratum for which the chooser picks the same evaluator.
pub struct Group {
    pub scale: usize,
    pub aspect: usize,
    pub kind: Evaluator,
    cases: Vec<(Cell<f32>, Local<f32>)>,
    truth: Vec<[f64; 3]>,
}

/// What one method does in one group.
#[derive(Clone, Default)]
pub struct Result {
    pub errors: Vec<f64>,
    /// Nanoseconds per query.
    pub cpu: f64,
    /// A few cases stand for all.
    slow: bool,
    pub gpu: Option<f64>,
}

/// Everything measured: `results[method][group]`, `None` where a method does not apply.
pub struct Measured {
    pub groups: Vec<Group>,
    pub methods: Vec<Method>,
    pub results: Vec<Vec<Option<Result>>>,
    /// Nanoseconds of a trilinear texture fetch.
    pub texture: Option<f64>,
}

/// Part of the sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    All,
    Scale(usize),
    Aspect(usize),
    Kind(Evaluator),
}

impl Part {
    pub fn holds(self, group: &Group) -> bool {
        match self {
            Self::All => true,
            Self::Scale(scale) => group.scale == scale,
            Self::Aspect(aspect) => group.aspect == aspect,
            Self::Kind(kind) => group.kind == kind,
        }
    }
}

/// Statistics of one method over a part of the sweep.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    pub count: usize,
    /// RMS, 99th percentile, maximum.
    pub error: [f64; 3],
    pub cpu: f64,
    pub gpu: Option<f64>,
}

impl Measured {
    /// `None` where the method does not apply to anything in the part.
    pub fn row(&self, method: usize, part: Part) -> Option<Row> {
        let mut errors = Vec::new();
        let mut cpu = 0.0;
        // Where a tile would take too long, the GPU's time is the CPU's times the ratio seen in the other groups.
        let ratio = self.gpu_over_cpu(method);
        let mut gpu = Some(0.0);
        for (group, result) in self.groups.iter().zip(&self.results[method]) {
            if let (true, Some(result)) = (part.holds(group), result) {
                let n = result.errors.len() as f64;
                cpu += n * result.cpu;
                let ns = result.gpu.or(ratio.map(|ratio| ratio * result.cpu));
                gpu = gpu.zip(ns).map(|(sum, ns)| sum + n * ns);
                errors.extend_from_slice(&result.errors);
            }
        }
        if errors.is_empty() {
            return None;
        }
        let n = errors.len() as f64;
        Some(Row {
            count: errors.len(),
            error: plumage_tests::sweep::statistics(&errors),
            cpu: cpu / n,
            gpu: gpu.map(|sum| sum / n),
        })
    }

    /// Time on the GPU over time on the CPU, over the groups with both.
    fn gpu_over_cpu(&self, method: usize) -> Option<f64> {
        let both = self.results[method]
            .iter()
            .flatten()
            .filter_map(|r| Some((r.gpu?, r.cpu)));
        let (gpu, cpu) = both.fold((0.0, 0.0), |sum, r| (sum.0 + r.0, sum.1 + r.1));
        (cpu > 0.0).then(|| gpu / cpu)
    }

    /// The method of a family with a setting.
    pub fn find(&self, family: Family, setting: &str) -> Option<usize> {
        self.methods
            .iter()
            .position(|m| m.family == family && m.setting == setting)
    }
}

fn groups() -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for (seed, masked) in SEEDS.into_iter().zip([false, true]) {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        for case in plumage_tests::sweep::cases(&mut random, CASES / 2, masked) {
            let (cell, local) = (
                plumage_tests::sweep::cell_f32(&case.cell),
                plumage_tests::sweep::local_f32(&case.local),
            );
            let kind = methods::kind(&cell, &local);
            let truth = coverage::coverage(&case.cell, &case.local);
            let found = groups
                .iter()
                .position(|g| (g.scale, g.aspect, g.kind) == (case.scale, case.aspect, kind));
            let index = found.unwrap_or_else(|| {
                groups.push(Group {
                    scale: case.scale,
                    aspect: case.aspect,
                    kind,
                    cases: Vec::new(),
                    truth: Vec::new(),
                });
                groups.len() - 1
            });
            groups[index].cases.push((cell, local));
            groups[index].truth.push(truth);
        }
    }
    groups
}

/// The numbers of a case as the GPU reads them.
pub fn numbers(cell: &Cell<f32>, local: &Local<f32>) -> [f32; gpu::CASE] {
    let (c, l) = (cell, local);
    [
        c.kappa,
        c.e_root,
        c.v_low,
        c.v_high,
        c.h_d,
        c.h_p,
        c.s_d,
        c.s_p,
        c.side,
        l.u,
        l.tau,
        l.variance,
        l.slope,
        l.conditional,
    ]
}

/// Sources that a method needs.
pub fn sources(wgsl: &Wgsl) -> Vec<(&'static str, String)> {
    const FILES: [&str; 5] = [
        "query.wgsl",
        "query_near.wgsl",
        "query_far.wgsl",
        "masking.wgsl",
        "math.wgsl",
    ];
    FILES
        .iter()
        .chain(wgsl.files)
        .map(|file| (*file, plumage_tests::gpu::shader_source(file)))
        .collect()
}

/// Nanoseconds per query of a function over the cases.
fn time_cpu(method: &Method, cases: &[(Cell<f32>, Local<f32>)]) -> f64 {
    let mut calls = 0usize;
    let start = Instant::now();
    loop {
        for (cell, local) in cases {
            black_box((method.cpu)(black_box(cell), black_box(local)));
        }
        calls += cases.len();
        let seconds = start.elapsed().as_secs_f64();
        if seconds > LEAST {
            return seconds * 1e9 / calls as f64;
        }
    }
}

/// Errors of a method over a group, and a first figure of its cost.
fn judge(method: &Method, group: &Group) -> Result {
    let error = |i: usize| {
        let (cell, local) = &group.cases[i];
        plumage_tests::sweep::difference((method.cpu)(cell, local).map(f64::from), group.truth[i])
    };
    let all = group.cases.len();
    let few = all.min(SAMPLE);
    let mut errors = Vec::new();
    let mut seconds = f64::INFINITY;
    // Twice, lest an interruption passes for slowness.
    for _ in 0..2 {
        let start = Instant::now();
        errors = (0..few).map(error).collect();
        seconds = seconds.min(start.elapsed().as_secs_f64() / few as f64);
    }
    let slow = seconds > SLOW;
    for i in few..all {
        errors.push(if slow { errors[i % few] } else { error(i) });
    }
    Result {
        errors,
        cpu: if slow { seconds * 1e9 } else { f64::INFINITY },
        slow,
        gpu: None,
    }
}

/// Nanoseconds per pixel of a kernel over tiles of the cases, without what the loop around it takes.
fn time_gpu(gpu: &Gpu, kernel: &Kernel, empty: &Kernel, group: &Group, cpu: f64) -> Option<f64> {
    // As many tiles as fit into the time that the CPU's figure promises; a cheap method is repeated.
    let tile = cpu * 1e-9 * gpu::LANES as f64;
    if tile > DISPATCH_MOST {
        return None;
    }
    let tiles = ((DISPATCH / tile) as usize).clamp(1, group.cases.len());
    let repeat = ((DISPATCH / (tile * tiles as f64)) as u32).clamp(1, 64);
    let stride = group.cases.len() / tiles;
    let input: Vec<f32> = group
        .cases
        .iter()
        .step_by(stride.max(1))
        .take(tiles)
        .flat_map(|(cell, local)| numbers(cell, local))
        .collect();
    let rounds = if tile > 0.05 { 1 } else { 2 * ROUNDS };
    let best = |kernel: &Kernel| {
        (0..rounds)
            .map(|_| gpu.run(kernel, &input, repeat, Spread::Tile).0)
            .fold(f64::INFINITY, f64::min)
    };
    let queries = (tiles * gpu::LANES) as f64 * f64::from(repeat);
    Some((best(kernel) - best(empty)).max(0.0) * 1e9 / queries)
}

/// The price of a texture fetch.
fn time_texture(gpu: &Gpu, group: &Group) -> f64 {
    let [texture, empty] =
        [methods::texture(), methods::empty()].map(|wgsl| gpu.kernel(sources(&wgsl), &wgsl.text));
    let input: Vec<f32> = group
        .cases
        .iter()
        .take(32)
        .flat_map(|(cell, local)| numbers(cell, local))
        .collect();
    let best = |kernel: &Kernel| {
        (0..20)
            .map(|_| gpu.run(kernel, &input, 64, Spread::Tile).0)
            .fold(f64::INFINITY, f64::min)
    };
    let queries = input.len() / gpu::CASE * gpu::LANES * 64;
    (best(&texture) - best(&empty)).max(0.0) * 1e9 / queries as f64
}

/// Measures everything.
pub fn measure(gpu: Option<&Gpu>) -> Measured {
    let groups = groups();
    let methods = methods::all();
    let mut results: Vec<Vec<Option<Result>>> = vec![vec![None; groups.len()]; methods.len()];
    let applies = |method: &Method, group: &Group| match method.family {
        Family::Forced(kind) => kind == group.kind,
        _ => true,
    };
    for (method, row) in methods.iter().zip(&mut results) {
        for (group, slot) in groups.iter().zip(row.iter_mut()) {
            if !applies(method, group) {
                continue;
            }
            *slot = Some(judge(method, group));
        }
    }
    eprintln!("errors known, timing");
    for _ in 0..3 * ROUNDS {
        for (index, group) in groups.iter().enumerate() {
            for (method, row) in methods.iter().zip(&mut results) {
                if let Some(result) = row[index].as_mut().filter(|r| !r.slow) {
                    result.cpu = result.cpu.min(time_cpu(method, &group.cases));
                }
            }
        }
    }
    let mut texture = None;
    if let Some(gpu) = gpu {
        let empty = methods::empty();
        let empty = gpu.kernel(sources(&empty), &empty.text);
        texture = groups.first().map(|group| time_texture(gpu, group));
        for (method, row) in methods.iter().zip(&mut results) {
            let Some(wgsl) = &method.wgsl else { continue };
            eprintln!("{}, {} on the GPU", method.family.name(), method.setting);
            let kernel = gpu.kernel(sources(wgsl), &wgsl.text);
            for (group, result) in groups.iter().zip(row.iter_mut()) {
                if let Some(result) = result {
                    result.gpu = time_gpu(gpu, &kernel, &empty, group, result.cpu);
                }
            }
        }
    }
    // The shader's rules end at 64 nodes; its sums are as long as there are nodes.
    let index = |nodes: usize| {
        let setting = format!("{nodes} nodes");
        let same = |m: &Method| m.family == Family::Spatial && m.setting == setting;
        methods.iter().position(same)
    };
    if let (Some(from), Some(to)) = (index(64), index(96)) {
        let times: Vec<Option<f64>> = results[from]
            .iter()
            .map(|r| r.as_ref()?.gpu.map(|ns| ns * 96.0 / 64.0))
            .collect();
        for (result, ns) in results[to].iter_mut().zip(times) {
            if let Some(result) = result {
                result.gpu = ns;
            }
        }
    }
    Measured {
        groups,
        methods,
        results,
        texture,
    }
}
