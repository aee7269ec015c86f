//! The facet lobe on the GPU against double precision, and what a stack leaves to the fibre below.

use bevy_plumage::maths::scattering::interference::*;
use bevy_plumage::maths::scattering::*;
use plumage_reference::fibre_traced::uniform;
use plumage_tests::cases::on_sphere;
use plumage_tests::fibres::*;
use plumage_tests::gpu::run;
use plumage_tests::shipped::stack;
use rand_pcg::Pcg64Mcg;

const FLOATS: usize = 22;
const FLATNESSES: [f32; 4] = [0.05, 0.14, 0.4, 1.0];
const SLOPES: [f32; 4] = [0.05, 0.1, 0.2, 0.349];
const RESULTS: usize = 16;

const TEXT: &str = "
#import bevy_plumage::interference as interference
// Behind two rows of colors: what eyes see of four flatnesses by four slopes.
const SEEN: u32 = 512u;
const CASES: u32 = SEEN + 16u * 2048u;

fn vector(at: u32) -> vec3<f32> { return vec3<f32>(input[at], input[at + 1u], input[at + 2u]); }

fn four(at: u32) -> vec4<f32> { return vec4<f32>(vector(at), input[at + 3u]); }

fn texel(at: u32, cell: interference::Simplex) -> vec4<f32> {
    return cell.weights.x * four(at) + cell.weights.y * four(at + cell.second)
        + cell.weights.z * four(at + cell.third) + cell.weights.w * four(at + cell.fourth);
}

fn stack_look(cosine: f32, row: interference::StackPlace) -> vec4<f32> {
    let place = interference::stack_step(cosine, 64.0);
    let at = 4u * (64u * row.index + place.index);
    let cell = interference::cell_triangle(vec2<f32>(place.fraction, row.fraction), vec2<u32>(4u, 256u));
    let look = texel(at, cell);
    return vec4<f32>(interference::in_gamut(look.rgb), look.w);
}


fn evaluate(i: u32) {
    let at = CASES + i * 22u;
    let facets = interference::Facets(input[at], input[at + 1u], input[at + 2u]);
    let eye = vector(at + 3u);
    let light = vector(at + 6u);
    let place = interference::scale_place(vec2<f32>(2.0, 2.0), vec2<f32>(input[at + 16u], input[at + 17u]));
    let row_place = interference::scale_mix(vec4<f32>(ROWS), place.fraction);
    let view = interference::facet_view(facets, eye);
    let seen_at = interference::seen_place(facets, vec2<f32>(input[at + 19u], input[at + 20u]), eye);
    let row = interference::stack_row(row_place, 2.0);
    let first = SEEN + 2048u * u32(input[at + 18u]) + 4u * seen_at.index;
    let cell = interference::cell_simplex(vec3<f32>(seen_at.fraction, row.fraction), vec3<u32>(4u, 64u, 1024u));
    let seen = interference::facet_seen(texel(first, cell), seen_at);
    let bare = vec4<f32>(seen.energy, stack_look(seen_at.facing, row).w);
    let energy = interference::facet_color(bare, interference::facet_share(facets, seen_at.outer));
    let area = seen.area;
    let half_way = interference::facet_half_way(eye + light);
    let color = interference::facet_color(stack_look(half_way.w, row), interference::facet_side(facets, half_way.z));
    let k = interference::facet_evaluate(facets, area, half_way) * color;
    let drawn = interference::facet_sample(facets, view, eye, vector(at + 9u));
    let turned = interference::facet_turn(light, vec2<f32>(input[at + 12u], input[at + 13u]), vec2<f32>(input[at + 14u], input[at + 15u]));
    let results = array<f32, 16>(k.x, k.y, k.z, area, energy.x, energy.y, energy.z,
        interference::facet_pdf(facets, view, eye, half_way), drawn.x, drawn.y, drawn.z, drawn.w, turned.x, turned.y, turned.z, row_place);
    for (var j = 0u; j < 16u; j++) { output[i * 16u + j] = results[j]; }
}
";

