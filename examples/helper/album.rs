//! Several pictures from one run, so that the birds grow once: `--shot CAMERA=FILE`, and masks that say where the birds are.

use super::{
    Args, Shot,
    camera::{self, Orbit, Shots},
    headless,
    scene::{self, Breast},
    stats,
};
use bevy::prelude::*;
use std::{path::Path, time::Instant};

/// Most frames of a mask: with four samples each, one alone is less than a hundredth of a pixel, from which on a pixel counts.
const MASK_FRAMES: u32 = 32;

/// Takes every picture that is asked for, then the masks.
pub fn run(app: &mut App, image: &Handle<Image>, name: &str, args: &Args) -> Result<(), String> {
    for folder in [&args.masks, &args.stats].into_iter().flatten() {
        std::fs::create_dir_all(folder).map_err(|error| told(folder, error))?;
    }
    for (shot, file) in &args.shot {
        aim(app, *shot, args);
        let start = Instant::now();
        headless::frame(app);
        let picture = headless::develop(app, image, name, args, args.accumulate)?;
        picture.save(file).map_err(|error| told(file, error))?;
        let time = start.elapsed();
        println!(
            "{name}: wrote {}, {:.0} s",
            file.display(),
            time.as_secs_f32()
        );
        if let Some(folder) = &args.stats {
            let mut times = [time / (1 + args.accumulate.unwrap_or(1))];
            let stats = stats::collect(app, &mut times);
            write(&named(folder, file, "json"), &format!("{stats:#}\n"))?;
        }
    }
    let Some(folder) = &args.masks else {
        return Ok(());
    };
    scene::mask(app);
    for (shot, file) in &args.shot {
        let pixel = aim(app, *shot, args);
        headless::frame(app);
        // Four times those of the picture: a mask is cheaper, and is judged pixel by pixel.
        let frames = args
            .accumulate
            .map(|count| count.saturating_mul(4).min(MASK_FRAMES));
        let mask = headless::develop(app, image, name, args, frames)?;
        let path = named(folder, file, "png");
        mask.save(&path).map_err(|error| told(&path, error))?;
        let said = serde_json::json!({ "mm_per_pixel": pixel * 1000.0, "breasts": breasts(app) });
        write(&named(folder, file, "json"), &format!("{said:#}\n"))?;
    }
    Ok(())
}

fn told(path: &Path, error: impl std::fmt::Display) -> String {
    format!("{}: {error}", path.display())
}

fn named(folder: &Path, file: &Path, ending: &str) -> std::path::PathBuf {
    folder
        .join(file.file_stem().unwrap_or_default())
        .with_extension(ending)
}

fn write(path: &Path, text: &str) -> Result<(), String> {
    std::fs::write(path, text).map_err(|error| told(path, error))
}

/// Where the breast of each bird is in the picture: middle and radius, pixels.
fn breasts(app: &mut App) -> Vec<[f32; 3]> {
    let world = app.world_mut();
    let mut cameras = world.query_filtered::<(&Camera, &GlobalTransform), With<Orbit>>();
    let mut birds = world.query::<(&Breast, &GlobalTransform)>();
    let Some((camera, eye)) = cameras.iter(world).next() else {
        return Vec::new();
    };
    let shown = |(Breast(at, radius), bird): (&Breast, &GlobalTransform)| {
        let middle = bird.transform_point(*at);
        let edge = middle + *radius * eye.right();
        let [middle, edge] = [middle, edge].map(|at| camera.world_to_viewport(eye, at).ok());
        let (middle, edge) = (middle?, edge?);
        Some([middle.x, middle.y, middle.distance(edge)])
    };
    birds.iter(world).filter_map(shown).collect()
}

/// Moves the camera to a shot. Returns what a pixel measures at its target, metres.
fn aim(app: &mut App, shot: Shot, args: &Args) -> f32 {
    let world = app.world_mut();
    let framing = world.resource::<Shots>().framing(shot);
    let (place, lens) = camera::place(framing, args);
    let away = place.translation.distance(framing.target);
    let mut cameras = world.query_filtered::<Entity, (With<Camera3d>, With<Orbit>)>();
    let found: Vec<Entity> = cameras.iter(world).collect();
    for camera in found {
        let orbit = Orbit {
            target: framing.target,
        };
        world
            .entity_mut(camera)
            .insert((place, lens.clone(), orbit));
    }
    2.0 * away * (0.5 * framing.fov.to_radians()).tan() / args.size.1 as f32
}
