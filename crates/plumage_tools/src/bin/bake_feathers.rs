//! Writes every preset to `assets/feathers/NAME.feather.ron`, and with `--sheet FILE.png` a contact sheet of them.
//!
//! `cargo run -p plumage_tools --bin bake_feathers -- --sheet feathers.png`

use bevy_plumage::anatomy::{BAKE_HEIGHT, BAKE_WIDTH, CONTOUR_ROWS, Feather, ShapeTable, Side};
use bevy_plumage::asset::RonAsset;
use bevy_plumage::maths::{Footprint, card, functions::normal_distribution};
use clap::Parser;
use plumage_tools::presets;
use std::{error::Error, fs, path::PathBuf};

/// Bakes the feather presets.
#[derive(Parser)]
struct Arguments {
    /// Folder for the feather files.
    #[arg(long, default_value = "assets/feathers")]
    out: PathBuf,
    /// Also draw a contact sheet (PNG).
    #[arg(long)]
    sheet: Option<PathBuf>,
    /// Draw the faces towards the body.
    #[arg(long)]
    back: bool,
}

const CELL: (usize, usize) = (150, 330);
const COLUMNS: usize = 10;
const GROUND: f32 = 0.62;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments = Arguments::parse();
    let feathers = presets::all();
    fs::create_dir_all(&arguments.out)?;
    for feather in &feathers {
        feather.write(&arguments.out.join(format!("{}.feather.ron", feather.name)))?;
    }
    println!("{} feathers in {}", feathers.len(), arguments.out.display());
    if let Some(path) = &arguments.sheet {
        sheet(&feathers, arguments.back).save(path)?;
        println!("{}", path.display());
    }
    Ok(())
}

fn sheet(feathers: &[Feather], back: bool) -> image::RgbImage {
    let rows = feathers.len().div_ceil(COLUMNS);
    let grey = image::Rgb([(GROUND * 255.0) as u8; 3]);
    let mut sheet = image::RgbImage::from_pixel(
        (COLUMNS * CELL.0) as u32,
        (rows * (CELL.1 + 10)) as u32,
        grey,
    );
    for (i, feather) in feathers.iter().enumerate() {
        let (left, top) = ((i % COLUMNS) * CELL.0, (i / COLUMNS) * (CELL.1 + 10) + 5);
        draw(&mut sheet, feather, back, left, top);
    }
    sheet
}

/// Linear lookup in the contour table: reach and slope of one side.
fn contour(table: &ShapeTable, side: Side, root: f32) -> (f32, f32) {
    let row = card::contour_row(root, table.start, CONTOUR_ROWS as f32);
    let i = (row as usize).min(CONTOUR_ROWS - 2);
    let t = row - i as f32;
    let (a, b) = (table.contour[i], table.contour[i + 1]);
    let at = |k: usize| a[k] + (b[k] - a[k]) * t;
    let k = usize::from(side == Side::Right);
    (at(k), at(k + 2))
}

/// One feather, as long as the cell allows at its true proportions: albedo through the outline, loose parts half clear.
fn draw(sheet: &mut image::RgbImage, feather: &Feather, back: bool, left: usize, top: usize) {
    let pattern = if back {
        feather.albedo.back_pattern()
    } else {
        &feather.albedo.front
    };
    let albedo = pattern.bake(BAKE_WIDTH * 2, BAKE_HEIGHT * 2, feather);
    let table = feather.shape_table();
    let map_of = feather.map();
    let scale = (CELL.1 as f32).min((CELL.0 - 10) as f32 / feather.aspect);
    let (width, height) = ((feather.aspect * scale) as usize, scale as usize);
    for row in 0..height {
        for column in 0..width {
            let u = (column as f64 + 0.5) / width as f64;
            let v = 1.0 - (row as f64 + 0.5) / height as f64;
            let footprint = map_of.footprint(
                [u, v],
                [1.0 / width as f64, 0.0],
                [0.0, -1.0 / height as f64],
            );
            let footprint = Footprint {
                mean: footprint.mean.map(|x| x as f32),
                covariance: footprint.covariance.map(|x| x as f32),
            };
            let mean = footprint.mean;
            let side = if mean[0] < 0.0 {
                Side::Left
            } else {
                Side::Right
            };
            let vane = feather.vane(side);
            let cotangent = vane.cotangent();
            let root = card::barb_root(mean, cotangent);
            let (reach, slope) = contour(&table, side, root);
            let hooked = card::hooked(mean[0].abs(), mean[1], reach, vane.fringe, vane.downy);
            let outline = card::contour_coverage(&footprint, reach, slope, cotangent)
                * card::vane_start_coverage(&footprint, table.start, cotangent);
            // A hint of the barbs, so that their direction can be judged.
            let barb = 0.93 + 0.07 * (root * vane.barb_count * 0.25 * std::f32::consts::TAU).cos();
            let vane_alpha = outline * (0.55 + 0.45 * hooked);
            let radius = feather.r_r(v as f32);
            let shaft = normal_distribution(
                (radius - mean[0].abs()) / footprint.covariance[0].sqrt().max(1e-6),
            );
            let texel = (((v * (BAKE_HEIGHT * 2) as f64) as usize * BAKE_WIDTH * 2)
                + (u * (BAKE_WIDTH * 2) as f64) as usize)
                * 4;
            let (x, y) = (
                (left + (CELL.0 - width) / 2 + column) as u32,
                (top + row) as u32,
            );
            let pixel = sheet.get_pixel_mut(x, y);
            for channel in 0..3 {
                let color = f32::from(albedo[texel + channel]) / 255.0;
                let vane_color = GROUND + (color * barb - GROUND) * vane_alpha;
                let shaft_color = 0.5 * color + 0.25;
                let value = vane_color + (shaft_color - vane_color) * shaft;
                pixel.0[channel] = (value.clamp(0.0, 1.0) * 255.0) as u8;
            }
        }
    }
}
