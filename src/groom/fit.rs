//! Cards as wide as their feathers: what a card has beside the outline would be asked for, and found empty, pixel by pixel.

use super::{
    card::{Card, CardGeometry},
    component::PlumageCards,
    worn::ATTRIBUTE_RAISED,
};
use crate::{anatomy::Feather, maths::order::raised_between, modified::modified};
use bevy::{
    asset::{AssetEvent, Assets},
    ecs::prelude::*,
    math::Vec3,
    mesh::{Mesh, Mesh3d, VertexAttributeValues},
    platform::collections::HashMap,
};

/// What is added to the number of a card in `UV_1` at the vertices of its right edge, and taken from it at those of its left one.
pub const EDGE_MARK: f32 = 0.25;
/// Share of the way from an edge of the card to the next column that the edge may be moved at most.
const FARTHEST: f32 = 0.9;
/// Widths of a card that need no move.
const LITTLE: f32 = 1.0e-4;

/// A vertex at an edge, moved on the line through its neighbor.
struct Move {
    vertex: usize,
    beside: usize,
    /// New distance from the neighbor over the old one.
    share: f32,
    u: f32,
    id: f32,
}

impl Move {
    fn between<const N: usize>(&self, values: &[[f32; N]]) -> [f32; N] {
        let (own, next) = (values[self.vertex], values[self.beside]);
        std::array::from_fn(|k| next[k] + (own[k] - next[k]) * self.share)
    }
}

/// Which cards are fitted.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Fitted {
    All,
    /// Those that were before: an app's own keep their shape.
    Again,
}

fn moves(
    mesh: &Mesh,
    cards: &[Card],
    geometry: &[CardGeometry],
    feathers: &[Option<&Feather>],
    fitted: Fitted,
) -> Vec<Move> {
    let mut moves = Vec::new();
    let attributes = [Mesh::ATTRIBUTE_UV_0, Mesh::ATTRIBUTE_UV_1].map(|of| mesh.attribute(of));
    let [
        Some(VertexAttributeValues::Float32x2(uvs)),
        Some(VertexAttributeValues::Float32x2(ids)),
    ] = attributes
    else {
        return moves;
    };
    if ids.len() < uvs.len() {
        return moves;
    }
    let mut uvs = uvs.clone();
    let mut strips = HashMap::<(usize, usize), Vec<[f32; 2]>>::default();
    for (card, place) in cards.iter().zip(geometry) {
        // Those in weather come behind the clean ones, in the same order.
        let Some(number) = usize::from(card.feather).checked_rem(feathers.len()) else {
            continue;
        };
        let Some(feather) = feathers[number] else {
            continue;
        };
        let first = place.first_vertex as usize;
        let Some(own) = uvs.get(first..first + place.vertex_count as usize) else {
            continue;
        };
        let wide = own.iter().take_while(|uv| uv[1] == own[0][1]).count();
        let rows = own.len() / wide.max(1);
        let was_fitted = ids[first][0].fract() != 0.0;
        if wide < 2
            || rows < 2
            || rows * wide != own.len()
            || (fitted == Fitted::Again && !was_fitted)
        {
            continue;
        }
        let strip = strips.entry((number, rows));
        let strip = strip.or_insert_with(|| feather.card_strip(rows - 1));
        let farthest = match wide {
            2 => 0.5 * FARTHEST,
            _ => FARTHEST / (wide - 1) as f32,
        };
        for (row, [left, right]) in strip.iter().enumerate() {
            let start = first + row * wide;
            let end = start + wide - 1;
            let mirrored = uvs[start][0] > uvs[end][0];
            for (vertex, beside) in [(start, start + 1), (end, end - 1)] {
                let (u, mark) = match (vertex == start) != mirrored {
                    true => (left.min(farthest), -EDGE_MARK),
                    false => (right.max(1.0 - farthest), EDGE_MARK),
                };
                let id = ids[vertex][0].round() + mark;
                let (own, next) = (uvs[vertex][0], uvs[beside][0]);
                let fits = (own - u).abs() <= LITTLE && ids[vertex][0] == id;
                // Between columns in one place there is no line to move on.
                if fits || (own - next).abs() <= LITTLE {
                    continue;
                }
                moves.push(Move {
                    vertex,
                    beside,
                    share: (u - next) / (own - next),
                    u,
                    id,
                });
                uvs[vertex][0] = u;
            }
        }
    }
    moves
}

