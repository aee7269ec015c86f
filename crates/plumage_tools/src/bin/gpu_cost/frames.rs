//! One frame of an example on a software renderer, its pipelines with counters in them.

use super::{
    Result,
    compose::Compiled,
    device::{self, Figures, Job},
    instrument::{COUNTER_WORDS, Counted, QUAD, instrument},
    spirv::{Module, op},
};
use std::{
    collections::{BTreeMap, HashMap},
    env, fs,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    thread,
    time::Duration,
};

/// A fragment or vertex stage's bit.
pub const VERTEX: u32 = 1;
/// See [`VERTEX`].
pub const FRAGMENT: u32 = 16;
/// Slots of a GPU's instructions over those that [`super::spirv::Costs`] finds in SPIR-V.
const FOLDED: f64 = 0.75;

/// What a stage of a pipeline ran in a frame.
#[derive(Clone, Debug, Default)]
pub struct Run {
    /// Invocations.
    pub invocations: f64,
    /// Slots of all of them, as [`super::spirv::Costs`] says.
    pub slots: f64,
    /// 2x2 quads with a fragment.
    pub quads: f64,
    /// Fragments in front of all that was drawn before.
    pub early: f64,
    /// 2x2 quads with one of those.
    pub early_quads: f64,
    /// Of `early` those that are no holes.
    pub kept: f64,
    /// Pixels with one of those.
    pub pixels: f64,
    /// Of `slots`, by function.
    pub functions: BTreeMap<String, f64>,
    /// What a GPU's compiler makes of the stage.
    pub compiled: Figures,
}

/// A pipeline that ran.
#[derive(Clone, Debug)]
pub struct Ran {
    /// What it draws.
    pub name: String,
    /// By its bit.
    pub stages: BTreeMap<u32, Run>,
}

struct Stage {
    bit: u32,
    first: u32,
    counters: Vec<Counted>,
    names: HashMap<u32, String>,
}

struct Made {
    index: u32,
    name: String,
    stages: Vec<Stage>,
    job: Option<Job>,
}

fn read_words(path: &Path) -> Result<Vec<u32>> {
    let bytes = fs::read(path).map_err(|error| format!("{}: {error}", path.display()))?;
    let words = bytes.as_chunks::<4>().0.iter();
    Ok(words.map(|bytes| u32::from_le_bytes(*bytes)).collect())
}

fn write_words(path: &Path, words: &[u32]) -> Result<()> {
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    Ok(fs::write(path, bytes)?)
}

/// A fragment stage for pipelines of depth alone.
fn depth_stage() -> Result<Vec<u32>> {
    let text = "@fragment fn count(@builtin(position) place: vec4<f32>) {}";
    let module = naga::front::wgsl::parse_str(text)?;
    let all = naga::valid::Capabilities::all();
    let info = naga::valid::Validator::new(naga::valid::ValidationFlags::all(), all)
        .validate(&module)
        .map_err(|error| error.to_string())?;
    let options = naga::back::spv::Options::default();
    Ok(naga::back::spv::write_vec(&module, &info, &options, None)?)
}

/// A function's name as its file has it.
fn own_name(known: &str) -> &str {
    known.split("X_naga").next().unwrap_or_default()
}

/// What a pipeline draws, by the functions in it.
fn name_of(vertex: &[u32], fragment: Option<&[u32]>, shadow: bool) -> String {
    let modules = [Some(vertex), fragment].map(|words| words.and_then(Module::new));
    let names: Vec<String> = modules
        .iter()
        .flatten()
        .flat_map(|module| module.names().into_values())
        .collect();
    let has = |name: &str| {
        let own = |known: &String| own_name(known) == name;
        names.iter().any(own)
    };
    let cut = modules[1].as_ref().is_some_and(|module| {
        let mut list = module.list.iter();
        list.any(|i| i[0] == op::KILL || i[0] == op::DEMOTE)
    });
    let color = has("shade");
    let mut name = if has("light_response") {
        "feathers LIT".to_owned()
    } else if color && has("is_left_out") {
        "feathers MEAN".into()
    } else if color && has("fibre_near") {
        "feathers RESOLVED".into()
    } else if color && has("cover") {
        "feathers FAR".into()
    } else if has("cover") || has("shadow_opacity") {
        "feathers".into()
    } else if has("apply_pbr_lighting") || has("pbr_input_from_standard_material") {
        "StandardMaterial".into()
    } else if has("mesh_position_local_to_world") {
        "meshes".into()
    } else {
        "others".into()
    };
    if !name.starts_with("feathers") && cut {
        name += ", cut out";
    }
    if shadow {
        name += ", shadow";
    } else if name.starts_with("feathers") && !color {
        name += ", prepass";
    }
    name
}

