//! Light on the coat: closed forms, energy, multiple scattering against photons (tests D4, D5, D15 of docs/down.md), and the
//! shader twin.

use bevy::math::{UVec3, Vec3};
use bevy_plumage::maths::undercoat::light::*;
use bevy_plumage::maths::undercoat::march::*;
use bevy_plumage::maths::undercoat::slab::{Coat, SlabRay, SlabSettings, slab_radiance};
use bevy_plumage::maths::undercoat::{Density, Tile};
use plumage_reference::undercoat::published;
use plumage_reference::undercoat::reference::{Slab, exponential_integral, hemisphere, sphere};
use plumage_tests::gpu;

fn uniform(depth: f32) -> Density {
    let size = UVec3::new(2, 2, 8);
    let tile = Tile::new(size, 1.0, vec![depth; 32], vec![Vec3::Z; 32]);
    Density::new(&tile.expect("a sound tile"))
}

fn direction(degrees: f64) -> [f64; 3] {
    let (s, c) = degrees.to_radians().sin_cos();
    [s, 0.0, c]
}

const BLACK: Coat<f64> = Coat {
    albedo: [0.0; 3],
    skin: [1.0; 3],
};

#[test]
fn uniform_medium() {
    for depth in [0.5f32, 1.0, 2.0, 4.0] {
        let density = uniform(depth);
        let c = f64::from(depth);
        for angle in [0.0, 30.0, 60.0, 75.0] {
            // An open light straight above: what is seen of a white skin below black fibres is the transmittance.
            let settings = SlabSettings {
                light: bevy_plumage::maths::undercoat::slab::LightModel::Open,
                ..SlabSettings::near()
            };
            let ray = SlabRay {
                place: [0.3, 0.6],
                eye: direction(angle),
                light: [0.0, 0.0, 1.0],
            };
            let seen = slab_radiance(&density, &BLACK, &ray, &settings)[0];
            let exact = (-c / ray.eye[2]).exp();
            assert!(
                (seen - exact).abs() < 1e-3,
                "{depth} {angle}: {seen} {exact}"
            );
        }
        // Light on the skin from the whole sky, by light steps.
        let irradiance = hemisphere(|light| {
            let way = light_exit(0.0, light[2], 0.0);
            let mut sum = 0.0;
            for i in 0..4 {
                let (middle, width) = light_step(i, 4);
                sum += density.sample([0.1, middle * way, middle], 0.0) * width * way;
            }
            (-sum).exp()
        });
        let exact = 2.0 * exponential_integral(3, c);
        assert!(
            (irradiance - exact).abs() < 1e-3,
            "{depth}: {irradiance} {exact}"
        );
    }
}

#[test]
fn fits_of_the_layered_medium() {
    let mut worst = [0.0f64; 3];
    for i in 0..=120 {
        let c = f64::from(i) * 0.05;
        let aligned = (0..4000)
            .map(|i| {
                let mu = (f64::from(i) + 0.5) / 4000.0;
                (-c * (1.0 - mu * mu).sqrt() / mu).exp() / 4000.0
            })
            .sum::<f64>();
        let errors = [
            sky_visibility(c) - exponential_integral(2, c),
            sky_irradiance(c) - 2.0 * exponential_integral(3, c),
            aligned_visibility(c) - aligned,
        ];
        for (w, e) in worst.iter_mut().zip(errors) {
            *w = w.max(e.abs());
        }
    }
    println!(
        "E2 {:.4}, 2 E3 {:.4}, aligned {:.4}",
        worst[0], worst[1], worst[2]
    );
    assert!(
        worst[0] < 0.014 && worst[1] < 0.0066 && worst[2] < 0.012,
        "{worst:?}"
    );
}

/// Cosine between a direction and a fibre that lies `tilt` degrees from the pole.
fn cosine(d: [f64; 3], tilt: f64) -> f64 {
    let (s, c) = tilt.to_radians().sin_cos();
    d[0] * s + d[2] * c
}

#[test]
fn furnace() {
    for spread in [0.0, 0.15, 0.5, 0.85, 1.0] {
        for tilt in [0.0, 35.0, 90.0] {
            // Uniform light 1 on a white fibre, nothing blocked: the source of a step; its sum along a ray is 1 - transmittance.
            let source = sphere(|d| kajiya_kay_diffuse(1.0, cosine(d, tilt), spread));
            assert!((source - 1.0).abs() < 1e-3, "{spread} {tilt}: {source}");
            let mut march = March::default();
            for i in 0..16 {
                let (share, width) = march_step(i, 16.0, 0.5);
                march = march.add(
                    4.0 * width * extinction_sine(0.3, spread),
                    [source; 3],
                    share,
                );
                assert!(march.radiance[0] <= 1.0 + 1e-3);
                assert!((march.radiance[0] + march.transmittance - 1.0).abs() < 1e-3);
            }
        }
    }
    // The usual guess creates energy.
    let usual = sphere(|d| published::kajiya_kay_diffuse(1.0, cosine(d, 0.0)));
    assert!((usual - std::f64::consts::PI).abs() < 1e-2, "{usual}");
}

