// Colour of a feather's fragment: coverage, masking, fibre scattering per light, environment, sheen, transparency.
#import bevy_plumage::{
    anatomy::{barb_root, barbule_factor, canonical_footprint, hooked, vane_start_coverage},
    feather_bindings::{albedo_sampler, albedo_texture, contour_at, feather_at, feather_base, rachis_at, settings, sheen_at},
    feather_data as data,
    feather_io::FeatherVertex,
    feather_lighting as light,
    feather_pattern::{hash, pattern_threshold},
    masking::{mask_rachis, mask_vane},
    query::{Footprint, mirrored, reduce, vane_coverage, widened},
    query_split::{averages, line_part, line_share, outline_line, outline_node, outline_root, outline_sight,
        rachis_line, rachis_share, split_line},
    scattering::{
        FIBRE_ROW_COUNT, FIBRE_ROW_LENGTH, FibreShading, fibre_energy_split, fibre_evaluate, fibre_local, fibre_parameters,
        fibre_albedo, fibre_row_at, fibre_row_mix, fibre_shading, light_visibility, multiple_scattering,
        single_scattering_albedo,
    },
    sheen::{sheen_albedo, sheen_evaluate, sheen_place},
}
#ifdef PUBLISHED_COVERAGE
#import bevy_plumage::query_published::{PUBLISHED_SWITCH, PublishedMethod, published_vane_coverage}
#endif
#ifdef SUPERSAMPLED_COVERAGE
#import bevy_plumage::query_published::{PUBLISHED_POINTS, PublishedMethod, published_vane_coverage}
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
#ifdef SUPERSAMPLED_COVERAGE
// Point queries per footprint.
const SUPERSAMPLES: u32 = 1024u;
#endif
// A component with less coverage than this is not shaded.
const LEAST_WEIGHT: f32 = 0.004;

// The card's frame in the world and the eye in it.
struct Frame {
    // Along u, along the rachis, out of the front face.
    across: vec3<f32>,
    along: vec3<f32>,
    normal: vec3<f32>,
    // To the eye, in the world and in this frame.
    eye: vec3<f32>,
    local_eye: vec3<f32>,
}

fn frame_of(in: FeatherVertex) -> Frame {
    var frame: Frame;
    frame.normal = normalize(in.world_normal);
    let tangent = in.world_tangent.xyz - frame.normal * dot(frame.normal, in.world_tangent.xyz);
    frame.along = tangent * inverseSqrt(max(dot(tangent, tangent), 1e-12));
    frame.across = cross(frame.normal, frame.along) * select(-1.0, 1.0, in.world_tangent.w > 0.0);
    frame.eye = light::to_eye(in.world_position);
    frame.local_eye = vec3(dot(frame.eye, frame.across), dot(frame.eye, frame.along), dot(frame.eye, frame.normal));
    return frame;
}

// Coverage of the footprint by rachis, barbs, distal and proximal barbules, and the vane that has most of it.
struct Covered {
    weights: vec4<f32>,
    right: bool,
}

