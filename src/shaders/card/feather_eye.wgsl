// Where the eye is.
#define_import_path bevy_plumage::feather_eye
#import bevy_pbr::mesh_view_bindings::view

// Asked of the view where the pipeline does not know: in prepasses, and of projections of an app's own.
fn is_orthographic() -> bool {
#ifdef VIEW_PROJECTION_PERSPECTIVE
    return false;
#else ifdef VIEW_PROJECTION_ORTHOGRAPHIC
    return true;
#else
    return view.clip_from_view[3].w == 1.0;
#endif
}

// Direction from a place in the world.
fn to_eye(place: vec3<f32>) -> vec3<f32> {
    if (is_orthographic()) {
        return normalize(vec3(view.clip_from_world[0].z, view.clip_from_world[1].z, view.clip_from_world[2].z));
    }
    return normalize(view.world_position - place);
}
