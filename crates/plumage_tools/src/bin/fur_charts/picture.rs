//! The dense fur of Kloetzli 2005: bytes, textures, and the detail of a picture seen straight down.

use bevy::math::UVec3;
use bevy_plumage::maths::undercoat::Tile;
use bevy_plumage::maths::undercoat::harmonics::HARMONICS;
use bevy_plumage::maths::undercoat::texture::{Fur, fur_tile};
use bevy_plumage::maths::undercoat::transfer::*;
use plumage_tests::tiles::{grey, sky_light};
use std::{collections::BTreeMap, f64::consts::PI};

/// Pixels along the side of the part that is drawn, and how many the whole tile has.
const PART: usize = 48;
const WHOLE: usize = 512;
const SUN: [f64; 3] = [0.6, 0.0, 0.8];
/// Color of the skin.
const SKIN: f64 = 0.05;

/// The paper's 55,000 hairs, drawn into cells of any size.
fn fur(size: u32) -> Fur {
    let mut fur = Fur::dense();
    let scale = size as f32 / fur.size.x as f32;
    fur.size = UVec3::new(size, size, 32);
    for coat in &mut fur.coats {
        coat.radius = coat.radius.map(|v| v * scale);
        coat.curl = coat.curl.map(|v| v * scale);
    }
    fur
}

/// What reaches a cell.
enum Lit {
    /// The sum over the traced rays themselves.
    Traced,
    /// The paper's seven look-ups, eight bits each.
    Published,
    /// Four numbers, eight bits each.
    Four,
}

/// Mean light of the cells that the part needs.
fn light(tile: &Tile, lit: &Lit) -> BTreeMap<usize, f64> {
    let size = tile.size().as_usizevec3();
    let reach = (PART * size.x / WHOLE + 2) as i32;
    let cells: Vec<usize> = (0..size.z as i32)
        .flat_map(|z| (-1..reach).flat_map(move |y| (-1..reach).map(move |x| (x, y, z))))
        .map(|(x, y, z)| tile.cell(x, y, z))
        .collect();
    let settings = match lit {
        Lit::Traced => TransferSettings {
            count: 256,
            rays: Rays::Fibonacci,
            ..TransferSettings::default()
        },
        Lit::Published => plumage_reference::undercoat::transfer_published::settings(1024, 1),
        Lit::Four => TransferSettings::default(),
    };
    let baker = Baker::new(tile, &settings).expect("sound settings");
    let sky = sky(4096, |d| sky_light(SUN, d));
    if let Lit::Traced = lit {
        let lights: Vec<f64> = rays(settings.rays, settings.count)
            .into_iter()
            .map(|d| grey(sky_light(SUN, d)))
            .collect();
        return cells
            .iter()
            .map(|cell| {
                let all = baker.visibility(*cell);
                let sum: f64 = all
                    .iter()
                    .zip(&lights)
                    .map(|(v, l)| f64::from(*v) * l)
                    .sum();
                (*cell, sum / lights.len() as f64)
            })
            .collect();
    }
    let raw = RawTransfer {
        cells: cells
            .iter()
            .flat_map(|cell| baker.bake(*cell..*cell + 1))
            .collect(),
        albedo: 0.0,
    };
    let byte = |v: f32, low: f32, high: f32| {
        low + (high - low) * ((v - low) / (high - low).max(1e-6) * 255.0).round() / 255.0
    };
    let values: Vec<f64> = match lit {
        Lit::Published => {
            let range: [(f32, f32); HARMONICS] = std::array::from_fn(|i| {
                raw.cells
                    .iter()
                    .map(|c| c[i])
                    .fold((0.0, 0.0), |(l, h), v| (f32::min(l, v), f32::max(h, v)))
            });
            let mut light = [0.0; HARMONICS];
            for (light, c) in light.iter_mut().zip(sky.harmonics) {
                *light = grey(c.map(f64::from)) as f32;
            }
            let light = plumage_reference::undercoat::transfer_published::lookups(&light);
            raw.cells
                .iter()
                .map(|c| {
                    let c = std::array::from_fn(|i| byte(c[i], range[i].0, range[i].1));
                    let sum = plumage_reference::undercoat::transfer_published::reconstruct(
                        &plumage_reference::undercoat::transfer_published::lookups(&c),
                        &light,
                    );
                    f64::from(sum.max(0.0)) / (4.0 * PI)
                })
                .collect()
        }
        _ => {
            let transfer = Transfer::compress(&raw);
            let longest = transfer.bands.longest;
            transfer
                .cells
                .iter()
                .map(|four| {
                    let four = Four {
                        bent: four.bent.map(|v| byte(v, -longest, longest)),
                        openness: byte(four.openness, 0.0, 1.0),
                    };
                    let c = transfer_zonal(&four, &transfer.bands, &sky.low());
                    grey(c.map(f64::from))
                })
                .collect()
        }
    };
    cells.into_iter().zip(values).collect()
}

