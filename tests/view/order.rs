//! Which of two feathers is seen where the lower in the coat's order lies before the upper: behind a depth prepass the upper within
//! the window, the nearer beyond it, in both modes that have one.

use bevy::{
    asset::RenderAssetUsages,
    core_pipeline::prepass::DepthPrepass,
    mesh::{Indices, PrimitiveTopology},
    prelude::*,
};
use bevy_plumage::{
    groom::{Card, CardGeometry, PlumageCards},
    maths::order::UNSETTLED_WINDOW,
    prelude::*,
};
use plumage_tests::{
    app::{SIZE, Stage},
    view::{frames, showing},
    wait,
};

const LENGTH: f32 = 0.2;
const WIDTH: f32 = 0.15;
/// Where the lowest layer is, metres to the right.
const ASIDE: f32 = 9.0;

/// The upper feather in the plane z = 0, the lower `gap` metres before it; and one of the lowest layer outside the picture.
fn spawn_two(stage: &mut Stage, gap: f32, quality: FeatherQuality) -> Entity {
    let file = "feathers/contour.feather.ron";
    let feather: Handle<Feather> = stage.app.world().resource::<AssetServer>().load(file);
    wait::until(file, || {
        stage.frame();
        let feathers = stage.app.world().resource::<Assets<Feather>>();
        feathers.get(&feather).map(|_| ())
    });
    let card = |x: f32, z: f32, layer: f32| Card {
        root: Vec3::new(x, -0.5 * LENGTH, z),
        along: Vec3::Y,
        normal: Vec3::Z,
        center: Vec3::new(x, 0.0, z),
        radius: LENGTH,
        length: LENGTH,
        width: WIDTH,
        joints: [0; 4],
        weights: [1.0, 0.0, 0.0, 0.0],
        feather: 0,
        region: 0,
        layer,
        tint: [0.5; 3],
        seed: 1,
        turn: 0.0,
        mirrored: false,
    };
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let place = |x: f32, z: f32| {
        corners.map(|[u, v]: [f32; 2]| [x + (u - 0.5) * WIDTH, (v - 0.5) * LENGTH, z])
    };
    let places = [place(0.0, 0.0), place(0.0, gap), place(ASIDE, 0.0)].concat();
    let quad = [0, 1, 2, 0, 2, 3];
    let mesh = Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::default(),
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, places)
    .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, vec![[0.0, 0.0, 1.0]; 12])
    .with_inserted_attribute(Mesh::ATTRIBUTE_TANGENT, vec![[0.0, 1.0, 0.0, -1.0]; 12])
    .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, [corners; 3].concat())
    .with_inserted_attribute(
        Mesh::ATTRIBUTE_UV_1,
        [[[0.0, 1.0]; 4], [[1.0, 0.5]; 4], [[2.0, 0.0]; 4]].concat(),
    )
    // As the groom makes it: the higher layer first.
    .with_inserted_indices(Indices::U32(
        [0, 4, 8]
            .into_iter()
            .flat_map(|first| quad.map(|at| first + at))
            .collect(),
    ));
    let geometry = [0, 4, 8].map(|first_vertex| CardGeometry {
        first_vertex,
        vertex_count: 4,
    });
    let world = stage.app.world_mut();
    let mesh = world.resource_mut::<Assets<Mesh>>().add(mesh);
    world
        .spawn((
            Transform::IDENTITY,
            Visibility::default(),
            Mesh3d(mesh),
            quality,
            PlumageCards::new(
                [
                    card(0.0, 0.0, 2.0),
                    card(0.0, gap, 1.0),
                    card(ASIDE, 0.0, 0.0),
                ],
                geometry,
                vec![feather],
            ),
        ))
        .id()
}

/// Mean of the middle of the picture: the debug view makes the upper feather white and the lower grey, so it is the brighter the more
/// of the upper is seen.
fn brightness(stage: &mut Stage) -> f32 {
    frames(stage, 4);
    let picture = stage.picture();
    let (side, half) = (SIZE as usize, SIZE as usize / 2);
    let rows = picture.chunks(side).skip(half - 12).take(16);
    let middle = rows.flat_map(|row| &row[half - 8..half + 8]);
    middle.map(|pixel| pixel[0]).sum::<f32>() / 256.0
}

/// What is drawn: metres of the lower before the upper, a depth prepass, the window, the eye behind the feathers.
struct Case {
    gap: f32,
    prepass: bool,
    open: bool,
    behind: bool,
}

fn draw(stage: &mut Stage, transparency: FeatherTransparency, case: &Case) -> f32 {
    let mut quality = showing(DebugView::Layer, transparency);
    if !case.open {
        quality.settings.order_window = 0.0;
    }
    let bird = spawn_two(stage, case.gap, quality);
    let side = if case.behind { -0.5 } else { 0.5 };
    let place = Transform::from_xyz(0.0, 0.0, side).looking_at(Vec3::ZERO, Vec3::Y);
    let camera = stage.camera;
    let mut eye = stage.app.world_mut().entity_mut(camera);
    eye.insert(place).remove::<DepthPrepass>();
    if case.prepass {
        eye.insert(DepthPrepass);
    }
    let found = brightness(stage);
    stage.app.world_mut().entity_mut(bird).despawn();
    found
}

#[test]
fn the_window_decides_near_feathers_and_depth_the_rest() {
    let Some(mut stage) = Stage::new() else {
        return;
    };
    let camera = stage.camera;
    let inside = 0.5 * UNSETTLED_WINDOW * WIDTH;
    for (msaa, transparency) in [
        (Msaa::Off, FeatherTransparency::Hashed),
        (Msaa::Sample4, FeatherTransparency::AlphaToCoverage),
    ] {
        stage.app.world_mut().entity_mut(camera).insert(msaa);
        let case = |gap, prepass, open, behind| Case {
            gap,
            prepass,
            open,
            behind,
        };
        let upper = draw(
            &mut stage,
            transparency,
            &case(-inside, false, false, false),
        );
        let lower = draw(&mut stage, transparency, &case(inside, false, false, false));
        println!("{transparency:?}: the upper {upper}, the lower {lower}");
        assert!(upper > lower + 0.03, "{transparency:?}: {upper}, {lower}");
        for (case, wanted) in [
            (case(inside, true, true, false), upper),
            (case(inside, true, false, false), lower),
            (case(inside, false, true, false), lower),
            (case(4.0 * inside, true, true, false), lower),
            // From behind the upper is the nearer, and the window is closed.
            (case(inside, true, true, true), upper),
            (case(-inside, true, true, true), lower),
            (case(-inside, true, true, false), upper),
            // In one plane the feather that is drawn last is seen: of fronts the lower, of backs, which it hides, the upper.
            (case(0.0, false, true, false), lower),
            (case(0.0, false, true, true), upper),
        ] {
            let found = draw(&mut stage, transparency, &case);
            let Case {
                gap,
                prepass,
                open,
                behind,
            } = case;
            assert!(
                (found - wanted).abs() < 0.3 * (upper - lower),
                "{transparency:?}, gap {gap}, prepass {prepass}, open {open}, behind {behind}: {found}, not {wanted}"
            );
        }
    }
}
