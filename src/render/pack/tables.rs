//! Feathers and their fibre tables as the shaders read them (`feather_data.wgsl`).

use super::{
    layout::{FEATHER_STRIDE, HEADER_LENGTH, header},
    stacks::{self, StackTables},
};
use crate::{
    anatomy::{Feather, Side},
    maths::query::{CardVane, Vane, vane_shape},
    maths::scattering::{
        FIBRE_ROW_VEC4S, FIBRE_ROWS, Fibre, FibreTable, KEPT_AZIMUTHS, KEPT_LEVELS,
        SHORT_TABLE_VEC4S, kept_light, mean_caught, mirror_place, sheen_row, shown_albedo,
    },
};

/// Tables are counted in steps of this many, so that an edit seldom changes the size of the buffer.
const TABLE_STEP: usize = 4;

/// Fibre tables built before, by what they were built from: building is the expensive part of packing.
#[derive(Default)]
pub struct TableCache {
    tables: Vec<(Fibre, FibreTable)>,
    kept: Vec<Kept>,
    /// Colors of thin layers.
    pub(crate) stacks: StackTables,
}

impl TableCache {
    /// A cache that knows the colors of these layers.
    pub fn with_stacks(stacks: StackTables) -> Self {
        Self {
            stacks,
            ..Self::default()
        }
    }

    /// Whether the short tables say all of these fibres.
    pub fn is_plain(&self) -> bool {
        self.tables.iter().all(|(_, table)| table.is_plain())
    }
}

/// The buffer `feathers` of one bird, in the order given: header, feathers, fibre tables, their short forms. Reuses the tables in `cache`, and leaves
/// in it those of these feathers.
pub fn pack_feathers(feathers: &[&Feather], cache: &mut TableCache) -> Vec<u8> {
    let known = std::mem::take(cache);
    let mut found = TableCache::default();
    let mut rows: Vec<[f32; 4]> = vec![[0.0; 4]];
    for feather in feathers {
        pack_feather(feather, &mut rows, &mut found, &known);
    }
    let first_table = rows.len();
    let tables = &found.tables;
    for (_, table) in tables {
        rows.extend(table.pack_rows());
    }
    let room = tables.len().next_multiple_of(TABLE_STEP) - tables.len();
    rows.resize(rows.len() + room * FIBRE_ROWS * FIBRE_ROW_VEC4S, [0.0; 4]);
    let first_short = rows.len();
    for (_, table) in tables {
        rows.extend(table.pack_short());
    }
    rows.resize(rows.len() + room * SHORT_TABLE_VEC4S, [0.0; 4]);
    rows[0] = [
        feathers.len() as f32,
        first_table as f32,
        tables.len() as f32,
        first_short as f32,
    ];
    stacks::append(feathers, &mut rows, &mut found.stacks, &known.stacks);
    *cache = found;
    rows.iter()
        .flatten()
        .flat_map(|value| value.to_le_bytes())
        .collect()
}

fn vane_rows(feather: &Feather, side: Side) -> [[f32; 4]; 5] {
    let CardVane {
        vane,
        fringe,
        downy,
    } = feather.card_vane::<f32>(side);
    let shape = vane_shape(&vane);
    let [distal, proximal] = shape.families;
    [
        [vane.sin_b, vane.cos_b, vane.sin_bl, vane.cos_bl],
        [vane.p_b, vane.d_bl, vane.r_b, vane.r_bd],
        [vane.r_bp, fringe, downy, shape.kappa],
        [shape.e_root, shape.per_barb, shape.per_barbule, shape.barb],
        [
            distal.radius,
            proximal.radius,
            distal.inverse,
            proximal.inverse,
        ],
    ]
}

/// What the fibres of a feather keep of light from all around.
#[derive(Clone)]
struct Kept {
    vanes: [Vane<f64>; 2],
    fibres: [Fibre; 4],
    dark_back: bool,
    /// The chance that light meets another fibre, and the table, seen from front and back.
    faces: [([f32; 4], Vec<[f32; 4]>); 2],
    /// One over the integral over the sphere of what the vanes catch.
    caught: f32,
}

impl Kept {
    fn new(
        vanes: [Vane<f64>; 2],
        fibres: [Fibre; 4],
        tables: [&FibreTable; 4],
        dark_back: bool,
    ) -> Self {
        let dark = f64::from(u8::from(dark_back));
        // The card's shaft lies between two vanes, often alike.
        let sides = if vanes[0] == vanes[1] { 1 } else { 2 };
        let faces = [true, false].map(|front| {
            let lights: Vec<_> = (0..sides)
                .map(|side| kept_light(&vanes[side], tables, dark, front))
                .collect();
            let mut rows = Vec::with_capacity(8 * KEPT_LEVELS * KEPT_AZIMUTHS);
            let mut meeting = [0.0; 4];
            for (part, meeting) in meeting.iter_mut().enumerate() {
                let normal = &tables[part].row(1.0)[0];
                let scattered: f64 = normal.iter().sum();
                for side in 0..2 {
                    for level in 0..KEPT_LEVELS {
                        for step in 0..KEPT_AZIMUTHS {
                            let row: [f64; 4] = std::array::from_fn(|lobe| {
                                let sum: f64 = lights
                                    .iter()
                                    .map(|light| light[part][side][level][step][lobe])
                                    .sum();
                                sum / sides as f64
                            });
                            if level == 0 && step == 0 {
                                *meeting += row.iter().zip(normal).map(|(a, b)| a * b).sum::<f64>();
                            }
                            rows.push(row.map(|x| x as f32));
                        }
                    }
                }
                *meeting = (1.0 - *meeting / scattered.max(1e-6)).clamp(0.0, 1.0);
            }
            (meeting.map(|x| x as f32), rows)
        });
        let caught = vanes.iter().map(mean_caught).sum::<f64>() * 0.5;
        Self {
            vanes,
            fibres,
            dark_back,
            faces,
            caught: (0.25 / std::f64::consts::PI / caught.max(1e-3)) as f32,
        }
    }
}

