// Layout of the packed feathers (twin of src/render/pack). Offsets and counts are in vec4s.
#define_import_path bevy_plumage::feather_data
#import bevy_plumage::masking::{Family, Vane, VaneShape}

// Buffer header: (feather count, first fibre table, fibre table count, first short table).
const FEATHERS_BASE: u32 = 1u;
// One feather: header, rachis table, contour table, sheen row, kept light.
const HEADER_LENGTH: u32 = 48u;
const RACHIS_SAMPLES: u32 = 64u;
const CONTOUR_SAMPLES: u32 = 256u;
const SHEEN_SAMPLES: u32 = 32u;
// Levels and azimuths of the eye's direction in the table of kept light.
const KEPT_LEVELS: u32 = 10u;
const KEPT_AZIMUTHS: u32 = 8u;
const FEATHER_STRIDE: u32 = 1680u;
// Inside the header.
const SHAPE: u32 = 0u;       // aspect, length in metres, contour start, dark back
const LEFT_VANE: u32 = 1u;   // 5: sin/cos of barb angle and barbule angle; p_b, d_bl, r_b, r_bd; r_bp, fringe, downy, kappa; e_root and one over
                             // the periods of barbs and barbules; half heights of distal and proximal barbules, one over both
const RIGHT_VANE: u32 = 6u;
const SHEEN: u32 = 11u;       // strength, roughness; place of the thin layers, 0: none
const FIBRES: u32 = 12u;     // 4 x 7: rachis, barb, distal, proximal
const PARTS: u32 = 40u;      // 4: factor on the painted color; chance that light meets another fibre, seen from front and back; fibre table
const CAUGHT: u32 = 44u;     // one over the integral of what the vane catches over the sphere
const MIRRORS: u32 = 45u;    // azimuthal roughness of barbs, where their mirror lobes leave them; the same of barbules
const PAINT: u32 = 46u;       // 2, barbs and barbules: darkest painted color by which they differ, seen from front and back; palest
// After the header. Kept light: seen from front and back; of each of the four; from the eye's side and the other; level; azimuth.
const KEPT: u32 = HEADER_LENGTH + RACHIS_SAMPLES + CONTOUR_SAMPLES + SHEEN_SAMPLES;

// Thin layers: flatness, slope, how much of the stack the inner side has, texels of a row.
const STACK_SIDE: u32 = 0u;
// Sine and cosine of rise and tilt.
const STACK_TURN: u32 = 1u;
// Two constants of the side, and the number of rows of texels.
const STACK_ROWS: u32 = 2u;
// Of the map of rows: its place in the buffer, columns, rows.
const STACK_MAP: u32 = 3u;
// What an eye sees: energy, area; for every row. Behind that the rows: color, and reflectance of bare keratin.
const STACK_SEEN: u32 = 4u;

// Class of a card, indices of CARD_COUNTERS.
const CARD_CULLED: u32 = 0u;
const CARD_NEAR: u32 = 1u;
const CARD_FAR: u32 = 2u;
const CARD_MEAN: u32 = 3u;
const CARD_MIXED: u32 = 4u;
// MEAN, its light found at the vertices.
const CARD_LIT: u32 = 5u;
// Behind the skin.
const CARD_HIDDEN: u32 = 6u;

// What is kept of a card beside its class: of a LIT one, how many of `LIT_SHARES` of its pixels the pipeline of that class draws; the rest is
// MEAN's. Cards come and go through all of them, so that none changes at once.
const LIT_SHARES: u32 = 31u;
fn lod_bits(level: u32, lit: u32) -> u32 { return level | (lit << 3u); }
fn lod_class(bits: u32) -> u32 { return bits & 7u; }
fn lod_lit(bits: u32) -> u32 { return (bits >> 3u) & 31u; }
// And whether it turns its back to the eye, which nothing but the lists asks.
const LOD_BACK: u32 = 256u;
fn lod_shows_back(bits: u32) -> bool { return (bits & LOD_BACK) != 0u; }
// Which pipelines draw the card: RESOLVED, FAR, MEAN, LIT.
fn lod_lists(bits: u32) -> vec4<bool> {
    let level = lod_class(bits);
    let resolved = level == CARD_NEAR || level == CARD_MIXED;
    let mean = level == CARD_MEAN || (level == CARD_LIT && lod_lit(bits) < LIT_SHARES);
    return vec4(resolved, level == CARD_FAR, mean, level == CARD_LIT);
}
// Class and share with the number of the card, as fragments know it.
fn card_bits(lod: u32, index: u32) -> u32 { return (lod & 255u) | (index << 8u); }
fn card_index(bits: u32) -> u32 { return bits >> 8u; }

