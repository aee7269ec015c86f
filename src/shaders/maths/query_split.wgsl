#define_import_path bevy_plumage::query_split

// Footprints cut by straight lines: at the rachis, at the outline. Twin of src/maths/query/split.rs, where the derivation is.

#import bevy_plumage::math::{normal_density, normal_distribution, normal_share}
#import bevy_plumage::query_far::{Local}
#import bevy_plumage::footprint::{Footprint}
#import bevy_plumage::query::{PARTS_MARGIN}

// A line that cuts off less than what lies beyond this many sigmas leaves one part on either side.
const TAIL_SIGMAS: f32 = 2.5;
// Beyond this many sigmas a line leaves all or nothing.
const FAR_SIGMAS: f32 = 4.0;
// Most places at which the outline is looked up.
const MAX_OUTLINE_NODES: u32 = 16u;

// The half plane offset + gradient . x >= 0.
struct Line {
    offset: f32,
    gradient: vec2<f32>,
}

// A share of a footprint, negative where it is taken away from a part before it.
struct Part {
    mass: f32,
    footprint: Footprint,
}

// A footprint and the line that cuts it, in sigmas from its mean along `carry`; `parts` of it are left.
struct LineCut {
    footprint: Footprint,
    carry: vec2<f32>,
    line: f32,
    parts: u32,
}

// Value of a line at a point.
fn line_at(line: Line, x: vec2<f32>) -> f32 {
    return line.offset + dot(line.gradient, x);
}

fn covariance_times(c: vec3<f32>, g: vec2<f32>) -> vec2<f32> {
    return vec2(c.x * g.x + c.y * g.y, c.y * g.x + c.z * g.y);
}

// Share of a footprint inside a line.
fn line_share(line: Line, f: Footprint) -> f32 {
    let variance = dot(line.gradient, covariance_times(f.covariance, line.gradient));
    return normal_share(line_at(line, f.mean) * inverseSqrt(max(variance, 1e-30)));
}

// Prepares the parts of a footprint inside a line; `resolved`: up to four of them, else one.
fn split_line(f: Footprint, line: Line, resolved: bool) -> LineCut {
    let along = covariance_times(f.covariance, line.gradient);
    let sigma = sqrt(max(dot(line.gradient, along), 1e-30));
    let at = clamp(-line_at(line, f.mean) / sigma, -FAR_SIGMAS, FAR_SIGMAS);
    var parts = 1u;
    if at >= FAR_SIGMAS {
        parts = 0u;
    } else if resolved && abs(at) <= TAIL_SIGMAS {
        parts = select(3u, 4u, at < 0.0);
    }
    return LineCut(f, along / sigma, at, parts);
}

// The part with this mean and variance along the gradient, in sigmas.
fn moved_part(cut: LineCut, mass: f32, mean: f32, variance: f32) -> Part {
    let less = 1.0 - variance;
    let f = cut.footprint;
    let c = cut.carry;
    return Part(mass, Footprint(f.mean + c * mean, f.covariance - vec3(c.x * c.x, c.x * c.y, c.y * c.y) * less));
}

// All of a cut footprint that is inside, as one part.
fn line_rest(cut: LineCut) -> Part {
    if cut.line <= -FAR_SIGMAS {
        return Part(1.0, cut.footprint);
    }
    let mass = normal_share(-cut.line);
    let ratio = normal_density(cut.line) / max(mass, 1e-6);
    return moved_part(cut, mass, ratio, clamp(1.0 + cut.line * ratio - ratio * ratio, 0.02, 1.0));
}

// Part `index` of a cut footprint, below `parts`.
fn line_part(cut: LineCut, index: u32) -> Part {
    if cut.parts == 1u {
        return line_rest(cut);
    }
    if cut.line <= -FAR_SIGMAS || index == 0u && cut.parts == 4u {
        return Part(1.0, cut.footprint);
    }
    let z = abs(cut.line);
    let beyond = normal_distribution(-z);
    let reach = normal_density(z) / beyond - z;
    // The three Gaussians of a tail: masses, means and deviations, the last two in units of its mean distance from the line.
    var w = vec3(0.143 + 0.01 * z, 0.366 + 0.0125 * z, 0.0);
    var m = vec3(0.16 - 0.008 * z, 0.608 - 0.0145 * z, 0.0);
    var s = vec3(0.117 - 0.004 * z, 0.331 - 0.0015 * z, 0.0);
    w.z = 1.0 - w.x - w.y;
    m.z = (1.0 - w.x * m.x - w.y * m.y) / w.z;
    let square = (1.0 - z * reach) / (reach * reach);
    let rest = (square - w.x * (m.x * m.x + s.x * s.x) - w.y * (m.y * m.y + s.y * s.y)) / w.z - m.z * m.z;
    s.z = sqrt(clamp(rest, 0.1, 2.0));
    let inside_out = cut.line < 0.0;
    let i = min(select(index, index - 1u, inside_out), 2u);
    let mean = z + m[i] * reach;
    let spread = s[i] * reach;
    return moved_part(cut, select(1.0, -1.0, inside_out) * w[i] * beyond, select(mean, -mean, inside_out), spread * spread);
}

