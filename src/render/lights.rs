//! Which lights there are: the directional ones that cards of the class LIT find at their vertices, and whether there are lamps, whose
//! code the pipelines of most frames do without.

use bevy::{camera::visibility::RenderLayers, light::RectLight, prelude::*};
use std::array;

/// Directional lights that are followed.
pub const VERTEX_LIGHTS: usize = 2;

/// Lights of the world.
#[derive(Resource, Clone, Debug, Default, PartialEq)]
pub(super) struct WorldLights {
    /// Unit vectors to the directional ones.
    directions: Vec<Vec3>,
    /// Some of them are for some cameras only.
    layered: bool,
    /// There are point, spot or rectangle lights.
    lamps: bool,
}

impl WorldLights {
    /// Whether vertices can follow all of them.
    pub(super) fn are_followed(&self) -> bool {
        self.directions.len() <= VERTEX_LIGHTS && !self.layered && !self.lamps
    }

    /// Whether there are others than directional ones.
    pub(super) fn has_lamps(&self) -> bool {
        self.lamps
    }

    /// (direction, 1) of each that is followed; where there is none, (up, 0).
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
    mut found: ResMut<WorldLights>,
    suns: Query<(&GlobalTransform, &InheritedVisibility), With<DirectionalLight>>,
    layered: Query<(), Layers>,
    lamps: Query<&InheritedVisibility, Or<(With<PointLight>, With<SpotLight>, With<RectLight>)>>,
) {
    let shining = suns.iter().filter(|(_, visible)| visible.get());
    found.set_if_neq(WorldLights {
        directions: shining.map(|(place, _)| *place.back()).collect(),
        layered: !layered.is_empty(),
        lamps: lamps.iter().any(|visible| visible.get()),
    });
}
