// Signed azimuths of one light, with the warps of flat fibres: shared by the near field and by sampling. Twin of `azimuths` in
// src/maths/scattering/flat.rs.
#define_import_path bevy_plumage::scattering_azimuth
#import bevy_plumage::scattering::{FIBRE_ROUND, FibreShading, SCATTERING_PI, fibre_acos}

// Each angle from the eye as (cosine, sine).
struct FibreAzimuths {
    turn: vec2<f32>,
    // Warped for TRcT and for R; Jacobians of both.
    core: vec2<f32>,
    stretch: f32,
    surface: vec2<f32>,
    surface_stretch: f32,
    // Narrowed for TT; its Jacobian, 0 where nothing arrives.
    through: vec2<f32>,
    shrink: f32,
    // Azimuth half way between eye and light.
    middle: vec2<f32>,
}

// Angle from the eye to the half-way normal on the circle that an ellipse of `aspect` is warped to, doubled; Jacobian in z.
fn fibre_warp(aspect: f32, eye: vec2<f32>, middle: vec2<f32>) -> vec3<f32> {
    let a = aspect;
    let hit = max(middle.x * middle.x + a * a * middle.y * middle.y, 1e-6);
    let seen = a * a * eye.x * eye.x + eye.y * eye.y;
    let scale = inverseSqrt(max(hit * seen, 1e-12));
    let c = (a * middle.y * eye.y + middle.x * a * eye.x) * scale;
    let d = (middle.x * eye.y - a * a * middle.y * eye.x) * scale;
    return vec3<f32>(clamp(2.0 * c * c - 1.0, -1.0, 1.0), 2.0 * c * d, a / hit);
}

fn fibre_azimuths(s: FibreShading, light: vec2<f32>) -> FibreAzimuths {
    let o = s.azimuth;
    let turn = vec2<f32>(clamp(dot(o, light), -1.0, 1.0), light.x * o.y - light.y * o.x);
    let raw = o + light;
    let square = dot(raw, raw);
    var out: FibreAzimuths;
    out.middle = select(vec2<f32>(o.y, -o.x), raw * inverseSqrt(max(square, 1e-12)), square > 1e-12);
    out.turn = turn;
    out.core = turn;
    out.stretch = 1.0;
    out.surface = turn;
    out.surface_stretch = 1.0;
    out.through = turn;
    out.shrink = 1.0;
    if s.aspect < FIBRE_ROUND {
        let core = fibre_warp(s.core_aspect, o, out.middle);
        let surface = fibre_warp(s.surface_aspect, o, out.middle);
        out.core = core.xy;
        out.stretch = core.z;
        out.surface = surface.xy;
        out.surface_stretch = surface.z;
        let root = sqrt(s.aspect);
        let bend = fibre_acos(-turn.x) / root;
        out.shrink = select(1.0 / root, 0.0, bend > SCATTERING_PI);
        out.through = vec2<f32>(-cos(bend), select(sin(bend), -sin(bend), turn.y < 0.0));
    }
    return out;
}

// sin n phi for n = 1..4 and 5..8 of (cosine, sine).
fn fibre_sines(angle: vec2<f32>) -> array<vec4<f32>, 2> {
    let c = 2.0 * angle.x;
    let two = c * angle.y;
    let three = c * two - angle.y;
    let four = c * three - two;
    let five = c * four - three;
    let six = c * five - four;
    let seven = c * six - five;
    return array<vec4<f32>, 2>(vec4<f32>(angle.y, two, three, four), vec4<f32>(five, six, seven, c * seven - six));
}
