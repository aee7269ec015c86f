//! Random fibres and directions for the shader twins, and the same in double precision.

use bevy_plumage::maths::scattering::*;
use plumage_reference::fibre_traced::uniform;
use rand_pcg::Pcg64Mcg;
use std::f64::consts::PI;

/// WGSL that reads what [`pack`] writes, from the `input` of [`run`](crate::gpu::run).
pub const LOAD: &str = "
const FIBRE_FLOATS: u32 = 860u;

fn load(at: u32) -> vec4<f32> {
    return vec4<f32>(input[at], input[at + 1u], input[at + 2u], input[at + 3u]);
}

fn load_parameters(at: u32) -> array<vec4<f32>, 7> {
    var v: array<vec4<f32>, 7>;
    for (var k = 0u; k < 7u; k++) {
        v[k] = load(at + 4u * k);
    }
    return v;
}

fn load_row(at: u32) -> array<vec4<f32>, 13> {
    var row: array<vec4<f32>, 13>;
    for (var k = 0u; k < 13u; k++) {
        row[k] = load(at + 4u * k);
    }
    return row;
}
";

/// One evaluation.
pub struct Case {
    pub fibre: usize,
    pub albedo: [f32; 3],
    pub omega_o: [f32; 3],
    pub omega_i: [f32; 3],
    pub dark_back: f32,
    pub harmonics: u32,
}

pub fn fibres() -> Vec<Fibre> {
    let mut list = Vec::new();
    for (i, core_radius) in [0.0, 0.3, 0.6, 0.7, 0.9].into_iter().enumerate() {
        list.push(Fibre {
            kind: FibreKind::Structural { core_radius },
            longitudinal_roughness: [0.05, 0.1, 0.2, 0.4, 0.8][i],
            azimuthal_roughness: [0.2, 0.3, 0.5, 0.25, 0.9][i],
            aspect: [1.0, 0.4, 1.0, 0.7, 0.2][i],
            ..Fibre::default()
        });
    }
    list.push(Fibre::default());
    list.push(Fibre {
        tilt: 0.15,
        kind: FibreKind::Pigment {
            medulla_radius: 0.5,
            scattering: 6.0,
            anisotropy: 0.7,
        },
        ..Fibre::default()
    });
    list.push(Fibre {
        eta: 1.4,
        aspect: 0.5,
        longitudinal_roughness: 0.01,
        ..Fibre::default()
    });
    list
}

pub fn pack(tables: &[FibreTable], cases: &[Case]) -> Vec<f32> {
    let mut input = vec![tables.len() as f32, 0.0, 0.0, 0.0];
    for t in tables {
        input.extend(t.pack_parameters().iter().flatten());
        input.extend(t.pack_rows().iter().flatten());
    }
    for c in cases {
        input.push(c.fibre as f32);
        input.extend(c.albedo.iter().chain(&c.omega_o).chain(&c.omega_i));
        input.extend([c.dark_back, c.harmonics as f32]);
    }
    input
}

/// The same in double precision, on the very numbers that the GPU gets.
pub fn shade(table: &FibreTable, c: &Case) -> FibreShading<f64> {
    let o = c.omega_o.map(f64::from);
    let [p, q, r, ..] = table.pack_parameters().map(|v| v.map(f64::from));
    let row = exact_row(table, c);
    fibre_shading(
        &fibre_parameters(p, q, r),
        &row,
        c.albedo.map(f64::from),
        o,
        f64::from(c.dark_back),
        c.harmonics,
    )
}

/// The table's row as the GPU reads it, mixed in double precision.
pub fn exact_row(table: &FibreTable, c: &Case) -> FibreRow<f64> {
    let o = c.omega_o.map(f64::from);
    let (i, f) = fibre_row_at((o[1] * o[1] + o[2] * o[2]).sqrt());
    let rows: Vec<FibreRow<f64>> = table
        .rows
        .iter()
        .map(|r| r.map(|v| v.map(|x| f64::from(x as f32))))
        .collect();
    fibre_row_mix(&rows[i], &rows[i + 1], f)
}

/// A direction, evenly.
pub fn on_sphere(random: &mut Pcg64Mcg) -> [f32; 3] {
    let (z, a) = (2.0 * uniform(random) - 1.0, 2.0 * PI * uniform(random));
    let r = (1.0 - z * z).sqrt();
    [(r * a.cos()) as f32, (r * a.sin()) as f32, z as f32]
}
