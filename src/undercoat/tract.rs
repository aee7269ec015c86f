//! Down below the feathers of a bird: tract by tract, drawn only where the feathers leave enough of it open
//! (docs/book/undercoat.md#when-it-is-drawn-at-all).

use super::{
    Down, Undercoat, UndercoatFailed, UndercoatQuality, UndercoatReady, UndercoatSettings,
    UndercoatState,
    bake::Bakes,
    material::UndercoatMaterial,
    pack::{PackedShell, ShellShape},
    spawn::{CoatAssets, CoatPlace, Grown, ShellSpawner},
};
use crate::maths::undercoat::tier::{CONTRAST, cover_now, is_drawn};
use crate::{
    groom::{DownTract, DownTracts, FeathersOf, Groom, PlumageCards, SkinMesh},
    maths::wind::RUFFLE_LIFT,
    render::Ruffle,
};
use bevy::{
    asset::AssetServer,
    prelude::*,
    tasks::{AsyncComputeTaskPool, Task, TaskPool, block_on, poll_once},
};

/// Feathers raised further than this from where they rest show what is below, radians.
const OPEN_LIFT: f32 = 6.0 * std::f32::consts::PI / 180.0;

/// Whether the down of a tract is drawn. `cover` is K, `lift` the angle by which feathers are raised from their rest in radians,
/// `error` the largest error of a picture that leaving it out may make, `drawn` what was decided last.
pub fn draws_down(cover: f32, lift: f32, error: f32, drawn: bool) -> bool {
    // What is drawn stays a little longer, so that nothing flickers at the limit.
    let limit = OPEN_LIFT * if drawn { 0.7 } else { 1.0 };
    let cover = cover_now(cover, lift, 1.0, 0.0);
    lift > limit || error <= 0.0 || is_drawn(cover, 0.0, CONTRAST as f32, error, drawn)
}

/// Whether feathers at rest hide the down of a tract.
fn is_hidden(cover: f32) -> bool {
    !draws_down(cover, 0.0, 1.0 / 255.0, false)
}

