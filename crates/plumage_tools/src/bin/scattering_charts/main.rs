//! Charts of the scattering model, an SVG and its numbers as CSV each: energy kept, lobes, what simplifications cost.
//!
//! `cargo run -p plumage_tools --bin scattering_charts [folder]` (default `docs/charts`)

use plumage_tools::plot;
mod bounces;
mod cost;
mod energy;
mod lobes;

use bevy_plumage::maths::scattering::*;
use plumage_reference::fibre_published::PublishedFibre;
use std::{env, fs, path::Path};

fn structural(core_radius: f32) -> Fibre {
    Fibre {
        kind: FibreKind::Structural { core_radius },
        tilt: 0.0,
        azimuthal_roughness: 0.3,
        ..Fibre::default()
    }
}

fn direction(theta: f64, phi: f64) -> [f64; 3] {
    [
        theta.sin(),
        theta.cos() * phi.sin(),
        theta.cos() * phi.cos(),
    ]
}

fn shade(fibre: &Fibre, theta: f64) -> FibreShading<f64> {
    let table = FibreTable::build(fibre);
    let row = table.row(theta.cos());
    let mut s = fibre_shading(
        &table.fibre(),
        &row,
        [1.0; 3],
        direction(theta, 0.0),
        0.0,
        8,
    );
    // A perfectly white core; an albedo stops at 0.995.
    s.energy = row[0].map(|e| [e; 3]);
    s
}

fn published(core: f64, nodes: usize) -> PublishedFibre {
    PublishedFibre {
        eta: 1.55,
        core,
        reflectance: 1.0,
        absorption: 0.0,
        longitudinal_roughness: 0.2,
        azimuthal_roughness: 0.3,
        tilt: 0.0,
        nodes,
    }
}

fn main() -> plot::Result<()> {
    let folder = env::args().nth(1).unwrap_or_else(|| "docs/charts".into());
    let folder = Path::new(&folder);
    fs::create_dir_all(folder)?;
    println!("timed on {}", plot::processor());
    energy::furnace(folder)?;
    energy::sweep(folder)?;
    energy::sheen(folder)?;
    lobes::azimuth(folder)?;
    lobes::reflectance(folder)?;
    cost::far_field(folder)?;
    cost::published_cost(folder)?;
    cost::environment(folder)?;
    cost::sheen_table_size(folder)?;
    bounces::multiple(folder)
}
