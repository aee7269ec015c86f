//! From the biologist's description of a barbule's surface to homogeneous layers (docs/book/iridescence.md#layers).

use super::{Base, Complex, Iridescence, Structure};

/// Sub-slices of a period of rods: the mean share of each is exact, and twelve of them are as good as a curve
/// (docs/book/iridescence.md#layers).
const SLICES: usize = 12;
/// Realizations of a stack with irregular layers.
pub const REALIZATIONS: usize = 32;
/// Share of air in the cavity of a hollow platelet; the rest are membranes of melanin.
const CAVITY_AIR: f64 = 5.0 / 6.0;
/// Share of melanin in what lies below the stack.
const BASE_MELANIN: f64 = 0.5;
/// How indices are mixed: `n^w` is the mean of the parts' `n^w`, with the field along rods and across them.
pub const MIXING: [f64; 2] = [2.5, -1.5];

/// What a layer consists of; the rest is keratin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Share of melanin by volume, 0..1.
    pub melanin: f64,
    /// Share of air by volume, 0..1.
    pub air: f64,
}

impl Material {
    const KERATIN: Self = Self {
        melanin: 0.0,
        air: 0.0,
    };

    /// Index of refraction `n + ik` at a wavelength in nanometres, mixed with the exponent `mixing`.
    pub fn index(self, wavelength: f64, mixing: f64) -> Complex {
        let keratin = keratin_index(wavelength);
        if self == Self::KERATIN {
            return Complex::new(keratin, 0.0);
        }
        let part = |index: Complex, share: f64| index.power(mixing).scaled(share);
        let mixed = part(melanin_index(wavelength), self.melanin)
            + part(Complex::new(1.0, 0.0), self.air)
            + part(
                Complex::new(keratin, 0.0),
                (1.0 - self.melanin - self.air).max(0.0),
            );
        mixed.power(1.0 / mixing)
    }
}

/// Refractive index of keratin at a wavelength in nanometres (Leertouwer et al. 2011).
pub fn keratin_index(wavelength: f64) -> f64 {
    1.532 + 5890.0 / (wavelength * wavelength)
}

/// Refractive index of melanin at a wavelength in nanometres (Stavenga et al. 2015).
pub fn melanin_index(wavelength: f64) -> Complex {
    Complex::new(
        1.648 + 23_700.0 / (wavelength * wavelength),
        0.56 * (-wavelength / 270.0).exp(),
    )
}

/// One homogeneous layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    /// Index into [`Stack::materials`].
    pub material: usize,
    /// Thickness in nanometres.
    pub thickness: f64,
    /// Layers of one group vary together.
    pub group: usize,
}

/// Layers from the surface inwards.
#[derive(Clone, Debug, PartialEq)]
pub struct Stack {
    /// What the layers consist of, each once.
    pub materials: Vec<Material>,
    /// The layers, the outermost first.
    pub layers: Vec<Layer>,
    /// Number of groups.
    pub groups: usize,
    /// What lies below, without end.
    pub base: Material,
    /// Standard deviation of a group's thickness, as a share.
    pub disorder: f64,
    /// Standard deviation of the whole stack's thickness, as a share.
    pub variation: f64,
}

/// Area of a disc of radius 1 on one side of the line at `x`, from -1.
fn disc_area(x: f64) -> f64 {
    let x = x.clamp(-1.0, 1.0);
    x * (1.0 - x * x).sqrt() + x.asin()
}

/// Mean over `low..high` of the chord of a disc about `center`, over its diameter.
fn disc_share(low: f64, high: f64, center: f64, diameter: f64) -> f64 {
    if diameter <= 0.0 {
        return 0.0;
    }
    let radius = 0.5 * diameter;
    let area = disc_area((high - center) / radius) - disc_area((low - center) / radius);
    // In units of radius^2, over the length in radii and the diameter in radii.
    0.5 * area * radius / (high - low)
}

impl Stack {
    /// The layers of a barbule. Values outside of their ranges are taken as the nearest that is inside.
    pub fn new(parameters: &Iridescence) -> Self {
        let p = parameters.limited();
        let scale = f64::from(p.scale);
        let nm = |x: f32| f64::from(x) * scale;
        let mut stack = Self {
            materials: Vec::new(),
            layers: Vec::new(),
            groups: 0,
            base: match p.base {
                Base::Melanin => Material {
                    melanin: BASE_MELANIN,
                    air: 0.0,
                },
                Base::Keratin => Material::KERATIN,
                Base::Air => Material {
                    melanin: 0.0,
                    air: 1.0,
                },
            },
            disorder: f64::from(p.disorder),
            variation: f64::from(p.variation),
        };
        stack.group(&[(Material::KERATIN, nm(p.cortex_nm))]);
        let rows = p.layers as usize;
        let fill = f64::from(p.fill);
        let (size, gap) = (nm(p.melanosome_nm), nm(p.gap_nm));
        let solid = Material {
            melanin: fill,
            air: 0.0,
        };
        match p.structure {
            Structure::Film => {}
            Structure::SolidRods => stack.rods(rows, size, 0.0, gap, fill, 0.0),
            Structure::HollowRods => {
                stack.rods(rows, size, size * f64::from(p.hollow), gap, fill, 0.0);
            }
            Structure::RodsAndChannels => {
                stack.rods(rows, size, 0.0, gap, fill, nm(p.channel_nm));
            }
            Structure::SolidPlatelets | Structure::HollowPlatelets => {
                let hollow = f64::from(p.hollow);
                for row in 0..rows {
                    let wall = 0.5 * (1.0 - hollow) * size;
                    let first = nm(p.first_nm);
                    let size = if row == 0 && first > 0.0 { first } else { size };
                    if p.structure == Structure::SolidPlatelets {
                        stack.group(&[(solid, size)]);
                    } else {
                        // The outermost platelet is thinner by its air.
                        let wall = wall.min(0.5 * size);
                        let cavity = Material {
                            melanin: fill * (1.0 - CAVITY_AIR),
                            air: fill * CAVITY_AIR,
                        };
                        stack.group(&[(solid, wall), (cavity, size - 2.0 * wall), (solid, wall)]);
                    }
                    stack.group(&[(Material::KERATIN, gap.max(0.0))]);
                }
            }
        }
        stack
    }

