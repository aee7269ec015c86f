//! A young macaw: down all over, the first feathers scattered in it. The groom is edited by code before the bird gets it.
//!
//! `cargo run --example chick -- --density 0.3`: `--down` names another coat, `--density` the share of feathers; F1 lists the keys.

mod helper;

use bevy::prelude::*;
use bevy_plumage::prelude::*;
use helper::{
    Args,
    camera::{Shots, shot},
    scene::{self, Perch},
};

/// Share of the grown bird's feathers that are there.
const FEATHERS: f32 = 0.04;
/// Their length relative to the grown bird's.
const LENGTH: f32 = 0.55;

const SHOTS: Shots = Shots {
    hero: shot([0.0, 0.16, 0.02], [0.95, 0.36, 1.0], 19.0),
    closeup: shot([0.0, 0.20, 0.05], [0.12, 0.26, 0.26], 24.0),
    macro_: shot([0.0, 0.12, 0.06], [0.04, 0.14, 0.16], 20.0),
    full: shot([0.0, 0.08, 0.0], [1.4, 0.2, 0.3], 17.0),
    back: shot([0.0, 0.08, -0.03], [-0.5, 0.4, -1.2], 19.0),
    head: None,
    far: shot([0.0, 0.05, 0.0], [2.6, 0.8, 3.4], 20.0),
};

fn main() -> AppExit {
    helper::run("chick", |app| {
        app.add_plugins(PlumagePlugins)
            .insert_resource(SHOTS)
            .add_systems(Startup, setup)
            .add_systems(Update, moult);
    })
}

/// The bird whose grown groom is on its way.
#[derive(Component)]
struct Young(Handle<Groom>);

fn setup(mut commands: Commands, assets: Res<AssetServer>, args: Res<Args>) {
    commands.spawn((
        scene::bird(&assets, "parrot", 0.0),
        // Its `Plumage` comes with the edited groom below.
        Young(assets.load("grooms/parrot.groom.ron")),
        UndercoatState::default(),
        PlumageState::default(),
        args.quality(FeatherTransparency::default()),
        args.condition(),
    ));
    commands.spawn(Perch(0.022, 0.8, 0.024));
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
        let share = args.density.unwrap_or(FEATHERS);
        for region in &mut groom.regions {
            if region.down.is_some() {
                region.down = Some(format!("downs/{down}.down.ron").into());
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
