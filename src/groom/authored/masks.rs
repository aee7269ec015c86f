//! Masks on the vertices of the skin.

use crate::groom::{
    error::SkinFlaw,
    mask_textures::MaskValues,
    skin::{SkinMesh, SurfacePoint},
};
use bevy::{
    ecs::prelude::*,
    math::Vec3,
    reflect::{Reflect, std_traits::ReflectDefault},
};

/// What the vertices of a mesh say about the feathers on it; a list is empty where they say nothing. On the entity of the mesh; read when
/// the feathers grow. glTF files bring it along: scalar or color attributes `_DENSITY`, `_LENGTH`, `_LIFT` and `_TRACT` (the first
/// channel counts), and `_LAY` of three numbers.
#[derive(Component, Clone, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
pub struct SkinMasks {
    /// Factor on the number of feathers, 0..4; none grow below 0.01.
    pub density: Vec<f32>,
    /// Factor on their length and width, 0.05..4.
    pub length: Vec<f32>,
    /// Degrees added to their lift, -90..90.
    pub lift: Vec<f32>,
    /// Direction of the lay, model space, any length; zero: no say.
    pub lay: Vec<[f32; 3]>,
    /// Number of the tract, 0..65535; counts before `TEXCOORD_1`.
    pub tract: Vec<f32>,
    /// Attributes of the file that nothing reads, and why where that is not plain from the name.
    pub unread: Vec<String>,
}

/// Allowed values of each mask, and what stands where there is none.
const DENSITY: (f32, f32, f32) = (0.0, 4.0, 1.0);
const LENGTH: (f32, f32, f32) = (0.05, 4.0, 1.0);
const LIFT: (f32, f32, f32) = (-90.0, 90.0, 0.0);
const TRACT: (f32, f32, f32) = (0.0, 65_535.0, 0.0);

impl SkinMesh {
    /// With masks: those of its meshes in order. What is not allowed becomes a flaw and counts as no say.
    pub fn with_masks(mut self, masks: &[SkinMasks]) -> Self {
        let mut flaws = Vec::new();
        let counts: Vec<usize> = (0..self.first_vertices.len())
            .map(|mesh| {
                let end = self.first_vertices.get(mesh + 1).copied();
                let end = end.map_or(self.positions.len(), |end| end as usize);
                end - self.first_vertices[mesh] as usize
            })
            .collect();
        let mut join = |field: &str, pick: fn(&SkinMasks) -> &Vec<f32>, allowed| {
            joined(masks, &counts, field, pick, allowed, &mut flaws)
        };
        self.masks = SkinMasks {
            density: join("_DENSITY", |masks| &masks.density, DENSITY),
            length: join("_LENGTH", |masks| &masks.length, LENGTH),
            lift: join("_LIFT", |masks| &masks.lift, LIFT),
            tract: join("_TRACT", |masks| &masks.tract, TRACT),
            lay: Vec::new(),
            unread: Vec::new(),
        };
        self.masks.lay = joined_lay(masks, &counts, &mut flaws);
        for (mesh, masks) in masks.iter().enumerate() {
            if !masks.unread.is_empty() {
                flaws.push(SkinFlaw {
                    mesh,
                    field: "attributes".into(),
                    value: masks.unread.join(", "),
                    range: "_DENSITY, _LENGTH, _LIFT, _LAY, _TRACT and what Bevy reads".into(),
                    mended: "left out",
                });
            }
        }
        self.flaws.extend(flaws);
        self
    }

    fn masked(&self, list: &[f32], point: SurfacePoint) -> Option<f32> {
        let corners = self.triangles[point.triangle as usize];
        let parts = corners.into_iter().zip(point.bary.to_array());
        parts
            .map(|(vertex, share)| Some(list.get(vertex as usize)? * share))
            .sum()
    }

    /// Factor of the masks on the number of feathers at a point, 0..4.
    pub fn mask_density(&self, point: SurfacePoint) -> f32 {
        let own = self.masked(&self.masks.density, point);
        let textures = self.textured(point, |sets| matches!(sets, MaskValues::Density(..)));
        let all = textures.fold(own.unwrap_or(DENSITY.2), |all, factor| all * factor);
        all.clamp(DENSITY.0, DENSITY.1)
    }

