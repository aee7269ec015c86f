//! Thin layers of the feathers that have some, behind the fibre tables (`feather_iridescence.wgsl`).

use super::layout::{FEATHER_STRIDE, header};
use crate::{
    anatomy::Feather,
    maths::scattering::interference::{
        Facets, Iridescence, SeenTable, StackTable, bare, facet_constants, scale_rows, scaled_row,
    },
};

/// Where the parts of a stack begin, in vec4s from its place.
pub mod stack {
    /// Flatness, slope, how much of the stack the inner side has, texels of a row.
    pub const SIDE: usize = 0;
    /// Sine and cosine of rise and tilt.
    pub const TURN: usize = 1;
    /// Two constants of the side, and the number of rows of texels.
    pub const ROWS: usize = 2;
    /// Of the map of rows: its place in the buffer, columns, rows.
    pub const MAP: usize = 3;
    /// What an eye sees: energy, area; for every row. Behind that the rows: color, and the reflectance of bare keratin.
    pub const SEEN: usize = 4;
}

/// What a table of colors is computed from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layers {
    /// The stack.
    pub stack: Iridescence,
    /// Least and greatest factor on its thickness.
    pub scales: [f64; 2],
}

impl Layers {
    /// The layers of a feather, if it has some.
    pub fn of(feather: &Feather) -> Option<Self> {
        let map = feather.iridescence_scale.as_ref();
        Some(Self {
            stack: feather.iridescence?,
            scales: map.map_or([1.0; 2], |map| map.range()),
        })
    }

    /// Whether the table of one is that of the other.
    pub fn same(&self, other: &Self) -> bool {
        self.scales == other.scales && self.stack.same_layers(&other.stack)
    }

    /// Computes the table.
    pub fn build(&self) -> StackTable {
        StackTable::scaled(&self.stack, self.scales)
    }

    /// Rows of the table.
    pub fn rows(&self) -> usize {
        scale_rows(self.scales)
    }

    /// Computes one row of it.
    pub fn row(&self, i: usize) -> Vec<[f64; 3]> {
        scaled_row(&self.stack, self.scales, i)
    }

    /// The table of all rows, one after the other.
    pub fn joined(&self, texels: Vec<[f64; 3]>) -> StackTable {
        StackTable::joined(texels, self.scales)
    }
}

/// Tables by the layers that they were computed from.
pub type StackTables = Vec<(Layers, StackTable)>;

/// The table of these layers.
pub fn find<'a>(tables: &'a [(Layers, StackTable)], layers: &Layers) -> Option<&'a StackTable> {
    let alike = |(known, _): &&(Layers, StackTable)| known.same(layers);
    tables.iter().find(alike).map(|(_, table)| table)
}

/// Appends the stacks of feathers whose headers stand in `rows` from 1 on, and puts the place of each into its header. Tables that are
/// not in `known` are computed here and now.
pub(super) fn append(
    feathers: &[&Feather],
    rows: &mut Vec<[f32; 4]>,
    found: &mut StackTables,
    known: &[(Layers, StackTable)],
) {
    for (i, feather) in feathers.iter().enumerate() {
        let Some(layers) = Layers::of(feather) else {
            continue;
        };
        if find(found, &layers).is_none() {
            let table = find(known, &layers).cloned();
            found.push((layers, table.unwrap_or_else(|| layers.build())));
        }
        let Some(table) = find(found, &layers) else {
            continue;
        };
        let place = rows.len();
        rows[1 + i * FEATHER_STRIDE + header::SHEEN][2] = place as f32;
        append_stack(rows, &layers.stack, table);
        if let Some(map) = &feather.iridescence_scale {
            let [width, height] = map.size();
            let at = rows.len() as f32;
            rows[place + stack::MAP][..3].copy_from_slice(&[at, width as f32, height as f32]);
            let steps = |count: usize| 0..(count - 1).max(1);
            let row = |factor: f32| table.row_place(factor);
            let quad = |x: usize, y: usize| map.quad([x, y]).map(row);
            rows.extend(steps(height).flat_map(|y| steps(width).map(move |x| quad(x, y))));
        }
    }
}

/// How the side lies, what an eye sees of it, the texels.
fn append_stack(rows: &mut Vec<[f32; 4]>, parameters: &Iridescence, table: &StackTable) {
    let p = parameters.limited();
    let ((sin_r, cos_r), (sin_t, cos_t)) =
        (p.rise.to_radians().sin_cos(), p.tilt.to_radians().sin_cos());
    let facets = Facets {
        flatness: f64::from(p.flatness),
        slope: f64::from(p.slope).to_radians(),
        back: f64::from(p.back),
    };
    let (columns, constants) = (table.columns(), facet_constants(&facets));
    rows.push([p.flatness, p.slope.to_radians(), p.back, columns as f32]);
    rows.push([sin_r, cos_r, sin_t, cos_t]);
    let [across, along] = constants.map(|x| x as f32);
    rows.push([across, along, table.rows as f32, 0.0]);
    rows.push([0.0, 1.0, 1.0, 0.0]);
    let seen = SeenTable::build(&facets, table);
    rows.extend(seen.texels.iter().map(|texel| texel.map(|x| x as f32)));
    rows.extend(
        table
            .texels
            .iter()
            .enumerate()
            .map(|(i, [r, g, b])| [*r, *g, *b, bare(i % columns, columns)].map(|x| x as f32)),
    );
}