fn apply(mesh: &mut Mesh, moves: &[Move]) {
    let unit = |[x, y, z]: [f32; 3]| Vec3::new(x, y, z).normalize_or_zero();
    if let Some(VertexAttributeValues::Float32x3(places)) =
        mesh.attribute_mut(Mesh::ATTRIBUTE_POSITION)
    {
        for step in moves {
            places[step.vertex] = step.between(places);
        }
    }
    let mut fronts = Vec::with_capacity(moves.len());
    if let Some(VertexAttributeValues::Float32x3(normals)) =
        mesh.attribute_mut(Mesh::ATTRIBUTE_NORMAL)
    {
        for step in moves {
            let front = unit(step.between(normals));
            normals[step.vertex] = front.to_array();
            fronts.push(front);
        }
    }
    if let Some(VertexAttributeValues::Float32x4(tangents)) =
        mesh.attribute_mut(Mesh::ATTRIBUTE_TANGENT)
    {
        for (step, front) in moves.iter().zip(fronts) {
            let [x, y, z, hand] = step.between(tangents);
            let along = Vec3::new(x, y, z).reject_from_normalized(front);
            tangents[step.vertex] = along.normalize_or_zero().extend(hand).to_array();
        }
    }
    if let Some(VertexAttributeValues::Uint16x4(raised)) = mesh.attribute_mut(ATTRIBUTE_RAISED) {
        for step in moves {
            let (own, next) = (raised[step.vertex], raised[step.beside]);
            raised[step.vertex] = raised_between(next, own, step.share);
        }
    }
    if let Some(VertexAttributeValues::Float32x2(uvs)) = mesh.attribute_mut(Mesh::ATTRIBUTE_UV_0) {
        moves.iter().for_each(|step| uvs[step.vertex][0] = step.u);
    }
    if let Some(VertexAttributeValues::Float32x2(ids)) = mesh.attribute_mut(Mesh::ATTRIBUTE_UV_1) {
        moves.iter().for_each(|step| ids[step.vertex][0] = step.id);
    }
}

/// Narrows cards to the strip that holds their feather ([`Feather::card_strip`]), on the surface that they have, and marks the vertices
/// at their edges ([`EDGE_MARK`]). Cards that fit stay; one whose feather has changed may become wider again. `feathers`: as
/// [`Card::feather`] counts, once for all weathers; cards of those that are `None` are left.
pub fn fit_cards(
    mesh: &mut Mesh,
    cards: &[Card],
    geometry: &[CardGeometry],
    feathers: &[Option<&Feather>],
) {
    let moves = moves(mesh, cards, geometry, feathers, Fitted::All);
    apply(mesh, &moves);
}

/// Fits cards anew whose feather has been edited.
pub(super) fn follow_outlines(
    mut events: MessageReader<AssetEvent<Feather>>,
    feathers: Res<Assets<Feather>>,
    birds: Query<(&Mesh3d, &PlumageCards)>,
    mut meshes: ResMut<Assets<Mesh>>,
) {
    let edited = modified(&mut events);
    if edited.is_empty() {
        return;
    }
    for (
        mesh,
        PlumageCards {
            cards,
            geometry,
            feathers: own,
            ..
        },
    ) in &birds
    {
        let own = own.iter().map(|own| {
            let edited = edited.contains(&own.id());
            edited.then(|| feathers.get(own)).flatten()
        });
        let own: Vec<Option<&Feather>> = own.collect();
        let found = meshes.get(mesh.id());
        let moves = found.map(|found| moves(found, cards, geometry, &own, Fitted::Again));
        let Some(moves) = moves.filter(|moves| !moves.is_empty()) else {
            continue;
        };
        if let Some(mut mesh) = meshes.get_mut(mesh.id()) {
            apply(&mut mesh, &moves);
        }
    }
}
