//! The facets' light from a sky: one look into a prefiltered map for every family, or for a whole vane, or samples, against all of it.

use super::{Truth, summary};
use bevy_plumage::maths::scattering::interference::*;
use plumage_reference::color_difference::{delta_e_2000, lab};
use plumage_tools::plot::{Labels, Result, draw};
use std::{f64::consts::TAU, path::Path};

/// Stacks that are judged.
const STACKS: [&str; 5] = [
    "anna_gorget",
    "peacock_green",
    "mallard_speculum",
    "pigeon_green",
    "bronzewing",
];
/// Angle between barbules and barb, degrees.
const BARBULE: f64 = 45.0;
/// Frames in which a vane is seen, and samples of the truth.
const FRAMES: usize = 24;
const MANY: usize = 16_384;

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn unit(a: [f64; 3]) -> [f64; 3] {
    let size = dot(a, a).sqrt();
    a.map(|x| x / size)
}

/// An even sky over darker ground, a bright window of clouds; no sun, which is a light of its own.
fn sky(direction: [f64; 3]) -> [f64; 3] {
    let up = direction[1];
    let t = 0.5 + 0.5 * (up / 0.2).tanh();
    let window = (dot(direction, unit([0.5, 0.6, 0.6])) - 0.75).max(0.0) * 12.0;
    [[0.18, 0.55], [0.16, 0.7], [0.12, 0.95]].map(|[low, high]| low + (high - low) * t + window)
}

/// Uniform numbers of a low-discrepancy sequence (Roberts' extension of the golden ratio).
fn uniform(i: usize) -> [f64; 3] {
    [0.819_172_513_4, 0.671_043_606_7, 0.549_700_477_9].map(|a| (0.5 + i as f64 * a).fract())
}

/// Mean of the sky over a lobe of a prefiltered map: half vectors of a GGX distribution about the direction, weighted by the cosine.
fn prefiltered(direction: [f64; 3], perceptual: f64) -> [f64; 3] {
    let a2 = (perceptual * perceptual).powi(2);
    let side = unit(if direction[1].abs() < 0.9 {
        [direction[2], 0.0, -direction[0]]
    } else {
        [0.0, -direction[2], direction[1]]
    });
    let up = [
        direction[1] * side[2] - direction[2] * side[1],
        direction[2] * side[0] - direction[0] * side[2],
        direction[0] * side[1] - direction[1] * side[0],
    ];
    let (mut sum, mut weight) = ([0.0; 3], 0.0);
    for i in 0..1_024 {
        let [u, v, _] = uniform(i);
        let cos2 = (1.0 - u) / (1.0 + (a2 - 1.0) * u);
        let (sin, cos) = ((1.0 - cos2).max(0.0).sqrt(), cos2.sqrt());
        let (y, x) = (TAU * v).sin_cos();
        let half = [0, 1, 2].map(|k| sin * (x * side[k] + y * up[k]) + cos * direction[k]);
        let light: [f64; 3] = [0, 1, 2].map(|k| 2.0 * cos * half[k] - direction[k]);
        let facing = dot(light, direction);
        if facing > 0.0 {
            let seen = sky(light);
            sum = [0, 1, 2].map(|k| sum[k] + facing * seen[k]);
            weight += facing;
        }
    }
    sum.map(|x| x / weight)
}

/// One family in the world: card axes x, y, z; the barb along x.
struct Family {
    axes: [[f64; 3]; 3],
    rise: (f64, f64),
    lean: (f64, f64),
}

impl Family {
    fn new(layers: &Iridescence, sign: f64, card: [[f64; 3]; 3]) -> Self {
        let (sin, cos) = (sign * BARBULE.to_radians()).sin_cos();
        let mix = |a: f64, b: f64| [0, 1, 2].map(|k| a * card[0][k] + b * card[1][k]);
        let (rise, tilt) = (
            f64::from(layers.rise).to_radians().sin_cos(),
            f64::from(layers.tilt).to_radians().sin_cos(),
        );
        // Across the barbule the barb's direction is -sin: the lean goes there.
        Self {
            axes: [mix(cos, sin), mix(-sin, cos), card[2]],
            rise,
            lean: (if sin > 0.0 { -tilt.0 } else { tilt.0 }, tilt.1),
        }
    }

    fn local(&self, world: [f64; 3]) -> [f64; 3] {
        facet_turn(self.axes.map(|axis| dot(axis, world)), self.rise, self.lean)
    }

    /// Back to the world: the turn is orthogonal.
    fn world(&self, local: [f64; 3]) -> [f64; 3] {
        let rows = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
            .map(|axis| facet_turn(axis, self.rise, self.lean));
        let fibre = rows.map(|row| dot(row, local));
        [0, 1, 2].map(|k| (0..3).map(|i| fibre[i] * self.axes[i][k]).sum())
    }
}

