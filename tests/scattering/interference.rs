//! Thin layers: the transfer matrix against recursion, its energy, colors of published stacks (docs/book/iridescence.md).

use bevy_plumage::maths::scattering::interference::*;
use plumage_reference::color_difference::{delta_e_2000, lab};
use plumage_reference::thin_film::{analytic_observer, balance};
use plumage_tests::shipped::{stack, stacks};
use rayon::prelude::*;

/// Layers of one realization at a wavelength, as (index, thickness).
fn films(stack: &Stack, factors: &[f64], wavelength: f64, mixing: f64) -> Vec<Film> {
    let film = |layer: &Layer| Film {
        index: stack.materials[layer.material].index(wavelength, mixing),
        thickness: layer.thickness * factors[layer.group],
    };
    stack.layers.iter().map(film).collect()
}

fn pairs(films: &[Film]) -> Vec<((f64, f64), f64)> {
    let pair = |film: &Film| ((film.index.re, film.index.im), film.thickness);
    films.iter().map(pair).collect()
}

/// Mean reflectance by the reference, all realizations.
fn reference(stack: &Stack, cosine: f64, wavelength: f64) -> f64 {
    let realizations = stack.realizations();
    let mut sum = 0.0;
    for mixing in MIXING {
        let base = stack.base.index(wavelength, mixing);
        for factors in &realizations {
            let layers = pairs(&films(stack, factors, wavelength, mixing));
            for in_plane in [false, true] {
                let base = (base.re, base.im);
                sum += balance(&layers, base, in_plane, cosine, wavelength).reflected;
            }
        }
    }
    sum / (4 * realizations.len()) as f64
}

/// Wavelength and height of the largest reflectance in a range.
fn peak(stack: &Stack, cosine: f64, low: f64, high: f64) -> (f64, f64) {
    let mut best = (low, 0.0);
    for i in 0..=(high - low) as usize {
        let wavelength = low + i as f64;
        let found = stack_reflectance(stack, cosine, wavelength);
        if found > best.1 {
            best = (wavelength, found);
        }
    }
    best
}

fn cosine(degrees: f64) -> f64 {
    degrees.to_radians().cos()
}

#[test]
fn the_matrix_is_the_recursion_and_energy_is_kept() {
    let (mut worst, mut lost) = (0.0_f64, 0.0_f64);
    for (name, parameters) in stacks() {
        let stack = Stack::new(&parameters);
        let realizations = stack.realizations();
        for factors in realizations.iter().step_by(9) {
            for wavelength in [380.0, 465.0, 550.0, 640.0, 780.0] {
                for degrees in [0.0, 20.0, 53.0, 75.0, 89.0] {
                    for mixing in MIXING {
                        let base = stack.base.index(wavelength, mixing);
                        let films = films(&stack, factors, wavelength, mixing);
                        for (polarization, in_plane) in
                            Polarization::BOTH.into_iter().zip([false, true])
                        {
                            let c = cosine(degrees);
                            let flow = film_flow(&films, base, polarization, c, wavelength);
                            let judge = balance(
                                &pairs(&films),
                                (base.re, base.im),
                                in_plane,
                                c,
                                wavelength,
                            );
                            let off = (flow.reflected - judge.reflected).abs()
                                + (flow.transmitted - judge.transmitted).abs();
                            let absorbed: f64 = judge.absorbed.iter().sum();
                            let balance = judge.reflected + absorbed + judge.transmitted - 1.0;
                            assert!(off < 1e-10, "{name} {wavelength} nm {degrees}: {off:e}");
                            assert!(
                                balance.abs() < 1e-9,
                                "{name} {wavelength} nm {degrees}: {balance:e}"
                            );
                            assert!(judge.absorbed.iter().all(|a| *a > -1e-12));
                            assert!((0.0..=1.0).contains(&flow.reflected));
                            worst = worst.max(off);
                            lost = lost.max(balance.abs());
                        }
                    }
                }
            }
        }
    }
    println!("matrix against recursion {worst:.1e}, R + A + T - 1 {lost:.1e}");
}

/// Means over polarizations, mixings and realizations, with their shared phases, are what single films give.
#[test]
fn means_are_sums_of_single_films() {
    for name in ["anna_gorget", "peacock_green", "starling", "magpie_wing"] {
        let stack = Stack::new(&stack(name));
        for (degrees, wavelength) in [(0.0, 430.0), (50.0, 555.0), (78.0, 640.0)] {
            let found = stack_reflectance(&stack, cosine(degrees), wavelength);
            let wanted = reference(&stack, cosine(degrees), wavelength);
            assert!((found - wanted).abs() < 1e-10, "{name}: {found} {wanted}");
        }
    }
}

