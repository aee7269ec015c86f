//! Every WGSL variant that Bevy may ask for is composed and validated by naga, without a GPU.

use bevy::{
    prelude::*,
    render::{
        RenderPlugin,
        settings::{RenderCreation, WgpuSettings},
    },
    shader::{ShaderCache, ShaderCacheError, ShaderCacheSource, ShaderDefVal, ValidateShader},
    window::ExitCondition,
    winit::WinitPlugin,
};
use bevy_plumage::{
    prelude::PlumagePlugins, render::key::pipelines, undercoat::layout as undercoat,
};
use plumage_tests::shaders::{FORWARD, PREPASS, Variant, bools, feather_stages, numbers};
use std::collections::HashSet;

/// Samples of a multisampled camera.
const SAMPLES: u32 = 4;

fn naga_module(
    (): &(),
    source: ShaderCacheSource,
    _: &ValidateShader,
) -> Result<naga::Module, ShaderCacheError> {
    match source {
        ShaderCacheSource::Naga(module) => Ok(module),
        _ => unreachable!("the cache hands over composed modules"),
    }
}

fn app() -> App {
    let mut app = App::new();
    app.add_plugins((
        DefaultPlugins
            .set(WindowPlugin {
                primary_window: None,
                exit_condition: ExitCondition::DontExit,
                ..default()
            })
            .set(RenderPlugin {
                render_creation: RenderCreation::Automatic(Box::new(WgpuSettings {
                    backends: None,
                    ..default()
                })),
                ..default()
            })
            .disable::<WinitPlugin>(),
        PlumagePlugins,
    ));
    app.finish();
    app.cleanup();
    app
}

/// Options of the view, of Bevy's own: each is tried with one kind of material.
const VIEW_OPTIONS: [&[&str]; 12] = [
    &["DISTANCE_FOG", "ENVIRONMENT_MAP", "HASHED"],
    &["ENVIRONMENT_MAP", "HASHED"],
    &["OIT_ENABLED", "FEATHER_FRINGE", "BLENDED", "DEPTH_PREPASS"],
    &[
        "TONEMAP_IN_SHADER",
        "TONEMAP_METHOD_ACES_FITTED",
        "OIT_ENABLED",
        "BLENDED",
    ],
    &[
        "DEPTH_PREPASS",
        "NORMAL_PREPASS",
        "ENVIRONMENT_MAP",
        "DEPTH_DECIDED",
    ],
    &[
        "IRRADIANCE_VOLUMES_ARE_USABLE",
        "IRRADIANCE_VOLUME",
        "ENVIRONMENT_MAP",
        "HASHED",
    ],
    &["IRRADIANCE_VOLUMES_ARE_USABLE", "ENVIRONMENT_MAP", "HASHED"],
    &["CONTACT_SHADOWS", "DEPTH_PREPASS", "HASHED"],
    &["SCREEN_SPACE_AMBIENT_OCCLUSION", "DEPTH_PREPASS", "HASHED"],
    &["ATMOSPHERE", "SAMPLE_COVERAGE", "MULTISAMPLED"],
    &["VISIBILITY_RANGE_DITHER", "HASHED"],
    &["SAMPLED_ENVIRONMENT", "HASHED"],
];
const PREPASS_VIEW_OPTIONS: [&[&str]; 2] = [
    &[
        "NORMAL_PREPASS",
        "MOTION_VECTOR_PREPASS",
        "PREPASS_FRAGMENT",
        "FEATHER_PREPASS_OUTPUT",
        "SAMPLE_COVERAGE",
    ],
    &[
        "MOTION_VECTOR_PREPASS",
        "HAS_PREVIOUS_SKIN",
        "VISIBILITY_RANGE_DITHER",
        "PREPASS_FRAGMENT",
        "FEATHER_PREPASS_OUTPUT",
        "HASHED",
    ],
];

/// Coats in the surroundings that occur.
const UNDERCOAT_OPTIONS: [&[&str]; 6] = [
    &["ENVIRONMENT_MAP", "MULTISAMPLED"],
    &["TONEMAP_IN_SHADER", "TONEMAP_METHOD_ACES_FITTED"],
    &["DISTANCE_FOG", "ENVIRONMENT_MAP"],
    &[
        "IRRADIANCE_VOLUMES_ARE_USABLE",
        "IRRADIANCE_VOLUME",
        "ENVIRONMENT_MAP",
    ],
    &["SCREEN_SPACE_AMBIENT_OCCLUSION", "DEPTH_PREPASS"],
    &["CONTACT_SHADOWS", "DEPTH_PREPASS", "MULTISAMPLED"],
];

/// What the plugin adds, over what Bevy says of the same pass.
fn feather_variants() -> Vec<Variant> {
    let mut all = Vec::new();
    for (key, pass) in pipelines(SAMPLES) {
        for skinned in [false, true] {
            all.extend(feather_stages(&key, &pass, skinned));
        }
    }
    all
}

