//! Naked skin of the face: a fine sheet over the skin of the body, which is too coarse for wrinkles and for a smooth rim.

use std::f32::consts::TAU;

use bevy::math::Vec3;

use crate::body::Body;
use crate::maps::{Maps, Strip, Texel, cloud, ease, mix, noise, plates};
use crate::nets::Surface;
use crate::skeleton::Skeleton;
use crate::species::{FaceLines, Naked, linear};
use crate::tract;
use crate::tube::{Primitive, Vertex, other_side};
use crate::weights;

/// Columns and rows of the sheet on one side.
const GRID: [usize; 2] = [56, 60];
/// How far from the vertical axis within the head its surface is looked for, mm.
const REACH: f32 = 60.0;
/// Height of the sheet over the skin, mm.
const OVER: f32 = 0.45;

/// How far from the bill it shades the skin, mm.
const SHADE: f32 = 4.0;

/// Points of the sheet on the left half: by angle from straight ahead, and down.
struct Sheet {
    points: Vec<Vec3>,
}

impl Sheet {
    fn new(body: &Body, naked: &Naked) -> Self {
        let [columns, rows] = GRID;
        let points = (0..=rows).flat_map(|j| {
            let y = naked.height[0] + (naked.height[1] - naked.height[0]) * j as f32 / rows as f32;
            (0..=columns).map(move |i| {
                let angle = naked.turn.to_radians() * i as f32 / columns as f32;
                outline(body, Vec3::new(0.0, y, naked.axis), angle)
            })
        });
        Self {
            points: points.collect(),
        }
    }

    fn place(&self, i: usize, j: usize) -> Vec3 {
        self.points[j * (GRID[0] + 1) + i]
    }

    /// The point at texture coordinates.
    fn at(&self, [u, v]: [f32; 2]) -> Vec3 {
        let cell = |x: f32, n: usize| {
            let x = x.clamp(0.0, 1.0) * n as f32;
            let i = (x as usize).min(n - 1);
            (i, x - i as f32)
        };
        let ((i, s), (j, t)) = (cell(u, GRID[0]), cell(v, GRID[1]));
        let row = |j: usize| self.place(i, j).lerp(self.place(i + 1, j), s);
        row(j).lerp(row(j + 1), t)
    }
}

/// Where a level ray from within the head leaves it; `angle` from straight ahead to the left, radians.
fn outline(body: &Body, from: Vec3, angle: f32) -> Vec3 {
    let ray = Vec3::new(angle.sin(), 0.0, angle.cos());
    let steps = 24;
    let mut inside = 0.0;
    let mut outside = REACH;
    for k in 0..=steps {
        let at = REACH * k as f32 / steps as f32;
        if body.distance(from + ray * at) > 0.0 {
            outside = at;
            break;
        }
        inside = at;
    }
    for _ in 0..12 {
        let middle = 0.5 * (inside + outside);
        if body.distance(from + ray * middle) > 0.0 {
            outside = middle;
        } else {
            inside = middle;
        }
    }
    from + ray * inside
}

/// The sheets of both sides with their texture; they are darker next to the bill.
pub fn face(
    body: &Body,
    skeleton: &Skeleton,
    naked: &Naked,
    bill: &Primitive,
) -> (Primitive, Maps) {
    let sheet = Sheet::new(body, naked);
    let width = naked.turn.to_radians() * 30.0;
    let height = (naked.height[0] - naked.height[1]).abs();
    let maps = Maps::paint(
        [256, 256],
        &[Strip { v: [0.0, 1.0] }],
        |_, uv| {
            let p = sheet.at(uv);
            let mut texel = texel(body, naked, p);
            let gap = bill
                .vertices
                .iter()
                .map(|v| v.position.distance_squared(p))
                .fold(f32::MAX, f32::min)
                .sqrt();
            let near = ease(SHADE, 0.0, gap);
            texel.open *= 1.0 - 0.75 * near;
            texel.color = mix(texel.color, texel.color.map(|x| x * x * 0.6), 0.7 * near);
            texel
        },
        |_, _| [width, height],
    );
    let [columns, rows] = GRID;
    let rim: Vec<f32> = sheet
        .points
        .iter()
        .map(|p| tract::bare_distance(body, *p))
        .collect();
    let surface = Surface {
        points: sheet
            .points
            .iter()
            .zip(&rim)
            .map(|(p, d)| {
                // Its border dips under the skin among the roots of the feathers.
                let dip = ease(naked.fringe - 1.2, naked.fringe, *d);
                *p + body.normal(*p) * (OVER * (1.0 - dip) - 0.5 * dip)
            })
            .collect(),
        triangles: grid(columns, rows)
            .filter(|t| t.iter().any(|i| rim[*i as usize] < naked.fringe))
            .collect(),
    };
    let bindings = weights::bind(body, skeleton, &surface);
    let mut out = Primitive::default();
    let mut index = vec![u32::MAX; surface.points.len()];
    for t in &surface.triangles {
        let triangle = t.map(|i| {
            let k = i as usize;
            if index[k] == u32::MAX {
                index[k] = out.vertices.len() as u32;
                let uv = [
                    (k % (columns + 1)) as f32 / columns as f32,
                    (k / (columns + 1)) as f32 / rows as f32,
                ];
                out.vertices
                    .push(Vertex::new(surface.points[k], uv, bindings[k]));
            }
            index[k]
        });
        out.triangles.push(triangle);
    }
    out.smooth(0);
    for v in &mut out.vertices {
        let normal = body.normal(v.position);
        // Left and right meet in the middle plane.
        v.normal = if v.position.x.abs() < 1e-3 {
            normal
        } else {
            v.normal
        };
    }
    out.tint(&maps);
    out.mirror(|j| other_side(skeleton, j));
    (out, maps)
}

