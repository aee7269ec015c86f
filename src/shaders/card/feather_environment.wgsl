// Environment maps lit with samples of the fibres' own lobes (docs/book/scattering.md#sampling).
#define_import_path bevy_plumage::feather_environment
#import bevy_pbr::{clustered_forward, environment_map, lighting, mesh_view_bindings as vb}
#import bevy_plumage::{
    feather_lighting as feather_light,
    feather_pattern::{hash, pattern_threshold},
    feather_cover::Frame,
    feather_shadow::{Shadowing, light_ray, part_reach},
    scattering::{FibreShading, fibre_lit},
    scattering_sample::{fibre_sample, fibre_sampler},
    shadow::PartEye,
}

const SKY_PI: f32 = 3.14159265358979;
// Powers -1, -2, -3 of the generalised golden ratio of four dimensions.
const LATTICE: vec3<f32> = vec3(0.85667488, 0.73389185, 0.62870671);
// A lobe is a thin band: a footprint wider than this share of its width would leak out of it; never wider than this in radians.
const FOOTPRINT_SHARE: f32 = 0.7;
const WIDEST_FOOTPRINT: f32 = 0.2;

// Radiance from a direction, seen through a cone of a solid angle. Bevy's maps are filtered with GGX lobes whose perceptual
// roughness rises evenly from level to level; a lobe of roughness r has the solid angle 4 pi r^4.
fn sky(
    f: feather_light::Fragment,
    ranges: ptr<function, clustered_forward::ClusterableObjectIndexRanges>,
    direction: vec3<f32>,
    solid_angle: f32,
) -> vec3<f32> {
    var result = vb::lights.ambient_color.rgb;
#ifdef ENVIRONMENT_MAP
    var layer: lighting::LayerLightingInput;
    // With N = R the map is read in this very direction.
    layer.N = direction;
    layer.R = direction;
    layer.NdotV = 1.0;
    layer.perceptual_roughness = min(sqrt(sqrt(solid_angle / (4.0 * SKY_PI))), 1.0);
    layer.roughness = layer.perceptual_roughness * layer.perceptual_roughness;
    result += environment_map::compute_radiances(layer, ranges, f.position.xyz, true).radiance;
#endif
    return result;
}

// Four numbers that shift the lattice of a pixel.
fn lattice_shift(pixel: vec2<f32>) -> vec4<f32> {
    let p = vec2<u32>(pixel);
    let a = hash(p.x + hash(p.y));
    let b = hash(a);
    let c = hash(b);
    return vec4(pattern_threshold(pixel, 0u), vec3(f32(a >> 8u), f32(b >> 8u), f32(c >> 8u)) / 16777216.0);
}

// Light from all around that one component scatters to the eye. The component is chosen with `count` samples in all by its share
// `low..high` of the coverage; its lobe, direction and density come from the sampler.
fn sampled_environment(
    f: feather_light::Fragment,
    shading: FibreShading,
    tangent: vec2<f32>,
    frame: Frame,
    shadowing: Shadowing,
    part_seen: PartEye,
    part: u32,
    low: f32,
    high: f32,
    count: u32,
) -> vec3<f32> {
    let chooser = fibre_sampler(shading);
    let shift = lattice_shift(f.frag_coord.xy);
    let n = f32(count);
    let width = max(high - low, 1e-4);
    var ranges = clustered_forward::unpack_clusterable_object_index_ranges(f.cluster);
    var sum = vec3(0.0);
    let end = u32(clamp(ceil(high * n - shift.x), 0.0, n));
    for (var k = u32(clamp(ceil(low * n - shift.x), 0.0, n)); k < end; k++) {
        let u = vec4(clamp(((f32(k) + shift.x) / n - low) / width, 0.0, 1.0), fract(shift.yzw + f32(k) * LATTICE));
        let drawn = fibre_sample(shading, chooser, u);
        if (drawn.pdf <= 0.0) {
            continue;
        }
        let d = drawn.direction;
        let local = vec3(d.x * tangent + d.y * frame.hand * vec2(tangent.y, -tangent.x), d.z);
        let direction = local.x * frame.across + local.y * frame.along + local.z * frame.normal;
        let radius = min(FOOTPRINT_SHARE * drawn.width, WIDEST_FOOTPRINT);
        let footprint = min(1.0 / (n * width * drawn.pdf), SKY_PI * radius * radius);
        let reach = part_reach(shadowing, part_seen, light_ray(shadowing, local), part, drawn.lobes.turn);
        sum += fibre_lit(shading, drawn.lobes, reach) / drawn.pdf * sky(f, &ranges, direction, footprint);
    }
    return sum / (n * width);
}
