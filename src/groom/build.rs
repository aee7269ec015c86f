//! From a groom and a skin to the cards: the whole way, without an app.

use super::{
    asset::{Groom, Region, Row, painted},
    bird::Bird,
    card::{Card, CardGeometry},
    cells::Cells,
    drape::{Shape, drape, rise},
    error::GroomError,
    field::{Field, Follicle},
    lay::{arc_length, lay_field},
    layer,
    leaf::{Leaf, vary},
    mesh::build_mesh,
    order::order,
    press::press,
    rows::{FanJoint, RowContext},
    scatter::scatter,
    select::select_triangles,
    skin::{SkinMesh, SurfacePoint, Weights, blend_weights},
    worn::WornPoses,
};
use crate::asset::RonAsset;
use crate::maths::seed::{Stream, name_hash, place_hash};
use bevy::{
    math::{Affine3A, Vec3},
    mesh::Mesh,
};
use std::collections::HashMap;

/// Lengths of a feather around its root, within which others are tied as it is.
const AROUND: f32 = 2.0;

/// The cards of a bird.
#[derive(Clone, Debug)]
pub struct Coat {
    /// One record per feather: regions in order, then rows.
    pub cards: Vec<Card>,
    /// Where each card's vertices are.
    pub geometry: Vec<CardGeometry>,
    /// The mesh, see [`build_mesh`].
    pub mesh: Mesh,
    /// Joints added behind the body's, one per feather of a row.
    pub fans: Vec<FanJoint>,
    /// What was odd but not fatal: joints that the skin lacks, regions that select nothing.
    pub warnings: Vec<String>,
    /// Pairs of feathers that still cross, see [`layer::settle`].
    pub crossings: layer::Crossings,
    /// Tracts with down below the feathers.
    pub down: Vec<DownTract>,
    /// Where each card is rooted.
    pub roots: Vec<SurfacePoint>,
    /// Furthest that settling has moved a vertex in any of the poses, metres.
    pub moved: f32,
    /// The poses that it was settled in.
    pub worn: WornPoses,
}

/// The skin of a tract that carries down.
#[derive(Clone, Debug, PartialEq)]
pub struct DownTract {
    /// Index of the region.
    pub region: usize,
    /// Which triangles of the skin are its own.
    pub triangles: Vec<bool>,
    /// Direction of the lay at each node of the skin.
    pub lay: Vec<Vec3>,
    /// Cover K: feathers over one another at a place, mean over the tract, measured on the draped feathers.
    pub cover: f32,
}

/// How far before its place a feather begins where no guide says how it lies, in lengths.
const BEFORE: f32 = 0.25;
/// Area of a feather over that of its card.
const VANE_SHARE: f32 = 0.7;

/// Measures the cover of every tract: each feather's area goes to the triangles that it lies over, step by step along its shaft.
fn measure_cover(skin: &SkinMesh, leaves: &[Leaf], down: &mut [DownTract]) {
    if down.is_empty() {
        return;
    }
    let mut covered = vec![0.0_f32; skin.triangles.len()];
    for leaf in leaves {
        let steps = leaf.shaft.points.len().max(1) as f32;
        let share = VANE_SHARE * leaf.card.length * leaf.card.width / steps;
        for below in &leaf.shaft.below {
            covered[below.triangle as usize] += share;
        }
    }
    for tract in down {
        let (mut sum, mut area) = (0.0, 0.0);
        for (triangle, _) in tract.triangles.iter().enumerate().filter(|(_, own)| **own) {
            sum += covered[triangle];
            area += skin.areas[triangle];
        }
        tract.cover = if area > 0.0 { sum / area } else { 0.0 };
    }
}

/// Feathers a bird. The same arguments give the same bytes. `density` scales the number of feathers, and the size of
/// those in regions against it, so that cover stays; 0.01..=16, clamped.
///
/// # Errors
/// [`GroomError::Asset`] if the groom is damaged, [`GroomError::Skin`] if the skin has no triangle.
pub fn groom_bird(bird: &Bird, groom: &Groom, seed: u64, density: f32) -> Result<Coat, GroomError> {
    groom_with(bird, groom, seed, density, true)
}

