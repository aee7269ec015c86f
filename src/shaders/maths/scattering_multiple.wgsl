// Light that meets further fibres, and what color a fibre has among its neighbors. Twin of src/maths/scattering/color.rs; the derivation is
// in docs/book/light_between_fibres.md#multiple-scattering.
#define_import_path bevy_plumage::scattering_multiple

// Albedo one fibre must have for plumage to show `albedo`, when scattered light meets another fibre with chance `meeting`.
fn single_scattering_albedo(albedo: vec3<f32>, meeting: f32) -> vec3<f32> {
    return vec3(inner_albedo(albedo.x, meeting), inner_albedo(albedo.y, meeting), inner_albedo(albedo.z, meeting));
}

// The same of one channel.
fn inner_albedo(albedo: f32, meeting: f32) -> f32 {
    let p = clamp(meeting, 0.0, 0.99);
    let shown = clamp(albedo, 0.0, 1.0);
    let b = 1.0 - p + shown * (0.5 * p + 0.25);
    return 2.0 * shown / (b + sqrt(max(b * b + (2.0 * p - 1.0) * shown, 0.0)));
}

// Of the meetings with further fibres, the share with parallel ones, where a fibre mirrors.
const PARALLEL_MEETINGS: f32 = 0.25;

// Light that met further fibres.
struct MultipleScattering {
    // Energy that has lost its direction.
    spread: vec3<f32>,
    // Factor on the light that met one fibre: what met parallel fibres alone goes where that goes.
    cone: vec3<f32>,
}

// `spread` and `cone` times the direct light, (1 - meeting) albedo, are together what a row of fibres sends back.
fn multiple_scattering(albedo: vec3<f32>, meeting: vec3<f32>, parallel: f32) -> MultipleScattering {
    let a = clamp(albedo, vec3<f32>(0.0), vec3<f32>(1.0));
    let lost = clamp(meeting, vec3<f32>(0.0), vec3<f32>(0.99)) * a;
    let cone = 1.0 / (1.0 - parallel * lost);
    let later = 0.5 * lost + 0.25 * a;
    return MultipleScattering(lost * (a - later) / (1.0 - later) - (a - lost) * (cone - 1.0), cone);
}
