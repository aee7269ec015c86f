// Color of a feather's fragment: coverage, masking, fibre scattering per light, environment, sheen, transparency.
#import bevy_plumage::{
    feather_bindings::{albedo_sampler, albedo_texture, feather_at, feather_base, rachis_at, settings, sheen_at},
    feather_cover::{Covered, Frame, cover, frame_of},
    feather_data as data,
    feather_fibre::{BARB, DISTAL, fibre_tangent, in_fibre, shown_parts},
    feather_io::{FeatherVertex, class_of},
    feather_lighting as light,
    feather_near::{NearFootprint, near_footprint},
    feather_opacity::{LEAST_OPACITY, is_left_out, leaves_hole, moved_by, sample_bits},
    feather_shadow::{Reaches, caught_light, kept_light, kept_place, light_ray, reach_of, reaches_of, shadowing_of},
    scattering::{
        FIBRE_PARAMETER_LENGTH, FIBRE_ROW_COUNT, FIBRE_ROW_LENGTH, FibreParameters, FibreReach, FibreRow, fibre_along, fibre_lit, fibre_lobes,
        fibre_parameters, fibre_row_at, fibre_row_mix, fibre_shading, fibre_terms,
    },
    scattering_multiple::{PARALLEL_MEETINGS, inner_albedo, multiple_scattering, single_scattering_albedo},
    scattering_near::{fibre_near, fibre_near_lobes, fibre_window},
    sheen::{sheen_albedo, sheen_evaluate, sheen_place, sheen_tint},
}
#ifdef PLAIN_FIBRES
#import bevy_plumage::scattering_short as short
#import bevy_plumage::feather_fibre::{keeping_of, kept_of, short_part}
#endif
#ifdef LIT_VERTICES
#import bevy_plumage::feather_vertex_light::{answer, light_response, paint_over, response_of}
#endif
#ifdef DEBUG_VIEW
#import bevy_plumage::feather_debug::{VIEW_LOBE, debug_color}
#import bevy_plumage::scattering::fibre_energy_split
#endif
#ifdef IRIDESCENT
#import bevy_plumage::feather_iridescence::{
    ONE_LOOK, Shimmer, shimmer_entering, shimmer_let_in, shimmer_lobe, shimmer_mirror, shimmer_of, shimmer_reflected,
    shimmer_roughness, shimmer_row,
}
#endif
#ifdef SAMPLED_ENVIRONMENT
#import bevy_plumage::feather_environment::sampled_environment
#import bevy_plumage::feather_shadow::part_eye
#endif
#ifdef OIT_ENABLED
#import bevy_core_pipeline::oit::oit_draw
#endif

// Lights fetched at a time: each is held in registers while the fibres are looked at.
#ifdef LIGHTS_TOGETHER
const BATCH: u32 = 4u;
#else
const BATCH: u32 = 1u;
#endif
// A component with less than this share of what is covered is not shaded.
const LEAST_SHARE: f32 = 0.004;
#ifdef ORDER_WINDOW
// Opacity that prepass and color pass may differ by.
const ROUNDING: f32 = 1e-4;
#else
const ROUNDING: f32 = 0.0;
#endif
// What a fragment adds in the overdraw view: sixteen make white.
const OVERDRAW_STEP: f32 = 0.0625;

// A light as the fibres of a fragment see it.
struct Arriving {
    color: vec3<f32>,
    // In the frame of the card.
    direction: vec3<f32>,
    // How much the vane catches of it.
    caught: f32,
    reaches: Reaches,
}

// The fibre of one component, its table read at the eye's inclination.
struct Part {
    parameters: FibreParameters,
    row: FibreRow,
    // To the eye, in the fibre's frame.
    eye: vec3<f32>,
}

fn read_part(base: u32, part: u32, index: f32, tangent: vec2<f32>, frame: Frame) -> Part {
    let slot = base + data::FIBRES + FIBRE_PARAMETER_LENGTH * part;
    var packed: array<vec4<f32>, FIBRE_PARAMETER_LENGTH>;
    for (var i = 0u; i < FIBRE_PARAMETER_LENGTH; i++) {
        packed[i] = feather_at(slot + i);
    }
    let eye = in_fibre(tangent, frame.hand, frame.local_eye);
    let place = fibre_row_at(sqrt(max(1.0 - eye.x * eye.x, 0.0)));
    let table = u32(feather_at(0u).y) + u32(index) * FIBRE_ROW_COUNT * FIBRE_ROW_LENGTH;
    let first = table + place.index * FIBRE_ROW_LENGTH;
    var low: array<vec4<f32>, FIBRE_ROW_LENGTH>;
    var high: array<vec4<f32>, FIBRE_ROW_LENGTH>;
    for (var i = 0u; i < FIBRE_ROW_LENGTH; i++) {
        low[i] = feather_at(first + i);
        high[i] = feather_at(first + FIBRE_ROW_LENGTH + i);
    }
    return Part(
        fibre_parameters(packed),
        fibre_row_mix(low, high, place.fraction),
        eye,
    );
}

