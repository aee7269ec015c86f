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
use bevy_plumage::prelude::PlumagePlugins;
use std::time::{Duration, Instant};

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

/// The defs of the forward pass without options.
const FORWARD: [&str; 9] = [
    "MESH_PIPELINE",
    "VERTEX_OUTPUT_INSTANCE_INDEX",
    "VERTEX_POSITIONS",
    "VERTEX_NORMALS",
    "VERTEX_UVS_A",
    "VERTEX_UVS_B",
    "VERTEX_TANGENTS",
    "VIEW_PROJECTION_PERSPECTIVE",
    "SHADOW_FILTER_METHOD_GAUSSIAN",
];
const PREPASS: [&str; 7] = [
    "PREPASS_PIPELINE",
    "VERTEX_POSITIONS",
    "VERTEX_UVS_A",
    "VERTEX_UVS_B",
    "VERTEX_NORMALS",
    "VERTEX_TANGENTS",
    "DEPTH_PREPASS",
];

/// Options of the view and the ways of transparency, in the combinations that occur.
const FORWARD_OPTIONS: [&[&str]; 24] = [
    &["ONLY_RESOLVED", "ENVIRONMENT_MAP"],
    &["ONLY_FAR", "ENVIRONMENT_MAP", "HASHED"],
    &["ONLY_MEAN", "ENVIRONMENT_MAP", "HASHED"],
    &["PUBLISHED_COVERAGE", "ENVIRONMENT_MAP"],
    &["SUPERSAMPLED_COVERAGE", "ENVIRONMENT_MAP"],
    &["SAMPLED_ENVIRONMENT"],
    &["SAMPLED_ENVIRONMENT", "ENVIRONMENT_MAP"],
    &["HASHED"],
    &["ENVIRONMENT_MAP", "HASHED"],
    &["ENVIRONMENT_MAP", "SAMPLE_COVERAGE", "MULTISAMPLED"],
    &["DISTANCE_FOG", "ENVIRONMENT_MAP", "HASHED"],
    &[
        "OIT_ENABLED",
        "FEATHER_FRINGE",
        "BLENDED",
        "ENVIRONMENT_MAP",
    ],
    &["OIT_ENABLED", "FEATHER_FRINGE", "BLENDED", "DEPTH_PREPASS"],
    &["FEATHER_CORE"],
    &["BLENDED"],
    &["OVERDRAW"],
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
        "HASHED",
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
];
const PREPASS_OPTIONS: [&[&str]; 8] = [
    &["ONLY_MEAN", "HASHED"],
    &["HASHED"],
    &["FEATHER_CORE"],
    &["SAMPLE_COVERAGE", "FEATHER_PREPASS_OUTPUT"],
    &[
        "UNCLIPPED_DEPTH_ORTHO_EMULATION",
        "PREPASS_FRAGMENT",
        "FEATHER_PREPASS_OUTPUT",
        "DIRECTIONAL_SHADOW",
        "HASHED",
    ],
    &[
        "NORMAL_PREPASS",
        "PREPASS_FRAGMENT",
        "FEATHER_PREPASS_OUTPUT",
        "HASHED",
    ],
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

/// Coats: marched or as shells, with samples or without, in the surroundings that occur.
const UNDERCOAT_OPTIONS: [&[&str]; 8] = [
    &[],
    &["ENVIRONMENT_MAP", "SAMPLE_COVERAGE", "MULTISAMPLED"],
    &["ENVIRONMENT_MAP", "UNDERCOAT_SHELLS", "BLENDED"],
    &[
        "UNDERCOAT_SHELLS",
        "TONEMAP_IN_SHADER",
        "TONEMAP_METHOD_ACES_FITTED",
    ],
    &["DISTANCE_FOG", "ENVIRONMENT_MAP"],
    &[
        "IRRADIANCE_VOLUMES_ARE_USABLE",
        "IRRADIANCE_VOLUME",
        "ENVIRONMENT_MAP",
    ],
    &["SCREEN_SPACE_AMBIENT_OCCLUSION", "DEPTH_PREPASS"],
    &[
        "CONTACT_SHADOWS",
        "DEPTH_PREPASS",
        "SAMPLE_COVERAGE",
        "MULTISAMPLED",
    ],
];

fn variants() -> Vec<(&'static str, Vec<&'static str>)> {
    let mut all = Vec::new();
    for skinned in [&[] as &[&str], &["SKINNED"]] {
        for options in FORWARD_OPTIONS {
            for file in ["feather.wgsl", "feather_vertex.wgsl"] {
                let defs = FORWARD.iter().chain(skinned).chain(options).copied();
                all.push((file, defs.collect()));
            }
        }
        for options in PREPASS_OPTIONS {
            let defs = PREPASS.iter().chain(skinned).chain(options).copied();
            all.push(("feather_prepass.wgsl", defs.collect()));
        }
    }
    all.push(("feather_lod.wgsl", Vec::new()));
    for options in UNDERCOAT_OPTIONS {
        for file in ["undercoat.wgsl", "undercoat_strands.wgsl"] {
            let defs = FORWARD.iter().chain(options).copied();
            all.push((file, defs.collect()));
        }
    }
    all.push(("undercoat_extrude.wgsl", Vec::new()));
    all
}

#[test]
fn every_variant_is_valid() {
    let mut app = app();
    let start = Instant::now();
    let files = [
        "feather.wgsl",
        "feather_vertex.wgsl",
        "feather_prepass.wgsl",
        "feather_lod.wgsl",
        "undercoat.wgsl",
        "undercoat_strands.wgsl",
        "undercoat_extrude.wgsl",
    ];
    let handles: Vec<Handle<Shader>> = {
        let server = app.world().resource::<AssetServer>();
        files
            .iter()
            .map(|file| server.load(format!("embedded://bevy_plumage/shaders/{file}")))
            .collect()
    };
    loop {
        app.update();
        let shaders = app.world().resource::<Assets<Shader>>();
        if handles.iter().all(|handle| shaders.contains(handle.id())) {
            break;
        }
        assert!(
            start.elapsed() < Duration::from_secs(30),
            "shaders did not load"
        );
        std::thread::sleep(Duration::from_millis(2));
    }
    for _ in 0..20 {
        app.update();
        std::thread::sleep(Duration::from_millis(2));
    }
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
    for (file, names) in variants() {
        let handle = &handles[files.iter().position(|f| *f == file).unwrap_or_default()];
        let mut defs: Vec<ShaderDefVal> = names.iter().map(|name| (*name).into()).collect();
        for (name, value) in [
            ("MATERIAL_BIND_GROUP", 3),
            ("MAX_DIRECTIONAL_LIGHTS", 10),
            ("MAX_CASCADES_PER_LIGHT", 4),
            ("MAX_RECT_LIGHTS", 8),
            ("FEATHER_SAMPLES", 4),
            ("UNDERCOAT_SAMPLES", 4),
            ("PER_OBJECT_BUFFER_BATCH_SIZE", 64),
        ] {
            defs.push(ShaderDefVal::UInt(name.into(), value));
        }
        if names.contains(&"TONEMAP_IN_SHADER") {
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
