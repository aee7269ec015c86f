//! Thin layers of the feathers that have some, behind the fibre tables (`feather_iridescence.wgsl`).

use super::tables::{FEATHER_STRIDE, header};
use crate::{
    anatomy::Feather,
    maths::scattering::interference::{Iridescence, StackTable},
};

/// Tables by the layers that they were computed from.
pub type StackTables = Vec<(Iridescence, StackTable)>;

/// The table of these layers.
pub fn find<'a>(
    tables: &'a [(Iridescence, StackTable)],
    layers: &Iridescence,
) -> Option<&'a StackTable> {
    let alike = |(known, _): &&(Iridescence, StackTable)| known.same_layers(layers);
    tables.iter().find(alike).map(|(_, table)| table)
}

/// Appends the stacks of feathers whose headers stand in `rows` from 1 on, and puts the place of each into its header. Tables that are
/// not in `known` are computed here and now.
pub(super) fn append(
    feathers: &[&Feather],
    rows: &mut Vec<[f32; 4]>,
    found: &mut StackTables,
    known: &[(Iridescence, StackTable)],
) {
    for (i, feather) in feathers.iter().enumerate() {
        let Some(layers) = &feather.iridescence else {
            continue;
        };
        if find(found, layers).is_none() {
            let table = find(known, layers).cloned();
            let table = table.unwrap_or_else(|| StackTable::build(layers));
            found.push((*layers, table));
        }
        let Some(table) = find(found, layers) else {
            continue;
        };
        let place = rows.len() as f32;
        rows[1 + i * FEATHER_STRIDE + header::SHEEN][2] = place;
        let p = layers.limited();
        let ((sin_r, cos_r), (sin_t, cos_t)) =
            (p.rise.to_radians().sin_cos(), p.tilt.to_radians().sin_cos());
        // How the side lies, then the texels.
        rows.push([p.flatness, p.slope.to_radians(), p.back, 0.0]);
        rows.push([sin_r, cos_r, sin_t, cos_t]);
        let texel = |c: &[f64; 3]| [c[0] as f32, c[1] as f32, c[2] as f32, 0.0];
        rows.extend(table.texels.iter().map(texel));
    }
}
