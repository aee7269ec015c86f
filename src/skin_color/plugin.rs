//! The system that keeps feathers in the colors of their skin.

use super::surface::{Surface, skin_color};
use crate::{
    groom::{Card, CardRoots, FeathersOf, PlumageCards, PlumageState, PlumageSystems, SkinColors},
    modified::modified,
};
use bevy::{
    app::{App, Plugin, Update},
    asset::{AssetEvent, AssetId, AssetServer, Assets, Handle, LoadState},
    color::LinearRgba,
    ecs::{prelude::*, system::SystemParam},
    image::Image,
    log::warn,
    math::Vec3,
    pbr::{MeshMaterial3d, StandardMaterial},
};

/// Colors the feathers of grooms that ask for it (`skin_color`), and again whenever a material or a texture of the skin changes:
/// without a new groom. One of the `PlumagePlugins`.
#[derive(Clone, Copy, Debug, Default)]
pub struct SkinColorPlugin;

impl Plugin for SkinColorPlugin {
    fn build(&self, app: &mut App) {
        // An app without Bevy's own materials has no colors to take.
        let materials = resource_exists::<Assets<StandardMaterial>>;
        app.add_systems(
            Update,
            take_colors
                .in_set(PlumageSystems::TakeSkinColors)
                .after(PlumageSystems::Groom)
                .run_if(any_with_component::<SkinColors>.and_then(materials)),
        );
    }
}

/// The card meshes whose colors are those of their skin as it now is; the others wait for a texture or have not been looked at.
#[derive(Component)]
struct Colored;

/// What the skins are made of.
#[derive(SystemParam)]
struct Skins<'w, 's> {
    server: Res<'w, AssetServer>,
    materials: Res<'w, Assets<StandardMaterial>>,
    images: Res<'w, Assets<Image>>,
    worn: Query<'w, 's, Ref<'static, MeshMaterial3d<StandardMaterial>>>,
}

impl Skins<'_, '_> {
    fn material(&self, mesh: Entity) -> Option<&StandardMaterial> {
        let id = self.worn.get(mesh).ok()?.id();
        self.materials.get(id)
    }

    /// Whether one of these materials or textures is worn by one of the meshes, or a mesh has another material than it had.
    fn touched(
        &self,
        meshes: &[Entity],
        materials: &[AssetId<StandardMaterial>],
        images: &[AssetId<Image>],
    ) -> bool {
        meshes.iter().any(|&mesh| {
            let Ok(worn) = self.worn.get(mesh) else {
                return false;
            };
            let texture = self
                .material(mesh)
                .and_then(|material| material.base_color_texture.as_ref());
            worn.is_changed()
                || materials.contains(&worn.id())
                || texture.is_some_and(|texture| images.contains(&texture.id()))
        })
    }

    /// Why a mesh's texture is not there, if it will not come.
    fn missing(&self, mesh: Entity) -> Option<String> {
        let texture = self.material(mesh)?.base_color_texture.as_ref()?;
        if self.images.contains(texture.id()) {
            return None;
        }
        match self.server.load_state(texture) {
            LoadState::Failed(cause) => Some(format!(
                "the skin's texture did not load, the base color alone serves: {cause}"
            )),
            _ => None,
        }
    }

    /// How a mesh looks, if it has a standard material; `None` while that or its texture loads.
    fn surface(&self, mesh: Entity) -> Option<Option<Surface<'_>>> {
        if !self.worn.contains(mesh) {
            return Some(None);
        }
        let material = self.material(mesh)?;
        let LinearRgba {
            red, green, blue, ..
        } = material.base_color.to_linear();
        let image = |texture: &Handle<Image>| self.images.get(texture);
        let texture = material.base_color_texture.as_ref();
        let loading = |texture: &&Handle<Image>| {
            image(texture).is_none() && !self.server.load_state(*texture).is_failed()
        };
        if texture.filter(loading).is_some() {
            return None;
        }
        Some(Some(Surface {
            base: [red, green, blue],
            texture: texture.and_then(image),
            uv_transform: material.uv_transform,
        }))
    }
}

fn take_colors(
    mut commands: Commands,
    mut material_events: MessageReader<AssetEvent<StandardMaterial>>,
    mut image_events: MessageReader<AssetEvent<Image>>,
    skins: Skins,
    mut birds: Query<(
        Entity,
        Ref<SkinColors>,
        &CardRoots,
        Has<Colored>,
        &mut PlumageCards,
        Option<&FeathersOf>,
    )>,
    mut states: Query<&mut PlumageState>,
) {
    let (materials, images) = (modified(&mut material_events), modified(&mut image_events));
    for (entity, colors, roots, colored, mut cards, of) in &mut birds {
        let stale = colors.is_changed() || skins.touched(&colors.meshes, &materials, &images);
        if colored && !stale {
            continue;
        }
        let surfaces = colors.meshes.iter().map(|&mesh| skins.surface(mesh));
        let Some(surfaces) = surfaces.collect::<Option<Vec<_>>>() else {
            commands.entity(entity).remove::<Colored>();
            continue;
        };
        let owner = FeathersOf::owner(of, entity);
        for &mesh in &colors.meshes {
            if let Some(note) = skins.missing(mesh)
                && let Ok(mut state) = states.get_mut(owner)
                && !state.warnings.contains(&note)
            {
                warn!("plumage of {owner}: {note}");
                state.warnings.push(note);
            }
        }
        cards.cards = colored_cards(&colors, roots, surfaces).into();
        commands.entity(entity).insert(Colored);
    }
}

/// The groom's cards in the skin's colors. Where a texture cannot be read the base color alone serves.
fn colored_cards(
    colors: &SkinColors,
    roots: &CardRoots,
    mut surfaces: Vec<Option<Surface>>,
) -> Vec<Card> {
    let mut cards = colors.cards.to_vec();
    for (card, &root) in cards.iter_mut().zip(roots.roots.iter()) {
        let share = colors.shares.get(usize::from(card.region)).copied();
        let share = share.unwrap_or(0.0);
        if share <= 0.0 {
            continue;
        }
        let size = 0.5 * card.width;
        let found = skin_color(&roots.skin, root, size, &surfaces).or_else(|error| {
            warn!("the skin's texture gives feathers no color: {error}");
            for surface in surfaces.iter_mut().flatten() {
                surface.texture = None;
            }
            skin_color(&roots.skin, root, size, &surfaces)
        });
        if let Ok(Some(skin)) = found {
            let own = Vec3::from(card.tint);
            card.tint = own.lerp(Vec3::from(skin), share).to_array();
        }
    }
    cards
}
