// How wrong light is that is found at the vertices of a card and interpolated. Twin of src/maths/vertex_light.rs.
#define_import_path bevy_plumage::vertex_light
#import bevy_plumage::math::smooth_step

// Typical error, share of white. `turn`: degrees between the normals of neighboring vertices; `facing`: the least of the cosines to eye and lights.
fn vertex_light_error(turn: f32, facing: f32) -> f32 {
    let least = clamp(facing - 0.00872664625997165 * turn, 0.0, 1.0);
    let along = 1.0 - smooth_step(0.0, 0.5, least);
    let edge = 1.0 - smooth_step(0.0, 0.2, least);
    return turn * (5.0e-5 + 4.5e-4 * along + 8.0e-3 * edge);
}
