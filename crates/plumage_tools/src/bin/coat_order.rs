//! Prints how much of a bird's coat is out of order: pixels that show a feather which another one should cover, by part of the
//! body, in bind pose and over the idle clip, without a GPU.
//!
//! `cargo run -p plumage_tools --bin coat_order -- parrot --output order.png`: the picture has a row for each time asked for and a column
//! for each view; wrong pixels are red, those of another color too are yellow.

use bevy::math::Vec3;
use bevy_plumage::{Wind, groom::Coat};
use clap::Parser;
use plumage_reference::{crossing::Overlaps, visible::Pixel};
use plumage_tests::{
    air::Air,
    order::{Measured, STEP, Tally},
    scene_bird::SceneBird,
};
use std::{collections::BTreeMap, path::Path, time::Instant};

/// What to measure.
#[derive(Parser)]
struct Args {
    /// Name of the bird and its groom, or a binary glTF file, which gets the groom of meshes without one.
    bird: String,
    /// Number of the clip that moves the model of a file.
    #[arg(long, default_value_t = 0)]
    clip: usize,
    /// Leaves the feathers as they grow.
    #[arg(long)]
    unsettled: bool,
    /// Phases of the idle clip.
    #[arg(long, default_value_t = 12)]
    phases: usize,
    /// Side of a picture, pixels.
    #[arg(long, default_value_t = 300)]
    size: usize,
    /// Depth within which the order decides at most, widths of a feather, as `FeatherSettings::order_window`. Of further ones only the
    /// mean of all phases is printed.
    #[arg(long, num_args = 1.., default_values_t = [0.5])]
    window: Vec<f32>,
    /// Seed.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Density of the plumage.
    #[arg(long, default_value_t = 1.0)]
    density: f32,
    /// Measure flicker too.
    #[arg(long)]
    flicker: bool,
    /// Print the tracts that are most often in the wrong order.
    #[arg(long)]
    tracts: bool,
    /// Count the pairs that poke through each other, too.
    #[arg(long)]
    pairs: bool,
    /// Ruffles the coat, as `Ruffle::amount`.
    #[arg(long, default_value_t = 0.0)]
    ruffle: f32,
    /// Wind with gusts of as much again, m/s.
    #[arg(long, default_value_t = 0.0)]
    wind: f32,
    /// Where it blows to; the default comes from behind and opens the coat.
    #[arg(long, num_args = 3, allow_negative_numbers = true, default_values_t = [0.3, 0.0, 1.0])]
    towards: Vec<f32>,
    /// Picture of the wrong pixels.
    #[arg(long)]
    output: Option<String>,
    /// Settles the coat at this time of the clip instead of in the groom's own pose, seconds.
    #[arg(long)]
    pose: Option<f32>,
    /// Settles it at this time of the clip, too, seconds.
    #[arg(long)]
    further: Option<f32>,
    /// Prints that pose for a groom file.
    #[arg(long)]
    print: bool,
    /// Times of the clip in the picture, seconds.
    #[arg(long, num_args = 1.., default_values_t = [0.0])]
    times: Vec<f32>,
}

fn line(name: &str, tally: &Tally) {
    let all = &tally.all;
    let [layers, backs_last] = all.passing_depth();
    println!(
        "{name:>10}: {:6.2} % wrong, {:6.2} % wrong color, flicker {:.3} % ({:.3} % passing, {:.3} % borders), body painted over {:.3} %, body {:.3} %, {:.2} shaded, without a prepass {backs_last:.2} ({layers:.2} by layers alone), {} px",
        all.wrong(),
        all.color(),
        all.flicker(),
        all.passing(),
        all.borders(),
        all.painted(),
        all.bare(),
        all.shaded(),
        all.feathers
    );
}

/// Depth from which a pair counts as crossing, metres.
const DEEP: f32 = 3.0e-4;

fn pairs(name: &str, found: &Overlaps) {
    println!(
        "{name:>10}: {} pairs, {:.2} % deeper than 0.3 mm, {:.2} % deeper than 1 mm",
        found.list.len(),
        100.0 * found.share(DEEP),
        100.0 * found.share(1.0e-3)
    );
}

/// Tracts printed at most.
const TRACTS: usize = 16;

fn tracts(bird: &SceneBird, sum: &Tally) {
    let regions = bird.groom.regions.iter().map(|region| &region.name);
    let names: Vec<&String> = regions
        .chain(bird.groom.rows.iter().map(|row| &row.name))
        .collect();
    let name = |region: &u16| names.get(usize::from(*region)).map_or("?", |name| name);
    print_most(sum, &sum.tracts, |shown, missing| {
        format!("{} shows instead of {}", name(shown), name(missing))
    });
    print_most(sum, &sum.colors, |shown, missing| {
        format!(
            "{} shows in another color than {}",
            name(shown),
            name(missing)
        )
    });
    print_most(sum, &sum.flickers, |before, after| {
        format!("{} flickers to {}", name(before), name(after))
    });
    println!(
        "  {:.3} % flicker and are wrong before or after",
        100.0 * sum.unsettled as f32 / sum.all.feathers.max(1) as f32
    );
}

