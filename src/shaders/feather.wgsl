// Colour of a feather's fragment: coverage, masking, fibre scattering per light, environment, sheen, transparency.
#import bevy_plumage::{
    feather_bindings::{albedo_sampler, albedo_texture, feather_at, feather_base, rachis_at, settings, sheen_at},
    feather_cover::{Covered, Frame, cover, frame_of},
    feather_data as data,
    feather_debug::debug_color,
    feather_io::{FeatherVertex, class_of},
    feather_lighting as light,
    feather_near::{NearFootprint, near_footprint},
    feather_opacity::{LEAST_OPACITY, leaves_hole, sample_bits},
    feather_shadow::{reached, shadowing_of},
    masking::Vane,
    scattering::{
        FIBRE_ROW_COUNT, FIBRE_ROW_LENGTH, FibreParameters, FibreRow, fibre_energy_split, fibre_evaluate, fibre_local,
        fibre_parameters, fibre_albedo, fibre_row_at, fibre_row_mix, fibre_shading, fibre_terms, light_visibility, mean_visibility,
        multiple_scattering, single_scattering_albedo,
    },
    scattering_near::{fibre_near, fibre_near_evaluate, fibre_window},
    sheen::{sheen_albedo, sheen_evaluate, sheen_place, sheen_tint},
}
#ifdef SAMPLED_ENVIRONMENT
#import bevy_plumage::feather_environment::sampled_environment
#endif
#ifdef OIT_ENABLED
#import bevy_core_pipeline::oit::oit_draw
#endif

const PI: f32 = 3.14159265358979;
// Components in the order of the weights; the rachis is 0.
const BARB: u32 = 1u;
const DISTAL: u32 = 2u;
const PROXIMAL: u32 = 3u;
// Lights fetched at a time.
const BATCH: u32 = 4u;
// A component with less than this share of what is covered is not shaded.
const LEAST_SHARE: f32 = 0.004;
// DebugView::Lobe.
const LOBE_VIEW: u32 = 7u;
// What a fragment adds in the overdraw view: sixteen make white.
const OVERDRAW_STEP: f32 = 0.0625;

// Direction of a component's fibres in the plane of the card, then in the world (the map shears along a curved rachis).
fn fibre_tangent(part: u32, angles: vec4<f32>, right: bool, slope: f32, aspect: f32, frame: Frame) -> vec3<f32> {
    var v = vec2(0.0, 1.0);
    let barb = vec2(-angles.x, angles.y);
    if (part == BARB) { v = barb; }
    // Turned by the barbule angle towards the tip (distal) or the base (proximal).
    if (part == DISTAL) { v = vec2(barb.x * angles.w + barb.y * angles.z, barb.y * angles.w - barb.x * angles.z); }
    if (part == PROXIMAL) { v = vec2(barb.x * angles.w - barb.y * angles.z, barb.y * angles.w + barb.x * angles.z); }
    if (right) { v.x = -v.x; }
    let across = v.x + slope * aspect * v.y;
    return normalize(frame.across * across + frame.along * v.y);
}

// The fibre of one component, its table read at the eye's inclination.
struct Part {
    parameters: FibreParameters,
    row: FibreRow,
    // To the eye, in the fibre's frame.
    eye: vec3<f32>,
}

fn read_part(base: u32, part: u32, tangent: vec3<f32>, frame: Frame) -> Part {
    let slot = base + data::FIBRES + 3u * part;
    let eye = fibre_local(tangent, frame.normal, frame.eye);
    let place = fibre_row_at(sqrt(max(1.0 - eye.x * eye.x, 0.0)));
    let table = u32(feather_at(0u).y) + u32(feather_at(base + data::TABLES)[part]) * FIBRE_ROW_COUNT * FIBRE_ROW_LENGTH;
    let first = table + place.index * FIBRE_ROW_LENGTH;
    var low: array<vec4<f32>, FIBRE_ROW_LENGTH>;
    var high: array<vec4<f32>, FIBRE_ROW_LENGTH>;
    for (var i = 0u; i < FIBRE_ROW_LENGTH; i++) {
        low[i] = feather_at(first + i);
        high[i] = feather_at(first + FIBRE_ROW_LENGTH + i);
    }
    return Part(
        fibre_parameters(feather_at(slot), feather_at(slot + 1u), feather_at(slot + 2u)),
        fibre_row_mix(low, high, place.fraction),
        eye,
    );
}

