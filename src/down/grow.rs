//! Grows the coats of entities with an [`Undercoat`]: shells, their materials, their strands.

use super::{
    Down, GuardStrands, Undercoat, UndercoatMode, UndercoatQuality, UndercoatSettings,
    UndercoatState, UndercoatTier,
    bake::{Baked, Bakes},
    hairs::{HairParts, StrandInput, grow_strands},
    material::{StrandMaterial, UndercoatMaterial, UndercoatUniform},
    pack::{PackedShell, ShellShape},
};
use crate::groom::{PlumageCards, PlumageRepeat, SkinMesh};
use bevy::{
    asset::{LoadState, RenderAssetUsages},
    camera::visibility::NoFrustumCulling,
    ecs::system::SystemParam,
    light::NotShadowCaster,
    mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes},
    prelude::*,
    render::{render_resource::BufferUsages, storage::ShaderBuffer},
    tasks::{AsyncComputeTaskPool, Task, TaskPool, block_on, poll_once},
};

/// The shell over one mesh.
#[derive(Component, Clone, Debug)]
pub struct UndercoatShell {
    /// Mesh entity that it lies over.
    pub skin: Entity,
    /// Entity with the [`Undercoat`].
    pub owner: Entity,
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

/// A coat under way.
#[derive(Component, Default)]
pub(super) struct GrowJob {
    targets: Vec<Entity>,
    task: Option<Task<Vec<Result<Grown, String>>>>,
}

pub(super) struct Grown {
    shell: PackedShell,
    coat: Option<Mesh>,
    strands: Option<HairParts>,
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

/// One mesh as the worker gets it.
struct Input {
    mesh: Mesh,
    world_scale: f32,
    colours: Option<Vec<[f32; 3]>>,
}

pub(super) fn request(
    mut commands: Commands,
    mut events: MessageReader<AssetEvent<Down>>,
    mut coats: Query<(
        Entity,
        Ref<Undercoat>,
        Option<Ref<GuardStrands>>,
        &mut UndercoatState,
    )>,
    mut lost: RemovedComponents<GuardStrands>,
) {
    let modified: Vec<_> = events
        .read()
        .filter_map(|event| match event {
            AssetEvent::Modified { id } => Some(*id),
            _ => None,
        })
        .collect();
    let lost: Vec<Entity> = lost.read().collect();
    for (entity, coat, strands, mut state) in &mut coats {
        if coat.is_changed()
            || strands.is_some_and(|strands| strands.is_changed())
            || lost.contains(&entity)
            || modified.contains(&coat.down.id())
        {
            state.ready = false;
            state.error = None;
            commands.entity(entity).insert(GrowJob::default());
        }
    }
}

/// Drops the shells of a coat that was taken off, and grows one anew whose shells went with the scene they hung on.
pub(super) fn tend(
    mut commands: Commands,
    mut removed: RemovedComponents<Undercoat>,
    shells: Query<(Entity, &UndercoatShell)>,
    mut coats: Query<(Entity, &mut UndercoatState), (With<Undercoat>, Without<GrowJob>)>,
) {
    for owner in removed.read() {
        for (entity, _) in shells.iter().filter(|(_, shell)| shell.owner == owner) {
            commands.entity(entity).try_despawn();
        }
        if let Ok(mut entity) = commands.get_entity(owner) {
            entity.try_remove::<(GrowJob, UndercoatState)>();
        }
    }
    for (owner, mut state) in &mut coats {
        if state.ready && !shells.iter().any(|(_, shell)| shell.owner == owner) {
            *state = UndercoatState::default();
            commands.entity(owner).insert(GrowJob::default());
        }
    }
}

/// The meshes below an entity.
#[derive(SystemParam)]
pub(super) struct Meshes<'w, 's> {
    children: Query<'w, 's, &'static Children>,
    meshes: Query<
        'w,
        's,
        (
            &'static Mesh3d,
            Option<&'static SkinnedMesh>,
            &'static GlobalTransform,
            Option<&'static MeshMaterial3d<StandardMaterial>>,
        ),
        (Without<PlumageCards>, Without<PlumageRepeat>),
    >,
    transforms: Query<'w, 's, &'static GlobalTransform>,
    assets: Res<'w, Assets<Mesh>>,
    poses: Res<'w, Assets<SkinnedMeshInverseBindposes>>,
    materials: Res<'w, Assets<StandardMaterial>>,
}

fn scale_of(matrix: Mat4) -> f32 {
    let scale = Mat3::from_mat4(matrix).determinant().abs().cbrt();
    if scale.is_finite() && scale > 1e-9 {
        scale
    } else {
        1.0
    }
}

/// Colour of every vertex in a picture laid over the mesh.
fn vertex_colours(mesh: &Mesh, image: &Image, base: LinearRgba) -> Option<Vec<[f32; 3]>> {
    let Ok(Some(bevy::mesh::VertexAttributeValues::Float32x2(uvs))) =
        mesh.try_attribute_option(Mesh::ATTRIBUTE_UV_0)
    else {
        return None;
    };
    let size = image.size();
    let texel = |share: f32, count: u32| {
        ((share - share.floor()) * count as f32).min(count.saturating_sub(1) as f32) as u32
    };
    uvs.iter()
        .map(|[u, v]| {
            let colour = image.get_color_at(texel(*u, size.x), texel(*v, size.y));
            let linear = colour.ok()?.to_linear();
            Some([
                linear.red * base.red,
                linear.green * base.green,
                linear.blue * base.blue,
            ])
        })
        .collect()
}

impl Meshes<'_, '_> {
    /// The meshes to cover, once all of them are loaded.
    fn find(&self, owner: Entity, images: &Assets<Image>) -> Option<Vec<(Entity, Input)>> {
        let mut found = Vec::new();
        for entity in std::iter::once(owner).chain(self.children.iter_descendants(owner)) {
            let Ok((handle, skin, transform, material)) = self.meshes.get(entity) else {
                continue;
            };
            let mesh = self.assets.get(&handle.0)?;
            let matrix = match skin {
                Some(skin) => {
                    let bind = self.poses.get(&skin.inverse_bindposes)?;
                    let joint = skin.joints.first()?;
                    let first = bind.first().copied().unwrap_or(Mat4::IDENTITY);
                    self.transforms.get(*joint).ok()?.to_matrix() * first
                }
                None => transform.to_matrix(),
            };
            let standard = material.and_then(|material| self.materials.get(material.id()));
            let colours = standard.and_then(|material| {
                let image = images.get(material.base_color_texture.as_ref()?)?;
                vertex_colours(mesh, image, material.base_color.to_linear())
            });
            found.push((
                entity,
                Input {
                    mesh: mesh.clone(),
                    world_scale: scale_of(matrix),
                    colours,
                },
            ));
        }
        (!found.is_empty()).then_some(found)
    }
}

/// Starts the worker of every coat whose assets are there.
pub(super) fn start(
    mut commands: Commands,
    server: Res<AssetServer>,
    downs: Res<Assets<Down>>,
    mut images: ResMut<Assets<Image>>,
    mut bakes: ResMut<Bakes>,
    meshes: Meshes,
    settings: Res<UndercoatSettings>,
    mut coats: Query<(
        Entity,
        &Undercoat,
        Option<&GuardStrands>,
        Option<&UndercoatQuality>,
        &mut UndercoatState,
        &mut GrowJob,
    )>,
) {
    for (owner, coat, strands, own, mut state, mut job) in &mut coats {
        if job.task.is_some() {
            continue;
        }
        let mut fail = |message: String| {
            error!("undercoat of {owner}: {message}");
            state.error = Some(message);
            commands.entity(owner).try_remove::<GrowJob>();
        };
        let Some(down) = downs.get(&coat.down) else {
            if let LoadState::Failed(cause) = server.load_state(coat.down.id()) {
                fail(cause.to_string());
            }
            continue;
        };
        match bakes.get(coat.down.id(), down, &mut images) {
            None => continue,
            Some(Err(message)) => {
                fail(message);
                continue;
            }
            Some(Ok(_)) => {}
        }
        let Some(found) = meshes.find(owner, &images) else {
            continue;
        };
        let (down, coat, strands) = (down.clone(), coat.clone(), strands.cloned());
        let shells = own.map_or(&*settings, |own| &own.0).shells;
        let (targets, inputs): (Vec<_>, Vec<_>) = found.into_iter().unzip();
        job.targets = targets;
        let pool = AsyncComputeTaskPool::get_or_init(TaskPool::new);
        job.task = Some(pool.spawn(async move {
            let grow = |input: Input| grow_one(input, &down, &coat, strands.as_ref(), shells);
            inputs.into_iter().map(grow).collect()
        }));
    }
}

fn grow_one(
    input: Input,
    down: &Down,
    coat: &Undercoat,
    strands: Option<&GuardStrands>,
    shells: u32,
) -> Result<Grown, String> {
    let mut skin = SkinMesh::from_meshes(&[&input.mesh], &[]).map_err(|error| error.to_string())?;
    if let Some(colours) = input.colours {
        skin.colors = colours;
    }
    let factor = coat.scale.clamp(0.0, 10.0) / input.world_scale;
    let shift = |bits: u64| (bits & 0xffff) as f32 / 65_536.0;
    let shape = ShellShape {
        height: 1.0e-3 * down.thickness_mm * factor,
        world_scale: input.world_scale,
        tile: down.tile_metres() * factor,
        lay: Vec3::from(down.lay),
        offset: Vec2::new(shift(coat.seed), shift(coat.seed >> 16)),
    };
    let shell =
        PackedShell::build(&skin, |_| true, None, &shape).map_err(|error| error.to_string())?;
    let drawn = coat.visible && coat.tier != UndercoatTier::None;
    let mesh = drawn.then(|| match coat.mode {
        UndercoatMode::Volume => shell.outside(),
        UndercoatMode::Shells => shell.shells(shells),
    });
    let strands = strands.map(|strands| {
        grow_strands(&StrandInput {
            shell: &shell.shell,
            strands,
            factor,
            scale: coat.scale.clamp(0.0, 10.0),
            seed: coat.seed,
        })
    });
    Ok(Grown {
        shell,
        coat: mesh,
        strands,
    })
}

fn linear(colour: [f32; 3]) -> Vec3 {
    let linear = Color::srgb_from_array(colour).to_linear();
    Vec3::new(linear.red, linear.green, linear.blue)
}

/// The uniform of a coat.
pub(super) fn uniform_of(
    down: &Down,
    baked: &Baked,
    coat: &Undercoat,
    settings: &UndercoatSettings,
    counts: (u32, u32),
    over_skin: bool,
) -> UndercoatUniform {
    let table = &baked.table;
    UndercoatUniform {
        counts: UVec4::new(
            counts.0.max(1),
            counts.1.max(1),
            settings.view as u32,
            coat.tier as u32,
        ),
        steps: UVec4::new(
            settings.eye_steps.clamp(4, 64),
            settings.light_steps.min(16),
            settings.shells.clamp(4, 64),
            u32::from(settings.jitter),
        ),
        colour: linear(down.colour).extend(table.largest),
        tip_colour: linear(down.tip_colour).extend(table.mean),
        skin: linear(down.skin).extend(settings.depth_clip.clamp(1.0, 20.0)),
        fibre: Vec4::new(
            down.tangent_spread.0,
            down.tangent_spread.1,
            down.specular.0,
            down.specular.1,
        ),
        shape: Vec4::new(
            down.bend,
            settings.tier_px[0],
            settings.tier_px[1],
            if over_skin { 0.0 } else { 1.0 },
        ),
        bands: table.bands,
        column: table.column,
    }
}

/// Spawns what the workers have grown.
pub(super) fn finish(
    mut commands: Commands,
    mut assets: Stores,
    downs: Res<Assets<Down>>,
    mut bakes: ResMut<Bakes>,
    settings: Res<UndercoatSettings>,
    entities: Query<Entity>,
    old: Query<(Entity, &UndercoatShell)>,
    mut coats: Query<(
        Entity,
        &Undercoat,
        Option<&GuardStrands>,
        Option<&UndercoatQuality>,
        &mut UndercoatState,
        &mut GrowJob,
    )>,
) {
    for (owner, coat, strands, own, mut state, mut job) in &mut coats {
        let Some(results) = job.task.as_mut().and_then(|task| block_on(poll_once(task))) else {
            continue;
        };
        let targets = std::mem::take(&mut job.targets);
        commands.entity(owner).remove::<GrowJob>();
        for (entity, _) in old.iter().filter(|(_, shell)| shell.owner == owner) {
            commands.entity(entity).try_despawn();
        }
        let baked = downs.get(&coat.down).and_then(|down| {
            let baked = bakes.get(coat.down.id(), down, &mut assets.images)?.ok()?;
            Some((down, baked))
        });
        // The down may have changed, or the scene been replaced, while the worker was busy: then begin again.
        let Some((down, baked)) = baked.filter(|_| targets.iter().all(|t| entities.contains(*t)))
        else {
            commands.entity(owner).insert(GrowJob::default());
            continue;
        };
        *state = UndercoatState {
            ready: true,
            bytes: baked.bytes,
            ..default()
        };
        for (skin, result) in targets.into_iter().zip(results) {
            let grown = match result {
                Ok(grown) => grown,
                Err(message) => {
                    error!("undercoat of {owner}: {message}");
                    state.error = Some(message);
                    continue;
                }
            };
            let wear = Wear {
                owner,
                skin,
                down,
                baked: &baked,
                coat,
                strands,
                settings: own.map_or(&*settings, |own| &own.0),
                over_skin: false,
            };
            wear.spawn(&mut commands, &mut assets, grown, &mut state);
        }
        if state.limited > 0 {
            warn!(
                "undercoat of {owner}: the skin is bent too tightly for its coat at {} of its vertices, which have less of it",
                state.limited
            );
        }
    }
}

/// Where meshes, buffers and materials go.
#[derive(SystemParam)]
pub(super) struct Stores<'w> {
    meshes: ResMut<'w, Assets<Mesh>>,
    buffers: ResMut<'w, Assets<ShaderBuffer>>,
    pub(super) images: ResMut<'w, Assets<Image>>,
    coats: ResMut<'w, Assets<UndercoatMaterial>>,
    strands: ResMut<'w, Assets<StrandMaterial>>,
}

/// What a shell is spawned with.
pub(super) struct Wear<'a> {
    pub owner: Entity,
    pub skin: Entity,
    pub down: &'a Down,
    pub baked: &'a Baked,
    pub coat: &'a Undercoat,
    pub strands: Option<&'a GuardStrands>,
    pub settings: &'a UndercoatSettings,
    /// The depth written is that of the skin: whatever lies over the skin covers the coat.
    pub over_skin: bool,
}

