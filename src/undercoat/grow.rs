//! Grows the coats of entities with an [`Undercoat`]: shells, their materials, their strands.

use super::{
    Down, GuardStrands, Undercoat, UndercoatFailed, UndercoatMode, UndercoatParts,
    UndercoatQuality, UndercoatReady, UndercoatSettings, UndercoatState, UndercoatTier,
    bake::Bakes,
    hairs::{StrandInput, grow_strands},
    meshes::{Input, Meshes},
    pack::{PackedShell, ShellShape},
    spawn::{CoatAssets, CoatPlace, DespawnAfter, Grown, ShellSpawner},
};
use crate::{groom::SkinMesh, modified::modified};
use bevy::{
    asset::LoadState,
    ecs::query::QueryData,
    prelude::*,
    tasks::{AsyncComputeTaskPool, Task, TaskPool, block_on, poll_once},
};

/// A coat under way.
#[derive(Component, Default)]
pub(super) struct GrowJob {
    targets: Vec<Entity>,
    task: Option<Task<Vec<Result<Grown, String>>>>,
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
    let modified = modified(&mut events);
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

/// A coat taken off takes its shells with it.
pub(super) fn drop_removed(remove: On<Remove, Undercoat>, mut commands: Commands) {
    let owner = remove.entity;
    // The whole entity may be on its way out.
    commands.queue(move |world: &mut World| {
        if let Ok(mut entity) = world.get_entity_mut(owner) {
            entity
                .despawn_related::<UndercoatParts>()
                .remove::<(GrowJob, UndercoatState)>();
        }
    });
}

/// Grows a coat anew whose shells went with the scene they hung on.
pub(super) fn regrow_lost(
    remove: On<Remove, UndercoatParts>,
    mut commands: Commands,
    mut coats: Query<&mut UndercoatState, (With<Undercoat>, Without<GrowJob>)>,
) {
    if let Ok(mut state) = coats.get_mut(remove.entity)
        && state.ready
        && state.error.is_none()
    {
        *state = UndercoatState::default();
        commands
            .entity(remove.entity)
            .try_insert(GrowJob::default());
    }
}

/// A coat whose shells and strands are being grown.
#[derive(QueryData)]
#[query_data(mutable)]
pub(super) struct Growing {
    owner: Entity,
    coat: &'static Undercoat,
    strands: Option<&'static GuardStrands>,
    own: Option<&'static UndercoatQuality>,
    state: &'static mut UndercoatState,
    job: &'static mut GrowJob,
}

/// Starts the worker of every coat whose assets are there.
pub(super) fn start(
    mut commands: Commands,
    server: Res<AssetServer>,
    downs: Res<Assets<Down>>,
    mut images: ResMut<Assets<Image>>,
    mut bakes: ResMut<Bakes>,
    meshes: Meshes,
    mut coats: Query<Growing>,
) {
    for growing in &mut coats {
        let GrowingItem {
            owner,
            coat,
            strands,
            mut state,
            mut job,
            ..
        } = growing;
        if job.task.is_some() {
            continue;
        }
        let mut fail = |message: String| {
            error!("undercoat of {owner}: {message}");
            state.error = Some(message.clone());
            commands.entity(owner).try_remove::<GrowJob>();
            commands.trigger(UndercoatFailed {
                entity: owner,
                error: message,
            });
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
        let Some(found) = meshes.find(owner, &images, coat.rounds) else {
            continue;
        };
        let (down, coat, strands) = (down.clone(), coat.clone(), strands.cloned());
        let (targets, inputs): (Vec<_>, Vec<_>) = found.into_iter().unzip();
        job.targets = targets;
        let pool = AsyncComputeTaskPool::get_or_init(TaskPool::new);
        job.task = Some(pool.spawn(async move {
            let grow = |input: Input| grow_one(input, &down, &coat, strands.as_ref());
            inputs.into_iter().map(grow).collect()
        }));
    }
}

fn grow_one(
    input: Input,
    down: &Down,
    coat: &Undercoat,
    strands: Option<&GuardStrands>,
) -> Result<Grown, String> {
    let mut skin = SkinMesh::from_meshes(&[&input.mesh], &[]).map_err(|error| error.to_string())?;
    if let Some(colors) = input.colors {
        skin.colors = colors;
    }
    let factor = coat.scale.clamp(0.0, 10.0) / input.world_scale;
    let shift = |bits: u64| (bits & 0xffff) as f32 / 65_536.0;
    let shape = ShellShape {
        height: 1.0e-3 * down.thickness_mm * factor,
        world_scale: input.world_scale,
        tile: down.tile_metres() * factor,
        lay: Vec3::from(down.lay),
        offset: Vec2::new(shift(coat.seed), shift(coat.seed >> 16)),
        sunk: false,
    };
    let shell =
        PackedShell::build(&skin, |_| true, None, &shape).map_err(|error| error.to_string())?;
    let drawn = coat.visible && coat.tier != UndercoatTier::None;
    let mesh = drawn.then(|| match coat.mode {
        UndercoatMode::Volume => shell.outside(),
        UndercoatMode::Shells => shell.shells(UndercoatSettings::SHELLS.1),
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

/// Spawns what the workers have grown.
pub(super) fn finish(
    mut commands: Commands,
    mut assets: CoatAssets,
    downs: Res<Assets<Down>>,
    mut bakes: ResMut<Bakes>,
    settings: Res<UndercoatSettings>,
    entities: Query<Entity>,
    parts: Query<&UndercoatParts>,
    replaced: Query<(), With<DespawnAfter>>,
    mut coats: Query<Growing>,
) {
    for growing in &mut coats {
        let GrowingItem {
            owner,
            coat,
            strands,
            own,
            mut state,
            mut job,
        } = growing;
        let Some(results) = job.task.as_mut().and_then(|task| block_on(poll_once(task))) else {
            continue;
        };
        let targets = std::mem::take(&mut job.targets);
        commands.entity(owner).remove::<GrowJob>();
        let old = parts.get(owner).map_or(&[][..], |parts| parts);
        for entity in old.iter().filter(|entity| !replaced.contains(**entity)) {
            commands.entity(*entity).try_insert(DespawnAfter::REPLACED);
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
                    state.error = Some(message.clone());
                    commands.trigger(UndercoatFailed {
                        entity: owner,
                        error: message,
                    });
                    continue;
                }
            };
            let spawner = ShellSpawner {
                owner,
                skin,
                down,
                baked: &baked,
                coat,
                strands,
                settings: own.map_or(&*settings, |own| &own.0),
                place: CoatPlace::Alone,
            };
            spawner.spawn(&mut commands, &mut assets, grown, &mut state);
        }
        if state.limited > 0 {
            warn!(
                "undercoat of {owner}: the skin is bent too tightly for its coat at {} of its vertices, which have less of it",
                state.limited
            );
        }
        if state.error.is_none() {
            commands.trigger(UndercoatReady { entity: owner });
        }
    }
}
