//! From groom and skin to cards: the coat's counts, sameness, soundness and order.

use bevy::{
    math::{Affine3A, Quat, Vec3},
    mesh::{Mesh, VertexAttributeValues},
};
use bevy_plumage::groom::*;
use plumage_tests::skins::*;

/// Every byte of the mesh, as numbers.
fn bytes(coat: &Coat) -> Vec<u32> {
    let mut out = Vec::new();
    for (_, values) in coat.mesh.attributes() {
        out.extend(values.get_bytes().iter().map(|byte| u32::from(*byte)));
    }
    let indices = coat.mesh.indices().unwrap();
    out.extend(indices.iter().map(|index| index as u32));
    out.extend(
        coat.cards
            .iter()
            .flat_map(|card| [card.seed, card.tint[0].to_bits(), card.layer.to_bits()]),
    );
    out
}

fn vec3s(coat: &Coat, id: bevy::mesh::MeshVertexAttribute) -> Vec<Vec3> {
    match coat.mesh.attribute(id) {
        Some(VertexAttributeValues::Float32x3(values)) => {
            values.iter().map(|v| Vec3::from_array(*v)).collect()
        }
        _ => panic!("no such attribute"),
    }
}

#[test]
fn the_same_seed_gives_the_same_bytes() {
    let (bird, groom) = (bird(true), groom());
    let one = bytes(&groom_bird(&bird, &groom, 7, 1.0).unwrap());
    assert_eq!(one, bytes(&groom_bird(&bird, &groom, 7, 1.0).unwrap()));
    assert_ne!(one, bytes(&groom_bird(&bird, &groom, 8, 1.0).unwrap()));
}

#[test]
fn counts_are_exact_at_every_density() {
    let (bird, groom) = (bird(true), groom());
    for density in [0.1, 0.5, 1.0, 2.0] {
        let coat = groom_bird(&bird, &groom, 1, density).unwrap();
        let count = |region: u16| {
            coat.cards
                .iter()
                .filter(|card| card.region == region)
                .count()
        };
        assert_eq!(
            coat.cards.len(),
            (766.0 * density).round() as usize,
            "{density}"
        );
        // The row keeps its sixteen; the regions share the rest as 400 to 350.
        let rest = (coat.cards.len() - 16) as f32;
        assert!(
            (count(0) as f32 - rest * 400.0 / 750.0).abs() <= 1.0,
            "{density}: {}",
            count(0)
        );
        assert_eq!(
            count(2),
            16,
            "a flight row keeps its feathers at density {density}"
        );
        let mean = |c: &Coat| {
            c.cards
                .iter()
                .filter(|card| card.region < 2)
                .map(|card| card.length * card.width)
                .sum::<f32>()
        };
        let full = groom_bird(&bird, &groom, 1, 1.0).unwrap();
        let cover = mean(&coat) / mean(&full);
        assert!(
            (cover - 1.0).abs() < 0.06,
            "cover changes by {cover} at density {density}"
        );
    }
}