// Words of a card in the buffer of classes: first come those bits of all cards, then how far the wind lifts each (feather_lift).
const LOD_WORDS: u32 = 2u;
// Radians, now and in the frame before.
fn lift_bits(now: f32, before: f32) -> u32 { return pack2x16float(vec2(now, before)); }
fn lift_of(bits: u32) -> vec2<f32> { return unpack2x16float(bits); }

// Rows of the motion table before its regions: wind (2), worn poses (2), lights (2).
const MOTION_WORN: u32 = 2u;
const MOTION_LIGHTS: u32 = 4u;
const MOTION_REGIONS: u32 = 6u;

// One card record.
const CARD_LENGTH: u32 = 5u;
struct Card {
    root: vec3<f32>,
    length: f32,
    center: vec3<f32>,
    radius: f32,
    along: vec3<f32>,
    width: f32,
    joints: vec4<u32>,
    weights: vec4<f32>,
    // Index of the feather in bits 0..15, the mirrored flag in bit 16, region in bits 17..23, layer in bits 24..31.
    feather: u32,
    tint: u32,
    seed: u32,
    // Of the front face at the root.
    normal: vec3<f32>,
}

// Regions that a record can tell apart.
const MAX_REGIONS: u32 = 128u;

fn card_feather(bits: u32) -> u32 { return bits & 0xffffu; }
fn card_region(bits: u32) -> u32 { return (bits >> 17u) & (MAX_REGIONS - 1u); }
// Row of the motion table of a card's region, of so many.
fn region_row(bits: u32, regions: f32) -> u32 { return MOTION_REGIONS + min(card_region(bits), max(u32(regions), 1u) - 1u); }
// Largest angle between the normals of neighboring vertices, degrees, in two bits above the tint.
fn card_turn(bits: u32) -> f32 { return 5.0 * f32(1u << (bits >> 30u)); }
fn card_layer(bits: u32) -> f32 { return f32(bits >> 24u) / 255.0; }

// Linear color that the groom gives, as square roots of ten bits.
fn card_tint(bits: u32) -> vec3<f32> {
    let t = vec3(f32(bits & 1023u), f32((bits >> 10u) & 1023u), f32((bits >> 20u) & 1023u)) / 1023.0;
    return t * t;
}

// A direction from the two numbers of the octahedral map (Cigolle et al. 2014).
fn octahedral(p: vec2<f32>) -> vec3<f32> {
    var v = vec3(p, 1.0 - abs(p.x) - abs(p.y));
    if (v.z < 0.0) {
        v = vec3((1.0 - abs(p.yx)) * select(vec2(-1.0), vec2(1.0), p >= vec2(0.0)), v.z);
    }
    return normalize(v);
}

// The two numbers of a direction.
fn octahedral_of(direction: vec3<f32>) -> vec2<f32> {
    let v = direction / max(dot(abs(direction), vec3(1.0)), 1e-9);
    return select((1.0 - abs(v.yx)) * select(vec2(-1.0), vec2(1.0), v.xy >= vec2(0.0)), v.xy, v.z >= 0.0);
}

fn card_decode(a: vec4<u32>, b: vec4<u32>, c: vec4<u32>, d: vec4<u32>, e: vec4<u32>) -> Card {
    var card: Card;
    card.root = bitcast<vec3<f32>>(a.xyz);
    card.length = bitcast<f32>(a.w);
    card.center = bitcast<vec3<f32>>(b.xyz);
    card.radius = bitcast<f32>(b.w);
    card.along = bitcast<vec3<f32>>(c.xyz);
    card.width = bitcast<f32>(c.w);
    card.joints = vec4(d.x & 0xffffu, d.x >> 16u, d.y & 0xffffu, d.y >> 16u);
    card.weights = vec4(unpack2x16unorm(d.z), unpack2x16unorm(d.w));
    card.feather = e.x;
    card.tint = e.y;
    card.seed = e.z;
    card.normal = octahedral(unpack2x16snorm(e.w));
    return card;
}

// The first three vec4s of a vane.
fn vane_unpack(angles: vec4<f32>, sizes: vec4<f32>, rest: vec4<f32>) -> Vane {
    return Vane(sizes.x, sizes.y, angles.y, angles.x, angles.w, angles.z, sizes.z, sizes.w, rest.x, 1.0);
}

// All five of them.
fn shape_unpack(angles: vec4<f32>, sizes: vec4<f32>, rest: vec4<f32>, periods: vec4<f32>, heights: vec4<f32>) -> VaneShape {
    let ratios = heights.xy * periods.z;
    return VaneShape(
        vane_unpack(angles, sizes, rest),
        periods.y,
        periods.z,
        periods.w,
        Family(heights.x, heights.z, ratios.x),
        Family(heights.y, heights.w, ratios.y),
        0.5 * (heights.x + heights.y),
        rest.w,
        periods.x,
    );
}
