//! The judge of pictures: clean pictures pass, each fault fails its own line.

use plumage_tools::judge::{Line, Species, Subject, View};

const WIDTH: usize = 80;
/// What a pixel measures, millimetres: that of the photographs.
const SCALE: f32 = 0.9;
/// Feathers in a mask.
const FEATHERS: [u8; 3] = [90, 200, 0];

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
    Subject::new(picture, mask, WIDTH, SCALE).judge(species, view)
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
        let subject = Subject::new(&grey, &mask, WIDTH, SCALE);
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
    let pair = Subject::new(&beside(&single), &beside(&mask), 2 * WIDTH, SCALE);
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
fn the_breasts_of_two_birds_lie_within_each() {
    // Between two birds the middle third of a row would be their wings.
    let (single, mask) = bird([205, 52, 36]);
    let with_wings = |bytes: &[u8], flip: bool| -> Vec<u8> {
        let mut bytes = bytes.to_vec();
        for y in 30..70 {
            for x in 40..WIDTH {
                let x = if flip { WIDTH - 1 - x } else { x };
                let at = 3 * (y * WIDTH + x);
                let outer = if flip { x < 28 } else { x > 52 };
                if outer && bytes[at] == 205 {
                    bytes[at..at + 3].copy_from_slice(&[120, 120, 160]);
                }
            }
        }
        bytes
    };
    let beside = |left: &[u8], right: &[u8]| -> Vec<u8> {
        let rows = left
            .chunks_exact(3 * WIDTH)
            .zip(right.chunks_exact(3 * WIDTH));
        rows.flat_map(|(a, b)| [a, b].concat()).collect()
    };
    let picture = beside(&with_wings(&single, false), &with_wings(&single, true));
    let pair = Subject::new(&picture, &beside(&mask, &mask), 2 * WIDTH, SCALE);
    let lines = pair.judge(Species::Macaw, View::Front);
    assert_eq!(failures(&lines, 8), 0, "{lines:?}");
}
