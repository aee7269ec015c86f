//! A branch with bark, lichen and moss, as a mesh with colors.

use super::noise::{fractal, noise};
use bevy::{
    asset::RenderAssetUsages,
    mesh::{Indices, PrimitiveTopology},
    prelude::*,
};
use std::f32::consts::{PI, TAU};

/// Radius for which the bark is drawn, metres; on others it scales with them.
const TWIG: f32 = 0.022;
/// Length of a ring of the mesh, metres.
const RING: f32 = 0.0018;
/// Half of the length on which birds sit: there the branch is straight and free of knots, metres.
const SEAT: f32 = 0.22;
/// Knots: place along the branch in metres, angle around it, size.
const KNOTS: [(f32, f32, f32); 4] = [
    (-0.43, 1.2, 0.9),
    (0.38, 4.4, 0.8),
    (0.62, 2.2, 0.7),
    (-0.30, 3.6, 0.5),
];

/// What the bark is like at a place: height over the mean radius in radii, and color.
fn bark(x: f32, a: f32, size: f32) -> (f32, Vec3) {
    // Long cracks: noise stretched along the branch and bent by a slower one.
    let twist = 0.25 * noise(Vec3::new(x * 9.0 / size, 5.0, 1.0));
    let around = Vec2::from_angle(a + twist) * 3.2;
    let at =
        |along: f32, across: f32| Vec3::new(x * along / size, around.x * across, around.y * across);
    let ridge = 1.0 - (2.2 * fractal(at(26.0, 1.0), 4)).abs().min(1.0);
    let crack = ridge.powi(3).min(0.6);
    let plates = fractal(at(70.0, 2.0), 3);
    let fine = fractal(at(400.0, 9.0), 3);
    let mut height = 0.05 * noise(Vec3::new(x * 7.0 / size, 0.3, 0.2)) - 0.12 * crack
        + 0.05 * plates
        + 0.018 * fine;
    for (place, angle, knot) in KNOTS {
        let off = (a - angle).sin().atan2((a - angle).cos());
        let e = Vec2::new((x - place) / (0.9 * TWIG * size), off / 0.5).length();
        height += knot * (0.35 * (-e * e).exp() - 0.3 * (-9.0 * e * e).exp());
    }
    // Grey-brown, darker in the cracks, pale lichen, some moss above.
    let (warm, grey) = (Vec3::new(0.150, 0.110, 0.078), Vec3::new(0.27, 0.24, 0.205));
    let tone = (0.5 + 0.9 * plates + 0.6 * fine).clamp(0.0, 1.0);
    let mut color = warm.lerp(grey, tone) * (1.0 - crack);
    let patch = |along: f32, across: f32, shift: f32| {
        let p = Vec2::from_angle(a) * across;
        fractal(
            Vec3::new(x * along / size + shift, p.x, p.y + 0.2 * shift),
            4,
        )
    };
    // Lobes of lichen stand off the bark; their middle is darker than their rim.
    let lobes = patch(55.0, 2.4, 45.0) + 0.05 * fine - 0.16;
    let lichen = (lobes / 0.04).clamp(0.0, 1.0) * (1.0 - crack);
    let rim = (1.0 - (lobes / 0.12).min(1.0)) + 0.6 * fine;
    height += 0.035 * lichen * (0.7 + rim);
    color = color.lerp(
        Vec3::new(0.32, 0.345, 0.27) * (0.72 + 0.45 * rim),
        0.8 * lichen,
    );
    let moss = patch(22.0, 1.6, 40.0) + 0.25 * a.cos() - 0.24;
    let green = Vec3::new(0.085, 0.115, 0.028) * (1.1 + 0.8 * fine);
    (
        height,
        color.lerp(green, 0.8 * (moss / 0.12).clamp(0.0, 1.0)),
    )
}

/// The middle of a branch at a place along it: straight where feet stand, wavering further out.
pub fn axis(x: f32, radius: f32) -> Vec3 {
    let out = 1.1 * radius * ((x.abs() - SEAT) / 0.3).clamp(0.0, 1.0);
    Vec3::new(
        x,
        out * noise(Vec3::new(x * 4.0, 3.1, 0.5)),
        out * noise(Vec3::new(x * 4.0, 7.7, 2.5)),
    )
}

/// A branch along x about the origin.
pub fn branch(radius: f32, length: f32) -> Mesh {
    let half = 0.5 * length + radius;
    let (rings, sides) = ((2.0 * half / RING) as u32, 128_u32);
    let size = radius / TWIG;
    let (mut positions, mut colors, mut uvs) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..=rings {
        let x = half * (2.0 * i as f32 / rings as f32 - 1.0);
        let centre = axis(x, radius);
        let taper = 1.0 + 0.10 * ((x.abs() - SEAT).max(0.0) * x.signum() / half);
        let closed = ((half - x.abs()) / (2.0 * radius)).clamp(0.0, 1.0).sqrt();
        for j in 0..=sides {
            // The seam lies below.
            let a = TAU * (j % sides) as f32 / sides as f32 + PI;
            let (height, color) = bark(x, a, size);
            let r = radius * (taper + height) * closed;
            positions.push((centre + Vec3::new(0.0, a.cos(), a.sin()) * r).to_array());
            uvs.push([j as f32 / sides as f32, x]);
            colors.push(color.extend(1.0).to_array());
        }
    }
    let wide = sides + 1;
    let mut indices = Vec::with_capacity((6 * rings * sides) as usize);
    for i in 0..rings {
        for j in 0..sides {
            let a = i * wide + j;
            indices.extend([a, a + 1, a + wide, a + 1, a + wide + 1, a + wide]);
        }
    }
    Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::default(),
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
    .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, uvs)
    .with_inserted_attribute(Mesh::ATTRIBUTE_COLOR, colors)
    .with_inserted_indices(Indices::U32(indices))
    .with_computed_smooth_normals()
}