#[test]
fn specular_lobe_and_cylinder_keep_energy() {
    for power in [1.0, 5.0, 20.0, 60.0, 200.0] {
        for inclination in [10.0, 30.0, 60.0, 90.0f64] {
            let light = inclination.to_radians().cos();
            let sine = inclination.to_radians().sin();
            // Sent on, with the eye's sine that the extinction brings, over what is blocked.
            let sent = sphere(|d| {
                let s = (1.0 - d[2] * d[2]).max(0.0).sqrt();
                s * kajiya_kay_specular(1.0, power, d[2], light)
            }) / sine;
            assert!(sent < 1.0 + 1e-3, "{power} {inclination}: {sent}");
            if power >= 20.0 && inclination >= 30.0 {
                assert!((sent - 1.0).abs() < 1e-3, "{power} {inclination}: {sent}");
            }
        }
    }
    let whole = sphere(|d| {
        let s = (1.0 - d[2] * d[2]).max(0.0).sqrt();
        cylinder_phase(s, d[1].atan2(d[0]))
    });
    assert!((whole - 1.0).abs() < 1e-3, "{whole}");
}

#[test]
fn way_to_the_light() {
    // Against a dense march along the ray in a coat over a sphere.
    for k in [0.0, 0.05, 0.3] {
        for z in [0.0, 0.3, 0.9] {
            for mu in [1.0, 0.5, 0.1, 0.0, -0.1, -0.3] {
                let way: f64 = light_exit(z, mu, k);
                let radius = |t: f64| {
                    // Height above the skin at the distance t, exactly.
                    if k == 0.0 {
                        return z + t * mu;
                    }
                    let r: f64 = 1.0 / k + z;
                    (r * r + 2.0 * r * t * mu + t * t).sqrt() - 1.0 / k
                };
                let step = 1e-3;
                let met = (1..64_000).map(|i| f64::from(i) * step).find_map(|t| {
                    let h = radius(t);
                    (h >= 1.0).then_some(t).or((h < -1e-9).then_some(64.0))
                });
                let met: f64 = met.unwrap_or(64.0);
                assert!(
                    (way - met).abs() < 2e-3 || way.min(met) > 63.9,
                    "{k} {z} {mu}: {way} {met}"
                );
            }
        }
    }
}

#[test]
fn coat_against_photons() {
    let mut worst = 0.0f64;
    for (depth, bound) in [(4.0f32, 0.04), (1.5, 0.06)] {
        let density = uniform(depth);
        for albedo in [0.5, 0.8, 0.95] {
            for angle in [30.0, 65.0f64] {
                let light = direction(angle);
                let slab = Slab {
                    depth: f64::from(depth),
                    albedo,
                    skin: 0.3,
                };
                let truth = slab.albedo(light[2], 200_000, 3);
                let coat = Coat {
                    albedo: [albedo; 3],
                    skin: [0.3; 3],
                };
                let model = |multiple| {
                    let settings = SlabSettings {
                        multiple,
                        ..SlabSettings::near()
                    };
                    hemisphere(|eye| {
                        let ray = SlabRay {
                            place: [0.0; 2],
                            eye,
                            light,
                        };
                        slab_radiance(&density, &coat, &ray, &settings)[0]
                    }) / light[2]
                };
                let (many, single) = (model(true), model(false));
                println!(
                    "depth {depth} albedo {albedo} light {angle}: {:.3} (single {:.3}) of {truth:.4}",
                    many / truth,
                    single / truth
                );
                worst = worst.max((many / truth - 1.0).abs());
                assert!(
                    (many / truth - 1.0).abs() < bound,
                    "{depth} {albedo} {angle}: {many} {truth}"
                );
                if depth == 4.0 {
                    assert!(
                        single / truth < 0.8,
                        "multiple scattering is missed: {single} {truth}"
                    );
                }
            }
        }
    }
    println!("worst {worst:.3}");
}

#[test]
fn nothing_is_ever_not_a_number() {
    for x in [f64::NAN, -1.0, 0.0, 1.0, 2.0, f64::INFINITY] {
        for y in [f64::NAN, -1.0, 0.0, 0.5, 1.0, f64::INFINITY] {
            let values = [
                kajiya_kay_norm(x),
                kajiya_kay_diffuse(0.5, x, y),
                kajiya_kay_specular(0.5, x, y, 0.3),
                light_exit(x, y, 0.1),
                light_exit(0.5, x, y),
                sky_visibility(x),
                sky_irradiance(x),
                aligned_visibility(x),
                column_transmittance(x, y),
                multiple_scattering(x, y, 1.0),
                multiple_scattering(0.5, 0.5, x),
                march_length(x, y, 7.0),
                extinction_sine(x, y),
            ];
            assert!(values.iter().all(|v| !v.is_nan()), "{x} {y}: {values:?}");
        }
    }
}

