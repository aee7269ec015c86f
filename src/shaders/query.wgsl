#define_import_path bevy_plumage::query

// Coverage of a pixel footprint by barbs and barbules. Twin of src/query, where the derivations are.

#import bevy_plumage::math::{wrap, Width, width, staircase, staircase_derivatives, overlap_integral, overlap_second_integral, smooth_positive, normal_density, normal_distribution}
#import bevy_plumage::masking::{Vane, Cell}

// What is known of all pixels of a card.
const LOD_NEAR: u32 = 1u;
const LOD_FAR: u32 = 2u;
const LOD_MEAN: u32 = 3u;
const LOD_MIXED: u32 = 4u;

// Most gaps that a footprint may touch, most cells in one gap.
const MAX_GAPS: i32 = 32;
const MAX_CELLS: i32 = 144;

// The standard quality.
const REACH: f32 = 3.0;
const CELL_PHASE: f32 = 0.4;
const CELL_SIGMAS: f32 = 0.75;
const SINGLE_SIGMAS: f32 = 1.5;
const EDGE_SIGMAS_SQUARED: f32 = 7.5;
const LEAST_ARC: f32 = 0.8;
const TIGHT_CELL_PHASE: f32 = 0.15;
const TIGHT_CELL_SIGMAS: f32 = 0.4;

const LEAST_VARIANCE: f32 = 1e-16;

// A Gaussian over the canonical plane; covariance is (xx, xy, yy).
struct Footprint {
    mean: vec2<f32>,
    covariance: vec3<f32>,
}

// A widened footprint and the determinant of its covariance.
struct Widened {
    footprint: Footprint,
    determinant: f32,
}

// A footprint in cell units, reduced to the cell around barb 0.
struct Local {
    u: f32,
    tau: f32,
    variance: f32,
    slope: f32,
    conditional: f32,
}

// A footprint cut at both sides of the rachis. Masses sum to 1. `right` still has x > 0.
struct RachisSplit {
    rachis: f32,
    left_mass: f32,
    left: Footprint,
    right_mass: f32,
    right: Footprint,
}

// Share of the footprint in a piece, mean and variance of it in sigmas.
struct Piece {
    mass: f32,
    mean: f32,
    variance: f32,
}

struct PieceWidths {
    upper: Width,
    lower: Width,
    both: Width,
    box_half: f32,
}

// The footprint with its minor axis widened to a sixteenth of the major one.
fn widened(f: Footprint) -> Widened {
    let mean = clamp(f.mean, vec2(-16.0), vec2(16.0));
    let xx = clamp(f.covariance.x, LEAST_VARIANCE, 256.0);
    let yy = clamp(f.covariance.z, LEAST_VARIANCE, 256.0);
    let bound = sqrt(xx * yy);
    let xy = clamp(f.covariance.y, -bound, bound);
    let half = 0.5 * (xx + yy);
    let d = 0.5 * (xx - yy);
    let r = sqrt(d * d + xy * xy);
    let major = half + r;
    let minor = half - r;
    let least = max(major * (1.0 / 256.0), LEAST_VARIANCE);
    if minor >= least {
        return Widened(Footprint(mean, vec3(xx, xy, yy)), minor * major);
    }
    let share = 0.5 * (least - minor) / max(r, 1e-30);
    return Widened(Footprint(mean, vec3(xx + share * (r - d), xy - share * xy, yy + share * (r + d))), least * major);
}

// Mirror image at the rachis.
fn mirrored(f: Footprint) -> Footprint {
    return Footprint(vec2(-f.mean.x, f.mean.y), vec3(f.covariance.x, -f.covariance.y, f.covariance.z));
}

// Brings a footprint over the left vane into cell units. Phases count from the nearest barb root.
fn reduce(cell: Cell, vane: Vane, footprint: Footprint) -> Local {
    let wide = widened(footprint);
    let f = wide.footprint;
    let c = vane.cos_b;
    let s = vane.sin_b;
    let spacing = vane.p_b / s;
    let rest = f.mean.y - floor(f.mean.y / spacing + 0.5) * spacing;
    let across = (f.mean.x * c + rest * s) / vane.p_b * cell.side;
    let k = floor(across);
    let tau = wrap((rest * c - f.mean.x * s) / vane.d_bl - k * cell.e_root);
    let cov = f.covariance;
    let var_s = max(cov.x * c * c + 2.0 * cov.y * c * s + cov.z * s * s, LEAST_VARIANCE);
    let cov_st = (cov.z - cov.x) * c * s + cov.y * (c * c - s * s);
    return Local(
        across - k,
        tau,
        max(var_s / (vane.p_b * vane.p_b), 1e-10),
        cell.side * cov_st / var_s * (vane.p_b / vane.d_bl),
        max(wide.determinant / var_s / (vane.d_bl * vane.d_bl), 1e-8),
    );
}