/// The part seen straight down through 32 shells, filtered within each: `coat` gives the opacity, `tile` the light.
fn draw(coat: &Tile, tile: &Tile, light: &BTreeMap<usize, f64>) -> Vec<f64> {
    let mut picture = Vec::new();
    for y in 0..PART {
        for x in 0..PART {
            let mut sum = 0.0;
            let mut left = 1.0;
            for z in (0..32).rev() {
                let at = |tile: &Tile, value: &dyn Fn(usize) -> f64| -> f64 {
                    let scale = f64::from(tile.size().x) / WHOLE as f64;
                    let place = [x, y].map(|p| (p as f64 + 0.5) * scale - 0.5);
                    let [i, j] = place.map(|p| p.floor() as i32);
                    let [s, t] = place.map(|p| p - p.floor());
                    let value = |a, b| value(tile.cell(i + a, j + b, z));
                    (value(0, 0) * (1.0 - s) + value(1, 0) * s) * (1.0 - t)
                        + (value(0, 1) * (1.0 - s) + value(1, 1) * s) * t
                };
                let extinction = at(coat, &|cell| f64::from(coat.extinction()[cell]));
                let alpha = 1.0 - (-extinction / 32.0).exp();
                sum += left * alpha * at(tile, &|cell| light[&cell]);
                left *= 1.0 - alpha;
            }
            picture.push(sum + left * SKIN);
        }
    }
    picture
}

fn mean(picture: &[f64]) -> f64 {
    picture.iter().sum::<f64>() / picture.len() as f64
}

/// Deviation over the mean, and the mean step from one pixel to the next over the mean.
fn detail(picture: &[f64]) -> [f64; 2] {
    let mean = mean(picture);
    let n = picture.len() as f64;
    let spread = picture.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n;
    let step: f64 = picture
        .chunks(PART)
        .flat_map(|row| row.windows(2))
        .map(|w| (w[1] - w[0]).abs())
        .sum();
    [spread.sqrt() / mean, step / n / mean]
}

pub fn dense() {
    let tile = |size| fur_tile(&fur(size)).expect("a sound fur");
    let (finest, fine, coarse) = (tile(512), tile(256), tile(64));
    let truth = draw(&finest, &finest, &light(&finest, &Lit::Traced));
    let published = light(&coarse, &Lit::Published);
    let four_coarse = light(&coarse, &Lit::Four);
    let four_fine = light(&fine, &Lit::Four);
    let cells = |size: usize| size * size * 32;
    println!(
        "55,000 hairs, 32 shells, seen straight down (a part of {PART} x {PART} pixels of {WHOLE} x {WHOLE}):"
    );
    println!(
        "| volume | textures of light | bytes of light | bytes of density | contrast | step | error |"
    );
    println!("|---|---|---|---|---|---|---|");
    let row = |name: &str, textures: u32, bytes: usize, density: usize, picture: &[f64]| {
        let [contrast, step] = detail(picture);
        // The paper has no scale of its own: both are compared at the mean of the truth.
        let scale = mean(&truth) / mean(picture);
        let square: f64 = picture
            .iter()
            .zip(&truth)
            .map(|(a, b)| (a * scale - b).powi(2))
            .sum();
        let error = (square / truth.len() as f64).sqrt() / mean(&truth);
        println!(
            "| {name} | {textures} | {bytes} | {density} | {contrast:.3} | {step:.4} | {error:.3} |"
        );
    };
    row("traced rays, 512 x 512 x 32", 0, 0, cells(512), &truth);
    row(
        "published, 64 x 64 x 32, 25 harmonics",
        plumage_reference::undercoat::transfer_published::TEXTURES,
        28 * cells(64),
        cells(64),
        &draw(&coarse, &coarse, &published),
    );
    row(
        "four numbers, 64 x 64 x 32",
        1,
        4 * cells(64),
        cells(64),
        &draw(&coarse, &coarse, &four_coarse),
    );
    row(
        "four numbers, 64 x 64 x 32, density 256 x 256 x 32",
        1,
        4 * cells(64),
        cells(256),
        &draw(&fine, &coarse, &four_coarse),
    );
    row(
        "four numbers, 256 x 256 x 32",
        1,
        4 * cells(256),
        cells(256),
        &draw(&fine, &fine, &four_fine),
    );
}
