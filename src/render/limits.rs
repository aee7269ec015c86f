//! What the device must offer, checked once.

use super::cut_out::FeatherPath;
use bevy::{
    prelude::*,
    render::{RenderApp, renderer::RenderDevice},
};

/// What the feather pipelines need of `wgpu::Limits`: name, least value.
///
/// A fragment stage binds the view's clusters (3), Bevy's transparency list (3), the mesh (1) and the feathers (1) as storage
/// buffers; a vertex stage the mesh, two skins, visibility ranges, cards, their classes and the wind (7).
const NEEDS: [(&str, u64); 5] = [
    ("max_storage_buffers_per_shader_stage", 8),
    ("max_bind_groups", 4),
    ("max_texture_array_layers", 64),
    ("max_compute_invocations_per_workgroup", 64),
    ("max_storage_buffer_binding_size", 1 << 24),
];

/// Decides how feathers are drawn; warns, by name, of every limit that is too low for the full way.
pub fn check(app: &mut App) {
    let wanted = app.world().get_resource::<FeatherPath>().copied();
    let Some(render_app) = app.get_sub_app(RenderApp) else {
        return;
    };
    let limits = render_app.world().get_resource::<RenderDevice>();
    let Some(limits) = limits.map(RenderDevice::limits) else {
        return;
    };
    let values = [
        u64::from(limits.max_storage_buffers_per_shader_stage),
        u64::from(limits.max_bind_groups),
        u64::from(limits.max_texture_array_layers),
        u64::from(limits.max_compute_invocations_per_workgroup),
        limits.max_storage_buffer_binding_size,
    ];
    let path = choose(&values, wanted.unwrap_or_default());
    app.insert_resource(path);
    if let Some(render_app) = app.get_sub_app_mut(RenderApp) {
        render_app.insert_resource(path);
    }
}

fn choose(values: &[u64; NEEDS.len()], wanted: FeatherPath) -> FeatherPath {
    let mut path = wanted;
    for ((name, least), value) in NEEDS.iter().zip(values) {
        if value < least {
            warn!(
                "bevy_plumage: the device's {name} is {value}, feathers need {least}: they are drawn as plain cut-out cards"
            );
            path = FeatherPath::CutOut;
        }
    }
    path
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_low_limit_means_cut_out_cards() {
        let enough = NEEDS.map(|(_, least)| least);
        assert_eq!(choose(&enough, FeatherPath::Full), FeatherPath::Full);
        assert_eq!(choose(&enough, FeatherPath::CutOut), FeatherPath::CutOut);
        for i in 0..NEEDS.len() {
            let mut values = enough;
            values[i] -= 1;
            assert_eq!(choose(&values, FeatherPath::Full), FeatherPath::CutOut);
        }
    }
}