fn storage(data: Vec<u8>, label: &'static str) -> ShaderBuffer {
    let mut buffer = ShaderBuffer::new(&data, RenderAssetUsages::RENDER_WORLD);
    buffer.buffer_description.label = Some(label);
    buffer.buffer_description.usage =
        BufferUsages::STORAGE | BufferUsages::COPY_DST | BufferUsages::COPY_SRC;
    buffer
}

impl Wear<'_> {
    /// Spawns one shell below its skin; the entity that draws the volume, if any does.
    pub(super) fn spawn(
        &self,
        commands: &mut Commands,
        assets: &mut Stores,
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
                    PlumageRepeat,
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
            self.over_skin,
        );
        let coat = grown.coat.map(|mesh| {
            state.bytes += mesh.count_vertices() as u64 * mesh.get_vertex_size();
            let material = UndercoatMaterial {
                mode: self.coat.mode,
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
        commands.entity(anchor).insert(UndercoatShell {
            skin: self.skin,
            owner: self.owner,
            coat,
            strands,
            buffer,
            rest,
            nodes,
            prisms,
        });
        coat
    }
}

/// Takes changes of the settings over into the materials.
pub(super) fn apply_settings(
    settings: Res<UndercoatSettings>,
    own: Query<Ref<UndercoatQuality>>,
    coats: Query<&Undercoat>,
    shells: Query<&UndercoatShell>,
    worn: Query<&MeshMaterial3d<UndercoatMaterial>>,
    mut materials: ResMut<Assets<UndercoatMaterial>>,
) {
    for shell in &shells {
        let quality = own.get(shell.owner).ok();
        if !settings.is_changed() && quality.as_ref().is_none_or(|quality| !quality.is_changed()) {
            continue;
        }
        let Some(coat) = shell.coat else {
            continue;
        };
        let tier = coats
            .get(shell.owner)
            .map(|coat| coat.tier)
            .unwrap_or_default();
        let quality = quality.map_or(*settings, |quality| quality.0);
        let Some(mut material) = worn
            .get(coat)
            .ok()
            .and_then(|handle| materials.get_mut(handle.id()))
        else {
            continue;
        };
        let uniform = &mut material.uniform;
        uniform.counts.z = quality.view as u32;
        uniform.counts.w = tier as u32;
        uniform.steps.x = quality.eye_steps.clamp(4, 64);
        uniform.steps.y = quality.light_steps.min(16);
        uniform.steps.w = u32::from(quality.jitter);
        uniform.skin.w = quality.depth_clip.clamp(1.0, 20.0);
        (uniform.shape.y, uniform.shape.z) = (quality.tier_px[0], quality.tier_px[1]);
    }
}