// One vane's share of a footprint (over the left vane, or mirrored there) beside the rachis, whose edge is at x = edge.
fn cover_vane(base: u32, right: bool, footprint: Footprint, edge: f32, frame: Frame, shape: vec4<f32>, level: u32) -> vec3<f32> {
    let rachis = rachis_line(edge);
    let beside = line_share(rachis, footprint);
    if (beside < 1e-3) {
        return vec3(0.0);
    }
    let slot = base + select(data::LEFT_VANE, data::RIGHT_VANE, right);
    let angles = feather_at(slot);
    let last = feather_at(slot + 2u);
    let vane = data::vane_unpack(angles, feather_at(slot + 1u), last);
    // Angle of the barbs in radians.
    let angle = last.w;
    let root = barb_root(footprint.mean, angle);
    let contour = contour_at(base, shape.z, root);
    let reach = select(contour.xz, contour.yw, right);
    let outline = outline_line(footprint.mean, reach, angle);
    let straight = line_share(outline, footprint);
    // The outline may turn within the footprint.
    let cotangent = cos(angle) / max(sin(angle), 1e-3);
    let sight = outline_sight(footprint, cotangent, (1.0 - shape.z) / f32(data::CONTOUR_SAMPLES - 1u));
    var nodes = vec2(0.0);
    for (var i = 0u; i < sight.count; i++) {
        let there = contour_at(base, shape.z, outline_root(sight, i));
        nodes += outline_node(sight, i, select(there.xz, there.yw, right));
    }
    let inside = nodes.y / max(nodes.x, 1e-9);
    let mean = vec2(min(footprint.mean.x, -1e-6), footprint.mean.y);
    let begun = vane_start_coverage(mean, footprint.covariance, shape.z, angle);
    if (inside * begun < 1e-3) {
        return vec3(0.0);
    }
    // The right vane is the left one mirrored.
    let cell = mask_vane(vane, frame.local_eye * vec3(select(1.0, -1.0, right), 1.0, 1.0));
    let hook = barbule_factor(hooked(abs(footprint.mean.x), footprint.mean.y, reach.x, last.y, last.z));
    // Whichever of rachis and outline takes more of the footprint cuts it into parts, the other one scales them. Where the tangent
    // tells too little of the outline, the outline scales the whole.
    let scale = inside / max(straight, 1e-6);
    let is_line = scale <= 2.0 && scale >= 0.5;
    var first = rachis;
    var second = outline;
    if (is_line && straight < beside) {
        first = outline;
        second = rachis;
    }
#ifdef PUBLISHED_COVERAGE
    let resolved = false;
#else
    let resolved = level != data::CARD_MEAN && !averages(reduce(cell, vane, footprint), settings.threshold);
#endif
    let cut = split_line(footprint, first, resolved);
    var covered = vec3(0.0);
    for (var i = 0u; i < cut.parts; i++) {
        let part = line_part(cut, i);
        var mass = part.mass * inside;
        if (is_line) {
            mass = part.mass * scale * line_share(second, part.footprint);
        }
        if (abs(mass) < 5e-4) {
            continue;
        }
#ifdef PUBLISHED_COVERAGE
        // Whatever the LOD pass says of the card: sixteen nodes near, orders 1 and 2 far.
        let method = PublishedMethod(PUBLISHED_SWITCH, 1u, 16u, 1, 2);
        covered += mass * published_vane_coverage(cell, vane, part.footprint, method);
#else ifdef SUPERSAMPLED_COVERAGE
        let method = PublishedMethod(PUBLISHED_POINTS, SUPERSAMPLES, 16u, 1, 2);
        covered += mass * published_vane_coverage(cell, vane, part.footprint, method);
#else
        // What the LOD pass promised of whole footprints does not hold for their parts.
        let part_level = select(level, data::CARD_MIXED, cut.parts > 1u);
        covered += mass * vane_coverage(cell, vane, part.footprint, part_level, settings.threshold);
#endif
    }
    covered = max(covered, vec3(0.0)) * begun;
    return vec3(covered.x, covered.yz * hook);
}

fn cover(in: FeatherVertex, base: u32, shape: vec4<f32>, frame: Frame, level: u32) -> Covered {
    let rachis = rachis_at(base, in.uv.y);
    let canonical = canonical_footprint(in.uv, dpdx(in.uv), dpdy(in.uv), rachis.x, rachis.y, shape.x);
    let footprint = widened(Footprint(canonical.mean, canonical.cov)).footprint;
    let edges = mask_rachis(rachis.z, frame.local_eye);
    var covered: Covered;
    covered.right = footprint.mean.x > 0.5 * (edges.x + edges.y);
    // The shaft ends where the card does.
    covered.weights.x = rachis_share(footprint, edges) * smoothstep(1.0, 0.99, in.uv.y);
    let vanes = cover_vane(base, false, footprint, edges.x, frame, shape, level)
        + cover_vane(base, true, mirrored(footprint), -edges.y, frame, shape, level);
    covered.weights = vec4(covered.weights.x, vanes);
    let total = dot(covered.weights, vec4(1.0));
    covered.weights = max(covered.weights, vec4(0.0)) / max(total, 1.0);
    return covered;
}

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