/// Light of the facets by `count` samples of their own lobe.
fn sampled(eye: &FacetEye<f64>, table: &StackTable, family: &Family, count: usize) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for i in 0..count {
        if let Some(sample) = facet_sample(eye, uniform(i)) {
            let k = facet_evaluate(eye, table, sample.direction);
            let light = sky(family.world(sample.direction));
            sum = [0, 1, 2].map(|c| sum[c] + k[c] * light[c] / sample.pdf);
        }
    }
    sum.map(|x| x / count as f64)
}

/// Errors of every way, over stacks and frames.
pub fn chart(folder: &Path, truths: &[Truth]) -> Result<()> {
    let ways = [
        "1 for a vane",
        "1 for each family",
        "16 samples",
        "64 samples",
        "irradiance",
    ];
    let mut errors = vec![Vec::new(); ways.len()];
    for truth in truths.iter().filter(|t| STACKS.contains(&t.name.as_str())) {
        let layers = truth.layers;
        let table = StackTable::build(&layers);
        let facets = Facets {
            flatness: f64::from(layers.flatness),
            slope: f64::from(layers.slope).to_radians(),
            back: 1.0,
        };
        let seen = SeenTable::build(&facets, &table);
        let roughness = (0.58 * facets.flatness).hypot(facets.slope).sqrt().min(1.0);
        for frame in 0..FRAMES {
            let [u, v, w] = uniform(frame + 1);
            // The eye looks from the front, the vane is turned.
            let (turn, nod, spin) = (1.6 * (u - 0.5), 1.0 * (v - 0.5), TAU * w);
            let normal = [turn.sin() * nod.cos(), nod.sin(), turn.cos() * nod.cos()];
            let first = unit([normal[2], 0.0, -normal[0]]);
            let second = [
                normal[1] * first[2] - normal[2] * first[1],
                normal[2] * first[0] - normal[0] * first[2],
                normal[0] * first[1] - normal[1] * first[0],
            ];
            let around = |a: f64, b: f64| [0, 1, 2].map(|k| a * first[k] + b * second[k]);
            let card = [
                around(spin.cos(), spin.sin()),
                around(-spin.sin(), spin.cos()),
                normal,
            ];
            let omega = [0.0, 0.0, 1.0];
            let reflect = |n: [f64; 3]| [0, 1, 2].map(|k| 2.0 * dot(n, omega) * n[k] - omega[k]);
            let families = [1.0, -1.0].map(|sign| Family::new(&layers, sign, card));
            let (sin_b, cos_b) = BARBULE.to_radians().sin_cos();
            let lean = f64::from(layers.tilt).to_radians().sin() * sin_b
                - families[0].rise.0 * families[0].lean.1 * cos_b;
            let up = families[0].rise.1 * families[0].lean.1;
            let vane = unit([0, 1, 2].map(|k| lean * card[0][k] + up * card[2][k]));
            let once = prefiltered(reflect(vane), roughness);
            let even = prefiltered(normal, 1.0);
            let mut colors = [[0.0; 3]; 6];
            for family in &families {
                let eye = facet_eye(&facets, &seen, &table, 1.0, family.local(omega));
                let mirror = family.world([-eye.omega[0], -eye.omega[1], eye.omega[2]]);
                let own = prefiltered(mirror, roughness);
                let of = |light: [f64; 3]| [0, 1, 2].map(|c| eye.energy[c] * light[c]);
                let found = [
                    of(once),
                    of(own),
                    sampled(&eye, &table, family, 16),
                    sampled(&eye, &table, family, 64),
                    of(even),
                    sampled(&eye, &table, family, MANY),
                ];
                for (sum, color) in colors.iter_mut().zip(found) {
                    *sum = [0, 1, 2].map(|c| sum[c] + 0.5 * color[c]);
                }
            }
            let exact = colors[5];
            let y = 0.2126 * exact[0] + 0.7152 * exact[1] + 0.0722 * exact[2];
            let shown = |c: [f64; 3]| lab(c.map(|x| 0.4 * x / y));
            for (list, color) in errors.iter_mut().zip(colors) {
                list.push(delta_e_2000(shown(color), shown(exact)));
            }
        }
    }
    let mut curves = Vec::new();
    // What each reads of the map for a pixel with both families.
    for ((name, list), looks) in ways.iter().zip(errors).zip([1.0, 2.0, 32.0, 128.0, 1.0]) {
        let [mean, high] = summary(list);
        println!("environment, {name}: mean {mean:.2}, 95 % {high:.2}");
        curves.push(((*name).to_owned(), vec![(looks, mean), (looks, high)]));
    }
    draw(
        &folder.join("iridescence_environment.svg"),
        &Labels {
            title: "Light of a sky on thin layers: mean and 95th percentile of the error",
            x: "looks into the map a pixel",
            y: "CIEDE2000",
        },
        [true, true],
        &curves,
    )
}