/// Share by which the down of a tract is seen, the rest is the painted skin: feathers at rest hide it so well that the skin, painted like
/// them, stands for it; those raised by 1.7 times the limit show all of it. `cover` and `lift` as in [`draws_down`].
pub fn shown_share(cover: f32, lift: f32, error: f32) -> f32 {
    if is_drawn(cover, 0.0, CONTRAST as f32, error.max(1e-6), false) && error > 0.0 {
        return 1.0;
    }
    let x = (lift / OPEN_LIFT - 0.7).clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

/// The triangles of a tract, and those of others around it: coats that end at the same edge would leave a seam.
fn with_seam(skin: &SkinMesh, tracts: &[DownTract], own: &DownTract) -> Vec<bool> {
    let has = |tract: &DownTract, t: usize| tract.triangles.get(t) == Some(&true);
    let node = |v: &u32| skin.node_of.get(*v as usize).map(|n| *n as usize);
    let mut touched = vec![false; skin.nodes.len()];
    for (t, corners) in skin.triangles.iter().enumerate() {
        if has(own, t) {
            for at in corners.iter().filter_map(node) {
                touched[at] = true;
            }
        }
    }
    let near = |corners: &[u32; 3]| corners.iter().filter_map(node).any(|at| touched[at]);
    let list = skin.triangles.iter().enumerate();
    list.map(|(t, corners)| near(corners) && tracts.iter().any(|tract| has(tract, t)))
        .collect()
}

/// The triangles of a tract that lie further than `margin` from where no tract is: at the rim of the plumage the feathers are short.
fn within(skin: &SkinMesh, tracts: &[DownTract], own: &DownTract, margin: f32) -> Vec<bool> {
    let feathered = |t: usize| tracts.iter().any(|g| g.triangles.get(t) == Some(&true));
    let mut sides = vec![(false, false); skin.nodes.len()];
    let node = |v: &u32| skin.node_of.get(*v as usize).map(|n| *n as usize);
    for (t, corners) in skin.triangles.iter().enumerate() {
        let inside = feathered(t);
        for side in corners.iter().filter_map(node) {
            if let Some(side) = sides.get_mut(side) {
                if inside { side.0 = true } else { side.1 = true }
            }
        }
    }
    let rim: Vec<Vec3> = sides
        .iter()
        .zip(&skin.nodes)
        .filter(|((inside, outside), _)| *inside && *outside)
        .map(|(_, place)| *place)
        .collect();
    let far = |t: usize| {
        let corners = skin.triangles[t].map(|v| skin.positions[v as usize]);
        rim.iter().all(|p| {
            corners
                .iter()
                .all(|c| c.distance_squared(*p) >= margin * margin)
        })
    };
    let count = skin.triangles.len();
    (0..count)
        .map(|t| own.triangles.get(t) == Some(&true) && far(t))
        .collect()
}

enum Stage {
    /// Never needed yet: it holds no memory.
    Idle,
    Busy(Task<Result<Grown, String>>),
    Grown(Entity),
    Failed,
}

/// The down of one tract.
struct Tract {
    down: Handle<Down>,
    drawn: bool,
    stage: Stage,
}

/// The down of a bird, on its card mesh; one entry for each of [`DownTracts::tracts`].
#[derive(Component)]
pub(super) struct BirdDown(Vec<Tract>);

/// Gives every groomed bird its tracts.
pub(super) fn prepare_tracts(
    mut commands: Commands,
    server: Res<AssetServer>,
    grooms: Res<Assets<Groom>>,
    birds: Query<(Entity, &DownTracts, &PlumageCards, Option<&FeathersOf>), Without<BirdDown>>,
) {
    for (entity, down, cards, of) in &birds {
        let Some(groom) = grooms.get(&cards.groom) else {
            continue;
        };
        let base = server.get_path(cards.groom.id());
        let tract = |tract: &DownTract| {
            let link = groom.regions.get(tract.region)?.down.as_ref()?;
            let down = link.load(&server, base.as_ref());
            Some(Tract {
                down,
                drawn: false,
                stage: Stage::Idle,
            })
        };
        let tracts: Option<Vec<Tract>> = down.tracts.iter().map(tract).collect();
        if let Some(tracts) = tracts {
            commands.entity(entity).insert(BirdDown(tracts));
            let owner = FeathersOf::owner(of, entity);
            commands.entity(owner).try_insert(UndercoatState {
                ready: true,
                ..default()
            });
        }
    }
}

fn fail(commands: &mut Commands, state: &mut UndercoatState, owner: Entity, message: String) {
    error!("undercoat of {owner}: {message}");
    state.error = Some(message.clone());
    commands.trigger(UndercoatFailed {
        entity: owner,
        error: message,
    });
}

/// Decides for every tract, grows what is wanted for the first time, shows and hides the rest.
pub(super) fn update_tracts(
    mut commands: Commands,
    settings: Res<UndercoatSettings>,
    downs: Res<Assets<Down>>,
    mut bakes: ResMut<Bakes>,
    mut assets: CoatAssets,
    ruffles: Query<&Ruffle>,
    own: Query<&UndercoatQuality>,
    mut birds: Query<(
        Entity,
        &mut BirdDown,
        &DownTracts,
        &PlumageCards,
        Option<&FeathersOf>,
    )>,
    mut states: Query<&mut UndercoatState>,
    mut shown: Query<&mut Visibility>,
    coats: Query<&MeshMaterial3d<UndercoatMaterial>>,
) {
    for (entity, mut tracts, down_tracts, cards, of) in &mut birds {
        let owner = FeathersOf::owner(of, entity);
        let ruffle = ruffles.get(owner).ok();
        let settings = own.get(owner).map_or(*settings, |own| own.0);
        let Ok(mut state) = states.get_mut(owner) else {
            continue;
        };
        let mut drawn = 0;
        let mut busy = false;
        for (tract, place) in tracts.0.iter_mut().zip(down_tracts.tracts.iter()) {
            let raised = ruffle.zip(cards.regions.get(place.region));
            let lift = raised.map_or(0.0, |(ruffle, region)| RUFFLE_LIFT * ruffle.share(region));
            tract.drawn = draws_down(place.cover, lift, settings.skip_error, tract.drawn);
            match &mut tract.stage {
                Stage::Failed => {}
                Stage::Idle if !tract.drawn => {}
                Stage::Grown(entity) => {
                    let wanted = if tract.drawn {
                        Visibility::Inherited
                    } else {
                        Visibility::Hidden
                    };
                    if let Ok(mut visibility) = shown.get_mut(*entity) {
                        visibility.set_if_neq(wanted);
                    }
                    if let Ok(coat) = coats.get(*entity) {
                        let share = shown_share(place.cover, lift, settings.skip_error);
                        assets.show(coat, share);
                    }
                    drawn += u32::from(tract.drawn);
                }
                Stage::Idle => {
                    busy = true;
                    let Some(down) = downs.get(&tract.down) else {
                        continue;
                    };
                    match bakes.get(tract.down.id(), down, &mut assets.images) {
                        None => {}
                        Some(Err(message)) => {
                            fail(&mut commands, &mut state, owner, message);
                            tract.stage = Stage::Failed;
                        }
                        Some(Ok(_)) => {
                            let down = down.clone();
                            let skin = down_tracts.skin.clone();
                            let all = down_tracts.tracts.clone();
                            let region = place.region;
                            let pool = AsyncComputeTaskPool::get_or_init(TaskPool::new);
                            tract.stage = Stage::Busy(pool.spawn(async move {
                                let own = all.iter().find(|tract| tract.region == region);
                                let own = own.ok_or_else(String::new)?;
                                let hidden = is_hidden(own.cover);
                                let shape = ShellShape {
                                    height: 1.0e-3 * down.thickness_mm,
                                    world_scale: 1.0,
                                    tile: down.tile_metres(),
                                    lay: Vec3::from(down.lay),
                                    offset: Vec2::ZERO,
                                    sunk: hidden,
                                };
                                let inner = if hidden {
                                    within(&skin, &all, own, 2.0 * shape.height)
                                } else {
                                    with_seam(&skin, &all, own)
                                };
                                let chosen = |t: usize| inner.get(t) == Some(&true);
                                let shell =
                                    PackedShell::build(&skin, chosen, Some(&own.lay), &shape)
                                        .map_err(|error| error.to_string())?;
                                Ok(Grown::volume(shell))
                            }));
                        }
                    }
                }
                Stage::Busy(task) => {
                    busy = true;
                    let Some(result) = block_on(poll_once(task)) else {
                        continue;
                    };
                    tract.stage = Stage::Failed;
                    let Some(down) = downs.get(&tract.down) else {
                        continue;
                    };
                    let Some(Ok(baked)) = bakes.get(tract.down.id(), down, &mut assets.images)
                    else {
                        tract.stage = Stage::Idle;
                        continue;
                    };
                    match result {
                        Ok(grown) => {
                            let spawner = ShellSpawner {
                                owner: entity,
                                skin: entity,
                                down,
                                baked: &baked,
                                coat: &Undercoat::default(),
                                strands: None,
                                settings: &settings,
                                place: if is_hidden(place.cover) {
                                    CoatPlace::Sunk
                                } else {
                                    CoatPlace::OnSkin
                                },
                            };
                            let coat = spawner.spawn(&mut commands, &mut assets, grown, &mut state);
                            if let Some(coat) = coat {
                                tract.stage = Stage::Grown(coat);
                            }
                        }
                        Err(message) => {
                            fail(&mut commands, &mut state, owner, message);
                        }
                    }
                }
            }
        }
        let ready = !busy;
        if ready && !state.ready {
            commands.trigger(UndercoatReady { entity: owner });
        }
        if state.drawn != drawn || state.ready != ready {
            (state.drawn, state.ready) = (drawn, ready);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The color comes in only where the down is drawn already, so that drawing it shows nothing at first.
    #[test]
    fn down_shows_its_color_as_feathers_rise() {
        let error = 1.0 / 255.0;
        assert_eq!(shown_share(8.0, 0.0, error), 0.0);
        assert_eq!(shown_share(8.0, 0.0, 0.0), 0.0);
        assert_eq!(shown_share(3.0, 0.0, error), 1.0);
        assert!(shown_share(8.0, OPEN_LIFT, error) < 0.25);
        assert_eq!(shown_share(8.0, 0.8 * RUFFLE_LIFT, error), 1.0);
        let mut last = 0.0;
        for i in 0..=140 {
            let now = shown_share(8.0, i as f32 * 1e-1f32.to_radians(), error);
            assert!(now >= last && now - last < 0.05);
            last = now;
        }
    }

    #[test]
    fn four_feathers_hide_the_down() {
        let error = 1.0 / 255.0;
        assert!(draws_down(0.0, 0.0, error, false));
        assert!(draws_down(3.6, 0.0, error, false));
        assert!(!draws_down(4.1, 0.0, error, false));
        assert!(draws_down(4.2, 0.0, error, true));
        assert!(!draws_down(4.5, 0.0, error, true));
        // Raised feathers show it whatever their number.
        assert!(draws_down(9.0, RUFFLE_LIFT * 0.8, error, false));
        assert!(draws_down(9.0, 0.0, 0.0, false));
    }
}
