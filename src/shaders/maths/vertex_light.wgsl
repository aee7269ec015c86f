// How wrong light is that is found at the vertices of a card and interpolated. Twin of src/maths/vertex_light.rs.
#define_import_path bevy_plumage::vertex_light
#import bevy_plumage::math::smooth_step

// What it grows by per degree where eye or light pass along a card. `half_turn`: radians; `facing`: cosine to eye or light.
fn grazing_error(half_turn: f32, facing: f32) -> f32 {
    let least = clamp(facing - half_turn, 0.0, 1.0);
    let along = 1.0 - smooth_step(0.0, 0.5, least);
    let edge = 1.0 - smooth_step(0.0, 0.2, least);
    return 4.5e-4 * along + 8.0e-3 * edge;
}

// Typical error, share of white. `turn`: degrees between the normals of neighboring vertices; `eye`, `lights`: cosines to them; `shares`: of all
// light, each light's.
fn vertex_light_error(turn: f32, eye: f32, lights: vec2<f32>, shares: vec2<f32>) -> f32 {
    let half_turn = 0.00872664625997165 * turn;
    let lit = dot(shares, vec2(grazing_error(half_turn, lights.x), grazing_error(half_turn, lights.y)));
    return turn * (5.0e-5 + max(grazing_error(half_turn, eye), lit));
}
