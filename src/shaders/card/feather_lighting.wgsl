// The thin layer that talks to Bevy's lights: every import from bevy_pbr that shading needs is listed here.
#define_import_path bevy_plumage::feather_lighting
#import bevy_pbr::{
    clustered_forward,
    environment_map,
    lighting,
    mesh_bindings::mesh,
    mesh_types::MESH_FLAGS_SHADOW_RECEIVER_BIT,
    mesh_view_bindings as vb,
    mesh_view_types,
    pbr_functions,
    shadow_sampling::{SPOT_SHADOW_TEXEL_SIZE, sample_shadow_map, sample_shadow_map_pcss},
    shadows,
}
#import bevy_render::maths::orthonormalize
#import bevy_plumage::{feather_eye::is_orthographic, feather_view as around}
#ifdef TONEMAP_IN_SHADER
#import bevy_core_pipeline::tonemapping::tone_mapping
#endif

// One light as a fragment sees it.
struct Light {
    // Unit vector to the light.
    direction: vec3<f32>,
    // Irradiance on a surface facing it, shadow included.
    color: vec3<f32>,
}

// Everything that the loop over lights needs to know of the fragment.
struct Fragment {
    position: vec4<f32>,
    normal: vec3<f32>,
    frag_coord: vec4<f32>,
    view_z: f32,
    receives_shadow: bool,
    // Of Bevy's clustered lights and probes.
    cluster: u32,
}

fn fragment_of(world_position: vec4<f32>, normal: vec3<f32>, frag_coord: vec4<f32>, instance: u32) -> Fragment {
    var f: Fragment;
    f.position = world_position;
    f.normal = normal;
    f.frag_coord = frag_coord;
    f.view_z = dot(vec4(
        vb::view.view_from_world[0].z,
        vb::view.view_from_world[1].z,
        vb::view.view_from_world[2].z,
        vb::view.view_from_world[3].z,
    ), world_position);
    f.receives_shadow = (mesh[instance].flags & MESH_FLAGS_SHADOW_RECEIVER_BIT) != 0u;
    f.cluster = clustered_forward::view_fragment_cluster_index(frag_coord.xy, f.view_z, is_orthographic());
    return f;
}

// A sheet is lit from either side: the shadow is looked up on the side of the light.
fn lit_side(f: Fragment, direction: vec3<f32>) -> vec3<f32> {
    return select(-f.normal, f.normal, dot(f.normal, direction) >= 0.0);
}

// What a light does to a fragment, all but the shadow maps that directional and spot lights look into: one filter serves both.
struct Source {
    light: Light,
    // To shade by contact.
    near: bool,
    // The map of the fragment's cascade or of the spot light, how many there are to look into, and the share of the second.
    first: u32,
    maps: u32,
    share: f32,
}

fn directional_count() -> u32 { return vb::lights.n_directional_lights; }

fn directional_source(f: Fragment, index: u32) -> Source {
    let source = &vb::lights.directional_lights[index];
    let direction = (*source).direction_to_light;
    let seen = around::atmosphere_transmittance(f.position.xyz, direction, (*source).sun_disk_angular_size);
    let near = f.receives_shadow && ((*source).flags & mesh_view_types::DIRECTIONAL_LIGHT_FLAGS_CONTACT_SHADOWS_ENABLED_BIT) != 0u;
    var found = Source(Light(direction, (*source).color.rgb * seen), near, 0u, 0u, 0.0);
    if (f.receives_shadow && ((*source).flags & mesh_view_types::DIRECTIONAL_LIGHT_FLAGS_SHADOWS_ENABLED_BIT) != 0u) {
        found.first = shadows::get_cascade_index(index, f.view_z);
        found.maps = min((*source).num_cascades - found.first, 1u);
        if (found.first + 1u < (*source).num_cascades) {
            // Where cascades overlap, both.
            let bound = (*source).cascades[found.first].far_bound;
            let overlap = (*source).cascades_overlap_proportion * bound;
            let beyond = -f.view_z - (bound - overlap);
            if (beyond >= 0.0) {
                found.maps = 2u;
                found.share = beyond / overlap;
            }
        }
    }
    return found;
}

