//! Helpers of the scattering tests.

use bevy_plumage::maths::gauss_legendre;
use bevy_plumage::maths::scattering::*;
use std::f64::consts::{FRAC_PI_2, PI};

pub const ANGLES: [f64; 6] = [0.0, 0.4, 0.8, 1.2, 1.45, 1.55];

pub fn structural(core: f32) -> Fibre {
    Fibre {
        kind: FibreKind::Structural { core_radius: core },
        ..Fibre::default()
    }
}

pub fn pigment(radius: f32, scattering: f32, anisotropy: f32) -> Fibre {
    Fibre {
        kind: FibreKind::Pigment {
            medulla_radius: radius,
            scattering,
            anisotropy,
        },
        ..Fibre::default()
    }
}

pub fn direction(theta: f64, phi: f64) -> [f64; 3] {
    [
        theta.sin(),
        theta.cos() * phi.sin(),
        theta.cos() * phi.cos(),
    ]
}

pub fn shade(
    table: &FibreTable,
    albedo: f64,
    omega_o: [f64; 3],
    dark_back: f64,
) -> FibreShading<f64> {
    let cos = (omega_o[1] * omega_o[1] + omega_o[2] * omega_o[2]).sqrt();
    fibre_shading(
        &table.fibre(),
        &table.row(cos),
        [albedo; 3],
        omega_o,
        dark_back,
        FIBRE_HARMONICS as u32,
    )
}

/// A fibre that absorbs nothing, whatever the albedo's upper limit: 0.995 is as white as an albedo may be.
pub fn whiten(s: &mut FibreShading<f64>, row: &FibreRow<f64>) {
    s.energy = row[0].map(|e| [e; 3]);
    s.dense = [0.0; 3];
}

/// Integral of K over the sphere: panels in theta that crowd around the lobes, even steps in phi.
pub fn furnace(s: &FibreShading<f64>, theta_o: f64, phi_steps: usize) -> [f64; 3] {
    let mut sum = [0.0; 3];
    lit_sphere(theta_o, phi_steps, |light, weight| {
        for (sum, k) in sum.iter_mut().zip(fibre_evaluate(s, light)) {
            *sum += k * weight;
        }
    });
    sum
}

/// Hands over directions of the light with their solid angles; they cover the sphere and crowd around -theta_o.
pub fn lit_sphere(theta_o: f64, phi_steps: usize, mut visit: impl FnMut([f64; 3], f64)) {
    let mut edges = vec![-FRAC_PI_2, FRAC_PI_2];
    for k in 0..14 {
        let d = 0.005 * 1.6_f64.powi(k);
        for at in [-theta_o - d, -theta_o + d, -theta_o] {
            edges.push(at.clamp(-FRAC_PI_2, FRAC_PI_2));
        }
    }
    edges.sort_by(f64::total_cmp);
    let nodes = gauss_legendre(12);
    for w in edges.windows(2) {
        let half = 0.5 * (w[1] - w[0]);
        if half < 1e-9 {
            continue;
        }
        for &(x, weight) in &nodes {
            let theta = w[0] + half * (x + 1.0);
            for i in 0..phi_steps {
                let phi = 2.0 * PI * (i as f64 + 0.5) / phi_steps as f64;
                let solid = theta.cos() * weight * half * 2.0 * PI / phi_steps as f64;
                visit(direction(theta, phi), solid);
            }
        }
    }
}
