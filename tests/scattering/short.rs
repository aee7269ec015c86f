//! The short form of a fibre that FAR and MEAN cards take: against the whole one, and against its shader.

use bevy_plumage::maths::scattering::*;
use plumage_reference::fibre_traced::uniform;
use plumage_tests::cases::on_sphere;
use plumage_tests::gpu::run;
use rand_pcg::Pcg64Mcg;
use std::f64::consts::PI;

/// Fibres of the shipped feathers, and their neighbors.
fn plain() -> Vec<Fibre> {
    let mut list = Vec::new();
    for longitudinal_roughness in [0.1, 0.2, 0.35] {
        for azimuthal_roughness in [0.2, 0.4, 0.7] {
            for kind in [
                Fibre::default().kind,
                FibreKind::Pigment {
                    medulla_radius: 0.9,
                    scattering: 6.0,
                    anisotropy: 0.7,
                },
                FibreKind::Structural { core_radius: 0.7 },
                FibreKind::Structural { core_radius: 0.9 },
            ] {
                list.push(Fibre {
                    kind,
                    longitudinal_roughness,
                    azimuthal_roughness,
                    ..Fibre::default()
                });
            }
        }
    }
    list
}

struct Case {
    fibre: usize,
    albedo: [f64; 3],
    eye: [f64; 3],
    light: [f64; 3],
    dark_back: f64,
    frequency: f64,
    fine: bool,
}

fn cases(random: &mut Pcg64Mcg, fibres: usize, count: usize) -> Vec<Case> {
    (0..count)
        .map(|k| {
            let eye = on_sphere(random).map(f64::from);
            let mut light = on_sphere(random).map(f64::from);
            // Half of the lights near the mirror cone, where narrow lobes are.
            if k % 2 == 0 {
                let sine = (-eye[0] + 0.1 * light[0]).clamp(-1.0, 1.0);
                let across = light[1].hypot(light[2]).max(1e-6);
                let scale = (1.0 - sine * sine).max(0.0).sqrt() / across;
                light = [sine, light[1] * scale, light[2] * scale];
            }
            Case {
                fibre: k % fibres,
                albedo: [0; 3].map(|_| uniform(random)),
                eye,
                light,
                dark_back: (k / 8 % 2) as f64,
                frequency: [0.0, 0.7][k / 16 % 2],
                fine: k / 32 % 2 == 0,
            }
        })
        .collect()
}

fn cosine([_, y, z]: [f64; 3]) -> f64 {
    y.hypot(z)
}

/// The short form as the shader reads it.
struct Short {
    head: [[f64; 4]; SHORT_HEAD_VEC4S],
    /// A row, how the next one differs from it, and so on.
    rows: Vec<ShortRow<f64>>,
}

impl Short {
    fn new(table: &FibreTable) -> Self {
        let all = table.pack_short();
        let (head, rows) = all.split_at(SHORT_HEAD_VEC4S);
        let rows = rows.as_chunks::<SHORT_ROW_VEC4S>().0;
        Self {
            head: std::array::from_fn(|i| head[i].map(f64::from)),
            rows: rows
                .iter()
                .map(|row| row.map(|v| v.map(f64::from)))
                .collect(),
        }
    }

    fn shade(&self, case: &Case) -> ShortShading<f64> {
        let (i, fraction) = fibre_row_at(cosine(case.eye));
        let row = short_row_step(
            &self.rows[2 * i],
            &self.rows[2 * i + 1],
            fraction,
            case.fine,
        );
        short_shading(&self.head, &row, case.eye, case.dark_back)
    }

    /// Of each channel: K where all light reaches the fibre and where `reach` of it does; the energies of R, TT or TRcT and the medulla.
    fn colors(&self, case: &Case, reach: &FibreReach<f64>) -> [([f64; 2], [f64; 3]); 3] {
        let s = self.shade(case);
        let lobes = short_lobes(&s, case.light);
        let all = FibreReach {
            mirror: 1.0,
            even: 1.0,
            along: 0.0,
            place: lobes.turn,
        };
        let [surface, second, medulla] = s.energy;
        case.albedo.map(|albedo| {
            let color = short_color(&s, albedo, case.frequency);
            let lit = [&all, reach].map(|reach| short_lit(&s, &color, &lobes, reach));
            (
                lit,
                [surface, second * color.second, medulla * color.scattered],
            )
        })
    }
}

