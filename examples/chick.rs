//! A young macaw: down all over, the first feathers scattered in it. `--down` takes another coat, `--density` the share of feathers.

mod helper;

use bevy::prelude::*;
use bevy_plumage::{groom::Groom, prelude::*};
use helper::{
    Args,
    camera::{Framing, Shots},
    scene,
};

/// Share of the grown bird's feathers that are there.
const FEATHERS: f32 = 0.04;
/// Their length relative to the grown bird's.
const LENGTH: f32 = 0.55;

fn main() {
    helper::run("chick", |app| {
        let shot = |target: [f32; 3], eye: [f32; 3], fov| Framing {
            target: Vec3::from(target),
            eye: Vec3::from(eye),
            fov,
        };
        app.insert_resource(Shots {
            hero: shot([0.0, 0.16, 0.02], [0.95, 0.36, 1.0], 19.0),
            closeup: shot([0.0, 0.20, 0.05], [0.12, 0.26, 0.26], 24.0),
            macro_: shot([0.0, 0.12, 0.06], [0.04, 0.14, 0.16], 20.0),
            full: shot([0.0, 0.08, 0.0], [1.4, 0.2, 0.3], 17.0),
            back: shot([0.0, 0.08, -0.03], [-0.5, 0.4, -1.2], 19.0),
            far: shot([0.0, 0.05, 0.0], [2.6, 0.8, 3.4], 20.0),
        })
        .add_systems(Startup, setup)
        .add_systems(Update, moult);
    });
}

/// The bird whose grown groom is on its way.
#[derive(Component)]
struct Young(Handle<Groom>);

fn setup(
    mut commands: Commands,
    assets: Res<AssetServer>,
    args: Res<Args>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let bird = scene::spawn_bird(
        &mut commands,
        &assets,
        &args,
        "parrot",
        1.0,
        args.seed,
        0.0,
        Transform::IDENTITY,
    );
    commands
        .entity(bird)
        .insert(Young(assets.load("grooms/parrot.groom.ron")))
        // Its plumage comes with the groom below.
        .remove::<Plumage>()
        .insert(UndercoatState::default());
    scene::spawn_perch(
        &mut commands,
        &mut meshes,
        &mut materials,
        0.022,
        0.8,
        Vec3::ZERO,
    );
}

/// Makes the grown bird's groom that of a young one.
fn moult(
    mut commands: Commands,
    young: Query<(Entity, &Young)>,
    args: Res<Args>,
    mut grooms: ResMut<Assets<Groom>>,
) {
    for (bird, young) in &young {
        let Some(mut groom) = grooms.get(&young.0).cloned() else {
            continue;
        };
        let down = args.down.as_deref().unwrap_or("chick");
        // Paths of a groom without a file begin at the assets.
        for path in &mut groom.feathers {
            *path = path.trim_start_matches("../").to_owned();
        }
        let share = args.density.unwrap_or(FEATHERS);
        for region in &mut groom.regions {
            if region.down.is_some() {
                region.down = Some(format!("downs/{down}.down.ron"));
                region.count = (region.count as f32 * share).round() as u32;
                region.length.0 *= LENGTH;
                region.length.1 *= LENGTH;
            }
        }
        for row in &mut groom.rows {
            for length in &mut row.lengths {
                *length *= LENGTH;
            }
        }
        let groom = grooms.add(groom);
        commands
            .entity(bird)
            .remove::<Young>()
            .insert(Plumage::new(groom).with_seed(args.seed));
    }
}
