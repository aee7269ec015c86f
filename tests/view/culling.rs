//! Culling: what the camera sees of a bird is drawn, wherever skeleton, wind and ruffle have put it.

use bevy::{mesh::skinning::SkinnedMesh, prelude::*};
use bevy_plumage::prelude::*;
use plumage_tests::{
    app::{SIZE, Stage},
    view::{culled, frames, orthographic, part_skin, showing, spawn_patch},
};

fn lit_share(picture: &[[f32; 3]]) -> f32 {
    let lit = picture.iter().filter(|p| p.iter().sum::<f32>() > 0.02);
    lit.count() as f32 / picture.len() as f32
}

/// Mean difference of two pictures over their mean.
fn difference(a: &[[f32; 3]], b: &[[f32; 3]]) -> f32 {
    let vector = |p: &[f32; 3]| Vec3::from_array(*p);
    let apart = a.iter().zip(b).map(|(a, b)| vector(a).distance(vector(b)));
    let all: Vec3 = a.iter().map(vector).sum();
    apart.sum::<f32>() / all.length().max(1.0e-6)
}

#[test]
fn feathers_follow_the_skeleton_to_the_edge_of_the_picture() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    let bird = spawn_patch(&mut stage, 160, Vec3::ZERO, FeatherQuality::default());
    stage.settle();
    let home = stage.picture();
    assert_eq!(culled(&mut stage), 0, "all of it is in the picture");
    // Far from the bind pose: the joint alone goes, the camera follows. The entities of skin and cards stay behind.
    let joint = stage.app.world().get::<SkinnedMesh>(bird).unwrap().joints[0];
    let camera = stage.camera;
    let far = Vec3::new(40.0, -25.0, 30.0);
    let shift = |stage: &mut Stage, entity: Entity, by: Vec3| {
        let mut transform = stage.app.world_mut().get_mut::<Transform>(entity).unwrap();
        transform.translation += by;
    };
    shift(&mut stage, joint, far);
    shift(&mut stage, camera, far);
    frames(&mut stage, 3);
    let apart = difference(&home, &stage.picture());
    assert!(apart < 0.1, "far from home the picture differs by {apart}");
    assert_eq!(culled(&mut stage), 0);
    // Sideways, step by step: what is inside the picture is drawn, what is outside is culled.
    let (mut gone, mut edges) = (Vec::new(), Vec::new());
    for _ in 0..5 {
        shift(&mut stage, camera, Vec3::X * 0.09);
        frames(&mut stage, 2);
        gone.push(culled(&mut stage));
        let picture = stage.picture();
        // The column at the edge nearest to the bird shows feathers as long as any is left.
        let edge: Vec<_> = (0..picture.len())
            .filter(|i| *i as u32 % SIZE < 4)
            .map(|i| picture[i])
            .collect();
        edges.push(lit_share(&edge));
    }
    println!("culled {gone:?}, lit at the edge {edges:?}");
    // The first three steps bring the bird to the edge and half over it, the last puts it out of the picture.
    assert!(
        edges[..3].iter().all(|lit| *lit > 0.3) && (1..160).contains(&gone[2]),
        "feathers vanish at the edge: {gone:?} {edges:?}"
    );
    assert!(
        lit_share(&stage.picture()) == 0.0,
        "feathers that are not there"
    );
    assert!(gone.windows(2).all(|pair| pair[0] <= pair[1]), "{gone:?}");
    assert_eq!(
        *gone.last().unwrap(),
        160,
        "nothing is in the picture: {gone:?}"
    );
    assert!(gone.iter().any(|n| (20..150).contains(n)), "{gone:?}");
}

/// Feathers whose roots are above the picture hang into it. What an orthographic camera sees of them is, to the pixel, what it
/// sees from higher up and farther right, where the roots are in the picture: lying still, bent by wind and ruffle, and where joints have parted
/// between root and tip.
#[test]
fn feathers_rooted_outside_reach_into_the_picture() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    let camera = stage.camera;
    let cards = showing(DebugView::Card, FeatherTransparency::Hashed);
    let bird = spawn_patch(&mut stage, 60, Vec3::ZERO, cards);
    stage
        .app
        .world_mut()
        .entity_mut(camera)
        .insert((orthographic(), Msaa::Off));
    stage.settle();
    let place = |stage: &mut Stage, rows: usize, columns: usize| {
        let mut at = stage.app.world_mut().get_mut::<Transform>(camera).unwrap();
        let pixel = 0.12 / SIZE as f32;
        at.translation.x = -pixel * columns as f32;
        at.translation.y = -pixel * rows as f32;
        frames(stage, 3);
    };
    let mut before: Option<Vec<[f32; 3]>> = None;
    for state in ["still", "wind and ruffle", "parted joints"] {
        match state {
            "wind and ruffle" => {
                stage.app.insert_resource(Wind {
                    gusts: 0.0,
                    ..Wind::new(Vec3::new(0.2, 1.0, 0.3), 6.0)
                });
                let regions = vec![("all".into(), 0.7)];
                let ruffle = Ruffle {
                    regions,
                    ..default()
                };
                stage.app.world_mut().entity_mut(bird).insert(ruffle);
            }
            "parted joints" => {
                stage.app.insert_resource(Wind::default());
                stage.app.world_mut().entity_mut(bird).remove::<Ruffle>();
                let second = part_skin(&mut stage, bird);
                stage.frame();
                stage.settle();
                let mut at = stage.app.world_mut().get_mut::<Transform>(second).unwrap();
                at.translation.y = -0.04;
            }
            _ => {}
        }
        place(&mut stage, 0, 0);
        let home = stage.picture();
        assert!(lit_share(&home) > 0.2, "{state}: {}", lit_share(&home));
        let new = before.is_none_or(|before| difference(&before, &home) > 0.1);
        assert!(new, "{state} changes nothing");
        for (rows, columns, least) in [(16, 0, 0), (32, 0, 1), (48, 64, 20)] {
            place(&mut stage, rows, columns);
            let gone = culled(&mut stage);
            let moved = stage.picture();
            // What both pictures show.
            let side = SIZE as usize;
            let (mut a, mut b) = (Vec::new(), Vec::new());
            for row in 0..side - rows {
                a.extend(&home[(row + rows) * side..][..side - columns]);
                b.extend(&moved[row * side + columns..][..side - columns]);
            }
            let apart = difference(&a, &b);
            println!("{state}, {rows} rows lower: {gone} culled, {apart} apart");
            assert!(gone >= least, "{state}: only {gone} are outside");
            assert!(apart < 0.02, "{state}: {rows} rows lower {apart} differ");
        }
        before = Some(home);
    }
}