#[test]
fn attributes_are_sound() {
    let coat = groom_bird(&bird(true), &groom(), 3, 1.0).unwrap();
    let positions = vec3s(&coat, Mesh::ATTRIBUTE_POSITION);
    let normals = vec3s(&coat, Mesh::ATTRIBUTE_NORMAL);
    let Some(VertexAttributeValues::Float32x4(tangents)) =
        coat.mesh.attribute(Mesh::ATTRIBUTE_TANGENT)
    else {
        panic!()
    };
    let Some(VertexAttributeValues::Float32x2(uvs)) = coat.mesh.attribute(Mesh::ATTRIBUTE_UV_0)
    else {
        panic!()
    };
    let Some(VertexAttributeValues::Float32x2(ids)) = coat.mesh.attribute(Mesh::ATTRIBUTE_UV_1)
    else {
        panic!()
    };
    let Some(VertexAttributeValues::Float32x4(weights)) =
        coat.mesh.attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT)
    else {
        panic!()
    };
    let Some(VertexAttributeValues::Uint16x4(joints)) =
        coat.mesh.attribute(Mesh::ATTRIBUTE_JOINT_INDEX)
    else {
        panic!()
    };
    for i in 0..positions.len() {
        assert!(
            positions[i].is_finite() && normals[i].is_normalized(),
            "vertex {i}"
        );
        let tangent = Vec3::new(tangents[i][0], tangents[i][1], tangents[i][2]);
        assert!(tangent.is_normalized() && tangent.dot(normals[i]).abs() < 1.0e-3);
        assert!((weights[i].iter().sum::<f32>() - 1.0).abs() < 1.0e-4);
        assert!(
            joints[i]
                .iter()
                .all(|j| usize::from(*j) < JOINTS.len() + coat.fans.len())
        );
        assert!(
            (0.0..=1.0).contains(&uvs[i][0])
                && (0.0..=1.0).contains(&uvs[i][1])
                && (0.0..=1.0).contains(&ids[i][1])
        );
    }
    for (number, (card, geometry)) in coat.cards.iter().zip(&coat.geometry).enumerate() {
        let range = geometry.first_vertex as usize
            ..(geometry.first_vertex + geometry.vertex_count) as usize;
        assert!(ids[range.clone()].iter().all(|id| id[0] == number as f32));
        let reach = positions[range.clone()]
            .iter()
            .map(|p| p.distance(card.center))
            .fold(0.0, f32::max);
        assert!(reach <= card.radius * 1.0001);
        // +u is where the tangent frame says it is: compare the two ends of the row in the middle of the card.
        let columns = if card.region == 2 { 5 } else { 3 };
        let row = range.start + (range.len() / columns / 2) * columns;
        let (a, b) = (row, row + columns - 1);
        let u = (positions[b] - positions[a]) * (uvs[b][0] - uvs[a][0]);
        let side =
            normals[row + 1].cross(Vec3::from_slice(&tangents[row + 1])) * tangents[row + 1][3];
        assert!(side.dot(u) > 0.9 * u.length(), "card {number}");
    }
    // Faces wind so that their front is the normal's side.
    let indices: Vec<usize> = coat.mesh.indices().unwrap().iter().collect();
    for t in indices.chunks_exact(3) {
        let [a, b, c] = [t[0], t[1], t[2]].map(|i| positions[i]);
        assert!((b - a).cross(c - a).dot(normals[t[0]]) > 0.0);
    }
    // Higher layers come first.
    let layers: Vec<f32> = indices.iter().step_by(3).map(|i| ids[*i][1]).collect();
    assert!(layers.windows(2).all(|pair| pair[0] >= pair[1]));
}

#[test]
fn feathers_stand_on_the_skin_face_outwards_and_point_to_the_tail() {
    for tracts in [true, false] {
        let mut groom = groom();
        if !tracts {
            groom.regions = vec![region("all", Select::All, 700, 1.0)];
        }
        let coat = groom_bird(&bird(tracts), &groom, 3, 1.0).unwrap();
        let mut tailwards = 0;
        let body: Vec<&Card> = coat
            .cards
            .iter()
            .filter(|card| usize::from(card.region) < groom.regions.len())
            .collect();
        for card in &body {
            let level = (card.root / HALF).length();
            assert!((0.97..1.02).contains(&level), "root at {level}");
            let outwards = (card.root / (HALF * HALF)).normalize();
            assert!(card.normal.dot(outwards) > 0.8, "{:?}", card.normal);
            tailwards += usize::from(card.along.z < 0.3);
        }
        assert!(
            tailwards * 100 > body.len() * 97,
            "{tailwards} of {}",
            body.len()
        );
    }
}