// The fibre of one component as this pixel's eye sees it.
fn shade_part(base: u32, part: u32, tangent: vec3<f32>, frame: Frame, albedo: vec3<f32>, dark_back: f32, harmonics: u32) -> FibreShading {
    let slot = base + data::FIBRES + 3u * part;
    let parameters = fibre_parameters(feather_at(slot), feather_at(slot + 1u), feather_at(slot + 2u));
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
    return fibre_shading(parameters, fibre_row_mix(low, high, place.fraction), albedo, eye, dark_back, harmonics);
}

fn tint_of(bits: u32) -> vec3<f32> {
    let t = vec3(f32(bits & 1023u), f32((bits >> 10u) & 1023u), f32((bits >> 20u) & 1023u)) / 1023.0;
    return t * t;
}

fn albedo_of(in: FeatherVertex, feather: u32, front: bool) -> vec3<f32> {
    let texel = textureSample(albedo_texture, albedo_sampler, in.uv, 2u * feather + select(1u, 0u, front));
    return mix(texel.rgb, tint_of(in.card.y), texel.a);
}

fn debug_color(in: FeatherVertex, covered: Covered, frame: Frame) -> vec3<f32> {
    switch settings.debug_view {
        case 1u: { return vec3(covered.weights.x + covered.weights.y, covered.weights.z, covered.weights.w); }
        case 2u: {
            let level = in.card.w & 7u;
            return select(
                vec3(f32(level == data::CARD_NEAR), f32(level == data::CARD_FAR), f32(level == data::CARD_MEAN)),
                vec3(1.0),
                level == data::CARD_MIXED,
            );
        }
        case 3u: {
            let h = hash(in.card.w >> 3u);
            return vec3(f32(h & 255u), f32((h >> 8u) & 255u), f32((h >> 16u) & 255u)) / 255.0;
        }
        case 4u: { return vec3(data::card_layer(in.card.x)); }
        default: { return frame.normal * 0.5 + 0.5; }
    }
}

@fragment
fn fragment(in: FeatherVertex) -> @location(0) vec4<f32> {
    let feather = data::card_feather(in.card.x);
    let base = feather_base(feather);
    let shape = feather_at(base + data::SHAPE);
    let frame = frame_of(in);
    let front = frame.local_eye.z >= 0.0;
    let albedo = albedo_of(in, feather, front);
    let covered = cover(in, base, shape, frame, in.card.w & 7u);
    let opacity = dot(covered.weights, vec4(1.0));
    if (opacity < 1.0 / 255.0) {
        discard;
    }
    var color: vec3<f32>;
    if (settings.debug_view != 0u) {
        color = debug_color(in, covered, frame);
    } else {
        color = shade(in, base, shape, frame, covered, albedo) / opacity;
    }
    var alpha = opacity;
#ifdef ALPHA_TO_COVERAGE
    if (settings.dither != 0u) {
        // Four samples make five steps of alpha; the pattern spreads the rounding, so that the mean is right.
        alpha = clamp(alpha + (pattern_threshold(in.position.xy, in.card.w >> 3u) - 0.5) * 0.25, 0.0, 1.0);
    }
#endif
    let out = light::finish(vec4(color, alpha), in.world_position, in.position);
#ifdef OIT_ENABLED
    oit_draw(in.position, out);
    discard;
#endif
    return out;
}

