//! Tables of what frames run: feathers beside the same cards in a `StandardMaterial`.

use super::{
    Args, Result,
    frames::{FRAGMENT, Ran, Run, VERTEX, count, plain},
    root,
};
use std::{fmt::Write, fs, path::Path};

/// Name, example, shot.
const PICTURES: [(&str, &str, &str); 4] = [
    ("hero", "parrot", "hero"),
    ("far", "parrot", "far"),
    ("eagle", "eagle", "hero"),
    ("closeup", "parrot", "closeup"),
];
/// Slots a second: 82 units of 128 lanes at 1.7 GHz, half of which share their port with integers, as a third of what runs is.
const RATE: f64 = 82.0 * 128.0 * 1.7e9 * 0.75;
/// Share of it that is reached: stalls, instruction cache, tails. A guess; 0.35 to 0.8 is possible.
const EFFICIENCY: f64 = 0.6;
/// Slots of a wave over those of its lanes.
const DIVERGENCE: f64 = 1.1;

/// A frame in numbers.
#[derive(Default)]
struct Sums {
    fragments: f64,
    early: f64,
    kept: f64,
    pixels: f64,
    /// Slots of early fragments, each instruction once, and as they ran.
    compiled: f64,
    ran: f64,
    /// Slots of the frame: vertices, shadow maps, and early fragments of depth and color.
    frame: f64,
    /// Milliseconds where all fragments run, and where only those do that pass the depth test before.
    most: f64,
    least: f64,
}

fn ms(lanes: f64, slots: f64) -> f64 {
    lanes * slots * DIVERGENCE / (RATE * EFFICIENCY) * 1e3
}

fn each(run: &Run) -> f64 {
    run.slots / run.invocations.max(1.0)
}

/// `of`: beginning of the names of what is summed.
fn sums(ran: &[Ran], of: &[&str]) -> Sums {
    let mut own = Sums::default();
    for pipeline in ran {
        if !of.iter().any(|name| pipeline.name.starts_with(name)) {
            continue;
        }
        if let Some(run) = pipeline.stages.get(&VERTEX) {
            own.frame += run.slots;
            let time = ms(run.invocations, each(run));
            own.most += time;
            own.least += time;
        }
        let Some(run) = pipeline.stages.get(&FRAGMENT) else {
            continue;
        };
        if pipeline.name.ends_with("shadow") {
            own.frame += run.slots;
            own.most += ms(run.invocations, each(run));
            own.least += ms(run.invocations, each(run));
            continue;
        }
        own.frame += run.early * each(run);
        own.most += ms(4.0 * run.quads, each(run));
        own.least += ms(4.0 * run.early_quads, each(run));
        if pipeline.name.ends_with("prepass") {
            continue;
        }
        own.fragments += run.invocations;
        own.early += run.early;
        own.kept += run.kept;
        own.pixels += run.pixels;
        own.compiled += run.early * run.compiled.slots as f64;
        own.ran += run.early * each(run);
    }
    own
}

fn rows(text: &mut String, what: &str, ran: &[Ran]) -> Result<()> {
    let mut ran: Vec<&Ran> = ran.iter().collect();
    let weight = |ran: &&Ran| -ran.stages.values().map(|run| run.slots).sum::<f64>();
    ran.sort_by(|a, b| weight(a).total_cmp(&weight(b)));
    for pipeline in ran {
        let vertex = pipeline.stages.get(&VERTEX).cloned().unwrap_or_default();
        let run = pipeline.stages.get(&FRAGMENT).cloned().unwrap_or_default();
        writeln!(
            text,
            "| {what} | {} | {} | {} | {:.0} | {} | {:.0} | {:.0} | {:.0} | {} | {:.0} | {:.2} |",
            pipeline.name,
            vertex.invocations,
            vertex.compiled.slots,
            each(&vertex),
            run.invocations,
            run.quads,
            run.early,
            run.kept,
            run.compiled.slots,
            each(&run),
            (vertex.slots + run.slots) / 1e9,
        )?;
    }
    Ok(())
}

/// Slots an invocation of each function that has a hundredth of a stage.
fn functions(text: &mut String, ran: &[Ran]) -> Result<()> {
    text.push_str("\n| pipeline | stage | function | slots, ran |\n|---|---|---|---|\n");
    for pipeline in ran.iter().filter(|ran| ran.name.starts_with("feathers")) {
        for (bit, run) in &pipeline.stages {
            let stage = if *bit == VERTEX { "vertex" } else { "fragment" };
            let mut list: Vec<_> = run.functions.iter().collect();
            list.retain(|(_, slots)| **slots >= 0.01 * run.slots);
            list.sort_by(|a, b| b.1.total_cmp(a.1));
            for (name, slots) in list {
                let each = slots / run.invocations.max(1.0);
                writeln!(text, "| {} | {stage} | {name} | {each:.0} |", pipeline.name)?;
            }
        }
    }
    Ok(())
}

