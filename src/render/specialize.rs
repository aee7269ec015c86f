//! Pipelines of [`super::FeatherMaterial`]: how coverage becomes pixels in the view at hand.

use super::material::{DrawnCards, FeatherPipelineKey, FeatherTransparency};
use bevy::{
    mesh::MeshVertexBufferLayoutRef,
    pbr::MeshPipelineKey,
    prelude::*,
    render::render_resource::{
        CompareFunction, FragmentState, RenderPipelineDescriptor, SpecializedMeshPipelineError,
    },
    shader::ShaderDefVal,
};

/// What one pipeline does with a fragment's coverage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Resolve {
    /// It becomes samples of the multisampled target.
    Samples(u32),
    /// There or not, by a pattern on the card.
    Hashed,
    /// Only almost opaque fragments.
    Core,
    /// Only the others, into the camera's list of transparent fragments.
    Fringe,
    /// All fragments, into the list.
    List,
    /// Alpha blending.
    Blend,
    /// Fragments are counted.
    Overdraw,
}

impl Resolve {
    fn choose(key: &FeatherPipelineKey, mesh_key: MeshPipelineKey) -> Self {
        let samples = mesh_key.msaa_samples();
        let listed = mesh_key.contains(MeshPipelineKey::OIT_ENABLED);
        let solid = if samples > 1 {
            Self::Samples(samples)
        } else {
            Self::Hashed
        };
        match key.transparency {
            _ if key.overdraw => Self::Overdraw,
            _ if key.drawn == DrawnCards::Core => Self::Core,
            FeatherTransparency::AlphaToCoverage => solid,
            FeatherTransparency::Hashed => Self::Hashed,
            FeatherTransparency::OrderIndependent if listed => Self::Fringe,
            FeatherTransparency::OrderIndependent => solid,
            FeatherTransparency::Blend if listed => Self::List,
            FeatherTransparency::Blend => Self::Blend,
        }
    }

    fn shader_defs(self) -> Vec<ShaderDefVal> {
        match self {
            Self::Samples(count) => vec![
                "SAMPLE_COVERAGE".into(),
                ShaderDefVal::UInt("FEATHER_SAMPLES".into(), count),
            ],
            Self::Hashed => vec!["HASHED".into()],
            Self::Core => vec!["FEATHER_CORE".into()],
            Self::Fringe => vec!["FEATHER_FRINGE".into(), "BLENDED".into()],
            Self::List | Self::Blend => vec!["BLENDED".into()],
            Self::Overdraw => Vec::new(),
        }
    }
}

fn has_def(defs: &[ShaderDefVal], name: &str) -> bool {
    defs.iter()
        .any(|def| matches!(def, ShaderDefVal::Bool(known, true) if known == name))
}

/// Attributes at the locations of `CardVertex` in `feather_io.wgsl`, the same in every pass.
fn lay_out_vertices(
    descriptor: &mut RenderPipelineDescriptor,
    layout: &MeshVertexBufferLayoutRef,
) -> Result<(), SpecializedMeshPipelineError> {
    let mut attributes = vec![
        Mesh::ATTRIBUTE_POSITION.at_shader_location(0),
        Mesh::ATTRIBUTE_NORMAL.at_shader_location(1),
        Mesh::ATTRIBUTE_UV_0.at_shader_location(2),
        Mesh::ATTRIBUTE_UV_1.at_shader_location(3),
        Mesh::ATTRIBUTE_TANGENT.at_shader_location(4),
    ];
    if has_def(&descriptor.vertex.shader_defs, "SKINNED") {
        attributes.push(Mesh::ATTRIBUTE_JOINT_INDEX.at_shader_location(5));
        attributes.push(Mesh::ATTRIBUTE_JOINT_WEIGHT.at_shader_location(6));
    }
    descriptor.vertex.buffers = vec![layout.0.get_layout(&attributes)?];
    Ok(())
}

/// Finishes a pipeline of a colour, depth or shadow pass.
pub fn feather_pipeline(
    descriptor: &mut RenderPipelineDescriptor,
    layout: &MeshVertexBufferLayoutRef,
    mesh_key: MeshPipelineKey,
    key: &FeatherPipelineKey,
) -> Result<(), SpecializedMeshPipelineError> {
    lay_out_vertices(descriptor, layout)?;
    // Both faces of a feather show, and both cast shadows.
    descriptor.primitive.cull_mode = None;
    // The shader picks the samples itself, so that prepass and colour pass pick the same ones.
    descriptor.multisample.alpha_to_coverage_enabled = false;
    let prepass = has_def(&descriptor.vertex.shader_defs, "PREPASS_PIPELINE");
    if prepass && descriptor.fragment.is_none() {
        // Bevy leaves the fragment stage out where a multisampled material does not discard; feathers would be whole cards.
        descriptor.fragment = Some(FragmentState {
            shader: descriptor.vertex.shader.clone(),
            shader_defs: descriptor.vertex.shader_defs.clone(),
            ..default()
        });
    }
    let resolve = Resolve::choose(key, mesh_key);
    let mut defs = key.shader_defs();
    defs.extend(resolve.shader_defs());
    descriptor.vertex.shader_defs.extend(key.shader_defs());
    if let Some(fragment) = &mut descriptor.fragment {
        if prepass {
            let emulated = has_def(&fragment.shader_defs, "UNCLIPPED_DEPTH_ORTHO_EMULATION");
            if descriptor.primitive.unclipped_depth || emulated {
                defs.push("DIRECTIONAL_SHADOW".into());
            }
            let outputs = !fragment.targets.is_empty() || emulated;
            if outputs || matches!(resolve, Resolve::Samples(_)) {
                defs.push("FEATHER_PREPASS_OUTPUT".into());
            }
        }
        fragment.shader_defs.extend(defs);
    }
    if !prepass
        && mesh_key.intersection(MeshPipelineKey::BLEND_RESERVED_BITS)
            == MeshPipelineKey::BLEND_ALPHA
        && matches!(resolve, Resolve::Samples(_) | Resolve::Hashed)
    {
        // A camera without a list of transparent fragments: solid, though in the phase of the transparent ones.
        if let Some(depth) = &mut descriptor.depth_stencil {
            depth.depth_write_enabled = Some(true);
            depth.depth_compare = Some(CompareFunction::GreaterEqual);
        }
        let targets = descriptor.fragment.iter_mut().flat_map(|f| &mut f.targets);
        targets.flatten().for_each(|target| target.blend = None);
    }
    Ok(())
}
