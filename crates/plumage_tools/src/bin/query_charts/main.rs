//! Error over cost of every way to answer a range query, measured in one run: charts, their figures, and what follows.
//!
//! `make charts`, or `cargo run --config 'profile.dev.opt-level=3' -p plumage_tools --bin query_charts [folder]` (default `docs/charts`)

mod charts;
mod divergence;
mod gpu;
mod measure;
mod methods;
mod report;
mod statements;

use charts::{Cost, Measure};
use measure::{ASPECTS, Part, SCALES};
use std::{env, error::Error, fs, path::Path};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = env::args().nth(1).unwrap_or_else(|| "docs/charts".into());
    let folder = Path::new(&folder);
    fs::create_dir_all(folder)?;
    let gpu = gpu::Gpu::open();
    if gpu.is_none() {
        eprintln!("no GPU with timestamps: costs on the CPU only");
    }
    let adapter = gpu.as_ref().map_or("no GPU", |g| g.name.as_str());
    let subtitle = format!("{}, {adapter}, {}", report::processor(), report::date());
    let measured = measure::measure(gpu.as_ref());

    let draw_all = |cost: Cost, suffix: &str| -> Result<(), Box<dyn Error>> {
        charts::single(
            &folder.join(format!("query_error_{suffix}.svg")),
            "The chooser is on the front at every error below 0.01",
            &subtitle,
            &measured,
            cost,
            Measure::Rms,
        )?;
        let scales: Vec<_> = (0..SCALES)
            .map(|i| (Part::Scale(i), Measure::Rms, report::scale_name(i)))
            .collect();
        charts::panels(
            &folder.join(format!("query_scale_{suffix}.svg")),
            "RMS error over cost, by the footprint's size: far away the published sums grow, ours do not",
            &subtitle,
            &measured,
            cost,
            &scales,
            4,
        )?;
        let aspects: Vec<_> = (0..ASPECTS)
            .map(|i| (Part::Aspect(i), Measure::Rms, report::aspect_name(i)))
            .collect();
        charts::panels(
            &folder.join(format!("query_aspect_{suffix}.svg")),
            "RMS error over cost, by the footprint's shape: thin ones are dearer, not worse",
            &subtitle,
            &measured,
            cost,
            &aspects,
            5,
        )?;
        let kinds: Vec<_> = report::kinds(&measured)
            .into_iter()
            .map(|kind| {
                let name = format!("where {} is chosen", format!("{kind:?}").to_uppercase());
                (Part::Kind(kind), Measure::Rms, name)
            })
            .collect();
        charts::panels(
            &folder.join(format!("query_evaluator_{suffix}.svg")),
            "RMS error over cost, by the evaluator that is chosen",
            &subtitle,
            &measured,
            cost,
            &kinds,
            kinds.len(),
        )
    };
    draw_all(Cost::Cpu, "cpu")?;
    if gpu.is_some() {
        draw_all(Cost::Gpu, "gpu")?;
    }
    let worst = [Measure::P99, Measure::Max].map(|m| (Part::All, m, m.name().to_owned()));
    charts::panels(
        &folder.join("query_worst_cpu.svg"),
        "Worst cases over cost",
        &subtitle,
        &measured,
        Cost::Cpu,
        &worst,
        2,
    )?;

    let divergence = gpu.as_ref().map_or_else(Vec::new, divergence::measure);
    report::write(folder, &subtitle, &measured, &divergence)
}