// Phase difference of the lower and the upper family at `v`.
fn phase_difference(cell: Cell, v: f32) -> f32 {
    return cell.kappa * (1.0 - v - v) + cell.e_root + cell.s_p - cell.s_d;
}

// MEAN: (barb, upper, lower) averaged over the pattern.
fn mean_coverage(cell: Cell) -> vec3<f32> {
    let open = cell.v_high - cell.v_low;
    let f_d = cell.h_d + cell.h_d;
    let f_p = cell.h_p + cell.h_p;
    let high = overlap_integral(phase_difference(cell, cell.v_high), cell.h_d, cell.h_p);
    let low = overlap_integral(phase_difference(cell, cell.v_low), cell.h_d, cell.h_p);
    return vec3(1.0 - open, f_d * open, f_p * (1.0 - f_d) * open + (high - low) / (cell.kappa + cell.kappa));
}

// STRIPE: barbs resolved, barbules averaged along the barb.
fn stripe_coverage(cell: Cell, local: Local) -> vec3<f32> {
    let w = width(local.variance);
    let a = cell.v_low - local.u;
    let b = cell.v_high - local.u;
    let open = staircase(b, w) - staircase(a, w);
    let f_d = cell.h_d + cell.h_d;
    let f_p = cell.h_p + cell.h_p;
    let at_high = staircase_derivatives(b, w);
    let at_low = staircase_derivatives(a, w);
    let x_high = phase_difference(cell, cell.v_high);
    let x_low = phase_difference(cell, cell.v_low);
    let edge = overlap_integral(x_high, cell.h_d, cell.h_p) * at_high.x - overlap_integral(x_low, cell.h_d, cell.h_p) * at_low.x;
    let slope = overlap_second_integral(x_high, cell.h_d, cell.h_p) * at_high.y
        - overlap_second_integral(x_low, cell.h_d, cell.h_p) * at_low.y;
    let inverse = 0.5 / cell.kappa;
    return vec3(1.0 - open, f_d * open, f_p * (1.0 - f_d) * open + edge * inverse + slope * inverse * inverse);
}

fn midpoint_piece(z: f32, w: f32) -> Piece {
    let variance = w * w * (1.0 / 12.0);
    return Piece(normal_density(z) * w * (1.0 + 0.5 * (z * z - 1.0) * variance), z * (1.0 - variance), variance);
}

fn truncated_piece(za: f32, zb: f32) -> Piece {
    let w = zb - za;
    if w < 0.8 {
        return midpoint_piece(0.5 * (za + zb), w);
    }
    let mass = max(normal_distribution(zb) - normal_distribution(za), 1e-6);
    let pa = normal_density(za);
    let pb = normal_density(zb);
    let mean = (pa - pb) / mass;
    let variance = 1.0 + (za * pa - zb * pb) / mass - mean * mean;
    return Piece(mass, clamp(mean, za, zb), clamp(variance, 0.0, 1.0));
}

// Variances of the upper and the lower family's steps in a piece of the given variance.
fn step_variances(cell: Cell, local: Local, variance: f32) -> vec2<f32> {
    let nd = cell.kappa - local.slope;
    let np = cell.kappa + local.slope;
    return vec2(local.conditional + nd * nd * variance, local.conditional + np * np * variance);
}

fn piece_widths(cell: Cell, local: Local, variance: f32) -> PieceWidths {
    let v = step_variances(cell, local, variance);
    return PieceWidths(width(v.x), width(v.y), width(0.5 * (v.x + v.y)), 3.4641016 * cell.kappa * sqrt(variance));
}

// Width of an arc's end, by which family it belongs to in this piece.
fn end_width(distance: f32, w: PieceWidths, box_half: f32) -> Width {
    if distance >= box_half {
        return w.lower;
    }
    if distance <= -box_half {
        return w.upper;
    }
    return w.both;
}