fn variants() -> Vec<Variant> {
    let mut all = feather_variants();
    for options in VIEW_OPTIONS {
        all.push(("card/feather.wgsl", bools(&[&FORWARD, options])));
        all.push(("card/feather_vertex.wgsl", bools(&[&FORWARD, options])));
    }
    for options in PREPASS_VIEW_OPTIONS {
        let defs = bools(&[&PREPASS, &["SKINNED"], options]);
        all.push(("card/feather_prepass.wgsl", defs));
    }
    all.push(("card/feather_lod.wgsl", Vec::new()));
    all.push(("card/feather_lift.wgsl", Vec::new()));
    all.push(("card/feather_hide.wgsl", Vec::new()));
    all.push(("card/feather_skin.wgsl", Vec::new()));
    all.push(("card/feather_lists.wgsl", Vec::new()));
    let [coats, strands] = undercoat::fragment_defs(SAMPLES);
    for (file, made) in [
        ("undercoat/undercoat.wgsl", coats),
        ("undercoat/undercoat_strands.wgsl", strands),
    ] {
        for own in &made {
            all.push((
                file,
                [bools(&[&FORWARD, &["ENVIRONMENT_MAP"]]), own.clone()].concat(),
            ));
        }
        for options in UNDERCOAT_OPTIONS {
            let own = made[0].clone();
            all.push((file, [bools(&[&FORWARD, options]), own].concat()));
        }
    }
    all.push(("undercoat/undercoat_extrude.wgsl", Vec::new()));
    // Many materials and passes come to the same.
    let mut seen = HashSet::new();
    for (_, defs) in &mut all {
        let mut names = HashSet::new();
        defs.retain(|def| names.insert(format!("{def:?}")));
    }
    all.retain(|(file, defs)| {
        let mut names: Vec<String> = defs.iter().map(|def| format!("{def:?}")).collect();
        names.sort();
        seen.insert((*file, names))
    });
    all
}

/// The lists that go wrong when they are kept by hand: what the default camera draws is in them.
#[test]
fn variants_follow_from_the_pipelines() {
    let all = variants();
    let has = |file: &str, names: &[&str]| {
        all.iter().any(|(known, defs)| {
            *known == file && names.iter().all(|name| defs.contains(&(*name).into()))
        })
    };
    for class in ["ONLY_RESOLVED", "ONLY_FAR", "ONLY_MEAN"] {
        for resolve in ["SAMPLE_COVERAGE", "HASHED", "DEPTH_DECIDED"] {
            assert!(
                has("card/feather.wgsl", &[class, resolve]),
                "{class} {resolve}"
            );
        }
        assert!(
            has("card/feather_prepass.wgsl", &[class, "SAMPLE_COVERAGE"]),
            "{class}"
        );
    }
    for method in ["PUBLISHED_COVERAGE", "SUPERSAMPLED_COVERAGE"] {
        assert!(has("card/feather.wgsl", &[method]), "{method}");
    }
    assert!(has("undercoat/undercoat.wgsl", &["UNDERCOAT_SUNK"]));
}

/// Every file of WGSL that the plugin registers is one that an entry shader imports, directly or not.
#[test]
fn every_registered_library_is_reached() {
    let folder = plumage_tests::root().join("src/shaders");
    let registration = std::fs::read_to_string(folder.join("mod.rs")).unwrap();
    let registered = |call: &str| -> Vec<String> {
        let calls = registration.lines().filter(|line| line.contains(call));
        let file = |line: &str| line.split('"').nth(1).map(str::to_owned);
        calls.filter_map(file).collect()
    };
    let source = |file: &str| std::fs::read_to_string(folder.join(file)).unwrap();
    let libraries = registered("load_shader_library!(");
    let entries = registered("embedded_asset!(");
    assert!(libraries.len() > 30 && entries.len() >= 7);
    let path = |file: &str| {
        let text = source(file);
        let line = text
            .lines()
            .find_map(|line| line.strip_prefix("#define_import_path "));
        line.unwrap_or_else(|| panic!("{file} is no library"))
            .to_owned()
    };
    let names: Vec<(String, String)> = libraries
        .iter()
        .map(|file| (path(file), file.clone()))
        .collect();
    let mut reached = HashSet::new();
    let mut waiting = entries.clone();
    while let Some(file) = waiting.pop() {
        let text = source(&file);
        for (path, library) in &names {
            let name = path.trim_start_matches("bevy_plumage::");
            // In a list of imports, or as one.
            let imports = imports_of(&text);
            if imports.contains(name) && reached.insert(library.clone()) {
                waiting.push(library.clone());
            }
        }
    }
    for library in &libraries {
        assert!(
            reached.contains(library),
            "no entry shader reaches {library}"
        );
    }
    for room in ["maths", "card", "undercoat", "comparison"] {
        for entry in std::fs::read_dir(folder.join(room)).unwrap() {
            let name = entry.unwrap().file_name().into_string().unwrap();
            let file = format!("{room}/{name}");
            assert!(
                libraries.contains(&file) || entries.contains(&file),
                "{file} is not registered"
            );
        }
    }
}

