//! Asset loader of `*.down.ron`.

use super::{Down, DownError};
use bevy::{
    asset::{AssetLoader, LoadContext, io::Reader},
    reflect::TypePath,
};

/// Loads a [`Down`] from a `*.down.ron` file.
#[derive(Clone, Copy, Debug, Default, TypePath)]
pub struct DownLoader;

impl AssetLoader for DownLoader {
    type Asset = Down;
    type Settings = ();
    type Error = DownError;

    async fn load(
        &self,
        reader: &mut dyn Reader,
        (): &(),
        context: &mut LoadContext<'_>,
    ) -> Result<Down, DownError> {
        let file = context.path().to_string();
        let mut bytes = Vec::new();
        let read = reader.read_to_end(&mut bytes).await;
        read.map_err(|error| DownError::Io {
            file: file.clone(),
            message: error.to_string(),
        })?;
        Down::from_ron(&bytes, &file)
    }

    fn extensions(&self) -> &[&str] {
        &["down.ron"]
    }
}
