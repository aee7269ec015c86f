//! The compiler of a GPU that is not there: Mesa's driver for Radeons with a family said by name.

use super::compose::Compiled;
use std::{
    collections::BTreeMap,
    env, fs,
    io::Write,
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

/// What the compiler says of one stage of one pipeline.
#[derive(Clone, Debug, Default)]
pub struct Figures {
    /// Machine instructions.
    pub instructions: u64,
    /// Vector registers of a lane.
    pub registers: u64,
    /// Vector registers spilled to memory.
    pub spilled: u64,
    /// Bytes of memory that a wave has beside its registers, for what was spilled and for arrays that are indexed.
    pub scratch: u64,
    /// Waves that fit on a SIMD.
    pub waves: u64,
    /// Bytes of code.
    pub code: u64,
    /// Issue slots, each instruction once ([`slots`]).
    pub slots: u64,
}

/// A pipeline to compile.
pub struct Job {
    /// A name without blanks.
    pub name: String,
    /// Samples per pixel.
    pub samples: u32,
    /// It writes depth.
    pub writes_depth: bool,
    /// `VkShaderStageFlagBits`, entry point and code.
    pub stages: Vec<(u32, String, Compiled)>,
}

/// Builds the program that drives the compiler.
pub fn build(root: &Path, folder: &Path) -> Result<PathBuf, String> {
    let program = folder.join("replay");
    let status = Command::new(env::var_os("CC").unwrap_or_else(|| "cc".into()))
        .args(["-O1", "-std=c17", "-D_GNU_SOURCE", "-o"])
        .arg(&program)
        .arg(root.join("benches/gpu_cost/replay.c"))
        .arg("-ldl")
        .status()
        .map_err(|error| format!("no C compiler: {error}"))?;
    if status.success() {
        Ok(program)
    } else {
        Err("benches/gpu_cost/replay.c does not compile; are Vulkan's headers there (libvulkan-dev)?".into())
    }
}

fn describe(job: &Job, folder: &Path) -> std::io::Result<String> {
    let targets = job.stages.iter().map(|(kind, _, made)| {
        const FRAGMENT: u32 = 16;
        if *kind == FRAGMENT { made.targets } else { 0 }
    });
    let mut text = format!(
        "pipeline {} {} {} {}\n",
        job.name,
        job.samples,
        targets.max().unwrap_or_default(),
        u32::from(job.writes_depth)
    );
    let mut bindings = BTreeMap::new();
    for (kind, entry, made) in &job.stages {
        let file = folder.join(format!("{}.{kind}.spv", job.name));
        let bytes: Vec<u8> = made.words.iter().flat_map(|w| w.to_le_bytes()).collect();
        fs::write(&file, bytes)?;
        text += &format!("stage {kind} {} {entry}\n", file.display());
        for [set, binding, descriptor, count] in &made.bindings {
            bindings.insert((*set, *binding), (*descriptor, *count));
        }
        if *kind == 1 {
            for [location, components, scalar] in &made.inputs {
                text += &format!("input {location} {components} {scalar}\n");
            }
        }
    }
    for ((set, binding), (kind, count)) in bindings {
        text += &format!("binding {set} {binding} {kind} {count}\n");
    }
    Ok(text + "make\n")
}

/// Compiles all; the device and its driver, and the figures by job and stage.
pub fn compile(
    program: &Path,
    driver: &str,
    family: &str,
    folder: &Path,
    jobs: &[Job],
) -> Result<(String, BTreeMap<(String, u32), Figures>), String> {
    let said = |error: std::io::Error| error.to_string();
    let mut text = String::new();
    for job in jobs {
        text += &describe(job, folder).map_err(said)?;
    }
    let mut child = Command::new(program)
        .args([driver, family])
        .arg(folder)
        // Its cache would spare the compiler the work, and us the figures.
        .env("MESA_SHADER_CACHE_DISABLE", "true")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .map_err(said)?;
    let mut input = child.stdin.take().ok_or("no input")?;
    let writer = std::thread::spawn(move || input.write_all(text.as_bytes()));
    let output = child.wait_with_output().map_err(said)?;
    let written = writer.join().map_err(|_| "the writer stopped")?;
    if !output.status.success() {
        return Err(format!("{} stopped: {}", program.display(), output.status));
    }
    written.map_err(said)?;
    let mut device = String::new();
    let mut found: BTreeMap<(String, u32), Figures> = BTreeMap::new();
    for line in String::from_utf8_lossy(&output.stdout).lines() {
        let mut words = line.split('\t');
        let (Some(name), Some(stage), Some(statistic), Some(value)) =
            (words.next(), words.next(), words.next(), words.next())
        else {
            continue;
        };
        if name == "device" {
            device = statistic.to_owned();
            continue;
        }
        let stage: u32 = stage.parse().map_err(|_| format!("stage of {line}"))?;
        let value: u64 = value.parse().map_err(|_| format!("value of {line}"))?;
        let figures = found.entry((name.to_owned(), stage)).or_default();
        match statistic {
            "Instructions" => figures.instructions = value,
            "VGPRs" => figures.registers = value,
            "Spilled VGPRs" => figures.spilled = value,
            "Scratch size" => figures.scratch = value,
            "Subgroups per SIMD" => figures.waves = value,
            "Code size" | "Code Size" => figures.code = value,
            _ => {}
        }
    }
    for ((name, stage), figures) in &mut found {
        let path = folder.join(format!("{name}.{stage}.isa"));
        let assembly = fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
        figures.slots = slots(&assembly);
    }
    Ok((device, found))
}

/// Issue slots of a SIMD32 by one lane, each instruction once: 1 for arithmetic, 4 for a transcendental or a full 32-bit product.
fn slots(assembly: &str) -> u64 {
    const SLOW: [&str; 13] = [
        "rcp_",
        "rsq_",
        "sqrt_",
        "exp_",
        "log_",
        "sin_",
        "cos_",
        "mul_lo_u32",
        "mul_lo_i32",
        "mul_hi_u32",
        "mul_hi_i32",
        "mad_u64_u32",
        "mad_i64_i32",
    ];
    let operations = assembly
        .lines()
        .filter_map(|line| line.trim_start().strip_prefix("v_"));
    operations
        .map(|operation| {
            let slow = SLOW.iter().any(|name| operation.starts_with(name));
            if slow { 4 } else { 1 }
        })
        .sum()
}
