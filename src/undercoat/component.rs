//! What an app puts on entities: [`Undercoat`], [`GuardStrands`], and what it reads back.

use super::Down;
use crate::parameter::Parameter;
use bevy::{
    asset::Handle,
    ecs::prelude::*,
    reflect::{Reflect, std_traits::ReflectDefault},
};
use serde::{Deserialize, Serialize};
use std::ops::Deref;

/// How a coat is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect, Serialize, Deserialize)]
#[non_exhaustive]
pub enum UndercoatMode {
    /// A ray through each pixel is marched through the prisms over the skin (hybrid fur rendering).
    #[default]
    Volume,
    /// Shells with precomputed radiance transfer.
    Shells,
}

/// Which of the renderers of a volume serves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect, Serialize, Deserialize)]
#[non_exhaustive]
pub enum UndercoatTier {
    /// By the thickness on the screen, see [`UndercoatSettings::tier_px`].
    #[default]
    Auto,
    /// All steps to the eye, a march to the key light from each.
    Near,
    /// Light by the mean column.
    Mid,
    /// The same with a rim that thins out.
    Far,
    /// Not drawn.
    None,
}

/// Grows a coat on the mesh of this entity, or on every mesh below it (the root of a glTF scene), whenever they come: stand-alone
/// fur. Birds get theirs from the regions of their groom.
#[derive(Component, Clone, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(UndercoatState)]
pub struct Undercoat {
    /// Which coat.
    pub down: Handle<Down>,
    /// How it is drawn.
    pub mode: UndercoatMode,
    /// Which renderer of a volume serves.
    pub tier: UndercoatTier,
    /// Whether the volume is drawn; strands ([`GuardStrands`]) are drawn regardless.
    pub visible: bool,
    /// Factor on the thickness, 0..10: metres of the app's world per metre of the animal.
    #[reflect(@Parameter::new("", 0.0, 10.0))]
    pub scale: f32,
    /// How often each triangle of the skin is split into four and rounded below the coat, 0..3: for meshes of few triangles.
    pub rounds: u32,
    /// Seed: shifts the tile over the skin.
    pub seed: u64,
}

impl Default for Undercoat {
    fn default() -> Self {
        Self {
            down: Handle::default(),
            mode: UndercoatMode::Volume,
            tier: UndercoatTier::Auto,
            visible: true,
            scale: 1.0,
            rounds: 0,
            seed: 0,
        }
    }
}

impl Undercoat {
    /// A coat of this down.
    pub fn new(down: Handle<Down>) -> Self {
        Self {
            down,
            ..Self::default()
        }
    }

    /// Drawn in this way.
    pub fn with_mode(mut self, mode: UndercoatMode) -> Self {
        self.mode = mode;
        self
    }
}

/// Single hairs through and over the coat of the [`Undercoat`] beside it: guard hairs, bristles, filoplumes.
#[derive(Component, Clone, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
pub struct GuardStrands {
    /// Strands per square centimetre, 0..1000.
    #[reflect(@Parameter::new("/cm\u{b2}", 0.0, 1000.0))]
    pub density: f32,
    /// Most strands on one mesh, 0..200000; beyond it they are thinned.
    pub limit: u32,
    /// Mean length, millimetres, 0.1..300.
    #[reflect(@Parameter::new("mm", 0.1, 300.0).logarithmic())]
    pub length_mm: f32,
    /// Relative spread of the length, 0..1.
    #[reflect(@Parameter::share())]
    pub length_spread: f32,
    /// Radius at the root, micrometres, 1..2000.
    #[reflect(@Parameter::new("\u{b5}m", 1.0, 2000.0).logarithmic())]
    pub radius_um: f32,
    /// Lean into the lay at the tip, 0 (upright) to 1 (flat).
    #[reflect(@Parameter::share())]
    pub bend: f32,
    /// Droop by gravity, radians at the tip, 0..1.5.
    #[reflect(@Parameter::new("rad", 0.0, 1.5))]
    pub gravity: f32,
    /// Fading towards the tip: alpha `exp(-fade s)`, 0..8.
    #[reflect(@Parameter::new("", 0.0, 8.0))]
    pub fade: f32,
    /// Albedo at the root, sRGB.
    pub color: [f32; 3],
    /// Albedo at the tip, sRGB.
    pub tip_color: [f32; 3],
    /// Seed of places and lengths.
    pub seed: u64,
}

impl Default for GuardStrands {
    fn default() -> Self {
        Self {
            density: 40.0,
            limit: 40_000,
            length_mm: 9.0,
            length_spread: 0.25,
            radius_um: 40.0,
            bend: 0.6,
            gravity: 0.2,
            fade: 1.2,
            color: [0.30, 0.22, 0.16],
            tip_color: [0.55, 0.42, 0.30],
            seed: 1,
        }
    }
}

