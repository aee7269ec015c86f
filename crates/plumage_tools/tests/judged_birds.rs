//! Hue, saturation and contrast of birds as their examples show them, by the judge of pictures: within the bands of photographs.

use plumage_tests::gpu;
use plumage_tools::judge::{Line, Species, Subject, View};
use std::{env, error::Error, fs, path::Path, process::Command};

const SIZE: &str = "800x600";
const FRAMES: &str = "4";
/// Numbers of the lines that are judged: colors, and contrast by scale.
const LINES: [u32; 2] = [6, 7];

/// What the judge finds in the picture that an example makes of its whole scene.
fn judged(example: &str, species: Species) -> Result<Vec<Line>, Box<dyn Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let built = Command::new(cargo)
        .current_dir(&root)
        .args(["build", "--workspace", "--all-features"])
        .args(["--example", example])
        .status()?;
    assert!(built.success(), "{example} does not build");
    let test = env::current_exe()?;
    let profile = test.ancestors().nth(2).ok_or("no target folder")?;
    let folder = root.join("target/judged_birds");
    fs::create_dir_all(&folder)?;
    let (picture, masks) = (folder.join(format!("{example}.png")), folder.join("masks"));
    let drawn = Command::new(profile.join("examples").join(example))
        .args(["--headless", "--size", SIZE, "--accumulate", FRAMES])
        .arg("--assets")
        .arg(root.join("assets"))
        .arg("--shot")
        .arg(format!("hero={}", picture.display()))
        .arg("--masks")
        .arg(&masks)
        .status()?;
    assert!(drawn.success(), "{example} does not draw");
    let mask = masks.join(format!("{example}.png"));
    let subject = Subject::open(&picture, &mask)?;
    Ok(subject.judge(species, View::Front))
}

fn looks_like_photographs(example: &str, species: Species) {
    if gpu::device().is_none() {
        return;
    }
    let lines = judged(example, species).unwrap();
    let judged: Vec<_> = lines.iter().filter(|l| LINES.contains(&l.number)).collect();
    for line in &judged {
        println!(
            "{example}, {}: {:.3} of {:?}",
            line.what, line.found, line.wanted
        );
    }
    assert!(judged.len() > 5, "the breast is judged");
    let off: Vec<_> = judged.iter().filter(|line| !line.passes()).collect();
    assert!(off.is_empty(), "{example}: {off:?}");
}

#[test]
fn a_macaw_has_the_hue_and_contrast_of_photographs() {
    looks_like_photographs("parrot", Species::Macaw);
}

#[test]
fn an_eagle_has_the_hue_and_contrast_of_photographs() {
    looks_like_photographs("eagle", Species::Eagle);
}
