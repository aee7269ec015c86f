// Sheen of dense barbules: the linearly transformed cosine of Zeltner et al. 2022; twin of src/maths/scattering/sheen.rs.
//
// `ltc` is (aInv, bInv, R) of the table at the eye's cosine and the sheen's roughness; interpolate between the 32 entries of
// a `sheen_row`, entry k at cos theta_o = k/31.
#define_import_path bevy_plumage::sheen

const SHEEN_PI: f32 = 3.14159265358979;

// Lower entry (0..30) of a sheen row in x and the fraction towards the next in y.
fn sheen_place(cos_o: f32) -> vec2<f32> {
    let x = clamp(cos_o, 0.0, 1.0) * 31.0;
    let i = min(floor(x), 30.0);
    return vec2<f32>(i, x - i);
}

// Sheen BRDF times cos(theta_i) for strength 1, per steradian; `normal` on the eye's side. 0 on the other side.
fn sheen_evaluate(ltc: vec3<f32>, normal: vec3<f32>, omega_o: vec3<f32>, omega_i: vec3<f32>) -> f32 {
    let a = ltc.x;
    let cos_o = dot(normal, omega_o);
    let z = dot(normal, omega_i);
    if !(cos_o > 0.0 && z > 0.0 && a >= 1e-4 && ltc.z >= 1e-5) {
        return 0.0;
    }
    let flat_o = omega_o - normal * cos_o;
    let size = sqrt(dot(flat_o, flat_o));
    let x = select(0.0, dot(flat_o, omega_i) / max(size, 1e-6), size > 1e-6);
    let across = max(1.0 - x * x - z * z, 0.0);
    let u = a * x + ltc.y * z;
    let q = u * u + a * a * across + z * z;
    return ltc.z * z * a * a / max(SHEEN_PI * q * q, 1e-12);
}

// Share of light that the sheen takes from the layer under it, 0..1.
fn sheen_albedo(ltc: vec3<f32>, strength: f32) -> f32 {
    return clamp(clamp(strength, 0.0, 1.0) * ltc.z, 0.0, 1.0);
}

// Color of the fibres that make the sheen: a colorless surface reflection, the rest has the feather's color.
fn sheen_tint(albedo: vec3<f32>) -> vec3<f32> {
    return 0.157 + 0.843 * clamp(albedo, vec3<f32>(0.0), vec3<f32>(1.0));
}
