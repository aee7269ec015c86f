#define_import_path bevy_plumage::masking

// How much wider fibres look, projected onto the feather's surface, from an inclined view. Twin of src/query/masking.rs.

#import bevy_plumage::math::{wrap}

// One vane in canonical units (feather lengths); layout of the Rust struct of the same name.
struct Vane {
    p_b: f32,
    d_bl: f32,
    cos_b: f32,
    sin_b: f32,
    cos_bl: f32,
    sin_bl: f32,
    r_b: f32,
    r_bd: f32,
    r_bp: f32,
}

// The pattern of a vane seen from one direction, in units of its periods: see the Rust struct of the same name.
struct Cell {
    kappa: f32,
    e_root: f32,
    v_low: f32,
    v_high: f32,
    h_d: f32,
    h_p: f32,
    s_d: f32,
    s_p: f32,
    side: f32,
}

// Strip hidden by a fibre lying in the surface: distances from its axis (along -r, along +r), both positive.
fn mask_strip(radius_r: f32, radius_n: f32, view_r: f32, view_n: f32) -> vec2<f32> {
    let t = abs(view_r) / max(abs(view_n), 1e-3);
    let far = sqrt(radius_r * radius_r + radius_n * radius_n * t * t);
    return select(vec2(radius_r, far), vec2(far, radius_r), view_r > 0.0);
}

// Half width (at most half a period) and centre, in periods, of a strip.
fn strip_to_arc(strip: vec2<f32>, period: f32) -> vec2<f32> {
    return vec2(min(0.5 * (strip.x + strip.y) / period, 0.5), wrap(0.5 * (strip.y - strip.x) / period));
}

// Where the rachis ends on both sides of x = 0: (lower x, upper x).
fn mask_rachis(radius: f32, view: vec3<f32>) -> vec2<f32> {
    let strip = mask_strip(radius, radius, view.x, view.z);
    return vec2(-strip.x, strip.y);
}

// The pattern of the left vane seen along `view`: towards the eye, canonical frame (x, y, front normal), any length.
// For the right vane mirror the view (flip x) and the footprint.
fn mask_vane(vane: Vane, view: vec3<f32>) -> Cell {
    let size = length(view);
    let v = select(vec3(0.0, 0.0, 1.0), view / max(size, 1e-12), size > 1e-12);
    let view_s = v.x * vane.cos_b + v.y * vane.sin_b;
    let view_t = v.y * vane.cos_b - v.x * vane.sin_b;
    let barb = mask_strip(vane.r_b, vane.r_b, view_s, v.z);
    let total = max(barb.x + barb.y, vane.p_b);
    let v_low = barb.y / total;
    let v_high = max(1.0 - barb.x / total, v_low);
    let p_bl = vane.d_bl * vane.sin_bl;
    let across = view_s * vane.cos_bl;
    let along = view_t * vane.sin_bl;
    let distal = strip_to_arc(mask_strip(vane.r_bd, vane.r_bd, across - along, v.z), p_bl);
    let proximal = strip_to_arc(mask_strip(vane.r_bp, vane.r_bp, across + along, v.z), p_bl);
    let ratio = vane.p_b / vane.d_bl;
    let kappa = max(vane.cos_bl / vane.sin_bl * ratio, 0.01);
    let e_root = wrap(vane.cos_b / vane.sin_b * ratio);
    if v.z >= 0.0 {
        return Cell(kappa, e_root, v_low, v_high, distal.x, proximal.x, -distal.y, proximal.y, 1.0);
    }
    // From the back proximal lies over distal: the same pattern, u reversed and the families exchanged.
    return Cell(kappa, -e_root, 1.0 - v_high, 1.0 - v_low, proximal.x, distal.x, proximal.y, -distal.y, -1.0);
}
