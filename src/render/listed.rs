//! Feathers drawn from the lists of their class (docs/book/lod.md#lists). Where a bird has none, or a camera culls what was drawn in the
//! frame before, its whole mesh is drawn, and vertices of other classes leave no pixels.

use super::{
    extra_draws::ExtraDraw,
    key::{DrawnCards, DrawnUnder},
    lights::WorldLights,
    lod::{CardLists, ListedDraw},
    material::FeatherMaterial,
};
use crate::groom::PlumageCards;
use bevy::{
    camera::visibility::VisibilityRange,
    core_pipeline::{
        core_3d::{AlphaMask3d, Opaque3d},
        prepass::{AlphaMask3dPrepass, Opaque3dPrepass},
    },
    ecs::{
        query::ROQueryItem,
        system::{SystemParamItem, lifetimeless::SRes},
    },
    material::labels::DrawFunctionLabel,
    pbr::{
        DrawMesh, MainPassAlphaMaskDrawFunction, MainPassOpaqueDrawFunction, MeshMaterial3d,
        PreparedMaterial, PrepassAlphaMaskDrawFunction, PrepassOpaqueDrawFunction,
        PreprocessPipelines, SetMaterialBindGroup, SetMeshBindGroup, SetMeshViewBindGroup,
        SetMeshViewBindingArrayBindGroup, SetPrepassViewBindGroup, SetPrepassViewEmptyBindGroup,
    },
    prelude::*,
    render::{
        Extract, Render, RenderApp, RenderSystems,
        erased_render_asset::{ErasedRenderAssets, prepare_erased_assets},
        mesh::allocator::MeshAllocator,
        occlusion_culling::OcclusionCulling,
        render_phase::{
            AddRenderCommand, DrawFunctionId, DrawFunctions, PhaseItem, PhaseItemExtraIndex,
            RenderCommand, RenderCommandResult, SetItemPipeline, TrackedRenderPass,
        },
        render_resource::PipelineCache,
        renderer::RenderQueue,
    },
};
use std::{any::TypeId, sync::Arc};

/// Passes of [`CardLists::draw`].
const DEPTH: u32 = 0;
const COLOR: u32 = 1;

/// Bevy's own draw of a material's color, from a list.
type DrawColor = (
    SetItemPipeline,
    SetMeshViewBindGroup<0>,
    SetMeshViewBindingArrayBindGroup<1>,
    SetMeshBindGroup<2>,
    SetMaterialBindGroup<3>,
    DrawListed<COLOR>,
);

/// Bevy's own draw of a material's depth, from a list.
type DrawDepth = (
    SetItemPipeline,
    SetPrepassViewBindGroup<0>,
    SetPrepassViewEmptyBindGroup<1>,
    SetMeshBindGroup<2>,
    SetMaterialBindGroup<3>,
    DrawListed<DEPTH>,
);

pub(super) fn add_systems(app: &mut App) {
    let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
        return;
    };
    render_app
        .add_render_command::<Opaque3d, DrawColor>()
        .add_render_command::<AlphaMask3d, DrawColor>()
        .add_render_command::<Opaque3dPrepass, DrawDepth>()
        .add_render_command::<AlphaMask3dPrepass, DrawDepth>()
        .add_systems(ExtractSchedule, extract_parts)
        .add_systems(
            Render,
            draw_by_lists
                .in_set(RenderSystems::PrepareAssets)
                .after(prepare_erased_assets::<MeshMaterial3d<FeatherMaterial>>),
        );
}

/// Which list each entity draws, and which ones are for other lights than there are. What has a visibility range is culled by it on the
/// GPU, too, which a list knows nothing of.
fn extract_parts(
    mut lists: ResMut<CardLists>,
    parts: Extract<
        Query<
            (
                Entity,
                &MeshMaterial3d<FeatherMaterial>,
                Has<PlumageCards>,
                Has<VisibilityRange>,
                Option<&ChildOf>,
            ),
            Or<(With<PlumageCards>, With<ExtraDraw>)>,
        >,
    >,
    materials: Extract<Res<Assets<FeatherMaterial>>>,
    lights: Extract<Res<WorldLights>>,
) {
    let idle = if lights.has_lamps() {
        DrawnUnder::Suns
    } else {
        DrawnUnder::Lamps
    };
    lists.clear_parts();
    for (part, material, is_bird, has_range, of) in &parts {
        let Some(material) = materials.get(material.id()).filter(|own| own.splits()) else {
            continue;
        };
        if material.under == idle {
            lists.add_idle(part.into());
            continue;
        }
        if has_range {
            continue;
        }
        let list = match material.drawn {
            DrawnCards::Own => 0,
            DrawnCards::Far => 1,
            DrawnCards::Mean => 2,
            DrawnCards::Lit => 3,
            DrawnCards::Core => continue,
        };
        let bird = of.map(ChildOf::parent).filter(|_| !is_bird);
        lists.add_part(part.into(), bird.unwrap_or(part).into(), list);
    }
}