// Mass and length of one visible arc of the lower family, `x` from the middle of the upper one's complement.
fn visible_arc(x: f32, y: f32, hb: f32, h_p: f32, w: PieceWidths, box_half: f32) -> vec2<f32> {
    let from_below = x - h_p + hb;
    let from_above = hb - x - h_p;
    var low = smooth_positive(from_below, box_half) - hb;
    var high = hb - smooth_positive(from_above, box_half);
    let length = max(smooth_positive(high - low, box_half), 1e-6);
    if x > 0.0 {
        low = high - length;
    } else {
        high = low + length;
    }
    let mass = staircase(high - y, end_width(from_above, w, box_half)) - staircase(low - y, end_width(from_below, w, box_half));
    return vec2(mass, length);
}

// Phases of the footprint against the upper and the lower family's centres, at `u` in gap `k`.
fn family_phases(cell: Cell, local: Local, k: f32, u: f32) -> vec2<f32> {
    let along = local.tau + local.slope * (u - local.u);
    let v = u - k;
    return vec2(
        wrap(along - cell.kappa * v - k * cell.e_root - cell.s_d),
        wrap(along - cell.kappa * (1.0 - v) - (k + 1.0) * cell.e_root - cell.s_p),
    );
}

// Mass of a family of arcs of half width `h` at phase `d` of its centre.
fn family_mass(d: f32, h: f32, w: Width) -> f32 {
    return staircase(h - d, w) - staircase(-h - d, w);
}

// Visible lower coverage of one piece of mass 1, `d` its phase against the upper family, `x` the phase difference.
fn lower_mass(cell: Cell, d: f32, x: f32, w: PieceWidths, typed: bool) -> f32 {
    let hb = 0.5 - cell.h_d;
    let y = wrap(d - 0.5);
    let box_half = select(w.box_half, 0.0, typed);
    var sum = visible_arc(x, y, hb, cell.h_p, w, box_half);
    if cell.h_p + hb + box_half > 1.0 - abs(x) {
        sum += visible_arc(select(x + 1.0, x - 1.0, x > 0.0), y, hb, cell.h_p, w, box_half);
    }
    if box_half > 0.02 {
        let at = x + 0.5;
        let s = overlap_integral(at + box_half, cell.h_d, cell.h_p) - overlap_integral(at - box_half, cell.h_d, cell.h_p);
        let exact = 4.0 * cell.h_p * hb - s / (box_half + box_half);
        return sum.x * clamp(exact, 0.0, 1.0) / sum.y;
    }
    return sum.x;
}

