//! Light found at the vertices of distant cards: the same picture as light found in every fragment, wherever it is used.

use bevy::{
    camera::visibility::RenderLayers,
    prelude::*,
    render::settings::{WgpuSettings, WgpuSettingsPriority},
};
use bevy_plumage::{CARD_COUNTERS, prelude::*};
use plumage_tests::{
    app::Stage,
    stack::Stack,
    view::{counts, frames, mean, mean_color, rms, spawn_patch},
};

const FEATHERS: u32 = 150;

fn quality(light_budget: f32) -> FeatherQuality {
    let mut quality = FeatherQuality::default();
    quality.settings.light_budget = light_budget;
    quality
}

/// A patch of feathers from so far away that all are MEAN.
fn stage(light_budget: f32) -> Option<(Stage, Entity)> {
    let mut stage = Stage::new()?;
    let bird = spawn_patch(&mut stage, FEATHERS, Vec3::ZERO, quality(light_budget));
    stage.settle();
    Some((stage, bird))
}

/// Cards that are lit at their vertices, and MEAN ones that are not.
fn lit(stage: &mut Stage) -> [u64; 2] {
    let counts = counts(stage);
    ["lit", "mean"].map(|name| {
        let class = CARD_COUNTERS.iter().position(|known| *known == name);
        counts[class.expect("a class")]
    })
}

fn budget(stage: &mut Stage, bird: Entity, light_budget: f32) {
    let mut entity = stage.app.world_mut().entity_mut(bird);
    entity.insert(quality(light_budget));
    frames(stage, 3);
}

/// The sun from several sides, from behind and along the feathers among them.
#[test]
fn pictures_are_those_of_lit_fragments() {
    let Some((mut stage, bird)) = stage(0.1) else {
        return;
    };
    let [first, rest] = lit(&mut stage);
    assert!(
        first > 9 * rest,
        "{first} of {} cards are lit",
        first + rest
    );
    for toward in [
        [0.2, 0.4, 1.0],
        [1.0, 0.3, 0.5],
        [0.3, 1.0, 0.1],
        [0.2, 0.3, -1.0],
    ] {
        let world = stage.app.world_mut();
        let mut suns = world.query_filtered::<&mut Transform, With<DirectionalLight>>();
        for mut place in suns.iter_mut(world) {
            *place = Transform::from_translation(toward.into()).looking_at(Vec3::ZERO, Vec3::Y);
        }
        budget(&mut stage, bird, 0.1);
        let at_vertices = stage.picture();
        budget(&mut stage, bird, 0.0);
        assert_eq!(lit(&mut stage)[0], 0, "no budget, no light at vertices");
        let in_fragments = stage.picture();
        let (off, bright) = (rms(&at_vertices, &in_fragments), mean(&in_fragments));
        let energy = mean(&at_vertices) / bright;
        println!("sun at {toward:?}: {off:.5} off, mean {bright:.4}, energy {energy:.4}");
        assert!(bright > 1e-3, "nothing is lit from {toward:?}");
        assert!(off < 2.0 / 255.0, "sun at {toward:?}: {off}");
        assert!((energy - 1.0).abs() < 0.01, "sun at {toward:?}: {energy}");
    }
}

#[test]
fn a_larger_budget_takes_in_more_cards() {
    let Some((mut stage, bird)) = stage(0.1) else {
        return;
    };
    let mut before = 0;
    for light_budget in [0.0005, 0.002, 0.01, 0.1] {
        budget(&mut stage, bird, light_budget);
        let [now, rest] = lit(&mut stage);
        println!("{light_budget}: {now} lit, {rest} not");
        assert!(now >= before, "{light_budget}: {now} after {before}");
        before = now;
    }
    assert!(before > 0);
}

/// Between the corners of a quad neither the shaft nor the downy base is met.
#[test]
fn quads_are_left_to_the_fragments() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    let mut stack = Stack::new(&mut stage, 8);
    for (grid, expected) in [([4, 3], [8, 0]), ([2, 2], [0, 8])] {
        stack.grid = grid;
        stack.draw(
            &mut stage,
            Msaa::Sample4,
            FeatherTransparency::AlphaToCoverage,
            false,
        );
        assert_eq!(lit(&mut stage), expected, "{grid:?}");
    }
}

