//! Light found at the ends of a span and interpolated, as cards of the class LIT do: what it is off in the middle, over how far the span
//! turns. Everything else is exact here, so a change of the lobes shows first in this test.

use bevy_plumage::maths::vertex_light::{grazing_light, vertex_light_error};
use plumage_reference::{fibre_traced::uniform, judged::PaintedVane};
use plumage_tests::cases::on_sphere;
use rand_pcg::Pcg64Mcg;
use std::f64::consts::PI;

/// Spans of each vane.
const COUNT: usize = 2000;
/// Irradiance of a sun, and radiance of a sky that is everywhere.
const SUN: f64 = 0.9 * PI;
const SKY: f64 = 0.12;

fn turned([x, y, z]: [f64; 3], angle: f64, about: f64) -> [f64; 3] {
    // About an axis in the card.
    let (s, c) = about.sin_cos();
    let (across, along) = (c * x + s * y, c * y - s * x);
    let (sin, cos) = angle.sin_cos();
    let (across, up) = (across * cos + z * sin, z * cos - across * sin);
    [c * across - s * along, s * across + c * along, up]
}

/// By a film's curve (Narkowicz' fit of ACES).
fn shown(radiance: f64) -> f64 {
    let x = (radiance + SKY * 0.4).max(0.0);
    let x = (x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)).clamp(0.0, 1.0);
    let encoded = if x <= 0.003_130_8 {
        12.92 * x
    } else {
        1.055 * x.powf(1.0 / 2.4) - 0.055
    };
    255.0 * encoded
}

struct Span {
    /// Steps of 255 that the middle is off.
    error: f64,
    /// Least of the cosines to eye and light.
    facing: f64,
    weight: f64,
}

fn spans(degrees: f64) -> Vec<Span> {
    let mut random = Pcg64Mcg::new(5);
    let half = 0.5 * degrees.to_radians();
    let mut spans = Vec::new();
    let vanes = [("covert", 0.3), ("remex", 0.4), ("eagle", 1.0)];
    for (number, (name, color)) in (1..).zip(vanes) {
        let vane = PaintedVane::new(name, color).unwrap();
        while spans.len() < number * COUNT {
            let [eye, light] = [0; 2].map(|_| on_sphere(&mut random).map(f64::from));
            let about = 2.0 * PI * uniform(&mut random);
            let at = |angle: f64| {
                let [eye, light] = [eye, light].map(|v| turned(v, angle, about));
                (vane.radiance(eye, light), eye[2])
            };
            let ends = [at(-half), at(half)];
            // Ends that show opposite faces are of no use in any way.
            if eye[2].abs() < 0.02 || ends[0].1 * ends[1].1 <= 0.0 {
                continue;
            }
            let middle = SUN * at(0.0).0;
            let mean = SUN * 0.5 * (ends[0].0 + ends[1].0);
            spans.push(Span {
                error: shown(mean) - shown(middle),
                facing: eye[2].abs().min(light[2].abs()),
                weight: eye[2].abs(),
            });
        }
    }
    spans
}

/// Root mean square and 99th percentile, by projected area.
fn rms_and_most(spans: &[Span]) -> [f64; 2] {
    let all: f64 = spans.iter().map(|s| s.weight).sum();
    let square: f64 = spans.iter().map(|s| s.weight * s.error * s.error).sum();
    let mut order: Vec<(f64, f64)> = spans.iter().map(|s| (s.error.abs(), s.weight)).collect();
    order.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut above = 0.0;
    let most = order.iter().find(|(_, weight)| {
        above += weight;
        above > 0.01 * all
    });
    [(square / all).sqrt(), most.map_or(0.0, |(error, _)| *error)]
}

#[test]
fn light_between_vertices_is_off_by_as_much_as_is_said() {
    for (degrees, rms, most) in [(2.5, 1.3, 3.1), (5.0, 2.7, 8.2), (10.0, 5.2, 19.5)] {
        let all = spans(degrees);
        let found = rms_and_most(&all);
        println!(
            "{degrees} degrees: RMS {:.2}, 99 % {:.2}",
            found[0], found[1]
        );
        let (facing, along): (Vec<Span>, Vec<Span>) =
            all.into_iter().partition(|span| span.facing > 0.35);
        let [facing, along] = [facing, along].map(|spans| rms_and_most(&spans)[0]);
        println!("  faced {facing:.2}, along the card {along:.2}");
        assert!(
            found[0] <= rms && found[1] <= most,
            "{degrees} degrees: {found:?}"
        );
        // The rule that chooses cards knows which of them are worse.
        let of =
            |facing| vertex_light_error(degrees, facing, [facing; 2], [0.0; 2], [1.0, 0.0], 0.0);
        let said = of(0.0) / of(0.9);
        assert!(
            along > 1.8 * facing && said > 1.8,
            "{along} and {facing}, said {said}"
        );
    }
}

/// Where a light passes along a card and the eye does not, what paint adds goes through zero with a fold: over [`grazing_light`] it changes
/// evenly. Of structural fibres it is a mirror's, whose glints fall between the vertices in either way.
#[test]
fn paint_under_a_light_along_the_card_is_interpolated_over_its_fading() {
    let mut random = Pcg64Mcg::new(6);
    let half = 7.5f64.to_radians();
    // Color and black; RMS and mean of the errors over those of plain interpolation, at most.
    for (name, [color, black], most) in [
        ("covert", [0.3, 30.0], [0.5, 0.2]),
        ("remex", [0.4, 0.0], [0.95, 0.3]),
        ("eagle", [1.0, 30.0], [0.5, 0.2]),
    ] {
        let [vane, dark] = [color, black].map(|color| PaintedVane::new(name, color).unwrap());
        let (mut paint, mut plain, mut faded) = (Vec::new(), Vec::new(), Vec::new());
        while paint.len() < COUNT {
            let [eye, light] = [0; 2].map(|_| on_sphere(&mut random).map(f64::from));
            let about = 2.0 * PI * uniform(&mut random);
            if eye[2] < 0.4 || light[2].abs() > 0.2 {
                continue;
            }
            let at = |angle: f64| {
                let [eye, light] = [eye, light].map(|v| turned(v, angle, about));
                let paint = vane.radiance(eye, light) - dark.radiance(eye, light);
                (paint, grazing_light(light[2]))
            };
            let [low, high, middle] = [-half, half, 0.0].map(at);
            paint.push(middle.0);
            plain.push(0.5 * (low.0 + high.0) - middle.0);
            faded.push(0.5 * middle.1 * (low.0 / low.1 + high.0 / high.1) - middle.0);
        }
        let mean = |list: &[f64]| list.iter().sum::<f64>() / list.len() as f64;
        let rms = |list: &[f64]| mean(&list.iter().map(|x| x * x).collect::<Vec<_>>()).sqrt();
        let [plain, faded] = [plain, faded].map(|list| [rms(&list), mean(&list)]);
        println!(
            "{name}: paint {:.4}; RMS and mean of the errors {plain:.5?}, over the fading {faded:.5?}",
            mean(&paint)
        );
        for (i, most) in most.into_iter().enumerate() {
            assert!(faded[i].abs() <= most * plain[i].abs(), "{name}");
        }
    }
}
