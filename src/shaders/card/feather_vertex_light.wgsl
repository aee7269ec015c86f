// What a card makes of light, found at its vertices and interpolated: for cards over which it changes evenly. Eye and directions of
// lights are known there; what of a light arrives, and the painted color, are asked in every fragment.
#define_import_path bevy_plumage::feather_vertex_light
#import bevy_plumage::{
    anatomy::{barbule_factor, hooked},
    feather_bindings::{albedo_sampler, albedo_texture, feather_at, feather_base, motion, rachis_at, settings, shape_at, sheen_at},
    feather_cover::{Covered, Frame, frame_of},
    feather_data as data,
    feather_fibre::{BARB, DISTAL, fibre_tangent, in_fibre, keeping_of, kept_of, short_part, shown_parts},
    feather_io::FeatherVertex,
    feather_shadow::{Reaches, caught_light, kept_place, light_ray, reach_of, reaches_of, shadowing_of},
    footprint::Footprint,
    masking::{barb_strip, seen_cell, storeys},
    query::{LOD_MEAN, vane_coverage},
    scattering::FibreReach,
    scattering_multiple::inner_albedo,
    scattering_short as short,
    sheen::{sheen_albedo, sheen_evaluate, sheen_place, sheen_tint},
    vertex_light::grazing_light,
}

// Directional lights that are followed.
const VERTEX_LIGHTS: u32 = 2u;
// Darkest paint that a response is found for: darker ones show little but the surface of the fibres.
const LEAST_PAINT: f32 = 0.15;
// Levels of the albedo below the smallest one: a vertex takes the color around it.
const AROUND: u32 = 3u;
// Share of the way from the vertices of the middle to those of an edge by which the shaft may lie beside the middle, so that a vane ends there.
const STRAIGHT: f32 = 0.12;
// Share of the width, from the middle, within which both vanes meet.
const EDGE: f32 = 0.25;

// Radiance to the eye per irradiance, of each light and of the sky in front and behind: of barbs and of barbules, each per its paint_over
// (of lights also over grazing_light), and of black paint; per radiance of the mirrored sky. Of the shaft beside the vane, of the lights and
// the sky: per paint of barbs, and black.
struct VaneResponse {
    first: vec3<f32>,
    second: vec3<f32>,
    front: vec3<f32>,
    back: vec3<f32>,
    sky: f32,
    shaft: vec4<f32>,
    black_shaft: vec4<f32>,
}

// What a painted color adds to black barbs, and to barbules, but for a factor: nothing up to the one that the surface of the fibres
// reflects, then evenly more, up to white ones.
struct Paint {
    barbs: vec3<f32>,
    barbules: vec3<f32>,
}

// `palette`: of header PAINT.
fn paint_added(albedo: vec3<f32>, palette: vec4<f32>, front: bool) -> vec3<f32> {
    return max(min(albedo, vec3(palette.z)) - select(palette.y, palette.x, front), vec3(0.0));
}

fn paint_over(base: u32, albedo: vec3<f32>, front: bool) -> Paint {
    return Paint(
        paint_added(albedo, feather_at(base + data::PAINT), front),
        paint_added(albedo, feather_at(base + data::PAINT + 1u), front),
    );
}

#ifdef LIT_VERTICES
// Lights whose directions are closer than this cosine are one to a fragment.
const SAME_LIGHT: f32 = 0.995;

// A vane's, interpolated, mixed with the share of the shaft in what is seen; to what a vane makes of lights light_response adds the shaft's.
fn response_of(in: FeatherVertex, right: bool, shaft: f32) -> VaneResponse {
    let first = select(in.left_first, in.right_first, right);
    let vane = 1.0 - shaft;
    // It is 0 at the edges.
    let there = shaft / max(1.0 - 2.0 * abs(in.world_normal.w - 0.5), 0.5);
    let painted = there * in.shaft;
    let black = there * vec4(in.left_front.w, in.left_back.w, in.right_front.w, in.right_back.w);
    return VaneResponse(
        vane * first.xyz,
        vane * select(in.left_second, in.right_second, right).xyz,
        vane * select(in.left_front, in.right_front, right).xyz + vec3(painted.z, 0.0, black.z),
        vane * select(in.left_back, in.right_back, right).xyz + vec3(painted.w, 0.0, black.w),
        vane * first.w,
        painted,
        black,
    );
}

// To which of the lights a fragment's light belongs: there are no others than those of the vertices. `facing`: its cosine to the
// normal on the eye's side.
fn light_response(in: FeatherVertex, response: VaneResponse, direction: vec3<f32>, facing: f32) -> vec3<f32> {
    let first = data::octahedral(vec2(in.left_second.w, in.right_second.w));
    let is_first = dot(first, direction) > SAME_LIGHT;
    let painted = vec3(vec2(grazing_light(facing)), 1.0);
    return painted * select(response.second, response.first, is_first)
        + select(vec3(response.shaft.y, 0.0, response.black_shaft.y), vec3(response.shaft.x, 0.0, response.black_shaft.x), is_first);
}

