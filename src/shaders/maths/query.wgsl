#define_import_path bevy_plumage::query

// Coverage of a pixel footprint by barbs and barbules. Twin of src/maths/query/{vane,choose,coverage}.rs, where the derivations are.

#import bevy_plumage::math::{wrap}
#import bevy_plumage::footprint::{LEAST_VARIANCE, Footprint, widened}
#import bevy_plumage::masking::{Vane, Cell}
#import bevy_plumage::query_far::{MAX_ROWS, Local, mean_coverage, stripe_coverage, lattice_coverage}
#import bevy_plumage::query_near::{edge_climb, quality_for_threshold, near_coverage}

// What is known of all pixels of a card.
const LOD_NEAR: u32 = 1u;
const LOD_FAR: u32 = 2u;
const LOD_MEAN: u32 = 3u;
const LOD_MIXED: u32 = 4u;
// Among the evaluators of `choose` only: harmonics are left.
const LATTICE: u32 = 5u;

// What averages over whole footprints averages over the parts that a line leaves of them, if it does so with this much to spare.
const PARTS_MARGIN: f32 = 4.0;

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

// Exponent budget of the first row of harmonics along the barb.
fn row_budget(cell: Cell, local: Local, threshold: f32) -> f32 {
    let sigma = sqrt(local.variance);
    let density = max(0.16 / sqrt(local.variance * local.conditional), 1.0);
    let slowest = min(abs(cell.kappa - local.slope), abs(cell.kappa + local.slope));
    let x = max(slowest - 0.47 / sigma, 0.32);
    let window = min(max(1.0, min(1.0 + 0.4 / sigma, 3.2 * x)) / (3.14159265 * x), 1.0);
    return threshold + log(window * density) / 19.7392088;
}

// What the chooser picked: an evaluator (LOD_NEAR, LATTICE, LOD_FAR for STRIPE, LOD_MEAN), whether NEAR has to be fine because it
// is close to a switch, and the exponents that LATTICE keeps.
struct Choice {
    evaluator: u32,
    beside_switch: bool,
    row_budget: f32,
}

// The cheapest evaluator within the budget.
fn choose(cell: Cell, local: Local, threshold: f32) -> Choice {
    // What STRIPE leaves out of the teeth inside a gap is below half the budget from here on (docs/book/fits/chooser.py).
    let least_teeth = max(threshold - 0.041, 0.05);
    let teeth = 4.0 * cell.kappa * cell.kappa * local.variance;
    if local.conditional > threshold {
        if local.variance > threshold {
            return Choice(LOD_MEAN, false, 0.0);
        }
        if teeth > least_teeth {
            return Choice(LOD_FAR, false, 0.0);
        }
    }
    if teeth <= 0.0625 {
        return Choice(LOD_NEAR, false, 0.0);
    }
    let budget = row_budget(cell, local, threshold);
    if teeth > least_teeth && local.conditional > budget {
        return Choice(LOD_FAR, false, budget);
    }
    let rows = floor(sqrt(max(budget, 0.0) / local.conditional));
    let nodes = rows + 1.57079633 * max(budget, 0.0) / sqrt(local.conditional * local.variance);
    let open = cell.v_high - cell.v_low;
    let cells = 6.0 * sqrt(local.variance) * max(open, 1.0 - open) * edge_climb(cell, local) / 0.4 + 1.0;
    if teeth > least_teeth && (local.variance > 25.0 || (rows <= f32(MAX_ROWS) && 1.2 * nodes <= cells)) {
        return Choice(LATTICE, false, budget);
    }
    return Choice(LOD_NEAR, 6.0 * nodes < 7.0 * cells, budget);
}

// What can be said of every footprint whose minor axis is at least `sigma_minor_min`, the major one at most `sigma_major_max`.
fn classify_bounds(vane: Vane, sigma_minor_min: f32, sigma_major_max: f32, threshold: f32) -> u32 {
    let across = sigma_minor_min / vane.p_b;
    let along = sigma_minor_min / vane.d_bl;
    let kappa = max(vane.cos_bl / vane.sin_bl * vane.p_b / vane.d_bl, 0.01);
    let teeth = 4.0 * kappa * kappa;
    let least_teeth = max(threshold - 0.041, 0.05);
    if along * along > threshold && across * across > threshold {
        return LOD_MEAN;
    }
    if along * along > PARTS_MARGIN * threshold && teeth * across * across > least_teeth {
        return LOD_FAR;
    }
    let across_max = sigma_major_max / vane.p_b;
    let along_max = sigma_major_max / vane.d_bl;
    if teeth * across_max * across_max <= least_teeth && (along_max * along_max <= threshold || across_max * across_max <= threshold) {
        return LOD_NEAR;
    }
    return LOD_MIXED;
}

// (barb, distal, proximal) in cell units.
fn cell_coverage(cell: Cell, local: Local, lod: u32, threshold: f32) -> vec3<f32> {
    var choice = Choice(lod, false, 0.0);
    if lod != LOD_FAR && lod != LOD_MEAN {
        // A card of near pixels still asks whether one has to be finer.
        choice = choose(cell, local, threshold);
    }
    var w: vec3<f32>;
    if choice.evaluator == LOD_MEAN {
        w = mean_coverage(cell);
    } else if choice.evaluator == LOD_FAR {
        w = stripe_coverage(cell, local);
    } else if choice.evaluator == LATTICE {
        w = lattice_coverage(cell, local, choice.row_budget);
    } else {
        w = near_coverage(cell, local, quality_for_threshold(threshold, choice.beside_switch));
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