// Mean and deviation in h of what the pixel sees of a component, deviation -1: its whole width. Barbs and shaft only.
fn near_of(part: u32, near: NearFootprint, angles: vec4<f32>, right: bool, tangent: vec3<f32>, eye: vec3<f32>, frame: Frame) -> vec2<f32> {
    var seen = vec2(0.0, -1.0);
    // The direction in which `near` counts, in the card.
    var along = vec2(1.0, 0.0);
    if (part == 0u) { seen = near.rachis; }
    if (part == BARB) {
        seen = near.barb;
        along = vec2(select(angles.y, -angles.y, right), angles.x);
    }
    // h counts along the azimuth a quarter turn from the eye's.
    let across = cross(frame.normal, tangent);
    let same = dot(frame.across * along.x + frame.along * along.y, across) * eye.z >= 0.0;
    return vec2(select(-seen.x, seen.x, same), seen.y);
}

fn tint_of(bits: u32) -> vec3<f32> {
    let t = vec3(f32(bits & 1023u), f32((bits >> 10u) & 1023u), f32((bits >> 20u) & 1023u)) / 1023.0;
    return t * t;
}

fn albedo_of(in: FeatherVertex, feather: u32, front: bool) -> vec3<f32> {
    let texel = textureSample(albedo_texture, albedo_sampler, in.uv, 2u * feather + select(1u, 0u, front));
    return mix(texel.rgb, tint_of(in.card.y), texel.a);
}

struct FeatherColor {
    @location(0) color: vec4<f32>,
#ifdef SAMPLE_COVERAGE
    @builtin(sample_mask) samples: u32,
#endif
}

@fragment
fn fragment(in: FeatherVertex) -> FeatherColor {
    let feather = data::card_feather(in.card.x);
    let base = feather_base(feather);
    let shape = feather_at(base + data::SHAPE);
    let frame = frame_of(in);
    let front = frame.local_eye.z >= 0.0;
    let albedo = albedo_of(in, feather, front);
    let covered = cover(in, base, shape, frame, class_of(in));
    var out: FeatherColor;
#ifdef DEPTH_DECIDED
    // The depth prepass left the holes out.
    let opacity = max(dot(covered.weights, vec4(1.0)), LEAST_OPACITY);
#else
    let opacity = dot(covered.weights, vec4(1.0));
    if (leaves_hole(in, opacity, shape.x)) {
        discard;
    }
#endif
#ifdef SAMPLE_COVERAGE
    out.samples = sample_bits(in, opacity);
#endif
#ifdef OVERDRAW
    out.color = vec4(vec3(OVERDRAW_STEP), 0.0);
#else
    var color: vec3<f32>;
    if (settings.debug_view != 0u) {
        color = debug_color(settings.debug_view, in, base, shape, covered, frame);
        if (settings.debug_view == LOBE_VIEW) {
            color = lobe_color(in, base, shape, frame, covered, albedo);
        }
    } else {
        color = shade(in, base, shape, frame, covered, albedo) / opacity;
    }
#ifdef BLENDED
    let alpha = opacity;
#else
    let alpha = 1.0;
#endif
    out.color = light::finish(vec4(color, alpha), in.world_position, in.position);
#ifdef OIT_ENABLED
    oit_draw(in.position, out.color);
    discard;
#endif
#endif
    return out;
}