/// Prints the most frequent pairs of tracts.
fn print_most(
    sum: &Tally,
    pairs: &BTreeMap<(u16, u16), usize>,
    text: impl Fn(&u16, &u16) -> String,
) {
    let mut worst: Vec<_> = pairs.iter().collect();
    worst.sort_by_key(|(_, count)| std::cmp::Reverse(**count));
    for ((a, b), count) in worst.into_iter().take(TRACTS) {
        let share = 100.0 * *count as f32 / sum.all.feathers.max(1) as f32;
        println!("  {share:.3} %: {}", text(a, b));
    }
}

/// How far vertices stand off, and what that takes.
fn heights(coat: &Coat) {
    let vertices = coat.mesh.count_vertices();
    println!(
        "  heights at most {:.1} mm, {} poses, {:.3} MB each",
        1.0e3 * coat.moved,
        coat.worn.count(),
        8.0 * vertices as f32 / 4.0e6,
    );
}

fn gaps(sum: &Tally) {
    let all = sum.gaps.iter().sum::<usize>().max(1) as f32;
    let shares = sum
        .gaps
        .iter()
        .map(|count| format!("{:.0}", 100.0 * *count as f32 / all));
    let shares: Vec<String> = shares.collect();
    println!(
        "  right feather behind by steps of {STEP} widths: {} %",
        shares.join(" ")
    );
}

fn main() {
    let args = Args::parse();
    let mut bird = if args.bird.ends_with(".glb") {
        match SceneBird::read(Path::new(&args.bird), args.clip) {
            Ok(bird) => bird,
            Err(error) => {
                eprintln!("{error}");
                std::process::exit(1);
            }
        }
    } else {
        SceneBird::load(&args.bird)
    };
    if let Some(time) = args.pose {
        let pose = bird.key_pose("rest", time);
        if args.print {
            for joint in &pose.joints {
                println!("{joint:?}");
            }
        }
        bird.groom.poses = vec![pose];
    }
    if let Some(time) = args.further {
        let pose = bird.key_pose("further", time);
        bird.groom.poses.push(pose);
    }
    let begun = Instant::now();
    let coat: Coat = if args.unsettled {
        bird.groom_unsettled(args.seed, args.density)
    } else {
        bird.groom(args.seed, args.density)
    };
    println!(
        "{}: {} cards in {:.2} s",
        args.bird,
        coat.cards.len(),
        begun.elapsed().as_secs_f32()
    );
    heights(&coat);
    let mut measured = Measured::new(&bird, &coat, args.size, args.window[0]);
    measured.air = Air {
        ruffle: args.ruffle,
        wind: Wind::new(Vec3::from_slice(&args.towards), args.wind),
    };
    line("bind", &measured.tally(None, false));
    if args.pairs {
        pairs("bind", &measured.pairs(None));
        pairs("rest", &measured.pairs(Some(0.0)));
    }
    let mut sum = Tally::default();
    for time in measured.phases(args.phases) {
        let tally = measured.tally(Some(time), args.flicker);
        line(&format!("{time:.2} s"), &tally);
        sum.add(&tally);
    }
    line("idle", &sum);
    for (part, count) in &sum.parts {
        println!(
            "  {part:<28} {:6.2} % wrong, {:6.2} % wrong color, {} px",
            count.wrong(),
            count.color(),
            count.feathers
        );
    }
    if args.tracts {
        tracts(&bird, &sum);
        gaps(&sum);
    }
    for window in &args.window[1..] {
        measured.window = *window;
        let mut sum = Tally::default();
        for time in measured.phases(args.phases) {
            sum.add(&measured.tally(Some(time), false));
        }
        line(&format!("window {window}"), &sum);
    }
    if let Some(output) = &args.output {
        if let Err(error) = picture(&measured, &args.times).save(output) {
            eprintln!("{output}: {error}");
            std::process::exit(1);
        }
        println!("wrote {output}");
    }
}

/// The pixels in their tints, the wrong ones marked.
fn picture(measured: &Measured, times: &[f32]) -> image::RgbImage {
    let size = measured.size as u32;
    let mut picture = image::RgbImage::new(1, 1);
    for (row, time) in times.iter().enumerate() {
        let pose = measured.pose(Some(*time));
        let views = measured.views(&pose);
        if row == 0 {
            picture = image::RgbImage::new(size * views.len() as u32, size * times.len() as u32);
        }
        for (column, view) in views.iter().enumerate() {
            let (layers, pixels) = measured.judge(&pose, view);
            for (number, pixel) in pixels.iter().enumerate() {
                let tint = |card: u32| {
                    let shown = layers.at(number).iter().find(|f| f.card == card);
                    let along = shown.map_or(1.0, |fragment| fragment.along);
                    let card = &measured.coat.cards[card as usize];
                    Vec3::from_array(card.tint) * (0.5 + 0.5 * along)
                };
                let color = match *pixel {
                    Pixel::Empty => Vec3::splat(0.5),
                    Pixel::Right(card) => tint(card),
                    Pixel::Wrong(..) => Vec3::new(0.9, 0.02, 0.02),
                    Pixel::WrongColor(..) => Vec3::new(0.95, 0.9, 0.02),
                };
                let srgb = color
                    .to_array()
                    .map(|x| (x.clamp(0.0, 1.0).powf(1.0 / 2.2) * 255.0) as u8);
                picture.put_pixel(
                    column as u32 * size + number as u32 % size,
                    row as u32 * size + number as u32 / size,
                    image::Rgb(srgb),
                );
            }
        }
    }
    picture
}
