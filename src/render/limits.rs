//! What the device must offer, checked once, and how feathers are drawn accordingly.

use bevy::{
    prelude::*,
    render::{RenderApp, renderer::RenderDevice},
};

/// How feathers are drawn, see [`FeatherRenderPlugin::path`](super::FeatherRenderPlugin::path).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
#[reflect(Default, PartialEq)]
#[non_exhaustive]
pub enum FeatherPath {
    /// Barbs, barbules and fibre scattering; [`Self::Fallback`] on devices whose limits are too low for that.
    #[default]
    Full,
    /// A textured card cut out at the feather's contour, with Bevy's `StandardMaterial`.
    Fallback,
}

/// How feathers are drawn in this app, by what was asked for and by the device's limits. Decided once, in `App::finish`.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Eq)]
pub struct ActiveFeatherPath(FeatherPath);

impl ActiveFeatherPath {
    /// The path taken.
    pub fn get(self) -> FeatherPath {
        self.0
    }
}

/// Run condition: barbs and barbules are drawn.
pub(super) fn path_is_full(path: Option<Res<ActiveFeatherPath>>) -> bool {
    path.is_some_and(|path| path.get() == FeatherPath::Full)
}

/// What the feather pipelines need of `wgpu::Limits`: name, least value.
///
/// A fragment stage binds the view's clusters (3), Bevy's transparency list (3), the mesh (1) and the feathers (1) as storage
/// buffers; a vertex stage the mesh, two skins, visibility ranges, cards, their classes and the wind (7), and
/// hands on up to 16 variables where it finds light.
const NEEDS: [(&str, u64); 6] = [
    ("max_storage_buffers_per_shader_stage", 8),
    ("max_bind_groups", 4),
    ("max_texture_array_layers", 64),
    ("max_compute_invocations_per_workgroup", 64),
    ("max_storage_buffer_binding_size", 1 << 24),
    ("max_inter_stage_shader_variables", 16),
];

/// Decides how feathers are drawn; warns, by name, of every limit that is too low for the full path.
pub fn decide(app: &mut App, wanted: FeatherPath) -> FeatherPath {
    let render_app = app.get_sub_app(RenderApp);
    let device = render_app.and_then(|app| app.world().get_resource::<RenderDevice>());
    let path = device.map_or(wanted, |device| {
        let limits = device.limits();
        let values = [
            u64::from(limits.max_storage_buffers_per_shader_stage),
            u64::from(limits.max_bind_groups),
            u64::from(limits.max_texture_array_layers),
            u64::from(limits.max_compute_invocations_per_workgroup),
            limits.max_storage_buffer_binding_size,
            u64::from(limits.max_inter_stage_shader_variables),
        ];
        choose(&values, wanted)
    });
    app.insert_resource(ActiveFeatherPath(path));
    if let Some(render_app) = app.get_sub_app_mut(RenderApp) {
        render_app.insert_resource(ActiveFeatherPath(path));
    }
    path
}

fn choose(values: &[u64; NEEDS.len()], wanted: FeatherPath) -> FeatherPath {
    let mut path = wanted;
    for ((name, least), value) in NEEDS.iter().zip(values) {
        if value < least {
            warn!(
                "bevy_plumage: the device's {name} is {value}, feathers need {least}: they are drawn as plain cut-out cards"
            );
            path = FeatherPath::Fallback;
        }
    }
    path
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_low_limit_means_the_fallback() {
        let enough = NEEDS.map(|(_, least)| least);
        assert_eq!(choose(&enough, FeatherPath::Full), FeatherPath::Full);
        assert_eq!(
            choose(&enough, FeatherPath::Fallback),
            FeatherPath::Fallback
        );
        for i in 0..NEEDS.len() {
            let mut values = enough;
            values[i] -= 1;
            assert_eq!(choose(&values, FeatherPath::Full), FeatherPath::Fallback);
        }
    }
}
