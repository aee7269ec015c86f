//! Cards as wide as their feathers: the strip holds the outline, the surface stays, an edited feather gets back what it needs.

use bevy::{
    math::Vec3,
    mesh::{Mesh, VertexAttributeValues},
};
use bevy_plumage::{
    anatomy::{Feather, Weather, covering},
    groom::{Coat, EDGE_MARK, fit_cards, groom_bird},
    maths::query::{MAP_MARGIN, MAP_SIZE},
};
use plumage_tests::{
    shipped,
    skins::{bird, groom},
};

/// Share of a texel from which its middle is part of the feather.
const SEEN: u8 = 128;
/// Farthest that one may lie outside, widths of the card: a quarter of a texel.
const OUTSIDE: f32 = 0.25 / 56.0;

/// Farthest that the middle of a texel of the feather's outline map lies outside the strip, widths of the card; and the map's share of it.
fn outside(feather: &Feather, strip: &[[f32; 2]]) -> (f32, f32) {
    let [width, height] = MAP_SIZE.map(|side| side as usize);
    let of_card = |texel: usize, side: usize| {
        let margin = MAP_MARGIN as f32;
        (texel as f32 + 0.5 - margin) / (side as f32 - 2.0 * margin)
    };
    let (mut most, mut sum) = (0.0_f32, 0.0);
    for (at, share) in feather.outline_map().into_iter().enumerate() {
        let (u, v) = (of_card(at % width, width), of_card(at / width, height));
        if !(0.0..1.0).contains(&u) || !(0.0..1.0).contains(&v) {
            continue;
        }
        sum += f32::from(share) / 255.0;
        if share >= SEEN {
            let place = v * (strip.len() - 1) as f32;
            let row = place as usize;
            let edge = |k: usize| {
                strip[row][k] + (strip[row + 1][k] - strip[row][k]) * (place - row as f32)
            };
            most = most.max(edge(0) - u).max(u - edge(1));
        }
    }
    let texels =
        (width as f32 - 2.0 * MAP_MARGIN as f32) * (height as f32 - 2.0 * MAP_MARGIN as f32);
    (most, sum / texels)
}

#[test]
fn strips_hold_their_feathers() {
    let (mut held, mut filled, mut count) = (0.0, 0.0, 0.0);
    for feather in shipped::feathers() {
        for segments in [1, 2, 4, 7, 64] {
            let strip = feather.card_strip(segments);
            assert_eq!(strip.len(), segments + 1);
            let bounds = strip.iter().flatten();
            assert!(bounds.into_iter().all(|u| (0.0..=1.0).contains(u)));
            let wet = feather.weathered(Weather {
                wetness: 1.0,
                dirt: 0.0,
                age: 1.0,
            });
            for (seen, what) in [(&feather, "dry"), (&wet, "wet")] {
                let (most, share) = outside(seen, &strip);
                assert!(
                    most <= OUTSIDE,
                    "{} {what}, {segments}: {most}",
                    feather.name
                );
                if segments == 4 && what == "dry" {
                    let rows = strip.windows(2);
                    let wide = |[left, right]: [f32; 2]| (right - left).max(0.0);
                    held += rows
                        .map(|rows| 0.125 * (wide(rows[0]) + wide(rows[1])))
                        .sum::<f32>();
                    filled += share;
                    count += 1.0;
                }
            }
        }
    }
    let (held, filled) = (held / count, filled / count);
    println!("of a card of four segments the strip is {held:.3}, the outline {filled:.3}");
    assert!(held < 0.76 && held > filled, "{held}");
}

fn vectors(coat: &Coat) -> (Vec<Vec3>, Vec<[f32; 2]>, Vec<[f32; 2]>) {
    let places = match coat.mesh.attribute(Mesh::ATTRIBUTE_POSITION) {
        Some(VertexAttributeValues::Float32x3(values)) => values,
        _ => panic!("no places"),
    };
    let pairs = |of| match coat.mesh.attribute(of) {
        Some(VertexAttributeValues::Float32x2(values)) => values.clone(),
        _ => panic!("no coordinates"),
    };
    (
        places
            .iter()
            .map(|place| Vec3::from_array(*place))
            .collect(),
        pairs(Mesh::ATTRIBUTE_UV_0),
        pairs(Mesh::ATTRIBUTE_UV_1),
    )
}

#[test]
fn fitted_cards_stay_on_their_surface() {
    let whole = groom_bird(&bird(true), &groom(), 5, 1.0).unwrap();
    let mut coat = whole.clone();
    let feather = covering();
    let fit = |coat: &mut Coat, feather: &Feather| {
        fit_cards(
            &mut coat.mesh,
            &coat.cards,
            &coat.geometry,
            &[Some(feather)],
        );
    };
    fit(&mut coat, &feather);
    let (before, uvs_before, ids_before) = vectors(&whole);
    let (places, uvs, ids) = vectors(&coat);
    let mut moved = 0;
    for card in &coat.geometry {
        let first = card.first_vertex as usize;
        let wide = (first..)
            .take_while(|i| uvs[*i][1] == uvs[first][1])
            .count();
        for i in 0..card.vertex_count as usize {
            let (at, column) = (first + i, i % wide);
            let (own, id) = (ids_before[at][0], ids[at][0]);
            assert_eq!(own, id.round());
            assert_eq!(uvs[at][1], uvs_before[at][1]);
            if column > 0 && column < wide - 1 {
                assert!(uvs[at] == uvs_before[at] && places[at] == before[at] && id == own);
                continue;
            }
            let next = if column == 0 { at + 1 } else { at - 1 };
            let share = (uvs[at][0] - uvs[next][0]) / (uvs_before[at][0] - uvs_before[next][0]);
            assert!(share > 0.05 && share <= 1.0, "{share}");
            let there = before[next].lerp(before[at], share);
            assert!(there.distance(places[at]) < 1.0e-6);
            let mark = if uvs[at][0] < 0.5 {
                -EDGE_MARK
            } else {
                EDGE_MARK
            };
            assert_eq!(id - own, mark);
            moved += usize::from(share < 0.99);
        }
    }
    assert!(moved > coat.cards.len(), "{moved} vertices moved");
    // What fits stays to the bit.
    let mut again = coat.clone();
    fit(&mut again, &feather);
    let bytes = |coat: &Coat| -> Vec<u8> {
        let attributes = coat.mesh.attributes();
        attributes
            .flat_map(|(_, v)| v.get_bytes().to_vec())
            .collect()
    };
    assert!(bytes(&coat) == bytes(&again));
    // A feather that fills its card gets the whole card back.
    let mut wide = feather.clone();
    wide.contour.start = 0.0;
    (wide.left.barb_angle, wide.right.barb_angle) = (90.0, 90.0);
    for reach in [&mut wide.contour.left, &mut wide.contour.right] {
        reach.iter_mut().for_each(|reach| *reach = 2.0);
    }
    fit(&mut again, &wide);
    let (places, uvs, _) = vectors(&again);
    let (mut far, mut off) = (0.0_f32, 0.0_f32);
    for at in 0..places.len() {
        far = far.max(places[at].distance(before[at]));
        off = off.max((uvs[at][0] - uvs_before[at][0]).abs());
    }
    assert!(far < 1.0e-4, "{far}");
    assert!(off < 0.03, "{off}");
}
