//! Coats being groomed, and coats that equal birds share: the same groom on the same meshes with the same seed and density is
//! groomed once and held once.

use super::{
    asset::Groom,
    authored::{Authored, SkinMasks},
    bird::Bird,
    build::{Coat, DownTract, groom_bird},
    card::{Card, CardGeometry},
    component::CardRegion,
    error::{GroomError, MaskFlaw},
    fit::fit_cards,
    layer::Crossings,
    mask_textures::SkinTexture,
    rows::FanJoint,
    skin::{SkinMesh, SurfacePoint},
    worn::WornPoses,
};
use crate::anatomy::Feather;
use bevy::{
    asset::{AssetId, Assets, Handle},
    ecs::prelude::*,
    image::Image,
    log::{info, warn},
    math::Vec3,
    mesh::Mesh,
    platform::{collections::HashMap, time::Instant},
    tasks::{AsyncComputeTaskPool, Task, TaskPool, block_on, poll_once},
};
use std::sync::Arc;

/// All that a coat depends on.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct CoatKey {
    pub groom: AssetId<Groom>,
    pub seed: u64,
    /// Bits of the density.
    pub density: u32,
    pub meshes: Vec<AssetId<Mesh>>,
    /// For each mesh: the skeleton's index of each of its joints.
    pub maps: Vec<Vec<u16>>,
    /// Names of the joints.
    pub joints: Vec<String>,
    /// Textures of masks.
    pub textures: Vec<AssetId<Image>>,
    /// Hash of masks, guides and rows of the file.
    pub authored: u64,
}

/// What a coat is made of besides its groom.
pub(super) struct CoatInput {
    /// Meshes of the skin.
    pub meshes: Vec<Mesh>,
    /// Their masks, in order.
    pub masks: Vec<SkinMasks>,
    /// Masks in textures, and what is wrong with those that are not there.
    pub textures: (Vec<SkinTexture>, Vec<MaskFlaw>),
    /// Guides and rows of the file.
    pub authored: Authored,
    /// Where each joint is in bind pose, model space.
    pub pivots: Vec<Vec3>,
    /// The feathers of the groom.
    pub feathers: Vec<Feather>,
}

/// A coat as equal birds share it.
#[derive(Clone)]
pub(super) struct SharedCoat {
    pub cards: Arc<[Card]>,
    pub geometry: Arc<[CardGeometry]>,
    pub regions: Arc<[CardRegion]>,
    pub fans: Arc<[FanJoint]>,
    /// None without cards: a mesh without vertices has no place on the GPU.
    pub mesh: Option<Handle<Mesh>>,
    pub skinned: bool,
    pub triangles: u32,
    pub skin: Arc<SkinMesh>,
    pub down: Arc<[DownTract]>,
    /// Where each card is rooted.
    pub roots: Arc<[SurfacePoint]>,
    /// Of the skin's color, for each region and row.
    pub shares: Arc<[f32]>,
    pub worn: Arc<WornPoses>,
    pub crossings: Crossings,
    pub milliseconds: f32,
    /// What was odd but not fatal.
    pub warnings: Arc<[String]>,
}

impl SharedCoat {
    fn new(groomed: Groomed, milliseconds: f32, meshes: &mut Assets<Mesh>) -> Self {
        let Groomed {
            coat,
            skin,
            regions,
            shares,
        } = groomed;
        coat.warnings.iter().for_each(|warning| warn!("{warning}"));
        info!(
            "plumage: {} cards in {milliseconds:.0} ms, {:?}",
            coat.cards.len(),
            coat.crossings
        );
        let triangles = coat.mesh.indices().map_or(0, |indices| indices.len() / 3);
        Self {
            skinned: coat.mesh.contains_attribute(Mesh::ATTRIBUTE_JOINT_INDEX),
            triangles: triangles as u32,
            mesh: (!coat.cards.is_empty()).then(|| meshes.add(coat.mesh)),
            cards: coat.cards.into(),
            geometry: coat.geometry.into(),
            regions: regions.into(),
            fans: coat.fans.into(),
            skin: Arc::new(skin),
            down: coat.down.into(),
            roots: coat.roots.into(),
            shares: shares.into(),
            worn: Arc::new(coat.worn),
            crossings: coat.crossings,
            milliseconds,
            warnings: coat.warnings.into(),
        }
    }
}

