//! Pipelines of [`super::FeatherMaterial`]: what [`super::key`] decides, written into Bevy's descriptors.

use super::key::{FeatherPipelineKey, PassKey, Resolve, shader_defs};
use crate::groom::ATTRIBUTE_RAISED;
use bevy::{
    mesh::MeshVertexBufferLayoutRef,
    pbr::MeshPipelineKey,
    prelude::*,
    render::render_resource::{
        CompareFunction, FragmentState, RenderPipelineDescriptor, SpecializedMeshPipelineError,
    },
    shader::ShaderDefVal,
};

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
    if layout.0.contains(ATTRIBUTE_RAISED) {
        attributes.push(ATTRIBUTE_RAISED.at_shader_location(7));
        descriptor.vertex.shader_defs.push("WORN_POSES".into());
    }
    descriptor.vertex.buffers = vec![layout.0.get_layout(&attributes)?];
    Ok(())
}

/// Finishes a pipeline of a color, depth or shadow pass.
pub fn feather_pipeline(
    descriptor: &mut RenderPipelineDescriptor,
    layout: &MeshVertexBufferLayoutRef,
    mesh_key: MeshPipelineKey,
    key: &FeatherPipelineKey,
) -> Result<(), SpecializedMeshPipelineError> {
    lay_out_vertices(descriptor, layout)?;
    // Both faces of a feather show, and both cast shadows.
    descriptor.primitive.cull_mode = None;
    // The shader picks the samples itself, so that prepass and color pass pick the same ones.
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
    let fragment_defs = |name| {
        let fragment = descriptor.fragment.as_ref();
        fragment.is_some_and(|fragment| has_def(&fragment.shader_defs, name))
    };
    let samples = mesh_key.msaa_samples();
    let listed = mesh_key.contains(MeshPipelineKey::OIT_ENABLED);
    let pass = if prepass {
        let emulated = fragment_defs("UNCLIPPED_DEPTH_ORTHO_EMULATION");
        let targets = descriptor.fragment.as_ref().map_or(0, |f| f.targets.len());
        PassKey::Prepass {
            samples,
            listed,
            directional: descriptor.primitive.unclipped_depth || emulated,
            outputs: targets > 0 || emulated,
        }
    } else {
        PassKey::Forward {
            samples,
            listed,
            depth_prepass: mesh_key.contains(MeshPipelineKey::DEPTH_PREPASS),
        }
    };
    let resolve = Resolve::choose(key, &pass);
    let [vertex, fragment] = shader_defs(key, &pass);
    descriptor.vertex.shader_defs.extend(vertex);
    if let Some(stage) = &mut descriptor.fragment {
        stage.shader_defs.extend(fragment);
    }
    if resolve == Resolve::Decided {
        // The depth prepass has said which samples show which card: only those are shaded, each once.
        if let Some(depth) = &mut descriptor.depth_stencil {
            depth.depth_write_enabled = Some(false);
            depth.depth_compare = Some(CompareFunction::Equal);
        }
    } else if matches!(resolve, Resolve::Ordered(_)) {
        // Shifted towards the eye by its window, a fragment passes that lies no further behind the nearest; cards come in the order of
        // their layers ([`super::order`]), so that the highest of them stays.
        if let Some(depth) = &mut descriptor.depth_stencil {
            depth.depth_write_enabled = Some(false);
            depth.depth_compare = Some(CompareFunction::GreaterEqual);
        }
    } else if !prepass && resolve.is_solid() && key.alpha_mode() == AlphaMode::Blend {
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