// NEAR: everything resolved.
fn near_coverage(cell: Cell, local: Local, tight: bool) -> vec3<f32> {
    let sigma = sqrt(local.variance);
    let reach = REACH * sigma;
    let barb_width = width(local.variance);
    let open = clamp(
        staircase(cell.v_high - local.u, barb_width) - staircase(cell.v_low - local.u, barb_width), 0.0, 1.0);
    let hb = 0.5 - cell.h_d;
    let change_e = abs(hb - cell.h_p);
    let change_g = hb + cell.h_p;
    let climb = cell.kappa + select(0.0, abs(local.slope), local.conditional < 0.2);
    let sharpness = sqrt(local.conditional);
    let cell_sigmas = select(CELL_SIGMAS, TIGHT_CELL_SIGMAS, tight) * clamp(1.5 * sharpness / (climb * sigma), 0.5, 1.0);
    var cell_phase = min(select(CELL_PHASE, TIGHT_CELL_PHASE, tight), max(LEAST_ARC * min(hb, cell.h_p), 0.15));
    let estimate = (reach + reach) * max(cell.v_high - cell.v_low, 0.5) * climb / cell_phase;
    cell_phase = cell_phase * max(estimate * (1.0 / 128.0), 1.0);

    let bottom = local.u - reach;
    let top = local.u + reach;
    let first = ceil(bottom - cell.v_high);
    let last = floor(top - cell.v_low);
    let gaps = i32(clamp(last - first + 1.0, 0.0, f32(MAX_GAPS)));
    var total = 0.0;
    var upper = 0.0;
    var lower = 0.0;
    // Of a footprint inside one gap the two families' own coverage is exact; cells only have to tell how they overlap.
    var exact = false;
    var exact_upper = 0.0;
    var exact_lower = 0.0;
    var k = first;
    for (var gap = 0; gap < gaps; gap++) {
        let low = max(bottom, k + cell.v_low);
        let high = min(top, k + cell.v_high);
        let length = high - low;
        if length > 0.0 {
            let uncut = low <= bottom && high >= top;
            let x_middle = wrap(phase_difference(cell, 0.5 * (low + high) - k) - 0.5);
            let ax = abs(x_middle);
            let vary = cell.kappa * length;
            let typed = abs(ax - change_e) > vary && abs(ax - change_g) > vary && abs(1.0 - ax - change_g) > vary
                && ax + vary < 0.5;
            var done = false;
            if uncut {
                let w = piece_widths(cell, local, local.variance);
                let phase = family_phases(cell, local, k, local.u);
                let v = step_variances(cell, local, local.variance);
                exact = true;
                exact_upper = family_mass(phase.x, cell.h_d, w.upper);
                exact_lower = family_mass(phase.y, cell.h_p, w.lower);
                let dd = abs(phase.x) - cell.h_d;
                let dp = abs(phase.y) - cell.h_p;
                if dd * dd > EDGE_SIGMAS_SQUARED * v.x || dp * dp > EDGE_SIGMAS_SQUARED * v.y {
                    lower = exact_lower * (1.0 - exact_upper);
                    done = true;
                } else if typed {
                    lower = lower_mass(cell, phase.x, x_middle, w, true);
                    done = true;
                }
                if done {
                    total = 1.0;
                    exact_lower = 0.0;
                }
            }
            if !done {
                let za = (low - local.u) / sigma;
                let zb = (high - local.u) / sigma;
                let single = !uncut && typed && climb * length < SINGLE_SIGMAS * sharpness;
                let wanted = select(ceil(max(length * climb / cell_phase, (zb - za) / cell_sigmas)), 1.0, single);
                let count = clamp(wanted, 1.0, f32(MAX_CELLS));
                let step = (zb - za) / count;
                var piece = truncated_piece(za, zb);
                let variance = select(step * step * (1.0 / 12.0), piece.variance, single);
                let w = piece_widths(cell, local, local.variance * variance);
                let cells = i32(count);
                for (var i = 0; i < cells; i++) {
                    if !single {
                        piece = midpoint_piece(za + (f32(i) + 0.5) * step, step);
                    }
                    let u = local.u + sigma * piece.mean;
                    let phase = family_phases(cell, local, k, u);
                    let x = wrap(phase_difference(cell, u - k) - 0.5);
                    total += piece.mass;
                    upper += piece.mass * family_mass(phase.x, cell.h_d, w.upper);
                    lower += piece.mass * lower_mass(cell, phase.x, x, w, single);
                    if uncut {
                        lower -= piece.mass * family_mass(phase.y, cell.h_p, w.lower);
                    }
                }
            }
        }
        k += 1.0;
    }
    if total <= 0.0 {
        return vec3(1.0 - open, 0.0, 0.0);
    }
    let scale = open / max(total, 1e-6);
    upper *= scale;
    lower *= scale;
    if exact {
        upper = exact_upper * open;
        lower += exact_lower * open;
    }
    upper = clamp(upper, 0.0, open);
    return vec3(1.0 - open, upper, clamp(lower, 0.0, open - upper));
}

// Exponent budget of the first row of harmonics along the barb.
fn row_budget(cell: Cell, local: Local, threshold: f32) -> f32 {
    let sigma = sqrt(local.variance);
    let density = max(0.16 / sqrt(local.variance * local.conditional), 1.0);
    let slowest = min(abs(cell.kappa - local.slope), abs(cell.kappa + local.slope));
    let x = max(slowest - 0.47 / sigma, 0.32);
    let window = min(max(1.0, min(1.0 + 0.4 / sigma, 3.2 * x)) / (3.14159265 * x), 1.0);
    return threshold + log(0.64 / 0.9 * window * density) / 19.7392088;
}

// The cheapest evaluator within the budget, as a LOD_ constant, and 1 in y where NEAR has to be tight.
fn choose(cell: Cell, local: Local, threshold: f32) -> vec2<u32> {
    let teeth = 4.0 * cell.kappa * cell.kappa * local.variance;
    if local.conditional > threshold {
        if local.variance > threshold {
            return vec2(LOD_MEAN, 0u);
        }
        if teeth > 0.25 {
            return vec2(LOD_FAR, 0u);
        }
    }
    if teeth > 0.0625 {
        let budget = row_budget(cell, local, threshold);
        if teeth > 0.25 && (local.conditional > budget || local.variance > 25.0) {
            return vec2(LOD_FAR, 0u);
        }
        return vec2(LOD_NEAR, select(0u, 1u, local.conditional > 0.25 * budget));
    }
    return vec2(LOD_NEAR, 0u);
}