/// As [`groom_bird`]; `settling`: whether feathers are pressed over each other, or left as they grow, to see what that does.
///
/// # Errors
/// As [`groom_bird`].
pub fn groom_with(
    bird: &Bird,
    groom: &Groom,
    seed: u64,
    density: f32,
    settling: bool,
) -> Result<Coat, GroomError> {
    groom.validate(&groom.name)?;
    let stretched = (groom.bend > 0.0).then(|| Bird {
        skin: bird
            .skin
            .clone()
            .with_stretch(&bird.pivots, groom.bend.to_radians()),
        joints: bird.joints.clone(),
        pivots: Vec::new(),
    });
    let bird = stretched.as_ref().unwrap_or(bird);
    let skin = &bird.skin;
    if skin.triangles.is_empty() {
        return Err(GroomError::Skin {
            mesh: 0,
            message: "has no triangle with an area".into(),
        });
    }
    let density = if density.is_finite() {
        density.clamp(0.01, 16.0)
    } else {
        1.0
    };
    groom
        .check_size(density)
        .map_err(|error| error.in_file(&groom.name))?;
    let mut warnings: Vec<String> = skin.flaws.iter().map(ToString::to_string).collect();
    warnings.extend(skin.mask_flaws.iter().map(ToString::to_string));
    let mut down = Vec::new();
    let mut leaves = regions(bird, groom, seed, density, &mut warnings, &mut down);
    let skinned = !bird.joints.is_empty() && !skin.weights.is_empty();
    let names = if skinned { &bird.joints[..] } else { &[] };
    if skinned {
        let poses = groom.poses.iter();
        let poses: Vec<_> = poses.map(|pose| pose.skinning(names, groom.unit)).collect();
        tie(&mut leaves, &poses);
    }
    let scattered = leaves.len();
    let (mut fans, mut missing) = (Vec::new(), Vec::new());
    for (number, row) in groom.rows.iter().enumerate() {
        let context = RowContext {
            skin,
            joints: names,
            unit: groom.unit,
            seed,
            region: (groom.regions.len() + number) as u16,
            first_joint: names.len() + fans.len(),
        };
        let (row_leaves, row_fans) = context.build(row, &mut missing);
        leaves.extend(row_leaves);
        if skinned {
            fans.extend(row_fans);
        }
    }
    measure_cover(skin, &leaves, &mut down);
    order(&mut leaves, scattered);
    let crossings = layer::settle(&mut leaves[..scattered]);
    let (worn, moved) = press(bird, groom, skinned, &fans, &mut leaves, settling);
    warnings.extend(
        missing
            .iter()
            .map(|name| format!("{}: the skin has no joint {name:?}", groom.name)),
    );
    let roots = leaves.iter().map(|leaf| skin_root(skin, leaf)).collect();
    let (mesh, geometry) = build_mesh(&mut leaves, skinned, worn.reach);
    let cards = leaves.iter().map(|leaf| leaf.card).collect();
    Ok(Coat {
        cards,
        geometry,
        mesh,
        fans,
        warnings,
        crossings,
        down,
        roots,
        moved,
        worn,
    })
}

/// Ties the feathers of each region to their roots where joints would draw them out of shape: each as far as it takes, and at least as
/// far as those around in the mean, for neighbors that are carried alike stay in order.
fn tie(leaves: &mut [Leaf], poses: &[Vec<Affine3A>]) {
    for leaves in leaves.chunk_by_mut(|a, b| a.card.region == b.card.region) {
        let needed: Vec<f32> = leaves.iter().map(|leaf| leaf.needed_tie(poses)).collect();
        if needed.iter().all(|share| *share == 0.0) {
            continue;
        }
        let roots = leaves.iter().map(|leaf| leaf.card.root);
        let roots: Vec<(Vec3, f32)> = roots.zip(needed).collect();
        let around = Cells::new(&roots, AROUND * leaves[0].card.length);
        let share = |(leaf, (root, own)): (&Leaf, &(Vec3, f32))| {
            let (mut sum, mut count) = (0.0, 0.0_f32);
            around.near(*root, AROUND * leaf.card.length, |_, share| {
                sum += share;
                count += 1.0;
            });
            own.max(sum / count.max(1.0))
        };
        let ties: Vec<f32> = leaves.iter().zip(&roots).map(share).collect();
        for (leaf, share) in leaves.iter_mut().zip(ties) {
            leaf.tie(share);
        }
    }
}

/// The place of the skin that a feather grows from.
fn skin_root(skin: &SkinMesh, leaf: &Leaf) -> SurfacePoint {
    let below = leaf.shaft.below.first().copied();
    below
        .or_else(|| skin.nearest(leaf.card.root, leaf.card.normal))
        .unwrap_or(SurfacePoint {
            triangle: 0,
            bary: Vec3::X,
        })
}

