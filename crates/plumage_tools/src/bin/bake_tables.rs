//! Makes `src/maths/scattering/tables/medulla.bin` and `medulla_place.bin` beside it: traces paths through the double cylinder of
//! a pigment fibre.
//!
//! `cargo run --release -p plumage_tools --bin bake_tables [output file] [paths per cell]`

use bevy_plumage::maths::scattering::{MEDULLA_AXES, MEDULLA_PLACE};
use rand_pcg::Pcg64Mcg;
use std::{env, error::Error, f64::consts::PI, fs};

/// Uniform in 0..1, 53 bits.
fn uniform(state: &mut Pcg64Mcg) -> f64 {
    use rand_pcg::rand_core::Rng;
    (state.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}

/// Fresnel reflectance from the refracted side's squared sine; `eta` = far over near side.
fn fresnel(cos: f64, eta: f64) -> f64 {
    let sin2 = (1.0 - cos * cos) / (eta * eta);
    if sin2 >= 1.0 {
        return 1.0;
    }
    let t = (1.0 - sin2).sqrt();
    let (s, p) = (
        (cos - eta * t) / (cos + eta * t),
        (t - eta * cos) / (t + eta * cos),
    );
    0.5 * (s * s + p * p)
}

/// Distance along `d` from `p` to the cylinder of radius `r` around x: (enters, leaves).
fn cylinder(p: [f64; 3], d: [f64; 3], r: f64) -> Option<(f64, f64)> {
    let a = (d[1] * d[1] + d[2] * d[2]).max(1e-18);
    let b = p[1] * d[1] + p[2] * d[2];
    let c = p[1] * p[1] + p[2] * p[2] - r * r;
    let root = b * b - a * c;
    (root > 0.0).then(|| ((-b - root.sqrt()) / a, (-b + root.sqrt()) / a))
}

/// Turns `d` by the Henyey-Greenstein phase function.
fn scatter(d: [f64; 3], g: f64, rng: &mut Pcg64Mcg) -> [f64; 3] {
    let u = uniform(rng);
    let cos = if g.abs() < 1e-3 {
        2.0 * u - 1.0
    } else {
        let s = (1.0 - g * g) / (1.0 - g + 2.0 * g * u);
        (1.0 + g * g - s * s) / (2.0 * g)
    };
    let (sin, turn) = ((1.0 - cos * cos).max(0.0).sqrt(), 2.0 * PI * uniform(rng));
    // A basis around d (Duff et al. 2017).
    let sign = 1.0_f64.copysign(d[2]);
    let k = -1.0 / (sign + d[2]);
    let b = d[0] * d[1] * k;
    let x = [1.0 + sign * d[0] * d[0] * k, sign * b, -sign * d[0]];
    let y = [b, sign + d[1] * d[1] * k, -d[1]];
    std::array::from_fn(|i| x[i] * sin * turn.cos() + y[i] * sin * turn.sin() + d[i] * cos)
}

/// A path that left the fibre after it was scattered.
struct Out {
    direction: [f64; 3],
    /// Length inside, in radii.
    length: f64,
    /// From the place of entry to the place of exit: along the fibre in radii, and the cosine of the angle around it.
    moved: [f64; 2],
}

/// Follows one path; None if it was never scattered.
fn path(
    h: f64,
    cos_theta: f64,
    eta: f64,
    kappa: f64,
    sigma: f64,
    g: f64,
    rng: &mut Pcg64Mcg,
) -> Option<Out> {
    let sin_theta = (1.0 - cos_theta * cos_theta).max(0.0).sqrt();
    // The eye is at azimuth 0 (z); the ray runs from it into the fibre at y = h.
    let mut p = [0.0, h, (1.0 - h * h).max(0.0).sqrt()];
    let cos_in = cos_theta * p[2];
    let t = (1.0 - (1.0 - cos_in * cos_in) / (eta * eta)).sqrt();
    let bend = cos_in / eta - t;
    let mut d = [
        -sin_theta / eta,
        bend * p[1],
        -cos_theta / eta + bend * p[2],
    ];
    let (mut scattered, mut length) = (false, 0.0);
    for _ in 0..10_000 {
        let (_, wall) = cylinder(p, d, 1.0)?;
        if let Some((enter, leave)) = cylinder(p, d, kappa) {
            let (enter, leave) = (enter.max(0.0), leave.min(wall));
            if leave > enter {
                let free = -(1.0 - uniform(rng)).ln() / sigma;
                if enter + free < leave {
                    let step = enter + free;
                    length += step;
                    p = std::array::from_fn(|i| p[i] + d[i] * step);
                    d = scatter(d, g, rng);
                    scattered = true;
                    continue;
                }
            }
        }
        let wall = wall.max(0.0);
        length += wall;
        p = std::array::from_fn(|i| p[i] + d[i] * wall);
        let r = (p[1] * p[1] + p[2] * p[2]).sqrt();
        (p[1], p[2]) = (p[1] / r, p[2] / r);
        let cos = (d[1] * p[1] + d[2] * p[2]).clamp(0.0, 1.0);
        if uniform(rng) < fresnel(cos, 1.0 / eta) {
            d[1] -= 2.0 * cos * p[1];
            d[2] -= 2.0 * cos * p[2];
        } else {
            let t = (1.0 - eta * eta * (1.0 - cos * cos)).max(0.0).sqrt();
            let k = t - eta * cos;
            return scattered.then(|| Out {
                direction: [eta * d[0], eta * d[1] + k * p[1], eta * d[2] + k * p[2]],
                length,
                moved: [p[0], h * p[1] + (1.0 - h * h).max(0.0).sqrt() * p[2]],
            });
        }
    }
    None
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = env::args().skip(1);
    let file = arguments
        .next()
        .unwrap_or_else(|| "src/maths/scattering/tables/medulla.bin".into());
    let paths: usize = arguments.next().map_or(Ok(120_000), |s| s.parse())?;
    let eta = 1.55;
    let (kappas, taus, gs, cosines) = MEDULLA_AXES;
    let (mut bytes, mut places) = (Vec::new(), Vec::new());
    let mut seed = 1_u128;
    for &kappa in kappas {
        for &tau in taus {
            for &g in gs {
                for &cos_theta in cosines {
                    seed += 2;
                    let mut rng = Pcg64Mcg::new(0xcafe_f00d_d15e_a5e5 + (seed << 32));
                    let mut sum = [0.0; 9];
                    for i in 0..paths {
                        let h = (2.0 * (i as f64 + uniform(&mut rng)) / paths as f64 - 1.0)
                            .clamp(-0.999_999_9, 0.999_999_9);
                        let weight = 1.0 - fresnel(cos_theta * (1.0 - h * h).sqrt(), eta);
                        let Some(out) = path(h, cos_theta, eta, kappa, tau / kappa, g, &mut rng)
                        else {
                            continue;
                        };
                        let phi = out.direction[1].atan2(out.direction[2]);
                        let halved = (-MEDULLA_PLACE.0 * out.length).exp();
                        let values = [
                            1.0,
                            phi.cos(),
                            (2.0 * phi).cos(),
                            out.direction[0],
                            (-0.2 * out.length).exp(),
                            (-out.length).exp(),
                            halved,
                            halved * out.moved[1],
                            halved * (MEDULLA_PLACE.1 * out.moved[0]).cos(),
                        ];
                        for (s, v) in sum.iter_mut().zip(values) {
                            *s += weight * v;
                        }
                    }
                    let mean: Vec<f64> = sum[1..].iter().map(|s| s / sum[0].max(1e-12)).collect();
                    // Straight across, forward and backward are the same.
                    let m1 = if cos_theta >= 1.0 { 0.0 } else { mean[2] };
                    for v in [
                        mean[0],
                        mean[1],
                        m1,
                        mean[3].max(1e-12).ln(),
                        mean[4].max(1e-12).ln(),
                    ] {
                        bytes.extend((v as f32).to_le_bytes());
                    }
                    for v in [mean[6], mean[7]] {
                        places.extend(((v / mean[5].max(1e-12)) as f32).to_le_bytes());
                    }
                }
            }
        }
        println!("kappa {kappa} done");
    }
    fs::write(&file, bytes)?;
    fs::write(file.replace(".bin", "_place.bin"), places)?;
    print_harmonics(paths);
    Ok(())
}

/// What light remembers of its place around the default fibre: means of the cosine of once to four times the angle between where it
/// enters and where it leaves, over that of once (`family_middle` of the shadows stands for all of them).
fn print_harmonics(paths: usize) {
    let mut rng = Pcg64Mcg::new(1);
    let mut sums = [[0.0; 4]; 3];
    for i in 0..paths {
        let h = (2.0 * (i as f64 + uniform(&mut rng)) / paths as f64 - 1.0).clamp(-0.9999, 0.9999);
        let weight = 1.0 - fresnel(0.8 * (1.0 - h * h).sqrt(), 1.55);
        let Some(out) = path(h, 0.8, 1.55, 0.85, 2.0 / 0.85, 0.4, &mut rng) else {
            continue;
        };
        let angle = out.moved[1].clamp(-1.0, 1.0).acos();
        for (sum, absorption) in sums.iter_mut().zip([0.0, 0.2, 1.0]) {
            for (k, sum) in sum.iter_mut().enumerate() {
                *sum += weight * (-absorption * out.length).exp() * ((k + 1) as f64 * angle).cos();
            }
        }
    }
    for (sum, absorption) in sums.iter().zip([0.0, 0.2, 1.0]) {
        println!(
            "absorption {absorption}: harmonics {:.2?}",
            sum.map(|x| x / sum[0])
        );
    }
}