#[test]
fn one_film_is_the_closed_form() {
    for degrees in [0.0, 33.0, 70.0] {
        for wavelength in [400.0, 500.0, 700.0] {
            let c = cosine(degrees);
            let n = keratin_index(wavelength);
            let inner = (1.0 - (1.0 - c * c) / (n * n)).sqrt();
            let film = Film {
                index: Complex::new(n, 0.0),
                thickness: 595.0,
            };
            let air = Complex::new(1.0, 0.0);
            for polarization in Polarization::BOTH {
                // Airy's formula for a film in air.
                let r = match polarization {
                    Polarization::S => (c - n * inner) / (c + n * inner),
                    Polarization::P => (n * c - inner) / (n * c + inner),
                };
                let phase = std::f64::consts::TAU / wavelength * 595.0 * n * inner;
                let swing = 4.0 * r * r * phase.sin().powi(2);
                let wanted = swing / ((1.0 - r * r).powi(2) + swing);
                let found = film_flow(&[film], air, polarization, c, wavelength);
                assert!((found.reflected - wanted).abs() < 1e-12);
                assert!((found.reflected + found.transmitted - 1.0).abs() < 1e-12);
                // Nothing on keratin: Fresnel.
                let bare = film_flow(&[], Complex::new(n, 0.0), polarization, c, wavelength);
                assert!((bare.reflected - r * r).abs() < 1e-12);
            }
        }
    }
}

#[test]
fn the_observer_is_the_published_one() {
    let weights = rgb_weights();
    for channel in 0..3 {
        let sum: f64 = weights.iter().map(|w| w[channel]).sum();
        assert!((sum - 1.0).abs() < 1e-12);
    }
    // Back to the luminance of D65 and its peak, and against the analytic fit of the observer on smooth spectra.
    for (center, width) in [
        (450.0_f64, 40.0_f64),
        (530.0, 50.0),
        (600.0, 40.0),
        (560.0, 150.0),
    ] {
        let bump = |l: f64| (-0.5 * ((l - center) / width).powi(2)).exp();
        let mut found = [0.0; 3];
        for (l, w) in wavelengths().zip(&weights) {
            found = std::array::from_fn(|c| found[c] + w[c] * bump(l));
        }
        let mut sums = [[0.0; 3]; 2];
        for l in wavelengths() {
            // D65 as a smooth daylight: a line through its values at 450 and 700 nm.
            let power = 117.0 + (71.6 - 117.0) * (l - 450.0) / 250.0;
            let xyz = analytic_observer(l);
            for c in 0..3 {
                sums[0][c] += power * xyz[c] * bump(l);
                sums[1][c] += power * xyz[c];
            }
        }
        let luminance = 0.2126 * found[0] + 0.7152 * found[1] + 0.0722 * found[2];
        let wanted = sums[0][1] / sums[1][1];
        assert!(
            (luminance - wanted).abs() < 0.01,
            "{center}: {luminance} {wanted}"
        );
    }
}

