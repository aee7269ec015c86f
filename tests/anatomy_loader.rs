//! Feathers through Bevy's asset server: good, damaged, with an image, saved and loaded again.

use bevy::{
    app::{App, TaskPoolPlugin},
    asset::{
        AssetApp, AssetPlugin, AssetServer, Assets, Handle, LoadState,
        saver::{SavedAsset, save_using_saver},
    },
    image::Image,
};
use bevy_plumage::anatomy::{AnatomyPlugin, Feather, FeatherSaver, presets};
use std::{fs, path::PathBuf, time::Duration};

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
        .add_plugins(AnatomyPlugin);
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
    for _ in 0..2000 {
        app.update();
        let state = app.world().resource::<AssetServer>().load_state(handle);
        if matches!(state, LoadState::Loaded | LoadState::Failed(_)) {
            return state;
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    panic!("the feather neither loaded nor failed");
}

#[test]
fn a_good_feather_loads() {
    let folder = Folder::new("good");
    let preset = presets::by_name("eagle_primary").expect("a preset");
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
    let text = presets::by_name("eagle_primary")
        .expect("a preset")
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
            text.replacen("version: 1", "version: 2", 1),
            "new.feather.ron: format version 2, this crate reads 1",
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
    let mut feather = presets::by_name("contour").expect("a preset");
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
    let preset = presets::by_name("macaw_rectrix").expect("a preset");
    let mut app = folder.app();
    let server = app.world().resource::<AssetServer>().clone();
    let save = |feather: &Feather| {
        bevy::tasks::block_on(save_using_saver(
            server.clone(),
            &FeatherSaver,
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
