//! One photograph becomes a feather: writes `NAME.feather.ron`, `NAME_albedo.png` and `NAME_overlay.png`.
//!
//! `cargo run --features photo --example photo -- photo.jpg [--out DIR] [--scale-mm N] [--front|--back] [--object N]`;
//! leaves with an error code when a photograph gave no feather.

use bevy_plumage::photo::{
    AlbedoFilter, ExtractError, ExtractSettings, Extraction, Face, ObjectChoice, extract,
    load_photograph,
};
use clap::Parser;
use std::{
    path::{Path, PathBuf},
    process::ExitCode,
    time::Instant,
};

/// Turns photographs of single feathers into feather assets.
#[derive(Parser)]
struct Args {
    /// Photographs (PNG, JPEG, WebP).
    #[arg(required = true)]
    photographs: Vec<PathBuf>,
    /// Directory for the results; is made.
    #[arg(long, default_value = "out")]
    out: PathBuf,
    /// Length of the feather from quill to tip in millimetres.
    #[arg(long, visible_alias = "length-mm")]
    scale_mm: Option<f32>,
    /// The photograph shows the face that looks away from the body (this is the default).
    #[arg(long, conflicts_with = "back")]
    front: bool,
    /// The photograph shows the face towards the body.
    #[arg(long)]
    back: bool,
    /// Of several feathers in the picture the one of this number, from left to right as the message lists them.
    #[arg(long, value_name = "N")]
    object: Option<u32>,
    /// Longest side in pixels of the view that is analysed.
    #[arg(long, default_value_t = ExtractSettings::default().resolution)]
    resolution: u32,
    /// Smooth the color with a plain Gaussian, as in the paper, instead of keeping the borders of patterns.
    #[arg(long)]
    low_pass: bool,
    /// Take no alpha channel for a mask.
    #[arg(long)]
    ignore_alpha: bool,
}

fn main() -> ExitCode {
    let args = Args::parse();
    if let Err(error) = std::fs::create_dir_all(&args.out) {
        eprintln!("{}: {error}", args.out.display());
        return ExitCode::FAILURE;
    }
    let mut failed = false;
    for path in &args.photographs {
        if let Err(error) = one(path, &args) {
            eprintln!("{}: {error}", path.display());
            if matches!(error, ExtractError::SeveralObjects { .. }) {
                eprintln!("`--object N` takes one of them");
            }
            failed = true;
        }
    }
    if failed {
        ExitCode::FAILURE
    } else {
        ExitCode::SUCCESS
    }
}

fn one(path: &Path, args: &Args) -> Result<(), ExtractError> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let name = name.split('.').next().unwrap_or("feather");
    let settings = ExtractSettings {
        name: name.to_owned(),
        face: if args.back && !args.front {
            Face::Back
        } else {
            Face::Front
        },
        object: args.object.map_or(ObjectChoice::Only, ObjectChoice::Number),
        length_mm: args.scale_mm,
        resolution: args.resolution,
        albedo: if args.low_pass {
            AlbedoFilter::LowPass
        } else {
            AlbedoFilter::EdgeAware
        },
        use_alpha: !args.ignore_alpha,
        ..ExtractSettings::default()
    };
    let start = Instant::now();
    let photograph = load_photograph(path)?;
    println!(
        "{name}: {} x {} pixels, read in {:.2} s",
        photograph.width(),
        photograph.height(),
        start.elapsed().as_secs_f32()
    );
    let found = extract(&photograph, &settings, &mut |progress| {
        println!(
            "{:5.2} s {:3.0} % {:?}",
            start.elapsed().as_secs_f32(),
            progress.share * 100.0,
            progress.stage
        );
    })?;
    report(&found);
    let overlay = args.out.join(format!("{name}_overlay.png"));
    found
        .overlay(&photograph)
        .save(&overlay)
        .map_err(|error| ExtractError::Io {
            file: overlay.display().to_string(),
            message: error.to_string(),
        })?;
    for written in found.write(&args.out)?.iter().chain([&overlay]) {
        println!("wrote {}", written.display());
    }
    Ok(())
}

fn report(found: &Extraction) {
    let feather = &found.feather;
    println!(
        "length {:.0} mm, width {:.1} mm, vane from {:.2}, down to {:.2}",
        feather.length_mm,
        feather.length_mm * feather.aspect,
        feather.contour.start,
        feather.left.downy
    );
    for (side, barbs) in ["left", "right"].iter().zip(&found.barbs) {
        match barbs {
            Some(barbs) => println!(
                "{side} barbs: {:.0} degrees (quartiles {:.0} apart), {}",
                barbs.angle.to_degrees(),
                barbs.spread.to_degrees(),
                barbs.count.map_or_else(
                    || "density not resolved".to_owned(),
                    |count| format!("{:.2} per mm", count / feather.length_mm)
                )
            ),
            None => println!("{side} barbs: not resolved"),
        }
    }
    println!("confidence {:.2}", found.confidence.overall());
    for (result, doubt) in found.confidence.doubts() {
        println!("  {result}: {doubt}");
    }
}
