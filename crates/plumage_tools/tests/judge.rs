//! The judge of pictures: clean pictures pass, each fault fails its own line.

use plumage_tools::judge::{Line, Species, Subject, View};

const WIDTH: usize = 80;
/// What a pixel measures, millimetres: that of the photographs.
const SCALE: f32 = 0.9;
/// Feathers in a mask.
const FEATHERS: [u8; 3] = [90, 200, 0];

/// Middle and radius of the breast of [`bird`].
const BREAST: [f32; 3] = [40.0, 50.0, 10.0];

/// A red ellipse on dark green, and its mask.
fn bird(color: [u8; 3]) -> (Vec<u8>, Vec<u8>) {
    let (mut picture, mut mask) = (Vec::new(), Vec::new());
    for y in 0..100 {
        for x in 0..WIDTH {
            let (u, v) = ((x as f32 - 40.0) / 22.0, (y as f32 - 50.0) / 45.0);
            let inside = u * u + v * v < 1.0;
            picture.extend(if inside { color } else { [20, 40, 12] });
            mask.extend(if inside { FEATHERS } else { [0; 3] });
        }
    }
    (picture, mask)
}

fn found(picture: &[u8], mask: &[u8], species: Species, view: View) -> Vec<Line> {
    Subject::new(picture, mask, WIDTH, SCALE, &[BREAST]).judge(species, view)
}

fn failures(lines: &[Line], number: u32) -> usize {
    let of = lines.iter().filter(|line| line.number == number);
    of.filter(|line| !line.passes()).count()
}

#[test]
fn a_clean_scarlet_body_passes_and_each_fault_fails_its_line() {
    let scarlet = [205, 52, 36];
    let (picture, mask) = bird(scarlet);
    let clean = found(&picture, &mask, Species::Macaw, View::Front);
    for number in [1, 2, 6, 8, 9] {
        assert_eq!(failures(&clean, number), 0, "{number}: {clean:?}");
    }
    // An even body has no detail at all.
    assert_eq!(failures(&clean, 7), 4, "{clean:?}");
    let at = |x: usize, y: usize| 3 * (y * WIDTH + x);
    let set = |bytes: &mut Vec<u8>, x: usize, y: usize, color: [u8; 3]| {
        bytes[at(x, y)..at(x, y) + 3].copy_from_slice(&color);
    };
    let (mut speckled, mut stray) = (picture.clone(), (picture.clone(), mask.clone()));
    for k in 0..8 {
        set(&mut speckled, 30 + 3 * k, 50, [255, 180, 150]);
    }
    let lines = found(&speckled, &mask, Species::Macaw, View::Front);
    assert_eq!(failures(&lines, 2), 1, "{lines:?}");
    set(&mut stray.0, 5, 5, scarlet);
    set(&mut stray.1, 5, 5, FEATHERS);
    let lines = found(&stray.0, &stray.1, Species::Macaw, View::Front);
    assert_eq!(failures(&lines, 1), 1, "{lines:?}");
    let (crimson, mask) = bird([178, 37, 41]);
    let lines = found(&crimson, &mask, Species::Macaw, View::Front);
    assert!(failures(&lines, 6) >= 2, "{lines:?}");
    let (dark, mask) = bird([20, 16, 12]);
    let lines = found(&dark, &mask, Species::Eagle, View::Back);
    assert_eq!(failures(&lines, 4), 2, "{lines:?}");
}

#[test]
fn contrast_is_found_at_its_own_scale() {
    for (period, octave) in [(4.0, 0), (8.0, 1), (16.0, 2), (32.0, 3)] {
        let mut grey = Vec::new();
        for i in 0..WIDTH * 100 {
            let (x, y) = ((i % WIDTH) as f32, (i / WIDTH) as f32);
            let turn = std::f32::consts::TAU / period;
            let wave = (turn * x).sin() * (turn * y).sin();
            grey.extend([(128.0 + 50.0 * wave) as u8; 3]);
        }
        let mask = FEATHERS.repeat(grey.len() / 3);
        let subject = Subject::new(&grey, &mask, WIDTH, SCALE, &[]);
        let all: Vec<usize> = (0..WIDTH * 100).collect();
        let found = subject.octaves(&all);
        let strongest = (0..4).max_by(|a, b| found[*a].total_cmp(&found[*b]));
        assert_eq!(strongest, Some(octave), "{period}: {found:?}");
    }
    // Of an owl only what holds for any bird.
    let (white, mask) = bird([225, 214, 196]);
    let lines = found(&white, &mask, Species::Owl, View::Front);
    let numbers: Vec<u32> = lines.iter().map(|line| line.number).collect();
    assert_eq!(numbers, [1, 2, 6, 9, 12], "{lines:?}");
    assert!(lines.iter().all(Line::passes), "{lines:?}");
}

