//! The coats of the birds lie in order: ranks, and what can be seen of them in the poses that the birds wear.

use bevy::math::Vec3;
use bevy_plumage::{FeatherSettings, groom::Coat};
use plumage_tests::{
    order::{Measured, Tally},
    scene_bird::SceneBird,
};
use std::sync::OnceLock;

pub fn groomed(name: &'static str) -> &'static (SceneBird, Coat) {
    static PARROT: OnceLock<(SceneBird, Coat)> = OnceLock::new();
    static EAGLE: OnceLock<(SceneBird, Coat)> = OnceLock::new();
    static OWL: OnceLock<(SceneBird, Coat)> = OnceLock::new();
    let cell = match name {
        "parrot" => &PARROT,
        "eagle" => &EAGLE,
        _ => &OWL,
    };
    cell.get_or_init(|| {
        let bird = SceneBird::load(name);
        let coat = bird.groom(1, 1.0);
        (bird, coat)
    })
}

#[test]
fn ranks_are_a_permutation_and_rows_keep_their_own_order() {
    for name in ["parrot", "eagle", "owl"] {
        let (bird, coat) = groomed(name);
        let mut ranks: Vec<f32> = coat.cards.iter().map(|card| card.layer).collect();
        ranks.sort_by(f32::total_cmp);
        let whole = ranks.iter().enumerate().all(|(i, rank)| *rank == i as f32);
        assert!(whole, "{name}: the layers are no permutation");
        let regions = bird.groom.regions.len();
        for (number, row) in bird.groom.rows.iter().enumerate() {
            let of_row: Vec<f32> = coat
                .cards
                .iter()
                .filter(|card| usize::from(card.region) == regions + number)
                .map(|card| card.layer)
                .collect();
            let rises = row.layer.1 > row.layer.0;
            for side in of_row.chunks(row.lengths.len()) {
                let ordered = side.windows(2).all(|pair| (pair[1] > pair[0]) == rises);
                assert!(ordered, "{name}: {} is out of order", row.name);
            }
        }
    }
}

/// Bounds of the pixels of feathers, per cent: wrong, and of another color, by depth alone and with the usual window.
struct Bounds {
    name: &'static str,
    quiet: [(f32, f32); 2],
    /// Time of the widest stretch of the wing, seconds, and its bounds.
    stretch: (f32, [(f32, f32); 2]),
}

const BOUNDS: [Bounds; 3] = [
    Bounds {
        name: "parrot",
        quiet: [(1.41, 0.26), (0.28, 0.03)],
        stretch: (3.38, [(0.86, 0.1), (0.4, 0.03)]),
    },
    Bounds {
        name: "eagle",
        quiet: [(2.24, 0.07), (0.43, 0.03)],
        stretch: (4.05, [(1.37, 0.12), (0.22, 0.02)]),
    },
    Bounds {
        name: "owl",
        quiet: [(1.7, 0.15), (0.46, 0.04)],
        stretch: (4.05, [(2.1, 0.33), (0.54, 0.15)]),
    },
];

/// Flicker per 1/30 s while the bird is quiet, by depth alone and with the usual window.
const FLICKER: [f32; 2] = [0.065, 0.038];
/// Pixels of the body that the window paints over.
const PAINTED: f32 = 0.023;
/// Feathers that pass the depth test at a pixel without a prepass.
const RUNS: f32 = 1.15;
/// Feathers shaded at a pixel with the usual window.
const SHADED: f32 = 1.4;

#[test]
fn few_pixels_show_a_feather_that_another_should_cover() {
    let usual = FeatherSettings::default().order_window;
    let mut failures = Vec::new();
    for bounds in BOUNDS {
        let name = bounds.name;
        let (bird, coat) = groomed(name);
        for (open, window) in [0.0, usual].into_iter().enumerate() {
            let measured = Measured::new(bird, coat, 200, window);
            let mut quiet = Tally::default();
            for phase in [0.02, 0.2, 0.4] {
                quiet.add(&measured.tally(Some(phase * bird.duration), true));
            }
            let stretch = measured.tally(Some(bounds.stretch.0), false);
            for (what, found, (wrong, color)) in [
                ("quiet", &quiet.all, bounds.quiet[open]),
                ("stretch", &stretch.all, bounds.stretch.1[open]),
            ] {
                println!(
                    "{name}, {what}, window {window}: {:.2} %, {:.2} %, flicker {:.3} %, painted over {:.3} %, {:.2?} pass",
                    found.wrong(),
                    found.color(),
                    found.flicker(),
                    found.painted(),
                    found.passing_depth()
                );
                assert!(found.feathers > 20_000, "{name}: {found:?}");
                if found.wrong() >= wrong || found.color() >= color {
                    failures.push(format!(
                        "{name}, {what}, window {window}: {:.2} %, {:.2} %; below {wrong}, {color}",
                        found.wrong(),
                        found.color()
                    ));
                }
                assert!(found.painted() < PAINTED, "{name}: {found:?}");
                assert!(found.shaded() < SHADED, "{name}: {found:?}");
                let [layers, backs_last] = found.passing_depth();
                assert!(backs_last < layers.min(RUNS), "{name}: {found:?}");
            }
            assert!(quiet.all.flicker() < FLICKER[open], "{name}: {quiet:?}");
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}

/// Longest scattered feather of a bird that a joint has drawn out, over its length in the groom.
fn longest(name: &'static str, phase: f32) -> f32 {
    let (bird, coat) = groomed(name);
    let skinning = bird.skinning(Some(phase * bird.duration));
    let carries = SceneBird::carries(coat, &skinning);
    let posed = bird.pose(&SceneBird::vertices(coat, &skinning), &carries, &skinning);
    let scattered = coat.cards.iter().zip(&coat.geometry);
    let lengths = scattered.filter_map(|(card, geometry)| {
        let region = bird.groom.regions.get(usize::from(card.region))?;
        let wide = usize::from(region.segments.across) + 1;
        let first = geometry.first_vertex as usize;
        let own = &posed.cards[first..first + geometry.vertex_count as usize];
        let shaft: Vec<Vec3> = own.chunks(wide).map(|row| row[wide / 2]).collect();
        let pairs = shaft.windows(2);
        let length: f32 = pairs.map(|pair| pair[0].distance(pair[1])).sum();
        Some(length / card.length)
    });
    lengths.fold(0.0, f32::max)
}

#[test]
fn joints_draw_no_feather_far_out_of_shape() {
    for name in ["parrot", "eagle", "owl"] {
        // At rest the wings are folded; bind pose has them open.
        for phase in [0.02, 0.68] {
            let found = longest(name, phase);
            println!("{name}, phase {phase}: {found:.2} lengths");
            assert!(found < 3.5, "{name}, phase {phase}: {found}");
        }
    }
}
