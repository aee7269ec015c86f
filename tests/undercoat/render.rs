//! Coats as an app draws them: on closed and open skins, with seams and joints, taken off and put on again, twice in one scene.
//! Small pictures on whatever adapter there is.

use bevy::prelude::*;
use bevy_plumage::prelude::*;
use plumage_tests::app::Stage;
use plumage_tests::scene::{
    Picture, brightness, covered, difference, dress, golden, holes, settle, spawn, spawn_tube,
    torus,
};

fn state(stage: &Stage, entity: Entity) -> UndercoatState {
    stage
        .app
        .world()
        .get::<UndercoatState>(entity)
        .unwrap()
        .clone()
}

#[test]
fn coats_grow_on_closed_and_open_skins() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    let cube = Mesh::from(Cuboid::from_length(0.12));
    for (name, mesh, walls) in [
        ("torus", torus(), 0),
        ("holes", holes(), 4 * 8 + 4 * 4),
        // Its sides do not share a vertex, but they share a skin.
        ("cube", cube, 0),
    ] {
        let entity = spawn(&mut stage, mesh, Transform::default());
        stage.frames(3);
        let bare = stage.picture();
        dress(&mut stage, entity);
        let coat = stage.picture();
        golden(&format!("down_{name}"), &coat);
        assert_eq!(state(&stage, entity).walls, walls, "{name}");
        // Pale down over a dark skin, over all of it and beyond its rim.
        let (skin, fur) = (covered(&bare, 0.004), covered(&coat, 0.02));
        assert!(fur as f32 > 1.05 * skin as f32, "{name}: {skin} to {fur}");
        assert!(
            brightness(&coat) > 2.0 * brightness(&bare),
            "{name}: {} to {}",
            brightness(&bare),
            brightness(&coat)
        );
        // Inside the outline no ray is lost: no pixel is darker than the darkest skin.
        let mut holes = 0;
        for (before, after) in bare.iter().zip(&coat) {
            let lit = before.iter().sum::<f32>() > 0.012;
            holes +=
                usize::from(lit && after.iter().sum::<f32>() < 0.5 * before.iter().sum::<f32>());
        }
        assert_eq!(holes, 0, "{name}");

        // Taken off and put on again.
        stage
            .app
            .world_mut()
            .entity_mut(entity)
            .remove::<Undercoat>();
        stage.frames(3);
        assert!(difference(&stage.picture(), &bare) < 1e-6, "{name}");
        dress(&mut stage, entity);
        assert!(difference(&stage.picture(), &coat) < 1.5 / 255.0, "{name}");
        // Both in one frame.
        let mut owner = stage.app.world_mut().entity_mut(entity);
        let undercoat = owner.take::<Undercoat>().unwrap();
        owner.insert(undercoat);
        stage.frame();
        settle(&mut stage);
        assert!(difference(&stage.picture(), &coat) < 1.5 / 255.0, "{name}");
        stage.app.world_mut().despawn(entity);
        stage.frames(3);
        assert!(brightness(&stage.picture()) < 1e-6, "{name}");
    }
}

/// Three sheets that meet at one edge are no surface there: each is walled.
#[test]
fn sheets_of_a_fan_are_walled_from_each_other() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    let mut positions = vec![[0.0, -0.08, 0.0], [0.0, 0.08, 0.0]];
    for angle in [0.4f32, 2.5, 4.6] {
        let (s, c) = angle.sin_cos();
        positions.extend([[0.09 * c, -0.08, 0.09 * s], [0.09 * c, 0.08, 0.09 * s]]);
    }
    let sheets = [2u32, 4, 6].into_iter();
    let indices = sheets.flat_map(|k| [0, 1, k, k, 1, k + 1]).collect();
    let mesh = Mesh::new(
        bevy::mesh::PrimitiveTopology::TriangleList,
        bevy::asset::RenderAssetUsages::default(),
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
    .with_inserted_indices(bevy::mesh::Indices::U32(indices))
    .with_computed_normals();
    let entity = spawn(&mut stage, mesh, Transform::default());
    stage.frames(3);
    let bare = stage.picture();
    dress(&mut stage, entity);
    // Three open sides each, and the side at the common edge.
    assert_eq!(state(&stage, entity).walls, 3 * 4);
    assert!(covered(&bare, 0.004) > 100);
    // Each sheet has its coat: nothing that was skin is darker, and the rims are furred.
    let coat = stage.picture();
    golden("down_fan", &coat);
    let (skin, fur) = (covered(&bare, 0.004), covered(&coat, 0.02));
    assert!(fur as f32 > 1.05 * skin as f32, "{skin} to {fur}");
}