// First point light, first spot light, end: indices for clustered_source.
fn clustered_range(f: Fragment) -> vec3<u32> {
    let ranges = clustered_forward::unpack_clusterable_object_index_ranges(f.cluster);
    return vec3(
        ranges.first_point_light_index_offset,
        ranges.first_spot_light_index_offset,
        ranges.first_reflection_probe_index_offset,
    );
}

// Along a spot light.
fn spot_axis(id: u32) -> vec3<f32> {
    let source = &vb::clustered_lights.data[id];
    let flat = (*source).light_custom_data.xy;
    let y = sqrt(max(0.0, 1.0 - dot(flat, flat)));
    let down = ((*source).flags & mesh_view_types::POINT_LIGHT_FLAGS_SPOT_LIGHT_Y_NEGATIVE) != 0u;
    return vec3(flat.x, select(y, -y, down), flat.y);
}

fn clustered_source(f: Fragment, index: u32, is_spot: bool) -> Source {
    let id = clustered_forward::get_clusterable_object_id(index);
    let source = &vb::clustered_lights.data[id];
    let offset = (*source).position_radius.xyz - f.position.xyz;
    let distance_square = max(dot(offset, offset), 1e-8);
    let direction = offset * inverseSqrt(distance_square);
    var attenuation = lighting::getDistanceAttenuation(distance_square, (*source).color_inverse_square_range.w);
    let shadowed = f.receives_shadow && ((*source).flags & mesh_view_types::POINT_LIGHT_FLAGS_SHADOWS_ENABLED_BIT) != 0u;
    if (is_spot) {
        let cone = saturate(dot(-spot_axis(id), direction) * (*source).light_custom_data.z + (*source).light_custom_data.w);
        attenuation *= cone * cone;
    } else if (shadowed) {
        attenuation *= shadows::fetch_point_shadow(id, f.position, lit_side(f, direction), f.frag_coord.xy);
    }
    let near = f.receives_shadow && ((*source).flags & mesh_view_types::POINT_LIGHT_FLAGS_CONTACT_SHADOWS_ENABLED_BIT) != 0u;
    let light = Light(direction, (*source).color_inverse_square_range.rgb * attenuation);
    return Source(light, near && attenuation > 0.0, id, select(0u, 1u, is_spot && shadowed), 0.0);
}

// Where a light looks into a map: place and depth, layer, size of a texel, size of the light.
struct MapPlace {
    uv: vec2<f32>,
    depth: f32,
    layer: i32,
    texel: f32,
    softness: f32,
    // Within the map.
    inside: bool,
}

fn cascade_place(f: Fragment, index: u32, cascade: u32, normal: vec3<f32>) -> MapPlace {
    let source = &vb::lights.directional_lights[index];
    let texel = (*source).cascades[cascade].texel_size;
    let offset = normal * ((*source).shadow_normal_bias * texel) + (*source).direction_to_light * (*source).shadow_depth_bias;
    let there = shadows::world_to_directional_light_local(index, cascade, vec4(f.position.xyz + offset, f.position.w));
    let layer = i32((*source).depth_texture_base_index + cascade);
    return MapPlace(there.xy, there.z, layer, texel, (*source).soft_shadow_size, there.w != 0.0);
}

// As Bevy's fetch_spot_shadow.
fn spot_place(f: Fragment, id: u32, direction: vec3<f32>, normal: vec3<f32>) -> MapPlace {
    let source = &vb::clustered_lights.data[id];
    let offset = (*source).position_radius.xyz - f.position.xyz;
    let back = -spot_axis(id);
    let moved = direction * (*source).shadow_depth_bias + normal * ((*source).shadow_normal_bias * dot(back, offset)) - offset;
    let there = moved * orthonormalize(back);
    let uv = there.xy * vec2(-0.5, 0.5) / ((*source).spot_light_tan_angle * there.z) + 0.5;
    let layer = i32(id) + vb::lights.spot_light_shadowmap_offset;
    return MapPlace(uv, -(*source).shadow_map_near_z / there.z, layer, SPOT_SHADOW_TEXEL_SIZE, (*source).soft_shadow_size, true);
}

// Share of a light that a map lets through at a place within it.
fn filtered(f: Fragment, place: MapPlace) -> f32 {
#ifdef PCSS_SAMPLERS_AVAILABLE
    // Without them no light has a size.
    if (place.softness > 0.0) {
        return sample_shadow_map_pcss(place.uv, place.depth, place.layer, f.frag_coord.xy, place.texel, place.softness);
    }
#endif
    return sample_shadow_map(place.uv, place.depth, place.layer, f.frag_coord.xy, place.texel);
}

