#define_import_path bevy_plumage::query_feather

// Coverage of a footprint by a whole feather as a card shows it. Twin of src/maths/query/feather.rs.

#import bevy_plumage::anatomy::{barb_cotangent, barbule_factor, hooked, vane_start_coverage}
#import bevy_plumage::coverage_method::{part_coverage, resolves_parts}
#import bevy_plumage::footprint::{Footprint, LEAST_VARIANCE}
#import bevy_plumage::masking::{VaneShape, barb_strip, seen_cell, storeys, vane_stop}
#import bevy_plumage::query::{LOD_MEAN, vane_coverage}
#import bevy_plumage::query_split::{line_part, line_rest, line_share, outline_line, rachis_line, rachis_share, split_line}

// A vane that shows less of a footprint than this is left out.
const LEAST_SHARE: f32 = 1e-3;
// A part of a footprint with less mass than this is left out.
const LEAST_PART: f32 = 5e-4;

// One vane's share of a footprint: barbs, distal and proximal barbules; for the light the share of their width that the barbules show,
// and the share of a barb's silhouette that they leave open.
struct VaneCover {
    weights: vec3<f32>,
    hook: f32,
    open: f32,
}

// One vane as a card has it: its pattern where the barbules hook, the share of a barb where they do not, the height below which
// they do not.
struct CardVane {
    shape: VaneShape,
    fringe: f32,
    downy: f32,
}

// Least that one of two lines leaves of a footprint that both may cut into parts.
const LINE_SHARE: f32 = 0.98;

// Where a vane ends, as a footprint sees it: how far the barb through its mean reaches along x and the derivative by the root of the
// barb; the share inside of what of the footprint lies on the vane's side of the shaft (outline_node).
struct Outline {
    reach: vec2<f32>,
    share: f32,
}

// Whether a footprint over the left vane shows enough of it beside the rachis, whose edge is at x = edge.
fn shows_vane(footprint: Footprint, edge: f32) -> bool {
    return line_share(rachis_line(edge), footprint) >= LEAST_SHARE;
}

// One vane's share of a footprint (over the left vane, or mirrored there) beside the rachis, whose edge is at x = edge. `view`: unit,
// towards the eye, in the same frame. `lod` is what is known of the whole footprint, `parts_lod` of what a line leaves of it.
fn cover_vane(
    card: CardVane,
    start: f32,
    outline: Outline,
    footprint: Footprint,
    edge: f32,
    view: vec3<f32>,
    lod: u32,
    parts_lod: u32,
    threshold: f32,
) -> VaneCover {
    let rachis = rachis_line(edge);
    let beside = line_share(rachis, footprint);
    var shape = card.shape;
    let vane = shape.vane;
    let cotangent = barb_cotangent(vane.sin_b, vane.cos_b);
    let mean = footprint.mean;
    let beyond = Footprint(vec2(min(mean.x, -1e-6), mean.y), footprint.covariance);
    let begun = vane_start_coverage(beyond, start, cotangent);
    let shows = beside >= LEAST_SHARE && outline.share * begun >= LEAST_SHARE;
    // Loose barbules stand on edge: they are narrower, and hide less of each other.
    shape.vane.hooked = select(1.0, barbule_factor(hooked(abs(mean.x), mean.y, outline.reach.x, card.fringe, card.downy)), shows);
    let seen = storeys(shape, view);
    let strip = barb_strip(shape, seen);
    let open = clamp(strip.x / max(2.0 * seen.silhouette, 1e-9), 0.0, 1.0);
    var found = VaneCover(vec3(0.0), shape.vane.hooked, open);
    if !shows {
        return found;
    }
    let cell = seen_cell(shape, seen, strip, view.z >= 0.0);
    // Whichever of rachis and outline takes more of the footprint cuts it into parts, the other one scales them. Where the tangent
    // tells too little of the outline, the outline scales the whole.
    let end = outline_line(mean, outline.reach, cotangent);
    let straight = line_share(end, footprint);
    let scale = outline.share / max(straight, 1e-6);
    let is_line = scale <= 2.0 && scale >= 0.5 && max(straight, beside) > LINE_SHARE;
    var first = rachis;
    var second = end;
    if is_line && straight < beside {
        first = end;
        second = rachis;
    }
    let cut = split_line(footprint, first, resolves_parts(cell, vane, footprint, lod, threshold));
    var covered = vec3(0.0);
    if parts_lod == LOD_MEAN {
        // Averages are the same everywhere: nothing is resolved, and a pipeline of means need not hold how.
        let part = line_rest(cut);
        var mass = part.mass * outline.share;
        if is_line {
            mass = part.mass * scale * line_share(second, part.footprint);
        }
        if mass >= LEAST_PART {
            covered = mass * part_coverage(cell, vane, part.footprint, lod, threshold);
        }
        found.weights = max(covered, vec3(0.0)) * begun;
        return found;
    }
    for (var i = 0u; i < cut.parts; i++) {
        let part = line_part(cut, i);
        var mass = part.mass * outline.share;
        if is_line {
            mass = part.mass * scale * line_share(second, part.footprint);
        }
        if abs(mass) < LEAST_PART {
            continue;
        }
        // What the LOD pass promised of whole footprints does not hold for their parts.
        let part_lod = select(lod, parts_lod, cut.parts > 1u);
        covered += mass * part_coverage(cell, vane, part.footprint, part_lod, threshold);
    }
    found.weights = max(covered, vec3(0.0)) * begun;
    return found;
}

