//! The groom of a mesh that nobody has groomed.

use super::{
    asset::{Groom, Region, Segments, Select, Span, Tint},
    select::select_triangles,
    skin::SkinMesh,
};
use bevy::{
    color::{LinearRgba, Srgba},
    math::Vec3,
};
use std::collections::BTreeMap;

/// Length of a feather over the diagonal of the mesh.
const LENGTH: f32 = 0.04;
/// Shortest feather of a small region, over the length of the others.
const SHORTEST: f32 = 0.35;
/// Width over length.
const WIDTH: f32 = 0.55;
/// Area of all feathers over that of the skin.
const COVER: f32 = 8.0;
/// Most feathers; beyond it they are larger instead.
const MOST: f32 = 12_000.0;
/// Most regions of one kind.
const MOST_REGIONS: usize = 48;
/// How far joints bend, degrees.
const BEND: f32 = 60.0;
/// Smallest share of the skin that makes a region.
const SMALLEST: f32 = 0.004;
/// Color where the mesh has none, sRGB.
const NEUTRAL: [f32; 3] = [0.50, 0.41, 0.32];

/// A part of the skin with one look.
struct Part {
    name: String,
    select: Select,
    area: f32,
    color: [f32; 3],
}

impl Groom {
    /// A groom for any skin, which a [`super::Plumage`] without a groom of its own gets. `joints` are the names of the skin's joints.
    ///
    /// Regions are taken from the first of these that the mesh has: tract numbers (a second set of texture coordinates whose x
    /// are whole numbers), vertex colors (2 to 48 of them), joints with names of their own, or nothing: one region. Feathers take their
    /// colors from the skin (`skin_color`); the tint is that of the vertex colors, if there are any. What none of them takes is a region too. Feathers are 0.04 of the mesh's diagonal long, shorter on small regions
    /// (thin limbs), about eight layers deep, at most 12,000, and more where bent joints stretch the skin; they lie towards -z and -y (glTF: backwards and down).
    pub fn fallback(skin: &SkinMesh, joints: &[String]) -> Self {
        let corners = || {
            skin.triangles
                .iter()
                .flatten()
                .filter_map(|v| skin.positions.get(*v as usize))
        };
        let low = corners().copied().fold(Vec3::INFINITY, Vec3::min);
        let high = corners().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
        let size = (high - low).length();
        // Lengths are in thousandths of the mesh's size.
        let unit = if size.is_finite() {
            (size * 1.0e-3).clamp(1.0e-9, 1.0e9)
        } else {
            1.0
        };
        let parts = parts(skin, joints);
        let longest = LENGTH * 1000.0;
        let shape = |part: &Part| {
            let length =
                (0.6 * part.area.max(0.0).sqrt() / unit).clamp(SHORTEST * longest, longest);
            let wanted = COVER * part.area / (unit * unit * WIDTH * length * length);
            (length, wanted)
        };
        let total: f32 = parts.iter().map(|part| shape(part).1).sum();
        let larger = (total / MOST).max(1.0);
        let region = |part: Part| {
            let (length, wanted) = shape(&part);
            let length = length * larger.sqrt();
            let count = (wanted / larger).round().clamp(1.0, MOST) as u32;
            Region {
                select: part.select,
                count,
                length: Span(length, length),
                width: Span(WIDTH * length, WIDTH * length),
                lift: Span(12.0, 12.0),
                camber: 0.06,
                curl: 6.0,
                stiffness: 0.2,
                layer: 1.0,
                segments: Segments::new(4, 2),
                tint: Tint(part.color, part.color),
                skin_color: 1.0,
                ..Region::new(part.name)
            }
        };
        Self {
            name: "fallback".into(),
            unit,
            feathers: vec!["feathers/contour.feather.ron".into()],
            regions: parts.into_iter().map(region).collect(),
            bend: BEND,
            ..Self::default()
        }
    }
}

fn parts(skin: &SkinMesh, joints: &[String]) -> Vec<Part> {
    let found = by_tract(skin)
        .or_else(|| by_color(skin))
        .or_else(|| by_joint(skin, joints))
        .unwrap_or_default();
    let all: f32 = skin.areas.iter().sum();
    let taken: f32 = found.iter().map(|part| part.area).sum();
    let mut parts = found;
    if parts.is_empty() {
        return vec![Part {
            name: "all".into(),
            select: Select::All,
            area: all,
            color: NEUTRAL,
        }];
    }
    // A thin remainder is left to the feathers around it.
    if all - taken > SMALLEST * all {
        let rest = parts.iter().map(|part| part.select.clone()).collect();
        let color = parts
            .iter()
            .max_by(|a, b| a.area.total_cmp(&b.area))
            .map_or(NEUTRAL, |part| part.color);
        parts.push(Part {
            name: "rest".into(),
            select: Select::Not(rest),
            area: all - taken,
            color,
        });
    }
    parts
}