// Light from the fragment towards the eye, times coverage (premultiplied).
fn shade(in: FeatherVertex, base: u32, shape: vec4<f32>, frame: Frame, covered: Covered, albedo: vec3<f32>) -> vec3<f32> {
    let angles = feather_at(base + select(data::LEFT_VANE, data::RIGHT_VANE, covered.right));
    let slope = rachis_at(base, in.uv.y).y;
    let seen = light::fragment_of(in.world_position, frame.normal, in.position, in.instance_index);
    let eye_side = select(-frame.normal, frame.normal, frame.local_eye.z >= 0.0);

    // Sheen takes its share first.
    let fuzz = feather_at(base + data::SHEEN);
    let opacity = dot(covered.weights, vec4(1.0));
    let sheen = sheen_at(base, sheen_place(abs(frame.local_eye.z)));
    let fuzz_albedo = sheen_albedo(sheen, fuzz.x);
    let shares = feather_at(base + data::SHARES);
    let harmonics = select(8u, 3u, (in.card.w & 7u) == data::CARD_MEAN);

    // The part of the sky that the feathers above leave open grows towards the tip.
    let open = 1.0 - settings.shelter * (1.0 - smoothstep(0.05, 0.8, in.uv.y));
    let reflected = reflect(-frame.eye, eye_side);
    let around = light::environment(seen, eye_side, reflected, 0.6);
    let behind = light::environment(seen, -eye_side, -frame.eye, 0.8);

    var sum = opacity * fuzz_albedo * around.irradiance * open;
    let lights = light::lights_of(seen);
    var first = 0u;
    // Lights are fetched once (shadows are dear) and then seen by every component, a batch at a time.
    loop {
        var batch: array<light::Light, BATCH>;
        let count = min(lights.count - first, BATCH);
        for (var i = 0u; i < count; i++) {
            batch[i] = light::light_at(seen, lights, first + i);
            sum += opacity * fuzz.x * batch[i].color * sheen_evaluate(sheen, eye_side, frame.eye, batch[i].direction);
        }
        for (var part = 0u; part < 4u; part++) {
            let weight = covered.weights[part];
            if (weight < LEAST_WEIGHT) {
                continue;
            }
            let tangent = fibre_tangent(part, angles, covered.right, slope, shape.x, frame);
            let painted = min(albedo * shares[part], vec3(0.98));
            let single = single_scattering_albedo(painted, settings.multiple_scattering);
            let shading = shade_part(base, part, tangent, frame, single, shape.w, harmonics);
            let again = multiple_scattering(fibre_albedo(shading), settings.multiple_scattering);
            let crowding = coverage_along_normal(base, part, covered.right);
            var radiance = vec3(0.0);
            for (var i = 0u; i < count; i++) {
                radiance += batch[i].color * lit(shading, again, tangent, frame, batch[i].direction, crowding);
            }
            if (first == 0u) {
                let energy = fibre_energy_split(shading);
                let indirect = around.radiance * energy.specular + around.irradiance * energy.front + behind.irradiance * energy.back;
                let everywhere = 0.5 * (around.irradiance + behind.irradiance);
                radiance += ((1.0 - settings.multiple_scattering) * indirect + again * everywhere) * open;
            }
            sum += weight * (1.0 - fuzz_albedo) * radiance;
        }
        first += BATCH;
        if (first >= lights.count) {
            break;
        }
    }
    return max(sum, vec3(0.0)) * light::exposure();
}

// Width over period of a family of fibres, seen along the normal.
fn coverage_along_normal(base: u32, part: u32, right: bool) -> f32 {
    let slot = base + select(data::LEFT_VANE, data::RIGHT_VANE, right);
    let vane = data::vane_unpack(feather_at(slot), feather_at(slot + 1u), feather_at(slot + 2u));
    let period = max(vane.d_bl * vane.sin_bl, 1e-9);
    switch part {
        case BARB: { return min(2.0 * vane.r_b / vane.p_b, 1.0); }
        case DISTAL: { return min(2.0 * vane.r_bd / period, 1.0); }
        case PROXIMAL: { return min(2.0 * vane.r_bp / period, 1.0); }
        default: { return 1.0; }
    }
}

// K of one component for one light, with the light's own view of the fibres (self-shadowing between neighbours).
// `again`: energy of light that has met other fibres before, spread evenly.
fn lit(shading: FibreShading, again: vec3<f32>, tangent: vec3<f32>, frame: Frame, direction: vec3<f32>, coverage: f32) -> vec3<f32> {
    let local = fibre_local(tangent, frame.normal, direction);
    let cos_theta = sqrt(max(1.0 - local.x * local.x, 1e-6));
    let scattered = (1.0 - settings.multiple_scattering) * fibre_evaluate(shading, local) + again * cos_theta / (PI * PI);
    return scattered * light_visibility(abs(dot(direction, frame.normal)), coverage, cos_theta);
}
