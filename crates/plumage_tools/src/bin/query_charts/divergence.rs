//! Divergence on the GPU: how unequal the work of the pixels of a tile is, over tilted cards as a picture shows them.

use crate::{
    gpu::{self, Gpu, Spread},
    measure::{numbers, sources},
    methods::{self, Wgsl},
};
use bevy_plumage::maths::Footprint;
use bevy_plumage::maths::query::{ErrorBudget, Vane, mask_vane, reduce};
use plumage_tests::sweep::between;
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

/// Size of the picture in pixels, in whole tiles.
const WIDTH: usize = 192;
const HEIGHT: usize = 96;
/// Side of a tile.
const TILE: usize = 8;

/// What a picture costs.
pub struct Divergence {
    /// Name of the picture.
    pub name: String,
    /// Mean trips per lane.
    pub mean: f64,
    /// Mean over the tiles of the most trips of one of their lanes, over `mean`: what a SIMD machine as wide as a tile pays.
    pub tile: f64,
    /// The same for half tiles and for rows of eight lanes.
    pub half: f64,
    pub row: f64,
    /// Most trips of a lane.
    pub most: f64,
    /// Time with the lanes as in the picture, over the time with every lane of a tile doing the work of the tile's first.
    pub seconds: f64,
    /// Seconds with the pixels shuffled over the picture, over `seconds`.
    pub shuffled: f64,
}

/// Cases of a picture in the order of tiles: a plane of cards, tilted, each card turned by its own angle.
///
/// `near`, `far`: barb periods per pixel at the lower and the upper edge.
fn picture(seed: u64, near: f64, far: f64) -> Vec<[f32; gpu::CASE]> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let vane = Vane::<f32>::from_measures(320.0, 35.0, 18.0, 32.0, 40.0, 6.0, 5.0, 90.0);
    let angles: Vec<f32> = (0..64)
        .map(|_| between(&mut random, -0.9, 0.9) as f32)
        .collect();
    let lifts: Vec<f32> = (0..64)
        .map(|_| between(&mut random, -0.5, 0.5) as f32)
        .collect();
    let mut cases = Vec::with_capacity(WIDTH * HEIGHT);
    for tile in 0..WIDTH * HEIGHT / (TILE * TILE) {
        let (tx, ty) = (tile % (WIDTH / TILE), tile / (WIDTH / TILE));
        for lane in 0..TILE * TILE {
            let (x, y) = (
                (tx * TILE + lane % TILE) as f32,
                (ty * TILE + lane / TILE) as f32,
            );
            // Distance grows upwards; a card is about a quarter of the picture wide at the lower edge.
            let depth = (near * (far / near).powf(f64::from(y) / HEIGHT as f64)) as f32;
            let size = 0.25 * WIDTH as f32 * near as f32;
            let (px, py) = ((x - 0.5 * WIDTH as f32) * depth, 2.5 * y * depth);
            let (cx, cy) = ((px / size).floor(), (py / size).floor());
            let card = (cx as i32 * 7 + cy as i32 * 13).rem_euclid(64) as usize;
            let (sin, cos) = angles[card].sin_cos();
            let pixel = depth * vane.p_b;
            let mean = [
                (px - (cx + 0.5) * size) * vane.p_b,
                (py - cy * size) * vane.p_b,
            ];
            let mean = [
                -0.05 + 0.02 * (cos * mean[0] + sin * mean[1]).rem_euclid(1.0),
                0.2 + (cos * mean[1] - sin * mean[0]).rem_euclid(0.5),
            ];
            // A pixel is 2.5 times longer up the plane than across; the card's own lift changes that.
            let (a, b) = (0.5 * pixel, 1.25 * pixel * (1.0 + lifts[card]));
            let (aa, bb) = (a * a, b * b);
            let covariance = [
                aa * cos * cos + bb * sin * sin,
                (bb - aa) * sin * cos,
                aa * sin * sin + bb * cos * cos,
            ];
            let view = [0.9 * sin, -0.9 * cos, 0.45 + 0.3 * lifts[card]];
            let cell = mask_vane(&vane, view);
            let local = reduce(&cell, &vane, &Footprint { mean, covariance });
            cases.push(numbers(&cell, &local));
        }
    }
    cases
}

