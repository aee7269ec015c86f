#define_import_path bevy_plumage::query_far

// Coverage by averages and by harmonics: MEAN, STRIPE, LATTICE. Twin of src/maths/query/{mean,stripe,lattice}.rs.

#import bevy_plumage::math::{PI, wrap, width, staircase, staircase_derivatives, overlap_integral, overlap_second_integral, overlap_third_integral, sine_turns, cosine_turns}
#import bevy_plumage::masking::{Cell}

// Most rows of harmonics, most nodes in a row.
const MAX_ROWS: i32 = 8;
const MAX_COLUMNS: i32 = 48;

// A footprint in cell units, reduced to the cell around barb 0.
struct Local {
    u: f32,
    tau: f32,
    variance: f32,
    slope: f32,
    conditional: f32,
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
    // What the ends of the gap leave of the teeth: repeated integration by parts.
    let inverse = 0.5 / cell.kappa;
    let third = overlap_third_integral(x_high, cell.h_d, cell.h_p) * at_high.z
        - overlap_third_integral(x_low, cell.h_d, cell.h_p) * at_low.z;
    let second = overlap_second_integral(x_high, cell.h_d, cell.h_p) * at_high.y
        - overlap_second_integral(x_low, cell.h_d, cell.h_p) * at_low.y;
    let first = overlap_integral(x_high, cell.h_d, cell.h_p) * at_high.x
        - overlap_integral(x_low, cell.h_d, cell.h_p) * at_low.x;
    let edges = ((third * inverse + second) * inverse + first) * inverse;
    return vec3(1.0 - open, f_d * open, f_p * (1.0 - f_d) * open + edges);
}

// Coefficients of a train of arcs that covers the share `f` of its circle: sin(pi m f) / (pi m).
fn coefficients(f: f32) -> array<f32, 10> {
    var a: array<f32, 10>;
    a[0] = f;
    var before = 0.0;
    var now = sine_turns(0.5 * f);
    let twice = 2.0 * cosine_turns(0.5 * f);
    for (var m = 1; m < 10; m++) {
        a[m] = now / (PI * f32(m));
        let next = twice * now - before;
        before = now;
        now = next;
    }
    return a;
}

// Spectrum of a window of length `l`.
fn window_spectrum(x: f32, l: f32) -> f32 {
    if abs(x) < 1e-3 {
        return l;
    }
    return sine_turns(wrap(0.5 * x * l)) / (PI * x);
}

// LATTICE: STRIPE plus the harmonics that are left; `budget` from `row_budget`.
fn lattice_coverage(cell: Cell, local: Local, budget: f32) -> vec3<f32> {
    var sum = stripe_coverage(cell, local);
    let open = cell.v_high - cell.v_low;
    let middle = 0.5 * (cell.v_low + cell.v_high);
    var a = coefficients(cell.h_d + cell.h_d);
    var b = coefficients(cell.h_p + cell.h_p);
    let root = wrap(cell.kappa + cell.e_root + cell.s_p);
    let rows = i32(clamp(floor(sqrt(max(budget, 0.0) / local.conditional)), 0.0, f32(MAX_ROWS)));
    for (var q = 1; q <= rows; q++) {
        let qt = f32(q);
        let reach = sqrt(max(budget - local.conditional * qt * qt, 0.0) / local.variance);
        let centre = qt * (cell.e_root - local.slope);
        let first = ceil(centre - reach);
        let columns = i32(min(floor(centre + reach - first) + 1.0, f32(MAX_COLUMNS)));
        for (var i = 0; i < columns; i++) {
            let p = first + f32(i) - qt * cell.e_root;
            let off = p + qt * local.slope;
            let damping = 2.0 * exp(-19.7392088 * (local.variance * off * off + local.conditional * qt * qt));
            let base = wrap(p * local.u) + wrap(qt * local.tau);
            let at = -qt * cell.kappa - p;
            sum.y += damping * a[q] * window_spectrum(at, open) * cosine_turns(base + wrap(at * middle) - qt * cell.s_d);
            var lower = 0.0;
            for (var m = -1; m <= q + 1; m++) {
                let n = q - m;
                let mt = f32(m);
                let nt = f32(n);
                let gap = select(-a[abs(m)], 1.0 - a[0], m == 0);
                let x = (nt - mt) * cell.kappa - p;
                lower += gap * b[abs(n)] * window_spectrum(x, open)
                    * cosine_turns(base + wrap(x * middle) - nt * root - mt * cell.s_d);
            }
            sum.z += damping * lower;
        }
    }
    return sum;
}
