//! Bakes the birds of the scenes: skinned meshes (`assets/birds/*.glb`) and grooms (`assets/grooms/*.groom.ron`), from
//! tables of measurements.
//!
//! `cargo run -p plumage_tools --bin bake_birds -- --out assets --preview target/preview`

mod bill;
mod body;
mod clip;
mod eyes;
mod feet;
mod glb;
mod idle;
mod loft;
mod maps;
mod model;
mod naked;
mod nets;
mod plumage;
mod preview;
mod rows;
mod skeleton;
mod species;
mod tract;
mod tube;
mod weights;
mod wing;

use std::fs;
use std::path::PathBuf;

use bevy_plumage::asset::RonAsset;
use clap::Parser;

/// Options of the generator.
#[derive(Parser)]
struct Options {
    /// Folder that holds `birds/` and `grooms/`.
    #[arg(long, default_value = "assets")]
    out: PathBuf,
    /// Also draw preview sheets into this folder.
    #[arg(long)]
    preview: Option<PathBuf>,
    /// Only this bird (`parrot`, `eagle` or `owl`).
    #[arg(long)]
    bird: Option<String>,
}

fn main() -> Result<(), String> {
    let options = Options::parse();
    for species in species::all() {
        if options.bird.as_ref().is_some_and(|b| b != species.name) {
            continue;
        }
        let started = std::time::Instant::now();
        let model = model::build(&species);
        let groom = plumage::groom(&species, &model);
        let glb = glb::write(&species, &model)?;
        let text = groom.to_ron().map_err(|error| error.to_string())?;
        for (folder, name, bytes) in [
            ("birds", format!("{}.glb", species.name), glb.as_slice()),
            (
                "grooms",
                format!("{}.groom.ron", species.name),
                text.as_bytes(),
            ),
        ] {
            let path = options.out.join(folder).join(name);
            let report = |e: std::io::Error| format!("{}: {e}", path.display());
            fs::create_dir_all(options.out.join(folder)).map_err(report)?;
            fs::write(&path, bytes).map_err(report)?;
        }
        let skin = &model.parts[0].primitive;
        println!(
            "{}: {} skin triangles, {} vertices, {} open edges, {} joints, {} KB, {} feathers, {:.1} s",
            species.name,
            skin.triangles.len(),
            skin.vertices.len(),
            model.open_edges,
            model.skeleton.joints.len(),
            glb.len() / 1024,
            plumage::count(&groom),
            started.elapsed().as_secs_f32()
        );
        plumage::report(&species, &model, &groom);
        if let Some(dir) = &options.preview {
            fs::create_dir_all(dir).map_err(|e| format!("{}: {e}", dir.display()))?;
            preview::sheets(&species, &model, &groom, dir)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn grooms_are_what_the_tables_say() {
        for species in species::all() {
            let groom = plumage::groom(&species, &model::build(&species));
            let path = Path::new(env!("CARGO_MANIFEST_DIR"))
                .join("../../assets/grooms")
                .join(format!("{}.groom.ron", species.name));
            let kept = fs::read_to_string(&path).expect("a groom of the assets");
            let baked = groom.to_ron().expect("a groom that can be written");
            let differs = kept.lines().zip(baked.lines()).position(|(a, b)| a != b);
            assert_eq!(
                differs,
                None,
                "{}: bake_birds writes another line",
                path.display()
            );
            assert_eq!(kept.len(), baked.len(), "{}", path.display());
        }
    }
}
