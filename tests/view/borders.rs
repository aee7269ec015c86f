//! A card that goes from one class to another does not jump: dolly, pan and turn through every border, the mean of the card as shown.

use bevy::{color::ColorToComponents, prelude::*};
use bevy_plumage::{CARD_COUNTERS, PlumageCards, prelude::*};
use plumage_tests::{
    app::Stage,
    view::{counts, frames, spawn_patch},
};

/// Largest step of the mean of a card, of 255.
const STEP: f32 = 1.0;
/// Metres from the card: from all of it in a few pixels to barbules wider than one.
const DISTANCES: [f32; 2] = [1.2, 0.016];
/// Between two places at which the class is asked for.
const COARSE: f32 = 1.12;
/// Between two pictures.
const FINE: f32 = 1.01;
/// The card.
const PLACE: Vec3 = Vec3::ZERO;

struct OneCard {
    stage: Stage,
    bird: Entity,
    center: Vec3,
}

/// Where the camera is, from the card, and how the card is turned.
#[derive(Clone, Copy, Debug)]
struct Pose {
    eye: Vec3,
    turn: f32,
}

impl Pose {
    fn at(distance: f32) -> Self {
        Self {
            eye: distance * Vec3::Z,
            turn: 0.0,
        }
    }
}

fn quality(settings: FeatherSettings) -> FeatherQuality {
    FeatherQuality {
        settings,
        ..default()
    }
}

/// What has no borders where the usual settings have them: light in fragments, and evaluators that change elsewhere.
fn without_borders() -> FeatherSettings {
    FeatherSettings {
        light_budget: 0.0,
        error_budget: 0.0005,
        ..default()
    }
}

impl OneCard {
    fn new() -> Option<Self> {
        let mut stage = Stage::new()?;
        let bird = spawn_patch(&mut stage, 1, PLACE, quality(default()));
        stage.settle();
        let mut cards = stage.app.world_mut().query::<&PlumageCards>();
        let center = cards.single(stage.app.world()).ok()?.cards[0].center;
        Some(Self {
            stage,
            bird,
            center,
        })
    }

    fn set(&mut self, settings: FeatherSettings) {
        let mut bird = self.stage.app.world_mut().entity_mut(self.bird);
        bird.insert(quality(settings));
        frames(&mut self.stage, 3);
    }

    /// The camera looks along -z all the time, so that a pan moves the card over the picture.
    fn pose(&mut self, pose: Pose) {
        let (camera, bird, center) = (self.stage.camera, self.bird, self.center);
        let world = self.stage.app.world_mut();
        let turn = Quat::from_rotation_y(pose.turn);
        world
            .entity_mut(bird)
            .insert(Transform::from_rotation(turn).with_translation(center - turn * center));
        world.entity_mut(camera).insert((
            Transform::from_translation(center + pose.eye),
            Projection::Perspective(PerspectiveProjection {
                near: 0.002,
                ..default()
            }),
        ));
    }

    fn class(&mut self, pose: Pose) -> &'static str {
        self.pose(pose);
        let counts = counts(&mut self.stage);
        let class = counts.iter().position(|count| *count > 0);
        CARD_COUNTERS[class.expect("a card")]
    }

    /// Mean of the card as shown, of 255.
    fn mean(&mut self, pose: Pose) -> Vec3 {
        self.pose(pose);
        frames(&mut self.stage, 1);
        let picture = self.stage.picture();
        let shown = |c: &[f32; 3]| Color::linear_rgb(c[0], c[1], c[2]).to_srgba();
        let card: Vec<Vec3> = picture
            .iter()
            .map(|c| shown(c).to_vec3())
            .filter(|c| c.max_element() > 0.0)
            .collect();
        assert!(!card.is_empty(), "{pose:?}: no card");
        255.0 * card.iter().sum::<Vec3>() / card.len() as f32
    }

    /// Largest change, from one pose to the next, of what `settings` make of the card against pictures without borders there.
    fn largest_step(&mut self, settings: FeatherSettings, path: &[Pose]) -> f32 {
        let mut means = [settings, without_borders()].map(|settings| {
            self.set(settings);
            path.iter().map(|pose| self.mean(*pose)).collect::<Vec<_>>()
        });
        let truth = means[1].clone();
        let off = means[0].iter_mut().zip(truth);
        let off: Vec<Vec3> = off.map(|(shown, truth)| *shown - truth).collect();
        let steps = off.windows(2).map(|w| (w[1] - w[0]).abs().max_element());
        steps.fold(0.0, f32::max)
    }

    /// The borders on the way to the card: classes, and distances on both sides.
    fn borders(&mut self, settings: FeatherSettings) -> Vec<([&'static str; 2], [f32; 2])> {
        self.set(settings);
        let mut found = Vec::new();
        let mut distance = DISTANCES[0];
        let mut class = self.class(Pose::at(distance));
        while distance > DISTANCES[1] {
            let next = distance / COARSE;
            let there = self.class(Pose::at(next));
            if there != class {
                found.push(([class, there], [distance, next]));
            }
            (distance, class) = (next, there);
        }
        found
    }
}

#[test]
fn a_dolly_through_every_border_makes_no_step() {
    let Some(mut card) = OneCard::new() else {
        return;
    };
    let settings = FeatherSettings::default();
    let borders = card.borders(settings);
    let crossed: Vec<_> = borders.iter().map(|(classes, _)| *classes).collect();
    assert_eq!(
        crossed,
        [["mean", "lit"], ["lit", "far"], ["far", "mixed"]],
        "classes on the way"
    );
    for (classes, [from, to]) in borders {
        let mut path = Vec::new();
        // A card fades into LIT beyond the border, too.
        let mut distance = from * COARSE;
        while distance > to / COARSE {
            path.push(Pose::at(distance));
            distance /= FINE;
        }
        let step = card.largest_step(settings, &path);
        println!("dolly, {classes:?} at {from:.3} to {to:.3} m: {step:.2} of 255");
        assert!(step <= STEP, "{classes:?}: {step} of 255");
    }
}

#[test]
fn a_pan_and_a_turn_through_a_border_make_no_step() {
    let Some(mut card) = OneCard::new() else {
        return;
    };
    // Off the middle of the picture a pixel spans less of the card.
    let settings = FeatherSettings::default();
    for (classes, [from, to]) in card.borders(settings) {
        let path = |distance: f32| -> Vec<Pose> {
            let aside = |i| Vec3::new(0.012 * i as f32 * distance, 0.0, distance);
            (0..24)
                .map(|i| Pose {
                    eye: aside(i),
                    turn: 0.0,
                })
                .collect()
        };
        let step = card.largest_step(settings, &path(0.5 * (from + to)));
        println!("pan, {classes:?}: {step:.2} of 255");
        assert!(step <= STEP, "{classes:?}: {step} of 255");
    }
    // A card turned away from the eye is no longer lit at its vertices.
    let settings = FeatherSettings {
        light_budget: 0.001,
        ..default()
    };
    let distance = 0.3;
    let turned = |turn| Pose {
        turn,
        ..Pose::at(distance)
    };
    card.set(settings);
    let classes = [0.0, 1.44].map(|turn| card.class(turned(turn)));
    assert_eq!(classes, ["lit", "mean"], "classes of the turn");
    let path: Vec<Pose> = (0..73).map(|i| turned(0.02 * i as f32)).collect();
    let step = card.largest_step(settings, &path);
    println!("turn, {classes:?}: {step:.2} of 255");
    assert!(step <= STEP, "turn: {step} of 255");
}