// Of every channel.
fn answer(response: vec3<f32>, paint: Paint) -> vec3<f32> {
    return response.x * paint.barbs + response.y * paint.barbules + response.z;
}
#endif

// Of one vane at a height on the rachis, `aside` of the card's width from the middle; of the shaft, too, where that is 0. `present`: which
// of the lights there are; the others answer nothing.
fn vane_response(
    base: u32,
    right: bool,
    height: f32,
    aside: f32,
    frame: Frame,
    painted: vec3<f32>,
    lights: array<vec3<f32>, VERTEX_LIGHTS>,
    present: vec2<bool>,
) -> VaneResponse {
    let front = frame.local_eye.z >= 0.0;
    // The brightest channel; what the others are follows from the paint. Of structural fibres, which follow it less, one between.
    let most = max(max(painted.x, painted.y), painted.z);
    let second = painted.x + painted.y + painted.z - most - min(min(painted.x, painted.y), painted.z);
    let bright = max(mix(most, second, 0.5 * feather_at(base + data::PAINT).w), LEAST_PAINT);
    let added = paint_over(base, vec3(bright), front);
    let per_paint = 1.0 / max(vec2(added.barbs.x, added.barbules.x), vec2(1e-3));
    let header = feather_at(base + data::SHAPE);
    let slot = base + select(data::LEFT_VANE, data::RIGHT_VANE, right);
    let shear = rachis_at(base, height).y * header.x;
    // Averages over the pattern beside the place.
    var shape = shape_at(slot);
    let rest = feather_at(slot + 2u);
    // The fringe is narrower than from one vertex to the next: at the edge so much is loose that the mean over the vane is right.
    let tight = max(1.0 - 4.0 * aside * rest.y, 0.0);
    shape.vane.hooked = barbule_factor(tight * hooked(0.0, height, 1.0, 0.0, rest.z));
    let view = frame.local_eye * vec3(select(1.0, -1.0, right), 1.0, 1.0);
    let seen = storeys(shape, view);
    let strip = barb_strip(shape, seen);
    let cell = seen_cell(shape, seen, strip, front);
    let nowhere = Footprint(vec2(0.0), vec3(0.0));
    let weights = max(vane_coverage(cell, shape.vane, nowhere, LOD_MEAN, 0.0), vec3(0.0));
    // The shaft counts for itself.
    let shares = vec4(select(0.0, 1.0, right && aside < EDGE), weights / max(dot(weights, vec3(1.0)), 1e-6));
    let open = clamp(strip.x / max(2.0 * seen.silhouette, 1e-9), 0.0, 1.0);
    let covered = Covered(shares, right, shape.vane.hooked, open, nowhere);
    let shadowing = shadowing_of(base, height, covered, frame);
    let kept = kept_place(base, right, frame);

    let fuzz = feather_at(base + data::SHEEN);
    let sheen = sheen_at(base, sheen_place(abs(frame.local_eye.z)));
    // Bright, and black.
    let share = feather_at(base + data::PARTS + DISTAL).x;
    let tint = vec2(sheen_tint(vec3(bright * share)).x, sheen_tint(vec3(0.0)).x);
    let shown = sheen_tint(painted * share);
    let fuzz_albedo = sheen_albedo(sheen, fuzz.x);
    let base_share = 1.0 - fuzz_albedo * max(max(shown.x, shown.y), shown.z);
    let up = vec3(0.0, 0.0, select(-1.0, 1.0, front));

    // Sheen colors as barbules do.
    let fuzzy = vec3(0.0, (tint.x - tint.y) * per_paint.y, tint.y);
    var lit = array<vec3<f32>, VERTEX_LIGHTS>();
    var ahead = fuzz_albedo * fuzzy;
    var beyond = vec3(0.0);
    var mirrored = 0.0;
    var caught = array<f32, VERTEX_LIGHTS>();
    var reaches = array<Reaches, VERTEX_LIGHTS>();
    for (var i = 0u; i < VERTEX_LIGHTS; i++) {
        if (!present[i]) {
            continue;
        }
        let ray = light_ray(shadowing, lights[i]);
        caught[i] = caught_light(shadowing, ray);
        reaches[i] = reaches_of(shadowing, ray);
        lit[i] = fuzz.x * sheen_evaluate(sheen, up, frame.local_eye, lights[i]) * fuzzy;
    }
    let angles = feather_at(slot);
    var shaft = vec4(0.0);
    var black_shaft = vec4(0.0);
    for (var left = shown_parts(shares, 0.0); left != 0u; left &= left - 1u) {
        let part = firstTrailingBit(left);
        let about = feather_at(base + data::PARTS + part);
        let tangent = fibre_tangent(part, angles, right, shear);
        let meets = settings.multiple_scattering * select(about.z, about.y, front);
        let eye = in_fibre(tangent, frame.hand, frame.local_eye);
        let frequency = select(0.0, shadowing.frequency, part == shadowing.lower);
        let shading = short_part(about.w, eye, header.w);
        let keeping = keeping_of(shading, shading.energy.x, kept, part);
        let weight = shares[part] * base_share;
        let of_part = vec3(select(vec2(0.0, per_paint.y), vec2(per_paint.x, 0.0), part <= BARB), 0.0);
        var lobes = array<short::ShortLobes, VERTEX_LIGHTS>();
        var arriving = array<FibreReach, VERTEX_LIGHTS>();
        for (var i = 0u; i < VERTEX_LIGHTS; i++) {
            if (!present[i]) {
                continue;
            }
            lobes[i] = short::short_lobes(shading, in_fibre(tangent, frame.hand, lights[i]));
            arriving[i] = reach_of(reaches[i], part, shadowing.lower, lobes[i].turn, false);
        }
        let inside = inner_albedo(min(bright * about.x, 0.98), meets);
        for (var c = 0u; c < 2u; c++) {
            let color = short::short_color(shading, select(0.0, inside, c == 0u), frequency);
            let counts = select(vec3(0.0, 0.0, 1.0) - of_part, of_part, c == 0u);
            let whole = kept_of(keeping, color);
            let there = whole.cone * whole.sides + 0.5 * whole.spread;
            let sky = whole.cone * keeping.outside * keeping.surface.x;
            var own = vec2(0.0);
            for (var i = 0u; i < VERTEX_LIGHTS; i++) {
                if (!present[i]) {
                    continue;
                }
                own[i] = whole.cone * short::short_lit(shading, color, lobes[i], arriving[i]) + whole.spread * caught[i];
            }
            if (part == 0u) {
                let seen = weight * vec4(own, there + vec2(sky, 0.0));
                shaft += select(-per_paint.x, per_paint.x, c == 0u) * seen;
                black_shaft += select(1.0, 0.0, c == 0u) * seen;
                continue;
            }
            ahead += weight * there.x * counts;
            beyond += weight * there.y * counts;
            mirrored += 0.5 * weight * sky;
            lit[0] += weight * own.x * counts;
            lit[1] += weight * own.y * counts;
        }
    }
    for (var i = 0u; i < VERTEX_LIGHTS; i++) {
        lit[i] *= vec3(vec2(1.0 / grazing_light(select(-lights[i].z, lights[i].z, front))), 1.0);
    }
    return VaneResponse(lit[0], lit[1], ahead, beyond, mirrored, shaft, black_shaft);
}

