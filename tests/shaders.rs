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
const PREPASS: [&str; 5] = [
    "PREPASS_PIPELINE",
    "VERTEX_POSITIONS",
    "VERTEX_UVS_A",
    "VERTEX_UVS_B",
    "MAY_DISCARD",
];

fn variants() -> Vec<(&'static str, Vec<&'static str>)> {
    let mut all = Vec::new();
    for skinned in [&[] as &[&str], &["SKINNED"]] {
        for options in [
            &[] as &[&str],
            &["ENVIRONMENT_MAP"],
            &["ENVIRONMENT_MAP", "ALPHA_TO_COVERAGE", "MULTISAMPLED"],
            &["PUBLISHED_COVERAGE", "ENVIRONMENT_MAP"],
            &["SUPERSAMPLED_COVERAGE", "ENVIRONMENT_MAP"],
            &["DISTANCE_FOG", "ENVIRONMENT_MAP"],
            &["OIT_ENABLED", "ENVIRONMENT_MAP"],
            &[
                "TONEMAP_IN_SHADER",
                "TONEMAP_METHOD_ACES_FITTED",
                "OIT_ENABLED",
            ],
            &["DEPTH_PREPASS", "NORMAL_PREPASS", "ENVIRONMENT_MAP"],
            &["IRRADIANCE_VOLUMES_ARE_USABLE", "ENVIRONMENT_MAP"],
        ] {
            for file in ["feather.wgsl", "feather_vertex.wgsl"] {
                let defs = FORWARD.iter().chain(skinned).chain(options).copied();
                all.push((file, defs.collect()));
            }
        }
        for options in [
            &[] as &[&str],
            &["UNCLIPPED_DEPTH_ORTHO_EMULATION", "PREPASS_FRAGMENT"],
        ] {
            for file in ["feather_prepass.wgsl", "feather_vertex.wgsl"] {
                let defs = PREPASS.iter().chain(skinned).chain(options).copied();
                all.push((file, defs.collect()));
            }
        }
    }
    all.push(("feather_lod.wgsl", Vec::new()));
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
