// Shadows between the fibres of a vane: which share of a fibre that the eye sees is reached by a light. Twin of src/query/shadow.rs.
#define_import_path bevy_plumage::shadow
#import bevy_plumage::masking::Vane

const SHADOW_TAU: f32 = 6.28318530717959;
const SHADOW_LEAST_FACING: f32 = 1e-3;

// How a direction, the eye's or a light's, lies to the storeys of a vane: see the Rust struct of the same name.
struct VaneSight {
    facing: f32,
    near_gap: vec2<f32>,
    far_gap: vec2<f32>,
    open: vec2<f32>,
    wide: vec2<f32>,
    shift: f32,
    ripples: vec3<f32>,
}

// sin(x) / x.
fn sinc_ratio(x: f32) -> f32 {
    return select(sin(x) / x, 1.0 - x * x / 6.0, abs(x) < 1e-3);
}

// Gap between two barbs at a height, in barb periods. long: half a barb's width as projected, slope: of the direction.
fn barb_gap(vane: Vane, s: f32, slope: f32, long: f32, height: f32) -> vec2<f32> {
    let far = max(long - height * slope, vane.r_b);
    let strip = select(vec2(vane.r_b, far), vec2(far, vane.r_b), s > 0.0);
    let low = strip.y / vane.p_b;
    return vec2(low, max(1.0 - strip.x / vane.p_b, low));
}

// Share of a barb's width above a height.
fn barb_above(vane: Vane, s: f32, slope: f32, long: f32, height: f32) -> f32 {
    let gap = barb_gap(vane, s, slope, long, height);
    return min((1.0 - (gap.y - gap.x)) * vane.p_b / max(long + long, 1e-9), 1.0);
}

// Width over period of fibres whose normal has the component `across` of the direction.
fn projected_width(across: f32, radius: f32, hooked: f32, n: f32, period: f32) -> f32 {
    let slope = across / n;
    return (radius + radius) * sqrt(hooked * hooked + slope * slope) / period;
}

// direction: unit, canonical frame of the left vane. hooked: breadth over height of the barbules. distal_above: the eye sees the front; the same for the eye and every light.
fn vane_sight(vane: Vane, hooked: f32, direction: vec3<f32>, distal_above: bool) -> VaneSight {
    let facing = direction.z;
    let n = max(abs(facing), SHADOW_LEAST_FACING);
    let s = direction.x * vane.cos_b + direction.y * vane.sin_b;
    let t = direction.y * vane.cos_b - direction.x * vane.sin_b;
    let storey = vane.r_bd + vane.r_bp;
    let lift = 0.5 * storey;
    let lit = 0.5 * lift;
    let slope = abs(s) / n;
    let long = vane.r_b * sqrt(1.0 + slope * slope);
    let c = vane.cos_bl;
    let b = vane.sin_bl;
    let distal = s * c - t * b;
    let proximal = s * c + t * b;
    let upper = select(proximal, distal, distal_above);
    let lower = select(distal, proximal, distal_above);
    let lower_radius = select(vane.r_bd, vane.r_bp, distal_above);
    let period = max(vane.d_bl * vane.sin_bl, 1e-9);
    let wide = vec2(
        projected_width(upper, select(vane.r_bp, vane.r_bd, distal_above), hooked, n, period),
        projected_width(lower, lower_radius, hooked, n, period),
    );
    let stacked = min(select(wide.yx, wide, (facing >= 0.0) == distal_above), vec2(1.0));
    let barb = stacked.x * barb_above(vane, s, slope, long, lift + lit + lit)
        + (1.0 - stacked.x) * (stacked.y * barb_above(vane, s, slope, long, lit + lit - lift) + 1.0 - stacked.y);
    let rachis = 0.5 + 0.5 * min(n / sqrt(max(1.0 - direction.y * direction.y, n * n)), 1.0);
    let cosine = c * c - b * b;
    let sine = 2.0 * c * b;
    let size = sqrt(lower * lower + n * n);
    let along = select(s * b + t * c, s * b - t * c, distal_above);
    let middle = 0.785398163397448 * lower_radius * along * sine / size;
    let breadth = lower_radius / period * abs(hooked * cosine * n + lower * upper / n) / size;
    let half_width = min(0.5 * wide.x, 0.5);
    var ripples = vec3(0.0);
    for (var k = 0u; k < 3u; k++) {
        let w = SHADOW_TAU * f32(k + 1u);
        ripples[k] = 2.0 * half_width * sinc_ratio(w * half_width) * sinc_ratio(w * breadth);
    }
    return VaneSight(
        facing,
        barb_gap(vane, s, slope, long, lift + lit),
        barb_gap(vane, s, slope, long, lit - lift),
        vec2(rachis, barb),
        wide,
        (storey * upper / n - middle) / period,
        ripples,
    );
}

// Share of the eye's gap that is the light's as well.
fn gaps_together(a: vec2<f32>, b: vec2<f32>) -> f32 {
    return clamp((min(a.y, b.y) - max(a.x, b.x)) / max(a.y - a.x, 1e-6), 0.0, 1.0);
}

// Shares of rachis, barbs, distal and proximal barbules that the light reaches of what the eye sees.
fn vane_shadow(eye: VaneSight, light: VaneSight, distal_above: bool) -> vec4<f32> {
    let own = 1.0 / max(light.wide, vec2(1.0));
    var upper = own.x;
    var lower = own.y;
    if (eye.facing >= 0.0) == (light.facing >= 0.0) {
        let closed = min(eye.wide.x, 1.0);
        let first = cos(SHADOW_TAU * (light.shift - eye.shift));
        let second = 2.0 * first * first - 1.0;
        let cosines = vec3(first, second, 2.0 * first * second - first);
        let both = (1.0 - closed) * (1.0 - min(light.wide.x, 1.0)) + 2.0 * dot(eye.ripples * light.ripples, cosines);
        upper *= gaps_together(eye.near_gap, light.near_gap);
        lower *= clamp(both / max(1.0 - closed, 1e-3), 0.0, 1.0) * gaps_together(eye.far_gap, light.far_gap);
    } else {
        upper *= max(1.0 - light.wide.y, 0.0) * gaps_together(eye.near_gap, light.far_gap);
        lower *= gaps_together(eye.far_gap, light.near_gap);
    }
    return vec4(light.open, select(vec2(lower, upper), vec2(upper, lower), distal_above));
}
