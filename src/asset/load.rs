//! [`RonLoader`] and [`RonSaver`]: any [`RonAsset`] through Bevy's asset server.

use super::{AssetError, RonAsset};
use bevy::{
    asset::{
        AssetLoader, AssetPath, AsyncWriteExt, LoadContext,
        io::{Reader, Writer},
        saver::{AssetSaver, SavedAsset},
    },
    reflect::TypePath,
};
use std::marker::PhantomData;

/// Loads an asset from its `*.ron` file, and the assets that the file names.
#[derive(TypePath)]
#[type_path = "bevy_plumage::asset"]
pub struct RonLoader<A: RonAsset>(PhantomData<fn() -> A>);

impl<A: RonAsset> Default for RonLoader<A> {
    fn default() -> Self {
        Self(PhantomData)
    }
}

impl<A: RonAsset> AssetLoader for RonLoader<A> {
    type Asset = A;
    type Settings = ();
    type Error = AssetError;

    async fn load(
        &self,
        reader: &mut dyn Reader,
        (): &(),
        context: &mut LoadContext<'_>,
    ) -> Result<A, AssetError> {
        let file = context.path().to_string();
        let mut bytes = Vec::new();
        let read = reader.read_to_end(&mut bytes).await;
        read.map_err(|error| AssetError::Read {
            file: file.clone(),
            message: error.to_string(),
        })?;
        let mut asset = A::from_ron(&bytes, &file)?;
        asset
            .load_dependencies(context)
            .map_err(|error| error.in_file(&file))?;
        Ok(asset)
    }

    fn extensions(&self) -> &[&str] {
        const { &[A::EXTENSION] }
    }
}

/// Saves an asset as its `*.ron` file. The whole text is made and checked before the first byte is written.
#[derive(TypePath)]
#[type_path = "bevy_plumage::asset"]
pub struct RonSaver<A: RonAsset>(PhantomData<fn() -> A>);

impl<A: RonAsset> Default for RonSaver<A> {
    fn default() -> Self {
        Self(PhantomData)
    }
}

impl<A: RonAsset> AssetSaver for RonSaver<A> {
    type Asset = A;
    type Settings = ();
    type OutputLoader = RonLoader<A>;
    type Error = AssetError;

    async fn save(
        &self,
        writer: &mut Writer,
        asset: SavedAsset<'_, '_, A>,
        (): &(),
        path: AssetPath<'_>,
    ) -> Result<(), AssetError> {
        let file = path.to_string();
        let text = asset.get().to_ron().map_err(|error| error.in_file(&file))?;
        let written = writer.write_all(text.as_bytes()).await;
        written.map_err(|error| AssetError::Write {
            file,
            message: error.to_string(),
        })
    }
}
