//! One vertex a place: seams of texture coordinates split the vertices of a mesh, the skin has none.

use super::{ShellReport, ShellVertex};
use crate::maths::vector::{add, cross, normalize, sub};
use std::collections::HashMap;

/// Welded vertices (their normals still zero, their heights the mean of those that met), and the welded id of every vertex.
pub(super) fn weld(
    positions: &[[f32; 3]],
    heights: &[f32],
    report: &mut ShellReport,
) -> (Vec<ShellVertex>, Vec<u32>) {
    let mut places: HashMap<[u32; 3], u32> = HashMap::with_capacity(positions.len());
    let mut vertices: Vec<ShellVertex> = Vec::new();
    let mut shared: Vec<f32> = Vec::new();
    let ids = positions
        .iter()
        .zip(heights)
        .enumerate()
        .map(|(source, (position, height))| {
            // Adding zero makes one zero of two.
            let key = position.map(|x| (x + 0.0).to_bits());
            let id = *places.entry(key).or_insert(vertices.len() as u32);
            if id as usize == vertices.len() {
                vertices.push(ShellVertex {
                    position: *position,
                    height: *height,
                    normal: [0.0; 3],
                    source: source as u32,
                });
                shared.push(1.0);
            } else {
                let (vertex, n) = (&mut vertices[id as usize], &mut shared[id as usize]);
                vertex.height = (vertex.height * *n + height) / (*n + 1.0);
                *n += 1.0;
                report.welded += 1;
            }
            id
        })
        .collect();
    (vertices, ids)
}

/// Smoothed normals, weighted with the triangles' areas. Where they cancel, one of the triangles gives its own.
pub(super) fn normals(vertices: &mut [ShellVertex], triangles: &[[u32; 3]]) {
    let mut sums = vec![[0.0f64; 3]; vertices.len()];
    let mut any = vec![[0.0f64; 3]; vertices.len()];
    for t in triangles {
        let [p, q, r] = t.map(|v| vertices[v as usize].position.map(f64::from));
        let n = cross(sub(q, p), sub(r, p));
        for v in t.map(|v| v as usize) {
            sums[v] = add(sums[v], n);
            if any[v] == [0.0; 3] {
                any[v] = n;
            }
        }
    }
    for ((vertex, sum), any) in vertices.iter_mut().zip(sums).zip(any) {
        let fallback = normalize(any, [0.0, 1.0, 0.0]);
        vertex.normal = normalize(sum, fallback).map(|x| x as f32);
    }
}
