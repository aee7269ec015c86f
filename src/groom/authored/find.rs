//! Curves and stations below an entity with a plumage.

use super::{Authored, AuthoredGuide, AuthoredRow, AuthoredStation, SkinMasks, chains};
use crate::groom::component::{NotSkin, PlumageCards};
use bevy::{
    asset::Assets,
    ecs::{name::Name, prelude::*, system::SystemParam},
    gltf::GltfExtras,
    math::{Affine3A, Vec3},
    mesh::{Mesh, Mesh3d, PrimitiveTopology},
    prelude::Transform,
};
use serde_json::Value;

/// What an artist may have put below an entity.
#[derive(SystemParam)]
pub(in crate::groom) struct AuthoredParts<'w, 's> {
    children: Query<'w, 's, &'static Children>,
    parents: Query<'w, 's, &'static ChildOf>,
    places: Query<'w, 's, &'static Transform>,
    named: Query<'w, 's, (&'static Name, Option<&'static GltfExtras>), Without<Mesh3d>>,
    extras: Query<'w, 's, &'static GltfExtras>,
    lines: Query<'w, 's, &'static Mesh3d, (Without<PlumageCards>, Without<NotSkin>)>,
    masks: Query<'w, 's, &'static SkinMasks>,
    assets: Res<'w, Assets<Mesh>>,
}

impl AuthoredParts<'_, '_> {
    /// The masks of the meshes, in order.
    pub(in crate::groom) fn masks(&self, meshes: &[Entity]) -> Vec<SkinMasks> {
        let masks = |mesh: &Entity| self.masks.get(*mesh).cloned().unwrap_or_default();
        meshes.iter().map(masks).collect()
    }

    /// Curves and stations below `owner`, in the space of the mesh `skin`.
    pub(in crate::groom) fn find(&self, owner: Entity, skin: Entity) -> Authored {
        let to_skin = self.place(owner, skin).inverse();
        let mut authored = Authored::default();
        for entity in self.children.iter_descendants(owner) {
            if let Some(mesh) = self.curve(entity) {
                let to_skin = to_skin * self.place(owner, entity);
                let extras = self.extras_of(entity);
                let guide = |points: Vec<Vec3>| AuthoredGuide {
                    points: points
                        .into_iter()
                        .map(|point| to_skin.transform_point3(point))
                        .collect(),
                    mirror: extras.get("mirror").is_some_and(truth),
                    regions: extras.get("regions").map(words).unwrap_or_default(),
                };
                authored.guides.extend(chains(mesh).into_iter().map(guide));
            }
            if let Ok((name, extras)) = self.named.get(entity) {
                let extras = extras.map(parsed).unwrap_or_default();
                let place = to_skin * self.place(owner, entity);
                station(&mut authored.rows, name.as_str(), &extras, place);
            }
        }
        for row in &mut authored.rows {
            let count = row.stations.len().saturating_sub(1).max(1) as f32;
            for (i, station) in row.stations.iter_mut().enumerate() {
                station.at.get_or_insert(i as f32 / count);
            }
            let at = |station: &AuthoredStation| station.at.unwrap_or(0.0);
            row.stations.sort_by(|a, b| at(a).total_cmp(&at(b)));
        }
        authored
    }

    /// Entities below `owner` whose meshes are curves.
    pub(in crate::groom) fn curves(&self, owner: Entity) -> Vec<Entity> {
        let below = self.children.iter_descendants(owner);
        below
            .filter(|entity| self.curve(*entity).is_some())
            .collect()
    }

    /// The mesh of an entity, if it is made of lines.
    fn curve(&self, entity: Entity) -> Option<&Mesh> {
        let mesh = self.assets.get(&self.lines.get(entity).ok()?.0)?;
        matches!(
            mesh.primitive_topology(),
            PrimitiveTopology::LineList | PrimitiveTopology::LineStrip
        )
        .then_some(mesh)
    }

