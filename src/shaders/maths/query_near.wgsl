#define_import_path bevy_plumage::query_near

// NEAR: coverage with everything resolved. Twin of src/maths/query/near.

#import bevy_plumage::math::{wrap, Width, width, staircase, overlap_integral, smooth_positive, normal_density, normal_distribution, arc_sine, sine_turns, cosine_turns}
#import bevy_plumage::masking::{Cell}
#import bevy_plumage::query_far::{Local, phase_difference}

// Most gaps that a footprint may touch, most cells in one gap.
const MAX_GAPS: i32 = 32;
const MAX_CELLS: i32 = 144;
// Largest variance of either family's phase for which the nearest corners are enough.
const CORNER_VARIANCE: f32 = 0.04;

// How finely it cuts: see the Rust struct of the same name.
struct Quality {
    reach: f32,
    cell_phase: f32,
    cell_sigmas: f32,
    single_sigmas: f32,
    edge_sigmas_squared: f32,
    least_arc: f32,
    least_sigmas: f32,
}

// The cheapest preset whose error is that of the switches at the chooser's threshold; finer beside a switch.
fn quality_for_threshold(threshold: f32, beside_switch: bool) -> Quality {
    var q = Quality(3.5, 0.1, 0.3, 0.8, 12.0, 0.6, 0.12);
    if threshold < 0.2425 {
        q = Quality(3.0, 0.5, 1.0, 1.5, 7.5, 0.8, 0.35);
    } else if threshold < 0.324 {
        q = Quality(3.0, 0.4, 0.75, 1.5, 9.0, 0.8, 0.18);
    } else if threshold < 0.359 {
        q = Quality(3.2, 0.3, 0.6, 1.5, 9.0, 0.8, 0.15);
    } else if threshold < 0.391 {
        q = Quality(3.5, 0.15, 0.4, 0.8, 10.0, 0.8, 0.15);
    }
    if beside_switch {
        q.cell_phase = min(q.cell_phase, 0.2);
        q.cell_sigmas = min(q.cell_sigmas, 0.5);
    }
    return q;
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

// A piece with one that has no width added to it.
fn piece_with(piece: Piece, mean: f32, mass: f32) -> Piece {
    let total = piece.mass + mass;
    return Piece(total, (piece.mass * piece.mean + mass * mean) / total, piece.variance);
}

// Variances of the upper and the lower family's phase in a piece of the given variance.
fn phase_variances(cell: Cell, local: Local, variance: f32) -> vec2<f32> {
    let nd = cell.kappa - local.slope;
    let np = cell.kappa + local.slope;
    return vec2(local.conditional + nd * nd * variance, local.conditional + np * np * variance);
}

fn piece_widths(cell: Cell, local: Local, variance: f32) -> PieceWidths {
    let v = phase_variances(cell, local, variance);
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
    let seen = high - low;
    if seen <= -box_half {
        return vec2(0.0, 1e-6);
    }
    let length = max(smooth_positive(seen, box_half), 1e-6);
    if x > 0.0 {
        low = high - length;
    } else {
        high = low + length;
    }
    // An arc that appears inside the piece has one width: two would leave a mass where its ends meet.
    var above = w.both;
    var below = w.both;
    if seen >= box_half {
        above = end_width(from_above, w, box_half);
        below = end_width(from_below, w, box_half);
    }
    let mass = staircase(high - y, above) - staircase(low - y, below);
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

// One density of corner_excess.
fn corner_density(h: f32, k: f32, sharp: f32, flat_part: f32) -> f32 {
    return exp(-(h - k) * (h - k) * sharp - h * k * flat_part);
}

// What correlation adds to the overlap of the two families over the product of their shares, by bivariate normal integrals.
fn corner_excess(cell: Cell, phase: vec2<f32>, variances: vec2<f32>, covariance: f32) -> f32 {
    let deviation = sqrt(variances);
    let correlation = clamp(covariance / (deviation.x * deviation.y), -1.0, 1.0);
    let side = select(1.0, -1.0, correlation < 0.0);
    let turns = arc_sine(abs(correlation)) * 0.15915494;
    let d = vec2(wrap(cell.h_d - phase.x), wrap(-cell.h_d - phase.x)) / deviation.x;
    let p = vec2(wrap(cell.h_p - phase.y), wrap(-cell.h_p - phase.y)) * (side / deviation.y);
    // Six-point Gauss-Legendre rule on [0, 1].
    var nodes = array<vec2<f32>, 6>(
        vec2(0.0337652429, 0.0856622462), vec2(0.1693953068, 0.1803807865), vec2(0.3806904069, 0.2339569673),
        vec2(0.6193095931, 0.2339569673), vec2(0.8306046932, 0.1803807865), vec2(0.9662347571, 0.0856622462),
    );
    var sum = 0.0;
    for (var i = 0; i < 6; i++) {
        let at = nodes[i].x * turns;
        let cosine = cosine_turns(at);
        let sharp = 0.5 / max(cosine * cosine, 1e-9);
        let flat_part = 1.0 / (1.0 + sine_turns(at));
        sum += nodes[i].y * (corner_density(d.x, p.x, sharp, flat_part) - corner_density(d.x, p.y, sharp, flat_part)
            - corner_density(d.y, p.x, sharp, flat_part) + corner_density(d.y, p.y, sharp, flat_part));
    }
    return side * turns * sum;
}

// Barbule periods that the edges climb across the footprint per barb period.
fn edge_climb(cell: Cell, local: Local) -> f32 {
    return cell.kappa + select(0.0, abs(local.slope), local.conditional < 0.2);
}

// NEAR: everything resolved.
fn near_coverage(cell: Cell, local: Local, quality: Quality) -> vec3<f32> {
    return near_counted(cell, local, quality).xyz;
}

// The same and the number of cells that it walked through.
fn near_counted(cell: Cell, local: Local, quality: Quality) -> vec4<f32> {
    let sigma = sqrt(local.variance);
    let reach = quality.reach * sigma;
    let barb_width = width(local.variance);
    let open = clamp(
        staircase(cell.v_high - local.u, barb_width) - staircase(cell.v_low - local.u, barb_width), 0.0, 1.0);
    let hb = 0.5 - cell.h_d;
    let change_e = abs(hb - cell.h_p);
    let change_g = hb + cell.h_p;
    let climb = edge_climb(cell, local);
    let sharpness = sqrt(local.conditional);
    let cell_sigmas = quality.cell_sigmas * clamp(sharpness / (climb * sigma), quality.least_sigmas, 1.0);
    var cell_phase = min(quality.cell_phase, max(quality.least_arc * min(hb, cell.h_p), 0.15));
    let estimate = (reach + reach) * max(cell.v_high - cell.v_low, 0.5) * climb / cell_phase;
    cell_phase = cell_phase * max(estimate * (1.0 / 128.0), 1.0);
    // What lies beyond the reach is put into the outermost cells.
    let tail = normal_distribution(-quality.reach);
    let tail_mean = normal_density(quality.reach) / tail;

    let bottom = local.u - reach;
    let top = local.u + reach;
    let first = ceil(bottom - cell.v_high);
    let last = floor(top - cell.v_low);
    let gaps = i32(clamp(last - first + 1.0, 0.0, f32(MAX_GAPS)));
    var total = 0.0;
    var upper = 0.0;
    var lower = 0.0;
    var trips = 0;
    // Of a footprint inside one gap the two families' own coverage is exact; cells only have to tell how they overlap.
    var exact = false;
    var exact_upper = 0.0;
    var exact_lower = 0.0;
    for (var gap = 0; gap < gaps; gap++) {
        let k = first + f32(gap);
        let low = max(bottom, k + cell.v_low);
        let high = min(top, k + cell.v_high);
        let length = high - low;
        if length <= 0.0 {
            continue;
        }
        let uncut = low <= bottom && high >= top;
        let x_middle = wrap(phase_difference(cell, 0.5 * (low + high) - k) - 0.5);
        let ax = abs(x_middle);
        let vary = cell.kappa * length;
        let typed = abs(ax - change_e) > vary && abs(ax - change_g) > vary && abs(1.0 - ax - change_g) > vary
            && ax + vary < 0.5;
        if uncut {
            let w = piece_widths(cell, local, local.variance);
            let phase = family_phases(cell, local, k, local.u);
            let v = phase_variances(cell, local, local.variance);
            exact = true;
            exact_upper = family_mass(phase.x, cell.h_d, w.upper);
            exact_lower = family_mass(phase.y, cell.h_p, w.lower);
            let dd = abs(phase.x) - cell.h_d;
            let dp = abs(phase.y) - cell.h_p;
            var done = true;
            lower = exact_lower * (1.0 - exact_upper);
            if dd * dd <= quality.edge_sigmas_squared * v.x && dp * dp <= quality.edge_sigmas_squared * v.y {
                if typed {
                    lower = lower_mass(cell, phase.x, x_middle, w, true);
                } else if max(v.x, v.y) < CORNER_VARIANCE {
                    let slopes = (cell.kappa - local.slope) * (cell.kappa + local.slope);
                    lower -= corner_excess(cell, phase, v, local.conditional - slopes * local.variance);
                } else {
                    lower = 0.0;
                    done = false;
                }
            }
            if done {
                total = 1.0;
                exact_lower = 0.0;
                continue;
            }
        }
        let za = (low - local.u) / sigma;
        let zb = (high - local.u) / sigma;
        let single = !uncut && typed && climb * length < quality.single_sigmas * sharpness;
        let wanted = ceil(max(length * climb / cell_phase, (zb - za) / cell_sigmas));
        let count = select(clamp(wanted, 1.0, f32(MAX_CELLS)), 1.0, single);
        let step = (zb - za) / count;
        var piece = truncated_piece(za, zb);
        let variance = select(step * step * (1.0 / 12.0), piece.variance, single);
        let w = piece_widths(cell, local, local.variance * variance);
        let cells = i32(count);
        trips += cells;
        for (var i = 0; i < cells; i++) {
            if !single {
                piece = midpoint_piece(za + (f32(i) + 0.5) * step, step);
                if i == 0 && low <= bottom {
                    piece = piece_with(piece, -tail_mean, tail);
                }
                if i + 1 == cells && high >= top {
                    piece = piece_with(piece, tail_mean, tail);
                }
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
    if total <= 0.0 {
        return vec4(1.0 - open, 0.0, 0.0, f32(trips));
    }
    let scale = open / max(total, 1e-6);
    upper *= scale;
    lower *= scale;
    if exact {
        upper = exact_upper * open;
        lower += exact_lower * open;
    }
    upper = clamp(upper, 0.0, open);
    return vec4(1.0 - open, upper, clamp(lower, 0.0, open - upper), f32(trips));
}
