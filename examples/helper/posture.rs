//! How a bird holds its head beside what its idle clip does: two birds of one clip are not alike.

use bevy::{
    app::AnimationSystems, prelude::*, transform::TransformSystems,
    world_serialization::WorldInstanceReady,
};

/// A turn of the head that is spread over the neck, degrees.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct Posture {
    /// To the left.
    pub yaw: f32,
    /// Downwards.
    pub pitch: f32,
    /// Its crown to the right.
    pub roll: f32,
}

/// Joints of the neck and the share of a turn that each takes.
const NECK: [(&str, f32); 5] = [
    ("neck1", 0.1),
    ("neck2", 0.15),
    ("neck3", 0.2),
    ("neck4", 0.25),
    ("head", 0.3),
];

/// What a joint is turned by after the clip has set it.
#[derive(Component)]
struct Turned {
    by: Quat,
    /// The rotation that was written last: a clip that leaves a joint alone does not turn it twice.
    written: Option<Quat>,
}

/// Turns the heads of birds with a [`Posture`].
pub struct PosturePlugin;

impl Plugin for PosturePlugin {
    fn build(&self, app: &mut App) {
        app.add_observer(find_neck).add_systems(
            PostUpdate,
            turn.after(AnimationSystems)
                .before(TransformSystems::Propagate),
        );
    }
}

fn find_neck(
    ready: On<WorldInstanceReady>,
    postures: Query<&Posture>,
    children: Query<&Children>,
    names: Query<&Name>,
    mut commands: Commands,
) {
    let Ok(posture) = postures.get(ready.entity) else {
        return;
    };
    for entity in children.iter_descendants(ready.entity) {
        let share = NECK
            .iter()
            .find(|(joint, _)| names.get(entity).is_ok_and(|name| name.as_str() == *joint));
        if let Some((_, share)) = share {
            let [yaw, pitch, roll] = [posture.yaw, posture.pitch, posture.roll]
                .map(|angle| (angle * share).to_radians());
            commands.entity(entity).insert(Turned {
                by: Quat::from_euler(EulerRot::YXZ, yaw, pitch, roll),
                written: None,
            });
        }
    }
}

fn turn(mut joints: Query<(&mut Transform, &mut Turned)>) {
    for (mut transform, mut turned) in &mut joints {
        if turned.written != Some(transform.rotation) {
            transform.rotation *= turned.by;
            turned.written = Some(transform.rotation);
        }
    }
}