/// Without phi in the mesh the order comes from the lay itself.
#[test]
fn cranial_feathers_lie_over_caudal_ones() {
    for tracts in [true, false] {
        let mut groom = groom();
        groom.rows.clear();
        if !tracts {
            groom.regions = vec![region("all", Select::All, 700, 1.0)];
        }
        let coat = groom_bird(&bird(tracts), &groom, 5, 1.0).unwrap();
        let positions = vec3s(&coat, Mesh::ATTRIBUTE_POSITION);
        let (mut pairs, mut above, mut ordered) = (0, 0, 0);
        for (a, upper) in coat.cards.iter().enumerate() {
            for (b, lower) in coat.cards.iter().enumerate() {
                let step = lower.root - upper.root;
                if upper.region != lower.region
                    || step.length() > 0.5 * upper.length
                    || upper.normal.dot(lower.normal) < 0.9
                {
                    continue;
                }
                // b is rooted clearly tailwards of a, below the middle of a's blade.
                let (along, aside) = (
                    step.dot(upper.along),
                    step.dot(upper.along.cross(upper.normal)),
                );
                if along < 0.15 * upper.length || aside.abs() > 0.35 * upper.width {
                    continue;
                }
                pairs += 1;
                ordered += usize::from(upper.layer > lower.layer);
                // Compare b's own middle with the nearest vertex of a's rachis.
                let rachis = |number: usize| {
                    let first = coat.geometry[number].first_vertex as usize;
                    (0..5)
                        .map(|i| positions[first + 3 * i + 1])
                        .collect::<Vec<_>>()
                };
                let middle = rachis(b)[1];
                let over = rachis(a)
                    .windows(2)
                    .map(|s| {
                        let t = ((middle - s[0]).dot(s[1] - s[0]) / (s[1] - s[0]).length_squared())
                            .clamp(0.0, 1.0);
                        s[0].lerp(s[1], t)
                    })
                    .min_by(|p, q| p.distance(middle).total_cmp(&q.distance(middle)))
                    .unwrap();
                let outwards = (middle / (HALF * HALF)).normalize();
                above += usize::from((over - middle).dot(outwards) > 0.0);
            }
        }
        assert!(pairs > 60, "{pairs}");
        assert_eq!(ordered, pairs, "layer keys against the order of roots");
        assert!(above * 100 >= pairs * 97, "{above} of {pairs} lie above");
        let Crossings {
            pairs,
            before,
            left,
        } = coat.crossings;
        println!("{pairs} pairs touch, {before} crossed, {left} cross");
        assert!(
            pairs > 500 && left * 10 < before * 7,
            "{left} of {before} crossings are left"
        );
    }
}

#[test]
fn spacing_is_even() {
    let mut groom = groom();
    groom.rows.clear();
    groom.regions = vec![region("all", Select::All, 600, 1.0)];
    groom.regions[0].length = Span(20.0, 20.0);
    groom.regions[0].width = Span(10.0, 10.0);
    let bird = bird(false);
    let coat = groom_bird(&bird, &groom, 5, 1.0).unwrap();
    let area: f32 = bird.skin.areas.iter().sum();
    let hexagonal = (1.1547 * area / 600.0).sqrt();
    let nearest = |card: &Card| {
        let others = coat
            .cards
            .iter()
            .filter(|other| !std::ptr::eq(*other, card));
        others
            .map(|other| other.root.distance(card.root))
            .fold(f32::INFINITY, f32::min)
    };
    let smallest = coat.cards.iter().map(nearest).fold(f32::INFINITY, f32::min);
    // White noise gives nearly 0 here, a perfect lattice 1.
    assert!(smallest > 0.45 * hexagonal, "{}", smallest / hexagonal);
}

#[test]
fn rows_are_mirror_images_and_fan() {
    let mut groom = groom();
    groom.regions.clear();
    let bird = bird(true);
    let coat = groom_bird(&bird, &groom, 5, 1.0).unwrap();
    assert_eq!(coat.fans.len(), 16);
    assert!(coat.warnings.is_empty(), "{:?}", coat.warnings);
    let flip = Vec3::new(-1.0, 1.0, 1.0);
    for i in 0..8 {
        let (left, right) = (&coat.cards[i], &coat.cards[i + 8]);
        assert!(
            left.root.abs_diff_eq(right.root * flip, 1.0e-6)
                && left.along.abs_diff_eq(right.along * flip, 1.0e-5)
        );
        assert!(left.normal.abs_diff_eq(right.normal * flip, 1.0e-5));
        assert!(!left.mirrored && right.mirrored && left.seed != right.seed);
    }
    // Bind pose of a bird moved, turned and doubled: every feather moves with it.
    let model = Affine3A::from_scale_rotation_translation(
        Vec3::splat(2.0),
        Quat::from_rotation_y(0.7),
        Vec3::new(1.0, 2.0, 3.0),
    );
    for (fan, card) in coat.fans.iter().zip(&coat.cards) {
        let skin = fan_transform(fan, &[model; 4]) * Affine3A::from_mat4(fan.inverse_bind());
        let tip = card.root + card.along * card.length;
        assert!(
            skin.transform_point3(tip)
                .abs_diff_eq(model.transform_point3(tip), 1.0e-4)
        );
    }
    // The wing turns by 40 degrees about y at its joint: the first feather keeps its direction, the last turns with the wing,
    // and between them the directions change in order.
    let turn = Quat::from_rotation_y(40.0_f32.to_radians());
    let place = joint_places()[2];
    let wing = Affine3A::from_translation(place)
        * Affine3A::from_quat(turn)
        * Affine3A::from_translation(-place);
    let pose = [
        Affine3A::IDENTITY,
        Affine3A::IDENTITY,
        wing,
        Affine3A::IDENTITY,
    ];
    let turned: Vec<f32> = (0..8)
        .map(|i| {
            let fan = &coat.fans[i];
            let skin = fan_transform(fan, &pose) * Affine3A::from_mat4(fan.inverse_bind());
            assert!(
                skin.transform_point3(fan.root)
                    .abs_diff_eq(wing.transform_point3(fan.root), 1.0e-5)
            );
            skin.transform_vector3(coat.cards[i].along)
                .angle_between(coat.cards[i].along)
                .to_degrees()
        })
        .collect();
    assert!(turned[0] < 0.1, "{turned:?}");
    // The last feather's rachis is not quite perpendicular to the axis.
    assert!((turned[7] - 40.0).abs() < 1.0, "{turned:?}");
    assert!(
        turned.windows(2).all(|pair| pair[1] > pair[0] + 2.0),
        "{turned:?}"
    );
    let right = fan_transform(&coat.fans[15], &pose);
    assert!(
        right
            .translation
            .abs_diff_eq(coat.fans[15].root.into(), 1.0e-6),
        "the right wing stays"
    );
}