// The vertex with what both vanes make of light there.
fn light_vertex(placed: FeatherVertex) -> FeatherVertex {
    var out = placed;
#ifdef LIT_VERTICES
    if (data::lod_class(placed.card.w) != data::CARD_LIT) {
        return out;
    }
    let feather = data::card_feather(placed.card.x);
    let base = feather_base(feather);
    let frame = frame_of(placed);
    var lights = array<vec3<f32>, VERTEX_LIGHTS>();
    var present = vec2(false);
    for (var i = 0u; i < VERTEX_LIGHTS; i++) {
        let there = motion[min(data::MOTION_LIGHTS + i, arrayLength(&motion) - 1u)];
        lights[i] = vec3(dot(there.xyz, frame.across), dot(there.xyz, frame.along), dot(there.xyz, frame.normal));
        present[i] = there.w > 0.0;
    }
    let first = data::octahedral_of(motion[min(data::MOTION_LIGHTS, arrayLength(&motion) - 1u)].xyz);
    let levels = textureNumLevels(albedo_texture);
    let layer = 2u * feather + select(1u, 0u, frame.local_eye.z >= 0.0);
    let texel = textureSampleLevel(albedo_texture, albedo_sampler, placed.uv, layer, f32(max(levels, AROUND) - AROUND));
    let albedo = mix(texel.rgb, data::card_tint(placed.card.y), texel.a);
    let aside = abs(placed.uv.x - 0.5);
    // Both vanes end at the shaft, one at an edge: there the other one, of which next to nothing shows unless the shaft is bent, counts as
    // the same.
    let both = aside < EDGE || abs(rachis_at(base, placed.uv.y).x - 0.5) > STRAIGHT * aside;
    let edge_is_right = placed.uv.x > 0.5;
    var found = VaneResponse();
    for (var i = 0u; i < 2u; i++) {
        let right = i == 1u;
        if (both || i == 0u) {
            found = vane_response(base, select(edge_is_right, right, both), placed.uv.y, aside, frame, albedo, lights, present);
        }
        if (right) {
            out.right_first = vec4(found.first, found.sky);
            out.right_second = vec4(found.second, first.y);
            out.right_front = vec4(found.front, found.black_shaft.z);
            out.right_back = vec4(found.back, found.black_shaft.w);
            out.left_front.w = found.black_shaft.x;
            out.left_back.w = found.black_shaft.y;
            out.shaft = found.shaft;
        } else {
            out.left_first = vec4(found.first, found.sky);
            out.left_second = vec4(found.second, first.x);
            out.left_front = vec4(found.front, 0.0);
            out.left_back = vec4(found.back, 0.0);
        }
    }
#endif
    return out;
}
