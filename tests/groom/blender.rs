//! The way from Blender, by the script of `docs/blender.md`: needs a Python with `bpy`, which `make blender` installs, or which
//! `PLUMAGE_BPY` names; without one nothing is tested, and the test says so.

use super::authored::cards;
use bevy_plumage::groom::*;
use std::{ffi::OsString, path::PathBuf, process::Command};

fn python() -> Option<OsString> {
    let named = std::env::var_os("PLUMAGE_BPY");
    let own: PathBuf = plumage_tests::root().join("scripts/blender/.venv/bin/python");
    named.or_else(|| own.exists().then(|| own.into_os_string()))
}

#[test]
fn a_bird_comes_from_blender() {
    let Some(python) = python() else {
        println!(
            "skipped: no Python with bpy (`make blender` installs one, PLUMAGE_BPY names one)"
        );
        return;
    };
    let file = plumage_tests::failure("blender_bird.glb");
    let script = plumage_tests::root().join("scripts/blender/feather.py");
    let run = Command::new(&python).arg(&script).arg(&file).output();
    let run = run.unwrap_or_else(|error| panic!("{python:?}: {error}"));
    assert!(
        run.status.success(),
        "{}{}",
        String::from_utf8_lossy(&run.stdout),
        String::from_utf8_lossy(&run.stderr)
    );
    let (cards, state, regions) = cards(file);
    println!("{} feathers, {:?}", cards.len(), state.warnings);
    assert_eq!(state.warnings, Vec::<String>::new());
    // Six feathers of the tail on each side, as long as their empty says.
    // Rows come after the regions, one of which is the bone of the same name.
    let tail = regions.iter().rposition(|region| region.name == "tail");
    let of_tail = |card: &&Card| Some(usize::from(card.region)) == tail;
    let tail: Vec<&Card> = cards.iter().filter(of_tail).collect();
    assert_eq!(tail.len(), 12);
    for card in &tail {
        assert!((0.13..0.2).contains(&card.length), "{}", card.length);
        assert!(card.along.z < -0.7, "the tail points to {}", card.along);
    }
    let scattered = || cards.iter().filter(|card| !of_tail(card));
    // glTF: z forward, y up. None on the bill, short ones on the head.
    let bill = bevy::math::Vec3::new(0.0, 0.055, 0.19);
    let on_bill = scattered().filter(|card| card.root.distance(bill) < 0.02);
    assert_eq!(on_bill.count(), 0);
    let mean = |head: bool| {
        let some = scattered().filter(|card| (card.root.z > 0.09) == head);
        let (sum, count) = some.fold((0.0, 0), |(sum, n), card| (sum + card.length, n + 1));
        assert!(count > 50, "{count}");
        sum / count as f32
    };
    let (head, body) = (mean(true), mean(false));
    assert!(head < 0.7 * body, "{head} {body}");
    // Along the guides: backwards on the back.
    let back = scattered().filter(|card| {
        let [x, y, z] = card.root.to_array();
        y > 0.02 && x.abs() < 0.03 && z.abs() < 0.05
    });
    let (along, count) = back.fold((0.0, 0), |(sum, n), card| (sum - card.along.z, n + 1));
    assert!(along / count as f32 > 0.8, "{along} {count}");
}
