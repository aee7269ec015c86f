//! The light of a vane against frozen figures of Mitsuba 3 (`make judge` takes them anew).

use plumage_reference::judged::{Judged, TABLE, Verdict, WhiteFibre, furnace_by_lights, judge};

/// Root mean square and largest error of a list, and where the largest is.
fn errors(list: &[&Judged]) -> (f64, f64, String) {
    let square: f64 = list.iter().map(|j| j.error().powi(2)).sum();
    let worst = list
        .iter()
        .max_by(|a, b| a.error().abs().total_cmp(&b.error().abs()));
    worst.map_or((f64::NAN, f64::NAN, String::new()), |worst| {
        let rms = (square / list.len() as f64).sqrt();
        (rms, worst.error().abs(), worst.name.clone())
    })
}

/// Figures of one vane and color that are at least a tenth of its brightest and not drowned in noise.
fn bright<'a>(list: &'a [Judged], name: &str) -> Vec<&'a Judged> {
    let all: Vec<_> = list.iter().filter(|j| j.name.starts_with(name)).collect();
    let peak = all.iter().map(|j| j.traced).fold(0.0, f64::max);
    all.into_iter()
        .filter(|j| j.traced > 0.1 * peak && j.traced > 8.0 * j.deviation)
        .collect()
}

fn verdict() -> Verdict {
    let verdict = judge(TABLE);
    assert!(verdict.coverage.len() > 300 && verdict.one.len() > 500);
    verdict
}

#[test]
fn one_fibre_has_the_energies_of_mitsuba() {
    for j in verdict().fibres {
        assert!(
            (j.model - j.traced).abs() < 0.005,
            "{}: {:.4}, Mitsuba {:.4}",
            j.name,
            j.model,
            j.traced
        );
    }
}

#[test]
fn coverage_is_that_of_mitsuba() {
    let mut worst = 0.0_f64;
    for j in verdict().coverage {
        worst = worst.max((j.model - j.traced).abs());
        assert!(
            (j.model - j.traced).abs() < 0.01,
            "{}: {:.4}, Mitsuba {:.4}",
            j.name,
            j.model,
            j.traced
        );
    }
    println!("coverage and open area, largest difference: {worst:.4}");
}

#[test]
fn light_from_all_around_comes_back() {
    for j in verdict().furnace {
        let white = j.traced > 0.999;
        // A white fibre has an albedo of 0.995.
        let wanted = if white { 0.991 } else { j.traced };
        let limit = if white { 0.005 } else { 0.0125 };
        assert!(
            (j.model - wanted).abs() < limit,
            "{}: {:.4}, Mitsuba {:.4}",
            j.name,
            j.model,
            j.traced
        );
    }
}

#[test]
fn white_vanes_keep_all_light() {
    // Eighteen eyes, some between those of the table; a white fibre has an albedo of 0.995, so a vane of them 0.991.
    let fibres = [
        (WhiteFibre::Pigment, 0.005),
        (WhiteFibre::Structural, 0.01),
        (WhiteFibre::Diffuse, 0.01),
    ];
    for (fibres, limit) in fibres {
        let mut worst = 0.0_f64;
        for theta in [0.0_f64, 30.0, 60.0] {
            for azimuth in [0.0_f64, 22.5, 90.0] {
                for up in [1.0, -1.0] {
                    let (sin, cos) = theta.to_radians().sin_cos();
                    let (y, x) = azimuth.to_radians().sin_cos();
                    let eye = [sin * x, sin * y, up * cos];
                    let back = furnace_by_lights(fibres, eye).unwrap();
                    worst = worst.max((back - 0.991).abs());
                    assert!(
                        (back - 0.991).abs() < limit,
                        "{fibres:?} {eye:?}: {back:.4}"
                    );
                }
            }
        }
        println!("white furnace, {fibres:?}: within {worst:.4} of 0.991");
    }
}

#[test]
fn light_of_a_vane_is_that_of_mitsuba() {
    let verdict = verdict();
    // Vane and color; root mean square and largest error of light that met one fibre, and of all light.
    let bounds = [
        ("covert 0 ", [0.03, 0.075], [0.03, 0.08]),
        ("covert 0.2 ", [0.035, 0.12], [0.033, 0.1]),
        ("covert 1 ", [0.042, 0.1], [0.043, 0.095]),
        ("eagle 0 ", [0.03, 0.075], [0.031, 0.08]),
        ("eagle 0.2 ", [0.037, 0.12], [0.033, 0.085]),
        ("eagle 1 ", [0.04, 0.08], [0.043, 0.085]),
        ("remex 1 ", [0.033, 0.1], [0.09, 0.27]),
        ("remex 0.5 ", [0.03, 0.11], [0.042, 0.085]),
    ];
    for (name, one, all) in bounds {
        for (list, [rms, largest], what) in
            [(&verdict.one, one, "one fibre"), (&verdict.all, all, "all")]
        {
            let chosen = bright(list, name);
            let found = errors(&chosen);
            println!(
                "{name}{what}: {} pairs, RMS {:.3}, largest {:.3} at {}",
                chosen.len(),
                found.0,
                found.1,
                found.2
            );
            assert!(chosen.len() >= 14, "{name}: {}", chosen.len());
            assert!(
                found.0 < rms && found.1 < largest,
                "{name}{what}: {found:?}"
            );
        }
    }
}
