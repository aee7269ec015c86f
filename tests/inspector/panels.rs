//! The inspector's panels without a window: what is drawn, what a click does, what a wrong file shows.
use bevy_egui::egui;
use bevy_plumage::anatomy::Feather;
use bevy_plumage::inspector::{
    Command, Document, FeatherPanel, Fields, GroomPanel, Sample, Session, Statistics, Toolbar,
    feather_panel, groom_panel, plumage_panel, quality_panel, statistics_panel, toolbar,
    weather_panel,
};
use bevy_plumage::prelude::*;
use egui_kittest::{
    Harness,
    kittest::{NodeT, Queryable},
};
use std::{
    cell::{Cell, RefCell},
    rc::Rc,
};

const SIZE: egui::Vec2 = egui::vec2(420.0, 2400.0);

fn feather() -> Feather {
    plumage_tests::shipped::feather("macaw_primary")
}

fn parrot() -> Groom {
    plumage_tests::shipped::groom("parrot")
}

#[test]
fn a_feather_shows_every_parameter_and_is_left_alone() {
    let state = (Fields::default(), FeatherPanel::default(), feather());
    let mut harness = Harness::builder().with_size(SIZE).build_ui_state(
        |ui, (fields, panel, feather)| {
            feather_panel(ui, fields, panel, feather);
        },
        state,
    );
    harness.run_steps(3);
    for name in [
        "length",
        "barb count",
        "barb angle",
        "spacing",
        "fringe",
        "eta",
        "longitudinal roughness",
        "strength",
    ] {
        assert!(
            harness.query_all_by_label(name).next().is_some(),
            "{name} is not shown"
        );
    }
    assert_eq!(harness.state().2, feather(), "drawing changed the feather");
}

#[test]
fn a_slider_changes_its_value_within_its_range() {
    let state = (Fields::default(), feather(), false);
    let mut harness = Harness::builder().with_size(SIZE).build_ui_state(
        |ui, (fields, feather, changed)| {
            *changed |= fields.edit(ui, "vane", &mut feather.left);
        },
        state,
    );
    harness.run_steps(2);
    let sliders: Vec<_> = harness
        .query_all_by_role(egui::accesskit::Role::Slider)
        .map(|node| node.rect())
        .collect();
    assert_eq!(sliders.len(), 9, "nine numbers of a vane are sliders");
    // Barb angle is the second; its right end is 85 degrees.
    let end = sliders[1].right_center() - egui::vec2(1.0, 0.0);
    for event in [
        egui::Event::PointerMoved(end),
        egui::Event::PointerButton {
            pos: end,
            button: egui::PointerButton::Primary,
            pressed: true,
            modifiers: egui::Modifiers::NONE,
        },
    ] {
        harness.event(event);
    }
    harness.run_steps(2);
    let (_, changed, edited) = {
        let (_, feather, changed) = harness.state();
        ((), feather.clone(), *changed)
    };
    assert!(edited);
    assert!(
        changed.left.barb_angle > 80.0 && changed.left.barb_angle <= 85.0,
        "{}",
        changed.left.barb_angle
    );
    assert_eq!(changed.right, feather().right);
    changed.validate("changed").unwrap();
}

#[test]
fn another_kind_of_fibre_begins_with_valid_numbers() {
    let state = (Fields::default(), feather());
    let mut harness = Harness::builder().with_size(SIZE).build_ui_state(
        |ui, (fields, feather)| {
            fields.edit(ui, "fibre", &mut feather.optics.barb);
        },
        state,
    );
    harness.run_steps(2);
    for (name, number) in [
        ("Structural", "core radius"),
        ("Pigment", "medulla radius"),
        ("Structural", "core radius"),
    ] {
        let combo = harness
            .query_all_by_role(egui::accesskit::Role::ComboBox)
            .next();
        combo.expect("a list of kinds").click();
        harness.run_steps(3);
        let choices: Vec<_> = harness.query_all_by_label(name).collect();
        choices.last().expect("the kind is offered").click();
        harness.run_steps(3);
        let kind = format!("{:?}", harness.state().1.optics.barb.kind);
        assert!(kind.starts_with(name), "{kind}");
        assert!(harness.query_all_by_label(number).next().is_some());
        harness.state().1.validate("clicked").unwrap();
    }
}

