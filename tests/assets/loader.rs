//! Feathers through Bevy's asset server: good, damaged, with an image, saved and loaded again.

use bevy::{
    app::{App, TaskPoolPlugin},
    asset::{
        AssetApp, AssetPlugin, AssetServer, Assets, Handle, LoadState,
        saver::{SavedAsset, save_using_saver},
    },
    image::Image,
};
use bevy_plumage::anatomy::{AnatomyPlugin, Down, Feather};
use bevy_plumage::asset::{AssetLink, RonAsset, RonLoader, RonSaver};
use bevy_plumage::groom::{Groom, Region};
use plumage_tests::wait;
use std::{fs, path::PathBuf};

struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("bevy_plumage_{name}_{}", std::process::id()));
        fs::create_dir_all(&path).expect("a folder");
        Self(path)
    }

    fn put(&self, name: &str, bytes: &[u8]) {
        fs::write(self.0.join(name), bytes).expect("written");
    }

    fn app(&self) -> App {
        let mut app = App::new();
        app.add_plugins((
            TaskPoolPlugin::default(),
            AssetPlugin {
                file_path: self.0.display().to_string(),
                ..Default::default()
            },
        ))
        .init_asset::<Image>()
        .add_plugins(AnatomyPlugin)
        .init_asset::<Groom>()
        .init_asset_loader::<RonLoader<Groom>>();
        app
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Runs the app until the feather is loaded or refused.
fn settle(app: &mut App, handle: &Handle<Feather>) -> LoadState {
    wait::until("the asset", || {
        app.update();
        let state = app.world().resource::<AssetServer>().load_state(handle);
        matches!(state, LoadState::Loaded | LoadState::Failed(_)).then_some(state)
    })
}

#[test]
fn a_good_feather_loads() {
    let folder = Folder::new("good");
    let preset = plumage_tests::shipped::feather("eagle_primary");
    folder.put("p.feather.ron", preset.to_ron().expect("text").as_bytes());
    let mut app = folder.app();
    let handle = app.world().resource::<AssetServer>().load("p.feather.ron");
    assert!(settle(&mut app, &handle).is_loaded());
    app.update();
    assert_eq!(
        app.world().resource::<Assets<Feather>>().get(&handle),
        Some(&preset)
    );
}

#[test]
fn a_damaged_feather_fails_with_file_and_field() {
    let folder = Folder::new("bad");
    let text = plumage_tests::shipped::feather("eagle_primary")
        .to_ron()
        .expect("text");
    for (name, bytes, expected) in [
        (
            "angle.feather.ron",
            text.replacen("barb_angle: 17.0", "barb_angle: 97.0", 1),
            "angle.feather.ron: `left.barb_angle` is 97, allowed is 5 to 85",
        ),
        (
            "cut.feather.ron",
            text[..text.len() / 2].to_owned(),
            "cut.feather.ron:",
        ),
        (
            "new.feather.ron",
            text.replacen("version: 2", "version: 3", 1),
            "new.feather.ron: format version 3, this crate reads 1 to 2",
        ),
    ] {
        folder.put(name, bytes.as_bytes());
        let mut app = folder.app();
        let handle = app.world().resource::<AssetServer>().load(name.to_owned());
        match settle(&mut app, &handle) {
            LoadState::Failed(error) => {
                let message = error.to_string();
                assert!(message.contains(expected), "{name}: {message}");
            }
            state => panic!("{name}: {state:?}"),
        }
    }
}

#[test]
fn the_image_of_a_feather_is_its_dependency() {
    let folder = Folder::new("image");
    let mut feather = plumage_tests::shipped::feather("contour");
    feather.albedo.image = Some("paint.png".to_owned());
    fs::create_dir_all(folder.0.join("sub")).expect("a folder");
    folder.put(
        "sub/i.feather.ron",
        feather.to_ron().expect("text").as_bytes(),
    );
    let mut app = folder.app();
    let handle = app
        .world()
        .resource::<AssetServer>()
        .load("sub/i.feather.ron");
    assert!(
        settle(&mut app, &handle).is_loaded(),
        "the feather itself needs no pixels"
    );
    app.update();
    let feathers = app.world().resource::<Assets<Feather>>();
    let image = feathers
        .get(&handle)
        .and_then(|feather| feather.image.clone())
        .expect("a handle");
    let path = image.path().expect("a path").to_string();
    assert_eq!(
        path.replace('\\', "/"),
        "sub/paint.png",
        "relative to the feather file"
    );
}

#[test]
fn the_saver_writes_what_the_loader_reads() {
    let folder = Folder::new("saver");
    let preset = plumage_tests::shipped::feather("macaw_rectrix");
    let mut app = folder.app();
    let server = app.world().resource::<AssetServer>().clone();
    let save = |feather: &Feather| {
        bevy::tasks::block_on(save_using_saver(
            server.clone(),
            &RonSaver::default(),
            &"s.feather.ron".into(),
            SavedAsset::from_asset(feather),
            &(),
        ))
    };
    save(&preset).expect("saved");
    let handle = server.load("s.feather.ron");
    assert!(settle(&mut app, &handle).is_loaded());
    app.update();
    let feathers = app.world().resource::<Assets<Feather>>();
    assert_eq!(feathers.get(&handle), Some(&preset));
    let mut wrong = preset.clone();
    wrong.aspect = 0.0;
    let error = save(&wrong).expect_err("no width");
    assert!(error.to_string().contains("`aspect` is 0"), "{error}");
}

/// A groom in a folder of its own that names a feather and a down beside that folder.
fn put_groom(folder: &Folder) -> Groom {
    let mut region = Region::new("all");
    region.down = Some("../downs/a.down.ron".into());
    let mut groom = Groom::default();
    groom.feathers = vec!["../feathers/a.feather.ron".into()];
    groom.regions = vec![region];
    for name in ["grooms", "feathers", "downs"] {
        fs::create_dir_all(folder.0.join(name)).expect("a folder");
    }
    let text = groom.to_ron().expect("text");
    folder.put("grooms/x.groom.ron", text.as_bytes());
    let feather = plumage_tests::shipped::feather("contour");
    let text = feather.to_ron().expect("text");
    folder.put("feathers/a.feather.ron", text.as_bytes());
    groom
}

fn path<A: bevy::asset::Asset>(link: &AssetLink<A>) -> String {
    let path = link.handle().and_then(|handle| handle.path());
    path.expect("a path").to_string().replace('\\', "/")
}

#[test]
fn a_groom_is_loaded_when_its_feathers_and_downs_are() {
    let folder = Folder::new("groom");
    let written = put_groom(&folder);
    let text = Down::default().to_ron().expect("text");
    folder.put("downs/a.down.ron", text.as_bytes());
    let mut app = folder.app();
    let server = app.world().resource::<AssetServer>().clone();
    let handle: Handle<Groom> = server.load("grooms/x.groom.ron");
    wait::until("the groom and all that it names", || {
        app.update();
        server.is_loaded_with_dependencies(&handle).then_some(())
    });
    let world = app.world();
    let groom = world.resource::<Assets<Groom>>().get(&handle).expect("it");
    let feather = groom.feathers[0].handle().expect("a handle");
    assert_eq!(path(&groom.feathers[0]), "feathers/a.feather.ron");
    assert!(world.resource::<Assets<Feather>>().get(feather).is_some());
    let down = groom.regions[0].down.as_ref().expect("down");
    assert_eq!(path(down), "downs/a.down.ron");
    let down = down.handle().expect("a handle");
    assert!(world.resource::<Assets<Down>>().get(down).is_some());
    // The paths go back into the file as they were.
    assert_eq!(groom, &written);
    assert_eq!(
        groom.to_ron().expect("text"),
        written.to_ron().expect("text")
    );
}

#[test]
fn a_groom_whose_down_is_missing_is_not_complete() {
    let folder = Folder::new("no_down");
    put_groom(&folder);
    let mut app = folder.app();
    let server = app.world().resource::<AssetServer>().clone();
    let handle: Handle<Groom> = server.load("grooms/x.groom.ron");
    wait::until("the missing down", || {
        app.update();
        matches!(
            server.dependency_load_state(&handle),
            bevy::asset::DependencyLoadState::Failed(_)
        )
        .then_some(())
    });
    assert!(server.load_state(&handle).is_loaded());
    assert!(!server.is_loaded_with_dependencies(&handle));
}

#[test]
fn a_groom_made_in_code_takes_handles_and_writes_their_paths() {
    let folder = Folder::new("in_code");
    put_groom(&folder);
    let mut app = folder.app();
    let server = app.world().resource::<AssetServer>().clone();
    let mut groom = Groom::default();
    groom.feathers = vec![server.load::<Feather>("feathers/a.feather.ron").into()];
    let text = groom.to_ron().expect("text");
    assert!(text.contains("\"/feathers/a.feather.ron\""), "{text}");
    // Below any folder that path is the same file.
    folder.put("grooms/y.groom.ron", text.as_bytes());
    let handle: Handle<Groom> = server.load("grooms/y.groom.ron");
    wait::until("the groom and its feather", || {
        app.update();
        server.is_loaded_with_dependencies(&handle).then_some(())
    });
    let mut feathers = app.world_mut().resource_mut::<Assets<Feather>>();
    let unnamed = feathers.add(Feather::default());
    groom.feathers = vec![unnamed.into()];
    groom.validate("in code").expect("usable");
    let error = groom.to_ron().expect_err("no path to write").to_string();
    assert!(error.contains("no path"), "{error}");
}
