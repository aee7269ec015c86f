// From coverage to what is drawn, the same in the color pass and the depth prepass. Which way is chosen by
// FeatherMaterial::specialize: SAMPLE_COVERAGE, HASHED, FEATHER_CORE, FEATHER_FRINGE, or none of them (blended).
#define_import_path bevy_plumage::feather_opacity
#import bevy_plumage::{
    feather_bindings::settings,
    feather_data as data,
    feather_io::FeatherVertex,
    feather_pattern::{hash, hashed_threshold, pattern_threshold, sample_mask},
}
#ifdef VISIBILITY_RANGE_DITHER
#import bevy_pbr::pbr_functions::visibility_range_dither
#endif

// From this opacity on a fragment counts as opaque for the transparency list.
const CORE_OPACITY: f32 = 0.98;
const LEAST_OPACITY: f32 = 0.00392157;

// Seed of the frame's pattern: 0, the usual one, leaves a seed as it is.
fn patterned(seed: u32) -> u32 {
    return seed + settings.pattern * 2654435769u;
}

// Whether nothing at all of the fragment is drawn. `aspect`: width over length of the card.
fn leaves_hole(in: FeatherVertex, opacity: f32, aspect: f32) -> bool {
#ifdef VISIBILITY_RANGE_DITHER
    visibility_range_dither(in.position, in.visibility_range_dither);
#endif
#ifdef HASHED
    let point = vec2(in.uv.x * aspect, in.uv.y);
    let dx = vec2(dpdx(in.uv.x) * aspect, dpdx(in.uv.y));
    let dy = vec2(dpdy(in.uv.x) * aspect, dpdy(in.uv.y));
    return opacity < hashed_threshold(point, dx, dy, patterned(in.card.z));
#else
#ifdef FEATHER_CORE
    return opacity < CORE_OPACITY;
#else
#ifdef FEATHER_FRINGE
    return opacity < LEAST_OPACITY || opacity >= CORE_OPACITY;
#else
    return opacity < LEAST_OPACITY;
#endif
#endif
#endif
}

#ifdef ONLY_MEAN
// Whether the other one of MEAN and LIT draws the pixel: they share a card that is on its way from one to the other.
fn is_left_out(in: FeatherVertex) -> bool {
    let pixel = vec2<u32>(in.position.xy);
    let card = patterned(data::card_index(in.card.w));
    let lit = data::lod_lit(in.card.w);
    let is_lit = lit >= data::LIT_SHARES || hash(card ^ hash(pixel.x ^ (pixel.y << 16u))) >> 27u < lit;
#ifdef ONLY_LIT
    return !is_lit;
#else
    return is_lit;
#endif
}
#endif

#ifdef SAMPLE_COVERAGE
// The multisampling samples that the fragment covers.
fn sample_bits(in: FeatherVertex, opacity: f32) -> u32 {
    let card = patterned(data::card_index(in.card.w));
    let threshold = select(0.5, pattern_threshold(in.position.xy, card), settings.dither != 0u);
    let pixel = vec2<u32>(in.position.xy);
    // Other samples in every pixel and for every card, so that no two cards always share theirs.
    let turn = hash(card ^ hash(pixel.x ^ (pixel.y << 16u))) >> 5u;
    return sample_mask(opacity, threshold, turn, #{FEATHER_SAMPLES}u);
}
#endif
