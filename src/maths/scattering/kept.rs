//! What the fibres of a vane keep of light from all around, by where the eye is: with it the energy of light that meets several
//! fibres follows from the light that meets one.

use super::{FibreTable, Lobe, fibre_lobes, fibre_local, fibre_shading};
use crate::maths::{
    gauss_legendre,
    query::{
        MirrorPlace, Vane, barb_light, lower_light, mirror_retreat, shaft_light, storeys,
        upper_light, vane_caught, vane_eye, vane_ray, vane_shape,
    },
    vector::dot,
};
use std::f64::consts::{PI, TAU};

/// Inclinations of the eye at which a table of kept light is taken: even steps of the root of
/// 1 - cosine, from the normal to `LAST_PLACE`.
pub const KEPT_LEVELS: usize = 10;
/// Azimuths of the eye over the vane: even steps of y/(|x| + |y|) from -1 to 1, x >= 0 across the barbs, y along them. A vane turned by
/// half a turn looks the same, so the last step leads to the first.
pub const KEPT_AZIMUTHS: usize = 8;

/// Shares of light kept by one part, by level and azimuth: of R, TT, TRT and TRcT or the medulla.
pub type KeptPart = [[[f64; 4]; KEPT_AZIMUTHS]; KEPT_LEVELS];

/// What rachis, barbs, distal and proximal barbules of a vane keep of light from all around, seen from one face: from the eye's side
/// and from the other.
pub type KeptLight = [[KeptPart; 2]; 4];

/// Directions of light: along a fibre, within the cone of its mirror lobes and on either side of it, and around it.
const NODES: usize = 6;
const TURNS: usize = 20;
/// Half width of that cone in longitudinal roughnesses.
const CONE: f64 = 3.0;
/// Turns from one row of directions to the next, in their distance: no row of them lies along the horizon more than another.
const LATTICE: f64 = 0.618_033_988_75;
/// Root of 1 - cosine at the last level: 79 degrees.
const LAST_PLACE: f64 = 0.9;

/// Shares of R, TT, TRT and the fourth lobe from a part's table. `eye`: unit, across and along the barbs and along the normal.
pub fn kept_at(part: &KeptPart, [across, along, facing]: [f64; 3]) -> [f64; 4] {
    let root = (1.0 - facing.abs()).max(0.0).sqrt() / LAST_PLACE;
    let place = root.min(1.0) * (KEPT_LEVELS - 1) as f64;
    let level = (place as usize).min(KEPT_LEVELS - 2);
    let fraction = place - level as f64;
    let along = if across < 0.0 { -along } else { along };
    let turn = along / (across.abs() + along.abs()).max(1e-9);
    let turn = 0.5 * (turn + 1.0) * KEPT_AZIMUTHS as f64;
    let step = (turn as usize).min(KEPT_AZIMUTHS - 1);
    let beside = turn - step as f64;
    let mix = |a: f64, b: f64, fraction: f64| a + (b - a) * fraction;
    std::array::from_fn(|lobe| {
        let at = |level: usize| {
            let next = (step + 1) % KEPT_AZIMUTHS;
            mix(part[level][step][lobe], part[level][next][lobe], beside)
        };
        mix(at(level), at(level + 1), fraction)
    })
}

/// Where the mirror lobes of a fibre leave it.
pub fn mirror_place(table: &FibreTable) -> MirrorPlace<f64> {
    let p = table.fibre();
    MirrorPlace {
        blur: p.azimuthal_roughness,
        retreat: if p.structural {
            mirror_retreat(p.core, p.eta)
        } else {
            0.0
        },
    }
}

/// Direction of a part's fibres over the left vane: rachis, barbs, distal and proximal barbules.
pub fn part_tangent(vane: &Vane<f64>, part: usize) -> [f64; 3] {
    let (c, s) = (vane.cos_bl, vane.sin_bl);
    let barb = [-vane.sin_b, vane.cos_b];
    let turn = match part {
        0 => return [0.0, 1.0, 0.0],
        1 => 0.0,
        2 => s,
        _ => -s,
    };
    let c = if part == 1 { 1.0 } else { c };
    [
        barb[0] * c + barb[1] * turn,
        barb[1] * c - barb[0] * turn,
        0.0,
    ]
}