#[test]
fn two_coats_in_one_scene_are_alike() {
    let Some(mut stage) = Stage::sized(192, 96) else {
        return;
    };
    let world = stage.app.world_mut();
    world
        .entity_mut(stage.camera)
        .insert(Projection::Orthographic(OrthographicProjection {
            scaling_mode: bevy::camera::ScalingMode::FixedVertical {
                viewport_height: 0.3,
            },
            ..OrthographicProjection::default_3d()
        }));
    for x in [-0.15, 0.15] {
        let entity = spawn(&mut stage, torus(), Transform::from_xyz(x, 0.0, 0.0));
        dress(&mut stage, entity);
    }
    let picture = stage.picture();
    let half = |left: bool| -> Picture {
        picture
            .chunks_exact(192)
            .flat_map(|row| if left { &row[..96] } else { &row[96..] })
            .copied()
            .collect()
    };
    let (left, right) = (half(true), half(false));
    assert!(brightness(&left) > 0.02);
    assert!(
        difference(&left, &right) < 2.5 / 255.0,
        "{}",
        difference(&left, &right)
    );
}

/// D14's skinned tube: the coat follows the joint, and no more than the half that hangs on it.
#[test]
fn a_coat_follows_its_joints() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    let (entity, upper) = spawn_tube(&mut stage);
    dress(&mut stage, entity);
    let straight = stage.picture();
    *stage.app.world_mut().get_mut::<Transform>(upper).unwrap() =
        Transform::from_rotation(Quat::from_rotation_z(-1.0));
    stage.frame();
    let bent = stage.picture();
    golden("down_tube", &bent);
    let half = |picture: &Picture, lower: bool| -> Picture {
        let rows = picture.chunks_exact(96).enumerate();
        let wanted = rows.filter(|(row, _)| if lower { *row > 68 } else { *row < 40 });
        wanted.flat_map(|(_, row)| row).copied().collect()
    };
    assert!(difference(&half(&straight, true), &half(&bent, true)) < 1.5 / 255.0);
    assert!(difference(&half(&straight, false), &half(&bent, false)) > 0.05);
    let right = |picture: &Picture| {
        let rows = picture.chunks_exact(96);
        rows.flat_map(|row| &row[64..])
            .filter(|pixel| pixel[1] > 0.02)
            .count()
    };
    assert_eq!(right(&straight), 0);
    assert!(right(&bent) > 80, "{}", right(&bent));
}

#[test]
fn a_change_of_the_down_grows_it_anew() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    let entity = spawn(&mut stage, torus(), Transform::default());
    dress(&mut stage, entity);
    let before = stage.picture();
    let handle = stage
        .app
        .world()
        .get::<Undercoat>(entity)
        .unwrap()
        .down
        .clone();
    {
        let mut downs = stage.app.world_mut().resource_mut::<Assets<Down>>();
        downs.get_mut(&handle).unwrap().tip_color = [0.9, 0.1, 0.1];
    }
    stage.frame();
    settle(&mut stage);
    let after = stage.picture();
    let green = |picture: &Picture| picture.iter().map(|pixel| pixel[1]).sum::<f32>();
    assert!(green(&after) < 0.8 * green(&before));
}

#[test]
fn strands_stand_out_of_the_coat() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    let entity = spawn(&mut stage, torus(), Transform::default());
    dress(&mut stage, entity);
    let coat = stage.picture();
    stage
        .app
        .world_mut()
        .entity_mut(entity)
        .insert(GuardStrands {
            density: 10.0,
            length_mm: 40.0,
            length_spread: 0.1,
            radius_um: 400.0,
            fade: 0.0,
            bend: 0.2,
            tip_color: [1.0, 1.0, 1.0],
            ..default()
        });
    stage.frame();
    settle(&mut stage);
    let hairy = stage.picture();
    let strands = state(&stage, entity).strands;
    // 10 for each of 2 pi 8 cm times 2 pi 3.5 cm, a little less on a faceted torus.
    assert!((10_800..11_054).contains(&strands), "{strands}");
    assert!(covered(&hairy, 0.01) > covered(&coat, 0.01) + 300);
}
