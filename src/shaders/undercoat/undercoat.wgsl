// The coat as a volume: a ray enters through the outside of the shell and is marched to the skin or to the air behind (hybrid fur
// rendering; docs/book/undercoat.md). Or as shells with precomputed transfer (UNDERCOAT_SHELLS).
#import bevy_pbr::{
    mesh_view_bindings as vb,
    view_transformations::position_world_to_clip,
}
#import bevy_plumage::down_march::{
    March,
    OPAQUE,
    extinction_sine,
    march_add,
    march_begin,
    march_jitter,
    march_lit,
    march_mean_distance,
    march_mip,
    march_over,
    march_step,
}
#import bevy_plumage::down_tier::{TierMix, tier_mix}
#import bevy_plumage::down_walk::{
    FACE_SKIN,
    FACE_TOP,
    MAX_CELLS,
    NO_FACE,
    NO_LINK,
    PrismCorners,
    Walk,
    face_place,
    face_tet,
    linked_face,
    tet_across,
    tet_exit,
    walk_start,
}
#import bevy_plumage::feather_eye as eye
#import bevy_plumage::feather_lighting as lighting
#import bevy_plumage::feather_pattern as pattern
#import bevy_plumage::undercoat_data as data
#import bevy_plumage::undercoat_data::coat
#import bevy_plumage::undercoat_lighting as light

struct VertexInput {
    @builtin(instance_index) instance: u32,
    @location(0) cell: vec2<u32>,
}

struct VertexOutput {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(perspective, centroid) world: vec3<f32>,
    @location(1) @interpolate(flat) start: u32,
    @location(2) @interpolate(flat) instance: u32,
    // Barycentric coordinates of the sorted corners, and the height.
    @location(3) @interpolate(perspective, centroid) place: vec4<f32>,
}

@vertex
fn vertex(vertex: VertexInput) -> VertexOutput {
    let id = vertex.cell.x >> 8u;
    let node = data::node_at(id);
#ifdef UNDERCOAT_SHELLS
    // Each in the middle of its slab.
    let shell = vertex.cell.x & 255u;
    let shells = max(coat.shell_count, 1u);
    let height = (f32(min(shell, shells - 1u)) + 0.5) / f32(shells);
#else
    let height = f32(vertex.cell.x & 255u) / 255.0;
#endif
    let ids = data::prism_at(vertex.cell.y >> 4u, vec3(0.0)).ids;
    var out: VertexOutput;
    out.world = mix(node.bottom, node.top, height);
    out.position = position_world_to_clip(out.world);
#ifdef UNDERCOAT_SUNK
    // Just in front of the skin on which its outside lies, so far as it differs from the skin.
    out.position.z *= 1.0 + 1e-5 * coat.shown;
#endif
#ifdef UNDERCOAT_SHELLS
    if (shell >= shells) {
        // No triangle: outside of every view.
        out.position = vec4(0.0, 0.0, -1.0, 1.0);
    }
#endif
    out.start = vertex.cell.y;
    out.instance = vertex.instance;
    out.place = vec4(vec3(f32(id == ids.x), f32(id == ids.y), f32(id == ids.z)), height);
    return out;
}

// Thickness of the coat on the screen, pixels, seen from the side.
fn pixels_of(height: f32, world: vec3<f32>) -> f32 {
    let clip = position_world_to_clip(world);
    return height * 0.5 * vb::view.viewport.w * abs(vb::view.clip_from_view[1][1]) / max(clip.w, 1e-6);
}

// Shares of the tiers at a thickness, or the one that is asked for.
fn tier_of(height_px: f32) -> TierMix {
    switch coat.tier {
        case 1u: { return TierMix(1.0, 0.0, 0.0, 16.0, 0.0, 1.0); }
        case 2u: { return TierMix(0.0, 1.0, 0.0, 14.0, 1.0, 1.0); }
        case 3u: { return TierMix(0.0, 0.0, 1.0, 14.0, 1.0, saturate(height_px / 3.0)); }
        default: { return tier_mix(height_px, vec2(coat.near_px, coat.far_px)); }
    }
}

fn place_of(
    cell: data::PrismCell,
    gradient: data::Gradient,
    place: vec4<f32>,
    to_eye: vec3<f32>,
    height_px: f32,
    mip: f32,
) -> light::Place {
    let weights = place.xyz;
    let z = clamp(place.w, 0.0, 1.0);
    let frame = data::frame_at(cell, weights);
    let height = dot(cell.heights, weights);
    var p: light::Place;
    p.at = vec3(dot(cell.u, weights), dot(cell.v, weights), z);
    p.normal = frame.normal;
    p.tangent = normalize(mix(frame.normal, frame.lay, 0.999 * coat.lean * z));
    p.to_eye = to_eye;
    p.albedo = mix(vec3(1.0), frame.color, coat.tinted) * mix(coat.color, coat.tip_color, z);
    p.spread = mix(coat.skin_spread, coat.tip_spread, z);
    p.grad_u = gradient.u * height;
    p.grad_v = gradient.v * height;
    p.lean = vec2(dot(p.grad_u, frame.lay), dot(p.grad_v, frame.lay));
    p.level = march_mip(data::cells_along(p.grad_u) / max(height_px, 1e-3), 2.0);
    p.level = max(p.level, mip);
    return p;
}

