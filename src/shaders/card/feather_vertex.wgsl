// Vertex function of the color pass; depth and shadow passes call the same `place`.
#import bevy_pbr::mesh_view_bindings::globals
#import bevy_plumage::feather_io::{CardVertex, FeatherVertex}
#import bevy_plumage::feather_place::place

@vertex
fn vertex(vertex: CardVertex) -> FeatherVertex {
    return place(vertex, globals.time, globals.delta_time);
}