#[test]
fn the_judge_of_colors_is_right_on_published_pairs() {
    // Sharma, Wu and Dalal 2005, table 1.
    let blue = [50.0, 0.0, -82.7485];
    let red = [50.0, 2.5, 0.0];
    let pairs: [([f64; 3], [f64; 3], f64); 26] = [
        ([50.0, 2.6772, -79.7751], blue, 2.0425),
        ([50.0, 3.1571, -77.2803], blue, 2.8615),
        ([50.0, 2.8361, -74.0200], blue, 3.4412),
        ([50.0, -1.3802, -84.2814], blue, 1.0),
        ([50.0, -1.1848, -84.8006], blue, 1.0),
        ([50.0, -0.9009, -85.5211], blue, 1.0),
        ([50.0, 0.0, 0.0], [50.0, -1.0, 2.0], 2.3669),
        ([50.0, 2.49, -0.001], [50.0, -2.49, 0.0009], 7.1792),
        ([50.0, 2.49, -0.001], [50.0, -2.49, 0.0011], 7.2195),
        ([50.0, -0.001, 2.49], [50.0, 0.0009, -2.49], 4.8045),
        ([50.0, -0.001, 2.49], [50.0, 0.0011, -2.49], 4.7461),
        (red, [50.0, 0.0, -2.5], 4.3065),
        (red, [73.0, 25.0, -18.0], 27.1492),
        (red, [61.0, -5.0, 29.0], 22.8977),
        (red, [56.0, -27.0, -3.0], 31.9030),
        (red, [58.0, 24.0, 15.0], 19.4535),
        (
            [60.2574, -34.0099, 36.2677],
            [60.4626, -34.1751, 39.4387],
            1.2644,
        ),
        (
            [63.0109, -31.0961, -5.8663],
            [62.8187, -29.7946, -4.0864],
            1.2630,
        ),
        (
            [61.2901, 3.7196, -5.3901],
            [61.4292, 2.2480, -4.9620],
            1.8731,
        ),
        (
            [35.0831, -44.1164, 3.7933],
            [35.0232, -40.0716, 1.5901],
            1.8645,
        ),
        (
            [22.7233, 20.0904, -46.6940],
            [23.0331, 14.9730, -42.5619],
            2.0373,
        ),
        (
            [36.4612, 47.8580, 18.3852],
            [36.2715, 50.5065, 21.2231],
            1.4146,
        ),
        (
            [90.8027, -2.0831, 1.4410],
            [91.1528, -1.6435, 0.0447],
            1.4441,
        ),
        (
            [90.9257, -0.5406, -0.9208],
            [88.6381, -0.8985, -0.7239],
            1.5381,
        ),
        (
            [6.7747, -0.2908, -2.4247],
            [5.8714, -0.0985, -2.2286],
            0.6377,
        ),
        (
            [2.0776, 0.0795, -1.1350],
            [0.9033, -0.0636, -0.5514],
            0.9082,
        ),
    ];
    for (one, two, wanted) in pairs {
        for (a, b) in [(one, two), (two, one)] {
            let found = delta_e_2000(a, b);
            assert!((found - wanted).abs() < 1e-4, "{a:?} {b:?}: {found}");
        }
    }
    let white = lab([1.0; 3]);
    assert!((white[0] - 100.0).abs() < 1e-9 && white[1].hypot(white[2]) < 1e-9);
}

/// The table, interpolated, against the reference's own sum over the spectrum at angles between its texels.
#[test]
fn tables_are_within_a_twentieth_of_a_just_noticeable_difference() {
    let errors: Vec<(String, f64, f64, f64)> = stacks()
        .into_par_iter()
        .map(|(name, parameters)| {
            let stack = Stack::new(&parameters);
            let table = StackTable::build(&parameters);
            let cosines: Vec<f64> = (0..=40).map(|d| cosine(2.0 * f64::from(d))).collect();
            let truth = stack_colors(&stack, &cosines);
            // As bright as the species is shown: its brightest luminance to 60 degrees is 0.6.
            let luminance = |c: [f64; 3]| 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
            let brightest = truth[..=30]
                .iter()
                .map(|c| luminance(*c))
                .fold(0.0, f64::max);
            let seen = |c: [f64; 3]| lab(c.map(|x| x * 0.6 / brightest));
            let mut list: Vec<f64> = cosines
                .iter()
                .zip(&truth)
                .map(|(c, truth)| delta_e_2000(seen(table.color(*c)), seen(in_gamut(*truth))))
                .collect();
            list.sort_by(f64::total_cmp);
            let mean = list.iter().sum::<f64>() / list.len() as f64;
            (
                name,
                mean,
                list[list.len() * 95 / 100],
                list[list.len() - 1],
            )
        })
        .collect();
    for (name, mean, high, worst) in &errors {
        println!("{name:17} mean {mean:.3} 95 % {high:.3} worst {worst:.3}");
        assert!(
            *mean <= 0.05 && *high <= 0.1 && *worst <= 0.5,
            "{name}: {mean} {high} {worst}"
        );
    }
}

/// Colors of whole realizations by the other formulation.
#[test]
fn colors_are_those_of_the_recursion() {
    for name in ["anna_gorget", "pigeon_green", "mallard_speculum"] {
        let stack = Stack::new(&stack(name));
        let c = cosine(41.0);
        let mut wanted = [0.0; 3];
        for (wavelength, weight) in wavelengths().zip(rgb_weights()) {
            let r = reference(&stack, c, wavelength);
            wanted = std::array::from_fn(|i| wanted[i] + weight[i] * r);
        }
        let found = stack_colors(&stack, &[c])[0];
        for i in 0..3 {
            assert!(
                (found[i] - wanted[i]).abs() < 1e-9,
                "{name}: {found:?} {wanted:?}"
            );
        }
    }
}