/// Names of the modules of `bevy_plumage` that a text imports.
fn imports_of(text: &str) -> HashSet<String> {
    let mut found = HashSet::new();
    let mut lists = text;
    while let Some(at) = lists.find("#import bevy_plumage::") {
        lists = &lists[at + "#import bevy_plumage::".len()..];
        let word = |text: &str| -> String {
            text.chars()
                .take_while(|c| c.is_alphanumeric() || *c == '_')
                .collect()
        };
        let Some(inside) = lists.strip_prefix('{') else {
            found.insert(word(lists));
            continue;
        };
        // The first word after the brace and after each comma of the outer list.
        let (mut depth, mut starts) = (1, true);
        let mut rest = inside.chars();
        while let Some(c) = rest.next() {
            match c {
                '{' => depth += 1,
                '}' => depth -= 1,
                ',' if depth == 1 => starts = true,
                c if starts && (c.is_alphanumeric() || c == '_') => {
                    found.insert(format!("{c}{}", word(rest.as_str())));
                    starts = false;
                }
                _ => {}
            }
            if depth == 0 {
                break;
            }
        }
    }
    found
}

/// Whether these shaders and all modules that they import are loaded: each comes from a file of its own.
fn complete(shaders: &Assets<Shader>, handles: &[Handle<Shader>]) -> bool {
    let mut waiting: Vec<&Shader> = handles.iter().filter_map(|h| shaders.get(h)).collect();
    if waiting.len() < handles.len() {
        return false;
    }
    let mut seen = HashSet::new();
    while let Some(shader) = waiting.pop() {
        for import in &shader.imports {
            if !seen.insert(import) {
                continue;
            }
            let mut all = shaders.iter().map(|(_, other)| other);
            let Some(found) = all.find(|other| other.import_path == *import) else {
                return false;
            };
            waiting.push(found);
        }
    }
    true
}

#[test]
fn every_variant_is_valid() {
    let mut app = app();
    let files = [
        "card/feather.wgsl",
        "card/feather_vertex.wgsl",
        "card/feather_prepass.wgsl",
        "card/feather_lod.wgsl",
        "card/feather_lift.wgsl",
        "card/feather_hide.wgsl",
        "card/feather_skin.wgsl",
        "card/feather_lists.wgsl",
        "undercoat/undercoat.wgsl",
        "undercoat/undercoat_strands.wgsl",
        "undercoat/undercoat_extrude.wgsl",
    ];
    let handles: Vec<Handle<Shader>> = {
        let server = app.world().resource::<AssetServer>();
        files
            .iter()
            .map(|file| server.load(format!("embedded://bevy_plumage/shaders/{file}")))
            .collect()
    };
    plumage_tests::wait::until("the shaders and what they import", || {
        app.update();
        let shaders = app.world().resource::<Assets<Shader>>();
        complete(shaders, &handles).then_some(())
    });
    let mut cache = ShaderCache::<naga::Module, ()>::new(
        (),
        wgpu_types::Features::all_webgpu_mask(),
        wgpu_types::DownlevelFlags::all(),
        naga_module,
    );
    for (id, shader) in app.world().resource::<Assets<Shader>>().iter() {
        let mut shader = shader.clone();
        shader.shader_defs.push(ShaderDefVal::UInt(
            "AVAILABLE_STORAGE_BUFFER_BINDINGS".into(),
            8,
        ));
        cache.set_shader(id, shader);
    }
    let mut failures = Vec::new();
    let variants = variants();
    eprintln!("{} variants", variants.len());
    for (file, mut defs) in variants {
        let handle = &handles[files
            .iter()
            .position(|f| *f == file)
            .expect("a file that is loaded")];
        let names = defs.clone();
        for (name, value) in numbers(SAMPLES) {
            defs.retain(|def| !matches!(def, ShaderDefVal::UInt(known, _) if known == name));
            defs.push(ShaderDefVal::UInt(name.into(), value));
        }
        if names.contains(&"TONEMAP_IN_SHADER".into()) {
            for (name, value) in [
                ("TONEMAPPING_LUT_TEXTURE_BINDING_INDEX", 18),
                ("TONEMAPPING_LUT_SAMPLER_BINDING_INDEX", 19),
            ] {
                defs.push(ShaderDefVal::UInt(name.into(), value));
            }
        }
        match cache.get(0, handle.id(), &defs) {
            Ok(module) => {
                let found = naga::valid::Validator::new(
                    naga::valid::ValidationFlags::all(),
                    naga::valid::Capabilities::all(),
                )
                .validate(&module);
                if let Err(error) = found {
                    failures.push(format!("{file} {names:?}: {}", error.emit_to_string("")));
                }
            }
            Err(ShaderCacheError::ProcessShaderError(error)) => failures.push(format!(
                "{file} {names:?}: {}",
                error.emit_to_string(&cache.composer)
            )),
            Err(error) => failures.push(format!("{file} {names:?}: {error:?}")),
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n\n"));
}