/// Palest color of a fibre, as the shaders have it.
const WHITEST: f32 = 0.98;

fn pack_feather(
    feather: &Feather,
    rows: &mut Vec<[f32; 4]>,
    found: &mut TableCache,
    known: &TableCache,
) {
    let start = rows.len();
    let shape = feather.shape_table();
    let mut head = [[0.0; 4]; HEADER_LENGTH];
    head[header::SHAPE] = [
        feather.aspect,
        feather.length_mm * 1e-3,
        shape.start,
        // Without colors of its own the back of a structural feather is dark (its mirrors face outwards).
        f32::from(u8::from(feather.albedo.back.is_none())),
    ];
    let mut put = |at: usize, values: &[[f32; 4]]| {
        head[at..at + values.len()].copy_from_slice(values);
    };
    put(header::LEFT_VANE, &vane_rows(feather, Side::Left));
    put(header::RIGHT_VANE, &vane_rows(feather, Side::Right));
    let sheen = feather.optics.sheen;
    put(
        header::SHEEN,
        &[[sheen.strength, sheen.roughness, 0.0, 0.0]],
    );
    let optics = &feather.optics;
    let mut index = [0.0; 4];
    let fibres = [optics.rachis, optics.barb, optics.distal, optics.proximal];
    let tables = &mut found.tables;
    for (slot, fibre) in fibres.into_iter().enumerate() {
        let table = tables
            .iter()
            .position(|(known, _)| *known == fibre)
            .unwrap_or_else(|| {
                let before = known.tables.iter().find(|(other, _)| *other == fibre);
                let table =
                    before.map_or_else(|| FibreTable::build(&fibre), |(_, table)| table.clone());
                tables.push((fibre, table));
                tables.len() - 1
            });
        let parameters = tables[table].1.pack_parameters();
        put(header::FIBRES + parameters.len() * slot, &parameters);
        index[slot] = table as f32;
    }
    let vanes = Side::BOTH.map(|side| feather.query_vane(side));
    let dark_back = feather.albedo.back.is_none();
    let alike =
        |kept: &&Kept| kept.vanes == vanes && kept.fibres == fibres && kept.dark_back == dark_back;
    let kept = found
        .kept
        .iter()
        .find(alike)
        .or_else(|| known.kept.iter().find(alike));
    let kept = kept.cloned().unwrap_or_else(|| {
        let tables = index.map(|i: f32| &found.tables[i as usize].1);
        Kept::new(vanes, fibres, tables, dark_back)
    });
    let share = feather.albedo.share;
    let shares = [share.rachis, share.barb, share.barbule, share.barbule];
    let [(front, _), (back, _)] = &kept.faces;
    let parts: [[f32; 4]; 4] =
        std::array::from_fn(|part| [shares[part], front[part], back[part], index[part]]);
    put(header::PARTS, &parts);
    put(header::CAUGHT, &[[kept.caught, 0.0, 0.0, 0.0]]);
    let [barb, barbule] = [1, 2].map(|slot| mirror_place(&found.tables[index[slot] as usize].1));
    let mirrors = [barb.blur, barb.retreat, barbule.blur, barbule.retreat];
    put(header::MIRRORS, &[mirrors.map(|x| x as f32)]);
    // Of barbules those that the eye meets first.
    let paint = |ahead: usize, behind: usize| -> [f32; 4] {
        let fibre = |part: usize| found.tables[index[part] as usize].1.fibre();
        let share = |part: usize| shares[part].max(1e-3);
        let dark = |face: &[f32; 4], part: usize| {
            shown_albedo(fibre(part).darkest(), f64::from(face[part])) as f32 / share(part)
        };
        [
            dark(front, ahead),
            dark(back, behind),
            WHITEST / share(ahead),
            f32::from(u8::from(fibre(ahead).structural)),
        ]
    };
    put(header::PAINT, &[paint(1, 1), paint(2, 3)]);
    rows.extend(head);
    rows.extend_from_slice(&shape.rachis);
    rows.extend_from_slice(&shape.contour);
    rows.extend(sheen_row(sheen.roughness));
    for (_, table) in &kept.faces {
        rows.extend_from_slice(table);
    }
    found.kept.push(kept);
    debug_assert_eq!(rows.len() - start, FEATHER_STRIDE);
}
