//! Curves from meshes of lines.

use bevy::{
    math::Vec3,
    mesh::{Mesh, PrimitiveTopology, VertexAttributeValues},
};

/// Most points of one curve.
const LONGEST: usize = 4096;

/// The curves of a mesh of lines, each from the end with the lower vertex number; a curve that joins others ends there. Empty if the mesh is
/// not made of lines.
pub fn chains(mesh: &Mesh) -> Vec<Vec<Vec3>> {
    let Ok(VertexAttributeValues::Float32x3(places)) = mesh.try_attribute(Mesh::ATTRIBUTE_POSITION)
    else {
        return Vec::new();
    };
    let list: Vec<usize> = match mesh.try_indices_option() {
        Ok(Some(indices)) => indices.iter().collect(),
        _ => (0..places.len()).collect(),
    };
    let edges: Vec<[usize; 2]> = match mesh.primitive_topology() {
        PrimitiveTopology::LineList => list
            .chunks_exact(2)
            .map(|pair| [pair[0], pair[1]])
            .collect(),
        PrimitiveTopology::LineStrip => list.windows(2).map(|pair| [pair[0], pair[1]]).collect(),
        _ => Vec::new(),
    };
    let mut around = vec![Vec::new(); places.len()];
    for (number, [a, b]) in edges.iter().copied().enumerate() {
        if a != b && a < places.len() && b < places.len() {
            around[a].push((number, b));
            around[b].push((number, a));
        }
    }
    let mut used = vec![false; edges.len()];
    let mut chains = Vec::new();
    let ends = (0..places.len()).filter(|&vertex| around[vertex].len() != 2);
    // What is left when all ends have been walked from are rings.
    for start in ends.chain(0..places.len()) {
        while let Some(&(edge, next)) = around[start].iter().find(|(edge, _)| !used[*edge]) {
            used[edge] = true;
            let mut chain = vec![start, next];
            let mut at = next;
            while around[at].len() == 2
                && chain.len() < LONGEST
                && let Some(&(edge, next)) = around[at].iter().find(|(edge, _)| !used[*edge])
            {
                used[edge] = true;
                chain.push(next);
                at = next;
            }
            let place = |vertex: usize| Vec3::from_array(places[vertex]);
            let chain: Vec<Vec3> = chain.into_iter().map(place).collect();
            if chain.iter().all(|place| place.is_finite()) {
                chains.push(chain);
            }
        }
    }
    chains
}