/// Channels of two pictures that differ, and all.
fn differing(a: &Path, b: &Path) -> Result<(usize, usize)> {
    let [a, b] = [a, b].map(image::open);
    let (a, b) = (a?.to_rgb8().into_raw(), b?.to_rgb8().into_raw());
    let count = a.iter().zip(&b).filter(|(a, b)| a != b).count();
    Ok((count, a.len()))
}

/// Counts and tells.
pub fn run(args: &Args, folder: &Path, state: &str) -> Result<String> {
    const FEATHERS: [&str; 1] = ["feathers"];
    const CARDS: [&str; 2] = ["StandardMaterial, cut out", "meshes, cut out, shadow"];
    let mut text = format!(
        "# What a frame runs, {state}\n\n`gpu_cost --pictures {} --transparency {}`, {} pixels, on a software renderer; slots of {}. Fragments: those that \
         run; llvmpipe has already left out those all of whose samples lie behind what was drawn before. Early: those \
         of them in front of all whole pixels drawn before; kept: no holes either. Slots: each instruction once, and as the blocks of the shader ran, by a model of its SPIR-V.\n",
        args.pictures.join(" "),
        args.transparency,
        args.size,
        args.family
    );
    for picture in &args.pictures {
        let known = PICTURES.iter().find(|(name, ..)| name == picture);
        let (_, example, shot) = known.ok_or(format!("no picture {picture}"))?;
        let base = [
            "--scene",
            "studio",
            "--camera",
            shot,
            "--time",
            "0",
            "--size",
            &args.size,
            "--transparency",
            &args.transparency,
        ];
        let with = |more: &[&str]| -> Vec<String> {
            let all = base.iter().chain(more);
            all.map(|word| (*word).to_owned()).collect()
        };
        let file = |what: &str| folder.join(format!("{picture}_{what}.png"));
        let of = |what: &str, more: &[&str]| {
            let tools = [args.driver.as_str(), args.family.as_str()];
            count(&root(), folder, tools, (example, &with(more)), &file(what))
        };
        let own = of("counted", &[])?;
        let prepared = of("prepass", &["--depth-prepass"])?;
        let cards = of("cards", &["--path", "fallback"])?;
        plain(&root(), example, &with(&[]), &file("plain"))?;
        let (wrong, all) = differing(&file("counted"), &file("plain"))?;
        writeln!(
            text,
            "\n## {picture}\n\n| frame | pipeline | vertices | slots, once | ran | fragments | quads | early | kept | slots, once | ran | \
             10^9 slots |\n|---|---|---|---|---|---|---|---|---|---|---|---|"
        )?;
        rows(&mut text, "feathers", &own)?;
        rows(&mut text, "after a prepass", &prepared)?;
        rows(&mut text, "cards", &cards)?;
        if args.functions {
            functions(&mut text, &own)?;
        }
        let [own, prepared] = [own, prepared].map(|ran| sums(&ran, &FEATHERS));
        let cards = sums(&cards, &CARDS);
        let ratio =
            |of: fn(&Sums) -> f64, sums: &Sums| of(sums) / sums.early / (of(&cards) / cards.early);
        writeln!(
            text,
            "\n- The picture with counters differs from the one without in {wrong} of {all} channels.\n\
             - Slots of an early feather fragment over a card's: {:.2} each instruction once, {:.2} as they ran ({:.0} and {:.0}); \
             of one that is kept, as they ran, {:.2}. Slots of all of the frame's feathers over all of its cards', early fragments, as \
             they ran: {:.2}, with a prepass {:.2}. Aim 1.5.\n\
             - Fragments a pixel of feathers ({:.0} pixels): {:.1} drawn, {:.2} early, {:.2} kept; after a prepass {:.2} early, {:.2} kept; \
             cards {:.1}, {:.2}, {:.2}. Aim 1.3.\n\
             - Estimated milliseconds (a guess within a factor of two): feathers {:.2} with every fragment, {:.2} with early ones; with a \
             prepass {:.2} and {:.2}; cards {:.2} and {:.2}. Aim 1.",
            ratio(|s| s.compiled, &own),
            ratio(|s| s.ran, &own),
            own.ran / own.early,
            cards.ran / cards.early,
            own.ran / own.kept / (cards.ran / cards.kept),
            own.frame / cards.frame,
            prepared.frame / cards.frame,
            own.pixels,
            own.fragments / own.pixels,
            own.early / own.pixels,
            own.kept / own.pixels,
            prepared.early / prepared.pixels,
            prepared.kept / prepared.pixels,
            cards.fragments / cards.pixels,
            cards.early / cards.pixels,
            cards.kept / cards.pixels,
            own.most,
            own.least,
            prepared.most,
            prepared.least,
            cards.most,
            cards.least,
        )?;
        fs::write(folder.join("pictures.md"), &text)?;
    }
    Ok(text)
}
