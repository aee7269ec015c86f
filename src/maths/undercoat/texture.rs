//! Fur drawn hair by hair into a periodic [`Tile`] (docs/book/undercoat.md#density; Kloetzli 2005, section 2.1).
//!
//! Hairs are cones that curl along a parabola. Each layer holds the exact area that the hairs' cross sections cover, and their
//! mean direction, without which no hair can be lit as a fibre.

use super::{Tile, coverage::disc_coverage};
use crate::maths::seed::{Stream, mix};
use bevy::math::{UVec3, Vec2, Vec3};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Most cells of a tile, and most hairs.
pub const MOST_CELLS: u64 = 1 << 24;
/// Most hairs of one coat.
pub const MOST_HAIRS: u32 = 1 << 20;

/// One coat of hairs; a fur has a dense, short undercoat and a sparse, long overcoat.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Coat {
    /// Hairs in the tile.
    pub hairs: u32,
    /// Least and greatest radius at the root, in cells (0 to 8).
    pub radius: [f32; 2],
    /// Least and greatest length, in heights of the coat (0 to 1).
    pub length: [f32; 2],
    /// Least and greatest shift of the tip sideways, in cells (0 to 64).
    pub curl: [f32; 2],
}

/// What a fur texture is made of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Fur {
    /// Cells along x, y (the skin) and z.
    pub size: UVec3,
    /// Width of the tile in heights of the coat.
    pub width: f32,
    /// Mean optical depth of the coat, seen straight down.
    pub optical_depth: f32,
    /// The coats.
    pub coats: Vec<Coat>,
    /// Seed of every hair.
    pub seed: u64,
}

impl Default for Fur {
    /// 64 x 64 x 32 cells with 2600 hairs of undercoat and 260 of overcoat: the `hair` volume of docs/book/undercoat.md.
    fn default() -> Self {
        Self {
            size: UVec3::new(64, 64, 32),
            width: 2.0,
            optical_depth: 4.0,
            coats: coats(2600, 260),
            seed: 1,
        }
    }
}

impl Fur {
    /// The 55,000 hairs and 32 layers of Kloetzli 2005, Fig. 1, at the default's cells per hair:
    /// 256 x 256 x 32.
    pub fn dense() -> Self {
        Self {
            size: UVec3::new(256, 256, 32),
            width: 8.0,
            coats: coats(50_000, 5_000),
            ..Self::default()
        }
    }
}

fn coats(under: u32, over: u32) -> Vec<Coat> {
    vec![
        Coat {
            hairs: under,
            radius: [0.15, 0.35],
            length: [0.25, 0.6],
            curl: [0.5, 5.0],
        },
        Coat {
            hairs: over,
            radius: [0.35, 0.5],
            length: [0.75, 1.0],
            curl: [1.0, 8.0],
        },
    ]
}

/// A fur that cannot be drawn.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum FurError {
    /// A number outside its range.
    #[error("{field} is {value}; allowed are {low} to {high}")]
    OutOfRange {
        /// What it is, e.g. `coats[0].radius`.
        field: String,
        /// What was given.
        value: f64,
        /// Least allowed value.
        low: f64,
        /// Greatest allowed value.
        high: f64,
    },
    /// The hairs cover nothing, so that no optical depth can be reached.
    #[error("no hair covers any cell: the tile would be empty")]
    Empty,
}

fn within(field: impl Into<String>, value: f64, low: f64, high: f64) -> Result<(), FurError> {
    // A NaN is in no range.
    if value >= low && value <= high {
        return Ok(());
    }
    Err(FurError::OutOfRange {
        field: field.into(),
        value,
        low,
        high,
    })
}

fn check(fur: &Fur) -> Result<(), FurError> {
    for (name, n) in [
        ("size.x", fur.size.x),
        ("size.y", fur.size.y),
        ("size.z", fur.size.z),
    ] {
        within(name, f64::from(n), 1.0, 1024.0)?;
    }
    let cells = fur
        .size
        .to_array()
        .iter()
        .map(|n| u64::from(*n))
        .product::<u64>();
    within("number of cells", cells as f64, 1.0, MOST_CELLS as f64)?;
    within("width", f64::from(fur.width), 0.01, 1000.0)?;
    within("optical_depth", f64::from(fur.optical_depth), 0.01, 100.0)?;
    for (i, coat) in fur.coats.iter().enumerate() {
        within(
            format!("coats[{i}].hairs"),
            f64::from(coat.hairs),
            0.0,
            f64::from(MOST_HAIRS),
        )?;
        for (name, range, least, most) in [
            ("radius", coat.radius, 0.0, 8.0),
            ("length", coat.length, 0.01, 1.0),
            ("curl", coat.curl, 0.0, 64.0),
        ] {
            within(
                format!("coats[{i}].{name}"),
                f64::from(range[0]),
                least,
                most,
            )?;
            within(
                format!("coats[{i}].{name}"),
                f64::from(range[1]),
                f64::from(range[0]),
                most,
            )?;
        }
    }
    Ok(())
}

