//! What an eye sees of a side's facets, tabled over its direction (docs/book/iridescence.md#seen). Twin of `interference.wgsl`.

use super::facet::{facet_node, facet_view};
use super::{Facets, StackTable, cell_simplex};
use crate::maths::functions::{Real, clamp, real};
use std::f64::consts::{FRAC_2_PI, FRAC_PI_2, PI};

/// Steps of the table in either direction.
pub const SEEN_STEPS: usize = 16;
/// Nodes on one side of the facet that looks at the eye: a rule that resolves the rim of the flattest side.
const NODES: usize = 48;
/// Factor of the slopes' part in [`facet_area`]: between energies that are too large edge-on and too small along the fibre.
const SLOPES: f64 = 1.15;

/// What an eye sees of the facets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FacetSeen<T> {
    /// Share of light that facets with the whole stack reflect, linear RGB.
    pub energy: [T; 3],
    /// Area of the facets in the eye's projection; the fibre's major axis is 1.
    pub area: T,
    /// Share of the visible facets that belong to the outer side, 0..1.
    pub outer: T,
    /// Cosine of incidence on the facets that look at the eye.
    pub facing: T,
}

/// [`FacetSeen`] over the eye's direction, for every row of a [`StackTable`]: [`SEEN_STEPS`] levels by the root of the share of a right
/// angle between eye and fibre, each of as many steps by the root of the width that the eye sees, from broadside to edge-on. Both roots
/// put steps where slopes fill what is hidden; the energy changes least along the diagonals of the cells, between which it is linear.
#[derive(Clone, Debug, PartialEq)]
pub struct SeenTable {
    /// Energy in linear RGB; area over [`facet_area`].
    pub texels: Vec<[f64; 4]>,
}

/// Factors on the squares of the cosine across and along the fibre in [`facet_area`].
pub fn facet_constants<T: Real>(facets: &Facets<T>) -> [T; 2] {
    let (a, s2) = (facets.flatness, facets.slope * facets.slope);
    // Perimeter of the ellipse, half axes 1 and a (Ramanujan 1914).
    let one = T::one();
    let m = ((one - a) / (one + a)).powi(2);
    let root = real::<T>(10.0) + (real::<T>(4.0) - real::<T>(3.0) * m).sqrt();
    let perimeter = real::<T>(FRAC_PI_2) * (one + a) * (one + real::<T>(3.0) * m / root);
    [
        (-s2).exp(),
        real::<T>(SLOPES / (2.0 * PI)) * perimeter * perimeter * s2,
    ]
}

/// Area of the facets in the eye's projection, nearly: `width` of the side as seen across the fibre, cosines of the eye across it and
/// along it.
pub fn facet_area<T: Real>(constants: [T; 2], width: T, across: T, along: T) -> T {
    let (seen, slopes) = (width * across, along * along);
    (seen * seen * constants[0] + constants[1] * slopes)
        .sqrt()
        .max(real(1e-6))
}