// The same where averages serve, in all what mean_stop says: of the footprint the vane has `share`. `mean`: over the left vane, or mirrored there; `reach`: of the
// barb through it.
fn mean_vane(card: CardVane, mean: vec2<f32>, reach: f32, share: f32, view: vec3<f32>) -> VaneCover {
    var shape = card.shape;
    let shows = share >= LEAST_SHARE;
    shape.vane.hooked = select(1.0, barbule_factor(hooked(abs(mean.x), mean.y, reach, card.fringe, card.downy)), shows);
    let seen = storeys(shape, view);
    let strip = barb_strip(shape, seen);
    let open = clamp(strip.x / max(2.0 * seen.silhouette, 1e-9), 0.0, 1.0);
    var found = VaneCover(vec3(0.0), shape.vane.hooked, open);
    if shows {
        let cell = seen_cell(shape, seen, strip, view.z >= 0.0);
        let nowhere = Footprint(mean, vec3(0.0));
        let covered = max(vane_coverage(cell, shape.vane, nowhere, LOD_MEAN, 0.0), vec3(0.0));
        found.weights = covered * (share * vane_stop(shape, seen) / max(covered.x + covered.y + covered.z, 1e-9));
    }
    return found;
}

// All that such a vane covers of a footprint, where nobody asks which fibres do.
fn mean_stop(card: CardVane, mean: vec2<f32>, reach: f32, share: f32, view: vec3<f32>) -> f32 {
    var shape = card.shape;
    shape.vane.hooked = barbule_factor(hooked(abs(mean.x), mean.y, reach, card.fringe, card.downy));
    return max(share, 0.0) * vane_stop(shape, storeys(shape, view));
}

// What there is of the rachis where a footprint at height `v` meets it: over the last hundredth of the card it ends. A slanting
// footprint meets it higher or lower than its middle.
fn rachis_left(footprint: Footprint, v: f32) -> f32 {
    let height = v - footprint.mean.x * footprint.covariance.y / max(footprint.covariance.x, LEAST_VARIANCE);
    return saturate(100.0 * (1.0 - height));
}

// Share of a footprint at height `v` that the rachis hides.
fn cover_rachis(footprint: Footprint, edges: vec2<f32>, v: f32) -> f32 {
    return rachis_share(footprint, edges) * rachis_left(footprint, v);
}

// Rachis and both vanes (cover_vane) as shares that sum to at most 1: differences of parts may leave a little too much.
fn cover_feather(rachis: f32, left: vec3<f32>, right: vec3<f32>) -> vec4<f32> {
    let weights = vec4(rachis, left + right);
    return max(weights, vec4(0.0)) / max(dot(weights, vec4(1.0)), 1.0);
}