// The line of the rachis over the left vane: x < edge.
fn rachis_line(edge: f32) -> Line {
    return Line(edge, vec2(-1.0, 0.0));
}

// The outline near a footprint over the left vane, to first order: `reach` is the contour and its derivative at the root of the
// barb through `mean`, `cotangent` of the angle of the barbs.
fn outline_line(mean: vec2<f32>, reach: vec2<f32>, cotangent: f32) -> Line {
    let gradient = vec2(1.0 + reach.y * cotangent, reach.y);
    return Line(reach.x + mean.x - dot(gradient, mean), gradient);
}

// How a footprint sees an outline that is stored by the roots of the barbs: where to look it up, `count` times.
struct OutlineSight {
    // Root through the mean, its deviation; distance from the rachis there.
    root: f32,
    sigma: f32,
    inset: f32,
    // Slope of that distance on the root, and the variance that is left of it.
    slope: f32,
    rest: f32,
    count: u32,
    // Of the nodes in sigmas of the root: the first, their distance, the variance that each stands for.
    first: f32,
    step: f32,
    width: f32,
}

// `cotangent` of the angle of the barbs; `spacing` of the stored values. A split may be narrower than the footprint.
fn outline_sight(f: Footprint, cotangent: f32, spacing: f32) -> OutlineSight {
    let c = f.covariance;
    let variance = max(cotangent * (cotangent * c.x + c.y + c.y) + c.z, 1e-20);
    let sigma = sqrt(variance);
    let slope = -(cotangent * c.x + c.y) / variance;
    var s = OutlineSight(f.mean.y + f.mean.x * cotangent, sigma, -f.mean.x, slope, max(c.x - slope * slope * variance, 1e-20), 1u, 0.0, 0.0, 1.0);
    if sigma >= 0.2 * spacing {
        let count = clamp(ceil(3.3 * sigma / spacing), 8.0, f32(MAX_OUTLINE_NODES));
        s.count = u32(count);
        s.step = 6.0 / count;
        s.first = 0.5 * s.step - 3.0;
        s.width = s.step * s.step * (1.0 / 12.0);
    }
    return s;
}

// Place of node `i` in sigmas of the root.
fn outline_place(s: OutlineSight, i: u32) -> f32 {
    return s.first + f32(i) * s.step;
}

// Root at which node `i` looks the outline up.
fn outline_root(s: OutlineSight, i: u32) -> f32 {
    return s.root + outline_place(s, i) * s.sigma;
}

// Of node `i`: what of it lies on this vane's side of the shaft, and what of that lies inside, both weighted; `reach` and its
// derivative there. The sum of the second over that of the first is the vane's share inside.
fn outline_node(s: OutlineSight, i: u32, reach: vec2<f32>) -> vec2<f32> {
    let t = outline_place(s, i);
    let distance = s.inset + s.slope * t * s.sigma;
    let steep = (reach.y - s.slope) * s.sigma;
    let scale = inverseSqrt(s.rest + steep * steep * s.width);
    let beyond = normal_share(-distance * scale);
    let inside = max(normal_share((reach.x - distance) * scale) - beyond, 0.0);
    return normal_density(t) * vec2(1.0 - beyond, inside);
}

// Share of a pixel inside an outline, from that of its footprint: the Gaussian ends at 1.75 deviations.
fn ended_share(share: f32) -> f32 {
    return saturate((share - 0.04) * 1.0869565);
}

// Share of a footprint that the rachis hides; `edges` from mask_rachis.
fn rachis_share(f: Footprint, edges: vec2<f32>) -> f32 {
    let left = line_share(rachis_line(min(edges.x, edges.y)), f);
    let right = line_share(Line(-max(edges.x, edges.y), vec2(1.0, 0.0)), f);
    return clamp(1.0 - left - right, 0.0, 1.0);
}

// Whether the average serves not only a footprint but what a line leaves of it, too.
fn averages(local: Local, threshold: f32) -> bool {
    return min(local.variance, local.conditional) > PARTS_MARGIN * threshold;
}