/// What a worker thread brings back.
struct Groomed {
    coat: Coat,
    skin: SkinMesh,
    regions: Vec<CardRegion>,
    shares: Vec<f32>,
}

enum Entry {
    Busy(Task<(Result<Groomed, GroomError>, f32)>),
    Done(Result<SharedCoat, String>),
}

/// Coats by what they depend on.
#[derive(Resource, Default)]
pub(super) struct Coats(HashMap<CoatKey, Entry>);

impl Coats {
    /// Begins to groom on a worker thread, unless that is done or under way. `meshes`: those of the key.
    pub(super) fn begin(
        &mut self,
        key: &CoatKey,
        groom: Option<&Groom>,
        input: impl FnOnce() -> CoatInput,
    ) {
        if self.0.contains_key(key) {
            return;
        }
        let (input, groom, of) = (input(), groom.cloned(), key.clone());
        let pool = AsyncComputeTaskPool::get_or_init(TaskPool::new);
        let task = pool.spawn(async move {
            let begun = Instant::now();
            let meshes: Vec<&Mesh> = input.meshes.iter().collect();
            let groomed = SkinMesh::from_meshes(&meshes, &of.maps).and_then(|skin| {
                let (textures, missing) = input.textures;
                let mut skin = skin.with_masks(&input.masks).with_textures(textures);
                skin.mask_flaws.extend(missing);
                let bird = Bird {
                    skin,
                    joints: of.joints,
                    pivots: input.pivots,
                };
                let mut groom = groom.unwrap_or_else(|| Groom::fallback(&bird.skin, &bird.joints));
                let mut notes = Vec::new();
                input.authored.dress(&mut groom, &mut notes);
                let mut coat = groom_bird(&bird, &groom, of.seed, f32::from_bits(of.density))?;
                coat.warnings.extend(notes);
                let feathers: Vec<_> = input.feathers.iter().map(Some).collect();
                fit_cards(&mut coat.mesh, &coat.cards, &coat.geometry, &feathers);
                Ok(Groomed {
                    coat,
                    skin: bird.skin,
                    regions: CardRegion::of(&groom),
                    shares: groom.shares().collect(),
                })
            });
            (groomed, begun.elapsed().as_secs_f32() * 1.0e3)
        });
        self.0.insert(key.clone(), Entry::Busy(task));
    }

    /// Takes over what the workers have finished.
    pub(super) fn poll(&mut self, meshes: &mut Assets<Mesh>) {
        for entry in self.0.values_mut() {
            if let Entry::Busy(task) = entry
                && let Some((groomed, milliseconds)) = block_on(poll_once(task))
            {
                *entry = Entry::Done(match groomed {
                    Ok(groomed) => Ok(SharedCoat::new(groomed, milliseconds, meshes)),
                    Err(error) => Err(error.to_string()),
                });
            }
        }
    }

    /// The coat, or what is wrong; `None` while it is being groomed.
    pub(super) fn get(&self, key: &CoatKey) -> Option<&Result<SharedCoat, String>> {
        match self.0.get(key)? {
            Entry::Busy(_) => None,
            Entry::Done(result) => Some(result),
        }
    }

    /// Whether it is known or under way.
    pub(super) fn knows(&self, key: &CoatKey) -> bool {
        self.0.contains_key(key)
    }

    /// Whether there is anything to poll or to forget.
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Forgets coats that were made of what has changed since.
    pub(super) fn forget(&mut self, changed: impl Fn(&CoatKey) -> bool) {
        self.0.retain(|key, _| !changed(key));
    }

    /// Cancels what nobody waits for, and lets go of coats that nobody has.
    pub(super) fn drop_unused(&mut self, waits: impl Fn(&CoatKey) -> bool) {
        self.0.retain(|key, entry| {
            waits(key)
                || matches!(entry, Entry::Done(Ok(coat)) if Arc::strong_count(&coat.cards) > 1)
        });
    }
}