/// Of structural fibres, which barbules the eye meets first says from which color on paint shows: from behind it is the proximal ones.
#[test]
fn backs_of_structural_feathers_keep_their_dark_colors() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    let mut stack = Stack::of(&mut stage, 8, "feathers/macaw_rectrix.feather.ron");
    let camera = stage.camera;
    let mut place = *stage.app.world().get::<Transform>(camera).unwrap();
    place.translation.z *= -1.0;
    let place = place.looking_at(Vec3::ZERO, Vec3::Y);
    stage.app.world_mut().entity_mut(camera).insert(place);
    let way = FeatherTransparency::AlphaToCoverage;
    let at_vertices = mean_color(&stack.draw(&mut stage, Msaa::Sample4, way, false));
    assert_eq!(lit(&mut stage), [8, 0]);
    let world = stage.app.world_mut();
    for mut worn in world.query::<&mut FeatherQuality>().iter_mut(world) {
        worn.settings.light_budget = 0.0;
    }
    frames(&mut stage, 3);
    assert_eq!(lit(&mut stage)[0], 0);
    let in_fragments = mean_color(&stage.picture());
    println!("at vertices {at_vertices:.5?}, in fragments {in_fragments:.5?}");
    for (vertices, fragments) in at_vertices.into_iter().zip(in_fragments) {
        assert!(fragments > 1e-4 && (vertices / fragments - 1.0).abs() < 0.05);
    }
}

/// Vertices follow two directional lights that every camera sees: where there are others, no card is lit by them.
#[test]
fn other_lights_are_left_to_the_fragments() {
    let Some((mut stage, _)) = stage(0.1) else {
        return;
    };
    assert!(lit(&mut stage)[0] > 0);
    let sun = || {
        (
            DirectionalLight::default(),
            Transform::from_xyz(1.0, 1.0, 1.0),
        )
    };
    let world = stage.app.world_mut();
    let lamps = [
        world.spawn(PointLight::default()).id(),
        world.spawn(SpotLight::default()).id(),
        world.spawn(RectLight::default()).id(),
        world.spawn((sun(), RenderLayers::layer(0))).id(),
        world.spawn((sun(), children![sun()])).id(),
    ];
    for lamp in lamps {
        stage
            .app
            .world_mut()
            .entity_mut(lamp)
            .insert(Visibility::Hidden);
    }
    // For some cameras only: also while it is hidden.
    stage
        .app
        .world_mut()
        .entity_mut(lamps[3])
        .remove::<RenderLayers>();
    frames(&mut stage, 3);
    assert!(lit(&mut stage)[0] > 0, "hidden lights count");
    for (number, lamp) in lamps.into_iter().enumerate() {
        let mut shown = stage.app.world_mut().entity_mut(lamp);
        shown.insert(Visibility::Inherited);
        if number == 3 {
            shown.insert(RenderLayers::layer(0));
        }
        frames(&mut stage, 3);
        assert_eq!(
            lit(&mut stage)[0],
            0,
            "light {number} is lost on the vertices"
        );
        stage.app.world_mut().entity_mut(lamp).despawn();
        frames(&mut stage, 3);
        assert!(lit(&mut stage)[0] > 0, "light {number} has gone");
    }
}

#[test]
fn the_limits_of_webgpu_are_enough() {
    let settings = WgpuSettings {
        priority: WgpuSettingsPriority::WebGPU,
        ..default()
    };
    let Some(mut stage) = Stage::with(settings, |_| ()) else {
        return;
    };
    let bird = spawn_patch(&mut stage, FEATHERS, Vec3::ZERO, quality(0.1));
    stage.settle();
    let at_vertices = stage.picture();
    budget(&mut stage, bird, 0.0);
    let off = rms(&at_vertices, &stage.picture());
    // Not the same to the last bit: they were lit there. Such devices count nothing.
    assert!(mean(&at_vertices) > 1e-3, "nothing is drawn");
    assert!(off > 0.0 && off < 2.0 / 255.0, "{off}");
}