/// Sums areas by a key of each triangle; `None` if there are too many kinds, or only one.
fn areas<K: Ord>(skin: &SkinMesh, key: impl Fn(u32) -> Option<K>) -> Option<BTreeMap<K, f32>> {
    let mut sums = BTreeMap::new();
    for (triangle, area) in skin.areas.iter().enumerate() {
        if let Some(key) = key(triangle as u32) {
            *sums.entry(key).or_insert(0.0) += area;
        }
        if sums.len() > 4096 {
            return None;
        }
    }
    let least = SMALLEST * skin.areas.iter().sum::<f32>();
    sums.retain(|_, area| *area > least);
    (2..=MOST_REGIONS).contains(&sums.len()).then_some(sums)
}

fn by_tract(skin: &SkinMesh) -> Option<Vec<Part>> {
    let whole = |value: f32| value >= 0.0 && (value - value.round()).abs() < 1.0e-3;
    let numbers = (0..skin.positions.len()).map(|vertex| skin.vertex_tract(vertex));
    if !numbers.into_iter().all(|number| number.is_some_and(whole)) {
        return None;
    }
    let parts = areas(skin, |triangle| {
        skin.tract(triangle).and_then(|n| u32::try_from(n).ok())
    })?;
    let part = |(number, area)| Part {
        name: format!("tract {number}"),
        select: Select::Tract(number),
        area,
        color: NEUTRAL,
    };
    Some(parts.into_iter().map(part).collect())
}

fn by_color(skin: &SkinMesh) -> Option<Vec<Part>> {
    if skin.colors.is_empty() {
        return None;
    }
    let mean = |triangle: u32| {
        let corners = skin.triangles.get(triangle as usize)?;
        let sum = corners
            .iter()
            .filter_map(|v| skin.colors.get(*v as usize))
            .fold(Vec3::ZERO, |sum, c| sum + Vec3::from_array(*c));
        let mean = sum / 3.0;
        mean.is_finite()
            .then_some(mean.clamp(Vec3::ZERO, Vec3::ONE))
    };
    let srgb = |linear: Vec3| {
        let color = Srgba::from(LinearRgba::rgb(linear.x, linear.y, linear.z));
        [color.red, color.green, color.blue]
    };
    // Five levels of each channel, as the eye sees them.
    let key = |triangle: u32| mean(triangle).map(|c| srgb(c).map(|x| (x * 4.0).round() as u8));
    let kinds = areas(skin, key)?;
    let centers: Vec<Vec3> = kinds
        .keys()
        .map(|kind| {
            let (mut sum, mut total) = (Vec3::ZERO, 0.0);
            for (triangle, area) in skin.areas.iter().enumerate() {
                if key(triangle as u32).as_ref() == Some(kind)
                    && let Some(color) = mean(triangle as u32)
                {
                    sum += color * *area;
                    total += area;
                }
            }
            sum / f32::max(total, f32::MIN_POSITIVE)
        })
        .collect();
    // Every triangle to the color nearest to it, so that none stays bare between two kinds.
    let mut parts: Vec<Part> = Vec::with_capacity(centers.len());
    for (number, color) in centers.iter().enumerate() {
        let others = centers.iter().filter(|other| *other != color);
        let select = Select::Nearest {
            color: color.to_array(),
            others: others.map(|c| c.to_array()).collect(),
        };
        let taken = select_triangles(&select, skin, &[], 1.0);
        let area = skin.areas.iter().zip(&taken).filter(|(_, taken)| **taken);
        parts.push(Part {
            name: format!("color {number}"),
            select,
            area: area.map(|(area, _)| area).sum(),
            color: srgb(*color),
        });
    }
    Some(parts)
}

fn by_joint(skin: &SkinMesh, joints: &[String]) -> Option<Vec<Part>> {
    let mut names = joints.to_vec();
    names.sort_unstable();
    let named = names.windows(2).all(|pair| pair[0] != pair[1]);
    if skin.weights.is_empty() || !named || names.first().is_none_or(String::is_empty) {
        return None;
    }
    let parts = areas(skin, |triangle| {
        let mut shares = BTreeMap::<u16, f32>::new();
        for vertex in skin.triangles.get(triangle as usize)? {
            let (joints, weights) = skin.weights.get(*vertex as usize)?;
            for (joint, weight) in joints.iter().zip(weights) {
                *shares.entry(*joint).or_default() += weight;
            }
        }
        let carried = shares.into_iter().find(|(_, share)| *share > 1.5);
        carried.and_then(|(joint, _)| joints.get(usize::from(joint)).cloned())
    })?;
    let part = |(name, area): (String, f32)| Part {
        select: Select::Joints(vec![name.clone()]),
        name,
        area,
        color: NEUTRAL,
    };
    Some(parts.into_iter().map(part).collect())
}