#ifdef IRIDESCENT
// The prefiltered map where one family's sides mirror the eye; `eye`: in the fibre's frame.
fn family_light(seen: light::Fragment, side: vec3<f32>, frame: Frame, tangent: vec2<f32>, shimmer: Shimmer, eye: vec3<f32>) -> vec3<f32> {
    let m = shimmer_reflected(shimmer, eye);
    let local = vec3(m.x * tangent + m.y * frame.hand * vec2(tangent.y, -tangent.x), m.z);
    let there = local.x * frame.across + local.y * frame.along + local.z * frame.normal;
    return light::environment(seen, side, there, shimmer_roughness(shimmer.facets.flatness, shimmer.facets.slope)).radiance;
}
#endif

// Mean and deviation in h of what the pixel sees of a component, deviation -1: its whole width. Barbs and shaft only.
fn near_of(part: u32, near: NearFootprint, angles: vec4<f32>, right: bool, tangent: vec2<f32>, eye: vec3<f32>, hand: f32) -> vec2<f32> {
    var seen = vec2(0.0, -1.0);
    // The direction in which `near` counts, in the card.
    var along = vec2(1.0, 0.0);
    if (part == 0u) { seen = near.rachis; }
    if (part == BARB) {
        seen = near.barb;
        along = vec2(select(angles.y, -angles.y, right), angles.x);
    }
    // h counts along the azimuth a quarter turn from the eye's.
    let same = hand * (along.x * tangent.y - along.y * tangent.x) * eye.z >= 0.0;
    return vec2(select(-seen.x, seen.x, same), seen.y);
}

