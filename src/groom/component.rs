//! What an app puts on entities and reads back: [`Plumage`], its state and events, and the cards made for it.

use super::{
    asset::Groom,
    build::DownTract,
    card::{Card, CardGeometry},
    skin::{SkinMesh, SurfacePoint},
};
use crate::{anatomy::Feather, parameter::Parameter};
use bevy::{
    asset::Handle,
    ecs::prelude::*,
    reflect::{Reflect, std_traits::ReflectDefault},
};
use std::{ops::Deref, sync::Arc};

/// Grows feathers on a mesh. Put it on the entity of the bird's mesh, or on any entity above it (the root of a glTF scene): the
/// meshes are looked for on the entity and below it, whenever they come. [`PlumageReady`] or [`PlumageFailed`] is triggered on
/// the entity; [`PlumageState`] says the same to those who ask.
///
/// Which meshes are the skin: all skinned meshes with a second set of texture coordinates (`TEXCOORD_1`: tract number and phi);
/// if there are none, the skinned mesh with most vertices; if none is skinned, the mesh with most vertices. Meshes marked
/// [`NotSkin`] are left out.
#[derive(Component, Clone, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(PlumageState)]
pub struct Plumage {
    /// Where feathers grow; with the default handle, by what the mesh itself offers ([`Groom::fallback`]).
    pub groom: Handle<Groom>,
    /// Seed of everything random: the same seed gives the same bird.
    pub seed: u64,
    /// Number of scattered feathers relative to the groom's own, 0.01..16; their size follows, so that cover stays.
    #[reflect(@Parameter::new("", 0.01, 16.0).logarithmic())]
    pub density: f32,
}

impl Default for Plumage {
    fn default() -> Self {
        Self {
            groom: Handle::default(),
            seed: 0,
            density: 1.0,
        }
    }
}

impl Plumage {
    /// Plumage after a groom, seed 0, density 1.
    pub fn new(groom: Handle<Groom>) -> Self {
        Self {
            groom,
            ..Self::default()
        }
    }

    /// With this seed.
    pub fn with_seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// With this density, 0.01..16.
    pub fn with_density(mut self, density: f32) -> Self {
        self.density = density;
        self
    }
}

/// Grooming status.
#[derive(Component, Clone, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
#[non_exhaustive]
pub struct PlumageState {
    /// Whether the cards there are belong to the plumage as it now is.
    pub(super) ready: bool,
    /// Number of cards.
    pub cards: u32,
    /// Number of triangles of the cards.
    pub triangles: u32,
    /// Time the groom took on its worker thread, milliseconds.
    pub groom_ms: f32,
    /// Pairs of feathers that still cross, see [`super::Crossings`].
    pub crossings: u32,
    /// Why the last groom failed, if it did. The cards there were before stay.
    pub error: Option<String>,
    /// What was odd but did not keep feathers from growing: attributes that nothing reads, values out of range and what was done about
    /// them, joints that the skin lacks, textures that did not load.
    pub warnings: Vec<String>,
}

impl PlumageState {
    /// Whether the cards there are belong to the plumage as it now is.
    pub fn is_ready(&self) -> bool {
        self.ready
    }

    /// The cards there are no longer belong to it.
    pub(super) fn regroom(&mut self) {
        self.ready = false;
        self.error = None;
    }
}

/// The feathers of a [`Plumage`] have grown: its card mesh is spawned, see [`PlumageParts`]. Triggered on the entity with the
/// plumage, again whenever the plumage, the groom or the meshes have changed.
#[derive(EntityEvent, Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[reflect(Clone, Debug, PartialEq)]
pub struct PlumageReady {
    /// The entity with the [`Plumage`].
    pub entity: Entity,
}

/// No feathers could be grown. Triggered on the entity with the [`Plumage`]; what was there before stays.
#[derive(EntityEvent, Clone, Debug, PartialEq, Eq, Reflect)]
#[reflect(Clone, Debug, PartialEq)]
pub struct PlumageFailed {
    /// The entity with the [`Plumage`].
    pub entity: Entity,
    /// What is wrong: file, field, value and range.
    pub error: String,
}

/// On a card mesh: the entity with the [`Plumage`] that it was made for. Cards of the app's own need none, then they look for
/// quality and ruffle on their own entity.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[reflect(Component, Clone, Debug, PartialEq)]
#[relationship(relationship_target = PlumageParts)]
pub struct FeathersOf(pub Entity);

impl FeathersOf {
    /// The entity that has quality and ruffle of the cards on `entity`.
    pub(crate) fn owner(of: Option<&Self>, entity: Entity) -> Entity {
        of.map_or(entity, |of| of.0)
    }
}

/// On the entity with the [`Plumage`]: the card meshes made for it, children of its skin. They go with it.
#[derive(Component, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq)]
#[relationship_target(relationship = FeathersOf, linked_spawn)]
pub struct PlumageParts(Vec<Entity>);

impl Deref for PlumageParts {
    type Target = [Entity];

    fn deref(&self) -> &[Entity] {
        &self.0
    }
}

