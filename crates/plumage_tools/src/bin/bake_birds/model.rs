//! A whole bird: skin, hard parts, skeleton.

use std::collections::BTreeMap;

use crate::bill;
use crate::body::Body;
use crate::clip;
use crate::eyes;
use crate::feet;
use crate::maps::Maps;
use crate::naked;
use crate::nets;
use crate::skeleton::Skeleton;
use crate::species::{Species, Tract, linear};
use crate::tract;
use crate::tube::{Primitive, Vertex};
use crate::weights;

/// A primitive with its material.
pub struct Part {
    /// Name of primitive and material.
    pub name: &'static str,
    /// Geometry.
    pub primitive: Primitive,
    /// Perceptual roughness, 0..1, of what has no textures.
    pub roughness: f32,
    /// Textures.
    pub maps: Option<Maps>,
    /// Carries tract numbers in `TEXCOORD_1`.
    pub skin: bool,
}

/// Everything that goes into one glb.
pub struct Model {
    /// Skin first, then the hard parts.
    pub parts: Vec<Part>,
    /// Joints.
    pub skeleton: Skeleton,
    /// Edges of the skin that do not have exactly one opposite.
    pub open_edges: usize,
}

/// Builds the bird.
pub fn build(species: &Species) -> Model {
    let body = Body::new(species);
    let skeleton = Skeleton::new(species, &feet::toe_joints(species));
    let mut surface = nets::polygonise(&body);
    let plane = species.arcs.head_plane - 4.0;
    if species.fine_head {
        clip::refine(&body, &mut surface, |p| p.y > plane);
    }
    let tracts = clip::clip(&body, &mut surface);
    let open_edges = open_edges(&surface.triangles);
    let bindings = weights::bind(&body, &skeleton, &surface);
    let normals: Vec<_> = surface.points.iter().map(|p| body.normal(*p)).collect();

    // One tract per triangle; vertices on a border are doubled, so that tract and phi never interpolate across it.
    let mut skin = Primitive::default();
    let mut split: BTreeMap<(u32, Tract), u32> = BTreeMap::new();
    for (t, &tract) in surface.triangles.iter().zip(&tracts) {
        let triangle = t.map(|i| {
            *split.entry((i, tract)).or_insert_with(|| {
                let p = surface.points[i as usize];
                let naked = matches!(tract, Tract::Bare | Tract::EyeRing);
                let dark = if naked { 1.0 } else { 0.4 };
                let shade = linear(species.skin_color(tract)).map(|c: f32| c * srgb_factor(dark));
                let phi = tract::phi(&body, tract, p);
                let uv = [tract as u32 as f32 / 32.0, phi];
                skin.vertices.push(Vertex {
                    normal: normals[i as usize],
                    tract: [tract as u32 as f32, phi],
                    color: shade,
                    ..Vertex::new(p, uv, bindings[i as usize])
                });
                skin.vertices.len() as u32 - 1
            })
        });
        skin.triangles.push(triangle);
    }
    let part = |name, (primitive, maps)| Part {
        name,
        primitive,
        roughness: 1.0,
        maps: Some(maps),
        skin: false,
    };
    let bill = bill::bill(species, &skeleton, &body);
    let face = species
        .naked
        .map(|sheet| naked::face(&body, &skeleton, &sheet, &bill.0));
    let mut parts = vec![
        Part {
            name: "skin",
            primitive: skin,
            roughness: 0.85,
            maps: None,
            skin: true,
        },
        part("bill", bill),
        part("eyes", eyes::eyes(species, &skeleton)),
        part("lids", eyes::lids(species, &skeleton, &body)),
        part("feet", feet::feet(species, &skeleton)),
        part("claws", feet::claws(species, &skeleton)),
    ];
    parts.extend(face.map(|face| part("face", face)));
    Model {
        parts,
        skeleton,
        open_edges,
    }
}

/// Factor on linear light of a factor on sRGB values.
fn srgb_factor(f: f32) -> f32 {
    f.powf(2.2)
}

/// Directed edges that lack exactly one opposite.
pub fn open_edges(triangles: &[[u32; 3]]) -> usize {
    let mut edges: BTreeMap<(u32, u32), i32> = BTreeMap::new();
    for t in triangles {
        for i in 0..3 {
            let (a, b) = (t[i], t[(i + 1) % 3]);
            *edges.entry((a.min(b), a.max(b))).or_default() += if a < b { 1 } else { -1 };
        }
    }
    edges.values().filter(|v| **v != 0).count()
}