/// Status and cost of an undercoat.
#[derive(Component, Clone, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
#[non_exhaustive]
pub struct UndercoatState {
    /// Whether the shells there are belong to the coat as it now is.
    pub(super) ready: bool,
    /// Prisms over the skin.
    pub prisms: u32,
    /// Sides of prisms that border on no other: rims and edges where the mesh is no surface.
    pub walls: u32,
    /// Vertices whose height was limited because the shell would fold.
    pub limited: u32,
    /// Single strands.
    pub strands: u32,
    /// Bytes on the GPU, the tile included.
    pub bytes: u64,
    /// Shells drawn this frame, of those there are.
    pub drawn: u32,
    /// Why there is no coat, if that is so.
    pub error: Option<String>,
}

impl UndercoatState {
    /// Whether the shells there are belong to the coat as it now is.
    pub fn is_ready(&self) -> bool {
        self.ready
    }
}

/// A coat has grown: its shells are spawned, see [`UndercoatParts`]. Triggered on the entity with the [`Undercoat`], again
/// whenever the coat, its [`Down`] or its [`GuardStrands`] have changed; on a bird whenever all its down that shows has grown.
#[derive(EntityEvent, Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[reflect(Clone, Debug, PartialEq)]
pub struct UndercoatReady {
    /// The entity with the [`Undercoat`], or the bird.
    pub entity: Entity,
}

/// A coat, or a part of it, could not be grown. Triggered on the entity with the [`Undercoat`], or on the bird.
#[derive(EntityEvent, Clone, Debug, PartialEq, Eq, Reflect)]
#[reflect(Clone, Debug, PartialEq)]
pub struct UndercoatFailed {
    /// The entity with the [`Undercoat`], or the bird.
    pub entity: Entity,
    /// What is wrong.
    pub error: String,
}

/// On a shell: the entity that it was grown for, with the [`Undercoat`]; of a bird's down its card mesh.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[reflect(Component, Clone, Debug, PartialEq)]
#[relationship(relationship_target = UndercoatParts)]
pub struct UndercoatOf(pub Entity);

/// On the entity with the [`Undercoat`]: the shells grown for it, children of the skins. They go with it.
#[derive(Component, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Component, Default, Debug, PartialEq)]
#[relationship_target(relationship = UndercoatOf, linked_spawn)]
pub struct UndercoatParts(Vec<Entity>);

impl Deref for UndercoatParts {
    type Target = [Entity];

    fn deref(&self) -> &[Entity] {
        &self.0
    }
}

/// When the systems of undercoats run, in `PostUpdate` after transforms are propagated: coats are grown and spawned, settings
/// taken over.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct UndercoatSystems;

/// What is shown instead of the shaded coat.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect, Serialize, Deserialize)]
#[non_exhaustive]
pub enum UndercoatView {
    /// Shaded.
    #[default]
    None,
    /// A color per prism.
    Prism,
    /// Cells crossed by the ray, 32 make white.
    Cells,
    /// Height at which the ray is halfway absorbed.
    Height,
    /// Near red, mid green, far blue.
    Tier,
    /// Opacity to the eye.
    Opacity,
    /// Mean visibility of the sky there.
    Sky,
    /// Bent vector there.
    Bent,
    /// Normal of the shell.
    Normal,
    /// Place in the tile.
    Tile,
}

/// Quality of one coat in place of the resource; put it beside its [`Undercoat`].
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default)]
pub struct UndercoatQuality(
    /// What holds for this coat.
    pub UndercoatSettings,
);

/// Quality of all coats.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[reflect(Resource, Default)]
#[serde(default, deny_unknown_fields)]
pub struct UndercoatSettings {
    /// Steps towards the eye, 4..64.
    #[reflect(@Parameter::new("", 4.0, 64.0))]
    pub eye_steps: u32,
    /// Steps towards the key light from each of them, 0..16; 0 takes the mean column above instead.
    #[reflect(@Parameter::new("", 0.0, 16.0))]
    pub light_steps: u32,
    /// Mean optical depth at which a ray is cut off, 1..20.
    #[reflect(@Parameter::new("", 1.0, 20.0))]
    pub depth_clip: f32,
    /// Shift the steps by a pattern that changes from frame to frame; only with temporal anti-aliasing.
    pub jitter: bool,
    /// Shells of [`UndercoatMode::Shells`] that are drawn, 4..32.
    #[reflect(@Parameter::new("", 4.0, 32.0))]
    pub shells: u32,
    /// Thickness on the screen, pixels: above the first the coat is near, below the second far.
    pub tier_px: [f32; 2],
    /// Largest error of a picture that leaving the coat out may make, 0..1.
    #[reflect(@Parameter::share())]
    pub skip_error: f32,
    /// What is shown.
    pub view: UndercoatView,
}

impl UndercoatSettings {
    /// Fewest and most shells.
    pub(super) const SHELLS: (u32, u32) = (4, 32);

    /// Shells that are drawn.
    pub(super) fn shell_count(&self) -> u32 {
        self.shells.clamp(Self::SHELLS.0, Self::SHELLS.1)
    }
}

impl Default for UndercoatSettings {
    fn default() -> Self {
        Self {
            eye_steps: 16,
            light_steps: 4,
            depth_clip: 7.0,
            jitter: false,
            shells: 24,
            tier_px: [12.0, 3.0],
            skip_error: 1.0 / 255.0,
            view: UndercoatView::None,
        }
    }
}
