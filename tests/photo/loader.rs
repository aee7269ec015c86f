//! Photographs through Bevy's asset server.
use bevy::{
    app::{App, TaskPoolPlugin},
    asset::{Asset, AssetApp, AssetPlugin, AssetServer, Assets, Handle, LoadState},
    image::{CompressedImageFormats, Image, ImageLoader, ImagePlugin},
};
use bevy_plumage::anatomy::{AnatomyPlugin, Feather};
use bevy_plumage::photo::ExtractPlugin;
use image::{Rgb, RgbImage};
use plumage_tests::wait;
use std::{fs, path::PathBuf};

struct Folder(PathBuf);

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn folder(name: &str) -> Folder {
    let path = std::env::temp_dir().join(format!("bevy_plumage_{name}_{}", std::process::id()));
    fs::create_dir_all(&path).expect("a folder");
    Folder(path)
}

fn app(folder: &Folder) -> App {
    let mut app = App::new();
    app.add_plugins((
        TaskPoolPlugin::default(),
        AssetPlugin {
            file_path: folder.0.display().to_string(),
            ..Default::default()
        },
        ImagePlugin::default(),
        AnatomyPlugin,
        ExtractPlugin,
    ));
    // Bevy's renderer does this, there is none here.
    app.register_asset_loader(ImageLoader::new(CompressedImageFormats::NONE));
    app
}

fn settle<A: Asset>(app: &mut App, handle: &Handle<A>) -> LoadState {
    wait::until("the asset", || {
        app.update();
        let state = app.world().resource::<AssetServer>().load_state(handle);
        matches!(state, LoadState::Loaded | LoadState::Failed(_)).then_some(state)
    })
}

/// A leaf with a stalk is feather enough.
fn leaf() -> RgbImage {
    RgbImage::from_fn(60, 120, |x, y| {
        let (x, y) = (x as f32 - 30.0, y as f32);
        let vane =
            (8.0..86.0).contains(&y) && (x / 18.0).powi(2) + ((y - 47.0) / 40.0).powi(2) < 1.0;
        let shaft = (8.0..112.0).contains(&y) && x.abs() < 2.0;
        Rgb(if shaft {
            [60, 40, 30]
        } else if vane {
            [170, 90, 40]
        } else {
            [215; 3]
        })
    })
}

#[test]
fn photograph_becomes_feather_and_stays_image() {
    let folder = folder("photograph");
    leaf()
        .save(folder.0.join("leaf.feather.png"))
        .expect("saved");
    leaf().save(folder.0.join("plain.png")).expect("saved");
    let mut app = app(&folder);
    let server = app.world().resource::<AssetServer>().clone();

    let feather: Handle<Feather> = server.load("leaf.feather.png");
    assert!(matches!(settle(&mut app, &feather), LoadState::Loaded));
    let labelled: Handle<Feather> = server.load("leaf.feather.png#feather");
    assert!(matches!(settle(&mut app, &labelled), LoadState::Loaded));
    let feathers = app.world().resource::<Assets<Feather>>();
    let found = feathers.get(&feather).expect("loaded");
    assert_eq!(found.name, "leaf");
    assert_eq!(
        feathers.get(&labelled).map(|f| &f.contour),
        Some(&found.contour)
    );
    let albedo = found.image.clone().expect("albedo");
    let images = app.world().resource::<Assets<Image>>();
    assert!(images.get(&albedo).is_some());

    // The plugin takes no picture away from Bevy.
    for name in ["plain.png", "leaf.feather.png"] {
        let image: Handle<Image> = server.load(name);
        assert!(
            matches!(settle(&mut app, &image), LoadState::Loaded),
            "{name}"
        );
        let images = app.world().resource::<Assets<Image>>();
        assert_eq!(images.get(&image).map(Image::width), Some(60), "{name}");
    }
}

/// Any name serves with a `.meta` file that names the loader.
#[test]
fn meta_file_names_the_loader() {
    let folder = folder("photograph_meta");
    leaf().save(folder.0.join("plain.png")).expect("saved");
    let meta = "(meta_format_version: \"1.0\", asset: Load(\
        loader: \"bevy_plumage::photo::PhotographLoader\", \
        settings: (name: \"leaf\", length_mm: Some(80.0), resolution: 256)))";
    fs::write(folder.0.join("plain.png.meta"), meta).expect("written");
    let mut app = app(&folder);
    let server = app.world().resource::<AssetServer>().clone();
    let feather: Handle<Feather> = server.load("plain.png#feather");
    assert!(matches!(settle(&mut app, &feather), LoadState::Loaded));
    let feathers = app.world().resource::<Assets<Feather>>();
    assert_eq!(feathers.get(&feather).expect("loaded").length_mm, 80.0);
}

#[test]
fn bad_photograph_fails() {
    let folder = folder("photograph_bad");
    fs::write(folder.0.join("half.feather.png"), b"\x89PNG\r\n\x1a\nno").expect("written");
    let mut app = app(&folder);
    let server = app.world().resource::<AssetServer>().clone();
    let feather: Handle<Feather> = server.load("half.feather.png");
    let LoadState::Failed(error) = settle(&mut app, &feather) else {
        panic!("loaded");
    };
    assert!(error.to_string().contains("half.feather.png"), "{error}");
}