#[test]
fn hues_move_to_shorter_wavelengths() {
    stacks().into_par_iter().for_each(|(name, parameters)| {
        if parameters.layers < 4 {
            return;
        }
        let stack = Stack::new(&parameters);
        let expected = |degrees: f64| 1.0 - 0.16 * (1.0 - cosine(degrees)) / (1.0 - cosine(50.0));
        let first = peak(&stack, 1.0, 400.0, 760.0).0;
        let mut last = first + 1.0;
        for degrees in [0.0, 20.0, 40.0, 50.0, 60.0] {
            let near = first * expected(degrees);
            let found = peak(&stack, cosine(degrees), near * 0.93, near * 1.07).0;
            assert!(found < last, "{name} at {degrees}: {found} after {last}");
            last = found;
            if degrees == 50.0 {
                let ratio = found / first;
                assert!((0.82..=0.91).contains(&ratio), "{name}: {ratio}");
            }
        }
        for (scale, wanted) in [(0.9, 0.905), (1.1, 1.096)] {
            let scaled = Stack::new(&Iridescence {
                scale,
                ..parameters
            });
            let near = first * wanted;
            let ratio = peak(&scaled, 1.0, near * 0.95, near * 1.05).0 / first;
            assert!((ratio - wanted).abs() < 0.01, "{name} x {scale}: {ratio}");
        }
    });
}

#[test]
fn peaks_are_where_spectra_were_measured() {
    let bronze = |rod: f32, gap: f32| {
        Stack::new(&Iridescence {
            melanosome_nm: rod,
            gap_nm: gap,
            ..stack("bronzewing")
        })
    };
    // Xiao et al. 2014: blue and red end of the bronzewing's wing spot.
    for (rod, gap, wanted) in [(75.0, 63.0, 462.0), (99.0, 100.0, 647.0)] {
        let found = peak(&bronze(rod, gap), 1.0, 420.0, 700.0).0;
        println!("bronzewing {rod}/{gap}: {found} nm, measured {wanted}");
        assert!((found / wanted - 1.0).abs() < 0.03 && (found - wanted).abs() <= 10.0);
    }
    // Stavenga et al. 2015: the silver nape of Lawes' parotia.
    let nape = Iridescence {
        cortex_nm: 100.0,
        layers: 7,
        melanosome_nm: 200.0,
        gap_nm: 200.0,
        fill: 0.9,
        ..Iridescence::default()
    };
    let found = peak(&Stack::new(&nape), 1.0, 1000.0, 1600.0).0;
    println!("parotia's nape: {found} nm, measured 1300");
    assert!((found / 1300.0 - 1.0).abs() < 0.03);
    // Durrer and Villiger 1970: the emerald cuckoo is golden green.
    let cuckoo = Iridescence {
        cortex_nm: 30.0,
        layers: 15,
        melanosome_nm: 77.0,
        gap_nm: 91.0,
        fill: 0.9,
        ..Iridescence::default()
    };
    let found = peak(&Stack::new(&cuckoo), 1.0, 450.0, 650.0).0;
    println!("emerald cuckoo: {found} nm");
    assert!((520.0..=570.0).contains(&found));
}

#[test]
fn pigeons_change_between_green_and_purple() {
    let color = |name: &str, degrees: f64| {
        in_gamut(stack_colors(&Stack::new(&stack(name)), &[cosine(degrees)])[0])
    };
    let [r, g, b] = color("pigeon_green", 0.0);
    assert!(g > r && g > b, "{r} {g} {b}");
    let [r, g, b] = color("pigeon_green", 50.0);
    assert!(r > 2.0 * g && b > 2.0 * g, "{r} {g} {b}");
    let [r, g, b] = color("pigeon_purple", 0.0);
    assert!(r > 2.0 * g && b > 2.0 * g, "{r} {g} {b}");
    let [r, g, _] = color("pigeon_purple", 70.0);
    assert!(g > 2.0 * r, "{r} {g}");
}

