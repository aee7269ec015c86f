//! Error over what is stored, and over the rays of the bake.

use bevy_plumage::maths::undercoat::Tile;
use bevy_plumage::maths::undercoat::transfer::*;
use plumage_tests::tiles::*;
use plumage_tools::plot::{Curve, Labels, Result, draw};
use std::path::Path;

const THREADS: usize = 4;

type Light = fn([f64; 3], [f64; 3]) -> f64;

/// The lights of the chart, each turned to many directions.
const LIGHTS: [(&str, Light); 3] = [
    ("sky and soft sun", |sun, d| grey(sky_light(sun, d))),
    ("the paper's lobe", lobe_light),
    ("sun of 8 degrees", |sun, d| {
        f64::from(u8::from(dot(sun, d) > (8f64.to_radians()).cos()))
    }),
];

fn double(four: &Four<f32>) -> Four<f64> {
    Four {
        bent: four.bent.map(f64::from),
        openness: f64::from(four.openness),
    }
}

/// Skies of one light turned to the directions that the judge uses.
fn skies(light: Light) -> Vec<Sky> {
    light_directions()
        .into_iter()
        .map(|sun| sky(16_384, |d| [light(sun, d); 3]))
        .collect()
}

pub fn stored(folder: &Path) -> Result<()> {
    for (volume, tile) in [
        ("down", down_tile(64, 32, 2)),
        ("hair", hair_tile(64, 32, 2)),
    ] {
        let judge = Judge::new(&tile, 2003);
        let curves = curves(&tile, &judge)?;
        let labels = Labels {
            title: &format!("Light in the fur over what is stored of its transfer ({volume})"),
            x: "bytes a cell",
            y: "RMS error over mean light",
        };
        let file = folder.join(format!("fur_transfer_{volume}.svg"));
        draw(&file, &labels, [true, true], &curves)?;
    }
    Ok(())
}

fn curves(tile: &Tile, judge: &Judge) -> Result<Vec<Curve>> {
    let raw = bake(tile, &TransferSettings::default(), THREADS)?;
    let random = TransferSettings {
        skin: Skin::Opaque(0.0),
        ..plumage_reference::undercoat::transfer_published::settings(1024, 1)
    };
    let judged = |settings: &TransferSettings| -> Result<RawTransfer> {
        let baker = Baker::new(tile, settings)?;
        let mut cells = vec![[0.0; 25]; baker.cells()];
        for cell in &judge.cells {
            cells[*cell] = baker.bake(*cell..*cell + 1)[0];
        }
        Ok(RawTransfer { cells, albedo: 0.0 })
    };
    let random = judged(&random)?;
    let clear = judged(&plumage_reference::undercoat::transfer_published::settings(
        1024, 1,
    ))?;
    let transfer = Transfer::compress(&raw);
    let texels = transfer_texture(&transfer, tile, 1).swap_remove(0).bytes;
    let mut curves = Vec::new();
    for (name, light) in LIGHTS {
        let skies = skies(light);
        let full: Vec<_> = skies
            .iter()
            .map(|s| s.harmonics.map(|c| c.map(f64::from)))
            .collect();
        let of_raw = |raw: &RawTransfer, count: usize| {
            judge.error(light, |cell, s| {
                transfer_raw(&raw.cells[cell].map(f64::from), &full[s], count)[0]
            })
        };
        let points = [1, 4, 9, 16, 25].map(|n| (n as f64, of_raw(&raw, n)));
        curves.push((format!("raw, {name}"), points.into()));
        let packed = |cell: usize| {
            let texel: [u8; 4] = std::array::from_fn(|k| texels[4 * cell + k]);
            let texel = texel.map(|b| f32::from(b) / 255.0);
            double(&transfer_decode(texel, &transfer.bands))
        };
        let four = judge.error(light, |cell, s| {
            transfer_zonal_full(&packed(cell), &transfer.bands, &full[s])[0]
        });
        let low = judge.error(light, |cell, s| {
            let low = skies[s].low().map(|c| c.map(f64::from));
            transfer_zonal(&packed(cell), &transfer.bands, &low)[0]
        });
        let published = (of_raw(&random, 25), of_raw(&clear, 25));
        println!(
            "{name}: raw 25 {:.3}, four packed bytes {four:.3} (light of 9: {low:.3}); 1024 random rays {:.3}, and clear skin {:.3}",
            points[4].1, published.0, published.1
        );
        curves.push((format!("four bytes, {name}"), vec![(4.0, four)]));
    }
    Ok(curves)
}

pub fn rays(folder: &Path) -> Result<()> {
    let mut curves: Vec<Curve> = Vec::new();
    for (volume, tile) in [
        ("down", down_tile(64, 32, 2)),
        ("hair", hair_tile(64, 32, 2)),
    ] {
        let step = 1009;
        let bake = |count: u32, rays: Rays| -> Result<Vec<[f32; 25]>> {
            let settings = TransferSettings {
                count,
                rays,
                ..TransferSettings::default()
            };
            let baker = Baker::new(&tile, &settings)?;
            Ok((0..baker.cells())
                .step_by(step)
                .flat_map(|cell| baker.bake(cell..cell + 1))
                .collect())
        };
        let truth = bake(16_384, Rays::Fibonacci)?;
        for (name, rays) in [
            ("Fibonacci", Rays::Fibonacci),
            ("mirrored", Rays::Mirrored),
            ("random", Rays::Random(1)),
        ] {
            let mut points = Vec::new();
            for count in [64, 128, 256, 512, 1024] {
                let (mut error, mut whole) = (0.0, 0.0);
                for (a, b) in bake(count, rays)?
                    .iter()
                    .flatten()
                    .zip(truth.iter().flatten())
                {
                    error += f64::from(a - b).powi(2);
                    whole += f64::from(*b).powi(2);
                }
                points.push((f64::from(count), (error / whole).sqrt()));
            }
            curves.push((format!("{name}, {volume}"), points));
        }
    }
    let labels = Labels {
        title: "Transfer over the rays of a cell",
        x: "rays",
        y: "relative error of 25 harmonics",
    };
    draw(&folder.join("fur_rays.svg"), &labels, [true, true], &curves)
}
