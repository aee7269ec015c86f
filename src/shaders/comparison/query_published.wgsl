#define_import_path bevy_plumage::query_published

// The range query as published (Chen et al. 2026, Sec. 5.1-5.3), for comparison. Twin of plumage_reference::query_published.

#import bevy_plumage::math::{wrap, sine_turns, cosine_turns, normal_density, normal_distribution}
#import bevy_plumage::masking::{Vane, Cell}
#import bevy_plumage::footprint::{Footprint}
#import bevy_plumage::query::{reduce, shares}
#import bevy_plumage::query_far::{Local}

// Methods.
const PUBLISHED_POINTS: u32 = 1u;
const PUBLISHED_SPATIAL: u32 = 2u;
const PUBLISHED_WHOLE_GAP: u32 = 3u;
const PUBLISHED_FREQUENCY: u32 = 4u;
const PUBLISHED_SWITCH: u32 = 5u;

// Most gaps that are visited, most barbules that are summed at a node.
const MAX_PUBLISHED_GAPS: i32 = 256;
const MAX_BARBULES: i32 = 1024;

// One of the methods: samples of PUBLISHED_POINTS; Gauss-Legendre nodes per gap (4, 6, 8, 16, 32 or 64); orders of the frequency
// domain, stripes (k_g, 0..16) and window (k_q, 0..32).
struct PublishedMethod {
    kind: u32,
    samples: u32,
    nodes: u32,
    stripes: i32,
    window: i32,
}

// Upper halves of the Gauss-Legendre rules with 4, 6, 8, 16, 32, 64 nodes: abscissa, weight.
var<private> gauss_table: array<vec2<f32>, 65> = array<vec2<f32>, 65>(
    vec2(0.339981044, 0.652145155), vec2(0.861136312, 0.347854845), vec2(0.238619186, 0.467913935),
    vec2(0.661209386, 0.360761573), vec2(0.932469514, 0.171324492), vec2(0.183434642, 0.362683783),
    vec2(0.52553241, 0.313706646), vec2(0.796666477, 0.222381034), vec2(0.960289856, 0.101228536),
    vec2(0.0950125098, 0.18945061), vec2(0.281603551, 0.182603415), vec2(0.458016778, 0.169156519),
    vec2(0.617876244, 0.149595989), vec2(0.755404408, 0.124628971), vec2(0.865631202, 0.0951585117),
    vec2(0.944575023, 0.0622535239), vec2(0.989400935, 0.0271524594), vec2(0.0483076657, 0.0965400885),
    vec2(0.144471962, 0.0956387201), vec2(0.239287362, 0.0938443991), vec2(0.331868602, 0.0911738787),
    vec2(0.421351276, 0.087652093), vec2(0.506899909, 0.0833119242), vec2(0.587715757, 0.0781938958),
    vec2(0.663044267, 0.0723457941), vec2(0.732182119, 0.0658222228), vec2(0.794483796, 0.0586840935),
    vec2(0.849367614, 0.0509980593), vec2(0.896321156, 0.042835898), vec2(0.934906076, 0.0342738629),
    vec2(0.964762256, 0.0253920653), vec2(0.985611512, 0.0162743947), vec2(0.997263862, 0.00701861001),
    vec2(0.0243502927, 0.048690957), vec2(0.0729931218, 0.0485754674), vec2(0.121462819, 0.0483447622),
    vec2(0.16964442, 0.0479993886), vec2(0.217423644, 0.0475401657), vec2(0.264687162, 0.0469681828),
    vec2(0.311322872, 0.0462847966), vec2(0.357220158, 0.0454916279), vec2(0.402270158, 0.0445905582),
    vec2(0.446366017, 0.0435837245), vec2(0.489403146, 0.0424735151), vec2(0.531279464, 0.0412625632),
    vec2(0.571895646, 0.0399537411), vec2(0.611155355, 0.0385501532), vec2(0.648965471, 0.0370551285),
    vec2(0.685236313, 0.0354722133), vec2(0.71988185, 0.0338051618), vec2(0.752819907, 0.0320579284),
    vec2(0.783972359, 0.0302346571), vec2(0.813265315, 0.0283396726), vec2(0.840629296, 0.0263774697),
    vec2(0.865999398, 0.0243527026), vec2(0.889315446, 0.0222701738), vec2(0.910522137, 0.0201348232),
    vec2(0.929569172, 0.0179517158), vec2(0.946411375, 0.0157260305), vec2(0.9610088, 0.0134630479),
    vec2(0.973326828, 0.0111681395), vec2(0.983336254, 0.00884675983), vec2(0.991013371, 0.00650445797),
    vec2(0.996340117, 0.00414703326), vec2(0.999305042, 0.00178328072),
);