#[test]
fn grooms_quality_and_statistics_draw() {
    let groom = Rc::new(RefCell::new(parrot()));
    let drawn = Rc::new(Cell::new(0));
    let (seen, count) = (groom.clone(), drawn.clone());
    let fields = Fields::default();
    let mut panel = GroomPanel::default();
    let mut quality = FeatherQuality::default();
    let mut plumage = Plumage::default();
    let mut statistics = Statistics::default();
    statistics.push(Sample {
        feathers: 6250,
        passes: vec![("feather_lod".into(), 0.25)],
        errors: vec!["parrot.groom.ron: broken".into()],
        ..Sample::default()
    });
    let mut weather = Weather::default();
    let mut harness = Harness::builder().with_size(SIZE).build_ui(move |ui| {
        let changed = groom_panel(ui, &fields, &mut panel, &mut seen.borrow_mut());
        assert!(!changed, "drawing changed the groom");
        assert!(!quality_panel(ui, &fields, &mut quality));
        assert!(!weather_panel(ui, &fields, &mut weather));
        assert!(!plumage_panel(ui, &mut plumage, &PlumageState::default()));
        statistics_panel(ui, &statistics);
        count.set(count.get() + 1);
    });
    harness.run_steps(3);
    assert!(drawn.get() > 0);
    for text in [
        "error budget",
        "wetness",
        "density",
        "6250",
        "parrot.groom.ron: broken",
    ] {
        assert!(
            harness.query_all_by_label(text).next().is_some(),
            "{text} is not shown"
        );
    }
    assert_eq!(*groom.borrow(), parrot());
}

#[test]
fn the_bar_asks_for_what_is_clicked() {
    let mut document = Document::open(feather(), None);
    let mut edited = feather();
    edited.length_mm = 50.0;
    document.edit(edited, 1).unwrap();
    let state = (Toolbar::default(), document, Vec::<Command>::new());
    let mut harness = Harness::builder().with_size(SIZE).build_ui_state(
        |ui, (bar, document, asked)| {
            asked.extend(toolbar(ui, bar, document, Some("preset")));
        },
        state,
    );
    harness.run_steps(1);
    for (label, command) in [
        ("Undo", Command::Undo),
        ("Reset", Command::Reset),
        ("Before", Command::Compare(true)),
    ] {
        harness.get_by_label(label).click();
        harness.run_steps(2);
        assert_eq!(harness.state().2.last(), Some(&command), "{label}");
    }
    let redo = harness.get_by_label("Redo");
    assert!(redo.accesskit_node().is_disabled(), "nothing to redo");
    let save = harness.get_by_label("Save *");
    assert!(save.accesskit_node().is_disabled(), "no file to save to");
}

#[test]
fn a_malformed_file_shows_its_error_and_changes_nothing() {
    let folder = std::env::temp_dir().join(format!("bevy_plumage_panel_{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let file = folder.join("broken.feather.ron");
    std::fs::write(&file, "(version: 1, length_mm: \"long\")").unwrap();
    let id = bevy::asset::AssetId::<Feather>::invalid();
    let mut session = Session::<Feather>::default();
    session.document(id, &feather(), || None);
    session.run(id, Command::Load(file.clone()), &folder, None, 1);
    assert_eq!(session.shown(id), Some(&feather()));
    let mut harness = Harness::builder().with_size(SIZE).build_ui_state(
        |ui, session: &mut Session<Feather>| {
            let id = bevy::asset::AssetId::<Feather>::invalid();
            let document = session.get(id).unwrap().clone();
            toolbar(ui, &mut session.toolbar, &document, None);
        },
        session,
    );
    harness.run_steps(1);
    assert!(
        harness
            .query_all_by_label_contains("broken.feather.ron:1:")
            .next()
            .is_some(),
        "the error names file and line"
    );
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn compare_shows_the_saved_state_and_comes_back() {
    let id = bevy::asset::AssetId::<Feather>::invalid();
    let mut session = Session::<Feather>::default();
    session.document(id, &feather(), || None);
    let mut edited = feather();
    edited.gaps.count = 9;
    session.edit(id, edited.clone(), 1);
    let folder = std::path::Path::new("");
    session.run(id, Command::Compare(true), folder, None, 2);
    assert_eq!(session.shown(id), Some(&feather()));
    session.run(id, Command::Compare(false), folder, None, 3);
    assert_eq!(session.shown(id), Some(&edited));
    session.run(id, Command::Undo, folder, None, 4);
    assert_eq!(session.shown(id), Some(&feather()));
    session.run(id, Command::Redo, folder, None, 5);
    assert_eq!(session.shown(id), Some(&edited));
    // An edit out of range is refused with its reason.
    edited.gaps.depth = 7.0;
    session.edit(id, edited, 6);
    let message = session.toolbar.message.clone().unwrap().unwrap_err();
    assert!(message.contains("gaps.depth"), "{message}");
    assert_eq!(session.shown(id).unwrap().gaps.depth, feather().gaps.depth);
}