/// Smallest distance between two different layer keys of the regions, at most 1: the room that each has for its own order.
fn layer_room(regions: &[Region]) -> f32 {
    let mut keys: Vec<f32> = regions.iter().map(|region| region.layer).collect();
    keys.sort_by(f32::total_cmp);
    keys.windows(2)
        .map(|pair| pair[1] - pair[0])
        .filter(|gap| *gap > 1.0e-4)
        .fold(1.0, f32::min)
}

fn regions(
    bird: &Bird,
    groom: &Groom,
    seed: u64,
    density: f32,
    warnings: &mut Vec<String>,
    down: &mut Vec<DownTract>,
) -> Vec<Leaf> {
    let skin = &bird.skin;
    let masks: Vec<Vec<bool>> = groom
        .regions
        .iter()
        .map(|region| select_triangles(&region.select, skin, &bird.joints, groom.unit))
        .collect();
    // One lay per set of guides: most regions share all of them.
    let mut lays: HashMap<Vec<bool>, (Vec<Vec3>, Vec<f32>)> = HashMap::new();
    let mut placed: Vec<Follicle> = Vec::new();
    let mut leaves = Vec::new();
    let room = layer_room(&groom.regions);
    let (counts, size) = region_counts(groom, density);
    for (number, region) in groom.regions.iter().enumerate() {
        let mask = &masks[number];
        let triangles: Vec<u32> = (0..mask.len() as u32)
            .filter(|&t| mask[t as usize])
            .collect();
        if triangles.is_empty() {
            warnings.push(format!(
                "{}: region {:?} selects nothing",
                groom.name, region.name
            ));
            continue;
        }
        let chosen: Vec<bool> = groom
            .guides
            .iter()
            .map(|guide| guide.regions.is_empty() || guide.regions.contains(&region.name))
            .collect();
        let (lay, arc) = lays.entry(chosen).or_insert_with_key(|chosen| {
            let guides = groom
                .guides
                .iter()
                .zip(chosen)
                .filter(|(_, chosen)| **chosen)
                .map(|(guide, _)| guide);
            let lay = lay_field(skin, guides, groom.unit);
            let arc = if skin.tract_phi.is_empty() {
                arc_length(skin, &lay)
            } else {
                Vec::new()
            };
            (lay, arc)
        });
        if region.down.is_some() {
            down.push(DownTract {
                region: number,
                triangles: mask.clone(),
                lay: lay.clone(),
                cover: 0.0,
            });
        }
        let below = clearance(groom, &masks, number, size);
        let field = Field::new(skin, lay, arc, &triangles, mask).painted(&groom.paint, groom.unit);
        let count = (counts[number] as f64 * field.paint_scale(region)).round() as usize;
        let own = name_hash(seed, &region.name);
        let follicles = scatter(&field, region, count, own, &placed);
        for follicle in &follicles {
            let clearance = below[follicle.at.triangle as usize];
            leaves.push(feather(
                &field, groom, number, follicle, own, size, clearance, room,
            ));
        }
        placed.extend(follicles);
    }
    leaves
}

/// Feathers of each region. The bird as a whole has `density` times its number of feathers; rows keep theirs at any density (a
/// wing has ten primaries), so that the regions take up the difference. Fractions go to the largest remainders. Also their
/// size, so that cover stays.
fn region_counts(groom: &Groom, density: f32) -> (Vec<usize>, f32) {
    let scattered: f64 = groom
        .regions
        .iter()
        .map(|region| f64::from(region.count))
        .sum();
    let sides = |row: &Row| if row.mirror { 2 } else { 1 };
    let in_rows = groom
        .rows
        .iter()
        .map(|row| (row.lengths.len() * sides(row)) as f64)
        .sum::<f64>();
    let wanted = ((scattered + in_rows) * f64::from(density)).round();
    let scale = if scattered > 0.0 {
        (wanted - in_rows).max(0.0) / scattered
    } else {
        0.0
    };
    let exact: Vec<f64> = groom
        .regions
        .iter()
        .map(|region| f64::from(region.count) * scale)
        .collect();
    let mut counts: Vec<usize> = exact.iter().map(|count| count.floor() as usize).collect();
    let total = exact.iter().sum::<f64>().round() as usize;
    let missing = total.saturating_sub(counts.iter().sum());
    let mut order: Vec<usize> = (0..exact.len()).collect();
    order.sort_by(|&a, &b| exact[b].fract().total_cmp(&exact[a].fract()));
    for &number in order.iter().take(missing) {
        counts[number] += 1;
    }
    let size = if scale > 0.0 {
        scale.sqrt().recip() as f32
    } else {
        1.0
    };
    (counts, size)
}

