// From coverage to what is drawn, the same in the color pass and the depth prepass. Which way is chosen by
// FeatherMaterial::specialize: SAMPLE_COVERAGE, HASHED, FEATHER_CORE, FEATHER_FRINGE, or none of them (blended).
#define_import_path bevy_plumage::feather_opacity
#import bevy_plumage::{
    feather_bindings::settings,
    feather_data as data,
    feather_io::FeatherVertex,
    feather_pattern::{frame_point, hash, hashed_threshold, pattern_threshold, sample_mask, threshold_after},
}
#ifdef VISIBILITY_RANGE_DITHER
#import bevy_pbr::pbr_functions::visibility_range_dither
#endif

// From this opacity on a fragment counts as opaque for the transparency list.
const CORE_OPACITY: f32 = 0.98;
const LEAST_OPACITY: f32 = 0.00392157;

// Where the frame's pattern stands for a card: the usual one, 0, nowhere. Found once a fragment, and handed on as `moved`.
fn moved_by(card: u32) -> vec2<u32> { return frame_point(settings.pattern, hash(card)); }

// Another number for every pixel and card.
fn pixel_hash(in: FeatherVertex) -> u32 {
    let pixel = vec2<u32>(in.position.xy);
    return hash(data::card_index(in.card.w) ^ hash(pixel.x ^ (pixel.y << 16u)));
}

// Whether nothing at all of the fragment is drawn. `aspect`: width over length of the card.
fn leaves_hole(in: FeatherVertex, opacity: f32, aspect: f32, moved: vec2<u32>) -> bool {
#ifdef VISIBILITY_RANGE_DITHER
    visibility_range_dither(in.position, in.visibility_range_dither);
#endif
#ifdef HASHED
    let point = vec2(in.uv.x * aspect, in.uv.y);
    let dx = vec2(dpdx(in.uv.x) * aspect, dpdx(in.uv.y));
    let dy = vec2(dpdy(in.uv.x) * aspect, dpdy(in.uv.y));
    let threshold = hashed_threshold(point, dx, dy, in.card.z);
    return opacity < threshold_after(threshold, moved.x);
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
fn is_left_out(in: FeatherVertex, moved: vec2<u32>) -> bool {
    let lit = data::lod_lit(in.card.w);
    let place = pixel_hash(in) + moved.y;
    let is_lit = lit >= data::LIT_SHARES || place >> 27u < lit;
#ifdef ONLY_LIT
    return !is_lit;
#else
    return is_lit;
#endif
}
#endif

#ifdef SAMPLE_COVERAGE
// The multisampling samples that the fragment covers.
fn sample_bits(in: FeatherVertex, opacity: f32, moved: vec2<u32>) -> u32 {
    let card = data::card_index(in.card.w);
    let threshold = select(0.5, threshold_after(pattern_threshold(in.position.xy, card), moved.x), settings.dither != 0u);
    // Other samples in every pixel and for every card, so that no two cards always share theirs.
    let turn = (pixel_hash(in) >> 5u) + (((moved.y >> 16u) * #{FEATHER_SAMPLES}u) >> 16u);
    return sample_mask(opacity, threshold, turn, #{FEATHER_SAMPLES}u);
}
#endif
