// What else Bevy's view knows of light: rectangles, contact shadows, screen-space occlusion, irradiance volumes, atmosphere.
#define_import_path bevy_plumage::feather_view
#import bevy_pbr::{
    clustered_forward,
    lighting,
    mesh_view_bindings as vb,
    mesh_view_types,
}
#ifdef CONTACT_SHADOWS
#import bevy_pbr::pbr_functions::calculate_contact_shadow
#endif
#ifdef IRRADIANCE_VOLUME
#import bevy_pbr::irradiance_volume::irradiance_volume_light
#endif
#ifdef ATMOSPHERE
#import bevy_pbr::atmosphere::functions::{calculate_visible_sun_ratio, clamp_to_surface}
#import bevy_pbr::lighting::sample_transmittance_lut
#endif

// A rectangle counts as this many small lights.
const RECT_SAMPLES: u32 = 4u;

fn rect_count() -> u32 { return RECT_SAMPLES * vb::lights.n_rect_lights; }

struct RectSample {
    direction: vec3<f32>,
    irradiance: vec3<f32>,
}

// One of the four quarters of a rectangle, as a point at its middle.
fn rect_sample(position: vec3<f32>, index: u32) -> RectSample {
    let source = &vb::lights.rect_lights[index / RECT_SAMPLES];
    let quarter = index % RECT_SAMPLES;
    let place = 0.25 * vec2(select(-1.0, 1.0, (quarter & 1u) != 0u), select(-1.0, 1.0, (quarter & 2u) != 0u));
    let center = (*source).position + (*source).right * ((*source).width * place.x) + (*source).up * ((*source).height * place.y);
    let offset = center - position;
    let area = 0.25 * (*source).width * (*source).height;
    let distance_square = max(dot(offset, offset), 1e-8);
    var sample: RectSample;
    sample.direction = offset * inverseSqrt(distance_square);
    let facing = max(-dot(cross((*source).up, (*source).right), sample.direction), 0.0);
    let to_middle = (*source).position - position;
    let falloff = lighting::getRangeFalloff(dot(to_middle, to_middle), 1.0 / max((*source).range * (*source).range, 1e-4));
    // The solid angle of the quarter, at most a quarter of the half space.
    let solid = min(area * facing / distance_square, 1.5707963);
    sample.irradiance = (*source).color.rgb * (solid * falloff);
    return sample;
}

// Shadow of what is close, found by a march through the depth prepass. `wanted`: flag of the light.
fn contact_shadow(position: vec3<f32>, frag_coord: vec2<f32>, direction: vec3<f32>, wanted: bool) -> f32 {
#ifdef CONTACT_SHADOWS
#ifdef DEPTH_PREPASS
    let steps = vb::contact_shadows_settings.linear_steps;
    if (wanted && steps > 0u) {
        return calculate_contact_shadow(position, frag_coord, direction, steps);
    }
#endif
#endif
    return 1.0;
}

// Share of a directional light that the atmosphere lets through.
fn atmosphere_transmittance(position: vec3<f32>, direction: vec3<f32>, sun_disk_angular_size: f32) -> vec3<f32> {
#ifdef ATMOSPHERE
    let place = clamp_to_surface(vb::atmosphere, (vb::atmosphere.world_to_atmosphere * vec4(position, 1.0)).xyz);
    let radius = length(place);
    let mu = dot(direction, place / max(radius, 1e-3));
    return sample_transmittance_lut(radius, mu) * calculate_visible_sun_ratio(vb::atmosphere, radius, mu, sun_disk_angular_size);
#else
    return vec3(1.0);
#endif
}

// Share of the surroundings' light that screen-space ambient occlusion leaves.
fn open_share(frag_coord: vec2<f32>) -> f32 {
#ifdef SCREEN_SPACE_AMBIENT_OCCLUSION
    return textureLoad(vb::screen_space_ambient_occlusion_texture, vec2<i32>(frag_coord), 0i).r;
#else
    return 1.0;
#endif
}

// Irradiance over pi for `normal`: of the irradiance volume where there is one, else `environment`.
fn surrounding_irradiance(environment: vec3<f32>, position: vec3<f32>, normal: vec3<f32>, cluster: u32) -> vec3<f32> {
#ifdef IRRADIANCE_VOLUME
    var ranges = clustered_forward::unpack_clusterable_object_index_ranges(cluster);
    let volume = irradiance_volume_light(position, normal, &ranges);
    return select(environment, volume, any(volume > vec3(0.0)));
#else
    return environment;
#endif
}
