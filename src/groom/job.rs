//! A groom under way, on the entity that it is for.

use super::{coats::CoatKey, mask_textures::MaskTexture, skin_meshes::SkinTarget};
use crate::anatomy::Feather;
use bevy::{asset::Handle, ecs::prelude::*, image::Image};

/// The masks of a bird, with their textures.
pub(super) type Masks = Vec<(Handle<Image>, MaskTexture)>;

/// What a groom has found so far.
#[derive(Component, Default)]
pub(super) struct GroomJob {
    pub feathers: Option<Vec<Handle<Feather>>>,
    pub masks: Option<Masks>,
    /// The skin, and the coat that it waits for.
    pub waits: Option<(SkinTarget, CoatKey)>,
}