#[test]
fn facets_on_the_gpu_are_those_of_the_crate() {
    // Two rows, of factors on the thickness an octave apart: the second is the first, backwards.
    let row = StackTable::build(&stack("coeligena_green")).texels;
    let table = StackTable {
        texels: row.iter().chain(row.iter().rev()).copied().collect(),
        rows: 2,
        scales: [0.5_f64.sqrt(), 2.0_f64.sqrt()],
    };
    // As the shader has it: in single precision.
    let rounded = StackTable {
        texels: table
            .texels
            .iter()
            .map(|texel| texel.map(|x| f64::from(x as f32)))
            .collect(),
        ..table.clone()
    };
    let mut input: Vec<f32> = Vec::new();
    for (i, [r, g, b]) in table.texels.iter().enumerate() {
        let last = bare(i % STACK_TEXELS, STACK_TEXELS);
        input.extend([*r, *g, *b, last].map(|x| x as f32));
    }
    let sides: [Facets<f64>; 16] = std::array::from_fn(|i| Facets {
        flatness: f64::from(FLATNESSES[i % 4]),
        slope: f64::from(SLOPES[i / 4]),
        back: 1.0,
    });
    let seen = sides.map(|side| SeenTable::build(&side, &rounded));
    let texels = seen.iter().flat_map(|table| table.texels.iter().flatten());
    input.extend(texels.map(|x| *x as f32));
    let cases = input.len();
    let map = ScaleMap {
        columns: 2,
        factors: vec![0.75, 0.9, 1.1, 1.4],
    };
    let mut random = Pcg64Mcg::new(77);
    let count = 24 * 24 * 16;
    for i in 0..count {
        let flatness = FLATNESSES[i % 4];
        let slope = SLOPES[i / 4 % 4];
        let back = [1.0, 0.4][i / 16 % 2];
        let eye = on_sphere(&mut random);
        let mut light = on_sphere(&mut random);
        // Half of the lights near the mirror of a flat side, and the eye's own place.
        if i % 2 == 0 {
            let mirror = if i % 4 == 0 {
                [-1.0, -1.0, 1.0]
            } else {
                [1.0; 3]
            };
            let near: [f32; 3] = std::array::from_fn(|k| mirror[k] * eye[k] + 0.15 * light[k]);
            let size = near.iter().map(|x| x * x).sum::<f32>().sqrt();
            light = near.map(|x| x / size);
        }
        let u = [0; 3].map(|_| uniform(&mut random) as f32);
        let (rise, lean) = (0.3 * (u[0] - 0.5), u[1] - 0.5);
        input.extend([flatness, slope, back]);
        input.extend(eye);
        input.extend(light);
        input.extend(u);
        input.extend([rise.sin(), rise.cos(), lean.sin(), lean.cos()]);
        input.extend([uniform(&mut random) as f32, uniform(&mut random) as f32]);
        let [across, along] = facet_constants(&sides[i % 16]);
        input.extend([(i % 16) as f32, across as f32, along as f32, 0.0]);
    }
    let places = map.quad([0, 0]).map(|factor| table.row_place(factor));
    let text = TEXT.replace("ROWS", &places.map(|x| format!("{x:?}")).join(", "));
    let Some(out) = run(
        &["interference.wgsl"],
        &text,
        &input,
        count,
        count * RESULTS,
    ) else {
        return;
    };
    let mut worst = [0.0_f64; 5];
    for (i, got) in out.chunks(RESULTS).enumerate() {
        let v: Vec<f64> = input[cases + i * FLOATS..][..FLOATS]
            .iter()
            .map(|x| f64::from(*x))
            .collect();
        let got: Vec<f64> = got.iter().map(|x| f64::from(*x)).collect();
        let three = |at: usize| [v[at], v[at + 1], v[at + 2]];
        let facets = Facets {
            flatness: v[0],
            slope: v[1],
            back: v[2],
        };
        let scale: f64 = map.at([v[16], v[17]]);
        let eye = facet_eye(&facets, &seen[i % 16], &rounded, scale, three(3));
        worst[1] = worst[1].max((got[15] - rounded.row_place(scale)).abs());
        let k = facet_evaluate(&eye, &rounded, three(6));
        let peak = facet_density(&facets, [0.0, 0.0, 1.0]) / (4.0 * eye.area);
        for (got, k) in got.iter().zip(k) {
            worst[0] = worst[0].max((got - k).abs() / peak);
        }
        for (got, energy) in got[4..].iter().zip(eye.energy) {
            worst[1] = worst[1].max((got - energy).abs());
        }
        worst[1] = worst[1].max((got[3] - eye.area).abs());
        let pdf = facet_pdf(&eye, three(6));
        worst[2] = worst[2].max((got[7] - pdf).abs() / pdf.max(peak));
        if let Some(sample) = facet_sample(&eye, three(9)) {
            let off = (0..3).map(|k| (got[8 + k] - sample.direction[k]).abs());
            worst[3] = worst[3].max(off.fold(0.0, f64::max));
        }
        let turned = facet_turn(three(6), (v[12], v[13]), (v[14], v[15]));
        let off = (0..3).map(|k| (got[12 + k] - turned[k]).abs());
        worst[4] = worst[4].max(off.fold(0.0, f64::max));
    }
    println!(
        "facet twins: K {:.1e} of the peak, energy {:.1e}, density {:.1e}, samples {:.1e}, turn {:.1e}",
        worst[0], worst[1], worst[2], worst[3], worst[4]
    );
    assert!(worst[0] < 1e-4 && worst[1] < 1e-4, "{worst:?}");
    assert!(
        worst[2] < 1e-3 && worst[3] < 1e-3 && worst[4] < 1e-5,
        "{worst:?}"
    );
}

