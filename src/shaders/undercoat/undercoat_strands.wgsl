// Single strands as ribbons that face the camera (docs/book/undercoat.md#strands). Roots ride on the shell's nodes.
#import bevy_pbr::{
    mesh_view_bindings as vb,
    view_transformations::position_world_to_clip,
}
#import bevy_plumage::down_light::{kajiya_kay_diffuse, kajiya_kay_specular, multiple_scattering, packed_color, sky_visibility}
#import bevy_plumage::down_strands::{
    StrandShape,
    strand_alpha,
    strand_curve,
    strand_point,
    strand_radius,
    strand_ribbon,
    strand_shadow,
    strand_side,
    strand_tangent,
}
#import bevy_plumage::feather_eye as eye
#import bevy_plumage::feather_lighting as lighting
#import bevy_plumage::feather_pattern as pattern

// Meanings and units: src/undercoat/material.rs.
struct StrandUniform {
    node_count: u32,
    prism_count: u32,
    color: vec3<f32>,
    radius: f32,
    tip_color: vec3<f32>,
    fade: f32,
    lean: f32,
    droop: f32,
    highlight_strength: f32,
    highlight_exponent: f32,
    column: array<vec4<f32>, 8>,
}

@group(#{MATERIAL_BIND_GROUP}) @binding(0) var<uniform> strands: StrandUniform;
@group(#{MATERIAL_BIND_GROUP}) @binding(1) var<storage, read> shell: array<vec4<u32>>;
@group(#{MATERIAL_BIND_GROUP}) @binding(2) var<storage, read> roots: array<vec4<u32>>;

const NODE_VEC4S: u32 = 3u;
const PRISM_VEC4S: u32 = 4u;
// Spread of the fibres of one strand: a little roughness.
const SPREAD: f32 = 0.15;

fn bits(index: u32) -> vec4<u32> {
    return shell[min(index, arrayLength(&shell) - 1u)];
}

fn word(index: u32) -> vec4<f32> {
    return bitcast<vec4<f32>>(bits(index));
}

struct VertexInput {
    @builtin(instance_index) instance: u32,
    // Strand; row, rows and side.
    @location(0) strand: vec2<u32>,
}

struct VertexOutput {
    @builtin(position) position: vec4<f32>,
    @location(0) world: vec3<f32>,
    @location(1) tangent: vec3<f32>,
    @location(2) normal: vec3<f32>,
    // Share of the length, opacity, height in the coat below, above 1 outside of it; random number of the strand.
    @location(3) along: vec4<f32>,
    @location(4) @interpolate(flat) instance: u32,
    @location(5) tint: vec3<f32>,
    @location(6) @interpolate(flat) strand: u32,
}

@vertex
fn vertex(in: VertexInput) -> VertexOutput {
    let root = roots[min(in.strand.x, arrayLength(&roots) - 1u)];
    let prism = NODE_VEC4S * strands.node_count + PRISM_VEC4S * min(root.x, strands.prism_count - 1u);
    let ids = NODE_VEC4S * min(bits(prism).xyz, vec3(strands.node_count - 1u));
    let first = unpack2x16unorm(root.y);
    let w = vec3(first, max(1.0 - first.x - first.y, 0.0));
    let bottom = mat3x4(word(ids.x), word(ids.y), word(ids.z)) * w;
    let top = mat3x4(word(ids.x + 1u), word(ids.y + 1u), word(ids.z + 1u)) * w;
    let a = bits(ids.x + 2u);
    let b = bits(ids.y + 2u);
    let c = bits(ids.z + 2u);
    let normal = normalize(top.xyz - bottom.xyz + vec3(0.0, 1e-12, 0.0));
    let along = mat3x3(bitcast<vec3<f32>>(a.xyz), bitcast<vec3<f32>>(b.xyz), bitcast<vec3<f32>>(c.xyz)) * w;
    var flat = along - normal * dot(along, normal);
    // Each strand for itself, a little to the side.
    let turn = (f32((root.w >> 8u) & 255u) / 127.5 - 1.0) * 0.5;
    flat = flat / max(length(flat), 1e-6);
    flat = select(normal, normalize(flat + cross(normal, flat) * turn), length(along) > 0.0);

    var shape: StrandShape;
    shape.root = bottom.xyz;
    shape.normal = normal;
    shape.lay = flat;
    shape.bend = strands.lean;
    shape.length = bitcast<f32>(root.z);
    shape.gravity = vec3(0.0, -1.0, 0.0);
    shape.sag = strands.droop;
    let curve = strand_curve(shape);
    let rows = max((in.strand.y >> 8u) & 255u, 1u);
    let s = f32(in.strand.y >> 16u) / f32(rows);
    let center = strand_point(curve, s);
    let tangent = strand_tangent(curve, s, normal);

    let clip = position_world_to_clip(center);
    let pixel = 2.0 * max(clip.w, 1e-6) / (vb::view.viewport.w * max(abs(vb::view.clip_from_view[1][1]), 1e-6));
    let ribbon = strand_ribbon(strand_radius(strands.radius, s), pixel);
    let view = eye::to_eye(center);
    let right = vb::view.world_from_view[0].xyz;
    let across = strand_side(tangent, view, right);
    let side = f32(in.strand.y & 1u) * 2.0 - 1.0;
    var out: VertexOutput;
    out.world = center + across * (side * ribbon.half_width);
    out.position = position_world_to_clip(out.world);
    out.tangent = tangent;
    out.normal = normal;
    let rise = dot(center - bottom.xyz, normal) / max(bottom.w, 1e-7);
    out.along = vec4(s, strand_alpha(strands.fade, s) * ribbon.coverage, rise, f32(root.w & 255u) / 255.0);
    out.instance = in.instance;
    out.tint = packed_color(a.w) * w.x + packed_color(b.w) * w.y + packed_color(c.w) * w.z;
    out.strand = pattern::hash(in.strand.x);
    return out;
}

fn column_above(height: f32) -> f32 {
    let x = clamp(height, 0.0, 1.0) * 31.0;
    let i = min(u32(x), 30u);
    return mix(strands.column[i / 4u][i % 4u], strands.column[(i + 1u) / 4u][(i + 1u) % 4u], x - f32(i));
}

struct FragmentOutput {
    @location(0) color: vec4<f32>,
#ifdef SAMPLE_COVERAGE
    @builtin(sample_mask) samples: u32,
#endif
}

@fragment
fn fragment(in: VertexOutput) -> FragmentOutput {
    var out: FragmentOutput;
    // Of strands thinner than a sample fewer are drawn, those whole: pixel by pixel they would fall into grains.
    let threshold = clamp(f32(pattern::hash(in.strand) >> 8u) / 16777216.0, 0.002, 0.998);
#ifdef SAMPLE_COVERAGE
    out.samples = pattern::sample_mask(in.along.y, threshold, in.strand, #{UNDERCOAT_SAMPLES}u);
    if (out.samples == 0u) {
        discard;
    }
#else
    if (in.along.y < threshold) {
        discard;
    }
#endif
    let s = in.along.x;
    let tangent = normalize(in.tangent);
    let normal = normalize(in.normal);
    let to_eye = eye::to_eye(in.world);
    let f = lighting::fragment_of(vec4(in.world, 1.0), normal, in.position, in.instance);
    let albedo = in.tint * mix(strands.color, strands.tip_color, s) * (0.85 + 0.3 * in.along.w);
    let eye_cosine = dot(tangent, to_eye);
    let column = column_above(in.along.z);
    let eye_mu = max(dot(normal, to_eye), 0.0);
    var sum = vec3(0.0);
    let lights = lighting::lights_of(f);
    for (var i = 0u; i < min(lights.count, 8u); i++) {
        let light = lighting::light_at(f, lights, i);
        let mu = dot(normal, light.direction);
        // Outside the coat a strand is lit from behind as well, as far as the body lets it.
        let reach = select(strand_shadow(column, mu), saturate(1.0 + 3.0 * mu), in.along.z >= 1.0);
        let cosine = dot(tangent, light.direction);
        let lobe = kajiya_kay_diffuse(albedo, cosine, SPREAD)
            + kajiya_kay_specular(strands.highlight_strength, strands.highlight_exponent, eye_cosine, cosine);
        sum += light.color * reach * lobe * multiple_scattering(eye_mu, max(mu, 0.0), albedo);
    }
    let sky = lighting::environment(f, normal, normal, 1.0).irradiance;
    sum += albedo * sky * (0.75 * sky_visibility(column)) * multiple_scattering(eye_mu, 0.5, albedo);
    out.color = lighting::finish(vec4(sum * lighting::exposure(), 1.0), vec4(in.world, 1.0), in.position);
    return out;
}
