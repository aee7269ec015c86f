//! What a GPU's compiler makes of the shaders, without a GPU: instructions, registers, spills, waves, code and issue slots of every
//! pipeline, beside a StandardMaterial card.
//!
//! `cargo run -p plumage_tools --bin gpu_cost -- --help`. The shader definitions follow from the plugin's own pipeline keys, naga
//! composes and translates as in Bevy and wgpu, and Mesa's driver for Radeons compiles for a card that is not there
//! (`RADV_FORCE_FAMILY`; Mesa up to 25 has that).

mod compose;
mod device;
mod frames;
mod instrument;
mod pictures;
mod spirv;
mod variants;

use clap::Parser;
use compose::Library;
use device::{Figures, Job};
use naga::ShaderStage;
use std::{
    collections::{BTreeMap, HashMap},
    env,
    fmt::Write,
    fs,
    path::{Path, PathBuf},
    process::Command,
};
use variants::Pipeline;

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

#[derive(Parser)]
#[command(about = "What a GPU's compiler makes of the shaders, without a GPU")]
struct Args {
    /// Family of Radeons, as RADV_FORCE_FAMILY names it
    #[arg(long, default_value = "navi21")]
    family: String,
    /// Mesa's Vulkan driver for Radeons
    #[arg(long, default_value = "libvulkan_radeon.so")]
    driver: String,
    /// Every pipeline that the plugin can make; otherwise those of the default settings with four samples
    #[arg(long)]
    all: bool,
    /// Only pipelines whose names contain this
    #[arg(long, default_value = "")]
    only: String,
    /// Folder with the plugin's WGSL
    #[arg(long)]
    shaders: Option<PathBuf>,
    /// Folder with another state of it, whose figures come first
    #[arg(long)]
    before: Option<PathBuf>,
    /// Shader definition, such as WORN_POSES; figures without it come first
    #[arg(long, conflicts_with = "before")]
    without: Option<String>,
    /// Write the table into benches/results, too
    #[arg(long)]
    save: bool,
    /// Count what frames of these pictures run on a software renderer, instead: `hero`, `far`, `eagle`, `closeup`; the examples must be built
    #[arg(long, num_args = 1.., value_name = "PICTURE")]
    pictures: Vec<String>,
    /// Of the examples, for those pictures: `alpha-to-coverage` (four samples), `hashed` (one)
    #[arg(long, default_value = "alpha-to-coverage")]
    transparency: String,
    /// Size of those pictures
    #[arg(long, default_value = "1920x1080")]
    size: String,
    /// For those pictures, also the slots of each function of the feathers' fragments and vertices
    #[arg(long)]
    functions: bool,
}

fn root() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}

fn output_of(program: &str, arguments: &[&str]) -> Result<String> {
    let output = Command::new(program)
        .args(arguments)
        .current_dir(root())
        .output()?;
    if !output.status.success() {
        return Err(format!("{program} {arguments:?}: {}", output.status).into());
    }
    Ok(String::from_utf8(output.stdout)?.trim().to_owned())
}

/// Folders of the crates of Bevy that this workspace uses.
fn bevy_folders() -> Result<Vec<PathBuf>> {
    let cargo = env::var("CARGO").unwrap_or_else(|_| "cargo".into());
    // Crates of other platforms need not be here.
    let about = output_of("rustc", &["-vV"])?;
    let host = about.lines().find_map(|line| line.strip_prefix("host: "));
    let mut arguments = vec!["metadata", "--format-version=1", "--offline"];
    arguments.extend(host.iter().flat_map(|host| ["--filter-platform", host]));
    let text = output_of(&cargo, &arguments)?;
    let metadata: serde_json::Value = serde_json::from_str(&text)?;
    let packages = metadata["packages"].as_array().ok_or("no packages")?;
    let mut folders = Vec::new();
    for package in packages {
        let name = package["name"].as_str().unwrap_or_default();
        let manifest = Path::new(package["manifest_path"].as_str().unwrap_or_default());
        if name.starts_with("bevy_") && package["source"].is_string() {
            folders.extend(manifest.parent().map(|folder| folder.join("src")));
        }
    }
    Ok(folders)
}