// Light from the fragment towards the eye, times coverage (premultiplied).
fn shade(in: FeatherVertex, base: u32, shape: vec4<f32>, frame: Frame, covered: Covered, albedo: vec3<f32>) -> vec3<f32> {
    let angles = feather_at(base + select(data::LEFT_VANE, data::RIGHT_VANE, covered.right));
    let slope = rachis_at(base, in.uv.y).y;
    let seen = light::fragment_of(in.world_position, frame.normal, in.position, in.instance_index);
    let eye_side = select(-frame.normal, frame.normal, frame.local_eye.z >= 0.0);
    let level = class_of(in);
    // Where a fibre may be wider than the pixel, the place on it matters.
    let resolved = level == data::CARD_NEAR || level == data::CARD_MIXED;
    var near = NearFootprint(vec2(0.0, -1.0), vec2(0.0, -1.0));
    if (resolved) {
        near = near_footprint(base, in.uv.y, covered.footprint, frame.local_eye, covered.right);
    }

    // Of light from all around, on the eye's side and behind.
    let sky = base + data::REACHED + select(2u, 0u, frame.local_eye.z >= 0.0);
    let reached_before = feather_at(sky);
    let reached_behind = feather_at(sky + 1u);
    let shadowing = shadowing_of(base, in.uv.y, covered, frame);

    // Sheen takes its share first.
    let fuzz = feather_at(base + data::SHEEN);
    let opacity = dot(covered.weights, vec4(1.0));
    let sheen = sheen_at(base, sheen_place(abs(frame.local_eye.z)));
    let shares = feather_at(base + data::SHARES);
    let tint = sheen_tint(albedo * shares[DISTAL]);
    let fuzz_albedo = sheen_albedo(sheen, fuzz.x);
    let base_share = 1.0 - fuzz_albedo * max(max(tint.x, tint.y), tint.z);

    // The part of the sky that the feathers above leave open grows towards the tip.
    let open = 1.0 - settings.shelter * (1.0 - smoothstep(0.05, 0.8, in.uv.y));
    let reflected = reflect(-frame.eye, eye_side);
    let around = light::environment(seen, eye_side, reflected, 0.6);
    let behind = light::environment(seen, -eye_side, -frame.eye, 0.8);

    var sum = opacity * fuzz_albedo * tint * around.irradiance * open;
    let lights = light::lights_of(seen);
    var first = 0u;
    // Lights are fetched once (shadows are dear) and then seen by every component, a batch at a time.
    loop {
        var batch: array<light::Light, BATCH>;
        var shadows: array<vec4<f32>, BATCH>;
        let count = min(lights.count - first, BATCH);
        for (var i = 0u; i < count; i++) {
            batch[i] = light::light_at(seen, lights, first + i);
            shadows[i] = reached(shadowing, frame, batch[i].direction);
            sum += opacity * fuzz.x * tint * batch[i].color * sheen_evaluate(sheen, eye_side, frame.eye, batch[i].direction);
        }
        var passed = 0.0;
        for (var part = 0u; part < 4u; part++) {
            let weight = covered.weights[part];
            if (weight <= LEAST_SHARE * opacity) {
                continue;
            }
            let tangent = fibre_tangent(part, angles, covered.right, slope, shape.x, frame);
            let painted = min(albedo * shares[part], vec3(0.98));
            // Light that leaves a fibre meets another one where light from all around would be kept off.
            let meeting = settings.multiple_scattering * (1.0 - 0.5 * (reached_before[part] + reached_behind[part]));
            let single = single_scattering_albedo(painted, meeting);
            let fibre = read_part(base, part, tangent, frame);
            var harmonics = 4u;
            if (level != data::CARD_MEAN) {
                harmonics = fibre_terms(settings.threshold, fibre.parameters.azimuthal_roughness);
            }
            let shading = fibre_shading(fibre.parameters, fibre.row, single, fibre.eye, shape.w, harmonics);
            let again = multiple_scattering(fibre_albedo(shading), meeting);
            let crowding = coverage_along_normal(shadowing.vane, part);
            // Spread evenly over the sphere.
            let spread = again / (PI * PI * mean_visibility(crowding));
            let place = near_of(part, near, angles, covered.right, tangent, fibre.eye, frame);
            var radiance = vec3(0.0);
            if (resolved && place.y > 0.0) {
                let window = fibre_window(place.x, place.y);
                let part_seen = fibre_near(fibre.parameters, fibre.row, single, fibre.eye, shape.w, 8u, window);
                for (var i = 0u; i < count; i++) {
                    let local = fibre_local(tangent, frame.normal, batch[i].direction);
                    radiance += batch[i].color * lit(fibre_near_evaluate(part_seen, local), shadows[i][part], spread, local, crowding);
                }
            } else {
                for (var i = 0u; i < count; i++) {
                    let local = fibre_local(tangent, frame.normal, batch[i].direction);
                    radiance += batch[i].color * lit(fibre_evaluate(shading, local), shadows[i][part], spread, local, crowding);
                }
            }
            if (first == 0u) {
#ifdef SAMPLED_ENVIRONMENT
                let indirect = sampled_environment(
                    seen, shading, tangent, frame, shadowing, part,
                    passed / opacity, (passed + weight) / opacity, settings.environment_samples,
                );
#else
                let energy = fibre_energy_split(shading);
                let indirect = (around.radiance * energy.specular + around.irradiance * energy.front) * reached_before[part]
                    + behind.irradiance * energy.back * reached_behind[part];
#endif
                let everywhere = 0.5 * (around.irradiance + behind.irradiance);
                radiance += (indirect + again * everywhere) * open;
                passed += weight;
            }
            sum += weight * base_share * radiance;
        }
        first += BATCH;
        if (first >= lights.count) {
            break;
        }
    }
    return max(sum, vec3(0.0)) * light::exposure();
}

