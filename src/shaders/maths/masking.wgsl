#define_import_path bevy_plumage::masking

// Which strip of the feather's surface fibres hide from an inclined view. Twin of src/maths/query/masking.rs.

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
    hooked: f32,
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

// Strip hidden by a fibre that lies on the surface: distances from its axis (along -r, along +r), both positive.
fn mask_strip(radius_r: f32, radius_n: f32, view_r: f32, view_n: f32) -> vec2<f32> {
    let t = abs(view_r) / max(abs(view_n), 1e-3);
    let far = sqrt(radius_r * radius_r + radius_n * radius_n * t * t);
    return select(vec2(radius_r, far), vec2(far, radius_r), view_r > 0.0);
}

// Where the rachis ends on both sides of x = 0: (lower x, upper x).
fn mask_rachis(radius: f32, view: vec3<f32>) -> vec2<f32> {
    let strip = mask_strip(radius, radius, view.x, view.z);
    return vec2(-strip.x, strip.y);
}

// Sizes of a family of barbules: half its height (at most a period), one over it, over the period.
struct Family {
    radius: f32,
    inverse: f32,
    ratio: f32,
}

// What every direction to a vane shares: see the Rust struct of the same name.
struct VaneShape {
    vane: Vane,
    per_barb: f32,
    per_barbule: f32,
    barb: f32,
    distal: Family,
    proximal: Family,
    lift: f32,
    kappa: f32,
    e_root: f32,
}

// A family of barbules as one direction sees it: see the Rust struct of the same name.
struct Storey {
    family: Family,
    slope: f32,
    wide: f32,
    root: f32,
}

fn family_of(radius: f32, period: f32, per_barbule: f32) -> Family {
    // Beyond a period a fibre is no wider: its neighbors are there.
    let r = min(radius, period);
    return Family(r, 1.0 / max(r, 1e-9), r * per_barbule);
}

fn vane_shape(vane: Vane) -> VaneShape {
    let period = max(vane.d_bl * vane.sin_bl, 1e-9);
    let per_barbule = 1.0 / period;
    let distal = family_of(vane.r_bd, period, per_barbule);
    let proximal = family_of(vane.r_bp, period, per_barbule);
    let lift = 0.5 * (distal.radius + proximal.radius);
    let ratio = vane.p_b / vane.d_bl;
    let kappa = max(vane.cos_bl / vane.sin_bl * ratio, 0.01);
    let e_root = wrap(vane.cos_b / vane.sin_b * ratio);
    return VaneShape(vane, 1.0 / vane.p_b, per_barbule, min(vane.r_b, vane.p_b), distal, proximal, lift, kappa, e_root);
}

fn storey(family: Family, hooked: f32, slope: f32) -> Storey {
    let root = sqrt(hooked * hooked + slope * slope);
    return Storey(family, slope, family.ratio * (root + root), root);
}

// Share of light that a storey keeps off a point of the flank, `height` above the axes in radii.
fn storey_blocks(s: Storey, height: f32, hooked: f32) -> f32 {
    let h = clamp(height, -1.0, 1.0);
    let over = hooked * sqrt(1.0 - h * h) + s.root - abs(s.slope) * h;
    return select(min(min(s.family.ratio * over, s.wide), 1.0), 0.0, height >= 1.0);
}

// The same of a flank at which it is cut, mean over its height.
fn storey_on_flank(s: Storey, hooked: f32) -> f32 {
    let off_axis = storey_blocks(s, -0.5, hooked) + storey_blocks(s, 0.5, hooked);
    return (min(s.wide, 1.0) + 2.0 * storey_blocks(s, 0.0, hooked) + 4.0 * off_axis) / 12.0;
}

// The fibres of a vane as one direction sees them; `first` is the storey that it meets first.
struct Storeys {
    slope: f32,
    root: f32,
    per_root: f32,
    silhouette: f32,
    first: Storey,
    second: Storey,
}

// direction: unit, canonical frame of the left vane.
fn storeys(shape: VaneShape, direction: vec3<f32>) -> Storeys {
    let vane = shape.vane;
    let per_facing = 1.0 / max(abs(direction.z), 1e-3);
    let slope = (direction.x * vane.cos_b + direction.y * vane.sin_b) * per_facing;
    let t = (direction.y * vane.cos_b - direction.x * vane.sin_b) * per_facing;
    let along = slope * vane.cos_bl;
    let across = t * vane.sin_bl;
    let distal = storey(shape.distal, vane.hooked, along - across);
    let proximal = storey(shape.proximal, vane.hooked, along + across);
    let square = 1.0 + slope * slope;
    let per_root = inverseSqrt(square);
    let root = square * per_root;
    if direction.z >= 0.0 {
        return Storeys(slope, root, per_root, shape.barb * root, distal, proximal);
    }
    return Storeys(slope, root, per_root, shape.barb * root, proximal, distal);
}

