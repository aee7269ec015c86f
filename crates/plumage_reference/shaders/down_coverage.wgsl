#define_import_path bevy_plumage::down_coverage

// How much of a pixel a disc covers. Twin of src/maths/undercoat/coverage.rs, where the comments are.

const PI: f32 = 3.14159265358979;

// Area of the disc beyond a line.
fn disc_segment(r: f32, line: f32) -> f32 {
    let d = clamp(line, 0.0, r);
    let h = sqrt(max((r - d) * (r + d), 0.0));
    return r * r * atan2(h, d) - d * h;
}

// Area of the disc of radius `r` at the origin beyond x > left and y > low.
fn disc_quadrant(r: f32, left: f32, low: f32) -> f32 {
    if left >= r || low >= r || r <= 0.0 {
        return 0.0;
    }
    let a = max(left, -r);
    let b = max(low, -r);
    if a * a + b * b < r * r {
        let xa = sqrt(max(r * r - b * b, 0.0));
        let ya = sqrt(max(r * r - a * a, 0.0));
        let t = atan2(ya, a) - atan2(b, xa);
        return 0.5 * ((xa - a) * (ya - b) + r * r * (t - sin(t)));
    }
    if a >= 0.0 && b >= 0.0 {
        return 0.0;
    }
    if a >= 0.0 {
        return disc_segment(r, a);
    }
    if b >= 0.0 {
        return disc_segment(r, b);
    }
    return PI * r * r - disc_segment(r, -a) - disc_segment(r, -b);
}

// Area of the disc of radius `r` around `centre` inside the pixel 0..1 x 0..1.
fn disc_coverage(r: f32, centre: vec2<f32>) -> f32 {
    let low = -centre;
    let high = 1.0 - centre;
    let area = disc_quadrant(r, low.x, low.y) - disc_quadrant(r, high.x, low.y) - disc_quadrant(r, low.x, high.y)
        + disc_quadrant(r, high.x, high.y);
    return clamp(area, 0.0, 1.0);
}

// Share of a unit disc's area left of `x`.
fn disc_share(x: f32) -> f32 {
    let u = clamp(x, -1.0, 1.0);
    let root = sqrt(max(1.0 - u * u, 0.0));
    return 0.5 + (u * root + atan2(u, root)) / PI;
}

// The same as a product of two integrals.
fn disc_coverage_separable(r: f32, centre: vec2<f32>) -> f32 {
    if r <= 0.0 {
        return 0.0;
    }
    let high = (1.0 - centre) / r;
    let low = -centre / r;
    let x = disc_share(high.x) - disc_share(low.x);
    let y = disc_share(high.y) - disc_share(low.y);
    return clamp(PI * r * r * x * y, 0.0, 1.0);
}
