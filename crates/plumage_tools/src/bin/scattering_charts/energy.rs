//! Energy: white furnaces of fibres, of flat and rough ones, of sheen over a base.

use super::{direction, published, shade, structural};
use bevy_plumage::maths::scattering::*;
use plumage_reference::fibre_published::published_evaluate;
use plumage_tools::plot::{Curve, Labels, Result, draw};
use std::{f64::consts::PI, path::Path};

/// Integral over the sphere of a density in (theta_i, phi).
pub fn sphere(rings: u32, sectors: u32, density: impl Fn(f64, f64) -> f64) -> f64 {
    let mut sum = 0.0;
    for i in 0..rings {
        let theta = PI * ((f64::from(i) + 0.5) / f64::from(rings) - 0.5);
        for k in 0..sectors {
            let phi = 2.0 * PI * (f64::from(k) + 0.5) / f64::from(sectors);
            sum += density(theta, phi) * theta.cos();
        }
    }
    sum * 2.0 * PI * PI / f64::from(rings * sectors)
}

/// This crate against the printed model.
pub fn furnace(folder: &Path) -> Result<()> {
    let mut curves: Vec<Curve> = Vec::new();
    let angles: Vec<f64> = (0..32).map(|i| 1.55 * f64::from(i) / 31.0).collect();
    for core in [0.5, 0.8] {
        let ours = angles.iter().map(|&t| {
            let s = shade(&structural(core), t);
            (
                t,
                sphere(1500, 32, |theta, phi| {
                    fibre_evaluate(&s, direction(theta, phi))[0]
                }),
            )
        });
        curves.push((format!("this crate, core {core}"), ours.collect()));
        let f = published(f64::from(core), 48);
        let printed = angles.iter().map(|&t| {
            (
                t,
                sphere(1500, 32, |theta, phi| published_evaluate(&f, theta, t, phi)),
            )
        });
        curves.push((format!("as printed, core {core}"), printed.collect()));
    }
    let labels = Labels {
        title: "White fibre in a white furnace (1 = all light comes back)",
        x: "theta_o (radians)",
        y: "albedo",
    };
    draw(
        &folder.join("scattering_furnace.svg"),
        &labels,
        [false; 2],
        &curves,
    )
}

/// Roughness x angle x ellipticity: how far the furnace is from 1.
pub fn sweep(folder: &Path) -> Result<()> {
    let mut curves: Vec<Curve> = Vec::new();
    let mut worst = 0.0_f64;
    for aspect in [1.0, 0.6, 0.3] {
        for roughness in [0.1, 0.3] {
            let fibre = Fibre {
                aspect,
                longitudinal_roughness: roughness,
                ..structural(0.8)
            };
            let points: Vec<(f64, f64)> = [0.0, 0.4, 0.8, 1.2, 1.45, 1.55]
                .into_iter()
                .map(|t: f64| {
                    // The mean over the azimuth of the eye: a flat fibre shows its broad and its narrow side.
                    let mean = (0..4).map(|k| {
                        let phi = PI * (f64::from(k) + 0.5) / 8.0;
                        let table = FibreTable::build(&fibre);
                        let eye = direction(t, phi);
                        let white = [1.0; 3];
                        let mut s =
                            fibre_shading(&table.fibre(), &table.row(t.cos()), white, eye, 0.0, 8);
                        let lost = 1.0 - s.energy.iter().map(|e| e[0]).sum::<f64>();
                        // An albedo stops at 0.995: the core takes the rest.
                        s.energy[3] = s.energy[3].map(|e| e + lost);
                        sphere(1200, 96, |theta, phi| {
                            fibre_evaluate(&s, direction(theta, phi))[0]
                        }) / 4.0
                    });
                    (t, mean.sum())
                })
                .collect();
            worst = points
                .iter()
                .map(|p| (p.1 - 1.0_f64).abs())
                .fold(worst, f64::max);
            curves.push((format!("aspect {aspect}, roughness {roughness}"), points));
        }
    }
    println!("furnace sweep: off by at most {worst:.4}");
    let labels = Labels {
        title: "White furnace over roughness, inclination and ellipticity, core 0.8",
        x: "theta_o (radians)",
        y: "albedo",
    };
    draw(
        &folder.join("scattering_furnace_sweep.svg"),
        &labels,
        [false; 2],
        &curves,
    )
}

/// White base under sheen: what comes back.
pub fn sheen(folder: &Path) -> Result<()> {
    let mut curves: Vec<Curve> = Vec::new();
    let normal = [0.0, 0.0, 1.0];
    for (alpha, strength) in [(0.3, 1.0), (0.5, 1.0), (0.5, 0.3), (1.0, 1.0)] {
        let points = (0..24).map(|i| {
            let cos = (f64::from(i) + 0.5) / 24.0;
            let ltc = sheen_lookup(cos, alpha);
            let eye = [(1.0 - cos * cos).sqrt(), 0.0, cos];
            let (n, m) = (400, 400);
            let mut sum = 0.0;
            for a in 0..n {
                let z = (f64::from(a) + 0.5) / f64::from(n);
                for b in 0..m {
                    let phi = 2.0 * PI * (f64::from(b) + 0.5) / f64::from(m);
                    let r = (1.0 - z * z).sqrt();
                    sum += sheen_evaluate(ltc, normal, eye, [r * phi.cos(), r * phi.sin(), z]);
                }
            }
            let rim = strength * sum * 2.0 * PI / f64::from(n * m);
            (cos, rim + 1.0 - sheen_albedo(ltc, strength))
        });
        curves.push((
            format!("roughness {alpha}, strength {strength}"),
            points.collect(),
        ));
    }
    let labels = Labels {
        title: "White base under sheen in a white furnace",
        x: "cosine of the eye",
        y: "albedo",
    };
    draw(
        &folder.join("scattering_sheen_furnace.svg"),
        &labels,
        [false; 2],
        &curves,
    )
}
