// The fibres of a card: how they lie in it, and their tables.
#define_import_path bevy_plumage::feather_fibre
#import bevy_plumage::{
    feather_bindings::{feather_at, settings},
    scattering::fibre_row_at,
}
#ifdef PLAIN_FIBRES
#import bevy_plumage::scattering_short as short
#import bevy_plumage::feather_shadow::{KeptPlace, kept_light}
#import bevy_plumage::scattering_multiple::PARALLEL_MEETINGS
#endif

// Components in the order of the weights; the rachis is 0.
const BARB: u32 = 1u;
const DISTAL: u32 = 2u;
const PROXIMAL: u32 = 3u;

// A bit for every component with a larger share than `least`. Who goes from bit to bit goes round as often as the neighbor with most of
// them, and not for those that none of them shows.
fn shown_parts(shares: vec4<f32>, least: f32) -> u32 {
    return dot(select(vec4(0u), vec4(1u, 2u, 4u, 8u), shares > vec4(least)), vec4(1u));
}

// Direction of a component's fibres in the frame of the card; `shear`: of the map along a curved rachis.
fn fibre_tangent(part: u32, angles: vec4<f32>, right: bool, shear: f32) -> vec2<f32> {
    var v = vec2(0.0, 1.0);
    let barb = vec2(-angles.x, angles.y);
    if (part == BARB) { v = barb; }
    // Turned by the barbule angle towards the tip (distal) or the base (proximal).
    if (part == DISTAL) { v = vec2(barb.x * angles.w + barb.y * angles.z, barb.y * angles.w - barb.x * angles.z); }
    if (part == PROXIMAL) { v = vec2(barb.x * angles.w - barb.y * angles.z, barb.y * angles.w + barb.x * angles.z); }
    if (right) { v.x = -v.x; }
    return normalize(vec2(v.x + shear * v.y, v.y));
}

// A direction of the card in the frame of a fibre: along it, across (the normal crossed with it), along the normal.
fn in_fibre(tangent: vec2<f32>, hand: f32, direction: vec3<f32>) -> vec3<f32> {
    return vec3(dot(tangent, direction.xy), hand * (tangent.y * direction.x - tangent.x * direction.y), direction.z);
}

#ifdef PLAIN_FIBRES
// The fibre of one component from its short table, prepared for the lights.
fn short_part(index: f32, eye: vec3<f32>, dark_back: f32) -> short::ShortShading {
    // Exact: the buffer has fewer than 2^24 vec4s.
    let table = u32(feather_at(0u).w + index * f32(short::SHORT_TABLE_LENGTH));
    var head = array<vec4<f32>, 4>();
    for (var i = 0u; i < short::SHORT_HEAD_LENGTH; i++) {
        head[i] = feather_at(table + i);
    }
    let place = fibre_row_at(sqrt(max(1.0 - eye.x * eye.x, 0.0)));
    let first = table + short::SHORT_HEAD_LENGTH + place.index * short::SHORT_STEP_LENGTH;
    let change = first + short::SHORT_ROW_LENGTH;
    var row = array<vec4<f32>, 9>();
#ifdef ONLY_MEAN
    // Of every series the four terms.
    for (var i = 0u; i < 6u; i++) {
        let to = select(2u * i - 3u, i, i < 3u);
        row[to] = feather_at(first + i) + feather_at(change + i) * place.fraction;
    }
    let fine = false;
#else
    for (var i = 0u; i < 9u; i++) {
        let from_row = select(i + 3u, i, i < 3u);
        row[i] = feather_at(first + from_row) + feather_at(change + from_row) * place.fraction;
    }
    let fine = true;
#endif
    return short::short_shading(head, row, eye, dark_back, fine);
}

// What a component keeps of light from all around, before color; pairs: of light from the eye's side, and from the other.
struct Keeping {
    // Energies of the surface, of TT or TRcT, and of the medulla.
    outside: f32,
    clear: f32,
    medulla: f32,
    // Shares of them that are kept.
    surface: vec2<f32>,
    second: vec2<f32>,
    scattered: vec2<f32>,
    // Of the meetings with further fibres, the share with parallel ones.
    parallel: f32,
}

// Of fibres of one color: energy kept of light from both sides (of the eye's side without what the surface mirrors), and spread and cone of
// what met further fibres.
struct Kept {
    sides: vec2<f32>,
    spread: f32,
    cone: f32,
}

// `outside`: energy of the surface.
fn keeping_of(shading: short::ShortShading, outside: f32, place: KeptPlace, part: u32) -> Keeping {
    let before = kept_light(place, part, 0u);
    let after = kept_light(place, part, 1u);
    let surface = vec2(before.x, after.x);
    let scattered = vec2(before.w, after.w);
    if (shading.structural) {
        let lit = mix(1.0, clamp(0.5 + 0.5 * shading.azimuth.y, 0.0, 1.0), shading.back.y);
        return Keeping(outside, shading.energy.y * lit, shading.energy.z, surface, scattered, scattered, PARALLEL_MEETINGS);
    }
    return Keeping(outside, shading.energy.y, shading.energy.z, surface, vec2(before.y, after.y), scattered, 0.0);
}

// Light that leaves a fibre meets another one where light from all around would be kept off.
fn kept_of(keeping: Keeping, color: short::ShortColor) -> Kept {
    let second = keeping.clear * color.second;
    let medulla = keeping.medulla * color.scattered;
    let surface = keeping.outside * keeping.surface;
    let sides = vec2(0.0, surface.y) + second * keeping.second + medulla * keeping.scattered;
    let again = short::short_again(
        keeping.outside + second + medulla, surface.x + sides.x + sides.y, settings.multiple_scattering, keeping.parallel,
    );
    return Kept(sides, again.x, again.y);
}
#endif