#[test]
fn two_birds_are_measured_apart() {
    let (single, mask) = bird([205, 52, 36]);
    let beside = |bytes: &[u8]| -> Vec<u8> {
        let rows = bytes.chunks_exact(3 * WIDTH);
        rows.flat_map(|row| [row, row].concat()).collect()
    };
    let width = |lines: Vec<Line>| {
        let line = lines
            .into_iter()
            .find(|line| line.what == "width over height");
        line.map(|line| line.found)
    };
    let one = width(found(&single, &mask, Species::Macaw, View::Back));
    let pair = Subject::new(&beside(&single), &beside(&mask), 2 * WIDTH, SCALE, &[]);
    assert_eq!(width(pair.judge(Species::Macaw, View::Back)), one);
}

#[test]
fn feet_and_bill_are_the_bird_but_not_its_feathers() {
    let (mut picture, mut mask) = bird([205, 52, 36]);
    // An olive bill that sticks out of the body, blue in the mask.
    for y in 40..50 {
        for x in 60..75 {
            let at = 3 * (y * WIDTH + x);
            picture[at..at + 3].copy_from_slice(&[90, 70, 30]);
            mask[at..at + 3].copy_from_slice(&[0, 0, 255]);
        }
    }
    let lines = found(&picture, &mask, Species::Macaw, View::Front);
    assert_eq!(failures(&lines, 6), 0, "{lines:?}");
    assert_eq!(failures(&lines, 1), 0, "{lines:?}");
    let slim = |lines: &[Line]| {
        let line = lines.iter().find(|line| line.what == "width over height");
        line.map(|line| line.found)
    };
    let (plain, plain_mask) = bird([205, 52, 36]);
    let plain = found(&plain, &plain_mask, Species::Macaw, View::Back);
    let billed = found(&picture, &mask, Species::Macaw, View::Back);
    assert!(slim(&billed) > slim(&plain), "{billed:?}");
}

#[test]
fn a_breast_is_where_the_circle_is() {
    let (mut picture, mask) = bird([205, 52, 36]);
    // A pale wing beside the breast.
    for y in 30..70 {
        for x in 52..WIDTH {
            let at = 3 * (y * WIDTH + x);
            if picture[at] == 205 {
                picture[at..at + 3].copy_from_slice(&[120, 120, 160]);
            }
        }
    }
    let lines = found(&picture, &mask, Species::Macaw, View::Front);
    assert_eq!(failures(&lines, 8), 0, "{lines:?}");
    let wing = Subject::new(&picture, &mask, WIDTH, SCALE, &[[50.0, 50.0, 6.0]]);
    let lines = wing.judge(Species::Macaw, View::Front);
    assert_eq!(failures(&lines, 8), 1, "{lines:?}");
}

/// A red square of feathers with the pixels of `paint` changed in picture and mask.
fn square(paint: impl Fn(usize, usize) -> Option<([u8; 3], [u8; 3])>) -> Vec<Line> {
    const SIDE: usize = 100;
    let (mut picture, mut mask) = (Vec::new(), Vec::new());
    for (x, y) in (0..SIDE * SIDE).map(|i| (i % SIDE, i / SIDE)) {
        let inside = (20..60).contains(&x) && (20..60).contains(&y);
        let usual = if inside {
            ([150, 30, 20], FEATHERS)
        } else {
            ([10, 40, 10], [0; 3])
        };
        let (shown, shape) = paint(x, y).unwrap_or(usual);
        picture.extend(shown);
        mask.extend(shape);
    }
    let subject = Subject::new(&picture, &mask, SIDE, 1.0, &[[40.0, 40.0, 10.0]]);
    subject.judge(Species::Macaw, View::Side)
}

fn of(lines: &[Line], what: &str) -> f32 {
    let line = lines.iter().find(|line| line.what.starts_with(what));
    line.map_or(f32::NAN, |line| line.found)
}

#[test]
fn a_piece_is_astray_unless_a_thing_hides_what_joins_it() {
    const THING: [u8; 3] = [0, 0, 60];
    let piece = |x, y| ((80..83).contains(&x) && y == 40).then_some(([150, 30, 20], FEATHERS));
    let stray = "pixels away";
    assert_eq!(of(&square(piece), stray), 3.0);
    let twig = |x, y| {
        let thing = (60..80).contains(&x) && y == 40;
        thing.then_some(([90; 3], THING)).or(piece(x, y))
    };
    assert_eq!(of(&square(twig), stray), 0.0);
}

#[test]
fn a_region_of_a_wrong_color_is_one_piece_within_the_feathers() {
    let region = "largest olive";
    let spots = square(|x, y| {
        let spot = (25..55).contains(&x) && x % 5 == 0 && (25..55).contains(&y) && y % 5 == 0;
        spot.then_some(([100, 80, 10], FEATHERS))
    });
    assert!((of(&spots, region) - 100.0 / 1600.0).abs() < 1.0e-3);
    let block = square(|x, y| {
        let inside = (30..40).contains(&x) && (30..36).contains(&y);
        inside.then_some(([100, 80, 10], FEATHERS))
    });
    assert!((of(&block, region) - 6000.0 / 1600.0).abs() < 1.0e-3);
    let rim = square(|x, y| {
        let rim = x == 20 && (20..60).contains(&y);
        rim.then_some(([100, 80, 10], FEATHERS))
    });
    assert_eq!(of(&rim, region), 0.0);
}