/// The table of a left vane, seen from the front or the back. `tables`: of rachis, barbs, distal and proximal barbules. Colorless,
/// since a lobe's share hardly depends on its color.
pub fn kept_light(
    vane: &Vane<f64>,
    tables: [&FibreTable; 4],
    dark_back: f64,
    front: bool,
) -> KeptLight {
    let nodes = gauss_legendre(NODES);
    let mirrors = [mirror_place(tables[1]), mirror_place(tables[2])];
    let up = if front { 1.0 } else { -1.0 };
    let mut kept = [[[[[0.0; 4]; KEPT_AZIMUTHS]; KEPT_LEVELS]; 2]; 4];
    for level in 0..KEPT_LEVELS {
        let place = LAST_PLACE * level as f64 / (KEPT_LEVELS - 1) as f64;
        let facing = 1.0 - place * place;
        for step in 0..KEPT_AZIMUTHS {
            if level == 0 && step > 0 {
                // Along the normal there is no azimuth.
                for side in kept.iter_mut().flatten() {
                    side[0][step] = side[0][0];
                }
                continue;
            }
            let along = 2.0 * step as f64 / KEPT_AZIMUTHS as f64 - 1.0;
            let across = 1.0 - along.abs();
            let scale = (1.0 - facing * facing).sqrt() / across.hypot(along);
            let (across, along) = (across * scale, along * scale);
            let eye = [
                across * vane.cos_b - along * vane.sin_b,
                across * vane.sin_b + along * vane.cos_b,
                up * facing,
            ];
            let sight = vane_eye(vane, eye, mirrors);
            for (part, table) in tables.into_iter().enumerate() {
                let reaching = |light: [f64; 3]| {
                    let ray = vane_ray(&sight, light);
                    let seen = match part {
                        0 => shaft_light(&ray),
                        1 => barb_light(&sight, &ray),
                        _ if (part == 2) == front => upper_light(&sight, &ray),
                        _ => lower_light(&sight, &ray),
                    };
                    [seen.mirror, seen.even]
                };
                let tangent = part_tangent(vane, part);
                let shares = kept_shares(table, tangent, eye, dark_back, &nodes, reaching);
                for (kept, shares) in kept[part].iter_mut().zip(shares) {
                    kept[level][step] = shares;
                }
            }
        }
    }
    kept
}

/// Shares of R, TT, TRT and the fourth lobe that arrive from the eye's side and from the other, for one fibre and eye.
fn kept_shares(
    table: &FibreTable,
    tangent: [f64; 3],
    eye: [f64; 3],
    dark_back: f64,
    nodes: &[(f64, f64)],
    reaching: impl Fn([f64; 3]) -> [f64; 2],
) -> [[f64; 4]; 2] {
    const NORMAL: [f64; 3] = [0.0, 0.0, 1.0];
    let local = fibre_local(tangent, NORMAL, eye);
    let row = table.row((1.0 - local[0] * local[0]).max(0.0).sqrt());
    let mut shading = fibre_shading(&table.fibre(), &row, [1.0; 3], local, dark_back, 8);
    // Each lobe alone in a channel of its kind.
    let structural = shading.structural;
    shading.energy = [[0.0; 3]; 4];
    shading.energy[Lobe::R as usize][0] = 1.0;
    shading.energy[Lobe::TT as usize][1] = 1.0;
    shading.energy[Lobe::TRT as usize][2] = 1.0;
    shading.energy[Lobe::TRcT as usize][usize::from(structural)] = 1.0;
    shading.dense = [0.0; 3];
    // The normal crossed with the tangent.
    let towards = [-tangent[1], tangent[0], 0.0];
    let (mut sums, mut all) = ([[0.0; 4]; 2], [0.0; 4]);
    // Three panels of the sine of the light's inclination.
    let (cone, half) = (-shading.eye[0].0, CONE / shading.spread[0].inverse.sqrt());
    let edges = [-1.0, cone - half, cone + half, 1.0].map(|x| x.clamp(-1.0, 1.0));
    let panels = edges.windows(2).flat_map(|edge| {
        let half = 0.5 * (edge[1] - edge[0]);
        nodes
            .iter()
            .map(move |&(x, weight)| (edge[0] + half * (x + 1.0), weight * half))
    });
    for (i, (sine, weight)) in panels.enumerate() {
        let shift = (LATTICE * i as f64).fract();
        let cosine = (1.0 - sine * sine).max(0.0).sqrt();
        for turn in 0..TURNS {
            let (s, c) = (TAU * (turn as f64 + shift) / TURNS as f64).sin_cos();
            let light: [f64; 3] = std::array::from_fn(|i| {
                sine * tangent[i] + cosine * (s * towards[i] + c * NORMAL[i])
            });
            let at = fibre_local(tangent, NORMAL, light);
            let k = fibre_lobes(&shading, at);
            let [mirror, even] = reaching(light);
            let other = usize::from(dot(light, NORMAL) * eye[2] < 0.0);
            let lobes = [
                (k.mirror[0], mirror),
                (k.even[1], even),
                (k.mirror[2], mirror),
                if structural {
                    (k.mirror[1], mirror)
                } else {
                    (k.even[0], even)
                },
            ];
            for (i, (k, share)) in lobes.into_iter().enumerate() {
                all[i] += weight * k;
                sums[other][i] += weight * k * share;
            }
        }
    }
    sums.map(|side| std::array::from_fn(|i| side[i] / f64::max(all[i], 1e-12)))
}

/// Mean over the sphere of what a vane catches of light ([`vane_caught`]).
pub fn mean_caught(vane: &Vane<f64>) -> f64 {
    const DIRECTIONS: usize = 256;
    let golden = PI * (3.0 - 5.0_f64.sqrt());
    let shape = vane_shape(vane);
    (0..DIRECTIONS)
        .map(|i| {
            let z = 1.0 - 2.0 * (i as f64 + 0.5) / DIRECTIONS as f64;
            let (s, c) = (golden * i as f64).sin_cos();
            let r = (1.0 - z * z).sqrt();
            vane_caught(&shape, &storeys(&shape, [r * c, r * s, z]), z) / DIRECTIONS as f64
        })
        .sum()
}