#[test]
fn shipped_fibres_are_plain_and_others_are_told() {
    for name in plumage_tests::shipped::FEATHERS {
        let optics = plumage_tests::shipped::feather(name).optics;
        for fibre in [optics.rachis, optics.barb, optics.distal, optics.proximal] {
            assert!(FibreTable::build(&fibre).is_plain(), "{name}: {fibre:?}");
        }
    }
    for fibre in plain() {
        assert!(FibreTable::build(&fibre).is_plain(), "{fibre:?}");
    }
    let flat = Fibre {
        aspect: 0.7,
        ..Fibre::default()
    };
    let core = Fibre {
        kind: FibreKind::Structural { core_radius: 0.4 },
        ..Fibre::default()
    };
    let thin = Fibre {
        kind: FibreKind::Pigment {
            medulla_radius: 0.3,
            scattering: 0.25,
            anisotropy: 0.0,
        },
        ..Fibre::default()
    };
    for fibre in [flat, core, thin] {
        assert!(!FibreTable::build(&fibre).is_plain(), "{fibre:?}");
    }
}

/// What the short form leaves out is below what anybody sees: K in the unit of a white fibre's mean, 1/4 pi; and energies.
#[test]
fn the_short_form_is_the_whole_one() {
    let fibres = plain();
    let tables: Vec<FibreTable> = fibres.iter().map(FibreTable::build).collect();
    let shorts: Vec<Short> = tables.iter().map(Short::new).collect();
    let mut random = Pcg64Mcg::new(3);
    let list = cases(&mut random, fibres.len(), 40_000);
    let (mut squares, mut sum, mut worst, mut energy) = (0.0, 0.0, 0.0_f64, 0.0_f64);
    let reach = FibreReach {
        mirror: 0.8,
        even: 0.6,
        along: 0.2,
        place: 0.3,
    };
    for case in &list {
        let table = &tables[case.fibre];
        let row = table.row(cosine(case.eye));
        let p = table.fibre();
        let mut whole = fibre_shading(
            &p,
            &row,
            case.albedo,
            case.eye,
            case.dark_back,
            if case.fine { 8 } else { MEAN_COSINES as u32 },
        );
        if case.frequency > 0.0 {
            whole.along = fibre_along(&p, &row, whole.absorption, case.frequency);
        }
        let wanted = fibre_lit(&whole, &fibre_lobes(&whole, case.light), &reach);
        let found = shorts[case.fibre].colors(case, &reach);
        for (c, ([_, found], energies)) in found.iter().enumerate() {
            let error = (found - wanted[c]) * 4.0 * PI;
            squares += error * error;
            sum += error;
            worst = worst.max(error.abs());
            let all: f64 = energies.iter().sum();
            energy = energy.max((all - fibre_albedo(&whole)[c]).abs());
        }
    }
    let count = 3.0 * list.len() as f64;
    let (rms, bias) = ((squares / count).sqrt(), sum / count);
    println!(
        "short form: K off by RMS {rms:.1e}, mean {bias:+.1e}, at most {worst:.1e} of 1/4 pi; energy at most {energy:.1e}"
    );
    assert!(rms < 2e-4 && bias.abs() < 5e-5 && worst < 5e-3 && energy < 2e-4);
}

#[test]
fn light_that_meets_again_is_that_of_the_whole_form() {
    for scattered in [0.0, 0.01, 0.3, 0.9, 1.0] {
        for kept in [0.0, 0.2, 0.7, 1.0, 1.1].map(|share| share * scattered) {
            for strength in [0.0, 0.5, 1.0] {
                let meeting = strength * (1.0 - f64::min(kept / f64::max(scattered, 1e-6), 1.0));
                for parallel in [0.0, PARALLEL_MEETINGS] {
                    let wanted = multiple_scattering([scattered; 3], [meeting; 3], parallel);
                    let [spread, cone] = short_again(scattered, kept, strength, parallel);
                    assert!(
                        (spread - wanted.spread[0]).abs() < 1e-12
                            && (cone - wanted.cone[0]).abs() < 1e-12,
                        "{scattered}, {kept}, {strength}"
                    );
                }
            }
        }
    }
}

