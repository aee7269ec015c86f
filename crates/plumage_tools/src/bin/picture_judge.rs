//! Judges a picture of a bird against photographs: outline, specks, wing, proportions, colors, contrast, highlights, clipping, backdrop.
//!
//! `cargo run -p plumage_tools --bin picture_judge -- parrot front picture.png masks/picture.png`: an example writes both with `--shot`
//! and `--masks`; the mask says where the bird is, the JSON beside it what a pixel measures and where the breasts are. Prints one row of a table for each line of
//! the list.

use clap::{Parser, ValueEnum};
use plumage_tools::judge::{Species, Subject, View};
use std::{error::Error, path::PathBuf, process::ExitCode};

#[derive(Clone, Copy, ValueEnum)]
enum Bird {
    Parrot,
    Eagle,
    Owl,
}

#[derive(Clone, Copy, ValueEnum)]
enum SeenFrom {
    Front,
    Side,
    Back,
    Head,
}

/// What is judged.
#[derive(Parser)]
struct Args {
    /// Which bird.
    bird: Bird,
    /// From where it is seen.
    view: SeenFrom,
    /// The picture.
    picture: PathBuf,
    /// Its mask.
    mask: PathBuf,
    /// Write the picture with what is objected to: specks white, stray pixels yellow, olive green, mauve magenta, pale breast cyan.
    #[arg(long)]
    marks: Option<PathBuf>,
}

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let args = Args::parse();
    let species = match args.bird {
        Bird::Parrot => Species::Macaw,
        Bird::Eagle => Species::Eagle,
        Bird::Owl => Species::Owl,
    };
    let view = match args.view {
        SeenFrom::Front => View::Front,
        SeenFrom::Side => View::Side,
        SeenFrom::Back => View::Back,
        SeenFrom::Head => View::Head,
    };
    let subject = Subject::open(&args.picture, &args.mask)?;
    if let Some(file) = &args.marks {
        let marks = subject.marks(species);
        let (width, height) = subject.size();
        image::RgbImage::from_raw(width as u32, height as u32, marks)
            .ok_or("the picture has another size")?
            .save(file)?;
    }
    let lines = subject.judge(species, view);
    let name = args.picture.file_stem().unwrap_or_default();
    for line in &lines {
        let verdict = if line.passes() { "pass" } else { "fail" };
        println!(
            "| {} | {} | {} | {:.3} | {:.3} to {:.3} | {verdict} |",
            name.display(),
            line.number,
            line.what,
            line.found,
            line.wanted.0,
            line.wanted.1
        );
    }
    Ok(if lines.iter().all(|line| line.passes()) {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    })
}