/// Between its rows a table over the thickness has the colors of stacks that are as thick.
#[test]
fn thickness_between_rows_is_interpolated() {
    let bronze = stack("bronzewing");
    let range = [0.9, 1.1];
    let table = StackTable::scaled(&bronze, range);
    assert_eq!((table.rows, table.columns()), (9, SCALED_TEXELS));
    // Half way between two rows, and at a row.
    let step = (range[1] / range[0]).powf(1.0 / 8.0);
    let mut list = Vec::new();
    for scale in [0.9 * step.powf(2.5), 0.9 * step.powi(4), 1.1] {
        let layers = Iridescence {
            scale: scale as f32,
            ..bronze
        };
        let cosines: Vec<f64> = (0..=40).map(|i| cosine(f64::from(2 * i))).collect();
        let truth = stack_colors(&Stack::new(&layers), &cosines);
        let luminance = |c: [f64; 3]| 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
        let brightest = truth[..=30]
            .iter()
            .map(|c| luminance(*c))
            .fold(0.0, f64::max);
        let seen = |c: [f64; 3]| lab(c.map(|x| x * 0.6 / brightest));
        for (c, truth) in cosines.iter().zip(truth) {
            let found = table.look(*c, scale).color;
            list.push(delta_e_2000(seen(found), seen(in_gamut(truth))));
        }
    }
    list.sort_by(f64::total_cmp);
    let (mean, high) = (
        list.iter().sum::<f64>() / list.len() as f64,
        list[list.len() * 95 / 100],
    );
    println!("thickness between rows: mean {mean:.3}, 95 % {high:.3}");
    assert!(mean <= 0.35 && high <= 1.0, "{mean} {high}");
    // Beyond the range the ends hold, and one row serves every factor.
    assert_eq!(table.look(0.7, 2.0), table.look(0.7, 1.1));
    let single = StackTable::single(table.texels[..SCALED_TEXELS].to_vec());
    assert_eq!(single.look(0.7, 0.6), single.look(0.7, 1.6));
}

#[test]
fn maps_of_thickness_have_linear_logarithms_and_hold_still() {
    let map = ScaleMap {
        columns: 2,
        factors: vec![0.8, 1.0, 1.2, 1.4],
    };
    assert_eq!(map.size(), [2, 2]);
    assert_eq!(map.range(), [0.8_f32, 1.4].map(f64::from));
    for (uv, wanted) in [
        ([0.0, 0.0], 0.8),
        ([1.0, 0.0], 1.0),
        ([0.5, 0.5], (0.8_f64 * 1.0 * 1.2 * 1.4).powf(0.25)),
        ([-3.0, 9.0], 1.2),
    ] {
        let found: f64 = map.at(uv);
        assert!((found - wanted).abs() < 1e-6, "{uv:?}: {found}");
    }
    // What a file could not hold.
    for (columns, factors) in [
        (0, vec![]),
        (7, vec![1.0; 3]),
        (3, vec![f32::NAN; 7]),
        (u32::MAX, vec![f32::INFINITY; 2]),
    ] {
        let odd = ScaleMap { columns, factors };
        let found: f64 = odd.at([0.3, 0.9]);
        assert!((0.599..=1.601).contains(&found), "{odd:?}: {found}");
        let [low, high] = odd.range();
        assert!(
            (0.599..=1.601).contains(&low) && low <= high && high <= 1.601,
            "{odd:?}"
        );
    }
}

#[test]
fn hostile_values_give_finite_tables() {
    let odd = [f32::NAN, f32::INFINITY, -1e30, 1e30];
    for x in odd {
        let stack = Stack::new(&Iridescence {
            structure: Structure::RodsAndChannels,
            cortex_nm: x,
            layers: 10_000,
            melanosome_nm: x,
            gap_nm: -x,
            hollow: x,
            fill: x,
            channel_nm: x,
            first_nm: x,
            disorder: x,
            variation: x,
            scale: x,
            ..Iridescence::default()
        });
        assert!(stack.layers.len() <= 24 * 12 + 1);
        for degrees in [0.0, 60.0, 90.0] {
            let r = stack_reflectance(&stack, cosine(degrees), 500.0);
            assert!((0.0..=1.0).contains(&r), "{x}: {r}");
        }
    }
    // Interlocking rows, nothing at all, and grazing light.
    let deep = Iridescence {
        gap_nm: -60.0,
        melanosome_nm: 80.0,
        hollow: 0.9,
        structure: Structure::HollowRods,
        disorder: 0.2,
        variation: 0.3,
        layers: 24,
        ..Iridescence::default()
    };
    let bare = Iridescence {
        layers: 0,
        cortex_nm: 0.0,
        ..Iridescence::default()
    };
    for parameters in [deep, bare] {
        let colors = stack_colors(&Stack::new(&parameters), &[0.0, 0.01, 0.5, 1.0]);
        for color in &colors {
            assert!(in_gamut(*color).iter().all(|x| (0.0..=1.0).contains(x)));
        }
        assert!(in_gamut(colors[0]).iter().all(|x| *x > 0.95));
    }
}
