//! How much bare skin shows through the coats that glTF files get without a groom: from 12 directions at 3 phases of a clip, pixels
//! of skin over pixels of skin and feathers. Leaves with an error code above half a per cent.
//!
//! `cargo run -p plumage_tools --bin bare_skin -- a.glb b.glb --clip 1 --pictures out`

use clap::Parser;
use plumage_tests::{
    app::Stage,
    bare::{Bare, PHASES, Subject, count, paint},
};
use std::{
    path::{Path, PathBuf},
    process::ExitCode,
};

/// Largest share allowed.
const ALLOWED: f32 = 0.005;

/// What to measure.
#[derive(Parser)]
struct Args {
    /// glTF files.
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Number of the clip that moves them.
    #[arg(long, default_value_t = 0)]
    clip: usize,
    /// Side of a picture, pixels.
    #[arg(long, default_value_t = 512)]
    size: u32,
    /// Folder for the pictures: skin magenta, feathers black, the rest green.
    #[arg(long)]
    pictures: Option<PathBuf>,
}

fn measure(args: &Args, file: &Path) -> Result<Bare, String> {
    let mut stage = Stage::sized(args.size, args.size).ok_or("no graphics adapter found")?;
    let subject = Subject::open(&mut stage, file, args.clip)?;
    paint(&mut stage, subject.owner);
    let mut bare = Bare::default();
    for phase in 0..PHASES {
        subject.pose(&mut stage, phase as f32 / PHASES as f32);
        let name = file.file_stem().unwrap_or_default().to_string_lossy();
        let folder = args
            .pictures
            .as_ref()
            .map(|folder| folder.join(format!("{name}_{phase}")));
        if let Some(folder) = &folder {
            std::fs::create_dir_all(folder).map_err(|error| error.to_string())?;
        }
        count(&mut stage, &subject, folder.as_ref(), &mut bare);
    }
    Ok(bare)
}

fn main() -> ExitCode {
    let args = Args::parse();
    let mut passes = true;
    for file in &args.files {
        match measure(&args, file) {
            Ok(bare) => {
                passes &= bare.share() <= ALLOWED;
                println!(
                    "{}: {:.2} % bare ({} of {} pixels), at most {:.2} % in one picture",
                    file.display(),
                    100.0 * bare.share(),
                    bare.skin,
                    bare.feathered,
                    100.0 * bare.worst
                );
            }
            Err(error) => {
                eprintln!("{}: {error}", file.display());
                passes = false;
            }
        }
    }
    if passes {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}
