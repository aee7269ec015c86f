//! The pipelines that are compiled: those of the plugin as its keys list them, and Bevy's own cards beside them.

use bevy::shader::ShaderDefVal;
use bevy_plumage::{
    prelude::FeatherTransparency,
    render::key::{
        CoverageMethod, DrawnCards, DrawnUnder, FeatherPipelineKey, PassKey, Resolve, ThinLayers,
        pipelines,
    },
    undercoat::layout as undercoat,
};
use naga::ShaderStage;
use plumage_tests::shaders::{FORWARD, PREPASS, Variant, bools, feather_stages, numbers};

/// Samples of a multisampled camera.
const SAMPLES: u32 = 4;

/// An entry point of a file, and the definitions of the file.
#[derive(Clone)]
pub struct Stage {
    /// Which stage.
    pub kind: ShaderStage,
    /// End of the file's path.
    pub file: String,
    /// Name of the function.
    pub entry: &'static str,
    /// With all numbers.
    pub defs: Vec<ShaderDefVal>,
}

/// One pipeline.
#[derive(Clone)]
pub struct Pipeline {
    /// In words.
    pub name: String,
    /// Vertex and fragment, or compute.
    pub stages: Vec<Stage>,
    /// Samples per pixel.
    pub samples: u32,
    /// It writes depth.
    pub writes_depth: bool,
    /// It belongs to the usual table.
    pub usual: bool,
    /// It needs the published methods.
    pub comparison: bool,
}

impl Stage {
    /// Takes a definition away.
    pub fn leave_out(&mut self, name: &str) {
        self.defs.retain(|def| {
            let (ShaderDefVal::Bool(own, _)
            | ShaderDefVal::Int(own, _)
            | ShaderDefVal::UInt(own, _)) = def;
            own != name
        });
    }
}

fn stage(kind: ShaderStage, file: &str, entry: &'static str, defs: &[ShaderDefVal]) -> Stage {
    let mut defs = defs.to_vec();
    for (name, value) in numbers(SAMPLES) {
        let known = |def: &ShaderDefVal| matches!(def, ShaderDefVal::UInt(n, _) if n == name);
        defs.retain(|def| !known(def));
        defs.push(ShaderDefVal::UInt(name.into(), value));
    }
    let storage = "AVAILABLE_STORAGE_BUFFER_BINDINGS".into();
    defs.push(ShaderDefVal::UInt(storage, 32));
    // By its name alone: a file may have moved between two trees.
    let name = file.rsplit('/').next().unwrap_or(file);
    Stage {
        kind,
        file: name.to_owned(),
        entry,
        defs,
    }
}

fn graphics(name: String, [vertex, fragment]: [Variant; 2], samples: u32) -> Pipeline {
    Pipeline {
        name,
        stages: vec![
            stage(ShaderStage::Vertex, vertex.0, "vertex", &vertex.1),
            stage(ShaderStage::Fragment, fragment.0, "fragment", &fragment.1),
        ],
        samples,
        writes_depth: true,
        usual: true,
        comparison: false,
    }
}

fn compute(name: &str, file: &str, entry: &'static str) -> Pipeline {
    Pipeline {
        name: name.into(),
        stages: vec![stage(ShaderStage::Compute, file, entry, &[])],
        samples: 1,
        writes_depth: false,
        usual: true,
        comparison: false,
    }
}

fn class_name(key: &FeatherPipelineKey) -> &'static str {
    match key.drawn {
        DrawnCards::Own if key.splits() => "RESOLVED",
        DrawnCards::Own => "all classes",
        DrawnCards::Core => "core",
        DrawnCards::Far => "FAR",
        DrawnCards::Mean => "MEAN",
        DrawnCards::Lit => "LIT",
    }
}

fn feather_name(key: &FeatherPipelineKey, pass: &PassKey) -> String {
    let mut name = format!("feathers {}", class_name(key));
    match key.coverage_method {
        CoverageMethod::Chosen => {}
        method => name += &format!(", {method:?} coverage"),
    }
    if let PassKey::Prepass { directional, .. } = pass {
        name += if *directional {
            ", shadow"
        } else {
            ", prepass"
        };
    }
    let (PassKey::Forward { samples, .. } | PassKey::Prepass { samples, .. }) = *pass;
    name += &match Resolve::choose(key, pass) {
        Resolve::Samples(_) => String::new(),
        Resolve::Decided => ", after a prepass".into(),
        resolve => format!(", {resolve:?}").to_lowercase(),
    };
    if samples > 1 {
        name += &format!(", {samples} samples");
    }
    if let PassKey::Forward { .. } = pass {
        for (set, words) in [
            (key.sampled_environment, ", sampled environment"),
            (key.lights_together, ", lights together"),
            (key.debug, ", debug views"),
            (key.under == DrawnUnder::Lamps, ", lamps"),
            (key.layers == ThinLayers::Even, ", thin layers"),
            (key.layers == ThinLayers::Graded, ", graded thin layers"),
            (
                matches!(
                    key.drawn,
                    DrawnCards::Far | DrawnCards::Mean | DrawnCards::Lit
                ) && !key.plain,
                ", any fibre",
            ),
        ] {
            name += if set { words } else { "" };
        }
    }
    if let PassKey::Prepass { outputs: true, .. } = pass {
        name += ", with outputs";
    }
    name
}