// Share of a light that the maps of a source let through.
fn map_shadow(f: Fragment, source: Source, directional: bool, index: u32) -> f32 {
    let normal = lit_side(f, source.light.direction);
    var open = 1.0;
    // In a loop, or the shader holds the filter for every map.
    for (var i = 0u; i < source.maps; i++) {
        var place: MapPlace;
        if (directional) {
            place = cascade_place(f, index, source.first + i, normal);
        } else {
            place = spot_place(f, source.first, source.light.direction, normal);
        }
        var here = 1.0;
        if (place.inside) {
            here = filtered(f, place);
        }
        open = mix(open, here, select(source.share, 1.0, i == 0u));
    }
    return open;
}

// Lights of every kind under one index.
struct Lights {
    directional: u32,
    // First point light, first spot light, end.
    clustered: vec3<u32>,
    // Directional and clustered ones; rectangles follow.
    single: u32,
    count: u32,
}

fn lights_of(f: Fragment) -> Lights {
    var lights: Lights;
    lights.directional = directional_count();
#ifdef UNDER_SUNS
    lights.single = lights.directional;
    lights.count = lights.directional;
#else
    lights.clustered = clustered_range(f);
    lights.single = lights.directional + lights.clustered.z - min(lights.clustered.x, lights.clustered.z);
    lights.count = lights.single + around::rect_count();
#endif
    return lights;
}

fn light_at(f: Fragment, lights: Lights, index: u32) -> Light {
#ifdef UNDER_SUNS
    let directional = true;
    let source = directional_source(f, index);
#else
    if (index >= lights.single) {
        let found = around::rect_sample(f.position.xyz, index - lights.single);
        return Light(found.direction, found.irradiance);
    }
    let directional = index < lights.directional;
    var source = Source();
    if (directional) {
        source = directional_source(f, index);
    } else {
        let at = lights.clustered.x + index - lights.directional;
        source = clustered_source(f, at, at >= lights.clustered.y);
    }
#endif
    let direction = source.light.direction;
    let open = map_shadow(f, source, directional, index);
    let close = around::contact_shadow(f.position.xyz, f.frag_coord.xy, direction, source.near && open > 0.0);
    return Light(direction, source.light.color * (open * close));
}

// Prefiltered environment: irradiance over pi for `normal`, radiance around `direction` blurred by `roughness`.
struct Environment {
    irradiance: vec3<f32>,
    radiance: vec3<f32>,
}

fn environment(f: Fragment, normal: vec3<f32>, direction: vec3<f32>, roughness: f32) -> Environment {
    var result: Environment;
#ifdef ENVIRONMENT_MAP
    var layer: lighting::LayerLightingInput;
    layer.N = normal;
    layer.R = direction;
    layer.NdotV = 1.0;
    layer.perceptual_roughness = roughness;
    layer.roughness = roughness * roughness;
    var ranges = clustered_forward::unpack_clusterable_object_index_ranges(f.cluster);
    let found = environment_map::compute_radiances(layer, &ranges, f.position.xyz, false);
    result.irradiance = found.irradiance;
    result.radiance = found.radiance;
#endif
    result.irradiance = around::surrounding_irradiance(result.irradiance, f.position.xyz, normal, f.cluster);
    // Bevy's flat ambient light, in the same unit.
    result.irradiance += vb::lights.ambient_color.rgb;
    result.radiance += vb::lights.ambient_color.rgb;
    let open = around::open_share(f.frag_coord.xy);
    result.irradiance *= open;
    result.radiance *= open;
    return result;
}

fn exposure() -> f32 { return vb::view.exposure; }

// Fog, and the tone mapping of cameras without HDR.
fn finish(color: vec4<f32>, world_position: vec4<f32>, frag_coord: vec4<f32>) -> vec4<f32> {
    var out = color;
#ifdef DISTANCE_FOG
    out = pbr_functions::apply_fog(vb::fog, out, world_position.xyz, vb::view.world_position.xyz, frag_coord.xy);
#endif
#ifdef TONEMAP_IN_SHADER
    out = tone_mapping(out, vb::view.color_grading);
#endif
    return out;
}