impl SeenTable {
    /// Tables the facets of a side with this stack.
    pub fn build(facets: &Facets<f64>, table: &StackTable) -> Self {
        let steps = SEEN_STEPS * SEEN_STEPS;
        let constants = facet_constants(facets);
        let a2 = facets.flatness * facets.flatness;
        let texel = |i: usize| {
            let scale = table.scale_of(i / steps);
            let (level, step) = (i % steps / SEEN_STEPS, i % SEEN_STEPS);
            let share = |i: usize| (i as f64 / (SEEN_STEPS - 1) as f64).powi(2);
            let (across, along) = (share(level) * FRAC_PI_2).sin_cos();
            let width = facets.flatness + (1.0 - facets.flatness) * share(SEEN_STEPS - 1 - step);
            // Where a side of this width looks at the eye: width^2 = z^2 + a^2 (1 - z^2).
            let z2 = ((width * width - a2) / (1.0 - a2).max(1e-12)).clamp(0.0, 1.0);
            let (y, z) = ((1.0 - z2).sqrt(), z2.sqrt());
            // Along the fibre the azimuth is lost, and the width with it.
            let mut view = facet_view(facets, [along, y, z]);
            view.turn = [y * facets.flatness / width, z / width];
            view.width = width;
            view.seen *= across;
            let (mut energy, mut area) = ([0.0; 3], 0.0);
            for node in 0..2 * NODES {
                let angle = (node as f64 + 0.5) / NODES as f64 - 1.0;
                let [cosine, part] = facet_node(facets, &view, (angle * FRAC_PI_2).sin_cos());
                let color = table.look(cosine, scale).color;
                area += part;
                energy = std::array::from_fn(|c| energy[c] + part * color[c]);
            }
            let [r, g, b] = energy.map(|e| e / area.max(1e-12));
            // Weights sum to half a turn, one half of each side.
            let area = area * FRAC_PI_2 / (2 * NODES) as f64;
            [r, g, b, area / facet_area(constants, width, across, along)]
        };
        Self {
            texels: (0..table.rows * steps).map(texel).collect(),
        }
    }

    /// What an eye at `omega_o`, in the side's frame, sees; `row` and `between`: of the stack's table, and how far to the next.
    pub fn seen<T: Real>(
        &self,
        facets: &Facets<T>,
        (row, between): (usize, T),
        omega_o: [T; 3],
    ) -> FacetSeen<T> {
        let place = seen_place(facets, omega_o);
        let steps = SEEN_STEPS * SEEN_STEPS;
        let [t, s] = place.fraction;
        let cell = cell_simplex([t, s, between], [1, SEEN_STEPS, steps]);
        let corners = cell.corners(row * steps + place.index);
        let found: [T; 4] = std::array::from_fn(|c| {
            (0..4).fold(T::zero(), |sum, i| {
                let texel = self.texels[corners[i].min(self.texels.len() - 1)];
                sum + cell.weights[i] * real(texel[c])
            })
        });
        FacetSeen {
            energy: [found[0], found[1], found[2]],
            area: found[3] * place.area,
            outer: place.outer,
            facing: place.facing,
        }
    }
}

/// Where an eye lies in a [`SeenTable`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenPlace<T> {
    /// Of the four texels around it the one nearest to the table's beginning.
    pub index: usize,
    /// How far it lies towards the next in a level, and towards the next level.
    pub fraction: [T; 2],
    /// [`facet_area`] there.
    pub area: T,
    /// [`FacetSeen::outer`]: of an ellipse's visible half the part whose normals have a positive z.
    pub outer: T,
    /// [`FacetSeen::facing`].
    pub facing: T,
}

/// The place of an eye at `omega_o`, in the side's frame.
pub fn seen_place<T: Real>(facets: &Facets<T>, omega_o: [T; 3]) -> SeenPlace<T> {
    let view = facet_view(facets, omega_o);
    let one = T::one();
    let along = omega_o[0].abs().min(one);
    let across = (omega_o[1] * omega_o[1] + omega_o[2] * omega_o[2]).sqrt();
    let share = (view.width - facets.flatness) / (one - facets.flatness).max(real(1e-3));
    let last = SEEN_STEPS - 1;
    let step = |x: T| {
        let place = x * real(last as f64);
        let low = place.to_usize().unwrap_or(0).min(last - 1);
        (low, place - real(low as f64))
    };
    let root = |x: T| clamp(x, T::zero(), one).sqrt();
    let (column, t) = step(one - root(share));
    let (level, s) = step(root(along.acos() * real(FRAC_2_PI)));
    SeenPlace {
        index: level * SEEN_STEPS + column,
        fraction: [t, s],
        area: facet_area(facet_constants(facets), view.width, across, along),
        outer: (one + view.turn[1]) * real(0.5),
        facing: (view.width * across).min(one),
    }
}
