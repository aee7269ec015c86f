// Vertex function of the color pass; depth and shadow passes call the same `place`.
#import bevy_plumage::feather_io::{CardVertex, FeatherVertex}
#import bevy_plumage::feather_place::place
#ifdef LIT_VERTICES
#import bevy_plumage::feather_vertex_light::light_vertex
#endif

@vertex
fn vertex(vertex: CardVertex) -> FeatherVertex {
    let placed = place(vertex);
#ifdef LIT_VERTICES
    return light_vertex(placed);
#else
    return placed;
#endif
}
