//! [`AssetLink`]: an asset that a file names.

use super::AssetError;
use bevy::{
    asset::{
        Asset, AssetPath, AssetServer, Handle, LoadContext, UntypedAssetId, VisitAssetDependencies,
    },
    reflect::Reflect,
};
use serde::{Deserialize, Deserializer, Serialize, Serializer, ser::Error as _};
use std::fmt::{Debug, Formatter};

/// An asset that a file names by its path, relative to that file. The loader of the file loads it too and keeps its handle
/// here, so that it is a dependency. In code: `"feathers/x.feather.ron".into()`, or `handle.into()` for an asset that is there.
#[derive(Reflect)]
pub struct AssetLink<A: Asset> {
    path: String,
    handle: Option<Handle<A>>,
}

// By hand: what is named need not be `Clone` or `Debug` itself.
impl<A: Asset> Clone for AssetLink<A> {
    fn clone(&self) -> Self {
        Self {
            path: self.path.clone(),
            handle: self.handle.clone(),
        }
    }
}

impl<A: Asset> Debug for AssetLink<A> {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("AssetLink")
            .field("path", &self.path)
            .field("handle", &self.handle)
            .finish()
    }
}

impl<A: Asset> AssetLink<A> {
    /// The path as the file has it; empty for a handle given in code.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// The asset, once the file that names it was loaded.
    pub fn handle(&self) -> Option<&Handle<A>> {
        self.handle.as_ref()
    }

    /// Whether nothing is named.
    pub fn is_empty(&self) -> bool {
        self.path.is_empty() && self.handle.is_none()
    }

    /// The asset; loaded by its path, relative to `base` or to the root of the assets, unless it is there already.
    pub(crate) fn load(&self, server: &AssetServer, base: Option<&AssetPath>) -> Handle<A> {
        if let Some(handle) = &self.handle {
            return handle.clone();
        }
        let full = base.and_then(|base| base.resolve_embed_str(&self.path).ok());
        match full {
            Some(full) => server.load(full),
            None => server.load(self.path.clone()),
        }
    }

    /// Starts to load the asset as a dependency of the file that is being read.
    pub(crate) fn load_dependency(
        &mut self,
        field: impl Fn() -> String,
        context: &mut LoadContext<'_>,
    ) -> Result<(), AssetError> {
        let path = &self.path;
        let full = context.path().resolve_embed_str(path).map_err(|error| {
            AssetError::value(field(), format_args!("{path:?} ({error})"), "an asset path")
        })?;
        self.handle = Some(context.load(full));
        Ok(())
    }
}

impl<A: Asset> VisitAssetDependencies for AssetLink<A> {
    fn visit_dependencies(&self, visit: &mut impl FnMut(UntypedAssetId)) {
        self.handle.visit_dependencies(visit);
    }
}

/// Equal if a file that names both would name the same, whether or not they are loaded yet.
impl<A: Asset> PartialEq for AssetLink<A> {
    fn eq(&self, other: &Self) -> bool {
        self.path == other.path && (!self.path.is_empty() || self.handle == other.handle)
    }
}

impl<A: Asset> From<&str> for AssetLink<A> {
    fn from(path: &str) -> Self {
        Self::from(path.to_owned())
    }
}

impl<A: Asset> From<String> for AssetLink<A> {
    fn from(path: String) -> Self {
        Self { path, handle: None }
    }
}

impl<A: Asset> From<Handle<A>> for AssetLink<A> {
    fn from(handle: Handle<A>) -> Self {
        Self {
            path: String::new(),
            handle: Some(handle),
        }
    }
}

impl<A: Asset> Serialize for AssetLink<A> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if !self.path.is_empty() {
            return serializer.serialize_str(&self.path);
        }
        let Some(path) = self.handle.as_ref().and_then(Handle::path) else {
            return Err(S::Error::custom(
                "an asset made in code has no path to write",
            ));
        };
        // A path from the root of the assets, where it would be taken as relative to the file.
        let root = match path.source() {
            bevy::asset::io::AssetSourceId::Default => "/",
            bevy::asset::io::AssetSourceId::Name(_) => "",
        };
        serializer.collect_str(&format_args!("{root}{path}"))
    }
}

impl<'de, A: Asset> Deserialize<'de> for AssetLink<A> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer).map(Self::from)
    }
}