#[test]
fn shader_twin() {
    const N: usize = 24;
    let text = "#import bevy_plumage::down_light as l
        #import bevy_plumage::down_march as m
        fn evaluate(i: u32) {
            let x = input[3u * i];
            let y = input[3u * i + 1u];
            let z = input[3u * i + 2u];
            let step = l::light_step(u32(x * 8.0), 8u);
            let place = m::march_step(u32(x * 16.0), 3.0 + 13.0 * y, z);
            let added = m::march_add(m::March(vec3(0.1, 0.2, 0.3), x, 0.4), 3.0 * y, vec3(z, 1.0, 2.0), 1.5);
            let values = array<f32, 24>(
                l::kajiya_kay_norm(x), l::kajiya_kay_diffuse(vec3(0.7), y, x).x,
                l::kajiya_kay_specular(0.5, 1.0 + 60.0 * x, 2.0 * y - 1.0, 2.0 * z - 1.0), l::cylinder_phase(x, 3.0 * y),
                step.x, step.y, l::light_exit(x, 2.0 * y - 1.0, 0.5 * z), l::light_exit(x, y, 0.0),
                l::sky_visibility(6.0 * x), l::sky_irradiance(6.0 * x), l::aligned_visibility(6.0 * x),
                l::column_transmittance(4.0 * x, y), l::multiple_scattering(x, y, vec3(z)).y,
                l::scattering_albedo(vec3(x), vec3(y), 4.0 * z).z, place.x, place.y, added.radiance.x, added.transmittance,
                added.distance, m::march_mip(20.0 * x, 3.0),
                m::march_floor(x, 5.0 * y, 1.0 + 2.0 * z, 7.0), m::march_lit(6.0 * x), m::mean_extinction(x, 4.0, 1.0 + 2.0 * z),
                m::lean_shift(x, y));
            for (var k = 0u; k < 24u; k++) { output[24u * i + k] = values[k]; }
        }";
    let axis = [0.0f32, 0.03, 0.2, 0.45, 0.5, 0.77, 0.98, 1.0];
    let mut input = Vec::new();
    let mut expected = Vec::new();
    for x in axis {
        for y in axis {
            for z in axis {
                input.extend([x, y, z]);
                let step = light_step::<f32>((x * 8.0) as u32, 8);
                let place = march_step((x * 16.0) as u32, 3.0 + 13.0 * y, z);
                let before = March {
                    radiance: [0.1, 0.2, 0.3],
                    transmittance: x,
                    distance: 0.4,
                };
                let added = before.add(3.0 * y, [z, 1.0, 2.0], 1.5);
                expected.extend([
                    kajiya_kay_norm(x),
                    kajiya_kay_diffuse(0.7, y, x),
                    kajiya_kay_specular(0.5, 1.0 + 60.0 * x, 2.0 * y - 1.0, 2.0 * z - 1.0),
                    cylinder_phase(x, 3.0 * y),
                    step.0,
                    step.1,
                    light_exit(x, 2.0 * y - 1.0, 0.5 * z),
                    light_exit(x, y, 0.0),
                    sky_visibility(6.0 * x),
                    sky_irradiance(6.0 * x),
                    aligned_visibility(6.0 * x),
                    column_transmittance(4.0 * x, y),
                    multiple_scattering(x, y, z),
                    scattering_albedo(x, y, 4.0 * z),
                    place.0,
                    place.1,
                    added.radiance[0],
                    added.transmittance,
                    added.distance,
                    march_mip(20.0 * x, 3.0),
                    march_floor(x, 5.0 * y, 1.0 + 2.0 * z, 7.0),
                    march_lit(6.0 * x),
                    mean_extinction(x, 4.0, 1.0 + 2.0 * z),
                    lean_shift(x, y),
                ]);
            }
        }
    }
    let count = input.len() / 3;
    let files = ["down_light.wgsl", "down_march.wgsl"];
    let Some(result) = gpu::run(&files, text, &input, count, N * count) else {
        return;
    };
    for (k, (a, b)) in result.iter().zip(&expected).enumerate() {
        let bound = 2e-5 * b.abs().max(1.0);
        let at = &input[3 * (k / N)..3 * (k / N) + 3];
        assert!((a - b).abs() <= bound, "value {} at {at:?}: {a} {b}", k % N);
    }
}
