//! Entities, buffers and materials of a grown coat.

use super::{
    Down, GuardStrands, Undercoat, UndercoatOf, UndercoatQuality, UndercoatSettings,
    UndercoatState,
    bake::Baked,
    hairs::HairParts,
    material::{StrandMaterial, UndercoatMaterial, UndercoatUniform},
    pack::PackedShell,
};
use crate::groom::{FeathersOf, NotSkin};
use bevy::{
    asset::RenderAssetUsages,
    camera::visibility::NoFrustumCulling,
    ecs::system::SystemParam,
    light::NotShadowCaster,
    prelude::*,
    render::{render_resource::BufferUsages, storage::ShaderBuffer},
};

/// The shell over one mesh.
#[derive(Component, Clone, Debug)]
pub struct UndercoatShell {
    /// Mesh entity that it lies over.
    pub skin: Entity,
    /// Entity that draws the volume or the shells.
    pub coat: Option<Entity>,
    /// Entity that draws the strands.
    pub strands: Option<Entity>,
    /// Nodes and prisms on the GPU.
    pub buffer: Handle<ShaderBuffer>,
    /// Nodes at rest on the GPU.
    pub rest: Handle<ShaderBuffer>,
    /// Number of nodes.
    pub nodes: u32,
    /// Number of prisms.
    pub prisms: u32,
}

/// What a worker has grown over one mesh.
pub(super) struct Grown {
    pub shell: PackedShell,
    pub coat: Option<Mesh>,
    pub strands: Option<HairParts>,
}

impl Grown {
    /// A shell drawn as a volume.
    pub(super) fn volume(shell: PackedShell) -> Self {
        Self {
            coat: Some(shell.outside()),
            shell,
            strands: None,
        }
    }
}

/// A shell that another takes over from: frames that it still stays, until the other's buffers are on the GPU.
#[derive(Component)]
pub(super) struct DespawnAfter(u8);

impl DespawnAfter {
    /// Long enough for materials that wait for their textures.
    pub(super) const REPLACED: Self = Self(3);
}

/// Drops the shells whose time is over.
pub(super) fn despawn_replaced(
    mut commands: Commands,
    mut old: Query<(Entity, &mut DespawnAfter)>,
) {
    for (entity, mut left) in &mut old {
        if left.0 == 0 {
            commands.entity(entity).try_despawn();
        }
        left.0 = left.0.saturating_sub(1);
    }
}

/// Where meshes, buffers and materials go.
#[derive(SystemParam)]
pub(super) struct CoatAssets<'w> {
    meshes: ResMut<'w, Assets<Mesh>>,
    buffers: ResMut<'w, Assets<ShaderBuffer>>,
    pub(super) images: ResMut<'w, Assets<Image>>,
    coats: ResMut<'w, Assets<UndercoatMaterial>>,
    strands: ResMut<'w, Assets<StrandMaterial>>,
}

/// What a shell is spawned with.
pub(super) struct ShellSpawner<'a> {
    /// What [`UndercoatOf`] names.
    pub owner: Entity,
    pub skin: Entity,
    pub down: &'a Down,
    pub baked: &'a Baked,
    pub coat: &'a Undercoat,
    pub strands: Option<&'a GuardStrands>,
    pub settings: &'a UndercoatSettings,
    pub place: CoatPlace,
}

/// Where a coat lies, which is the depth that it writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CoatPlace {
    /// By itself: its own depth.
    Alone,
    /// Around a skin with sparse feathers: the depth of the skin, whatever lies over that covers the coat.
    OnSkin,
    /// Below the skin of a bird, whose feathers hide it at rest: the depth of its outside.
    Sunk,
}

impl CoatAssets<'_> {
    /// Gives a coat its own color to this share, the skin's to the rest.
    pub(super) fn show(&mut self, coat: &MeshMaterial3d<UndercoatMaterial>, share: f32) {
        let unlike = |material: &UndercoatMaterial| (material.uniform.shown - share).abs() > 2e-3;
        if self.coats.get(coat.id()).is_some_and(unlike)
            && let Some(mut material) = self.coats.get_mut(coat.id())
        {
            material.uniform.shown = share;
        }
    }
}

