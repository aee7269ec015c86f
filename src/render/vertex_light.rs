//! The directional lights that cards of the class LIT find at their vertices.

use bevy::{camera::visibility::RenderLayers, light::RectLight, prelude::*};
use std::array;

/// Directional lights that are followed.
pub const VERTEX_LIGHTS: usize = 2;

/// Lights of the world, as far as vertices can be lit by them.
#[derive(Resource, Clone, Debug, Default, PartialEq)]
pub(super) struct VertexLights {
    /// Unit vectors to them.
    directions: Vec<Vec3>,
    /// There are others, of other kinds, or for some cameras only.
    others: bool,
}

impl VertexLights {
    /// Whether there are no other lights.
    pub(super) fn are_all(&self) -> bool {
        !self.others
    }

    /// (direction, 1) of each; where there is none, (up, 0).
    pub(super) fn rows(&self) -> [Vec4; VERTEX_LIGHTS] {
        array::from_fn(|i| {
            let direction = self.directions.get(i);
            direction.map_or(Vec4::Y, |direction| direction.extend(1.0))
        })
    }
}

/// What says that a light is for some cameras only.
type Layers = (With<RenderLayers>, With<DirectionalLight>);

/// Finds the lights of this frame.
pub(super) fn find_lights(
    mut found: ResMut<VertexLights>,
    suns: Query<(&GlobalTransform, &InheritedVisibility), With<DirectionalLight>>,
    layered: Query<(), Layers>,
    others: Query<&InheritedVisibility, Or<(With<PointLight>, With<SpotLight>, With<RectLight>)>>,
) {
    let shining = suns.iter().filter(|(_, visible)| visible.get());
    let directions: Vec<Vec3> = shining.map(|(place, _)| *place.back()).collect();
    let others = directions.len() > VERTEX_LIGHTS
        || !layered.is_empty()
        || others.iter().any(|visible| visible.get());
    found.set_if_neq(VertexLights { directions, others });
}
