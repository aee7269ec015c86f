//! Which lights there are: the directional ones that cards of the class LIT find at their vertices, and whether there are lamps, whose
//! code the pipelines of most frames do without.

use bevy::{camera::visibility::RenderLayers, light::RectLight, prelude::*};
use std::array;

/// Directional lights that are followed.
pub const VERTEX_LIGHTS: usize = 2;

/// Lights of the world.
#[derive(Resource, Clone, Debug, Default, PartialEq)]
pub(super) struct WorldLights {
    /// The directional ones: unit vectors to them, and how bright they are, lux.
    suns: Vec<(Vec3, f32)>,
    /// Some of them are for some cameras only.
    layered: bool,
    /// There are point, spot or rectangle lights.
    lamps: bool,
}

impl WorldLights {
    /// Whether vertices can follow all of them.
    pub(super) fn are_followed(&self) -> bool {
        self.suns.len() <= VERTEX_LIGHTS && !self.layered && !self.lamps
    }

    /// Whether there are others than directional ones.
    pub(super) fn has_lamps(&self) -> bool {
        self.lamps
    }

    /// Direction of each that is followed, and its share of their light; where there is none, or none but dark ones, (up, 0).
    pub(super) fn rows(&self) -> [Vec4; VERTEX_LIGHTS] {
        let all: f32 = self.suns.iter().map(|(_, lux)| lux).sum();
        array::from_fn(|i| match self.suns.get(i) {
            Some((direction, lux)) if *lux > 0.0 => direction.extend(lux / all),
            _ => Vec4::Y,
        })
    }
}

/// What says that a light is for some cameras only.
type Layers = (With<RenderLayers>, With<DirectionalLight>);

/// Finds the lights of this frame.
pub(super) fn find_lights(
    mut found: ResMut<WorldLights>,
    suns: Query<(&GlobalTransform, &InheritedVisibility, &DirectionalLight)>,
    layered: Query<(), Layers>,
    lamps: Query<&InheritedVisibility, Or<(With<PointLight>, With<SpotLight>, With<RectLight>)>>,
) {
    let shining = suns.iter().filter(|(_, visible, _)| visible.get());
    let lux = |sun: &DirectionalLight| sun.illuminance * sun.color.luminance();
    found.set_if_neq(WorldLights {
        suns: shining
            .map(|(place, _, sun)| (*place.back(), lux(sun)))
            .collect(),
        layered: !layered.is_empty(),
        lamps: lamps.iter().any(|visible| visible.get()),
    });
}
