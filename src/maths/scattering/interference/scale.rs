//! Stacks whose thickness changes over a feather (docs/book/iridescence.md#scale). Twin of `interference.wgsl`.

use crate::maths::functions::{Real, clamp, real};
use crate::parameter::{Length, Parameter};
use bevy::reflect::{Reflect, std_traits::ReflectDefault};
use serde::{Deserialize, Serialize};

/// Factors on the thickness of a stack over the card: the rings of a peacock's eye, a bronzewing's spots.
///
/// Rows run from the skin to the tip in even steps of the card, each from its left to its right edge; between them the factors'
/// logarithm is linear.
#[derive(Clone, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[reflect(Default)]
#[serde(deny_unknown_fields)]
pub struct ScaleMap {
    /// Factors in a row, 1..64.
    #[reflect(@Parameter::new("", 1.0, 64.0))]
    pub columns: u32,
    /// The factors, row after row, 1..4096 in all: 0.6..1.6.
    #[reflect(@Parameter::new("", 0.6, 1.6), @Length::new(1, 4096))]
    pub factors: Vec<f32>,
}

/// One factor of 1 everywhere.
impl Default for ScaleMap {
    fn default() -> Self {
        Self {
            columns: 1,
            factors: vec![1.0],
        }
    }
}

/// Where a point of the card lies in a map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScalePlace<T> {
    /// Of the four factors around it the one nearest to the skin and to the left edge: column and row.
    pub low: [usize; 2],
    /// How far it lies towards the next column, and towards the next row.
    pub fraction: [T; 2],
}

/// The place of `(u, v)`, 0..1 each, among `columns` times `rows` factors.
pub fn scale_place<T: Real>(size: [usize; 2], uv: [T; 2]) -> ScalePlace<T> {
    let along = |i: usize| {
        let place = clamp(uv[i], T::zero(), T::one()) * real((size[i] - 1) as f64);
        let low = place.to_usize().unwrap_or(0).min(size[i].saturating_sub(2));
        (low, place - real(low as f64))
    };
    let ((column, t), (row, s)) = (along(0), along(1));
    ScalePlace {
        low: [column, row],
        fraction: [t, s],
    }
}

/// The value between four: at the place, one column on, one row on, both. Of factors: of their logarithms, or of the rows that they
/// lead to.
pub fn scale_mix<T: Real>(quad: [T; 4], fraction: [T; 2]) -> T {
    let mix = |a: T, b: T, t: T| a + (b - a) * t;
    let near = mix(quad[0], quad[1], fraction[0]);
    mix(near, mix(quad[2], quad[3], fraction[0]), fraction[1])
}

impl ScaleMap {
    /// Columns and rows; what no full row is left of counts as none.
    pub fn size(&self) -> [usize; 2] {
        let columns = (self.columns as usize)
            .clamp(1, 64)
            .min(self.factors.len().max(1));
        [columns, (self.factors.len() / columns).max(1)]
    }

    /// The factor in a column of a row, the last ones beyond; 1 where there is none.
    pub fn factor(&self, column: usize, row: usize) -> f32 {
        let [columns, rows] = self.size();
        let at = row.min(rows - 1) * columns + column.min(columns - 1);
        clamp(self.factors.get(at).copied().unwrap_or(1.0), 0.6, 1.6)
    }

    /// The four factors between whose logarithms [`scale_mix`] lies.
    pub fn quad(&self, [column, row]: [usize; 2]) -> [f32; 4] {
        let at = |x: usize, y: usize| self.factor(column + x, row + y);
        [at(0, 0), at(1, 0), at(0, 1), at(1, 1)]
    }

    /// The factor at a point of the card.
    pub fn at<T: Real>(&self, uv: [T; 2]) -> T {
        let place = scale_place(self.size(), uv);
        let quad = self.quad(place.low);
        scale_mix(quad.map(|x| real::<T>(f64::from(x)).log2()), place.fraction).exp2()
    }

    /// Least and greatest factor.
    pub fn range(&self) -> [f64; 2] {
        let ends = |[low, high]: [f32; 2], x: f32| [low.min(x), high.max(x)];
        let [columns, rows] = self.size();
        let all = (0..columns * rows).map(|i| self.factor(i % columns, i / columns));
        all.fold([f32::INFINITY, 0.0], ends).map(f64::from)
    }
}