// Where the energy of the fibres goes: surface reflection red, back to the eye's side green, through the feather blue.
fn lobe_color(in: FeatherVertex, base: u32, shape: vec4<f32>, frame: Frame, covered: Covered, albedo: vec3<f32>) -> vec3<f32> {
    let angles = feather_at(base + select(data::LEFT_VANE, data::RIGHT_VANE, covered.right));
    let slope = rachis_at(base, in.uv.y).y;
    let shares = feather_at(base + data::SHARES);
    var sum = vec3(0.0);
    for (var part = 0u; part < 4u; part++) {
        let weight = covered.weights[part];
        if (weight <= LEAST_SHARE * dot(covered.weights, vec4(1.0))) {
            continue;
        }
        let tangent = fibre_tangent(part, angles, covered.right, slope, shape.x, frame);
        let painted = min(albedo * shares[part], vec3(0.98));
        let fibre = read_part(base, part, tangent, frame);
        let energy = fibre_energy_split(fibre_shading(fibre.parameters, fibre.row, painted, fibre.eye, shape.w, 3u));
        sum += weight * vec3(3.0 * energy.specular, dot(energy.front, vec3(1.0)), dot(energy.back, vec3(1.0)));
    }
    return sum / max(max(sum.x, sum.y), max(sum.z, 1e-6));
}

// Width over period of a family of fibres, seen along the normal.
fn coverage_along_normal(vane: Vane, part: u32) -> f32 {
    let period = max(vane.d_bl * vane.sin_bl, 1e-9);
    switch part {
        case BARB: { return min(2.0 * vane.r_b / vane.p_b, 1.0); }
        case DISTAL: { return min(2.0 * vane.r_bd / period, 1.0); }
        case PROXIMAL: { return min(2.0 * vane.r_bp / period, 1.0); }
        default: { return 1.0; }
    }
}

// K of one component for one light of which `share` reaches it, and light that has met other fibres before (`spread`, per
// steradian), which follows what the component's own array receives. `local`: to the light, in the fibre's frame.
fn lit(k: vec3<f32>, share: f32, spread: vec3<f32>, local: vec3<f32>, coverage: f32) -> vec3<f32> {
    let cos_theta = sqrt(max(1.0 - local.x * local.x, 1e-6));
    return share * k + spread * cos_theta * light_visibility(local.z, coverage, cos_theta);
}
