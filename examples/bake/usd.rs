//! Curves and cards as text USD, in the pose of the file: shafts as `BasisCurves`, cards as a `Mesh` with the atlas.

use super::{atlas::Atlas, gather::Bird};
use bevy::prelude::*;
use std::fmt::Write;

/// Width of a shaft at its root over the width of the card.
const SHAFT: f32 = 0.04;

/// Items between brackets.
fn list<T>(items: impl IntoIterator<Item = T>, show: impl Fn(&mut String, T)) -> String {
    let mut text = String::from("[");
    for (number, item) in items.into_iter().enumerate() {
        if number > 0 {
            text.push_str(", ");
        }
        show(&mut text, item);
    }
    text.push(']');
    text
}

fn vector(text: &mut String, v: Vec3) {
    // Writing to a text cannot fail.
    let _ = write!(text, "({}, {}, {})", v.x, v.y, v.z);
}

fn plain<T: std::fmt::Display>(text: &mut String, item: T) {
    let _ = write!(text, "{item}");
}

/// The file; `picture` is the atlas beside it.
pub fn write(bird: &Bird, atlas: &Atlas, picture: &str) -> String {
    let (positions, normals) = bird.posed();
    let (mut points, mut counts, mut widths) = (Vec::new(), Vec::new(), Vec::new());
    let mut st = vec![[0.0; 2]; positions.len()];
    let mut colors = vec![Vec3::ONE; positions.len()];
    for (number, (card, block)) in bird.cards.iter().zip(&bird.geometry).enumerate() {
        let first = block.first_vertex as usize;
        let all = first..first + block.vertex_count as usize;
        let [_, bottom] = bird.uvs[first];
        let wide = bird.uvs[all.clone()]
            .iter()
            .filter(|[_, v]| *v == bottom)
            .count();
        let rows = all.len() / wide.max(1);
        counts.push(rows);
        for row in 0..rows {
            let left = first + row * wide;
            let share = row as f32 / (rows - 1).max(1) as f32;
            // The shaft: the middle column, or between the two in the middle.
            let (a, b) = (left + (wide - 1) / 2, left + wide / 2);
            points.push(0.5 * (positions[a] + positions[b]));
            widths.push(SHAFT * card.width * (1.0 - 0.8 * share));
        }
        for i in all {
            let [u, v] = atlas.place(usize::from(card.feather), bird.uvs[i]);
            st[i] = [u, 1.0 - v];
            colors[i] = Vec3::from_array(atlas.colors[number]);
        }
    }
    let triangles = bird.indices.len() / 3;
    format!(
        r#"#usda 1.0
(
    defaultPrim = "Plumage"
    metersPerUnit = 1
    upAxis = "Y"
)

def Xform "Plumage"
{{
    def BasisCurves "Shafts"
    {{
        uniform token type = "linear"
        int[] curveVertexCounts = {counts}
        point3f[] points = {points}
        float[] widths = {widths} (
            interpolation = "vertex"
        )
    }}

    def Mesh "Cards" (
        prepend apiSchemas = ["MaterialBindingAPI"]
    )
    {{
        uniform bool doubleSided = 1
        int[] faceVertexCounts = {faces}
        int[] faceVertexIndices = {corners}
        point3f[] points = {vertices}
        normal3f[] normals = {normals} (
            interpolation = "vertex"
        )
        texCoord2f[] primvars:st = {st} (
            interpolation = "vertex"
        )
        color3f[] primvars:displayColor = {colors} (
            interpolation = "vertex"
        )
        uniform token subdivisionScheme = "none"
        rel material:binding = </Plumage/Feathers>
    }}

    def Material "Feathers"
    {{
        token outputs:surface.connect = </Plumage/Feathers/Surface.outputs:surface>

        def Shader "Surface"
        {{
            uniform token info:id = "UsdPreviewSurface"
            color3f inputs:diffuseColor.connect = </Plumage/Feathers/Atlas.outputs:rgb>
            float inputs:opacity.connect = </Plumage/Feathers/Atlas.outputs:a>
            float inputs:opacityThreshold = 0.5
            float inputs:roughness = 0.8
            token outputs:surface
        }}

        def Shader "Atlas"
        {{
            uniform token info:id = "UsdUVTexture"
            asset inputs:file = @./{picture}@
            float2 inputs:st.connect = </Plumage/Feathers/Place.outputs:result>
            float3 outputs:rgb
            float outputs:a
        }}

        def Shader "Place"
        {{
            uniform token info:id = "UsdPrimvarReader_float2"
            string inputs:varname = "st"
            float2 outputs:result
        }}
    }}
}}
"#,
        counts = list(counts, plain),
        points = list(points, vector),
        widths = list(widths, plain),
        faces = list(std::iter::repeat_n(3, triangles), plain),
        corners = list(&bird.indices, plain),
        vertices = list(positions, vector),
        normals = list(normals, vector),
        st = list(st, |text, [u, v]| {
            let _ = write!(text, "({u}, {v})");
        }),
        colors = list(colors, vector),
    )
}
