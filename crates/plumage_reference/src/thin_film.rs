//! Thin films by recursion over their interfaces (Parratt 1954), with the absorption of every layer integrated over its own field, and
//! color through an analytic observer (Wyman, Sloan and Shirley 2013). Complex numbers are pairs, so that nothing is shared with what it
//! judges.

use std::f64::consts::TAU;

/// Real and imaginary part.
pub type Pair = (f64, f64);

fn add(a: Pair, b: Pair) -> Pair {
    (a.0 + b.0, a.1 + b.1)
}

fn sub(a: Pair, b: Pair) -> Pair {
    (a.0 - b.0, a.1 - b.1)
}

fn mul(a: Pair, b: Pair) -> Pair {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}

fn div(a: Pair, b: Pair) -> Pair {
    let size = b.0 * b.0 + b.1 * b.1;
    let top = mul(a, (b.0, -b.1));
    (top.0 / size, top.1 / size)
}

fn size2(a: Pair) -> f64 {
    a.0 * a.0 + a.1 * a.1
}

/// The root with an imaginary part of at least 0, by polar coordinates.
fn root(a: Pair) -> Pair {
    let (size, angle) = (size2(a).powf(0.25), 0.5 * a.1.atan2(a.0));
    let found = (size * angle.cos(), size * angle.sin());
    if found.1 < 0.0 {
        (-found.0, -found.1)
    } else {
        found
    }
}

/// exp(i a).
fn wave(a: Pair) -> Pair {
    let size = (-a.1).exp();
    (size * a.0.cos(), size * a.0.sin())
}

/// Shares of the light that arrives.
#[derive(Clone, Debug)]
pub struct Balance {
    /// Reflected.
    pub reflected: f64,
    /// Absorbed by each layer, the outermost first.
    pub absorbed: Vec<f64>,
    /// Passed into the base.
    pub transmitted: f64,
}

/// Light of a wavelength that comes through air at `cosine` from the normal; `layers`: index and thickness, the outermost first, lengths
/// in the unit of the wavelength; `in_plane`: the electric field lies in the plane of incidence.
pub fn balance(
    layers: &[(Pair, f64)],
    base: Pair,
    in_plane: bool,
    cosine: f64,
    wavelength: f64,
) -> Balance {
    let k = TAU / wavelength;
    let sin2 = 1.0 - cosine * cosine;
    let admittance = |square: Pair, q: Pair| if in_plane { div(square, q) } else { q };
    // Air, the layers, the base: normal part of the wave vector, admittance, thickness, square of the index.
    let mut media = vec![((cosine, 0.0), (1.0, 0.0), 0.0)];
    for &(index, thickness) in layers.iter().chain([&(base, 0.0)]) {
        let square = mul(index, index);
        media.push((root(sub(square, (sin2, 0.0))), square, thickness));
    }
    let y: Vec<Pair> = media.iter().map(|m| admittance(m.1, m.0)).collect();
    let last = media.len() - 1;
    // Backward over forward wave at the upper and lower side of every medium.
    let mut upper = vec![(0.0, 0.0); media.len()];
    let mut lower = vec![(0.0, 0.0); media.len()];
    for j in (0..last).rev() {
        let f = div(sub(y[j], y[j + 1]), add(y[j], y[j + 1]));
        let both = add((1.0, 0.0), mul(f, upper[j + 1]));
        lower[j] = div(add(f, upper[j + 1]), both);
        let path = 2.0 * k * media[j].2;
        upper[j] = mul(lower[j], wave((media[j].0.0 * path, media[j].0.1 * path)));
    }
    let arriving = y[0].0;
    let mut amplitude = (1.0, 0.0);
    let mut absorbed = Vec::new();
    for j in 0..last {
        let (q, square, thickness) = media[j];
        if j > 0 {
            let back = mul(amplitude, upper[j]);
            let (electric, magnetic) =
                field_integrals(amplitude, back, (k * q.0, k * q.1), thickness);
            let across = if in_plane {
                sin2 * size2(y[j]) / size2(square) * magnetic
            } else {
                0.0
            };
            absorbed.push(k * square.1 * (electric + across) / arriving);
        }
        // The tangential electric field goes on.
        let down = mul(amplitude, wave((k * q.0 * thickness, k * q.1 * thickness)));
        let field = mul(down, add((1.0, 0.0), lower[j]));
        amplitude = div(field, add((1.0, 0.0), upper[j + 1]));
    }
    Balance {
        reflected: size2(lower[0]),
        absorbed,
        transmitted: y[last].0 * size2(amplitude) / arriving,
    }
}

/// Integrals over a layer of the squares of `a e^{iuz} + b e^{-iuz}` and of their difference.
fn field_integrals(a: Pair, b: Pair, u: Pair, depth: f64) -> (f64, f64) {
    // (e^{x d} - 1)/x, smooth through 0.
    let grown = |x: f64| {
        if (x * depth).abs() < 1e-9 {
            depth
        } else {
            (x * depth).exp_m1() / x
        }
    };
    let plain = size2(a) * grown(-2.0 * u.1) + size2(b) * grown(2.0 * u.1);
    let turn = 2.0 * u.0;
    let beat = if (turn * depth).abs() < 1e-9 {
        (depth, 0.0)
    } else {
        div(sub(wave((turn * depth, 0.0)), (1.0, 0.0)), (0.0, turn))
    };
    let cross = 2.0 * mul(mul(a, (b.0, -b.1)), beat).0;
    (plain + cross, plain - cross)
}

/// CIE XYZ of 1931 at a wavelength in nanometres, by sums of Gaussians with two widths (Wyman, Sloan and Shirley 2013).
pub fn analytic_observer(wavelength: f64) -> [f64; 3] {
    let lobe = |center: f64, left: f64, right: f64| {
        let t = (wavelength - center) * if wavelength < center { left } else { right };
        (-0.5 * t * t).exp()
    };
    [
        0.362 * lobe(442.0, 0.0624, 0.0374) + 1.056 * lobe(599.8, 0.0264, 0.0323)
            - 0.065 * lobe(501.1, 0.0490, 0.0382),
        0.821 * lobe(568.8, 0.0213, 0.0247) + 0.286 * lobe(530.9, 0.0613, 0.0322),
        1.217 * lobe(437.0, 0.0845, 0.0278) + 0.681 * lobe(459.0, 0.0385, 0.0725),
    ]
}
