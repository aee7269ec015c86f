// How wrong light is that is found at the vertices of a card and interpolated. Twin of src/maths/vertex_light.rs.
#define_import_path bevy_plumage::vertex_light
#import bevy_plumage::math::smooth_step

// What of its paint a vane shows of a light fades where the light passes along it: by about so much. `facing`: cosine between light and
// normal, above 0 where the light comes from the eye's side.
fn grazing_light(facing: f32) -> f32 {
    return (max(facing, -0.4 * facing) + 0.01) / (abs(facing) + 0.3);
}

// What it grows by per degree where eye or light pass along a card. `half_turn`: radians; `facing`: cosine to eye or light.
fn grazing_error(half_turn: f32, facing: f32) -> f32 {
    let least = clamp(facing - half_turn, 0.0, 1.0);
    let along = 1.0 - smooth_step(0.0, 0.5, least);
    let edge = 1.0 - smooth_step(0.0, 0.2, least);
    return 4.5e-4 * along + 8.0e-3 * edge;
}

// Share that the cores of structural fibres show of a light that passes along their card.
const MIRRORED: f32 = 0.3;

// Share that shows of what a light does that passes along a card. `eye`: cosine to its normal; `against`: to the direction away from the light;
// `mirrors`: 1 for structural fibres, 0 for others.
fn glint_share(half_turn: f32, eye: f32, against: f32, mirrors: f32) -> f32 {
    return max(max(1.0 - smooth_step(0.0, 0.4, eye - half_turn), smooth_step(0.2, 0.7, against)), MIRRORED * mirrors);
}

// Typical error, share of white. `turn`: degrees between the normals of neighboring vertices; `eye`, `lights`: cosines to them; `against`: from
// the eye to where the light of each goes; `shares`: of all light, each light's; `mirrors`: see glint_share.
fn vertex_light_error(turn: f32, eye: f32, lights: vec2<f32>, against: vec2<f32>, shares: vec2<f32>, mirrors: f32) -> f32 {
    let half_turn = 0.00872664625997165 * turn;
    let first = shares.x * glint_share(half_turn, eye, against.x, mirrors) * grazing_error(half_turn, lights.x);
    let second = shares.y * glint_share(half_turn, eye, against.y, mirrors) * grazing_error(half_turn, lights.y);
    return turn * (5.0e-5 + max(grazing_error(half_turn, eye), first + second));
}
