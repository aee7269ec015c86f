//! The definitions under which Bevy asks for the plugin's shaders: those of its own passes, and what the plugin adds.

use bevy::shader::ShaderDefVal;
use bevy_plumage::render::key::{FeatherPipelineKey, PassKey, shader_defs};

/// A file below `src/shaders` and its definitions.
pub type Variant = (&'static str, Vec<ShaderDefVal>);

/// The defs of the forward pass without options.
pub const FORWARD: [&str; 9] = [
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
/// The defs of the depth and shadow passes without options.
pub const PREPASS: [&str; 7] = [
    "PREPASS_PIPELINE",
    "VERTEX_POSITIONS",
    "VERTEX_UVS_A",
    "VERTEX_UVS_B",
    "VERTEX_NORMALS",
    "VERTEX_TANGENTS",
    "DEPTH_PREPASS",
];

/// Definitions without a value.
pub fn bools(names: &[&[&str]]) -> Vec<ShaderDefVal> {
    names.concat().into_iter().map(Into::into).collect()
}

/// Definitions with a value that every pass has.
pub fn numbers(samples: u32) -> [(&'static str, u32); 7] {
    [
        ("MATERIAL_BIND_GROUP", 3),
        ("MAX_DIRECTIONAL_LIGHTS", 10),
        ("MAX_CASCADES_PER_LIGHT", 4),
        ("MAX_RECT_LIGHTS", 8),
        ("FEATHER_SAMPLES", samples),
        ("UNDERCOAT_SAMPLES", samples),
        ("PER_OBJECT_BUFFER_BATCH_SIZE", 64),
    ]
}

/// Vertex and fragment stage of a material in a pass, under an environment map.
pub fn feather_stages(key: &FeatherPipelineKey, pass: &PassKey, skinned: bool) -> [Variant; 2] {
    let skin: &[&str] = if skinned {
        &["SKINNED", "WORN_POSES"]
    } else {
        &[]
    };
    let [own_vertex, own_fragment] = shader_defs(key, pass);
    match *pass {
        PassKey::Forward {
            samples,
            listed,
            depth_prepass,
        } => {
            let mut view = vec!["ENVIRONMENT_MAP"];
            view.extend((samples > 1).then_some("MULTISAMPLED"));
            view.extend(listed.then_some("OIT_ENABLED"));
            view.extend(depth_prepass.then_some("DEPTH_PREPASS"));
            let vertex = [bools(&[&FORWARD, skin]), own_vertex].concat();
            let fragment = [bools(&[&FORWARD, &view]), own_fragment].concat();
            [
                ("card/feather_vertex.wgsl", vertex),
                ("card/feather.wgsl", fragment),
            ]
        }
        PassKey::Prepass {
            samples,
            directional,
            outputs,
            ..
        } => {
            let mut view = Vec::new();
            view.extend((samples > 1).then_some("MULTISAMPLED"));
            view.extend(directional.then_some("UNCLIPPED_DEPTH_ORTHO_EMULATION"));
            if outputs {
                view.extend(["NORMAL_PREPASS", "PREPASS_FRAGMENT"]);
            }
            // Both stages are in one file.
            let defs = [bools(&[&PREPASS, &view, skin]), own_fragment].concat();
            let file = "card/feather_prepass.wgsl";
            [(file, defs.clone()), (file, defs)]
        }
    }
}