fn albedo_of(in: FeatherVertex, feather: u32, front: bool) -> vec3<f32> {
    let texel = textureSample(albedo_texture, albedo_sampler, in.uv, 2u * feather + select(1u, 0u, front));
    return mix(texel.rgb, data::card_tint(in.card.y), texel.a);
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
    let moved = moved_by(data::card_index(in.card.w));
#ifdef ONLY_MEAN
    if (is_left_out(in, moved)) {
        discard;
    }
#endif
#ifdef DEPTH_DECIDED
    // The depth prepass left the holes out.
    let opacity = max(dot(covered.weights, vec4(1.0)), LEAST_OPACITY);
#else
    let opacity = dot(covered.weights, vec4(1.0));
    // Where the prepass has put the fragment it must be: another compiler's rounding may not lose it.
    let asked = opacity + ROUNDING;
    if (leaves_hole(in, asked, shape.x, moved)) {
        discard;
    }
#endif
#ifdef SAMPLE_COVERAGE
    out.samples = sample_bits(in, asked, moved);
#endif
#ifdef OVERDRAW
    out.color = vec4(vec3(OVERDRAW_STEP), 0.0);
#else
#ifdef DEBUG_VIEW
    var color = debug_color(settings.debug_view, in, base, shape, covered, frame);
    if (settings.debug_view == VIEW_LOBE) {
        color = lobe_color(in, base, shape, frame, covered, albedo);
    }
#else
    let color = shade(in, base, shape, frame, covered, albedo, opacity);
#endif
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

// The part of the sky that the feathers above leave open at a height of the card: it grows towards the tip.
fn open_sky(v: f32) -> f32 { return 1.0 - settings.shelter * (1.0 - smoothstep(0.05, 0.8, v)); }

#ifdef LIT_VERTICES
// Light from the fragment towards the eye: what its card makes of light is known from its vertices.
fn shade(
    in: FeatherVertex,
    base: u32,
    shape: vec4<f32>,
    frame: Frame,
    covered: Covered,
    albedo: vec3<f32>,
    opacity: f32,
) -> vec3<f32> {
    let seen = light::fragment_of(in.world_position, frame.normal, in.position, in.instance_index);
    let eye_side = select(-frame.normal, frame.normal, frame.local_eye.z >= 0.0);
    let around = light::environment(seen, eye_side, reflect(-frame.eye, eye_side), 0.6);
    let behind = light::environment(seen, -eye_side, -frame.eye, 0.8);
    let response = response_of(in, covered.right, covered.weights.x / opacity);
    let paint = paint_over(base, albedo, frame.local_eye.z >= 0.0);
    var sum = open_sky(in.uv.y) * (around.radiance * response.sky + around.irradiance * answer(response.front, paint)
        + behind.irradiance * answer(response.back, paint));
    let lights = light::lights_of(seen);
    for (var i = 0u; i < lights.count; i++) {
        let found = light::light_at(seen, lights, i);
        sum += found.color * answer(light_response(in, response, found.direction, dot(eye_side, found.direction)), paint);
    }
    return max(sum, vec3(0.0)) * light::exposure();
}
#else
// Light from the fragment towards the eye, where its coverage is `opacity` in all.
fn shade(
    in: FeatherVertex,
    base: u32,
    shape: vec4<f32>,
    frame: Frame,
    covered: Covered,
    albedo: vec3<f32>,
    opacity: f32,
) -> vec3<f32> {
    let vane = base + select(data::LEFT_VANE, data::RIGHT_VANE, covered.right);
    let shear = rachis_at(base, in.uv.y).y * shape.x;
    let seen = light::fragment_of(in.world_position, frame.normal, in.position, in.instance_index);
    let front = frame.local_eye.z >= 0.0;
    let eye_side = select(-frame.normal, frame.normal, front);
    let level = class_of(in);
    // Where a fibre may be wider than the pixel, the place on it matters.
    let resolved = level == data::CARD_NEAR || level == data::CARD_MIXED;
    var near = NearFootprint(vec2(0.0, -1.0), vec2(0.0, -1.0));
    if (resolved) {
        near = near_footprint(base, in.uv.y, covered.footprint, frame.local_eye, covered.right);
    }

    // Sheen takes its share first.
    let fuzz = feather_at(base + data::SHEEN);
    let sheen = sheen_at(base, sheen_place(abs(frame.local_eye.z)));
    let tint = sheen_tint(albedo * feather_at(base + data::PARTS + DISTAL).x);
    let fuzz_albedo = sheen_albedo(sheen, fuzz.x);
    let base_share = 1.0 - fuzz_albedo * max(max(tint.x, tint.y), tint.z);
    let fuzz_tint = fuzz.x * tint;

    let open = open_sky(in.uv.y);
    let reflected = reflect(-frame.eye, eye_side);
#ifdef IRIDESCENT
    // Of all mirrors of a vane thin layers are the brightest.
    let vane_angles = feather_at(vane);
    let vane_barb = fibre_tangent(BARB, vane_angles, covered.right, shear);
    let mirror = shimmer_mirror(base, vane_barb, vane_angles);
    let mirror_normal = mirror.x * frame.across + mirror.y * frame.along + mirror.z * frame.normal;
    let around = light::environment(seen, eye_side, reflect(-frame.eye, mirror_normal), mirror.w);
    let row = shimmer_row(base, in.uv);
#else
    let around = light::environment(seen, eye_side, reflected, 0.6);
#endif
    let behind = light::environment(seen, -eye_side, -frame.eye, 0.8);

    let shares = covered.weights / opacity;
    let shown = shown_parts(shares, LEAST_SHARE);
    var sum = fuzz_albedo * tint * around.irradiance * open;
    let lights = light::lights_of(seen);
    // Lights are fetched once (shadows are dear) and then seen by every component, a batch at a time. The first batch sees the sky, too.
    for (var first = 0u; first == 0u || first < lights.count; first += BATCH) {
        // Said to be zero: what is only declared in a loop keeps, and holds in registers, what it was in the turn before.
        var batch = array<Arriving, BATCH>();
        // Those that arrive: others are in shadow.
        var count = 0u;
        for (var i = first; i < min(first + BATCH, lights.count); i++) {
            let found = light::light_at(seen, lights, i);
            if (all(found.color <= vec3(0.0))) {
                continue;
            }
            let there = found.direction;
            let direction = vec3(dot(there, frame.across), dot(there, frame.along), dot(there, frame.normal));
            batch[count].color = found.color;
            batch[count].direction = direction;
            count += 1u;
            let up = vec3(0.0, 0.0, select(-1.0, 1.0, front));
            sum += fuzz_tint * found.color * sheen_evaluate(sheen, up, frame.local_eye, direction);
        }
        if (count == 0u && first > 0u) {
            continue;
        }
        // Found anew for every batch and behind its shadow maps, so that its many numbers need not be kept.
        let shadowing = shadowing_of(base, in.uv.y, covered, frame);
        for (var i = 0u; i < count; i++) {
            let ray = light_ray(shadowing, batch[i].direction);
            batch[i].caught = caught_light(shadowing, ray);
            batch[i].reaches = reaches_of(shadowing, ray);
        }
        let kept = kept_place(base, covered.right, frame);
        var passed = 0.0;
        for (var left = shown; left != 0u; left &= left - 1u) {
            let part = firstTrailingBit(left);
            let share = shares[part];
            let about = feather_at(base + data::PARTS + part);
            let angles = feather_at(vane);
            let tangent = fibre_tangent(part, angles, covered.right, shear);
            let meets = settings.multiple_scattering * select(about.z, about.y, front);
            let eye = in_fibre(tangent, frame.hand, frame.local_eye);
#ifdef PLAIN_FIBRES
            let frequency = select(0.0, shadowing.frequency, part == shadowing.lower);
            var shading = short_part(about.w, eye, shape.w);
#ifdef IRIDESCENT
            let tipward = in_fibre(tangent, frame.hand, vec3(vane_barb, 0.0)).y;
            let shimmer = shimmer_of(base, part, eye, tipward, min(albedo * about.x, vec3(0.98)), row);
            let entering = shimmer_entering(shimmer, shading.energy.x);
#endif
            var lobes = array<short::ShortLobes, BATCH>();
            var reaching = array<FibreReach, BATCH>();
#ifdef IRIDESCENT
            var mirrored = array<vec3<f32>, BATCH>();
#endif
            for (var i = 0u; i < count; i++) {
                let to_light = in_fibre(tangent, frame.hand, batch[i].direction);
                lobes[i] = short::short_lobes(shading, to_light);
                reaching[i] = reach_of(batch[i].reaches, part, shadowing.lower, lobes[i].turn, false);
#ifdef IRIDESCENT
                lobes[i].surface *= 1.0 - shimmer.share;
                mirrored[i] = reaching[i].mirror * shimmer_lobe(shimmer, to_light + eye);
#endif
            }
            var outside = shading.energy.x;
#ifdef IRIDESCENT
            // Under layers the surface has no other reflection.
            outside *= 1.0 - shimmer.share;
#endif
            let keeping = keeping_of(shading, outside, kept, part);
            let weight = share * base_share;
            // One channel after the other: fewer numbers at a time.
            for (var c = 0u; c < 3u; c++) {
                var color = short::short_color(shading, inner_albedo(min(albedo[c] * about.x, 0.98), meets), frequency);
#ifdef IRIDESCENT
                color.second *= entering[c];
                color.scattered *= entering[c];
#endif
                let own = kept_of(keeping, color);
                var radiance = 0.0;
                if (first == 0u) {
                    let everywhere = 0.5 * (around.irradiance[c] + behind.irradiance[c]);
                    radiance = around.radiance[c] * keeping.outside * keeping.surface.x + around.irradiance[c] * own.sides.x
                        + behind.irradiance[c] * own.sides.y;
                    radiance = own.cone * radiance + own.spread * everywhere;
#ifdef IRIDESCENT
                    radiance += around.radiance[c] * shimmer.energy[c] * keeping.surface.x;
#endif
                    radiance *= open;
                }
                for (var i = 0u; i < count; i++) {
                    var lit = own.cone * short::short_lit(shading, color, lobes[i], reaching[i]);
#ifdef IRIDESCENT
                    lit += mirrored[i][c];
#endif
                    radiance += batch[i].color[c] * (lit + own.spread * batch[i].caught);
                }
                sum[c] += weight * radiance;
            }
#else
            let painted = min(albedo * about.x, vec3(0.98));
            let single = single_scattering_albedo(painted, meets);
            let fibre = read_part(base, part, about.w, tangent, frame);
            var harmonics = 4u;
            if (level != data::CARD_MEAN) {
                harmonics = fibre_terms(settings.threshold, fibre.parameters.azimuthal_roughness);
            }
            var shading = fibre_shading(fibre.parameters, fibre.row, single, eye, shape.w, harmonics);
#ifdef IRIDESCENT
            let tipward = in_fibre(tangent, frame.hand, vec3(vane_barb, 0.0)).y;
            let shimmer = shimmer_of(base, part, eye, tipward, painted, row);
            shading = shimmer_let_in(shading, shimmer);
#endif
            if (part == shadowing.lower) {
                shading.along = fibre_along(fibre.parameters, fibre.row, shading.absorption, shadowing.frequency);
            }
            let before = kept_light(kept, part, 0u);
            let after = kept_light(kept, part, 1u);
            var fourth = shading.energy_fourth;
            if (shading.structural) {
                fourth *= mix(1.0, clamp(0.5 + 0.5 * shading.azimuth.y, 0.0, 1.0), shading.dark_back);
            }
            let specular = shading.energy_surface * before.x;
            let from_front = shading.energy_through * before.y + shading.energy_inner * before.z + fourth * before.w;
            let from_back = shading.energy_surface * after.x + shading.energy_through * after.y + shading.energy_inner * after.z
                + fourth * after.w;
            let scattered = shading.energy_surface + shading.energy_through + shading.energy_inner + fourth;
            let meeting = 1.0 - min((specular + from_front + from_back) / max(scattered, vec3(1e-6)), vec3(1.0));
            let parallel = select(0.0, PARALLEL_MEETINGS, shading.structural);
            let again = multiple_scattering(scattered, settings.multiple_scattering * meeting, parallel);
            var radiance = vec3(0.0);
            if (first == 0u) {
#ifdef SAMPLED_ENVIRONMENT
                let indirect = sampled_environment(
                    seen, shading, tangent, frame, shadowing, part_eye(shadowing, part), part,
                    passed, passed + share, settings.environment_samples,
                );
#else
                let indirect = around.radiance * specular + around.irradiance * from_front + behind.irradiance * from_back;
#endif
                let everywhere = 0.5 * (around.irradiance + behind.irradiance);
                radiance += (again.cone * indirect + again.spread * everywhere) * open;
#ifdef IRIDESCENT
                var mirrored = around.radiance;
                if (!ONE_LOOK && shimmer.share > 0.0) {
                    mirrored = family_light(seen, eye_side, frame, tangent, shimmer, eye);
                }
                radiance += shimmer.energy * before.x * mirrored * open;
#endif
                passed += share;
            }
            let place = near_of(part, near, angles, covered.right, tangent, eye, frame.hand);
            if (resolved && place.y > 0.0) {
                let window = fibre_window(place.x, place.y);
                let near_fibre = fibre_near(fibre.parameters, fibre.row, single, eye, shape.w, 8u, window);
                for (var i = 0u; i < count; i++) {
                    let lobes = fibre_near_lobes(near_fibre, in_fibre(tangent, frame.hand, batch[i].direction));
                    let reach = reach_of(batch[i].reaches, part, shadowing.lower, lobes.turn, true);
                    radiance += batch[i].color * (again.cone * fibre_lit(shading, lobes, reach) + again.spread * batch[i].caught);
                }
            } else {
                for (var i = 0u; i < count; i++) {
                    let lobes = fibre_lobes(shading, in_fibre(tangent, frame.hand, batch[i].direction));
                    let reach = reach_of(batch[i].reaches, part, shadowing.lower, lobes.turn, false);
                    radiance += batch[i].color * (again.cone * fibre_lit(shading, lobes, reach) + again.spread * batch[i].caught);
#ifdef IRIDESCENT
                    let half_way = in_fibre(tangent, frame.hand, batch[i].direction + frame.local_eye);
                    radiance += batch[i].color * reach.mirror * shimmer_lobe(shimmer, half_way);
#endif
                }
            }
            sum += share * base_share * radiance;
#endif
        }
    }
    return max(sum, vec3(0.0)) * light::exposure();
}

#endif

#ifdef DEBUG_VIEW
// Where the energy of the fibres goes: surface reflection red, back to the eye's side green, through the feather blue.
fn lobe_color(in: FeatherVertex, base: u32, shape: vec4<f32>, frame: Frame, covered: Covered, albedo: vec3<f32>) -> vec3<f32> {
    let angles = feather_at(base + select(data::LEFT_VANE, data::RIGHT_VANE, covered.right));
    let shear = rachis_at(base, in.uv.y).y * shape.x;
    var sum = vec3(0.0);
    for (var part = 0u; part < 4u; part++) {
        let weight = covered.weights[part];
        if (weight <= LEAST_SHARE * dot(covered.weights, vec4(1.0))) {
            continue;
        }
        let tangent = fibre_tangent(part, angles, covered.right, shear);
        let about = feather_at(base + data::PARTS + part);
        let painted = min(albedo * about.x, vec3(0.98));
        let fibre = read_part(base, part, about.w, tangent, frame);
        let energy = fibre_energy_split(fibre_shading(fibre.parameters, fibre.row, painted, fibre.eye, shape.w, 3u));
        sum += weight * vec3(3.0 * energy.specular, dot(energy.front, vec3(1.0)), dot(energy.back, vec3(1.0)));
    }
    return sum / max(max(sum.x, sum.y), max(sum.z, 1e-6));
}
#endif
