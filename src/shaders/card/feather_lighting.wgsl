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
    shadows,
}
#import bevy_plumage::feather_view as around
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
    return f;
}

fn is_orthographic() -> bool { return vb::view.clip_from_view[3].w == 1.0; }

fn to_eye(world_position: vec4<f32>) -> vec3<f32> {
    return pbr_functions::calculate_view(world_position, is_orthographic());
}

// A sheet is lit from either side: the shadow is looked up on the side of the light.
fn lit_side(f: Fragment, direction: vec3<f32>) -> vec3<f32> {
    return select(-f.normal, f.normal, dot(f.normal, direction) >= 0.0);
}

fn directional_count() -> u32 { return vb::lights.n_directional_lights; }

fn directional_light(f: Fragment, index: u32) -> Light {
    let source = &vb::lights.directional_lights[index];
    var light: Light;
    light.direction = (*source).direction_to_light;
    var shadow = 1.0;
    if (f.receives_shadow && ((*source).flags & mesh_view_types::DIRECTIONAL_LIGHT_FLAGS_SHADOWS_ENABLED_BIT) != 0u) {
        shadow = shadows::fetch_directional_shadow(index, f.position, lit_side(f, light.direction), f.view_z, f.frag_coord.xy);
    }
    let near = f.receives_shadow && ((*source).flags & mesh_view_types::DIRECTIONAL_LIGHT_FLAGS_CONTACT_SHADOWS_ENABLED_BIT) != 0u;
    shadow *= around::contact_shadow(f.position.xyz, f.frag_coord.xy, light.direction, near && shadow > 0.0);
    light.color = (*source).color.rgb * shadow
        * around::atmosphere_transmittance(f.position.xyz, light.direction, (*source).sun_disk_angular_size);
    return light;
}

// First point light, first spot light, end: indices for clustered_light.
fn clustered_range(f: Fragment) -> vec3<u32> {
    let cluster = clustered_forward::view_fragment_cluster_index(f.frag_coord.xy, f.view_z, is_orthographic());
    let ranges = clustered_forward::unpack_clusterable_object_index_ranges(cluster);
    return vec3(
        ranges.first_point_light_index_offset,
        ranges.first_spot_light_index_offset,
        ranges.first_reflection_probe_index_offset,
    );
}

fn clustered_light(f: Fragment, index: u32, is_spot: bool) -> Light {
    let id = clustered_forward::get_clusterable_object_id(index);
    let source = &vb::clustered_lights.data[id];
    let offset = (*source).position_radius.xyz - f.position.xyz;
    let distance_square = max(dot(offset, offset), 1e-8);
    var light: Light;
    light.direction = offset * inverseSqrt(distance_square);
    var attenuation = lighting::getDistanceAttenuation(distance_square, (*source).color_inverse_square_range.w);
    let shadowed = f.receives_shadow && ((*source).flags & mesh_view_types::POINT_LIGHT_FLAGS_SHADOWS_ENABLED_BIT) != 0u;
    if (is_spot) {
        var axis = vec3((*source).light_custom_data.x, 0.0, (*source).light_custom_data.y);
        axis.y = sqrt(max(0.0, 1.0 - dot(axis.xz, axis.xz)));
        if (((*source).flags & mesh_view_types::POINT_LIGHT_FLAGS_SPOT_LIGHT_Y_NEGATIVE) != 0u) {
            axis.y = -axis.y;
        }
        let cone = saturate(dot(-axis, light.direction) * (*source).light_custom_data.z + (*source).light_custom_data.w);
        attenuation *= cone * cone;
        if (shadowed) {
            attenuation *= shadows::fetch_spot_shadow(id, f.position, lit_side(f, light.direction), (*source).shadow_map_near_z, f.frag_coord.xy);
        }
    } else if (shadowed) {
        attenuation *= shadows::fetch_point_shadow(id, f.position, lit_side(f, light.direction), f.frag_coord.xy);
    }
    let near = f.receives_shadow && ((*source).flags & mesh_view_types::POINT_LIGHT_FLAGS_CONTACT_SHADOWS_ENABLED_BIT) != 0u;
    attenuation *= around::contact_shadow(f.position.xyz, f.frag_coord.xy, light.direction, near && attenuation > 0.0);
    light.color = (*source).color_inverse_square_range.rgb * attenuation;
    return light;
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
    lights.clustered = clustered_range(f);
    lights.single = lights.directional + lights.clustered.z - min(lights.clustered.x, lights.clustered.z);
    lights.count = lights.single + around::rect_count();
    return lights;
}

fn light_at(f: Fragment, lights: Lights, index: u32) -> Light {
    if (index < lights.directional) {
        return directional_light(f, index);
    }
    if (index >= lights.single) {
        let found = around::rect_sample(f.position.xyz, index - lights.single);
        return Light(found.direction, found.irradiance);
    }
    let at = lights.clustered.x + index - lights.directional;
    return clustered_light(f, at, at >= lights.clustered.y);
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
    let cluster = clustered_forward::view_fragment_cluster_index(f.frag_coord.xy, f.view_z, is_orthographic());
    var ranges = clustered_forward::unpack_clusterable_object_index_ranges(cluster);
    let found = environment_map::compute_radiances(layer, &ranges, f.position.xyz, false);
    result.irradiance = found.irradiance;
    result.radiance = found.radiance;
#endif
    let here = clustered_forward::view_fragment_cluster_index(f.frag_coord.xy, f.view_z, is_orthographic());
    result.irradiance = around::surrounding_irradiance(result.irradiance, f.position.xyz, normal, here);
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
