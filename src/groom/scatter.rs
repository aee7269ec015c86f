//! Where the feathers of a region grow: blue noise by weighted sample elimination (Yuksel 2015), or staggered rows.

use super::{
    asset::{Placement, Region},
    field::{Field, Follicle},
    grid::PointGrid,
    lattice,
    skin::SurfacePoint,
};
use crate::maths::seed::Stream;
use bevy::math::Vec3;

/// Candidates per feather kept.
const OVERSAMPLING: usize = 5;
/// Draws until a candidate falls where a texture wants feathers.
const TRIES: usize = 24;

/// Fills a region with `count` follicles. `placed` are the follicles of other regions: those outside this region keep their
/// distance across the border.
pub fn scatter(
    field: &Field,
    region: &Region,
    count: usize,
    seed: u64,
    placed: &[Follicle],
) -> Vec<Follicle> {
    if count == 0 || field.triangles.is_empty() {
        return Vec::new();
    }
    // Paint is laid over rows, too: they become blue noise where it changes their number.
    if let Placement::Rows(rows) = region.placement
        && !field.skin.has_density_mask()
        && field.paint_scale(region) == 1.0
    {
        let follicles = lattice::rows(field, region, rows as usize, count, seed);
        if follicles.len() == count {
            return follicles;
        }
    }
    let mut stream = Stream::new(seed);
    let candidates = candidates(field, region, count * OVERSAMPLING, &mut stream);
    eliminate(field, region, candidates, count, placed)
}

/// Systematic sampling over the triangles, by area over spacing squared.
fn candidates(field: &Field, region: &Region, count: usize, stream: &mut Stream) -> Vec<Follicle> {
    let textured = field.skin.has_density_texture();
    let square = |at: SurfacePoint| f64::from(field.spacing(region, &field.follicle(at))).powi(2);
    let density = |triangle: u32| {
        let places = field.skin.mask_places(triangle);
        let area = f64::from(field.skin.areas[triangle as usize]) / places.len() as f64;
        if !textured && !corners_wanted(field, triangle) {
            return 0.0;
        }
        let wanted = places
            .into_iter()
            .filter(|at| !textured || field.wants(*at));
        wanted.map(|at| area / square(at)).sum()
    };
    let weights: Vec<f64> = field
        .triangles
        .iter()
        .map(|&triangle| density(triangle))
        .collect();
    let step = weights.iter().sum::<f64>() / count as f64;
    let mut list = Vec::with_capacity(count);
    let (mut reached, mut reached_count) = (0.0, 0);
    let last = field.triangles.len() - 1;
    for (i, (&triangle, weight)) in field.triangles.iter().zip(&weights).enumerate() {
        reached += weight;
        let most = if textured && *weight > 0.0 {
            let places = field.skin.mask_places(triangle).into_iter();
            places.map(|at| square(at).recip()).fold(0.0, f64::max)
        } else {
            0.0
        };
        while reached_count < count && (i == last || (reached_count as f64 + 0.5) * step < reached)
        {
            let mut at = anywhere(triangle, stream);
            // A texture may be finer than the triangle: more where it asks for more.
            for _ in 0..if textured { TRIES } else { 0 } {
                if field.wants(at) && f64::from(stream.uniform()) * most < square(at).recip() {
                    break;
                }
                at = anywhere(triangle, stream);
            }
            reached_count += 1;
            if field.wants(at) {
                list.push(field.follicle(at));
            }
        }
    }
    list
}

/// A point of a triangle, any alike.
fn anywhere(triangle: u32, stream: &mut Stream) -> SurfacePoint {
    let (root, split) = (stream.uniform().sqrt(), stream.uniform());
    let bary = Vec3::new(1.0 - root, root * (1.0 - split), root * split);
    SurfacePoint { triangle, bary }
}

/// Whether a mask wants feathers at any corner of a triangle.
fn corners_wanted(field: &Field, triangle: u32) -> bool {
    let corners = [Vec3::X, Vec3::Y, Vec3::Z].into_iter();
    corners
        .map(|bary| SurfacePoint { triangle, bary })
        .any(|at| field.wants(at))
}