/// What feathers of one region or row of a groom have in common.
#[derive(Clone, Debug, PartialEq)]
pub struct CardRegion {
    /// Name in the groom.
    pub name: String,
    /// Stiffness against wind and ruffle, 0..1; rows of flight feathers have 1.
    pub stiffness: f32,
}

impl CardRegion {
    /// The stiffness, whatever an app has put there.
    pub(crate) fn stiffness(&self) -> f32 {
        if self.stiffness.is_finite() {
            self.stiffness.clamp(0.0, 1.0)
        } else {
            1.0
        }
    }

    /// Those of a groom, in the order that [`Card::region`] counts: regions, then rows.
    pub(super) fn of(groom: &Groom) -> Vec<Self> {
        let regions = groom.regions.iter().map(|region| Self {
            name: region.name.clone(),
            stiffness: region.stiffness,
        });
        let rows = groom.rows.iter().map(|row| Self {
            name: row.name.clone(),
            stiffness: 1.0,
        });
        regions.chain(rows).collect()
    }
}

/// On the card mesh of a bird: what the renderer needs beside the mesh.
#[derive(Component, Clone, Debug)]
#[non_exhaustive]
pub struct PlumageCards {
    /// One record per card; `UV_1.x` of the mesh, rounded, is the index ([`fit_cards`](super::fit_cards) marks edges in its fraction).
    pub cards: Arc<[Card]>,
    /// Where each card's vertices are.
    pub geometry: Arc<[CardGeometry]>,
    /// The groom they were made by.
    pub groom: Handle<Groom>,
    /// The feathers worn, in the groom's order.
    pub feathers: Vec<Handle<Feather>>,
    /// The same feathers in the bird's weather, once or several times over; [`Card::feather`] counts on into them.
    pub weathered: Vec<Handle<Feather>>,
    /// Regions and rows, in the order that [`Card::region`] counts. Without any, all cards are of one region of medium stiffness.
    pub regions: Arc<[CardRegion]>,
}

impl PlumageCards {
    /// Cards of the app's own, without a groom.
    pub fn new(
        cards: impl Into<Arc<[Card]>>,
        geometry: impl Into<Arc<[CardGeometry]>>,
        feathers: Vec<Handle<Feather>>,
    ) -> Self {
        Self {
            cards: cards.into(),
            geometry: geometry.into(),
            groom: Handle::default(),
            feathers,
            weathered: Vec::new(),
            regions: Arc::new([]),
        }
    }

    /// All feathers, as [`Card::feather`] counts them.
    pub(crate) fn all_feathers(&self) -> impl Iterator<Item = &Handle<Feather>> {
        self.feathers.iter().chain(&self.weathered)
    }

    /// The feather that a card wears, as it is without weather.
    pub fn feather_of(&self, card: &Card) -> Option<&Handle<Feather>> {
        let place = usize::from(card.feather).checked_rem(self.feathers.len())?;
        self.feathers.get(place)
    }
}

/// On the card mesh of a bird whose groom has down: what the down grows on.
#[derive(Component, Clone, Debug)]
pub struct DownTracts {
    /// The skin, its joints those of the card mesh.
    pub skin: Arc<SkinMesh>,
    /// Tracts with down.
    pub tracts: Arc<[DownTract]>,
}

/// On the card mesh of a bird: where its cards are rooted.
#[derive(Component, Clone, Debug)]
pub struct CardRoots {
    /// The skin.
    pub skin: Arc<SkinMesh>,
    /// Root of each card on it.
    pub roots: Arc<[SurfacePoint]>,
}

/// On the card mesh of a bird whose groom takes colors from the skin: whose.
#[derive(Component, Clone, Debug)]
pub struct SkinColors {
    /// The meshes that the skin was taken from, in its order.
    pub meshes: Vec<Entity>,
    /// The cards in the groom's own colors.
    pub cards: Arc<[Card]>,
    /// Share of the skin's color, for each region, then for each row.
    pub shares: Arc<[f32]>,
}

/// A mesh on which nothing grows, on or below an entity with a [`Plumage`] or an undercoat: harness, jesses, a rider.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Component, Default, Clone, Debug, PartialEq)]
pub struct NotSkin;

/// When the plugin's systems run; order an app's own by them.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum PlumageSystems {
    /// `Update`: plumages are groomed and their cards spawned; [`PlumageReady`] and [`PlumageFailed`] are triggered. Changes made
    /// before are seen in this frame.
    Groom,
    /// `Update`, after [`Self::Groom`]: cards take the colors of their skin.
    TakeSkinColors,
    /// `Update`, after [`Self::TakeSkinColors`]: cards wear the feathers of the weather.
    TakeWeather,
    /// `PostUpdate`: card meshes get their materials; changed feathers, quality, wind and ruffle are taken over.
    PrepareMaterials,
    /// `PostUpdate`, after [`Self::PrepareMaterials`]: meshes that draw the cards once more are spawned and follow the first.
    PrepareExtraDraws,
    /// `PostUpdate`, before visibility is checked: card meshes get their bounds in bind pose.
    UpdateBounds,
    /// `PostUpdate`, after transforms are propagated: joints of flight feathers follow those of the skin; the coat takes on the pose
    /// that is worn, wind and ruffle.
    MoveFeathers,
}