// What barbules hide of the silhouettes of the barbs at which they end: the storey met first, and the other one.
fn barb_hidden(shape: VaneShape, s: Storeys) -> vec2<f32> {
    let slope = abs(s.slope);
    let radius = s.first.family.radius;
    let rest = 2.0 * s.second.family.radius;
    let top = shape.lift + radius;
    let seam = shape.lift - radius;
    let down = shape.barb * slope / (1.0 + s.root);
    // Lengths of the foot's way through the storeys and below them.
    let first = clamp(top + down, 0.0, 2.0 * radius) * slope;
    let second = clamp(seam + down, 0.0, rest) * slope;
    let below = max(seam - rest + down, 0.0) * slope;
    let wide = min(vec2(s.first.wide, s.second.wide), vec2(1.0));
    let hooked = shape.vane.hooked;
    return vec2(
        first * storey_on_flank(s.first, hooked) + (second + below) * wide.x,
        (1.0 - wide.x) * (second * storey_on_flank(s.second, hooked) + below * wide.y),
    );
}

// What a barb shows between its barbules: width of the strip, share of the first storey of what the barbules cover, and of the other
// one of the rest.
fn barb_strip(shape: VaneShape, s: Storeys) -> vec3<f32> {
    let by = barb_hidden(shape, s);
    let wide = min(vec2(s.first.wide, s.second.wide), vec2(1.0));
    let long = 2.0 * s.silhouette;
    let period = shape.vane.p_b;
    let width = min(max(long - by.x - by.y, 0.0), period);
    let free = max(period - long, 0.0);
    let rest = max(free + by.x + by.y, 1e-9);
    let share = min((wide.x * free + by.x) / rest, 1.0);
    let second = (1.0 - wide.x) * wide.y * free + by.y;
    return vec3(width, share, min(second / max(rest * (1.0 - share), 1e-9), 1.0));
}

// Share of what comes along a direction that a vane stops, its families taken to know nothing of each other. What barbules hide of barbs
// they stop themselves.
fn vane_stop(shape: VaneShape, s: Storeys) -> f32 {
    let gap = max(1.0 - 2.0 * s.silhouette * shape.per_barb, 0.0);
    return 1.0 - gap * max(1.0 - s.first.wide, 0.0) * max(1.0 - s.second.wide, 0.0);
}

// The pattern of the left vane seen along `view`: towards the eye, canonical frame (x, y, front normal), any length.
// For the right vane mirror the view (flip x) and the footprint.
fn mask_vane(vane: Vane, view: vec3<f32>) -> Cell {
    let size = length(view);
    let v = select(vec3(0.0, 0.0, 1.0), view / max(size, 1e-12), size > 1e-12);
    let shape = vane_shape(vane);
    let seen = storeys(shape, v);
    return seen_cell(shape, seen, barb_strip(shape, seen), v.z >= 0.0);
}

// The same of what a direction sees; `strip` of barb_strip, `front`: the eye sees the front face.
fn seen_cell(shape: VaneShape, seen: Storeys, strip: vec3<f32>, front: bool) -> Cell {
    // The strip reaches half a silhouette away from the viewer; where it does not reach back to the axis, it is moved there.
    let width = strip.x * shape.per_barb;
    let far = min(min(seen.silhouette * shape.per_barb, 1.0), width);
    let v_low = min(select(far, width - far, seen.slope > 0.0), 1.0);
    let v_high = max(1.0 - select(width - far, far, seen.slope > 0.0), v_low);
    let half_widths = 0.5 * strip.yz;
    let upper = wrap(shape.lift * seen.first.slope * shape.per_barbule);
    let lower = wrap(shape.lift * seen.second.slope * shape.per_barbule);
    if front {
        return Cell(shape.kappa, shape.e_root, v_low, v_high, half_widths.x, half_widths.y, upper, lower, 1.0);
    }
    // From the back proximal lies over distal: the same pattern, u reversed and the families exchanged.
    return Cell(shape.kappa, -shape.e_root, 1.0 - v_high, 1.0 - v_low, half_widths.x, half_widths.y, -upper, -lower, -1.0);
}