/// The chooser's text with a counter in every loop.
fn counted() -> (Vec<(&'static str, String)>, Wgsl) {
    let threshold = ErrorBudget::<f32>::default().threshold();
    let mut wgsl = methods::empty();
    wgsl.text = format!(
        "#import bevy_plumage::masking::Cell
        #import bevy_plumage::query::{{cell_coverage, LOD_MIXED}}
        #import bevy_plumage::query_far::{{Local, trips_far}}
        #import bevy_plumage::query_near::trips_near
        fn measured(cell: Cell, local: Local) -> vec3<f32> {{
            let w = cell_coverage(cell, local, LOD_MIXED, {threshold:?});
            // The sum keeps the call alive.
            return vec3(trips_near() + trips_far(), 1e-12 * w.x, 1e-12 * w.y);
        }}"
    );
    let mut all = sources(&wgsl);
    for (file, source) in &mut all {
        let name = file.trim_start_matches("query_").trim_end_matches(".wgsl");
        if name == "near" || name == "far" {
            let mut text = String::new();
            for line in source.lines() {
                text += line;
                text += "\n";
                let body = line.trim_start();
                if (body.starts_with("for (") || body.starts_with("while ")) && body.ends_with('{')
                {
                    text += "lane_trips += 1.0;\n";
                }
            }
            text += &format!(
                "var<private> lane_trips: f32;\nfn trips_{name}() -> f32 {{ return lane_trips; }}\n"
            );
            *source = text;
        }
    }
    (all, wgsl)
}

/// Measures three pictures: barbules resolved, barbs resolved, and everything between on one tilted plane.
pub fn measure(gpu: &Gpu) -> Vec<Divergence> {
    let (texts, wgsl) = counted();
    let counter = gpu.kernel(texts, &wgsl.text);
    let chosen = methods::all().into_iter().find_map(|m| m.wgsl);
    let Some(chosen) = chosen else {
        return Vec::new();
    };
    let kernel = gpu.kernel(sources(&chosen), &chosen.text);
    let pictures = [
        ("macro: 0.02 to 0.1 barb periods a pixel", 0.02, 0.1),
        ("closeup: 0.1 to 0.6", 0.1, 0.6),
        ("barbs a pixel apart: 0.6 to 2", 0.6, 2.0),
        ("tilted plane: 0.03 to 4", 0.03, 4.0),
    ];
    let best = |input: &[f32]| {
        (0..20)
            .map(|_| gpu.run(&kernel, input, 1, Spread::Lane).0)
            .fold(f64::INFINITY, f64::min)
    };
    pictures
        .into_iter()
        .map(|(name, near, far)| {
            let cases = picture(77, near, far);
            let flat: Vec<f32> = cases.iter().flatten().copied().collect();
            let (_, trips) = gpu.run(&counter, &flat, 1, Spread::Lane);
            let mean_of = |x: &[f32]| x.iter().map(|t| f64::from(*t)).sum::<f64>() / x.len() as f64;
            let most_of = |x: &[f32]| x.iter().fold(0.0f32, |m, t| m.max(*t));
            let mean = mean_of(&trips).max(1e-9);
            let width = |lanes: usize| {
                let most: Vec<f32> = trips.chunks(lanes).map(most_of).collect();
                mean_of(&most) / mean
            };
            let coherent = best(&flat);
            let mut order: Vec<usize> = (0..cases.len()).collect();
            // A fixed shuffle: the golden ratio's multiples.
            order.sort_by_key(|i| (*i as u32).wrapping_mul(2_654_435_769));
            let mixed: Vec<f32> = order.iter().flat_map(|i| cases[*i]).collect();
            Divergence {
                name: name.into(),
                mean,
                tile: width(TILE * TILE),
                half: width(TILE * TILE / 2),
                row: width(TILE),
                most: f64::from(most_of(&trips)),
                seconds: coherent,
                shuffled: best(&mixed) / coherent,
            }
        })
        .collect()
}
