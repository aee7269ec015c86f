//! Whether the coats of the scene have grown, and what became of those that have not.

use bevy::{asset::UntypedAssetLoadFailedEvent, prelude::*, time::common_conditions::on_timer};
use bevy_plumage::{PlumageCards, prelude::*};
use std::time::{Duration, Instant};

/// Wait for the rest after a file has failed to load.
const GRACE: Duration = Duration::from_secs(3);

/// Coats of feathers, down and fur in the world.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Growth {
    /// Coats that are wanted.
    pub wanted: usize,
    /// Of these, the ones that are there.
    pub grown: usize,
    /// Why the others will not come.
    pub errors: Vec<String>,
    /// Card meshes that are there, wanted by a plumage or made by hand.
    pub card_meshes: usize,
    /// Of these, the ones that wait for their material (tables of thin layers take a moment).
    pub undrawn: usize,
}

impl Growth {
    /// Counts the coats of a world.
    pub fn of(world: &mut World) -> Self {
        let mut growth = Self::default();
        for state in world.query::<&PlumageState>().iter(world) {
            growth.wanted += 1;
            growth.grown += usize::from(state.is_ready() && state.cards > 0);
            growth.errors.extend(state.error.clone());
            if state.is_ready() && state.cards == 0 {
                let bare = "a groom without a single feather (counts, masks and paint leave none)";
                growth.errors.push(bare.into());
            }
        }
        for state in world.query::<&UndercoatState>().iter(world) {
            growth.wanted += 1;
            growth.grown += usize::from(state.is_ready() && state.error.is_none());
            growth.errors.extend(state.error.clone());
        }
        type Drawn = (
            &'static PlumageCards,
            Has<MeshMaterial3d<FeatherMaterial>>,
            Has<MeshMaterial3d<StandardMaterial>>,
        );
        for (worn, full, fallback) in world.query::<Drawn>().iter(world) {
            if worn.cards.is_empty() {
                continue;
            }
            growth.card_meshes += 1;
            growth.undrawn += usize::from(!full && !fallback);
        }
        growth
    }

    /// Whether there is nothing to look at.
    pub fn is_bare(&self) -> bool {
        self.grown == 0 && self.card_meshes == 0
    }

    /// Whether every coat has grown or failed.
    pub fn is_settled(&self) -> bool {
        let settled = self.grown + self.errors.len() >= self.wanted && self.undrawn == 0;
        settled && (self.wanted > 0 || !self.is_bare())
    }
}

/// Notices files that do not load: what hangs on them never gets as far as an error of its own (the log has the reason).
#[derive(Default)]
pub struct FailedFiles(Option<Instant>);

impl FailedFiles {
    /// Whether files have failed, and what does not depend on them has had its time.
    pub fn given_up(&mut self, world: &World) -> bool {
        let messages = world.resource::<Messages<UntypedAssetLoadFailedEvent>>();
        // Without its clip a bird stands still, that is all.
        let clip = |event: &UntypedAssetLoadFailedEvent| {
            let label = event.path.label();
            label.is_some_and(|label| label.starts_with("Animation"))
        };
        if messages
            .iter_current_update_messages()
            .any(|event| !clip(event))
        {
            self.0 = Some(Instant::now());
        }
        self.0.is_some_and(|at| at.elapsed() > GRACE)
    }
}

/// In a window: says when the coats have grown, and leaves with an error code if none will.
pub struct GrowthPlugin(pub &'static str);

impl Plugin for GrowthPlugin {
    fn build(&self, app: &mut App) {
        let name = self.0;
        let (mut files, mut done) = (FailedFiles::default(), false);
        let watch = move |world: &mut World| {
            if done {
                return;
            }
            let growth = Growth::of(world);
            let given_up = files.given_up(world);
            if growth.is_bare() && (given_up || growth.is_settled()) {
                error!("{name}: no coat has grown: {}", growth.errors.join("; "));
                world.write_message(AppExit::error());
                done = true;
            } else if growth.is_settled() {
                info!("{name}: {} of {} coats grown", growth.grown, growth.wanted);
                done = true;
            }
        };
        app.add_systems(Update, watch.run_if(on_timer(Duration::from_millis(100))));
    }
}
