//! The dolly through the switches: where the chooser changes its mind, the coverage may not jump.

use bevy_plumage::maths::query::{Cell, Local};
use plumage_tests::{
    stability::{self, Step},
    sweep::{self, between},
};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

/// Scenes, and steps of the dolly between which flips are looked for.
const SCENES: usize = 400;
const STEPS: usize = 160;

/// A footprint whose size is `exp(x)` of its largest.
struct Scene {
    cell: Cell<f64>,
    spacing: f64,
    least: f64,
    ratio: f64,
    angle: f64,
    u: f64,
    tau: f64,
}

impl Scene {
    fn random(random: &mut Pcg64Mcg, masked: bool) -> Self {
        let (cell, spacing, sin_bl) = sweep::random_cell(random, masked);
        Self {
            cell,
            spacing,
            least: (0.01 * spacing * sin_bl).ln(),
            ratio: 2f64.powf(between(random, 0.0, 4.0)),
            angle: between(random, 0.0, std::f64::consts::PI),
            u: between(random, 0.0, 1.0),
            tau: between(random, -0.5, 0.5),
        }
    }

    fn size(&self, x: f64) -> f64 {
        self.least + (10f64.ln() - self.least) * x
    }

    fn local(&self, x: f64) -> Local<f64> {
        let major = self.size(x).exp();
        sweep::local(
            self.u,
            self.tau,
            major,
            major / self.ratio,
            self.angle,
            self.spacing,
        )
    }
}

#[test]
fn switches_do_not_jump() {
    let mut random = Pcg64Mcg::seed_from_u64(401);
    // Of the summed coverage, which is what shows, and of a component.
    let bounds = [1.0 / 255.0, 2.0 / 255.0];
    let mut flips = 0;
    let mut worst = ([0.0f64; 2], 0.0, None);
    for i in 0..SCENES {
        let scene = Scene::random(&mut random, i % 2 == 1);
        let kind = |x: f64| stability::kind(&scene.cell, &scene.local(x));
        for j in 0..STEPS {
            let (mut low, mut high) = (j as f64 / STEPS as f64, (j + 1) as f64 / STEPS as f64);
            let before = kind(low);
            if before == kind(high) {
                continue;
            }
            // Closes in on the flip, until the footprint itself hardly changes any more.
            for _ in 0..16 {
                let middle = 0.5 * (low + high);
                if kind(middle) == before {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            flips += 1;
            let a = stability::value(&scene.cell, &scene.local(low));
            let b = stability::value(&scene.cell, &scene.local(high));
            let change = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
            let component = change.iter().fold(0.0, |m: f64, e| m.max(e.abs()));
            let sum = change.iter().sum::<f64>().abs();
            let badness = |jump: [f64; 2]| (jump[0] / bounds[0]).max(jump[1] / bounds[1]);
            if badness([sum, component]) > badness(worst.0) {
                worst = ([sum, component], low, Some((before, kind(high), i)));
            }
        }
    }
    let ([sum, component], at, kinds) = worst;
    eprintln!(
        "{flips} flips, largest jump {component:.5} of a component, {sum:.5} of the sum, {kinds:?}"
    );
    assert!(flips > SCENES, "only {flips} flips");
    if sum > bounds[0] || component > bounds[1] {
        let mut random = Pcg64Mcg::seed_from_u64(401);
        let scenes: Vec<Scene> = (0..SCENES)
            .map(|i| Scene::random(&mut random, i % 2 == 1))
            .collect();
        let scene = &scenes[kinds.map_or(0, |k| k.2)];
        let steps: Vec<Step> = (-40..=40)
            .map(|j| at + 0.002 * f64::from(j))
            .map(|x| Step::new(scene.size(x), &scene.cell, &scene.local(x)))
            .collect();
        let file = stability::failure_file("stability_switch");
        let title = format!("Jump of {component:.4} (sum {sum:.4}) at a switch, {kinds:?}");
        let label = "ln of the major axis in barb periods";
        stability::draw(&file, &title, label, &steps, bounds[0]);
        panic!("{title}, picture {}", file.display());
    }
}