#[test]
fn odd_skins_do_not_panic() {
    let groom = groom();
    // A wing that the skin does not know: a warning, and the feathers ride on the skin.
    let mut other = bird(true);
    other.joints = vec!["a".into(), "b".into(), "c".into(), "d".into()];
    let coat = groom_bird(&other, &groom, 1, 1.0).unwrap();
    assert!(
        coat.warnings
            .iter()
            .any(|warning| warning.contains("wing_R")),
        "{:?}",
        coat.warnings
    );
    assert!(coat.fans.iter().all(|fan| !fan.ride.is_empty()));
    // No joints, no tracts, no normals, no indices, a triangle without area and one that is NaN.
    let mut mesh = body(false);
    mesh.remove_attribute(Mesh::ATTRIBUTE_NORMAL);
    mesh.remove_attribute(Mesh::ATTRIBUTE_JOINT_INDEX);
    mesh.remove_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT);
    mesh.duplicate_vertices();
    let Some(VertexAttributeValues::Float32x3(positions)) =
        mesh.attribute_mut(Mesh::ATTRIBUTE_POSITION)
    else {
        panic!()
    };
    positions[1] = positions[0];
    positions[3] = [f32::NAN; 3];
    let skin = SkinMesh::from_meshes(&[&mesh], &[]).unwrap();
    let bare = Bird {
        skin,
        ..Bird::default()
    };
    let mut all = groom.clone();
    all.regions = vec![region("all", Select::All, 200, 1.0)];
    let coat = groom_bird(&bare, &all, 1, f32::NAN).unwrap();
    assert_eq!(coat.cards.len(), 216);
    assert!(coat.mesh.attribute(Mesh::ATTRIBUTE_JOINT_INDEX).is_none() && coat.fans.is_empty());
    assert!(
        vec3s(&coat, Mesh::ATTRIBUTE_POSITION)
            .iter()
            .all(|p| p.is_finite())
    );
    // Nothing selected.
    let coat = groom_bird(&bare, &groom, 1, 1.0).unwrap();
    assert_eq!(coat.cards.len(), 16);
    assert_eq!(coat.warnings.len(), 2, "{:?}", coat.warnings);
    // No skin.
    assert!(matches!(
        groom_bird(&Bird::default(), &groom, 1, 1.0),
        Err(GroomError::Skin { .. })
    ));
    // Tiny and huge birds are the same bird.
    for scale in [1.0e-3, 1.0e3] {
        let mut mesh = body(true);
        mesh.scale_by(Vec3::splat(scale));
        let bird = Bird {
            skin: SkinMesh::from_meshes(&[&mesh], &[]).unwrap(),
            ..Bird::default()
        };
        let mut groom = groom.clone();
        groom.unit *= scale;
        let coat = groom_bird(&bird, &groom, 1, 1.0).unwrap();
        assert_eq!(coat.cards.len(), 766);
        assert!(
            vec3s(&coat, Mesh::ATTRIBUTE_POSITION)
                .iter()
                .all(|p| p.length() < 0.3 * scale)
        );
    }
}
