//! Meshes of the hard parts: tubes swept through rings and sheets over a grid, with tangents for textures.

use std::collections::HashMap;

use bevy::math::{Vec2, Vec3};

use crate::maps::Maps;
use crate::skeleton::Skeleton;
use crate::weights::Binding;

/// A vertex of a primitive.
#[derive(Clone, Copy, Debug)]
pub struct Vertex {
    /// Position, mm.
    pub position: Vec3,
    /// Unit normal.
    pub normal: Vec3,
    /// Direction in which u grows, and the sign by which v grows along `normal x tangent`.
    pub tangent: [f32; 4],
    /// Texture coordinates.
    pub uv: [f32; 2],
    /// Tract number and place along it.
    pub tract: [f32; 2],
    /// Linear color.
    pub color: [f32; 3],
    /// Joints and weights.
    pub binding: Binding,
}

impl Vertex {
    /// A white vertex at a point; normal and tangent are computed once its triangles are there.
    pub fn new(position: Vec3, uv: [f32; 2], binding: Binding) -> Self {
        Self {
            position,
            normal: Vec3::Y,
            tangent: [1.0, 0.0, 0.0, 1.0],
            uv,
            tract: [0.0, 0.0],
            color: [1.0; 3],
            binding,
        }
    }
}

/// One primitive.
#[derive(Clone, Debug, Default)]
pub struct Primitive {
    /// Vertices.
    pub vertices: Vec<Vertex>,
    /// Triangles.
    pub triangles: Vec<[u32; 3]>,
}

/// One ring of a tube.
#[derive(Clone, Copy, Debug)]
pub struct Ring {
    /// Centre, mm.
    pub centre: Vec3,
    /// Half its width.
    pub across: Vec3,
    /// Half its height.
    pub up: Vec3,
    /// Share of the tube's length.
    pub at: f32,
    /// Joints and weights.
    pub binding: Binding,
    /// Share of the width that its top lacks: a ridge.
    pub ridge: f32,
    /// How angular its lower half is: 0 an ellipse, near 1 a box.
    pub boxy: f32,
}

impl Ring {
    /// An elliptic ring.
    pub fn round(centre: Vec3, across: Vec3, up: Vec3, at: f32, binding: Binding) -> Self {
        Self {
            centre,
            across,
            up,
            at,
            binding,
            ridge: 0.0,
            boxy: 0.0,
        }
    }

    /// The point at an angle from the top, radians.
    pub fn point(&self, angle: f32) -> Vec3 {
        let (s, c) = angle.sin_cos();
        let power = |x: f32, below: bool| {
            if below {
                x.signum() * x.abs().powf(1.0 - self.boxy)
            } else {
                x
            }
        };
        let wide = 1.0 - self.ridge * c.max(0.0).powi(2);
        self.centre + self.across * (power(s, c < 0.0) * wide) + self.up * power(c, c < 0.0)
    }
}

/// All weight on one joint.
pub fn rigid(joint: usize) -> Binding {
    ([joint as u16, 0, 0, 0], [1.0, 0.0, 0.0, 0.0])
}

/// Weight between two joints: all on `b` at 1.
pub fn blend(a: usize, b: usize, t: f32) -> Binding {
    ([a as u16, b as u16, 0, 0], [1.0 - t, t, 0.0, 0.0])
}

impl Primitive {
    /// Adds a closed tube through rings, `sides` vertices round each: u runs round from the top, v from `strip[0]` to `strip[1]`.
    pub fn tube(&mut self, rings: &[Ring], sides: usize, strip: [f32; 2]) {
        let base = self.vertices.len() as u32;
        let stride = sides as u32 + 1;
        let v = |at: f32| strip[0] + (strip[1] - strip[0]) * at;
        for r in rings {
            for j in 0..=sides {
                let u = j as f32 / sides as f32;
                self.vertices.push(Vertex::new(
                    r.point(std::f32::consts::TAU * u),
                    [u, v(r.at)],
                    r.binding,
                ));
            }
        }
        self.quads(base, rings.len(), sides + 1);
        for (end, flip) in [(0, false), (rings.len() - 1, true)] {
            let centre = self.vertices.len() as u32;
            let ring = &rings[end];
            self.vertices
                .push(Vertex::new(ring.centre, [0.5, v(ring.at)], ring.binding));
            for j in 0..sides as u32 {
                let a = base + end as u32 * stride + j;
                self.triangles.push(if flip {
                    [centre, a + 1, a]
                } else {
                    [centre, a, a + 1]
                });
            }
        }
        self.finish(base);
    }

    /// Triangles of a grid of `rows` by `columns` vertices that begins at `base`.
    pub fn quads(&mut self, base: u32, rows: usize, columns: usize) {
        let stride = columns as u32;
        for i in 0..rows as u32 - 1 {
            for j in 0..stride - 1 {
                let a = base + i * stride + j;
                let b = a + stride;
                self.triangles.push([a, b, a + 1]);
                self.triangles.push([a + 1, b, b + 1]);
            }
        }
    }

    /// Turns the triangles that begin at `base` outward (away from their middle) and computes normals and tangents.
    pub fn finish(&mut self, base: u32) {
        let own = &self.vertices[base as usize..];
        let middle = own.iter().map(|v| v.position).sum::<Vec3>() / own.len().max(1) as f32;
        let mut volume = 0.0;
        for t in self.triangles.iter().filter(|t| t[0] >= base) {
            let [a, b, c] = t.map(|i| self.vertices[i as usize].position - middle);
            volume += a.dot(b.cross(c));
        }
        if volume < 0.0 {
            for t in self.triangles.iter_mut().filter(|t| t[0] >= base) {
                t.swap(1, 2);
            }
        }
        self.smooth(base);
    }