/// Components and kind (0 float, 1 signed, 2 unsigned) of a `VkFormat` of a vertex.
fn input_of(format: u32) -> [u32; 2] {
    match format {
        // Bytes and 16 bits come in fours, or in twos.
        41 | 95 => [4, 2],
        77..=83 => [2, 0],
        98 | 101 | 104 | 107 => [(format - 98) / 3 + 1, 2],
        99 | 102 | 105 | 108 => [(format - 99) / 3 + 1, 1],
        100 | 103 | 106 | 109 => [(format - 100) / 3 + 1, 0],
        _ => [4, 0],
    }
}

/// Reads what the layer has written of a pipeline, and writes its counted code.
fn take(folder: &Path, index: u32, next: &mut u32) -> Result<Made> {
    let text = fs::read_to_string(folder.join(format!("{index}.made")))?;
    let (mut state, mut bindings, mut inputs, mut entries) =
        ([0; 5], Vec::new(), Vec::new(), Vec::new());
    for line in text.lines() {
        let words: Vec<&str> = line.split(' ').collect();
        let number = |at: usize| {
            words
                .get(at)
                .and_then(|w| w.parse::<u32>().ok())
                .unwrap_or(0)
        };
        match words[0] {
            "state" => state = [1, 2, 3, 4, 5].map(number),
            "binding" => bindings.push([1, 2, 3, 4].map(number)),
            "input" => {
                let [components, kind] = input_of(number(2));
                inputs.push([number(1), components, kind]);
            }
            "stage" => entries.push((number(1), words.get(2).copied().unwrap_or("").to_owned())),
            _ => {}
        }
    }
    let [samples, targets, tests, writes, clamps] = state;
    let tested = tests != 0 && clamps == 0;
    let mut own = Made {
        index,
        name: String::new(),
        stages: Vec::new(),
        job: None,
    };
    let mut codes = BTreeMap::new();
    let mut stages = Vec::new();
    for (bit, entry) in entries {
        let words = read_words(&folder.join(format!("{index}.{bit}.spv")))?;
        codes.insert(bit, words.clone());
        let made = Compiled {
            words,
            bindings: bindings.clone(),
            inputs: inputs.clone(),
            targets,
        };
        stages.push((bit, entry, made));
    }
    own.name = match codes.get(&VERTEX) {
        Some(vertex) => name_of(vertex, codes.get(&FRAGMENT).map(Vec::as_slice), clamps != 0),
        None => "compute".into(),
    };
    let marks = !own.name.ends_with("prepass")
        && (own.name.starts_with("feathers") || own.name == "StandardMaterial, cut out");
    let mut counted = codes.clone();
    if codes.contains_key(&VERTEX) && tested && writes != 0 {
        counted.entry(FRAGMENT).or_insert(depth_stage()?);
    }
    for (bit, words) in counted {
        let tested = tested && bit == FRAGMENT;
        let Some(made) = instrument(&words, *next, [tested, writes != 0, marks]) else {
            continue;
        };
        if *next + made.counters.len() as u32 > COUNTER_WORDS {
            return Err("more counters than there is room for".into());
        }
        write_words(
            &folder.join(format!("{index}.{bit}.counted.spv")),
            &made.words,
        )?;
        own.stages.push(Stage {
            bit,
            first: *next,
            counters: made.counters.clone(),
            names: Module::new(&words).map_or_else(HashMap::new, |module| module.names()),
        });
        *next += made.counters.len() as u32;
    }
    own.job = Some(Job {
        name: format!("frame_{index}"),
        samples,
        writes_depth: writes != 0,
        stages,
    });
    Ok(own)
}

fn build_layer(root: &Path, folder: &Path) -> Result<()> {
    let library = folder.join("libplumage_counters.so");
    let status = Command::new(env::var_os("CC").unwrap_or_else(|| "cc".into()))
        .args(["-O1", "-std=c17", "-D_GNU_SOURCE", "-fPIC", "-shared", "-o"])
        .arg(&library)
        .arg(root.join("benches/gpu_cost/layer.c"))
        .status()?;
    if !status.success() {
        return Err("benches/gpu_cost/layer.c does not compile".into());
    }
    let about = serde_json::json!({
        "file_format_version": "1.2.0",
        "layer": {
            "name": LAYER,
            "type": "GLOBAL",
            "library_path": library,
            "api_version": "1.3.0",
            "implementation_version": "1",
            "description": "counters in shaders",
        },
    });
    Ok(fs::write(folder.join("layer.json"), about.to_string())?)
}

const LAYER: &str = "VK_LAYER_PLUMAGE_counters";

fn example(root: &Path, name: &str, arguments: &[String], picture: &Path) -> Result<Command> {
    let own = env::current_exe()?;
    let program = own.with_file_name("examples").join(name);
    let mut command = Command::new(program);
    command
        .args(["--headless", "--output"])
        .arg(picture)
        .arg("--assets")
        .arg(root.join("assets"))
        .args(arguments)
        .env("BEVY_ASSET_ROOT", root)
        .env("RUST_LOG", "error")
        .stdout(Stdio::null());
    Ok(command)
}

/// Draws a picture without counters.
pub fn plain(root: &Path, name: &str, arguments: &[String], picture: &Path) -> Result<()> {
    let status = example(root, name, arguments, picture)?.status()?;
    if status.success() {
        Ok(())
    } else {
        Err(format!("{name} {arguments:?}: {status}").into())
    }
}

