//! Motion vectors in wind: as long, and in the direction, as the twin on the processor moves the feather from frame to frame.

use bevy::{
    camera::ScalingMode, core_pipeline::prepass::MotionVectorPrepass, prelude::*,
    render::settings::WgpuSettings,
};
use bevy_plumage::groom::PlumageCards;
use bevy_plumage::maths::wind::{wind_lift, wind_response, wind_velocity};
use bevy_plumage::prelude::*;
use plumage_tests::{
    app::{SIZE, Stage},
    feather_card::spawn_filling,
    view::{Shown, hang_sheet, showing, with_sheets},
};

/// What the sheet multiplies motion by, and the most that it can show.
const GAIN: f32 = 500.0;
const SHOWN: f32 = 0.5 / GAIN;

/// A flat card of four corners with its root at the origin, along y, facing z.
struct Flat {
    length: f32,
    width: f32,
    world: GlobalTransform,
}

impl Flat {
    /// The place in the world of the point (u, v) of the card, at a time.
    fn place(&self, wind: &Wind, [u, v]: [f32; 2], time: f32) -> Vec3 {
        let direction = |axis: Vec3| self.world.affine().transform_vector3(axis);
        // What a card of no region answers.
        let (compliance, limit) = wind_response(0.5f32);
        let lift = wind_lift(
            wind_velocity(&wind.breeze(), self.world.translation().to_array(), time),
            direction(Vec3::Y).to_array(),
            direction(Vec3::Z).to_array(),
            self.length,
            compliance,
            limit,
        );
        // The shaft bends as an arc about the axis across it, so its chord turns half as far as its tip.
        let turn = Quat::from_axis_angle(Vec3::Y.cross(Vec3::Z), 0.5 * v * lift);
        let flat = Vec3::new((u - 0.5) * self.width, v * self.length, 0.0);
        self.world.transform_point(turn * flat)
    }
}

/// Weights of the corners of a triangle at a point, all 0..1 inside.
fn weights(corners: [Vec2; 3], at: Vec2) -> Option<[f32; 3]> {
    let [a, b, c] = corners;
    let area = (b - a).perp_dot(c - a);
    let second = (at - a).perp_dot(c - a) / area;
    let third = (b - a).perp_dot(at - a) / area;
    let all = [1.0 - second - third, second, third];
    all.iter().all(|w| *w >= 0.0).then_some(all)
}

#[test]
fn motion_vectors_in_wind_are_those_of_the_twin() {
    let Some(mut stage) = Stage::with(WgpuSettings::default(), with_sheets) else {
        return;
    };
    let camera = stage.camera;
    let eye = Transform::from_xyz(0.12, -0.3, 0.3).looking_at(Vec3::ZERO, Vec3::Y);
    stage.app.world_mut().entity_mut(camera).insert((
        eye,
        Projection::Orthographic(OrthographicProjection {
            scaling_mode: ScalingMode::FixedVertical {
                viewport_height: 0.45,
            },
            near: 0.01,
            far: 2.0,
            ..OrthographicProjection::default_3d()
        }),
        Msaa::Off,
        MotionVectorPrepass,
    ));
    let owner = spawn_filling(&mut stage, "feathers/macaw_contour.feather.ron");
    let world = stage.app.world_mut();
    let solid = showing(DebugView::Normal, FeatherTransparency::Hashed);
    world.entity_mut(owner).insert(solid);
    let card = world.get::<PlumageCards>(owner).unwrap().cards[0];
    let flat = Flat {
        length: card.length,
        width: card.width,
        world: *world.get::<GlobalTransform>(owner).unwrap(),
    };
    // Against the lay, with eddies that change fast.
    let wind = Wind {
        direction: Vec3::new(-1.0, 0.1, 0.2),
        speed: 1.0,
        gusts: 2.0,
        eddy: 0.06,
        frequency: 8.0,
    };
    world.insert_resource(wind);
    hang_sheet(&mut stage, Shown::Motion);
    stage.frames(6);
    let (mut checked, mut forth, mut back) = (0, 0, 0);
    // Gusts come and go: frames with little or too much motion are passed over.
    for _ in 0..400 {
        let time = stage.app.world().resource::<Time>();
        let (now, step) = (time.elapsed_secs_wrapped() + 0.016, 0.016);
        let world = stage.app.world();
        let (lens, eye) = (
            world.get::<Camera>(camera).unwrap(),
            world.get::<GlobalTransform>(camera).unwrap(),
        );
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let seen = |time: f32| {
            corners.map(|corner| {
                let place = flat.place(&wind, corner, time);
                lens.world_to_ndc(eye, place).unwrap().truncate()
            })
        };
        let (after, before) = (seen(now), seen(now - step));
        let moved: [Vec2; 4] =
            std::array::from_fn(|k| (after[k] - before[k]) * Vec2::new(0.5, -0.5));
        let most = moved.iter().map(|m| m.length()).fold(0.0, f32::max);
        if !(0.5 * SHOWN..0.9 * SHOWN).contains(&most) {
            stage.frame();
            continue;
        }
        let picture = stage.picture();
        // 0.5 is not a step of the 8-bit picture; the background says where it lies.
        let zero = Vec2::new(picture[0][0], picture[0][1]);
        let (mut found, mut wanted, mut square, mut count) = (Vec2::ZERO, Vec2::ZERO, 0.0, 0.0);
        let mut holes = 0.0;
        for (i, pixel) in picture.iter().enumerate() {
            let (x, y) = (i as u32 % SIZE, i as u32 / SIZE);
            let at = Vec2::new(x as f32 + 0.5, SIZE as f32 - y as f32 - 0.5);
            let at = at * 2.0 / SIZE as f32 - 1.0;
            for triangle in [[0usize, 1, 2], [0, 2, 3]] {
                let Some(share) = weights(triangle.map(|k| after[k]), at) else {
                    continue;
                };
                let mix = |values: [Vec2; 3]| (0..3).map(|k| values[k] * share[k]).sum::<Vec2>();
                let uv = mix(triangle.map(|k| Vec2::from_array(corners[k])));
                // Well inside the outline, away from the root, which does not move.
                if (uv.x - 0.5).abs() > 0.15 || !(0.4..0.85).contains(&uv.y) {
                    continue;
                }
                let shown = (Vec2::new(pixel[0], pixel[1]) - zero) / GAIN;
                // A hole of the vane, through which the background is seen.
                if shown == Vec2::ZERO {
                    holes += 1.0;
                    continue;
                }
                let right = mix(triangle.map(|k| moved[k]));
                found += shown;
                wanted += right;
                square += (shown - right).length_squared();
                count += 1.0;
            }
        }
        let rms = (square / count).sqrt();
        let off = (found - wanted).length() / wanted.length();
        println!(
            "{count} pixels: mean {:?}, wanted {:?}, {:.1} % apart, RMS {rms:.2e}",
            found / count,
            wanted / count,
            100.0 * off
        );
        assert!(count > 200.0, "only {count} pixels");
        assert!(holes < 0.1 * count, "{holes} holes");
        assert!(off < 0.03, "{found} against {wanted}");
        // A step of the 8-bit picture is 1.3e-5.
        assert!(rms < 1.5e-5, "RMS {rms}");
        checked += 1;
        forth += u32::from(wanted.y > 0.0);
        back += u32::from(wanted.y < 0.0);
        if forth > 1 && back > 1 {
            break;
        }
    }
    assert!(
        forth > 1 && back > 1,
        "{checked} frames, {forth} down, {back} up"
    );
}
