//! Grows the coats of entities with an [`Undercoat`]: shells, their materials, their strands.

use super::{
    Down, GuardStrands, Undercoat, UndercoatMode, UndercoatQuality, UndercoatSettings,
    UndercoatState, UndercoatTier,
    bake::Bakes,
    hairs::{StrandInput, grow_strands},
    meshes::{Input, Meshes},
    pack::{PackedShell, ShellShape},
    wear::{Grown, Lies, Outgoing, Stores, UndercoatShell, Wear},
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

/// Drops the shells of a coat that was taken off, and grows one anew whose shells went with the scene they hung on.
pub(super) fn tend(
    mut commands: Commands,
    mut removed: RemovedComponents<Undercoat>,
    shells: Query<(Entity, &UndercoatShell)>,
    worn: Query<(), With<Undercoat>>,
    mut coats: Query<(Entity, &mut UndercoatState), (With<Undercoat>, Without<GrowJob>)>,
) {
    for owner in removed.read() {
        // Taken off and put on again in one frame is a change.
        if worn.contains(owner) {
            continue;
        }
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
    settings: Res<UndercoatSettings>,
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
        let Some(found) = meshes.find(owner, &images, coat.rounds) else {
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
        sunk: false,
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

/// Spawns what the workers have grown.
pub(super) fn finish(
    mut commands: Commands,
    mut assets: Stores,
    downs: Res<Assets<Down>>,
    mut bakes: ResMut<Bakes>,
    settings: Res<UndercoatSettings>,
    entities: Query<Entity>,
    old: Query<(Entity, &UndercoatShell), Without<Outgoing>>,
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
        for (entity, _) in old.iter().filter(|(_, shell)| shell.owner == owner) {
            commands.entity(entity).try_insert(Outgoing::START);
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
                lies: Lies::Alone,
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