/// Draws it with counters, and compiles what ran for a GPU: the pipelines of the last frame.
pub fn count(
    root: &Path,
    folder: &Path,
    [driver, family]: [&str; 2],
    (name, arguments): (&str, &[String]),
    picture: &Path,
) -> Result<Vec<Ran>> {
    let work = folder.join("frames");
    let _ = fs::remove_dir_all(&work);
    fs::create_dir_all(&work)?;
    build_layer(root, &work)?;
    let mut child = example(root, name, arguments, picture)?
        .env("GPU_COST_FOLDER", &work)
        // Names of functions, by which pipelines are known.
        .env("WGPU_DEBUG", "1")
        .env("VK_LAYER_PATH", &work)
        .env("VK_INSTANCE_LAYERS", LAYER)
        .spawn()?;
    let mut made = Vec::new();
    let mut next = 0;
    let status = loop {
        let ended = child.try_wait()?;
        for entry in fs::read_dir(&work)?.flatten() {
            let path: PathBuf = entry.path();
            let stem = path.file_stem().and_then(|stem| stem.to_str());
            let index = stem.and_then(|stem| stem.parse::<u32>().ok());
            let is_new = path.extension().is_some_and(|end| end == "made");
            let (Some(index), true) = (index, is_new) else {
                continue;
            };
            if made.iter().any(|known: &Made| known.index == index) {
                continue;
            }
            made.push(take(&work, index, &mut next)?);
            fs::write(work.join(format!("{index}.counted")), "")?;
        }
        if let Some(status) = ended {
            break status;
        }
        thread::sleep(Duration::from_millis(5));
    };
    let frame = last_frame(&fs::read_to_string(work.join("counts")).unwrap_or_default());
    // On a slow machine the example gives up waiting for its picture, after the frame is done.
    if !status.success() && frame.is_empty() {
        return Err(format!("{name} {arguments:?} with counters: {status}").into());
    }
    collect(root, &work, [driver, family], made, &frame)
}

/// Counters of the last whole frame: a frame is handed over at once, with the most that is counted.
fn last_frame(text: &str) -> BTreeMap<u32, f64> {
    let frames: Vec<BTreeMap<u32, f64>> = text
        .split("submission\n")
        .map(|part| {
            let lines = part.lines().filter_map(|line| line.split_once(' '));
            lines
                .filter_map(|(index, value)| Some((index.parse().ok()?, value.parse().ok()?)))
                .collect()
        })
        .collect();
    let sum = |frame: &BTreeMap<u32, f64>| frame.values().sum::<f64>();
    let most = frames.iter().map(sum).fold(0.0, f64::max);
    let mut whole = frames.into_iter().rev();
    whole
        .find(|frame| sum(frame) > 0.5 * most)
        .unwrap_or_default()
}

fn collect(
    root: &Path,
    work: &Path,
    [driver, family]: [&str; 2],
    made: Vec<Made>,
    frame: &BTreeMap<u32, f64>,
) -> Result<Vec<Ran>> {
    let (mut found, mut jobs) = (Vec::new(), Vec::new());
    for mut pipeline in made {
        let mut ran = Ran {
            name: pipeline.name,
            stages: BTreeMap::new(),
        };
        for stage in &pipeline.stages {
            let mut run = Run::default();
            for (at, counted) in (stage.first..).zip(&stage.counters) {
                let count = frame.get(&at).copied().unwrap_or(0.0);
                match *counted {
                    Counted::Invocations => run.invocations += count,
                    Counted::Block(slots, function) => {
                        let slots = FOLDED * slots * count;
                        run.slots += slots;
                        let name = stage.names.get(&function).map_or("", |name| own_name(name));
                        *run.functions.entry(name.into()).or_default() += slots;
                    }
                    Counted::Quads => run.quads += count / QUAD,
                    Counted::Early => run.early += count,
                    Counted::EarlyQuads => run.early_quads += count / QUAD,
                    Counted::Kept => run.kept += count,
                    Counted::Pixels => run.pixels += count,
                }
            }
            if run.invocations > 0.0 {
                ran.stages.insert(stage.bit, run);
            }
        }
        let drawn = ran.name.starts_with("feathers")
            || ran.name.starts_with("StandardMaterial")
            || ran.name.starts_with("meshes");
        if ran.stages.is_empty() || !drawn {
            continue;
        }
        jobs.extend(pipeline.job.take());
        found.push((pipeline.index, ran));
    }
    let program = device::build(root, work)?;
    let (_, figures) = device::compile(&program, driver, family, work, &jobs)?;
    for (index, ran) in &mut found {
        for (bit, run) in &mut ran.stages {
            let own = figures.get(&(format!("frame_{index}"), *bit));
            run.compiled = own.cloned().unwrap_or_default();
        }
    }
    Ok(found.into_iter().map(|(_, ran)| ran).collect())
}
