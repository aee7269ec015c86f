#define_import_path bevy_plumage::anatomy
#import bevy_plumage::math::{normal_distribution, normal_share, smooth_step}
#import bevy_plumage::footprint::{Footprint}

// The UV rectangle of a feather, its canonical space and its outline. Twin of src/maths/card.rs.
// Lengths in feather lengths, angles in radians, the rachis on x = 0, left is x < 0.

// Barbule coverage that is left where nothing hooks.
const LOOSE_BARBULES: f32 = 0.35;

// Map M: curve is F_P at uv.y.
fn canonical(uv: vec2<f32>, curve: f32, aspect: f32) -> vec2<f32> {
    return vec2<f32>((uv.x - curve) * aspect, uv.y);
}

// Footprint of a pixel with a standard deviation of half a pixel along each screen axis; curve, slope: F_P and F_P' at uv.y.
fn canonical_footprint(
    uv: vec2<f32>,
    duv_dx: vec2<f32>,
    duv_dy: vec2<f32>,
    curve: f32,
    slope: f32,
    aspect: f32,
) -> Footprint {
    let a = vec2<f32>(aspect * (duv_dx.x - slope * duv_dx.y), duv_dx.y);
    let b = vec2<f32>(aspect * (duv_dy.x - slope * duv_dy.y), duv_dy.y);
    let covariance = 0.25 * vec3<f32>(a.x * a.x + b.x * b.x, a.x * a.y + b.x * b.y, a.y * a.y + b.y * b.y);
    return Footprint(canonical(uv, curve, aspect), covariance);
}

// Least share of a footprint between two edges of its card.
const LEAST_CARD_SHARE: f32 = 0.02;
// Square of a card's width in deviations of an even density over one of its sides.
const EVEN_SIDE: f32 = 48.0;

// What a pixel sees of a card: the footprint, where its middle lies across and along the card (0 to 1), and how many deviations of that
// place the card is wide and long.
struct CardSight {
    footprint: Footprint,
    place: vec2<f32>,
    size: vec2<f32>,
}

// How many deviations of a place within a pixel the card is wide and long.
fn card_size(dplace_dx: vec2<f32>, dplace_dy: vec2<f32>) -> vec2<f32> {
    return inverseSqrt(max(0.25 * (dplace_dx * dplace_dx + dplace_dy * dplace_dy), vec2(1e-14)));
}

// The same where the pixel is wider than one side of the card, left or right of its fold: no more of it than that side has. `carry`: way in
// canonical space of one deviation across the card.
fn narrowed(sight: CardSight, carry: vec2<f32>) -> CardSight {
    let square = sight.size.x * sight.size.x;
    let root = inverseSqrt(square * square + EVEN_SIDE * EVEN_SIDE);
    let lost = 1.0 - square * root;
    let inward = sight.place.x - select(0.0, 0.5, sight.place.x > 0.5);
    let moved = (0.25 - inward) * lost;
    let way = carry * lost;
    let less = vec3(way.xx, way.y) * vec3(carry, carry.y);
    return CardSight(
        Footprint(sight.footprint.mean + carry * (moved * sight.size.x), sight.footprint.covariance - less),
        vec2(sight.place.x + moved, sight.place.y),
        vec2(inverseSqrt(root), sight.size.y),
    );
}

// Share of a footprint that lies on the card.
fn card_share(place: vec2<f32>, size: vec2<f32>) -> f32 {
    let low = place * size;
    let high = size - low;
    let across = normal_share(low.x) + normal_share(high.x) - 1.0;
    let along = normal_share(low.y) + normal_share(high.y) - 1.0;
    return max(across, LEAST_CARD_SHARE) * max(along, LEAST_CARD_SHARE);
}

// Coverages of the part of a footprint on the card, from those of the whole one and its card_share.
fn on_card(weights: vec4<f32>, share: f32) -> vec4<f32> {
    return weights / max(share, dot(weights, vec4(1.0)));
}

// Cosine between normal and eye from which on a place does not count as edge on.
const EDGE_FACING: f32 = 0.1;

// How far a place at share `across` of a card moves along its normal, so that the card never looks narrower than `thickness`; `facing`,
// `aside`: the eye's components along the normal and from left to right; `front`: the face that the card shows at its root.
fn edge_shift(across: f32, width: f32, thickness: f32, facing: f32, aside: f32, front: bool) -> f32 {
    let side = select(-1.0, 1.0, front);
    let shown = width * facing * side;
    let lacking = select(0.0, max(thickness - shown, 0.0), abs(facing) < EDGE_FACING);
    return (across - 0.5) * select(lacking, -lacking, aside * side > 0.0);
}

// Cotangent of the angle between barb and rachis, finite.
fn barb_cotangent(sin_b: f32, cos_b: f32) -> f32 {
    return cos_b / max(sin_b, 1e-3);
}

// Height on the rachis where the barb through a point is rooted.
fn barb_root(mean: vec2<f32>, cotangent: f32) -> f32 {
    return mean.y - abs(mean.x) * cotangent;
}

fn footprint_deviation(gx: f32, gy: f32, cov: vec3<f32>) -> f32 {
    return sqrt(max(gx * gx * cov.x + 2.0 * gx * gy * cov.y + gy * gy * cov.z, 1e-14));
}

// Share of a footprint inside the outline; reach and reach_slope are the contour and its derivative at barb_root.
fn contour_coverage(footprint: Footprint, reach: f32, reach_slope: f32, cotangent: f32) -> f32 {
    let mean = footprint.mean;
    let side = select(1.0, -1.0, mean.x < 0.0);
    let gx = -(1.0 + reach_slope * cotangent) * side;
    return normal_distribution((reach - abs(mean.x)) / footprint_deviation(gx, reach_slope, footprint.covariance));
}

// Share of a footprint above the lowest barb, rooted at start.
fn vane_start_coverage(footprint: Footprint, start: f32, cotangent: f32) -> f32 {
    let mean = footprint.mean;
    let side = select(1.0, -1.0, mean.x < 0.0);
    let deviation = footprint_deviation(-cotangent * side, 1.0, footprint.covariance);
    return normal_share((barb_root(mean, cotangent) - start) / deviation);
}

// How far the barbules hook into a closed vane, 0..1; x_distance is |x|, height is y.
fn hooked(x_distance: f32, height: f32, reach: f32, fringe: f32, downy: f32) -> f32 {
    let share = x_distance / max(reach, 1e-5);
    let edge = 1.0 - fringe;
    let rim = select(1.0, 1.0 - smooth_step(-0.1, 0.1, share - edge), fringe > 0.0);
    let down = select(1.0, smooth_step(-0.1, 0.1, height - downy), downy > 0.0);
    return rim * down;
}

// Factor on barbule coverage for a value of hooked.
fn barbule_factor(hooked_share: f32) -> f32 {
    return LOOSE_BARBULES + (1.0 - LOOSE_BARBULES) * hooked_share;
}

// Fractional row of the contour table for a barb rooted at root, 0..rows-1.
fn contour_row(root: f32, start: f32, rows: f32) -> f32 {
    let last = max(rows - 1.0, 0.0);
    return clamp((root - start) / max(1.0 - start, 1e-3) * last, 0.0, last);
}