    /// Factor of the masks on the length of feathers at a point, 0.05..4.
    pub fn mask_length(&self, point: SurfacePoint) -> f32 {
        let own = self.masked(&self.masks.length, point);
        let textures = self.textured(point, |sets| matches!(sets, MaskValues::Length(..)));
        let all = textures.fold(own.unwrap_or(LENGTH.2), |all, factor| all * factor);
        all.clamp(LENGTH.0, LENGTH.1)
    }

    /// Degrees that the masks add to the lift of feathers at a point, -90..90.
    pub fn mask_lift(&self, point: SurfacePoint) -> f32 {
        let own = self.masked(&self.masks.lift, point);
        let textures = self.textured(point, |sets| matches!(sets, MaskValues::Lift(..)));
        let all = textures.fold(own.unwrap_or(LIFT.2), |all, degrees| all + degrees);
        all.clamp(LIFT.0, LIFT.1)
    }

    /// Nodes whose lay the mask gives, and the lay (not projected, any length).
    pub fn mask_lay(&self) -> impl Iterator<Item = (usize, Vec3)> {
        let vertices = self.masks.lay.iter().zip(&self.node_of);
        vertices
            .map(|(lay, node)| (*node as usize, Vec3::from_array(*lay)))
            .filter(|(_, lay)| *lay != Vec3::ZERO)
    }
}

/// One mask of all meshes; empty if none has it.
fn joined(
    masks: &[SkinMasks],
    counts: &[usize],
    field: &str,
    pick: fn(&SkinMasks) -> &Vec<f32>,
    (low, high, none): (f32, f32, f32),
    flaws: &mut Vec<SkinFlaw>,
) -> Vec<f32> {
    if masks.iter().all(|masks| pick(masks).is_empty()) {
        return Vec::new();
    }
    let mut list = Vec::with_capacity(counts.iter().sum());
    for (mesh, &count) in counts.iter().enumerate() {
        let own = masks.get(mesh).map_or(&[][..], |masks| pick(masks));
        if !own.is_empty() && own.len() != count {
            flaws.push(SkinFlaw::count(mesh, field, own.len(), count));
        }
        let own = if own.len() == count { own } else { &[] };
        let (mut wrong, mut first) = (0, 0.0);
        list.extend((0..count).map(|i| match own.get(i) {
            None => none,
            Some(value) if (low..=high).contains(value) => *value,
            Some(value) => {
                first = if wrong == 0 { *value } else { first };
                wrong += 1;
                if value.is_finite() {
                    value.clamp(low, high)
                } else {
                    none
                }
            }
        }));
        if wrong > 0 {
            flaws.push(SkinFlaw {
                mesh,
                field: field.into(),
                value: format!("{first} ({wrong} vertices in all)"),
                range: format!("{low} to {high}"),
                mended: "the nearest that is allowed stands in",
            });
        }
    }
    list
}

/// The lay of all meshes; empty if none has it.
fn joined_lay(masks: &[SkinMasks], counts: &[usize], flaws: &mut Vec<SkinFlaw>) -> Vec<[f32; 3]> {
    if masks.iter().all(|masks| masks.lay.is_empty()) {
        return Vec::new();
    }
    let mut list = Vec::with_capacity(counts.iter().sum());
    for (mesh, &count) in counts.iter().enumerate() {
        let own = masks.get(mesh).map_or(&[][..], |masks| &masks.lay);
        if !own.is_empty() && own.len() != count {
            flaws.push(SkinFlaw::count(mesh, "_LAY", own.len(), count));
        }
        let own = if own.len() == count { own } else { &[] };
        let sound = |lay: &&[f32; 3]| lay.iter().all(|x| x.is_finite());
        if let Some(wrong) = own.iter().find(|lay| !sound(lay)) {
            flaws.push(SkinFlaw {
                mesh,
                field: "_LAY".into(),
                value: format!("{wrong:?}"),
                range: "three finite numbers".into(),
                mended: "counts as no say",
            });
        }
        list.extend((0..count).map(|i| own.get(i).filter(sound).copied().unwrap_or_default()));
    }
    list
}