    /// From an entity's space to that of the owner, by what stands in the file: nothing may have been propagated yet.
    fn place(&self, owner: Entity, entity: Entity) -> Affine3A {
        let (mut at, mut place) = (entity, Affine3A::IDENTITY);
        while at != owner {
            if let Ok(transform) = self.places.get(at) {
                place = transform.compute_affine() * place;
            }
            let Ok(parent) = self.parents.get(at) else {
                break;
            };
            at = parent.parent();
        }
        place
    }

    /// Extras of a mesh entity or of the node that it belongs to.
    fn extras_of(&self, entity: Entity) -> Value {
        let parent = self.parents.get(entity).map(ChildOf::parent);
        let extras = self.extras.get(entity).ok();
        let extras = extras.or_else(|| self.extras.get(parent.ok()?).ok());
        extras.map(parsed).unwrap_or_default()
    }
}

fn parsed(extras: &GltfExtras) -> Value {
    serde_json::from_str(&extras.value).unwrap_or_default()
}

fn truth(value: &Value) -> bool {
    let number = value.as_f64().is_some_and(|number| number != 0.0);
    value.as_bool().unwrap_or(number)
}

/// Words of a list or of a text with commas.
fn words(value: &Value) -> Vec<String> {
    let trimmed = |text: &str| text.trim().to_owned();
    let words: Vec<String> = match value {
        Value::Array(list) => list.iter().filter_map(Value::as_str).map(trimmed).collect(),
        Value::String(text) => text.split(',').map(trimmed).collect(),
        _ => Vec::new(),
    };
    words.into_iter().filter(|word| !word.is_empty()).collect()
}

fn numbers(value: &Value) -> Vec<f32> {
    let number = |value: &Value| value.as_f64().map(|number| number as f32);
    match value {
        Value::Array(list) => list.iter().filter_map(number).collect(),
        value => number(value).into_iter().collect(),
    }
}

/// `hand_L:0.7, wing_L:0.3`; a joint without a number counts 1.
fn joints(value: &Value) -> Vec<(String, f32)> {
    let joint = |word: String| match word.rsplit_once(':') {
        Some((name, weight)) => match weight.trim().parse() {
            Ok(weight) => (name.trim().to_owned(), weight),
            Err(_) => (word, 1.0),
        },
        None => (word, 1.0),
    };
    words(value).into_iter().map(joint).collect()
}

/// Takes up a node named `row.NAME` or `row.NAME.NUMBER`.
fn station(rows: &mut Vec<AuthoredRow>, name: &str, extras: &Value, place: Affine3A) {
    let mut parts = name.splitn(3, '.');
    let (Some("row"), Some(name)) = (parts.next(), parts.next()) else {
        return;
    };
    let number = parts.next();
    let at = rows.iter().position(|row| row.name == name);
    let at = at.unwrap_or_else(|| {
        rows.push(AuthoredRow {
            name: name.to_owned(),
            ..AuthoredRow::default()
        });
        rows.len() - 1
    });
    let row = &mut rows[at];
    if number.is_some() {
        row.stations.push(AuthoredStation {
            at: extras.get("at").and_then(Value::as_f64).map(|at| at as f32),
            root: place.translation.into(),
            direction: place.transform_vector3(Vec3::Y),
            normal: place.transform_vector3(Vec3::Z),
            ride: extras.get("ride").map(joints).unwrap_or_default(),
            follow: extras.get("follow").map(joints).unwrap_or_default(),
        });
    } else {
        row.lengths = extras.get("lengths").map(numbers).unwrap_or_default();
        row.width = extras
            .get("width")
            .map(numbers)
            .and_then(|list| Some([*list.first()?, *list.last()?]));
        row.mirror = extras.get("mirror").map(truth);
        let feather = extras.get("feather").and_then(Value::as_u64);
        row.feather = feather.and_then(|feather| u16::try_from(feather).ok());
    }
}