/// What a scene with the default settings and four samples draws, with and without a depth prepass.
fn is_usual(key: &FeatherPipelineKey, pass: &PassKey) -> bool {
    let plain = key.transparency == FeatherTransparency::AlphaToCoverage
        && key.coverage_method == CoverageMethod::Chosen
        && !key.overdraw
        && !key.debug;
    let seen = match *pass {
        PassKey::Forward { samples, .. } => samples == SAMPLES,
        PassKey::Prepass {
            samples,
            directional,
            outputs,
            ..
        } if directional => samples == 1 && !outputs && key.drawn == DrawnCards::Own,
        PassKey::Prepass {
            samples, outputs, ..
        } => samples == SAMPLES && !outputs,
    };
    let listed = matches!(
        pass,
        PassKey::Forward { listed: true, .. } | PassKey::Prepass { listed: true, .. }
    );
    let mean = key.drawn == DrawnCards::Mean;
    // The prepass knows nothing of the options of color.
    let prepared = !matches!(
        pass,
        PassKey::Forward {
            depth_prepass: false,
            ..
        }
    );
    let optional = key.sampled_environment != (key.lights_together && key.plain)
        && key.layers == ThinLayers::None;
    // Thin layers: the three classes without a prepass.
    let default = !key.sampled_environment
        && !key.lights_together
        && (key.layers == ThinLayers::None || !(prepared || key.ordered));
    // Of fibres that are not plain one line tells.
    let after = matches!(
        pass,
        PassKey::Forward {
            depth_prepass: true,
            ..
        }
    );
    let short = matches!(
        key.drawn,
        DrawnCards::Far | DrawnCards::Mean | DrawnCards::Lit
    );
    let fibres = key.plain || !(after && short);
    plain && seen && !listed && fibres && (default || (mean && optional && !prepared))
}

/// A StandardMaterial with alpha mask, albedo and normal map under the same light.
fn standard() -> Vec<Pipeline> {
    let without = |list: &[&'static str]| -> Vec<&'static str> {
        let uvs = |name: &&str| !name.starts_with("VERTEX_UVS");
        list.iter().copied().filter(uvs).collect()
    };
    let own = ["VERTEX_UVS", "VERTEX_UVS_A", "SKINNED", "MAY_DISCARD"];
    let colored = [
        "STANDARD_MATERIAL_NORMAL_MAP",
        "ENVIRONMENT_MAP",
        "MULTISAMPLED",
    ];
    let forward = bools(&[&without(&FORWARD), &own, &colored]);
    let cast = ["UNCLIPPED_DEPTH_ORTHO_EMULATION", "PREPASS_FRAGMENT"];
    let shadow = bools(&[&without(&PREPASS), &own, &cast]);
    let card = |name: &str, files: [&'static str; 2], defs: &[ShaderDefVal], samples| {
        let [vertex, fragment] = files.map(|file| (file, defs.to_vec()));
        let mut made = graphics(
            format!("StandardMaterial card{name}"),
            [vertex, fragment],
            samples,
        );
        for (stage, file) in made.stages.iter_mut().zip(files) {
            stage.file = file.into();
        }
        made
    };
    vec![
        card(
            "",
            ["render/mesh.wgsl", "render/pbr.wgsl"],
            &forward,
            SAMPLES,
        ),
        card(
            ", shadow",
            ["prepass/prepass.wgsl", "render/pbr_prepass.wgsl"],
            &shadow,
            1,
        ),
    ]
}

/// All, in the order of the table.
pub fn all() -> Vec<Pipeline> {
    let mut found = Vec::new();
    for (key, pass) in pipelines(SAMPLES) {
        let (PassKey::Forward { samples, .. } | PassKey::Prepass { samples, .. }) = pass;
        let stages = feather_stages(&key, &pass, true);
        let mut made = graphics(feather_name(&key, &pass), stages, samples);
        made.writes_depth = Resolve::choose(&key, &pass).is_solid();
        made.usual = is_usual(&key, &pass);
        made.comparison = key.coverage_method != CoverageMethod::Chosen;
        found.push(made);
    }
    let [coats, strands] = undercoat::fragment_defs(SAMPLES);
    let view = bools(&[&FORWARD, &["ENVIRONMENT_MAP"]]);
    for (what, file, list) in [
        ("undercoat", "undercoat/undercoat.wgsl", coats),
        ("strands", "undercoat/undercoat_strands.wgsl", strands),
    ] {
        for own in list {
            let has = |name: &str| own.contains(&name.into());
            let mut name = what.to_owned();
            if has("UNDERCOAT_SHELLS") {
                name += ", shells";
            }
            if has("UNDERCOAT_SUNK") {
                name += ", eye inside";
            }
            let samples = if has("SAMPLE_COVERAGE") { SAMPLES } else { 1 };
            name += &format!(", {samples} samples");
            let usual = has("SAMPLE_COVERAGE") || has("UNDERCOAT_SHELLS");
            let mut defs = [view.clone(), own].concat();
            defs.extend((samples > 1).then(|| "MULTISAMPLED".into()));
            let mut made = graphics(name, [(file, defs.clone()), (file, defs)], samples);
            made.usual = usual;
            found.push(made);
        }
    }
    found.push(compute(
        "classes of cards",
        "card/feather_lod.wgsl",
        "classify",
    ));
    found.push(compute(
        "lift by the wind",
        "card/feather_lift.wgsl",
        "lift",
    ));
    let extrude = "undercoat/undercoat_extrude.wgsl";
    found.push(compute("extrusion of the coat", extrude, "extrude"));
    found.extend(standard());
    let mut seen = std::collections::HashSet::new();
    found.retain(|pipeline| seen.insert(pipeline.name.clone()));
    found
}
