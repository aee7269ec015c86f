//! Address of a point inside a prism of the shell: the triangle is subdivided `level` times, the height into layers.
//!
//! A triangle at level `d` has `4^d` cells in `2^d` rows counted from corner 0. Row `r` starts at index `r^2` and holds `2r + 1`
//! cells. The printed forms (Andersen et al., *Hybrid fur rendering*, Eq. 1 to 3) are in
//! [`published`](super::published). Twin: `down_prism.wgsl`.

use bevy_plumage::maths::functions::{Real, clamp};

/// Deepest subdivision of a triangle.
pub const MAX_LEVEL: u32 = 12;

/// One cell of a subdivided triangle. Its corner nearest to the triangle's corner 0 is the grid vertex
/// `(a, b)` of row `a + b`, counted along the sides to corners 1 and 2.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PrismCell {
    /// Steps towards corner 1.
    pub a: u32,
    /// Steps towards corner 2.
    pub b: u32,
    /// The cell points towards the far side (its neighbors in the row point to corner 0).
    pub down: bool,
}

/// Index, below `4^level`, of the cell that holds a point with the barycentric coordinates `lambda`.
///
/// Equal to Eq. 2 inside cells; on their edges and corners, where the floors of Eq. 1 disagree with each other, it is one of the
/// cells that touch the point (docs/book/undercoat.md#shell).
pub fn prism_index<T: Real>(lambda: [T; 3], level: u32) -> u32 {
    let rows = 1u32 << level.min(MAX_LEVEL);
    let n = T::of(f64::from(rows));
    let unit = |x: T| clamp(x, T::zero(), T::one());
    let (u, v) = (n * unit(lambda[1]), n * unit(lambda[2]));
    let row = (u + v).floor().to_u32().unwrap_or(0).min(rows - 1);
    let a = u.floor().to_u32().unwrap_or(0).min(row);
    let b = v.floor().to_u32().unwrap_or(0).min(row - a);
    row * row + row + b - a
}

/// The cell of an index: inverse of [`prism_index`].
pub fn prism_cell(index: u32) -> PrismCell {
    // The root of a float may be one off at squares.
    let mut row = (index as f32).sqrt() as u32;
    if row * row > index {
        row -= 1;
    }
    if (row + 1) * (row + 1) <= index {
        row += 1;
    }
    // Position in the row plus `row`; 2 b + down of it.
    let twice = index - row * row;
    let down = twice & 1;
    let b = twice / 2;
    PrismCell {
        a: row - down - b,
        b,
        down: down == 1,
    }
}

/// Barycentric coordinates of the centre of a cell.
pub fn prism_centre<T: Real>(cell: PrismCell, level: u32) -> [T; 3] {
    let n = T::of(f64::from(1u32 << level.min(MAX_LEVEL)));
    let third = T::of(if cell.down { 2.0 / 3.0 } else { 1.0 / 3.0 });
    let l1 = (T::of(f64::from(cell.a)) + third) / n;
    let l2 = (T::of(f64::from(cell.b)) + third) / n;
    [T::one() - l1 - l2, l1, l2]
}

/// First element of every prism in one buffer, and the buffer's length last: prefix sum of `layers * 4^level`.
///
/// (Eq. 3's `(i_v n_l + i_l) 4^d` hands out an element twice as soon as levels differ.) `None` beyond 2^32 elements.
pub fn prism_bases(levels: &[u32], layers: u32) -> Option<Vec<u32>> {
    let mut bases = Vec::with_capacity(levels.len() + 1);
    let mut sum = 0u32;
    bases.push(0);
    for level in levels {
        let cells = 1u32 << (2 * (*level).min(MAX_LEVEL));
        sum = sum.checked_add(layers.checked_mul(cells)?)?;
        bases.push(sum);
    }
    Some(bases)
}

/// Element of a cell in a layer of a prism that starts at `base`.
pub fn prism_element(base: u32, layer: u32, level: u32, index: u32) -> u32 {
    base + (layer << (2 * level.min(MAX_LEVEL))) + index
}

/// Level, as a real number, at which the cells of a triangle whose longest edge is `edge_px` pixels long have edges of
/// `target_px` pixels; 0..=`deepest`.
///
/// Its whole part is the level, its fraction the share of the next finer one: a density looked up at both and mixed has no
/// seams and does not pop. `edge_px` must not depend on the edge's orientation (bound it by a sphere).
pub fn prism_level<T: Real>(edge_px: T, target_px: T, deepest: u32) -> T {
    let ratio = edge_px / target_px.max(T::of(1e-6));
    clamp(
        ratio.max(T::one()).log2(),
        T::zero(),
        T::of(f64::from(deepest.min(MAX_LEVEL))),
    )
}

/// The level that a stored prism takes next: it moves by one, once `wanted` ([`prism_level`]) is 0.3 past the middle between
/// two levels. Call it once in four frames.
pub fn prism_level_next<T: Real>(current: u32, wanted: T) -> u32 {
    let off = wanted - T::of(f64::from(current));
    if off > T::of(0.8) {
        current + 1
    } else if off < T::of(-0.8) {
        current.saturating_sub(1)
    } else {
        current
    }
}
