//! A photograph as an asset.
//!
//! A picture whose name ends in `.feather.png`, `.feather.jpg`, `.feather.jpeg` or `.feather.webp` is a photograph of a feather:
//! `server.load::<Feather>("blue_tit.feather.jpg")` and `server.load::<Feather>("blue_tit.feather.jpg#feather")` extract it.
//! Bevy picks a loader by the whole of a name's extension first, so that plain `.png` files stay images, and
//! `server.load::<Image>("blue_tit.feather.png")` still is the photograph. A picture of any name becomes a feather with a
//! `.meta` file beside it that names the loader `bevy_plumage::photo::PhotographLoader`; its settings are
//! [`ExtractSettings`].

use super::{ExtractError, ExtractSettings, decode_photograph, extract};
use crate::anatomy::Feather;
use bevy::{
    app::{App, Plugin},
    asset::{AssetApp, AssetLoader, LoadContext, RenderAssetUsages, io::Reader},
    image::Image,
    reflect::TypePath,
};
use image::DynamicImage;

/// Extracts a [`Feather`] from a photograph. Labels: `feather` (the asset once more), `albedo` and `overlay` (images).
#[derive(Clone, Copy, Debug, Default, TypePath)]
#[type_path = "bevy_plumage::photo"]
pub struct PhotographLoader;

/// Name for messages and assets: the file's, up to its first dot.
fn stem(path: &str) -> &str {
    let file = path.rsplit(['/', '\\']).next().unwrap_or(path);
    file.split('.').next().unwrap_or(file)
}

impl AssetLoader for PhotographLoader {
    type Asset = Feather;
    type Settings = ExtractSettings;
    type Error = ExtractError;

    async fn load(
        &self,
        reader: &mut dyn Reader,
        settings: &ExtractSettings,
        context: &mut LoadContext<'_>,
    ) -> Result<Feather, ExtractError> {
        let path = context.path().to_string();
        let mut bytes = Vec::new();
        reader
            .read_to_end(&mut bytes)
            .await
            .map_err(|error| ExtractError::Io {
                file: path.clone(),
                message: error.to_string(),
            })?;
        let photograph = decode_photograph(&bytes, &path)?;
        let mut settings = settings.clone();
        if settings.name == ExtractSettings::default().name && !stem(&path).is_empty() {
            settings.name = stem(&path).to_owned();
        }
        let found = extract(&photograph, &settings, &mut |_| ())?;
        let overlay = DynamicImage::ImageRgb8(found.overlay(&photograph));
        let albedo = DynamicImage::ImageRgba8(found.albedo);
        let image = |picture| Image::from_dynamic(picture, true, RenderAssetUsages::default());
        let mut feather = found.feather;
        feather.image = Some(context.add_labeled_asset("albedo".to_owned(), image(albedo)));
        context.add_labeled_asset("overlay".to_owned(), image(overlay));
        context.add_labeled_asset("feather".to_owned(), feather.clone());
        Ok(feather)
    }

    fn extensions(&self) -> &[&str] {
        &["feather.png", "feather.jpg", "feather.jpeg", "feather.webp"]
    }
}

/// Registers [`PhotographLoader`]. Needs [`AnatomyPlugin`](crate::anatomy::AnatomyPlugin) and Bevy's `ImagePlugin` before it.
#[derive(Clone, Copy, Debug, Default)]
pub struct ExtractPlugin;

impl Plugin for ExtractPlugin {
    fn build(&self, app: &mut App) {
        app.init_asset_loader::<PhotographLoader>();
    }
}