/// One row: a stage of a pipeline.
struct Row {
    name: String,
    stage: u32,
    figures: Figures,
}

fn bit_of(stage: ShaderStage) -> u32 {
    match stage {
        ShaderStage::Vertex => 1,
        ShaderStage::Fragment => 16,
        _ => 32,
    }
}

/// The code of every stage as naga translates it, by the pipeline's name.
type Code = BTreeMap<(String, u32), Vec<u32>>;

/// Compiles the pipelines with the WGSL of a folder.
fn measure(
    args: &Args,
    shaders: &Path,
    pipelines: &[Pipeline],
    folder: &Path,
) -> Result<(String, Vec<Row>, Code)> {
    let mut code = Code::new();
    let mut folders = bevy_folders()?;
    folders.push(shaders.to_owned());
    let mut libraries = [
        Library::new(&folders, false)?,
        Library::new(&folders, true)?,
    ];
    let mut jobs = Vec::new();
    // A stage that another pipeline has, too, gets one row.
    let mut known: HashMap<Vec<u32>, String> = HashMap::new();
    let mut rows = Vec::new();
    for pipeline in pipelines {
        let name: String = pipeline
            .name
            .chars()
            .map(|c| if c.is_alphanumeric() { c } else { '_' })
            .collect();
        let mut stages = Vec::new();
        let mut fresh = Vec::new();
        for stage in &pipeline.stages {
            let library = &mut libraries[usize::from(pipeline.comparison)];
            let made = library
                .compile(&stage.file, stage.kind, stage.entry, &stage.defs)
                .map_err(|error| format!("{}: {error}", pipeline.name))?;
            let bit = bit_of(stage.kind);
            code.insert((pipeline.name.clone(), bit), made.words.clone());
            if known.insert(made.words.clone(), name.clone()).is_none() {
                fresh.push((name.clone(), bit));
            }
            stages.push((bit, stage.entry.to_owned(), made));
        }
        if fresh.is_empty() {
            continue;
        }
        rows.extend(
            fresh
                .into_iter()
                .map(|(key, stage)| (key, stage, pipeline.name.clone())),
        );
        jobs.push(Job {
            name,
            samples: pipeline.samples,
            writes_depth: pipeline.writes_depth,
            stages,
        });
    }
    let program = device::build(&root(), folder)?;
    let (device, found) = device::compile(&program, &args.driver, &args.family, folder, &jobs)?;
    // Fragments first: they are what costs.
    rows.sort_by_key(|(_, stage, _)| *stage != 16);
    let rows = rows.into_iter().map(|(key, stage, name)| {
        let figures = found
            .get(&(key, stage))
            .cloned()
            .ok_or(format!("nothing said of {name}"))?;
        Ok(Row {
            name,
            stage,
            figures,
        })
    });
    Ok((device, rows.collect::<Result<_>>()?, code))
}

/// Which stages are the same to the bit in both states of the WGSL, in words.
fn same_code(before: &Code, now: &Code) -> String {
    let differs = |stage: &&(String, u32)| before.get(*stage) != now.get(*stage);
    let others: Vec<String> = now
        .keys()
        .filter(differs)
        .map(|(name, stage)| match stage {
            1 => format!("{name}, vertices"),
            _ => name.clone(),
        })
        .collect();
    format!(
        "\nThe SPIR-V of {} of {} stages is the same to the bit as before. Others: {}.\n",
        now.len() - others.len(),
        now.len(),
        others.join("; "),
    )
}

/// Lanes of a wave.
const LANES: u64 = 64;

