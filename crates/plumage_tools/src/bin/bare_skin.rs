//! How much bare skin shows through coats, from 12 directions: pixels of skin over pixels of skin and feathers. Of glTF files, which
//! get theirs without a groom, at 3 phases of a clip; of the repository's birds in their grooms at 6. Leaves with an error code above
//! half a per cent, of a bird above a tenth.
//!
//! `cargo run -p plumage_tools --bin bare_skin -- a.glb b.glb --clip 1 --pictures out`, `-- --bird parrot --bird eagle --bird owl`

use clap::Parser;
use plumage_tests::{
    app::Stage,
    bare::{BIRD_PHASES, Bare, PHASES, Subject, count, paint, paint_bird},
};
use std::{
    path::{Path, PathBuf},
    process::ExitCode,
};

/// Largest share allowed.
const ALLOWED: f32 = 0.005;
/// Largest share allowed of a bird in its groom.
const ALLOWED_BIRD: f32 = 0.001;
/// How many of the barest pictures are named.
const NAMED: usize = 5;

/// What to measure.
#[derive(Parser)]
struct Args {
    /// glTF files.
    #[arg(required_unless_present = "bird")]
    files: Vec<PathBuf>,
    /// A bird of the repository.
    #[arg(long)]
    bird: Vec<String>,
    /// Phases of a bird's clip, instead of 6.
    #[arg(long)]
    phases: Option<u32>,
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

/// What is feathered.
enum Kind<'a> {
    File(&'a Path),
    Bird(&'a str),
}

fn measure(args: &Args, kind: &Kind) -> Result<Bare, String> {
    let mut stage = Stage::sized(args.size, args.size).ok_or("no graphics adapter found")?;
    let (subject, name, phases) = match kind {
        Kind::File(file) => {
            let subject = Subject::open(&mut stage, file, args.clip)?;
            paint(&mut stage, subject.owner);
            let name = file.file_stem().unwrap_or_default().to_string_lossy();
            (subject, name, PHASES)
        }
        Kind::Bird(name) => {
            let subject = Subject::bird(&mut stage, name)?;
            paint_bird(&mut stage, subject.owner)?;
            (subject, (*name).into(), args.phases.unwrap_or(BIRD_PHASES))
        }
    };
    let mut bare = Bare::default();
    let mut pictures = Vec::new();
    for phase in 0..phases {
        subject.pose(&mut stage, phase as f32 / phases as f32);
        let folder = args
            .pictures
            .as_ref()
            .map(|folder| folder.join(format!("{name}_{phase}")));
        if let Some(folder) = &folder {
            std::fs::create_dir_all(folder).map_err(|error| error.to_string())?;
        }
        let shares = count(&mut stage, &subject, folder.as_ref(), &mut bare);
        let direction = |(number, share)| (share, phase, number);
        pictures.extend(shares.into_iter().enumerate().map(direction));
    }
    pictures.sort_by(|a, b| b.0.total_cmp(&a.0));
    for (share, phase, number) in pictures.iter().take(NAMED) {
        println!(
            "{name}: phase {phase} of {phases}, direction {number:02}: {:.2} %",
            100.0 * share
        );
    }
    Ok(bare)
}

fn main() -> ExitCode {
    let args = Args::parse();
    let mut passes = true;
    let files = args.files.iter().map(|file| Kind::File(file));
    let birds = args.bird.iter().map(|name| Kind::Bird(name));
    for kind in files.chain(birds) {
        let (what, allowed) = match kind {
            Kind::File(file) => (file.display().to_string(), ALLOWED),
            Kind::Bird(name) => (name.to_owned(), ALLOWED_BIRD),
        };
        match measure(&args, &kind) {
            Ok(bare) => {
                passes &= bare.share() <= allowed;
                println!(
                    "{what}: {:.2} % bare ({} of {} pixels), at most {:.2} % in one picture",
                    100.0 * bare.share(),
                    bare.skin,
                    bare.feathered,
                    100.0 * bare.worst
                );
            }
            Err(error) => {
                eprintln!("{what}: {error}");
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
