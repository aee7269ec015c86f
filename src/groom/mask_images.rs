//! Textures of masks: they are waited for, and when one changes the feathers grow anew.

use super::{
    asset::Groom,
    coats::Coats,
    component::{Plumage, PlumageState},
    error::MaskFlaw,
    job::{GroomJob, Masks},
    mask_textures::{MaskTexture, PlumageMasks, SkinTexture},
};
use crate::modified::modified;
use bevy::{
    asset::{AssetEvent, AssetId, AssetServer, Assets, Handle, LoadState},
    ecs::{prelude::*, system::SystemParam},
    image::Image,
};
use std::sync::Arc;

/// On an entity with a plumage: the textures of its masks, kept so that changes of them are heard of.
#[derive(Component)]
pub(super) struct MaskImages(pub Vec<Handle<Image>>);

/// The textures that masks name.
#[derive(SystemParam)]
pub(super) struct MaskSource<'w, 's> {
    server: Res<'w, AssetServer>,
    images: Option<Res<'w, Assets<Image>>>,
    own: Query<'w, 's, &'static PlumageMasks>,
}

impl MaskSource<'_, '_> {
    /// The masks of the groom and of the entity itself; starts to load their textures.
    pub fn load(&self, owner: Entity, plumage: &Plumage, groom: Option<&Groom>) -> Masks {
        if self.images.is_none() {
            let masks = groom.map_or(&[][..], |groom| &groom.masks);
            return masks
                .iter()
                .map(|mask| (Handle::default(), mask.clone()))
                .collect();
        }
        let base = self.server.get_path(plumage.groom.id());
        let of_groom = groom.map_or(&[][..], |groom| &groom.masks);
        let own = self.own.get(owner).map_or(&[][..], |masks| &masks.0);
        let load = |mask: &MaskTexture, base| (mask.texture.load(&self.server, base), mask.clone());
        of_groom
            .iter()
            .map(|mask| load(mask, base.as_ref()))
            .chain(own.iter().map(|mask| load(mask, None)))
            .collect()
    }

    fn image(&self, handle: &Handle<Image>) -> Option<&Image> {
        self.images.as_ref()?.get(handle)
    }

    /// Whether every texture is there, or will never be.
    pub fn are_there(&self, masks: &Masks) -> bool {
        self.images.is_none()
            || masks.iter().all(|(handle, _)| {
                self.image(handle).is_some() || self.server.load_state(handle).is_failed()
            })
    }

    /// Copies for a worker thread, and what did not load.
    pub fn copies(&self, masks: &Masks) -> (Vec<SkinTexture>, Vec<MaskFlaw>) {
        let (mut found, mut missing) = (Vec::new(), Vec::new());
        for (handle, mask) in masks {
            let path = handle.path().map(ToString::to_string);
            let name = path.unwrap_or_else(|| mask.texture.path().to_owned());
            let name = if name.is_empty() {
                "(made in code)".to_owned()
            } else {
                name
            };
            match self.image(handle) {
                Some(image) => found.push(SkinTexture {
                    name,
                    image: Arc::new(image.clone()),
                    channel: mask.channel,
                    sets: mask.sets,
                }),
                None => missing.push(MaskFlaw::NotLoaded {
                    file: name,
                    cause: match self.server.load_state(handle) {
                        LoadState::Failed(cause) => cause.to_string(),
                        _ => "the app has no images".to_owned(),
                    },
                }),
            }
        }
        (found, missing)
    }
}

/// Grooms anew where a texture, or the masks of an entity, have changed.
pub(super) fn follow_masks(
    mut commands: Commands,
    mut events: MessageReader<AssetEvent<Image>>,
    mut coats: ResMut<Coats>,
    changed: Query<Entity, (Changed<PlumageMasks>, With<Plumage>)>,
    mut removed: RemovedComponents<PlumageMasks>,
    mut birds: Query<(Entity, Option<&MaskImages>, &mut PlumageState), With<Plumage>>,
) {
    let images = modified(&mut events);
    let is_modified = |id: &AssetId<Image>| images.contains(id);
    if !images.is_empty() {
        coats.forget(|key| key.textures.iter().any(is_modified));
    }
    let removed: Vec<Entity> = removed.read().collect();
    if images.is_empty() && removed.is_empty() && changed.is_empty() {
        return;
    }
    for (entity, used, mut state) in &mut birds {
        let touched = used.is_some_and(|used| used.0.iter().any(|used| is_modified(&used.id())));
        if touched || changed.contains(entity) || removed.contains(&entity) {
            state.regroom();
            commands.entity(entity).insert(GroomJob::default());
        }
    }
}