fn strand_color(id: u32) -> vec3<f32> {
    let h = (id * 747796405u + 2891336453u) ^ (id >> 7u);
    let g = h * 277803737u;
    return vec3(f32(g & 255u), f32((g >> 8u) & 255u), f32((g >> 16u) & 255u)) / 255.0;
}

// Interleaved gradient noise (Jimenez 2014).
fn pixel_noise(at: vec2<f32>) -> f32 {
    return fract(52.9829189 * fract(dot(at, vec2(0.06711056, 0.00583715))));
}

#ifdef UNDERCOAT_SHELLS

@fragment
fn fragment(in: VertexOutput) -> @location(0) vec4<f32> {
    let cell = data::prism_at(in.start >> 4u, in.world);
    let to_eye = eye::to_eye(in.world);
    let height_px = pixels_of(dot(cell.heights, in.place.xyz), in.world);
    let p = place_of(cell, data::tile_gradient(cell), in.place, to_eye, height_px, 0.0);
    let f = lighting::fragment_of(vec4(in.world, 1.0), p.normal, in.position, in.instance);
    let s = light::surroundings_of(f);
    let extinction = data::extinction_at(light::root_of(p, p.at), p.level) * extinction_sine(dot(p.tangent, to_eye), p.spread);
    // The way through the slab, not its thickness.
    let way = 1.0 / (f32(max(coat.shell_count, 1u)) * max(abs(dot(p.normal, to_eye)), 0.05));
    let alpha = 1.0 - exp(-extinction * way);
    let source = light::coat_source(p, s, 0.0);
    return lighting::finish(vec4(source * lighting::exposure(), alpha), vec4(in.world, 1.0), in.position);
}

#else

struct FragmentOutput {
    @location(0) color: vec4<f32>,
#ifndef UNDERCOAT_SUNK
    @builtin(frag_depth) depth: f32,
#endif
#ifdef SAMPLE_COVERAGE
    @builtin(sample_mask) samples: u32,
#endif
}

// Where the walk has come to, with the prism it is in.
struct Journey {
    walk: Walk,
    prism: u32,
    cell: data::PrismCell,
    // Why there is no next cell.
    ended: u32,
    // Face of a wall through which it has left.
    wall: u32,
    // Of the last cell crossed.
    t: f32,
    place: vec4<f32>,
}

// A ray of which more is left where the mean coat is opaque has met a gap in it.
const GAP: f32 = 0.25;
// Pixels by which a ray must pass the rim of the skin to count as one that leaves into the air.
const NEAR_RIM: f32 = 1.5;
const GOING: u32 = 0u;
const ON_SKIN: u32 = 1u;
const IN_AIR: u32 = 2u;

fn journey_begin(start: u32, origin: vec3<f32>, direction: vec3<f32>) -> Journey {
    var j: Journey;
    j.prism = start >> 4u;
    j.cell = data::prism_at(j.prism, origin);
    j.walk = walk_start(j.cell.corners, start & 15u, vec3(0.0), direction);
    j.ended = GOING;
    j.wall = NO_FACE;
    return j;
}

// Through one tetrahedron: from j.walk to (j.t, j.place); the caller then calls journey_on.
fn journey_across(j: ptr<function, Journey>, direction: vec3<f32>) -> u32 {
    let exit = tet_exit((*j).cell.corners, (*j).cell.parity, (*j).walk.tet, (*j).walk.face, vec3(0.0), direction);
    if (exit.face == NO_FACE) {
        (*j).t = (*j).walk.t;
        (*j).place = (*j).walk.place;
        (*j).ended = IN_AIR;
        return exit.face;
    }
    (*j).t = max(exit.t, (*j).walk.t);
    (*j).place = face_place((*j).cell.corners, exit.face, (*j).t * direction);
    return exit.face;
}

fn journey_on(j: ptr<function, Journey>, face: u32, origin: vec3<f32>, direction: vec3<f32>) {
    if ((*j).ended != GOING) {
        return;
    }
    if (face == FACE_SKIN) {
        (*j).ended = ON_SKIN;
        return;
    }
    if (face == FACE_TOP) {
        (*j).ended = IN_AIR;
        return;
    }
    if (face < FACE_TOP) {
        (*j).walk = Walk(tet_across(face, (*j).walk.tet), face, (*j).t, (*j).place);
        return;
    }
    let link = (*j).cell.links[(face - 4u) % 3u];
    if (link == NO_LINK) {
        (*j).ended = IN_AIR;
        (*j).wall = face;
        return;
    }
    (*j).prism = link >> 2u;
    (*j).cell = data::prism_at((*j).prism, origin);
    let other = linked_face(face, link);
    (*j).walk = Walk(face_tet(other), other, (*j).t, face_place((*j).cell.corners, other, (*j).t * direction));
}