// Node `i` of the rule with `count` nodes.
fn gauss_legendre(count: u32, i: u32) -> vec2<f32> {
    let half = count / 2u;
    var first = 33u;
    switch count {
        case 4u: { first = 0u; }
        case 6u: { first = 2u; }
        case 8u: { first = 5u; }
        case 16u: { first = 9u; }
        case 32u: { first = 17u; }
        default: {}
    }
    let node = gauss_table[min(first + select(i, i - half, i >= half), 64u)];
    return select(vec2(-node.x, node.y), node, i >= half);
}

// A supported number of nodes.
fn gauss_count(nodes: u32) -> u32 {
    if nodes <= 4u { return 4u; }
    if nodes <= 6u { return 6u; }
    if nodes <= 8u { return 8u; }
    if nodes <= 16u { return 16u; }
    if nodes <= 32u { return 32u; }
    return 64u;
}

// Sample `index` of a standard normal in two dimensions.
fn published_sample(index: u32) -> vec2<f32> {
    let bits = (vec2(index) + 1u) * vec2(3242174889u, 2447445414u) + (1u << 31u);
    let at = (vec2<f32>(bits >> vec2(8u)) + 0.5) / 16777216.0;
    let radius = sqrt(max(-2.0 * log(at.x), 0.0));
    return radius * vec2(cosine_turns(at.y), sine_turns(at.y));
}

// The point query in cell units: 0 nothing, 1 barb, 2 upper, 3 lower family.
fn point_component(cell: Cell, u: f32, tau: f32) -> u32 {
    if u < cell.v_low || u > cell.v_high {
        return 1u;
    }
    if abs(wrap(tau - cell.kappa * u - cell.s_d)) < cell.h_d {
        return 2u;
    }
    return select(0u, 3u, abs(wrap(tau - cell.kappa * (1.0 - u) - cell.e_root - cell.s_p)) < cell.h_p);
}

// (barb, upper, lower) by point queries.
fn published_points(cell: Cell, local: Local, samples: u32) -> vec3<f32> {
    let count = max(samples, 1u);
    let deviation = sqrt(vec2(local.variance, local.conditional));
    var hits = vec3(0u);
    for (var i = 0u; i < count; i++) {
        let z = published_sample(i);
        let u = local.u + deviation.x * z.x;
        let k = floor(u);
        let tau = wrap(local.tau + local.slope * (u - local.u) + deviation.y * z.y - k * cell.e_root);
        let hit = point_component(cell, u - k, tau);
        hits += vec3(select(0u, 1u, hit == 1u), select(0u, 1u, hit == 2u), select(0u, 1u, hit == 3u));
    }
    return vec3<f32>(hits) / f32(count);
}

// Mass of an interval under a Gaussian.
fn published_interval(low: f32, high: f32, mean: f32, sigma: f32) -> f32 {
    if high <= low {
        return 0.0;
    }
    return normal_distribution((high - mean) / sigma) - normal_distribution((low - mean) / sigma);
}

// First index and number of the barbules within `span` of `at`.
fn published_barbules(at: f32, span: f32) -> vec2<f32> {
    let within = min(span, f32(MAX_BARBULES / 2));
    let first = ceil(at - within);
    return vec2(first, min(floor(at + within - first) + 1.0, f32(MAX_BARBULES)));
}

// Eq. 15-19 at one node: mass of the upper family and of what is left of the lower one, at `u` in gap `k`.
fn published_node(cell: Cell, local: Local, k: f32, u: f32) -> vec2<f32> {
    let sigma = sqrt(local.conditional);
    let mean = local.tau + local.slope * (u - local.u);
    let c_d = cell.kappa * (u - k) + k * cell.e_root + cell.s_d;
    let c_p = cell.kappa * (k + 1.0 - u) + (k + 1.0) * cell.e_root + cell.s_p;
    let span = 4.0 * sigma + 1.0;
    let reach = f32(MAX_BARBULES / 2);
    var all = 1.0;
    if span > reach {
        all = published_interval(mean - reach, mean + reach, mean, sigma);
    }
    var sum = vec2(0.0);
    var near = published_barbules(mean - c_d, span);
    for (var j = 0; j < i32(near.y); j++) {
        let c = c_d + near.x + f32(j);
        sum.x += published_interval(c - cell.h_d, c + cell.h_d, mean, sigma);
    }
    near = published_barbules(mean - c_p, span);
    for (var j = 0; j < i32(near.y); j++) {
        let c = c_p + near.x + f32(j);
        sum.y += published_interval(c - cell.h_p, c + cell.h_p, mean, sigma);
        let nearest = floor(c - c_d + 0.5);
        for (var offset = -1; offset <= 1; offset++) {
            let d = c_d + nearest + f32(offset);
            sum.y -= published_interval(max(d - cell.h_d, c - cell.h_p), min(d + cell.h_d, c + cell.h_p), mean, sigma);
        }
    }
    return sum / all;
}

