//! What a frame costs over the number of feathers, the size of the picture, the number of lights, and with other settings: feathers
//! beside the same cards in a `StandardMaterial`, in one run.

use super::{
    cost::{SETTLE, clock, least, seconds},
    headless::{Apps, frame, regrow, resize},
};
use bevy::{core_pipeline::prepass::DepthPrepass, prelude::*};
use bevy_plumage::{PlumageCards, prelude::*};
use std::{f32::consts::TAU, fmt::Write, fs, path::Path};

/// Pictures.
const SIZES: [(u32, u32); 5] = [(120, 68), (240, 135), (480, 270), (960, 540), (1920, 1080)];
/// Lights: the sun, and point lights around.
const LIGHTS: [usize; 3] = [1, 4, 16];
/// Feathers of all birds together.
const COUNTS: [f32; 5] = [625.0, 2500.0, 6250.0, 25_000.0, 62_500.0];
/// Frames of each app, in turn; the fastest counts.
const ROUNDS: usize = 3;

/// A way to draw the birds of an app.
#[derive(Clone, Copy)]
struct Choice {
    quality: FeatherQuality,
    depth_first: bool,
}

/// What the table compares.
fn choices() -> Vec<(&'static str, Choice)> {
    let choice = |transparency, depth_first, change: fn(&mut FeatherSettings)| {
        let mut quality = FeatherQuality {
            transparency,
            ..default()
        };
        change(&mut quality.settings);
        Choice {
            quality,
            depth_first,
        }
    };
    let samples =
        |depth_first, change| choice(FeatherTransparency::AlphaToCoverage, depth_first, change);
    let hashed = |depth_first| choice(FeatherTransparency::Hashed, depth_first, |_| ());
    let lit = |own: &mut FeatherSettings| own.light_budget = 0.0;
    vec![
        ("4 samples", samples(false, |_| ())),
        ("4 samples; all light in fragments", samples(false, lit)),
        ("4 samples; depth first", samples(true, |_| ())),
        (
            "4 samples; depth first; no window",
            samples(true, |own| own.order_window = 0.0),
        ),
        (
            "4 samples; depth first; hidden cards",
            samples(true, |own| own.cull_hidden = false),
        ),
        (
            "4 samples; depth first; all light in fragments",
            samples(true, lit),
        ),
        ("hashed", hashed(false)),
        ("hashed; depth first", hashed(true)),
    ]
}

/// How an app is drawn now.
fn chosen(app: &mut App) -> Option<Choice> {
    let world = app.world_mut();
    let mut cameras = world.query_filtered::<Has<DepthPrepass>, With<Camera3d>>();
    let depth_first = cameras.iter(world).next()?;
    let mut qualities = world.query::<&FeatherQuality>();
    let quality = *qualities.iter(world).next()?;
    Some(Choice {
        quality,
        depth_first,
    })
}

/// Draws an app that way.
fn choose(app: &mut App, choice: Choice) {
    let world = app.world_mut();
    let mut cameras = world.query_filtered::<Entity, With<Camera3d>>();
    let cameras: Vec<Entity> = cameras.iter(world).collect();
    for camera in cameras {
        let mut camera = world.entity_mut(camera);
        camera.insert(match choice.quality.transparency {
            FeatherTransparency::Hashed => Msaa::Off,
            _ => Msaa::Sample4,
        });
        if choice.depth_first {
            camera.insert(DepthPrepass);
        } else {
            camera.remove::<DepthPrepass>();
        }
    }
    let mut qualities = world.query::<&mut FeatherQuality>();
    for mut quality in qualities.iter_mut(world) {
        *quality = choice.quality;
    }
}

/// A point light of the table.
#[derive(Component)]
struct Added;

/// Feathers that all birds of an app wear.
fn feathers(app: &mut App) -> usize {
    let mut worn = app.world_mut().query::<&PlumageCards>();
    worn.iter(app.world()).map(|worn| worn.cards.len()).sum()
}

/// Puts `count` lights around the birds.
fn light(app: &mut App, count: usize) {
    let world = app.world_mut();
    let mut added = world.query_filtered::<Entity, With<Added>>();
    let old: Vec<Entity> = added.iter(world).collect();
    for entity in old {
        world.entity_mut(entity).despawn();
    }
    for i in 0..count {
        let angle = TAU * i as f32 / count as f32;
        world.spawn((
            Added,
            PointLight {
                intensity: 20_000.0 / count as f32,
                ..default()
            },
            Transform::from_xyz(0.8 * angle.cos(), 0.5, 0.8 * angle.sin()),
        ));
    }
}

/// Milliseconds of a frame of each, by the adapter's clock.
fn time(apps: &mut Apps) -> [f64; 2] {
    for (app, _) in apps.iter_mut() {
        (0..SETTLE).for_each(|_| {
            frame(app);
        });
    }
    let mut times: [Vec<f64>; 2] = Default::default();
    for _ in 0..ROUNDS {
        for ((app, _), times) in apps.iter_mut().zip(&mut times) {
            times.push(seconds(app));
        }
    }
    times.map(|times| 1e3 * least(&times))
}

/// Measures and writes the table; one line for each.
pub fn run(mut apps: Apps, name: &str, size: (u32, u32), file: &Path) -> Result<(), String> {
    let mut table = String::from("what,x,feathers ms,cards ms,feathers over cards\n");
    let mut line = |what: &str, x: usize, apps: &mut Apps| {
        let [own, cards] = time(apps);
        let text = format!("{what},{x},{own:.2},{cards:.2},{:.3}", own / cards);
        println!("{text}");
        let _ = writeln!(table, "{text}");
    };
    for size in SIZES {
        for (app, image) in &mut apps {
            resize(app, image, size);
        }
        line("pixels", (size.0 * size.1) as usize, &mut apps);
    }
    for (app, image) in &mut apps {
        resize(app, image, size);
    }
    if let Some(own) = chosen(apps[0].0) {
        for (row, choice) in choices() {
            for (app, _) in &mut apps {
                choose(app, choice);
            }
            line(row, (size.0 * size.1) as usize, &mut apps);
        }
        for (app, _) in &mut apps {
            choose(app, own);
        }
    }
    for count in LIGHTS {
        for (app, _) in &mut apps {
            light(app, count - 1);
        }
        line("lights", count, &mut apps);
    }
    for (app, _) in &mut apps {
        light(app, 0);
    }
    for count in COUNTS {
        let mut found = 0;
        for (app, _) in &mut apps {
            let share = count / feathers(app).max(1) as f32;
            let mut birds = app.world_mut().query::<&mut Plumage>();
            for mut bird in birds.iter_mut(app.world_mut()) {
                bird.density *= share;
            }
            regrow(app, name)?;
            found = feathers(app);
        }
        line("feathers", found, &mut apps);
    }
    println!("{}", clock(apps[0].0));
    fs::write(file, table).map_err(|error| format!("{}: {error}", file.display()))
}
