//! What an edit costs: a number of a feather re-uploads one buffer, a groom is built once and off the main thread.

use bevy::prelude::*;
use bevy::tasks::AsyncComputeTaskPool;
use bevy_plumage::anatomy::Feather;
use bevy_plumage::groom::{PlumageParts, Span};
use bevy_plumage::prelude::*;
use bevy_plumage::render::PlumageWork;
use plumage_tests::{app::Stage, view::patch_groom, wait};
use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
    time::Duration,
};

fn work(stage: &Stage) -> PlumageWork {
    *stage.app.world().resource::<PlumageWork>()
}

/// A patch of short feathers.
fn short(count: u32) -> Groom {
    let mut groom = patch_groom(count);
    if count > 1000 {
        groom.regions[0].length = Span(12.0, 12.0);
        groom.regions[0].width = Span(8.0, 8.0);
    }
    groom
}

/// A square that wears a feather made in code; its entity and the feather.
fn dress(stage: &mut Stage, count: u32) -> (Entity, Handle<Groom>) {
    let groom = stage
        .app
        .world_mut()
        .resource_mut::<Assets<Groom>>()
        .add(short(count));
    let skin = stage.spawn_skin();
    stage
        .app
        .world_mut()
        .entity_mut(skin)
        .insert(Plumage::new(groom.clone()).with_seed(3));
    stage.settle();
    (skin, groom)
}

fn worn(stage: &mut Stage) -> AssetId<Feather> {
    let mut cards = stage
        .app
        .world_mut()
        .query::<&bevy_plumage::groom::PlumageCards>();
    cards.single(stage.app.world()).unwrap().feathers[0].id()
}

#[test]
fn an_optics_slider_uploads_one_buffer_and_builds_nothing() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    dress(&mut stage, 60);
    let id = worn(&mut stage);
    let before = work(&stage);
    let picture = stage.picture();
    for step in 1..=3 {
        let mut feathers = stage.app.world_mut().resource_mut::<Assets<Feather>>();
        let mut feather = feathers.get(id).unwrap().clone();
        feather.optics.barb.longitudinal_roughness += 0.05;
        feather.optics.sheen.strength = 0.9;
        feather.albedo.share.barb = 0.2;
        feathers.insert(id, feather).unwrap();
        stage.frame();
        stage.frame();
        let now = work(&stage);
        assert_eq!(now.feather_buffers, before.feather_buffers + step);
        assert_eq!(now.albedo_textures, before.albedo_textures);
        assert_eq!(now.materials, before.materials);
    }
    let changed = stage.picture();
    let difference: f32 = picture
        .iter()
        .zip(&changed)
        .map(|(a, b)| (a[0] - b[0]).abs() + (a[1] - b[1]).abs() + (a[2] - b[2]).abs())
        .sum();
    assert!(difference > 1.0, "the edit does not show: {difference}");
}

#[test]
fn a_color_is_painted_anew_and_shows() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    dress(&mut stage, 60);
    let id = worn(&mut stage);
    let before = work(&stage);
    let mut feathers = stage.app.world_mut().resource_mut::<Assets<Feather>>();
    let mut feather = plumage_tests::shipped::feather("contour");
    feather.image = feathers.get(id).unwrap().image.clone();
    for stop in &mut feather.albedo.front.stops {
        (stop.color, stop.tint) = ([0.0, 0.9, 0.0], 0.0);
    }
    feathers.insert(id, feather).unwrap();
    stage.frames(4);
    let now = work(&stage);
    assert_eq!(now.albedo_textures, before.albedo_textures + 1);
    let sum = stage.picture().iter().fold([0.0; 3], |s: [f32; 3], p| {
        [s[0] + p[0], s[1] + p[1], s[2] + p[2]]
    });
    assert!(sum[1] > 1.3 * sum[0] && sum[1] > 1.3 * sum[2], "{sum:?}");
}

/// Keeps every thread of the pool that grooms busy until it is told to go on.
struct Busy(Arc<AtomicBool>);

impl Busy {
    fn new() -> Self {
        let pool = AsyncComputeTaskPool::get();
        let busy = Self(Arc::default());
        let caught = Arc::new(AtomicUsize::new(0));
        for _ in 0..pool.thread_num() {
            let (released, caught) = (busy.0.clone(), caught.clone());
            pool.spawn(async move {
                caught.fetch_add(1, Ordering::SeqCst);
                while !released.load(Ordering::SeqCst) {
                    std::thread::sleep(Duration::from_millis(1));
                }
            })
            .detach();
        }
        wait::until("the threads of the pool", || {
            (caught.load(Ordering::SeqCst) == pool.thread_num()).then_some(())
        });
        busy
    }
}

impl Drop for Busy {
    fn drop(&mut self) {
        self.0.store(true, Ordering::SeqCst);
    }
}

/// While no thread of the pool is free a groom makes no progress, and frames go on: nothing of it is done by the main thread. Once
/// they are free, one coat takes the place of the old one in one frame, and only that frame makes anything.
#[test]
fn a_density_slider_builds_one_groom_off_the_main_thread() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    // As many feathers as a bird has, and as short for their number; from far away, since nobody looks at them.
    let far = Transform::from_xyz(0.0, 0.0, 12.0).looking_at(Vec3::ZERO, Vec3::Y);
    let camera = stage.camera;
    stage.app.world_mut().entity_mut(camera).insert(far);
    let (skin, groom) = dress(&mut stage, 3000);
    let old = stage.app.world().get::<PlumageParts>(skin).unwrap()[0];
    let before = work(&stage);
    let busy = Busy::new();
    let mut grooms = stage.app.world_mut().resource_mut::<Assets<Groom>>();
    grooms.get_mut(&groom).unwrap().regions[0].count = 2800;
    // The edit is told in the frame after it.
    stage.frame();
    for _ in 0..20 {
        stage.frame();
        let state = stage.app.world().get::<PlumageState>(skin).unwrap();
        assert!(!state.is_ready(), "groomed without a thread of the pool");
        let output = stage.app.world().get::<PlumageParts>(skin).unwrap()[0];
        assert_eq!(output, old, "the old coat stays until the new one is there");
        assert_eq!(
            work(&stage),
            before,
            "something is made before the coat is there"
        );
    }
    drop(busy);
    let mut last = before;
    let mut working = 0;
    let mut frame = |stage: &mut Stage| {
        stage.frame();
        let now = work(stage);
        working += u32::from(now != last);
        last = now;
    };
    wait::until("the new coat", || {
        frame(&mut stage);
        let state = stage.app.world().get::<PlumageState>(skin).unwrap();
        state.is_ready().then_some(())
    });
    (0..10).for_each(|_| frame(&mut stage));
    let state = stage.app.world().get::<PlumageState>(skin).unwrap();
    assert_eq!(state.cards, 2800);
    let output = stage.app.world().get::<PlumageParts>(skin).unwrap()[0];
    assert_ne!(output, old, "the new coat is not worn");
    assert!(stage.app.world().get_entity(old).is_err(), "two coats");
    assert_eq!(working, 1, "frames that made something");
    let wanted = PlumageWork {
        materials: before.materials + 1,
        ..before
    };
    assert_eq!(
        last, wanted,
        "a coat of the same feathers makes one material"
    );
}
