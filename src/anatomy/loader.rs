//! [`Feather`] as a Bevy asset.

use super::{Feather, FeatherError};
use bevy::{
    app::{App, Plugin},
    asset::{
        AssetApp, AssetLoader, AssetPath, LoadContext,
        io::{Reader, Writer},
        saver::{AssetSaver, SavedAsset},
    },
    reflect::TypePath,
};
use std::{io::Write as _, path::Path};

/// Loads `*.feather.ron`. An image named by `albedo.image` is loaded too, its handle is in [`Feather::image`].
#[derive(Clone, Copy, Debug, Default, TypePath)]
pub struct FeatherLoader;

impl AssetLoader for FeatherLoader {
    type Asset = Feather;
    type Settings = ();
    type Error = FeatherError;

    async fn load(
        &self,
        reader: &mut dyn Reader,
        (): &(),
        context: &mut LoadContext<'_>,
    ) -> Result<Feather, FeatherError> {
        let path = context.path().to_string();
        let mut bytes = Vec::new();
        reader
            .read_to_end(&mut bytes)
            .await
            .map_err(|error| FeatherError::Io {
                file: path.clone(),
                message: error.to_string(),
            })?;
        let mut feather = Feather::from_ron(&bytes, &path)?;
        if let Some(image) = &feather.albedo.image {
            let target = context.path().resolve_embed_str(image).map_err(|error| {
                FeatherError::range(
                    "albedo.image",
                    format_args!("\"{image}\" ({error})"),
                    "an asset path",
                )
                .in_file(&path)
            })?;
            feather.image = Some(context.load(target));
        }
        Ok(feather)
    }

    fn extensions(&self) -> &[&str] {
        &["feather.ron"]
    }
}

/// Saves a [`Feather`] as `*.feather.ron`. The whole text is made and checked before the first byte is written.
#[derive(Clone, Copy, Debug, Default, TypePath)]
pub struct FeatherSaver;

impl AssetSaver for FeatherSaver {
    type Asset = Feather;
    type Settings = ();
    type OutputLoader = FeatherLoader;
    type Error = FeatherError;

    async fn save(
        &self,
        writer: &mut Writer,
        asset: SavedAsset<'_, '_, Feather>,
        (): &(),
        path: AssetPath<'_>,
    ) -> Result<(), FeatherError> {
        use bevy::tasks::futures_lite::AsyncWriteExt as _;
        let file = path.to_string();
        let text = asset.get().to_ron().map_err(|error| error.in_file(&file))?;
        let written = writer.write_all(text.as_bytes()).await;
        written.map_err(|error| FeatherError::Io {
            file,
            message: error.to_string(),
        })
    }
}

impl Feather {
    /// Writes the feather to a file. A reader never sees half of it: the text goes to a file beside it that then takes its
    /// place. On failure the old file stays.
    pub fn write(&self, path: &Path) -> Result<(), FeatherError> {
        let name = path.display().to_string();
        let text = self.to_ron().map_err(|error| error.in_file(&name))?;
        let mut beside = path.as_os_str().to_owned();
        beside.push(format!(".{}.tmp", std::process::id()));
        let attempt = || -> std::io::Result<()> {
            let mut file = std::fs::File::create(&beside)?;
            file.write_all(text.as_bytes())?;
            file.sync_all()?;
            std::fs::rename(&beside, path)
        };
        attempt().map_err(|error| {
            // Nothing to do about a leftover that cannot be removed either; the first error is the one to tell.
            let _ = std::fs::remove_file(&beside);
            FeatherError::Io {
                file: name,
                message: error.to_string(),
            }
        })
    }
}

/// Registers [`Feather`] with its loader. Needs Bevy's `AssetPlugin` before it.
#[derive(Clone, Copy, Debug, Default)]
pub struct AnatomyPlugin;

impl Plugin for AnatomyPlugin {
    fn build(&self, app: &mut App) {
        app.init_asset::<Feather>()
            .register_asset_reflect::<Feather>()
            .register_type::<Feather>()
            .init_asset_loader::<FeatherLoader>();
    }
}