fn storage(data: Vec<u8>, label: &'static str) -> ShaderBuffer {
    let mut buffer = ShaderBuffer::new(&data, RenderAssetUsages::RENDER_WORLD);
    buffer.buffer_description.label = Some(label);
    buffer.buffer_description.usage =
        BufferUsages::STORAGE | BufferUsages::COPY_DST | BufferUsages::COPY_SRC;
    buffer
}

impl ShellSpawner<'_> {
    /// Spawns one shell below its skin; the entity that draws the volume, if any does.
    pub(super) fn spawn(
        &self,
        commands: &mut Commands,
        assets: &mut CoatAssets,
        grown: Grown,
        state: &mut UndercoatState,
    ) -> Option<Entity> {
        let shell = &grown.shell.shell;
        let (nodes, prisms) = (shell.vertices.len() as u32, shell.prisms.len() as u32);
        state.prisms += prisms;
        state.walls += (shell.faces.len() - shell.tops) as u32 / 2;
        state.limited += shell.report.lowered as u32;
        state.bytes += (grown.shell.bytes.len() + grown.shell.rest.len()) as u64;
        let buffer = assets
            .buffers
            .add(storage(grown.shell.bytes, "undercoat_shell"));
        let rest = assets
            .buffers
            .add(storage(grown.shell.rest, "undercoat_rest"));
        let anchor = commands
            .spawn((
                Transform::IDENTITY,
                Visibility::default(),
                Name::new("Undercoat"),
                ChildOf(self.skin),
            ))
            .id();
        let part = |commands: &mut Commands, name: &'static str| {
            commands
                .spawn((
                    // No skin to feather, and none to cover once more.
                    NotSkin,
                    NoFrustumCulling,
                    NotShadowCaster,
                    Transform::IDENTITY,
                    Visibility::default(),
                    Name::new(name),
                    ChildOf(anchor),
                ))
                .id()
        };
        let uniform = uniform_of(
            self.down,
            self.baked,
            self.coat,
            self.settings,
            (nodes, prisms),
            self.place,
        );
        let coat = grown.coat.map(|mesh| {
            state.bytes += mesh.count_vertices() as u64 * mesh.get_vertex_size();
            let material = UndercoatMaterial {
                mode: self.coat.mode,
                sunk: self.place == CoatPlace::Sunk,
                uniform,
                shell: buffer.clone(),
                density: self.baked.density.clone(),
                transfer: self.baked.transfer.clone(),
            };
            let entity = part(commands, "Undercoat volume");
            commands.entity(entity).insert((
                Mesh3d(assets.meshes.add(mesh)),
                MeshMaterial3d(assets.coats.add(material)),
            ));
            entity
        });
        let strands = grown
            .strands
            .zip(self.strands)
            .and_then(|(parts, strands)| {
                if parts.count == 0 {
                    return None;
                }
                state.strands += parts.count;
                state.bytes += parts.bytes();
                let material = StrandMaterial {
                    uniform: parts.uniform(
                        strands,
                        &uniform,
                        self.coat.scale.clamp(0.0, 10.0),
                        coat.is_some(),
                    ),
                    shell: buffer.clone(),
                    roots: assets.buffers.add(storage(parts.roots, "undercoat_roots")),
                };
                let entity = part(commands, "Undercoat strands");
                commands.entity(entity).insert((
                    Mesh3d(assets.meshes.add(parts.mesh)),
                    MeshMaterial3d(assets.strands.add(material)),
                ));
                Some(entity)
            });
        let shell = UndercoatShell {
            skin: self.skin,
            coat,
            strands,
            buffer,
            rest,
            nodes,
            prisms,
        };
        commands
            .entity(anchor)
            .insert((shell, UndercoatOf(self.owner)));
        coat
    }
}