/// Height, at each triangle, of the feathers of lower regions that grow there.
fn clearance(groom: &Groom, masks: &[Vec<bool>], number: usize, size: f32) -> Vec<f32> {
    let mut heights = vec![0.0_f32; masks[number].len()];
    for (other, mask) in groom.regions.iter().zip(masks) {
        if other.layer >= groom.regions[number].layer {
            continue;
        }
        let height = other.length.at(0.5)
            * size
            * groom.unit
            * other.lift.at(0.5).to_radians().sin().max(0.0)
            * rise(1.0);
        for (sum, taken) in heights.iter_mut().zip(mask) {
            if *taken {
                *sum = sum.max(height);
            }
        }
    }
    heights
}

fn feather(
    field: &Field,
    groom: &Groom,
    number: usize,
    follicle: &Follicle,
    own: u64,
    size: f32,
    clearance: f32,
    room: f32,
) -> Leaf {
    let (skin, lay) = (field.skin, field.lay);
    let region = &groom.regions[number];
    let phi = follicle.phi;
    // Half a millimetre on a bird: the feather keeps its seed when others are added around it.
    let seed = place_hash(
        own,
        follicle.position,
        (skin.mean_edge() * 0.05).max(1.0e-6),
    );
    let mut draw = Stream::new(seed);
    let jitter = region.jitter;
    let (_, longer) = painted(&groom.paint, (follicle.position / groom.unit).to_array());
    let length =
        region.length.at(phi) * longer * size * groom.unit * (1.0 + jitter.length * draw.normal());
    let width = region.width.at(phi) * size * groom.unit * (1.0 + jitter.width * draw.normal());
    let masked = skin.mask_length(follicle.at);
    let (length, width) = (length * masked, width * masked);
    let yaw = (jitter.yaw * draw.normal()).to_radians();
    let roll = (jitter.roll * draw.normal()).to_radians();
    let lift = region.lift.at(phi) + jitter.lift * draw.normal() + skin.mask_lift(follicle.at);
    let lift = lift.clamp(-90.0, 90.0).to_radians();
    let tint = vary(
        region.tint,
        phi,
        jitter.hue * draw.normal(),
        jitter.value * draw.normal(),
    );
    let shape = Shape {
        length,
        width,
        yaw,
        roll,
        lift,
        curl: region.curl.to_radians(),
        stiffness: region.stiffness,
        // Neighbors of one row lie at slightly different heights, so that one side always covers the other.
        clearance: clearance + 0.012 * width * draw.uniform(),
        segments: usize::from(region.segments.along),
    };
    // A default lay parts along the front edges of wings and over foreheads, where nothing lies over the roots: feathers that
    // begin a little before their place cover them.
    let root = if groom.guides.is_empty() {
        let before = skin.interpolate(lay, follicle.at) * (BEFORE * length);
        skin.walk(follicle.at.triangle, follicle.position - before)
    } else {
        follicle.at
    };
    let shaft = drape(skin, lay, root, &shape);
    let root: Weights = skin.joint_weights(root);
    // Towards the tip a feather goes more and more with the skin below it, so that neighbors stay in order; but a long one that lies
    // over a wing must not be carried off with it.
    let weights = if root.1[0] > 0.0 {
        let last = (shaft.below.len() - 1).max(1) as f32;
        let share = |x: f32| (1.0 - 2.0 * x).max(0.0).powi(2);
        let at = |(i, below)| {
            let own = share(i as f32 / last);
            blend_weights([(root, own), (skin.joint_weights(below), 1.0 - own)])
        };
        shaft.below.iter().copied().enumerate().map(at).collect()
    } else {
        vec![root]
    };
    let along =
        (shaft.points[1] - shaft.points[0]).normalize_or(shaft.normals[0].any_orthonormal_vector());
    let card = Card {
        root: shaft.points[0],
        along,
        normal: shaft.normals[0],
        center: shaft.points[0],
        radius: length,
        length,
        width,
        joints: root.0,
        weights: root.1,
        feather: region.feather,
        region: number as u16,
        layer: region.layer + room * 0.999 * (1.0 - phi),
        tint,
        seed: (seed >> 32) as u32,
        turn: 0.0,
        mirrored: false,
    };
    Leaf {
        card,
        shaft,
        weights,
        camber: region.camber,
        columns: usize::from(region.segments.across),
        raised: Vec::new(),
        raised_further: Vec::new(),
        windows: Vec::new(),
        held: 0.0,
    }
}
