//! Asset loader and saver of `*.groom.ron`.

use super::{asset::Groom, error::GroomError};
use bevy::{
    asset::{
        AssetLoader, AssetPath, AsyncWriteExt, LoadContext, io::Reader, io::Writer,
        saver::AssetSaver, saver::SavedAsset,
    },
    reflect::TypePath,
};

/// Loads a [`Groom`] from a `*.groom.ron` file.
#[derive(Clone, Copy, Debug, Default, TypePath)]
pub struct GroomLoader;

impl AssetLoader for GroomLoader {
    type Asset = Groom;
    type Settings = ();
    type Error = GroomError;

    async fn load(
        &self,
        reader: &mut dyn Reader,
        _: &(),
        context: &mut LoadContext<'_>,
    ) -> Result<Groom, GroomError> {
        let file = context.path().to_string();
        let mut bytes = Vec::new();
        let read = reader.read_to_end(&mut bytes).await;
        read.map_err(|error| GroomError::Read {
            file: file.clone(),
            message: error.to_string(),
        })?;
        let text = std::str::from_utf8(&bytes).map_err(|error| GroomError::Read {
            file: file.clone(),
            message: error.to_string(),
        })?;
        Groom::from_ron(text, &file)
    }

    fn extensions(&self) -> &[&str] {
        &["groom.ron"]
    }
}

/// Saves a [`Groom`] as a `*.groom.ron` file.
#[derive(Clone, Copy, Debug, Default, TypePath)]
pub struct GroomSaver;

impl AssetSaver for GroomSaver {
    type Asset = Groom;
    type Settings = ();
    type OutputLoader = GroomLoader;
    type Error = GroomError;

    async fn save(
        &self,
        writer: &mut Writer,
        asset: SavedAsset<'_, '_, Groom>,
        _: &(),
        path: AssetPath<'_>,
    ) -> Result<(), GroomError> {
        let file = path.to_string();
        asset.get().validate(&file)?;
        let text = asset.get().to_ron(&file)?;
        let written = writer.write_all(text.as_bytes()).await;
        written.map_err(|error| GroomError::Write {
            file,
            message: error.to_string(),
        })
    }
}