/// Triangles of a grid, counter-clockwise from outside.
fn grid(columns: usize, rows: usize) -> impl Iterator<Item = [u32; 3]> {
    let stride = columns as u32 + 1;
    (0..rows as u32).flat_map(move |j| {
        (0..columns as u32).flat_map(move |i| {
            let a = j * stride + i;
            let b = a + stride;
            [[a, b, a + 1], [a + 1, b, b + 1]]
        })
    })
}

/// The skin at a point of the sheet.
fn texel(body: &Body, naked: &Naked, p: Vec3) -> Texel {
    let s = body.species;
    let [_, skin, ..] = s.bare_colors.map(linear);
    let at = p.to_array().map(|x| x / 7.0);
    let blotch = cloud(at, 91);
    let eye = s.joint("eye_L");
    let away = (p - eye).length();
    // Wrinkles run round the eye and across the cheek, each a fold with a narrow furrow.
    let bend = 3.2 * cloud(p.to_array().map(|x| x / 16.0), 92);
    let across = away / naked.wrinkle + bend;
    let fold = (across * TAU * 0.5).sin().abs();
    let second = ((p.y - 0.5 * p.z) / (1.4 * naked.wrinkle) + 1.5 * bend)
        .sin()
        .abs();
    let deep = (0.65 + 0.5 * cloud(p.to_array().map(|x| x / 11.0), 94)).clamp(0.15, 1.0);
    let folds = 1.0 - deep * (1.0 - fold.powf(0.6) * second.powf(0.35));
    let [grain, _] = plates([p.z / 0.9, p.y / 0.9], i32::MAX, 93);
    let pink = linear(naked.blush);
    let mut color = mix(skin, pink, 0.28 + 0.35 * blotch + 0.45 * (1.0 - folds));
    color = color.map(|x| x * (0.93 + 0.07 * grain));
    let rim = -tract::bare_distance(body, p);
    let mut texel = Texel {
        color,
        height: 0.22 * folds + 0.05 * grain + 0.08 * blotch,
        roughness: 0.62 - 0.06 * blotch,
        open: 0.72 + 0.28 * folds,
    };
    if let Some(lines) = naked.lines {
        let (line, stroke) = strokes(p - eye, lines);
        let there = ease(-1.5, -5.0, p.y - eye.y - 0.35 * (p.z - eye.z)) * ease(1.5, 4.0, rim);
        let ink = line * there * stroke;
        texel.color = mix(texel.color, linear(lines.color), 0.62 * ink);
        texel.height += 0.12 * ink;
    }
    // Short feathers stand the closer the nearer the coat.
    let stubble = noise([p.x / 0.5, p.y / 0.9, p.z / 0.5], 95);
    let coat = ease(naked.edge, -0.5, rim + 1.6 * stubble);
    texel.color = mix(
        texel.color,
        linear(naked.coat).map(|x| x * (0.85 + 0.25 * stubble)),
        coat,
    );
    texel.height += 0.12 * coat * stubble;
    texel.roughness += 0.15 * coat;
    texel
}

/// Lines of tiny feathers round the eye, from its centre: how near a point is to one, and how much feather is at this place of it, both
/// 0..1.
fn strokes(from: Vec3, lines: FaceLines) -> (f32, f32) {
    let (z, y) = (from.z, from.y);
    let place = lines.line(z, y) + 0.14 * noise([z / 6.0, y / 6.0, 0.0], 97);
    let k = place.round();
    if !(0.0..FaceLines::COUNT).contains(&k) {
        return (0.0, 0.0);
    }
    let off = (place - k) * lines.pitch;
    let along = z.atan2(-y) * (lines.first + k * lines.pitch) / 2.3 + 0.41 * k;
    let within = along - along.floor();
    // Each tapers backwards and leans off the line; some are missing.
    let own = noise([1.7 * along.floor(), 2.3 * k, 0.5], 99);
    let lean = off - 0.5 * (within - 0.5) - 0.5 * own;
    let width = (0.27 + 0.1 * own) * (1.0 - 0.6 * within);
    (
        ease(width + 0.14, width - 0.08, lean.abs()) * ease(-0.5, 0.3, own),
        ease(0.0, 0.12, within) * ease(1.0, 0.75, within),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sheet_lies_on_the_skin_and_dips_under_it_at_its_border() {
        let species = &crate::species::all()[0];
        let body = Body::new(species);
        let skeleton = Skeleton::new(species, &crate::feet::toe_joints(species));
        let naked = species.naked.expect("the macaw has a naked face");
        let (sheet, _) = face(&body, &skeleton, &naked, &Primitive::default());
        for v in &sheet.vertices {
            let rim = tract::bare_distance(&body, v.position.with_x(v.position.x.abs()));
            let over = body.distance(v.position);
            assert!(over < 1.0 && over > -1.0, "{over} at {}", v.position);
            if rim < 0.0 {
                assert!(over > 0.1, "{over} at {}", v.position);
            }
            assert!(v.normal.dot(body.normal(v.position)) > 0.5);
        }
    }
}