/// Lets materials of feathers that were prepared in this frame be drawn by lists.
fn draw_by_lists(
    mut materials: ResMut<ErasedRenderAssets<PreparedMaterial>>,
    opaque: Res<DrawFunctions<Opaque3d>>,
    mask: Res<DrawFunctions<AlphaMask3d>>,
    opaque_depth: Res<DrawFunctions<Opaque3dPrepass>>,
    mask_depth: Res<DrawFunctions<AlphaMask3dPrepass>>,
) {
    let depth = opaque_depth.read().id::<DrawDepth>();
    // Not the function of depth alone: Bevy draws meshes of several materials in one draw with it, by the bind group of the first.
    let own: [(_, DrawFunctionId); 4] = [
        (
            MainPassOpaqueDrawFunction.intern(),
            opaque.read().id::<DrawColor>(),
        ),
        (
            MainPassAlphaMaskDrawFunction.intern(),
            mask.read().id::<DrawColor>(),
        ),
        (PrepassOpaqueDrawFunction.intern(), depth),
        (
            PrepassAlphaMaskDrawFunction.intern(),
            mask_depth.read().id::<DrawDepth>(),
        ),
    ];
    for (id, material) in materials.iter_mut() {
        if id.type_id() != TypeId::of::<FeatherMaterial>() {
            continue;
        }
        // Nobody else has it in the frame that prepares it.
        let Some(properties) = Arc::get_mut(&mut material.properties) else {
            continue;
        };
        for (label, function) in &mut properties.draw_functions {
            if let Some((_, own)) = own.iter().find(|(own, _)| own == label) {
                *function = *own;
            }
        }
    }
}

/// Draws a list, or the mesh.
struct DrawListed<const PASS: u32>;

/// Whether Bevy can write where the meshes are.
fn is_placed(pipelines: &PreprocessPipelines, cache: &PipelineCache) -> bool {
    [
        pipelines.direct_preprocess.pipeline_id,
        pipelines.gpu_frustum_culling_preprocess.pipeline_id,
        pipelines.bin_unpacking.pipeline_id,
    ]
    .into_iter()
    .all(|id| id.is_some_and(|id| cache.get_compute_pipeline(id).is_some()))
}

impl<P: PhaseItem, const PASS: u32> RenderCommand<P> for DrawListed<PASS> {
    type Param = (
        SRes<CardLists>,
        SRes<MeshAllocator>,
        SRes<RenderQueue>,
        SRes<PipelineCache>,
        Option<SRes<PreprocessPipelines>>,
        <DrawMesh as RenderCommand<P>>::Param,
    );
    type ViewQuery = (
        Entity,
        Has<OcclusionCulling>,
        <DrawMesh as RenderCommand<P>>::ViewQuery,
    );
    type ItemQuery = ();

    fn render<'w>(
        item: &P,
        (camera, culls, of_mesh): ROQueryItem<'w, '_, Self::ViewQuery>,
        query: Option<()>,
        (lists, allocator, queue, cache, preprocess, param): SystemParamItem<'w, '_, Self::Param>,
        pass: &mut TrackedRenderPass<'w>,
    ) -> RenderCommandResult {
        let lists = lists.into_inner();
        if lists.is_idle(item.main_entity()) {
            return RenderCommandResult::Skip;
        }
        let single = item.batch_range().len() == 1
            && match item.extra_index() {
                PhaseItemExtraIndex::IndirectParametersIndex { range, .. } => range.len() == 1,
                _ => true,
            };
        let placed = preprocess.is_none_or(|pipelines| of_mesh && is_placed(&pipelines, &cache));
        let found = lists
            .draw(item.main_entity(), camera, PASS)
            .filter(|_| single && placed && !culls);
        let Some(draw) = found else {
            return <DrawMesh as RenderCommand<P>>::render(item, of_mesh, query, param, pass);
        };
        let Some(vertices) = allocator.into_inner().mesh_vertex_slice(&draw.mesh) else {
            return RenderCommandResult::Skip;
        };
        draw.record(&queue, vertices.range.start, item.batch_range().start);
        let ListedDraw {
            indices,
            format,
            draws,
            at,
            ..
        } = draw;
        pass.set_vertex_buffer(0, vertices.buffer.slice(..));
        pass.set_index_buffer(indices, format);
        pass.draw_indexed_indirect(draws, at);
        RenderCommandResult::Success
    }
}
