// The one vertex function of feathers: colour, depth and shadow passes place a card alike.
#import bevy_pbr::{mesh_functions, skinning, view_transformations::position_world_to_clip}
#import bevy_plumage::feather_bindings::{cards, lod}
#import bevy_plumage::feather_data::{CARD_LENGTH, CARD_CULLED}
#ifdef PREPASS_PIPELINE
#import bevy_pbr::prepass_io::Vertex
#import bevy_plumage::feather_io::FeatherPrepassVertex
#else
#import bevy_pbr::forward_io::Vertex
#import bevy_plumage::feather_io::FeatherVertex
#endif

fn world_from_card(vertex: Vertex) -> mat4x4<f32> {
#ifdef SKINNED
    return skinning::skin_model(vertex.joint_indices, vertex.joint_weights, vertex.instance_index);
#else
    return mesh_functions::get_world_from_local(vertex.instance_index);
#endif
}

#ifdef PREPASS_PIPELINE
@vertex
fn vertex(vertex: Vertex) -> FeatherPrepassVertex {
    var out: FeatherPrepassVertex;
    let world = world_from_card(vertex) * vec4(vertex.position, 1.0);
    out.position = position_world_to_clip(world.xyz);
#ifdef UNCLIPPED_DEPTH_ORTHO_EMULATION
    out.unclipped_depth = out.position.z;
    out.position.z = min(out.position.z, 1.0);
#endif
    out.uv = vertex.uv;
    let card = min(u32(vertex.uv_b.x + 0.5), arrayLength(&cards) / CARD_LENGTH - 1u);
    out.card = vec2(cards[card * CARD_LENGTH + 4u].x, card);
    return out;
}
#else
@vertex
fn vertex(vertex: Vertex) -> FeatherVertex {
    var out: FeatherVertex;
    let card = min(u32(vertex.uv_b.x + 0.5), arrayLength(&cards) / CARD_LENGTH - 1u);
    let level = lod[min(card, arrayLength(&lod) - 1u)];
    let look = cards[card * CARD_LENGTH + 4u];
    out.card = vec4(look.x, look.y, look.z, level | (card << 3u));
    out.uv = vertex.uv;
    out.instance_index = vertex.instance_index;
    if (level == CARD_CULLED) {
        // All corners on one point outside the view: no pixels.
        out.position = vec4(2.0, 2.0, 0.5, 1.0);
        return out;
    }
    let world_from_local = world_from_card(vertex);
    out.world_position = world_from_local * vec4(vertex.position, 1.0);
    out.position = position_world_to_clip(out.world_position.xyz);
#ifdef SKINNED
    out.world_normal = skinning::skin_normals(world_from_local, vertex.normal);
#else
    out.world_normal = mesh_functions::mesh_normal_local_to_world(vertex.normal, vertex.instance_index);
#endif
    out.world_tangent = mesh_functions::mesh_tangent_local_to_world(world_from_local, vertex.tangent, vertex.instance_index);
    return out;
}
#endif
