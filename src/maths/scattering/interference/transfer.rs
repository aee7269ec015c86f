//! Reflectance of a stack by characteristic matrices (docs/book/iridescence.md#transfer-matrix).

use super::{Complex, MIXING, Stack};
use std::f64::consts::TAU;

/// Smallest cosine of incidence: at 0 itself everything is reflected.
const LEAST_COSINE: f64 = 1e-6;

/// Where light goes, as shares of what arrives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flow {
    /// Reflected.
    pub reflected: f64,
    /// Passed into what lies below.
    pub transmitted: f64,
}

/// Polarizations: the electric field across the plane of incidence, and in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Polarization {
    /// Across.
    S,
    /// In it.
    P,
}

impl Polarization {
    /// Both.
    pub const BOTH: [Self; 2] = [Self::S, Self::P];

    /// Ratio of the tangential magnetic to the electric field, for an index squared and the normal part of the wave vector.
    fn admittance(self, square: Complex, normal: Complex) -> Complex {
        match self {
            Self::S => normal,
            Self::P => square / normal,
        }
    }
}

/// A layer of one index (squared) and thickness in nanometres.
#[derive(Clone, Copy, Debug)]
pub struct Film {
    /// Refractive index `n + ik`.
    pub index: Complex,
    /// Thickness in nanometres.
    pub thickness: f64,
}

/// Light of a wavelength in nanometres that comes through air at `cosine` from the normal, onto films above an endless base.
pub fn film_flow(
    films: &[Film],
    base: Complex,
    polarization: Polarization,
    cosine: f64,
    wavelength: f64,
) -> Flow {
    let cosine = cosine.clamp(LEAST_COSINE, 1.0);
    let sin2 = Complex::new(1.0 - cosine * cosine, 0.0);
    let optics = |index: Complex| {
        let square = index * index;
        let normal = (square - sin2).root();
        (normal, polarization.admittance(square, normal))
    };
    let below = optics(base).1;
    let mut field = Field::on(below);
    for film in films.iter().rev() {
        let (normal, admittance) = optics(film.index);
        let phase = normal.scaled(TAU / wavelength * film.thickness).sin_cos();
        field = field.through(phase, admittance, Complex::new(1.0, 0.0) / admittance);
    }
    let above = polarization.admittance(Complex::new(1.0, 0.0), Complex::new(cosine, 0.0));
    let down = above * field.electric + field.magnetic;
    Flow {
        reflected: field.reflected(above),
        transmitted: 4.0 * below.re * above.re / down.norm2(),
    }
}

/// Tangential fields at a boundary, for a wave of amplitude 1 that leaves below.
#[derive(Clone, Copy)]
struct Field {
    electric: Complex,
    magnetic: Complex,
}

impl Field {
    fn on(base: Complex) -> Self {
        Self {
            electric: Complex::new(1.0, 0.0),
            magnetic: base,
        }
    }

    /// At the upper side of a layer: its characteristic matrix.
    #[inline]
    fn through(
        self,
        (sin, cos): (Complex, Complex),
        admittance: Complex,
        impedance: Complex,
    ) -> Self {
        let turned = -sin.turned();
        Self {
            electric: cos * self.electric + turned * (impedance * self.magnetic),
            magnetic: turned * (admittance * self.electric) + cos * self.magnetic,
        }
    }

    #[inline]
    fn reflected(self, above: Complex) -> f64 {
        let up = above * self.electric - self.magnetic;
        up.norm2() / (above * self.electric + self.magnetic).norm2()
    }
}

/// A stack at one wavelength: the indices of its materials.
pub(super) struct Spectral<'a> {
    stack: &'a Stack,
    wavelength: f64,
    /// Per kind of mixing: squares of the materials' indices, and of the base's.
    squares: [(Vec<Complex>, Complex); 2],
    /// Layers of equal material, thickness and group, which share their phase.
    kinds: Vec<(usize, f64, usize)>,
    /// Kind of every layer.
    layers: Vec<usize>,
}

impl<'a> Spectral<'a> {
    pub(super) fn new(stack: &'a Stack, wavelength: f64) -> Self {
        let squares = MIXING.map(|mixing| {
            let square = |index: Complex| index * index;
            let of = |material: &super::Material| square(material.index(wavelength, mixing));
            (stack.materials.iter().map(of).collect(), of(&stack.base))
        });
        let mut kinds: Vec<(usize, f64, usize)> = Vec::new();
        let layers = stack
            .layers
            .iter()
            .map(|layer| {
                let kind = (layer.material, layer.thickness, layer.group);
                let known = kinds.iter().position(|other| *other == kind);
                known.unwrap_or_else(|| {
                    kinds.push(kind);
                    kinds.len() - 1
                })
            })
            .collect();
        Self {
            stack,
            wavelength,
            squares,
            kinds,
            layers,
        }
    }

    /// Mean reflectance over both polarizations, both mixings and all realizations.
    pub(super) fn reflectance(&self, cosine: f64, realizations: &[Vec<f64>]) -> f64 {
        let cosine = cosine.clamp(LEAST_COSINE, 1.0);
        let sin2 = Complex::new(1.0 - cosine * cosine, 0.0);
        let one = Complex::new(1.0, 0.0);
        let above = Polarization::BOTH.map(|p| p.admittance(one, Complex::new(cosine, 0.0)));
        let wave = TAU / self.wavelength;
        let mut sum = 0.0;
        let mut phases = Vec::with_capacity(self.kinds.len());
        for (squares, base) in &self.squares {
            let optics: Vec<_> = squares
                .iter()
                .map(|&square| {
                    let normal = (square - sin2).root();
                    let admittance = Polarization::BOTH.map(|p| p.admittance(square, normal));
                    (normal.scaled(wave), admittance, admittance.map(|y| one / y))
                })
                .collect();
            let below = {
                let normal = (*base - sin2).root();
                Polarization::BOTH.map(|p| p.admittance(*base, normal))
            };
            for factors in realizations {
                phases.clear();
                phases.extend(self.kinds.iter().map(|&(material, thickness, group)| {
                    let thickness = thickness * factors[group];
                    optics[material].0.scaled(thickness).sin_cos()
                }));
                let mut fields = below.map(Field::on);
                for (&kind, layer) in self.layers.iter().zip(&self.stack.layers).rev() {
                    let (_, admittance, impedance) = &optics[layer.material];
                    for (i, field) in fields.iter_mut().enumerate() {
                        *field = field.through(phases[kind], admittance[i], impedance[i]);
                    }
                }
                sum += fields[0].reflected(above[0]) + fields[1].reflected(above[1]);
            }
        }
        sum / (2 * self.squares.len() * realizations.len()) as f64
    }
}