// What can be said of every footprint whose minor axis is at least `sigma_minor_min`, the major one at most `sigma_major_max`.
fn classify_bounds(vane: Vane, sigma_minor_min: f32, sigma_major_max: f32, threshold: f32) -> u32 {
    let across = sigma_minor_min / vane.p_b;
    let along = sigma_minor_min / vane.d_bl;
    let kappa = max(vane.cos_bl / vane.sin_bl * vane.p_b / vane.d_bl, 0.01);
    let teeth = 4.0 * kappa * kappa;
    if along * along > threshold && across * across > threshold {
        return LOD_MEAN;
    }
    if along * along > threshold && teeth * across * across > 0.25 {
        return LOD_FAR;
    }
    let across_max = sigma_major_max / vane.p_b;
    let along_max = sigma_major_max / vane.d_bl;
    if teeth * across_max * across_max <= 0.25 && (along_max * along_max <= threshold || across_max * across_max <= threshold) {
        return LOD_NEAR;
    }
    return LOD_MIXED;
}

// (barb, distal, proximal) in cell units.
fn cell_coverage(cell: Cell, local: Local, lod: u32, threshold: f32) -> vec3<f32> {
    var kind = vec2(lod, 0u);
    if lod != LOD_FAR && lod != LOD_MEAN {
        // A card of near pixels still asks whether one has to be tight.
        kind = choose(cell, local, threshold);
    }
    var w: vec3<f32>;
    if kind.x == LOD_MEAN {
        w = mean_coverage(cell);
    } else if kind.x == LOD_FAR {
        w = stripe_coverage(cell, local);
    } else {
        w = near_coverage(cell, local, kind.y == 1u);
    }
    return shares(cell, w);
}

// (barb, upper, lower) as an evaluator gives it, clamped to disjoint shares: (barb, distal, proximal).
fn shares(cell: Cell, w: vec3<f32>) -> vec3<f32> {
    let barb = clamp(w.x, 0.0, 1.0);
    let upper = clamp(w.y, 0.0, 1.0 - barb);
    let lower = clamp(w.z, 0.0, 1.0 - barb - upper);
    return select(vec3(barb, upper, lower), vec3(barb, lower, upper), cell.side < 0.0);
}

// (barb, distal, proximal) coverage of a footprint over the left vane.
fn vane_coverage(cell: Cell, vane: Vane, footprint: Footprint, lod: u32, threshold: f32) -> vec3<f32> {
    if lod == LOD_MEAN {
        // Spares the reduction: the average does not depend on the place.
        return cell_coverage(cell, Local(0.0, 0.0, 1.0, 0.0, 1.0), lod, threshold);
    }
    return cell_coverage(cell, reduce(cell, vane, footprint), lod, threshold);
}

// Mass of the part of a footprint below `edge` along x.
fn mass_below(f: Footprint, edge: f32) -> f32 {
    let z = (edge - f.mean.x) / sqrt(f.covariance.x);
    if z > 4.0 {
        return 1.0;
    }
    let mass = normal_distribution(z);
    return select(mass, 0.0, mass < 1e-4);
}

// That part, as a Gaussian of the same mean and covariance; `mass` from `mass_below`.
fn part_below(f: Footprint, edge: f32, mass: f32) -> Footprint {
    let cov = f.covariance;
    let sigma = sqrt(cov.x);
    let z = (edge - f.mean.x) / sigma;
    if z > 4.0 || mass <= 0.0 {
        return f;
    }
    let ratio = normal_density(z) / mass;
    let shrink = clamp(1.0 - z * ratio - ratio * ratio, 0.02, 1.0);
    let slope = cov.y / cov.x;
    return Footprint(
        vec2(f.mean.x - sigma * ratio, f.mean.y - slope * sigma * ratio),
        vec3(cov.x * shrink, cov.y * shrink, cov.z - slope * cov.y * (1.0 - shrink)),
    );
}

// Splits a footprint at the rachis, whose edges along x are `edges` (mask_rachis).
fn split_rachis(footprint: Footprint, edges: vec2<f32>) -> RachisSplit {
    let f = widened(footprint).footprint;
    let flipped = mirrored(f);
    let low = min(edges.x, edges.y);
    let high = max(edges.x, edges.y);
    let left_mass = mass_below(f, low);
    let right_mass = mass_below(flipped, -high);
    let left = part_below(f, low, left_mass);
    let right = mirrored(part_below(flipped, -high, right_mass));
    return RachisSplit(clamp(1.0 - left_mass - right_mass, 0.0, 1.0), left_mass, left, right_mass, right);
}