// Distance of a ray from the skin's rim below a wall; far for faces that are no wall.
fn rim_distance(corners: PrismCorners, face: u32, direction: vec3<f32>) -> f32 {
    if (face < 4u || face > 9u) {
        return 1e9;
    }
    let wall = (face - 4u) % 3u;
    let first = select(corners.a, corners.b, wall == 1u);
    let second = select(corners.c, corners.b, wall == 0u);
    // Seen along the ray.
    let p = first - direction * dot(first, direction);
    let q = second - direction * dot(second, direction);
    let x = saturate(-dot(p, q - p) / max(dot(q - p, q - p), 1e-20));
    return length(mix(p, q, x));
}

// Beyond the last step the next are as long.
fn step_of(i: u32, count: u32, steps: f32, jitter: f32) -> vec2<f32> {
    if (i < count) {
        return march_step(i, steps, jitter);
    }
    let n = clamp(steps, 1.0, 64.0);
    return vec2(1.0 + (f32(i - count) + jitter) / n, 1.0 / n);
}

@fragment
fn fragment(in: VertexOutput) -> FragmentOutput {
    let origin = in.world;
    let to_eye = eye::to_eye(origin);
    let direction = -to_eye;

    // The way through the shell, in heights of the coat.
    var j = journey_begin(in.start, origin, direction);
    let entry_height = dot(j.cell.heights, j.walk.place.xyz);
    let height_px = pixels_of(entry_height, origin);
    let entry_color = data::frame_at(j.cell, j.walk.place.xyz).color;
    var rim = rim_distance(j.cell.corners, in.start & 15u, direction);
    let entry = place_of(j.cell, data::tile_gradient(j.cell), j.walk.place, to_eye, height_px, 0.0);
#ifndef SAMPLE_COVERAGE
    // It moves with the skin, so that the rim does not swim.
    let threshold = pattern::hashed_threshold(entry.at.xy, dpdx(entry.at.xy), dpdy(entry.at.xy), 0u);
#endif
    // It ends where the mean coat along it is opaque: at the tips that is further on than deep inside.
    let sine = extinction_sine(dot(entry.tangent, direction), 0.5 * (coat.skin_spread + coat.tip_spread));
    let clip_depth = coat.depth_clip / max(sine, 0.05);
    var way = 0.0;
    var depth_so_far = 0.0;
    var cells = 0u;
    var clipped = false;
    for (var i = 0u; i < MAX_CELLS; i++) {
        let face = journey_across(&j, direction);
        let here = (j.t - j.walk.t) / max(dot(j.cell.heights, 0.5 * (j.place.xyz + j.walk.place.xyz)), 1e-7);
        let depth = here * data::mean_extinction(0.5 * (j.place.w + j.walk.place.w));
        cells += 1u;
        if (depth_so_far + depth >= clip_depth) {
            way += here * saturate((clip_depth - depth_so_far) / max(depth, 1e-9));
            clipped = true;
            break;
        }
        way += here;
        depth_so_far += depth;
        journey_on(&j, face, origin, direction);
        if (j.ended != GOING) {
            break;
        }
    }
    rim = min(rim, rim_distance(j.cell.corners, j.wall, direction));
    var on_skin = j.ended == ON_SKIN;
    var end = j.t;
    var end_frame = data::frame_at(j.cell, j.place.xyz);

    let tier = tier_of(height_px);
    let steps = tier.steps / 16.0 * f32(coat.eye_steps);
    let mip = tier.mip;
    var jitter = 0.5;
    if (coat.jitter != 0u) {
        jitter = march_jitter(pixel_noise(in.position.xy), vb::globals.frame_count);
    }

    let f = lighting::fragment_of(vec4(origin, 1.0), entry.normal, in.position, in.instance);
    let s = light::surroundings_of(f);
    var march = march_begin();
    var half_height = entry.at.z;
    var openness = 0.0;
    var bent = vec3(0.0);
    j = journey_begin(in.start, origin, direction);
    var walked = 0.0;
    var next = 0u;
    let count = u32(ceil(clamp(steps, 1.0, 64.0)));
    // Where the mean coat is opaque but this ray has met a gap, it goes on as far again.
    let most = select(count, 2u * count, clipped);
    for (var i = 0u; i < MAX_CELLS; i++) {
        let face = journey_across(&j, direction);
        let here = (j.t - j.walk.t) / max(dot(j.cell.heights, 0.5 * (j.place.xyz + j.walk.place.xyz)), 1e-7);
        var step = step_of(next, count, steps, jitter);
        if (next < most && step.x * way <= walked + here) {
            let gradient = data::tile_gradient(j.cell);
            while (next < most && step.x * way <= walked + here) {
                let x = saturate((step.x * way - walked) / max(here, 1e-9));
                let p = place_of(j.cell, gradient, mix(j.walk.place, j.place, x), to_eye, height_px, mip);
                let extinction = data::extinction_at(light::root_of(p, p.at), p.level) * extinction_sine(dot(p.tangent, direction), p.spread);
                let depth = extinction * step.y * way;
                if (depth > 1e-4) {
                    let before = march.transmittance;
                    // The light is met where the step is seen, not in its middle.
                    var lit = p;
                    let slope = vec3(dot(p.grad_u, direction), dot(p.grad_v, direction), dot(p.normal, direction));
                    lit.at += slope * ((march_lit(depth) - jitter) * step.y * way);
                    lit.at.z = saturate(lit.at.z);
                    march = march_add(march, depth, light::coat_source(lit, s, tier.near), mix(j.walk.t, j.t, x));
                    if (before > 0.5 && march.transmittance <= 0.5) {
                        half_height = p.at.z;
                        if (coat.view == data::VIEW_SKY || coat.view == data::VIEW_BENT) {
                            let four = light::transfer_at(p);
                            openness = four.openness;
                            bent = four.bent;
                        }
                    }
                }
                next += 1u;
                step = step_of(next, count, steps, jitter);
                if (next == count && march.transmittance < GAP) {
                    next = most;
                }
            }
        }
        walked += here;
        journey_on(&j, face, origin, direction);
        if (j.ended != GOING || next >= most || march.transmittance < OPAQUE) {
            break;
        }
    }

    if (clipped && march.transmittance >= GAP && j.ended != GOING) {
        clipped = false;
        on_skin = j.ended == ON_SKIN;
        end = j.t;
        end_frame = data::frame_at(j.cell, j.place.xyz);
    }
    let seen = max(1.0 - march.transmittance, 1e-4);
    var color = march.radiance / seen;
    var alpha = 1.0;
    if (clipped) {
        // A gap in the coat, where its mean is opaque.
        alpha = saturate(4.0 * seen);
    } else if (on_skin) {
        color = march_over(march, light::skin_radiance(f, s, end_frame.normal));
    } else {
        // A coat thinner than a few pixels covers less of them.
        alpha = (1.0 - march.transmittance) * tier.rim;
        // By itself, one that misses the rim of the skin by less than a pixel stands for samples that do not.
        let graze = 1.0 - smoothstep(0.5 * NEAR_RIM, NEAR_RIM, pixels_of(rim, origin));
        if (graze > 0.0 && coat.own_depth != 0u) {
            color = mix(color, march_over(march, light::skin_radiance(f, s, end_frame.normal)), graze);
            alpha = max(alpha, graze);
        }
    }
    if (coat.shown < 1.0) {
        let painted = light::painted_radiance(f, s, entry_color, entry.normal, to_eye);
        color = mix(painted, color, coat.shown);
        alpha = mix(1.0, alpha, coat.shown);
    }
    color *= lighting::exposure();
    switch coat.view {
        case 1u: { color = strand_color(in.start >> 4u); }
        case 2u: { color = vec3(f32(cells) / 32.0); }
        case 3u: { color = vec3(half_height); }
        case 4u: { color = vec3(tier.near, tier.middle, tier.far); }
        case 5u: { color = vec3(1.0 - march.transmittance); }
        case 6u: { color = vec3(openness); }
        case 7u: { color = 0.5 + 2.0 * bent; }
        case 8u: { color = 0.5 + 0.5 * entry.normal; }
        case 9u: { color = fract(entry.at); }
        default: {}
    }

    var out: FragmentOutput;
#ifdef SAMPLE_COVERAGE
    out.samples = pattern::sample_mask(alpha, 0.5, 0u, #{UNDERCOAT_SAMPLES}u);
    if (out.samples == 0u) {
        discard;
    }
#else
    if (alpha < threshold) {
        discard;
    }
#endif
    out.color = lighting::finish(vec4(color, 1.0), vec4(origin, 1.0), in.position);
#ifndef UNDERCOAT_SUNK
    // Coats of neighboring tracts overlap, and end at the same place of the skin: the one that was entered further out is seen.
    let in_front = 0.05 * entry_height * (0.2 + 0.8 * entry.at.z);
    let depth_at = select(min(march_mean_distance(march), end), end - in_front, coat.own_depth == 0u);
    let clip = position_world_to_clip(origin + direction * depth_at);
    out.depth = clip.z / clip.w;
#endif
    return out;
}

#endif
