#define_import_path bevy_plumage::anatomy
#import bevy_plumage::math::{error_function}

// The UV rectangle of a feather, its canonical space and its outline. Twin of src/anatomy/map.rs.
// Lengths in feather lengths, angles in radians, the rachis on x = 0, left is x < 0.

// A pixel's Gaussian in canonical space: centre, covariance (xx, xy, yy).
struct CanonicalFootprint {
    mean: vec2<f32>,
    cov: vec3<f32>,
}

// Barbule coverage that is left where nothing hooks.
const LOOSE_BARBULES: f32 = 0.35;

// Mass of a unit Gaussian below x.
fn gaussian_step(x: f32) -> f32 {
    return 0.5 + 0.5 * error_function(x * 0.70710678);
}

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
) -> CanonicalFootprint {
    let a = vec2<f32>(aspect * (duv_dx.x - slope * duv_dx.y), duv_dx.y);
    let b = vec2<f32>(aspect * (duv_dy.x - slope * duv_dy.y), duv_dy.y);
    var footprint: CanonicalFootprint;
    footprint.mean = canonical(uv, curve, aspect);
    footprint.cov = 0.25 * vec3<f32>(a.x * a.x + b.x * b.x, a.x * a.y + b.x * b.y, a.y * a.y + b.y * b.y);
    return footprint;
}

fn barb_cotangent(barb_angle: f32) -> f32 {
    return cos(barb_angle) / max(sin(barb_angle), 1e-3);
}

// Height on the rachis where the barb through a point is rooted.
fn barb_root(mean: vec2<f32>, barb_angle: f32) -> f32 {
    return mean.y - abs(mean.x) * barb_cotangent(barb_angle);
}

fn footprint_deviation(gx: f32, gy: f32, cov: vec3<f32>) -> f32 {
    return sqrt(max(gx * gx * cov.x + 2.0 * gx * gy * cov.y + gy * gy * cov.z, 1e-14));
}

// Share of a footprint inside the outline; reach and reach_slope are the contour and its derivative at barb_root.
fn contour_coverage(mean: vec2<f32>, cov: vec3<f32>, reach: f32, reach_slope: f32, barb_angle: f32) -> f32 {
    let side = select(1.0, -1.0, mean.x < 0.0);
    let gx = -(1.0 + reach_slope * barb_cotangent(barb_angle)) * side;
    return gaussian_step((reach - abs(mean.x)) / footprint_deviation(gx, reach_slope, cov));
}

// Share of a footprint above the lowest barb, rooted at start.
fn vane_start_coverage(mean: vec2<f32>, cov: vec3<f32>, start: f32, barb_angle: f32) -> f32 {
    let side = select(1.0, -1.0, mean.x < 0.0);
    let gx = -barb_cotangent(barb_angle) * side;
    return gaussian_step((barb_root(mean, barb_angle) - start) / footprint_deviation(gx, 1.0, cov));
}

fn hermite_step(low: f32, high: f32, x: f32) -> f32 {
    let t = clamp((x - low) / max(high - low, 1e-6), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

// How far the barbules hook into a closed vane, 0..1; x_distance is |x|, height is y.
fn hooked(x_distance: f32, height: f32, reach: f32, fringe: f32, downy: f32) -> f32 {
    let share = x_distance / max(reach, 1e-5);
    let edge = 1.0 - fringe;
    let rim = select(1.0, 1.0 - hermite_step(edge - 0.1, edge + 0.1, share), fringe > 0.0);
    let down = select(1.0, hermite_step(downy - 0.1, downy + 0.1, height), downy > 0.0);
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