fn linear(color: [f32; 3]) -> Vec3 {
    let linear = Color::srgb_from_array(color).to_linear();
    Vec3::new(linear.red, linear.green, linear.blue)
}

/// The uniform of a coat.
pub(super) fn uniform_of(
    down: &Down,
    baked: &Baked,
    coat: &Undercoat,
    settings: &UndercoatSettings,
    counts: (u32, u32),
    place: CoatPlace,
) -> UndercoatUniform {
    let table = &baked.table;
    UndercoatUniform {
        node_count: counts.0.max(1),
        prism_count: counts.1.max(1),
        view: settings.view as u32,
        tier: coat.tier as u32,
        eye_steps: settings.eye_steps.clamp(4, 64),
        light_steps: settings.light_steps.min(16),
        shell_count: settings.shell_count(),
        jitter: u32::from(settings.jitter),
        color: linear(down.color),
        largest_extinction: table.largest,
        tip_color: linear(down.tip_color),
        mean_depth: table.mean,
        skin_color: linear(down.skin),
        depth_clip: settings.depth_clip.clamp(1.0, 20.0),
        skin_spread: down.tangent_spread.skin,
        tip_spread: down.tangent_spread.tips,
        highlight_strength: down.specular.strength,
        highlight_exponent: down.specular.exponent,
        lean: down.bend,
        near_px: settings.tier_px[0],
        far_px: settings.tier_px[1],
        own_depth: u32::from(place == CoatPlace::Alone),
        // Under feathers at rest it passes for the skin, which is painted like them.
        shown: f32::from(place != CoatPlace::Sunk),
        tinted: f32::from(place == CoatPlace::Alone),
        bands: table.bands,
        column: table.column,
        correction: table.correction,
    }
}

/// Takes changes of the settings over into the materials.
pub(super) fn apply_settings(
    settings: Res<UndercoatSettings>,
    own: Query<Ref<UndercoatQuality>>,
    changed: Query<(), Changed<UndercoatQuality>>,
    mut removed: RemovedComponents<UndercoatQuality>,
    coats: Query<&Undercoat>,
    birds: Query<&FeathersOf>,
    shells: Query<(&UndercoatShell, &UndercoatOf)>,
    handles: Query<&MeshMaterial3d<UndercoatMaterial>>,
    mut materials: ResMut<Assets<UndercoatMaterial>>,
) {
    let removed: Vec<Entity> = removed.read().collect();
    if !settings.is_changed() && removed.is_empty() && changed.is_empty() {
        return;
    }
    for (shell, of) in &shells {
        // The down of a bird hangs on its card mesh, its quality on the bird.
        let owner = FeathersOf::owner(birds.get(of.0).ok(), of.0);
        let quality = own.get(owner).ok();
        let own_changed = match &quality {
            Some(quality) => quality.is_changed(),
            None => removed.contains(&owner),
        };
        if !settings.is_changed() && !own_changed {
            continue;
        }
        let Some(coat) = shell.coat else {
            continue;
        };
        let tier = coats.get(of.0).map(|coat| coat.tier).unwrap_or_default();
        let quality = quality.map_or(*settings, |quality| quality.0);
        let Some(mut material) = handles
            .get(coat)
            .ok()
            .and_then(|handle| materials.get_mut(handle.id()))
        else {
            continue;
        };
        let uniform = &mut material.uniform;
        uniform.view = quality.view as u32;
        uniform.tier = tier as u32;
        uniform.eye_steps = quality.eye_steps.clamp(4, 64);
        uniform.light_steps = quality.light_steps.min(16);
        uniform.shell_count = quality.shell_count();
        uniform.jitter = u32::from(quality.jitter);
        uniform.depth_clip = quality.depth_clip.clamp(1.0, 20.0);
        [uniform.near_px, uniform.far_px] = quality.tier_px;
    }
}