// (barb, upper, lower) by Eq. 12-19; `clipped` to four deviations of the footprint, or over the whole gap as printed.
fn published_spatial(cell: Cell, local: Local, nodes: u32, clipped: bool) -> vec3<f32> {
    let count = gauss_count(nodes);
    let sigma = sqrt(local.variance);
    let reach = 4.0 * sigma;
    let first = floor(local.u - reach - 1.0);
    let gaps = i32(min(floor(local.u + reach + 1.0 - first) + 1.0, f32(MAX_PUBLISHED_GAPS)));
    var sum = vec3(0.0);
    for (var i = 0; i < gaps; i++) {
        let k = first + f32(i);
        sum.x += published_interval(k - (1.0 - cell.v_high), k + cell.v_low, local.u, sigma);
        var low = k + cell.v_low;
        var high = k + cell.v_high;
        if clipped {
            low = max(low, local.u - reach);
            high = min(high, local.u + reach);
        }
        if high > low {
            for (var j = 0u; j < count; j++) {
                let node = gauss_legendre(count, j);
                let u = 0.5 * (low + high) + 0.5 * (high - low) * node.x;
                let mass = 0.5 * (high - low) * node.y * normal_density((u - local.u) / sigma) / sigma;
                sum += mass * vec3(0.0, published_node(cell, local, k, u));
            }
        }
    }
    return vec3(clamp(sum.x, 0.0, 1.0), sum.yz);
}

// Coefficient `m` of a train of stripes that covers the share `f`.
fn published_coefficient(m: i32, f: f32) -> f32 {
    if m == 0 {
        return f;
    }
    return sine_turns(0.5 * f32(m) * f) / (3.14159265 * f32(m));
}

fn published_sinc(x: f32) -> f32 {
    if abs(x) < 1e-3 {
        return 1.0;
    }
    return sine_turns(0.5 * x) / (3.14159265 * x);
}

// One node of the lattice, of frequency (climb - x, q).
fn published_harmonic(cell: Cell, local: Local, x: f32, climb: f32, q: f32, phase: f32) -> f32 {
    let p = climb - x;
    let open = cell.v_high - cell.v_low;
    let along = p + local.slope * q;
    let damping = exp(-19.7392088 * (local.variance * along * along + local.conditional * q * q));
    let turns = wrap(p * local.u) + wrap(q * local.tau) + wrap(x * 0.5 * (cell.v_low + cell.v_high)) - phase;
    return damping * open * published_sinc(x * open) * cosine_turns(turns);
}

// (barb, upper, lower) by Eq. 23-25.
fn published_frequency(cell: Cell, local: Local, stripe_orders: i32, window_orders: i32) -> vec3<f32> {
    let stripes = clamp(stripe_orders, 0, 16);
    let window = clamp(window_orders, 0, 32);
    let f_d = cell.h_d + cell.h_d;
    let f_p = cell.h_p + cell.h_p;
    let shift_d = wrap(cell.kappa - cell.e_root);
    let shift_p = wrap(cell.kappa + cell.e_root);
    let root_p = cell.kappa + cell.e_root + cell.s_p;
    var sum = vec3(1.0 - (cell.v_high - cell.v_low), 0.0, 0.0);
    for (var order = -window; order <= window; order++) {
        let turn = f32(order);
        if order != 0 {
            sum.x -= published_harmonic(cell, local, turn, 0.0, 0.0, 0.0);
        }
        for (var m = -stripes; m <= stripes; m++) {
            let mt = f32(m);
            let a = published_coefficient(m, f_d);
            let b = published_coefficient(m, f_p);
            sum.y += a * published_harmonic(cell, local, -turn - mt * shift_d, -mt * cell.kappa, mt, mt * cell.s_d);
            sum.z += b * published_harmonic(cell, local, mt * shift_p - turn, mt * cell.kappa, mt, mt * root_p);
            for (var n = -stripes; n <= stripes; n++) {
                let nt = f32(n);
                let x = nt * shift_p - mt * shift_d - turn;
                let phase = mt * cell.s_d + nt * root_p;
                sum.z -= a * published_coefficient(n, f_p)
                    * published_harmonic(cell, local, x, (nt - mt) * cell.kappa, mt + nt, phase);
            }
        }
    }
    return sum;
}

// (barb, upper, lower) by a method, as it gives them: not clamped.
fn published_evaluate(cell: Cell, local: Local, how: PublishedMethod) -> vec3<f32> {
    var kind = how.kind;
    if kind == PUBLISHED_SWITCH {
        kind = select(PUBLISHED_SPATIAL, PUBLISHED_FREQUENCY, local.variance >= 4.0);
    }
    if kind == PUBLISHED_POINTS {
        return published_points(cell, local, how.samples);
    }
    if kind == PUBLISHED_FREQUENCY {
        return published_frequency(cell, local, how.stripes, how.window);
    }
    return published_spatial(cell, local, how.nodes, kind != PUBLISHED_WHOLE_GAP);
}

// (barb, distal, proximal) coverage of a footprint over the left vane, clamped to shares: stands in for `vane_coverage`.
fn published_vane_coverage(cell: Cell, vane: Vane, footprint: Footprint, how: PublishedMethod) -> vec3<f32> {
    return shares(cell, published_evaluate(cell, reduce(cell, vane, footprint), how));
}