/// Kills the most crowded candidate until `count` are left.
fn eliminate(
    field: &Field,
    region: &Region,
    list: Vec<Follicle>,
    count: usize,
    placed: &[Follicle],
) -> Vec<Follicle> {
    let skin = field.skin;
    let area: f64 = field
        .triangles
        .iter()
        .map(|&t| f64::from(skin.areas[t as usize]))
        .sum();
    let radius = (area / (2.0 * 3.0_f64.sqrt() * count as f64)).sqrt() as f32;
    let mean_square = list
        .iter()
        .map(|f| field.spacing(region, f).powi(-2))
        .sum::<f32>()
        / list.len().max(1) as f32;
    // Mean number density stays count / area: the radius follows the local spacing.
    let radii: Vec<f32> = list
        .iter()
        .map(|f| radius * field.spacing(region, f) * mean_square.sqrt())
        .collect();
    let widest = radii.iter().copied().fold(0.0, f32::max);
    let lay: Vec<Vec3> = list
        .iter()
        .map(|f| skin.interpolate(field.lay, f.at))
        .collect();
    let normals: Vec<Vec3> = list
        .iter()
        .map(|f| skin.face_normals[f.at.triangle as usize])
        .collect();
    let crowding = |i: usize, position: Vec3, reach: f32| {
        let delta = position - list[i].position;
        let along = delta.dot(lay[i]);
        // A little closer along the lay than across it: the feathers fall into rows by themselves.
        let distance = (delta.length_squared() - along * along * 0.2775)
            .max(0.0)
            .sqrt();
        (1.0 - distance / reach.max(f32::MIN_POSITIVE))
            .max(0.0)
            .powi(8)
    };
    let positions: Vec<Vec3> = list.iter().map(|f| f.position).collect();
    let grid = PointGrid::of(&positions, widest * 2.2);
    let mut starts = vec![0_usize];
    let mut pairs: Vec<(u32, f32)> = Vec::new();
    let mut weights = Vec::with_capacity(list.len());
    for i in 0..list.len() {
        let mut sum = 0.0;
        grid.near(positions[i], widest * 2.2, |j| {
            let j = j as usize;
            if j != i && normals[i].dot(normals[j]) > 0.0 {
                // The mean of both directions, so that a pair weighs the same from either end.
                let reach = radii[i] + radii[j];
                let weight =
                    0.5 * (crowding(i, positions[j], reach) + crowding(j, positions[i], reach));
                if weight > 0.0 {
                    pairs.push((j as u32, weight));
                    sum += weight;
                }
            }
        });
        starts.push(pairs.len());
        weights.push(sum);
    }
    let foreign: Vec<&Follicle> = placed
        .iter()
        .filter(|f| !field.mask[f.at.triangle as usize])
        .collect();
    for follicle in foreign {
        grid.near(follicle.position, widest * 2.2, |i| {
            let i = i as usize;
            if normals[i].dot(skin.face_normals[follicle.at.triangle as usize]) > 0.0 {
                weights[i] += crowding(i, follicle.position, 2.0 * radii[i]);
            }
        });
    }
    let mut heap = Heap::new(weights);
    let mut alive = vec![true; list.len()];
    for _ in count..list.len() {
        let Some(killed) = heap.pop() else { break };
        alive[killed] = false;
        for &(other, weight) in &pairs[starts[killed]..starts[killed + 1]] {
            if alive[other as usize] {
                heap.lower(other as usize, weight);
            }
        }
    }
    list.into_iter()
        .zip(alive)
        .filter(|(_, alive)| *alive)
        .map(|(follicle, _)| follicle)
        .collect()
}

/// Binary heap of the candidates by weight, largest first, whose weights can fall.
struct Heap {
    weights: Vec<f32>,
    order: Vec<u32>,
    place: Vec<u32>,
}

impl Heap {
    fn new(weights: Vec<f32>) -> Self {
        let order: Vec<u32> = (0..weights.len() as u32).collect();
        let mut heap = Self {
            weights,
            place: order.clone(),
            order,
        };
        for i in (0..heap.order.len() / 2).rev() {
            heap.sink(i);
        }
        heap
    }

    fn above(&self, a: u32, b: u32) -> bool {
        let (x, y) = (self.weights[a as usize], self.weights[b as usize]);
        x > y || (x == y && a > b)
    }

    fn swap(&mut self, i: usize, j: usize) {
        self.order.swap(i, j);
        self.place[self.order[i] as usize] = i as u32;
        self.place[self.order[j] as usize] = j as u32;
    }

    fn sink(&mut self, mut i: usize) {
        loop {
            let mut top = i;
            for child in [2 * i + 1, 2 * i + 2] {
                if child < self.order.len() && self.above(self.order[child], self.order[top]) {
                    top = child;
                }
            }
            if top == i {
                return;
            }
            self.swap(i, top);
            i = top;
        }
    }

    fn pop(&mut self) -> Option<usize> {
        let last = self.order.len().checked_sub(1)?;
        self.swap(0, last);
        let top = self.order.pop()?;
        self.sink(0);
        Some(top as usize)
    }

    /// Takes `amount` off the weight of a candidate that is still in the heap.
    fn lower(&mut self, candidate: usize, amount: f32) {
        self.weights[candidate] -= amount;
        self.sink(self.place[candidate] as usize);
    }
}
