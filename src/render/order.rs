//! In which order the cards of a mesh are drawn.
//!
//! Behind a depth prepass the card of the highest layer within the window must come last, so that it stays
//! ([`FeatherSettings::order_window`](super::FeatherSettings)). Without one the nearest stays, and cards of high layers, which hide
//! others, come first. Where cards are drawn from lists (docs/book/lod.md#lists), these have the order that each pass asks for; what
//! stands here is for all others.

use super::FeatherMaterial;
use crate::groom::{PlumageCards, PlumageSystems};
use bevy::{
    core_pipeline::prepass::DepthPrepass,
    mesh::{Indices, VertexAttributeValues},
    prelude::*,
};

pub(super) fn add_systems(app: &mut App) {
    app.add_systems(
        PostUpdate,
        sort_cards
            .in_set(PlumageSystems::PrepareExtraDraws)
            .after(PlumageSystems::PrepareMaterials),
    );
}

/// Another mesh or material, or an edited material.
type ChangedBird = Or<(
    Changed<Mesh3d>,
    Changed<MeshMaterial3d<FeatherMaterial>>,
    AssetChanged<MeshMaterial3d<FeatherMaterial>>,
)>;

/// Turns the triangles of card meshes round where the cameras ask for it.
fn sort_cards(
    mut sorted: Local<bool>,
    cameras: Query<(), (With<Camera3d>, With<DepthPrepass>)>,
    changed: Query<(), (With<PlumageCards>, ChangedBird)>,
    birds: Query<(&Mesh3d, &MeshMaterial3d<FeatherMaterial>), With<PlumageCards>>,
    materials: Res<Assets<FeatherMaterial>>,
    mut meshes: ResMut<Assets<Mesh>>,
) {
    let prepass = !cameras.is_empty();
    if prepass == *sorted && changed.is_empty() {
        return;
    }
    *sorted = prepass;
    for (mesh, material) in &birds {
        let open = materials
            .get(material.id())
            .is_some_and(|material| material.settings.order_window > 0.0);
        let rises = meshes.get(mesh.id()).and_then(rises);
        if rises.is_some_and(|rises| rises != (prepass && open))
            && let Some(mut mesh) = meshes.get_mut(mesh.id())
        {
            turn_round(&mut mesh);
        }
    }
}

/// Whether cards of low layers come first; none if there is but one, or no cards at all.
pub(super) fn rises(mesh: &Mesh) -> Option<bool> {
    let Some(VertexAttributeValues::Float32x2(ids)) = mesh.attribute(Mesh::ATTRIBUTE_UV_1) else {
        return None;
    };
    let indices = mesh.indices()?;
    let rank = |index: Option<usize>| ids.get(index?).map(|id| id[1]);
    let first = rank(indices.iter().next())?;
    let last = rank(indices.iter().last())?;
    (first != last).then_some(first < last)
}

fn turn_round(mesh: &mut Mesh) {
    match mesh.indices_mut() {
        Some(Indices::U32(list)) => list.as_chunks_mut::<3>().0.reverse(),
        Some(Indices::U16(list)) => list.as_chunks_mut::<3>().0.reverse(),
        None => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::{asset::RenderAssetUsages, mesh::PrimitiveTopology};

    #[test]
    fn cards_come_in_the_other_order() {
        let mut mesh = Mesh::new(
            PrimitiveTopology::TriangleList,
            RenderAssetUsages::default(),
        );
        let ids: Vec<[f32; 2]> = (0..6).map(|i| [0.0, 0.9 - 0.1 * (i / 3) as f32]).collect();
        mesh.insert_attribute(Mesh::ATTRIBUTE_UV_1, ids);
        mesh.insert_indices(Indices::U32(vec![0, 1, 2, 3, 4, 5]));
        assert_eq!(rises(&mesh), Some(false));
        turn_round(&mut mesh);
        assert_eq!(rises(&mesh), Some(true));
        assert_eq!(
            mesh.indices().unwrap().iter().collect::<Vec<_>>(),
            [3, 4, 5, 0, 1, 2]
        );
    }
}
