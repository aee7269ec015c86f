#define_import_path bevy_plumage::footprint

// What one pixel sees of the canonical plane. Twin of src/maths/footprint.rs.

// Smallest variance of a footprint, feather lengths squared.
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
