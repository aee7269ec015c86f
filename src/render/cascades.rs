//! Shadow maps that are spent on birds.

use bevy::{
    light::{CascadeShadowConfig, CascadeShadowConfigBuilder},
    prelude::*,
};

/// Nearest distance at which a fitted cascade begins, metres.
const NEAREST: f32 = 0.01;

/// One cascade of a directional light that holds a ball and little else, so that the texels of the shadow map lie where feathers throw
/// shadows on each other. `camera` is the camera's place in the world; `center` and `radius` (metres) are those of a ball round the birds
/// and what they sit on. What lies nearer than the ball or beyond it gets no shadow.
///
/// Bevy cuts cascades by depth before the camera: insert the result anew when the camera has come nearer or gone away by some per cent of
/// its distance. Where the ball lies behind the camera, or a value is not finite or not positive, Bevy's default is returned.
///
/// ```
/// # use bevy::{light::CascadeShadowConfig, prelude::*};
/// # use bevy_plumage::fit_cascades;
/// # #[derive(Component)] struct Bird;
/// fn fit(
///     camera: Single<&GlobalTransform, With<Camera3d>>,
///     bird: Single<&GlobalTransform, With<Bird>>,
///     mut sun: Single<&mut CascadeShadowConfig, With<DirectionalLight>>,
/// ) {
///     **sun = fit_cascades(&camera, bird.translation(), 0.6);
/// }
/// ```
pub fn fit_cascades(camera: &GlobalTransform, center: Vec3, radius: f32) -> CascadeShadowConfig {
    let depth = (center - camera.translation()).dot(*camera.forward());
    let far = depth + radius;
    if !(radius > 0.0 && far > NEAREST && far.is_finite()) {
        return CascadeShadowConfig::default();
    }
    CascadeShadowConfigBuilder {
        num_cascades: 1,
        minimum_distance: (depth - radius).clamp(NEAREST, far),
        maximum_distance: far.max(2.0 * NEAREST),
        ..default()
    }
    .build()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cascade_holds_the_ball_and_ends_behind_it() {
        let camera =
            GlobalTransform::from(Transform::from_xyz(0.0, 1.0, 4.0).looking_at(Vec3::Y, Vec3::Y));
        // Depth counts along the view, not the way to the ball.
        let fitted = fit_cascades(&camera, Vec3::new(2.0, 1.0, 1.0), 0.5);
        assert_eq!(fitted.bounds.len(), 1);
        assert!((fitted.minimum_distance - 2.5).abs() < 1e-5, "{fitted:?}");
        assert!((fitted.bounds[0] - 3.5).abs() < 1e-5, "{fitted:?}");
        // Around the camera it begins at once.
        let near = fit_cascades(&camera, camera.translation(), 0.5);
        assert!((near.minimum_distance - NEAREST).abs() < 1e-6 && near.bounds[0] > NEAREST);
    }

    #[test]
    fn what_cannot_be_held_gets_the_default() {
        let camera = GlobalTransform::IDENTITY;
        let usual = CascadeShadowConfig::default();
        for (center, radius) in [
            (Vec3::Z * 5.0, 1.0),
            (Vec3::NEG_Z * 5.0, 0.0),
            (Vec3::NEG_Z * 5.0, -1.0),
            (Vec3::NEG_Z * 5.0, f32::NAN),
            (Vec3::NAN, 1.0),
            (Vec3::NEG_Z * f32::INFINITY, 1.0),
            (Vec3::NEG_Z, f32::INFINITY),
        ] {
            let found = fit_cascades(&camera, center, radius);
            assert_eq!(found.bounds, usual.bounds, "{center} {radius}");
        }
    }
}