/// What the stack reflects does not enter the fibre.
#[test]
fn a_stack_takes_its_share_first() {
    let parameters = stack("anna_gorget");
    let table = StackTable::build(&parameters);
    for fibre in [pigment(0.85, 2.0, 0.4), structural(0.7)] {
        let fibre_table = FibreTable::build(&fibre);
        for theta in [0.0, 0.5, 1.0] {
            for phi in [0.0, 0.6, 1.2] {
                let omega_o = direction(theta, phi);
                let facets = Facets {
                    flatness: 0.14,
                    slope: 0.1,
                    back: 1.0,
                };
                let seen = SeenTable::build(&facets, &table);
                let eye = facet_eye(&facets, &seen, &table, 1.0, omega_o);
                for albedo in [0.0, 0.03, 0.5, 1.0] {
                    let mut shading = shade(&fibre_table, albedo, omega_o, 0.0);
                    let before = shading;
                    facet_let_in(&mut shading, eye.energy);
                    let rest = fibre_albedo(&shading);
                    for (c, (rest, energy)) in rest.iter().zip(eye.energy).enumerate() {
                        let whole = rest + energy;
                        assert!(whole <= 1.001, "{fibre:?} {albedo}: {whole}");
                        // Nothing reflected: all enters that did not before.
                        let mut open = before;
                        facet_let_in(&mut open, [0.0; 3]);
                        let entering = 1.0 - before.energy[0][c];
                        let other = fibre_albedo(&before)[c] - before.energy[0][c];
                        assert!((fibre_albedo(&open)[c] * entering - other).abs() < 1e-9);
                    }
                    // No surface reflection of its own is left.
                    assert_eq!(shading.energy[0], [0.0; 3]);
                    let k = fibre_evaluate(&shading, direction(-theta, -phi));
                    assert!(k.iter().all(|k| k.is_finite() && *k >= 0.0));
                }
            }
        }
    }
}