/// What lies in a cell: area covered, and the sum of area times direction.
#[derive(Clone, Copy, Default)]
struct Cell {
    area: f32,
    tangent: Vec3,
}

/// Draws the hairs of `fur` into a tile.
pub fn fur_tile(fur: &Fur) -> Result<Tile, FurError> {
    check(fur)?;
    let size = fur.size.as_usizevec3();
    let mut cells = vec![Cell::default(); size.element_product()];
    for (number, coat) in fur.coats.iter().enumerate() {
        for hair in 0..coat.hairs {
            let key = mix(mix(fur.seed, number as u64), u64::from(hair));
            draw(fur, coat, key, &mut cells);
        }
    }
    let covered: f64 = cells.iter().map(|c| f64::from(c.area.min(1.0))).sum();
    if covered <= 0.0 {
        return Err(FurError::Empty);
    }
    let scale = (f64::from(fur.optical_depth) * cells.len() as f64 / covered) as f32;
    let extinction = cells.iter().map(|c| c.area.min(1.0) * scale).collect();
    let tangent = tangents(size.to_array(), &cells);
    Tile::new(fur.size, fur.width, extinction, tangent).ok_or(FurError::Empty)
}

fn draw(fur: &Fur, coat: &Coat, key: u64, cells: &mut [Cell]) {
    let mut random = Stream::new(key);
    let mut between = |[low, high]: [f32; 2]| low + (high - low) * random.uniform();
    let size = fur.size;
    let root = Vec2::new(between([0.0, size.x as f32]), between([0.0, size.y as f32]));
    let radius = between(coat.radius);
    let length = between(coat.length);
    let curl = Vec2::from_angle(between([0.0, std::f32::consts::TAU])) * between(coat.curl);
    let cell_width = Vec2::new(fur.width / size.x as f32, fur.width / size.y as f32);
    let layer = (size.x * size.y) as usize;
    for z in 0..size.z {
        let along = (z as f32 + 0.5) / (size.z as f32 * length);
        if along >= 1.0 {
            break;
        }
        let centre = root + curl * along * along;
        let r = radius * (1.0 - along);
        let slope = curl * cell_width * (2.0 * along / length);
        let tangent = slope.extend(1.0).normalize();
        let low = (centre - r).floor().as_ivec2();
        let high = (centre + r).floor().as_ivec2();
        for y in low.y..=high.y {
            for x in low.x..=high.x {
                let place = [
                    f64::from(centre.x) - f64::from(x),
                    f64::from(centre.y) - f64::from(y),
                ];
                let area = disc_coverage(f64::from(r), place) as f32;
                let (i, j) = (x.rem_euclid(size.x as i32), y.rem_euclid(size.y as i32));
                let cell =
                    &mut cells[z as usize * layer + i as usize + j as usize * size.x as usize];
                cell.area += area;
                cell.tangent += area * tangent;
            }
        }
    }
}

/// Directions of all cells. An empty cell takes those of its neighbors in the layer, so that a filtered look-up does not mix
/// in a direction that is not there; one without neighbors stands up.
fn tangents(size: [usize; 3], cells: &[Cell]) -> Vec<Vec3> {
    let [nx, ny, _] = size;
    (0..cells.len())
        .map(|i| {
            if cells[i].area > 0.0 {
                return cells[i].tangent.normalize_or(Vec3::Z);
            }
            let (x, y, layer) = (i % nx, i / nx % ny, i / (nx * ny) * nx * ny);
            let mut sum = Vec3::ZERO;
            for dy in [ny - 1, 0, 1] {
                for dx in [nx - 1, 0, 1] {
                    sum += cells[layer + (y + dy) % ny * nx + (x + dx) % nx].tangent;
                }
            }
            sum.normalize_or(Vec3::Z)
        })
        .collect()
}