#[test]
fn the_shader_agrees() {
    const ENTRY: &str = "
#import bevy_plumage::scattering as scattering
#import bevy_plumage::scattering_short as short
const CASE_FLOATS: u32 = 13u;

fn load(at: u32) -> vec4<f32> {
    return vec4<f32>(input[at], input[at + 1u], input[at + 2u], input[at + 3u]);
}

fn evaluate(i: u32) {
    let at = u32(input[0]) * 4u * short::SHORT_TABLE_LENGTH + 4u + i * CASE_FLOATS;
    let table = 4u + u32(input[at]) * 4u * short::SHORT_TABLE_LENGTH;
    let albedo = load(at + 1u).xyz;
    let omega_o = load(at + 4u).xyz;
    let omega_i = load(at + 7u).xyz;
    var head: array<vec4<f32>, 4>;
    for (var k = 0u; k < 4u; k++) { head[k] = load(table + 4u * k); }
    let place = scattering::fibre_row_at(length(omega_o.yz));
    let first = table + 4u * (short::SHORT_HEAD_LENGTH + place.index * short::SHORT_STEP_LENGTH);
    let fine = input[at + 12u] > 0.5;
    var row: array<vec4<f32>, 9>;
    for (var k = 0u; k < 9u; k++) {
        var from_row = k;
        if (k >= 3u) { from_row = select((k + 3u) / 2u, k + 3u, fine); }
        if (fine || k < 3u || k % 2u == 1u) {
            row[k] = load(first + 4u * from_row) + load(first + 4u * (from_row + short::SHORT_ROW_LENGTH)) * place.fraction;
        }
    }
    let s = short::short_shading(head, row, omega_o, input[at + 10u], fine);
    let lobes = short::short_lobes(s, omega_i);
    for (var c = 0u; c < 3u; c++) {
        let color = short::short_color(s, albedo[c], input[at + 11u]);
        output[15u * i + c] = short::short_lit(s, color, lobes, scattering::FibreReach(1.0, 1.0, 0.0, lobes.turn));
        output[15u * i + 3u + c] = short::short_lit(s, color, lobes, scattering::FibreReach(0.8, 0.6, 0.2, 0.3));
        let second = s.energy.y * color.second;
        let rest = s.energy.z * color.scattered + s.energy.x;
        output[15u * i + 6u + c] = second;
        output[15u * i + 9u + c] = rest;
        let again = short::short_again(second + rest, 0.4 * second + 0.8 * rest, 0.9, 0.25);
        output[15u * i + 12u + c] = again.x + again.y;
    }
}
";
    let fibres = plain();
    let tables: Vec<FibreTable> = fibres.iter().map(FibreTable::build).collect();
    let shorts: Vec<Short> = tables.iter().map(Short::new).collect();
    let mut random = Pcg64Mcg::new(4);
    let mut list = cases(&mut random, fibres.len(), 16_000);
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let axes = axes.map(|axis: [f64; 3]| [axis, axis.map(|x| -x)]);
    for fibre in 0..fibres.len() {
        for eye in axes.concat() {
            for light in axes.concat() {
                for albedo in [0.0, 1.0, 1e9] {
                    list.push(Case {
                        fibre,
                        albedo: [albedo; 3],
                        eye,
                        light,
                        dark_back: 1.0,
                        frequency: 0.7,
                        fine: true,
                    });
                }
            }
        }
    }
    let mut input = vec![tables.len() as f32, 0.0, 0.0, 0.0];
    for table in &tables {
        input.extend(table.pack_short().as_flattened());
    }
    for case in &list {
        input.push(case.fibre as f32);
        let vectors = case.albedo.iter().chain(&case.eye).chain(&case.light);
        input.extend(vectors.map(|x| *x as f32));
        let fine = f32::from(u8::from(case.fine));
        input.extend([case.dark_back as f32, case.frequency as f32, fine]);
    }
    let Some(out) = run(
        &["scattering_short.wgsl", "scattering.wgsl"],
        ENTRY,
        &input,
        list.len(),
        15 * list.len(),
    ) else {
        return;
    };
    let reach = FibreReach {
        mirror: 0.8,
        even: 0.6,
        along: 0.2,
        place: 0.3,
    };
    let mut worst = [0.0_f64; 2];
    for (case, found) in list.iter().zip(out.chunks(15)) {
        assert!(
            found.iter().all(|x| x.is_finite() && *x >= 0.0),
            "{:?} {:?}: {found:?}",
            case.eye,
            case.light
        );
        // The very numbers that the shader has.
        let single = |v: [f64; 3]| v.map(|x| f64::from(x as f32));
        let given = Case {
            fibre: case.fibre,
            albedo: single(case.albedo),
            eye: single(case.eye),
            light: single(case.light),
            dark_back: case.dark_back,
            frequency: f64::from(case.frequency as f32),
            fine: case.fine,
        };
        let beta = f64::from(fibres[case.fibre].longitudinal_roughness);
        let peak = (0.4 / (0.5 * beta)).max(1.0) / PI;
        let wanted = shorts[case.fibre].colors(&given, &reach);
        for (c, ([whole, lit], [surface, second, medulla])) in wanted.into_iter().enumerate() {
            let off = |k: usize, wanted: f64| (f64::from(found[k + c]) - wanted).abs();
            let error = off(0, whole).max(off(3, lit)) / peak;
            worst[0] = worst[0].max(error);
            let rest = medulla + surface;
            let [spread, cone] = short_again(second + rest, 0.4 * second + 0.8 * rest, 0.9, 0.25);
            let error = off(6, second).max(off(9, rest)).max(off(12, spread + cone));
            worst[1] = worst[1].max(error);
        }
    }
    println!(
        "short form's twin: K {:.1e} of the peak, energies {:.1e}",
        worst[0], worst[1]
    );
    assert!(worst[0] < 1e-4 && worst[1] < 1e-4, "{worst:?}");
}