    /// Rows of rods: melanin of diameter `size` with an air core, and air channels of their own half way between the rows.
    fn rods(&mut self, rows: usize, size: f64, core: f64, gap: f64, fill: f64, channel: f64) {
        let period = (size + gap).max(0.25 * size);
        let depth = (rows as f64 * period).max((rows.max(1) - 1) as f64 * period + size);
        let count = rows * SLICES;
        let step = depth / count.max(1) as f64;
        // As many side by side as rods: one per lateral period.
        let lateral = size / fill;
        let place = |row: isize| row as f64 * period + 0.5 * size;
        for row in 0..rows {
            let slices: Vec<(Material, f64)> = (row * SLICES..(row + 1) * SLICES)
                .map(|slice| {
                    let (low, high) = (slice as f64 * step, (slice + 1) as f64 * step);
                    let near = (row as isize - 3).max(0)..(row as isize + 4).min(rows as isize);
                    let (mut melanin, mut air) = (0.0, 0.0);
                    for other in near {
                        let disc = |diameter, center| {
                            disc_share(low, high, center, diameter) * diameter / lateral
                        };
                        let hole = disc(core, place(other));
                        melanin += disc(size, place(other)) - hole;
                        air += hole;
                        if other + 1 < rows as isize {
                            air += disc(channel, place(other) + 0.5 * period);
                        }
                    }
                    let full = (melanin + air).max(1.0);
                    let material = Material {
                        melanin: melanin / full,
                        air: air / full,
                    };
                    (material, step)
                })
                .collect();
            self.group(&slices);
        }
    }

    /// Adds layers that vary together; none of no thickness.
    fn group(&mut self, parts: &[(Material, f64)]) {
        let before = self.layers.len();
        for &(material, thickness) in parts.iter().filter(|part| part.1 > 0.0) {
            // Rows repeat, but for rounding.
            let round = |x: f64| (x * 1e9).round() / 1e9;
            let material = Material {
                melanin: round(material.melanin),
                air: round(material.air),
            };
            let known = self.materials.iter().position(|other| *other == material);
            let material = known.unwrap_or_else(|| {
                self.materials.push(material);
                self.materials.len() - 1
            });
            self.layers.push(Layer {
                material,
                thickness,
                group: self.groups,
            });
        }
        self.groups += usize::from(self.layers.len() > before);
    }

    /// Factors on the thickness of every group, for every realization: a Latin hypercube of normal deviates.
    pub fn realizations(&self) -> Vec<Vec<f64>> {
        if self.disorder <= 0.0 && self.variation <= 0.0 {
            return vec![vec![1.0; self.groups]];
        }
        let whole = deviates(0);
        let groups: Vec<_> = (1..=self.groups as u64).map(deviates).collect();
        (0..REALIZATIONS)
            .map(|i| {
                let all = 1.0 + self.variation * whole[i];
                let factor = |g: &[f64; REALIZATIONS]| (1.0 + self.disorder * g[i]) * all;
                groups.iter().map(factor).collect()
            })
            .collect()
    }
}

/// The middles of equally likely intervals of a normal distribution, in an order of their own for every dimension.
fn deviates(dimension: u64) -> [f64; REALIZATIONS] {
    let mut list: [f64; REALIZATIONS] =
        std::array::from_fn(|i| quantile((i as f64 + 0.5) / REALIZATIONS as f64));
    let mut state = dimension.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x1bad_5eed;
    for i in (1..REALIZATIONS).rev() {
        // A linear congruential generator (Knuth's constants); its high bits are the good ones.
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        list.swap(i, (state >> 33) as usize % (i + 1));
    }
    list
}

/// The number below which the share `p` of a standard normal distribution lies.
fn quantile(p: f64) -> f64 {
    let (mut low, mut high) = (-8.0, 8.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if 0.5 * libm::erfc(-middle * std::f64::consts::FRAC_1_SQRT_2) < p {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}
