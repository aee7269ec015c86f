//! Which share of its card a feather's outline holds, as a map of bytes.

use super::{CONTOUR_ROWS, Feather, RACHIS_ROWS, ShapeTable, Side};
use crate::maths::{
    card::{barb_cotangent, contour_row},
    query::{MAP_MARGIN, MAP_SIZE},
};

/// Lines of samples through a texel.
const LINES: u32 = 4;
/// Samples of a texel on a line.
const SAMPLES: u32 = 2;

/// A feather's outline as the map holds it.
struct Outline<'a> {
    table: &'a ShapeTable,
    aspect: f32,
    /// Cotangents of the angles of the barbs, left and right.
    cotangents: [f32; 2],
}

/// Linear between the rows of a table.
pub(super) fn between<const N: usize>(rows: &[[f32; N]], place: f32, column: usize) -> f32 {
    let last = rows.len() - 1;
    let i = (place as usize).min(last.saturating_sub(1));
    let (low, high) = (rows[i][column], rows[(i + 1).min(last)][column]);
    low + (high - low) * (place - i as f32)
}

impl Outline<'_> {
    /// How far inside a point of the card is, in feather lengths across (below 0: outside).
    fn depth(&self, u: f32, curve: f32, v: f32) -> f32 {
        let x = (u - curve) * self.aspect;
        let side = usize::from(x > 0.0);
        let root = v - x.abs() * self.cotangents[side];
        let row = contour_row(root, self.table.start, CONTOUR_ROWS as f32);
        let reach = between(&self.table.contour, row, side);
        (reach - x.abs()).min(root - self.table.start)
    }
}

/// Share of the way from a depth to another one that is inside, where depth grows evenly.
fn inside(from: f32, to: f32) -> f32 {
    let (low, high) = (from.min(to), from.max(to));
    if low >= 0.0 {
        1.0
    } else if high <= 0.0 {
        0.0
    } else {
        high / (high - low)
    }
}

impl Feather {
    /// The first level of the map of the outline, [`MAP_SIZE`] texels, row after row from the root to the tip: share of each inside the
    /// outline, 0..=255. Splits and clumps are in it; the rachis is not.
    pub fn outline_map(&self) -> Vec<u8> {
        let table = self.shape_table();
        let outline = Outline {
            table: &table,
            aspect: self.aspect,
            cotangents: Side::BOTH.map(|side| {
                let vane = self.query_vane::<f32>(side);
                barb_cotangent(vane.sin_b, vane.cos_b)
            }),
        };
        let [width, height] = MAP_SIZE;
        let margin = MAP_MARGIN as f32;
        let of_card = |place: f32, size: u32| (place - margin) / (size as f32 - 2.0 * margin);
        let mut depths = vec![0.0; (width * SAMPLES) as usize + 1];
        let mut map = Vec::with_capacity((width * height) as usize);
        for row in 0..height {
            let mut sums = vec![0.0; width as usize];
            for line in 0..LINES {
                let v = of_card(row as f32 + (line as f32 + 0.5) / LINES as f32, height);
                let place = v.clamp(0.0, 1.0) * (RACHIS_ROWS - 1) as f32;
                let curve = between(&table.rachis, place, 0);
                for (i, depth) in depths.iter_mut().enumerate() {
                    *depth = outline.depth(of_card(i as f32 / SAMPLES as f32, width), curve, v);
                }
                for (sum, depths) in sums.iter_mut().zip(
                    depths
                        .windows(SAMPLES as usize + 1)
                        .step_by(SAMPLES as usize),
                ) {
                    let pairs = depths.windows(2).map(|pair| inside(pair[0], pair[1]));
                    *sum += pairs.sum::<f32>();
                }
            }
            let most = (LINES * SAMPLES) as f32;
            map.extend(sums.iter().map(|sum| (255.0 * sum / most).round() as u8));
        }
        map
    }
}