fn table(before: Option<&[Row]>, rows: &[Row]) -> Result<String> {
    let mut text = String::from(
        "| pipeline | instructions | registers | spilled | scratch, B a lane | waves | code, KiB | slots |\n|---|---|---|---|---|---|---|---|\n",
    );
    let old: BTreeMap<(&str, u32), &Figures> = before
        .unwrap_or_default()
        .iter()
        .map(|row| ((row.name.as_str(), row.stage), &row.figures))
        .collect();
    for row in rows {
        let stage = match row.stage {
            1 => ", vertices",
            16 => "",
            _ => ", compute",
        };
        let old = old.get(&(row.name.as_str(), row.stage));
        let cell = |of: &dyn Fn(&Figures) -> String| {
            let now = of(&row.figures);
            match old.map(|figures| of(figures)) {
                Some(then) if then != now => format!("{then} → {now}"),
                _ => now,
            }
        };
        writeln!(
            text,
            "| {}{stage} | {} | {} | {} | {} | {} | {} | {} |",
            row.name,
            cell(&|f| f.instructions.to_string()),
            cell(&|f| f.registers.to_string()),
            cell(&|f| f.spilled.to_string()),
            cell(&|f| (f.scratch / LANES).to_string()),
            cell(&|f| f.waves.to_string()),
            cell(&|f| format!("{:.1}", f.code as f64 / 1024.0)),
            cell(&|f| f.slots.to_string()),
        )?;
    }
    Ok(text)
}

fn main() -> Result<()> {
    let args = Args::parse();
    let folder = root().join("target/gpu_cost");
    fs::create_dir_all(&folder)?;
    let folder = folder.canonicalize()?;
    let date = output_of("date", &["+%F"])?;
    let commit = output_of("git", &["describe", "--always", "--dirty", "--exclude=*"])
        .unwrap_or_else(|_| "unknown".into());
    if !args.pictures.is_empty() {
        let text = pictures::run(&args, &folder, &format!("{date}, commit {commit}"))?;
        return save(
            &args,
            &format!("{date}_gpu_frames_{}", args.transparency),
            &text,
        );
    }
    let mut pipelines = variants::all();
    pipelines.retain(|p| (args.all || p.usual) && p.name.contains(&args.only));
    let shaders = args
        .shaders
        .clone()
        .unwrap_or_else(|| root().join("src/shaders"));
    let before = match (&args.before, &args.without) {
        (Some(old), _) => Some(measure(&args, old, &pipelines, &folder)?),
        (None, Some(name)) => {
            let mut plain = pipelines.clone();
            let stages = plain.iter_mut().flat_map(|pipeline| &mut pipeline.stages);
            stages.for_each(|stage| stage.leave_out(name));
            Some(measure(&args, &shaders, &plain, &folder)?)
        }
        (None, None) => None,
    };
    let (device, rows, code) = measure(&args, &shaders, &pipelines, &folder)?;
    let same = before
        .as_ref()
        .map_or(String::new(), |(_, _, before)| same_code(before, &code));
    let before = before.map(|(_, rows, _)| rows);
    let text = format!(
        "# Pipelines as a GPU's compiler makes them, {date}, commit {commit}\n\n\
         `make gpu-cost`: {device}, no hardware. Vector registers a lane (256 at most) and those spilled to memory, scratch memory with indexed arrays; \
         waves of 64 lanes per SIMD; a slot is one instruction of a lane, transcendentals and 32-bit products 4, loops counted once. \
         Vertex stages appear with the first pipeline that has them.\n\n{}",
        table(before.as_deref(), &rows)? + &same
    );
    save(&args, &format!("{date}_gpu_cost_{}", args.family), &text)
}

/// Prints, and writes if asked.
fn save(args: &Args, name: &str, text: &str) -> Result<()> {
    print!("{text}");
    if args.save {
        let name = format!("benches/results/{name}.md");
        fs::write(root().join(&name), text)?;
        println!("\nwritten to {name}");
    }
    Ok(())
}