    /// Smooth normals (welded by position) and tangents of the vertices that begin at `base`.
    pub fn smooth(&mut self, base: u32) {
        let key = |p: Vec3| (p * 64.0).round().as_ivec3().to_array();
        let mut normals = HashMap::<[i32; 3], Vec3>::new();
        // Directions in which u and v grow; the seam of a tube is not welded, because u jumps there.
        let mut along = vec![[Vec3::ZERO; 2]; self.vertices.len()];
        for t in self.triangles.iter().filter(|t| t[0] >= base) {
            let p = t.map(|i| self.vertices[i as usize].position);
            let n = (p[1] - p[0]).cross(p[2] - p[0]);
            for q in p {
                *normals.entry(key(q)).or_default() += n;
            }
            let uv = t.map(|i| Vec2::from_array(self.vertices[i as usize].uv));
            let (e, f) = (p[1] - p[0], p[2] - p[0]);
            let (d, g) = (uv[1] - uv[0], uv[2] - uv[0]);
            let sign = d.perp_dot(g).signum();
            for i in t {
                let [u, v] = &mut along[*i as usize];
                *u += (e * g.y - f * d.y) * sign;
                *v += (f * d.x - e * g.x) * sign;
            }
        }
        for (vertex, [u, v]) in self.vertices.iter_mut().zip(along).skip(base as usize) {
            let n = normals
                .get(&key(vertex.position))
                .copied()
                .unwrap_or(Vec3::Y)
                .normalize_or(Vec3::Y);
            vertex.normal = n;
            let t = u
                .reject_from_normalized(n)
                .normalize_or(n.any_orthonormal_vector());
            let hand = if n.cross(t).dot(v) < 0.0 { -1.0 } else { 1.0 };
            vertex.tangent = t.extend(hand).to_array();
        }
    }

    /// Takes the colors of the vertices from a texture, for what looks at vertices alone.
    pub fn tint(&mut self, maps: &Maps) {
        for v in &mut self.vertices {
            v.color = maps.color_at(v.uv);
        }
    }

    /// Adds the mirror image of everything so far, with joints renamed by `swap`.
    pub fn mirror(&mut self, swap: impl Fn(u16) -> u16) {
        let n = self.vertices.len() as u32;
        let flip = Vec3::new(-1.0, 1.0, 1.0);
        for i in 0..n as usize {
            let mut v = self.vertices[i];
            v.position *= flip;
            v.normal *= flip;
            v.tangent[0] = -v.tangent[0];
            v.tangent[3] = -v.tangent[3];
            v.binding.0 = v.binding.0.map(&swap);
            self.vertices.push(v);
        }
        for i in 0..self.triangles.len() {
            let [a, b, c] = self.triangles[i];
            self.triangles.push([a + n, c + n, b + n]);
        }
    }
}

/// Joint on the other side.
pub fn other_side(skeleton: &Skeleton, joint: u16) -> u16 {
    let name = &skeleton.joints[joint as usize].name;
    name.strip_suffix("_L")
        .map_or(joint, |stem| skeleton.index(&format!("{stem}_R")) as u16)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cylinder() -> Primitive {
        let ring = |at: f32| {
            Ring::round(
                Vec3::Z * (10.0 * at),
                Vec3::X * 2.0,
                Vec3::Y * 3.0,
                at,
                rigid(0),
            )
        };
        let mut out = Primitive::default();
        out.tube(&[ring(0.0), ring(0.5), ring(1.0)], 24, [0.2, 0.7]);
        out
    }

    #[test]
    fn tangents_follow_the_texture_also_in_the_mirror() {
        let mut p = cylinder();
        p.mirror(|j| j);
        let half = p.vertices.len() / 2;
        for t in &p.triangles {
            let v = t.map(|i| p.vertices[i as usize]);
            let n = (v[1].position - v[0].position).cross(v[2].position - v[0].position);
            if v.iter()
                .any(|v| v.uv[0] == 0.5 && v.position.x.abs() + v.position.y.abs() < 0.1)
            {
                continue;
            }
            for (a, b) in [(v[0], v[1]), (v[1], v[2])] {
                assert!(n.dot(a.normal) > 0.0, "normals point outwards");
                let tangent = Vec3::from_slice(&a.tangent);
                let other = a.normal.cross(tangent) * a.tangent[3];
                let step = b.position - a.position;
                let (du, dv) = (b.uv[0] - a.uv[0], b.uv[1] - a.uv[1]);
                assert!(tangent.dot(step) * du >= -1e-3, "u grows along the tangent");
                assert!(other.dot(step) * dv >= -1e-3, "v grows along the bitangent");
            }
        }
        assert_eq!(p.vertices[0].tangent[3], -p.vertices[half].tangent[3]);
    }

    #[test]
    fn a_boxy_ring_has_a_flat_lower_side_and_a_ridge_a_narrow_top() {
        let mut ring = Ring::round(Vec3::ZERO, Vec3::X, Vec3::Y, 0.0, rigid(0));
        (ring.ridge, ring.boxy) = (0.4, 0.6);
        let low = ring.point(std::f32::consts::PI * 0.8);
        assert!(low.y < -0.85 && low.x > 0.75, "{low}");
        let high = ring.point(std::f32::consts::PI * 0.2);
        assert!(high.x < 0.45, "{high}");
    }
}
