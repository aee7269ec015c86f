//! Which triangles a region takes.

use super::{asset::Select, skin::SkinMesh};
use bevy::math::Vec3;

/// For each triangle whether the predicate selects it. `joints` are the names of the skin's joints, `unit` the metres per
/// unit of the groom.
pub fn select_triangles(
    select: &Select,
    skin: &SkinMesh,
    joints: &[String],
    unit: f32,
) -> Vec<bool> {
    let count = skin.triangles.len();
    let each = |test: &dyn Fn(u32) -> bool| (0..count as u32).map(test).collect::<Vec<bool>>();
    match select {
        Select::All => vec![true; count],
        Select::Tract(number) => each(&|t| {
            skin.tract(t)
                .is_some_and(|tract| i64::from(tract) == i64::from(*number))
        }),
        Select::Color { color, distance } => {
            let wanted = Vec3::from_array(*color);
            each(&|t| mean_color(skin, t).is_some_and(|mean| mean.distance(wanted) <= *distance))
        }
        Select::Nearest { color, others } => each(&|t| {
            mean_color(skin, t).is_some_and(|mean| {
                let away = |color: &[f32; 3]| mean.distance_squared(Vec3::from_array(*color));
                // The smaller color takes what lies between two, so that none is two regions'.
                let nearer = |other| (away(color), color) < (away(other), other);
                others.iter().all(nearer)
            })
        }),
        Select::Joints(names) => {
            let chosen: Vec<bool> = joints.iter().map(|joint| names.contains(joint)).collect();
            each(&|t| {
                let corners = skin.triangles[t as usize]
                    .into_iter()
                    .filter_map(|v| skin.weights.get(v as usize));
                let share = corners
                    .flat_map(|(joints, weights)| joints.iter().zip(weights))
                    .filter(|(joint, _)| {
                        chosen.get(usize::from(**joint)).copied().unwrap_or(false)
                    });
                share.map(|(_, weight)| weight).sum::<f32>() > 1.5
            })
        }
        Select::Within { low, high } => {
            let (low, high) = (
                Vec3::from_array(*low) * unit,
                Vec3::from_array(*high) * unit,
            );
            each(&|t| {
                let sum = skin.triangles[t as usize]
                    .iter()
                    .fold(Vec3::ZERO, |sum, &v| sum + skin.positions[v as usize]);
                let middle = sum / 3.0;
                middle.cmpge(low).all() && middle.cmple(high).all()
            })
        }
        Select::Any(list) => combine(list, skin, joints, unit, false, |a, b| a || b),
        Select::Every(list) => combine(list, skin, joints, unit, true, |a, b| a && b),
        Select::Not(list) => combine(list, skin, joints, unit, false, |a, b| a || b)
            .into_iter()
            .map(|taken| !taken)
            .collect(),
    }
}

/// Mean color of a triangle's corners, linear RGB; `None` where the skin has none.
fn mean_color(skin: &SkinMesh, triangle: u32) -> Option<Vec3> {
    let corners = skin.triangles.get(triangle as usize)?;
    let mut sum = Vec3::ZERO;
    for vertex in corners {
        sum += Vec3::from_array(*skin.colors.get(*vertex as usize)?);
    }
    let mean = sum / 3.0;
    mean.is_finite().then_some(mean)
}

fn combine(
    list: &[Select],
    skin: &SkinMesh,
    joints: &[String],
    unit: f32,
    start: bool,
    join: fn(bool, bool) -> bool,
) -> Vec<bool> {
    list.iter()
        .fold(vec![start; skin.triangles.len()], |sum, select| {
            sum.into_iter()
                .zip(select_triangles(select, skin, joints, unit))
                .map(|(a, b)| join(a, b))
                .collect()
        })
}
