//! A photograph of two things: both are shown, and a click on one makes it the feather.
use bevy_egui::egui;
use bevy_plumage::inspector::{Photos, photo_panel};
use egui_kittest::{Harness, kittest::Queryable};
use image::{Rgb, RgbImage};
use plumage_tests::wait;

/// Two leaves, the right one red.
fn leaves() -> RgbImage {
    RgbImage::from_fn(160, 120, |x, y| {
        let right = x >= 80;
        let (x, y) = ((x % 80) as f32 - 40.0, y as f32);
        let vane =
            (8.0..86.0).contains(&y) && (x / 18.0).powi(2) + ((y - 47.0) / 40.0).powi(2) < 1.0;
        let shaft = (8.0..112.0).contains(&y) && x.abs() < 2.0;
        Rgb(match (shaft, vane, right) {
            (true, ..) => [60, 40, 30],
            (_, true, true) => [170, 60, 40],
            (_, true, false) => [60, 120, 50],
            _ => [215; 3],
        })
    })
}

#[test]
fn a_click_takes_one_of_several_objects() {
    let file = plumage_tests::failure("two_leaves.png");
    leaves().save(&file).expect("the folder for failures");
    let mut photos = Photos::default();
    photos.begin(file);
    wait::until("the refusal", || {
        assert!(photos.poll().is_empty(), "two leaves became one feather");
        (photos.busy() == 0).then_some(())
    });
    assert_eq!(photos.choices.len(), 1);
    assert_eq!(photos.choices[0].objects.len(), 2);
    let mut harness = Harness::builder()
        .with_size(egui::vec2(420.0, 600.0))
        .build_ui_state(|ui, photos| photo_panel(ui, photos, None), photos);
    harness.run_steps(3);
    let shown = harness.query_all_by_label_contains("2 objects").next();
    assert!(shown.is_some(), "the panel does not say what it wants");
    let picture = harness.get_by_label("photograph").rect();
    // In the middle of the right leaf: 3/4 of the width, 2/5 of the height.
    let at = picture.min + picture.size() * egui::vec2(0.75, 0.4);
    harness.event(egui::Event::PointerMoved(at));
    harness.run_steps(1);
    for pressed in [true, false] {
        harness.event(egui::Event::PointerButton {
            pos: at,
            button: egui::PointerButton::Primary,
            pressed,
            modifiers: egui::Modifiers::NONE,
        });
        harness.run_steps(1);
    }
    let photos = harness.state_mut();
    assert_eq!((photos.choices.len(), photos.busy()), (0, 1));
    let found = wait::until("the feather", || photos.poll().pop());
    let middle = found.rachis[found.rachis.len() / 2];
    assert!((middle.x - 120.0).abs() < 8.0, "the shaft is at {middle}");
    let texel = found
        .albedo
        .get_pixel(found.albedo.width() / 4, found.albedo.height() / 2);
    assert!(texel[0] > texel[1], "the green leaf: {texel:?}");
}
