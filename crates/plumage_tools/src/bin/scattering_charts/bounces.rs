//! Several bounces through explicit fibres against the closed form of the plugin
//! (docs/book/light_between_fibres.md#multiple-scattering).

use bevy_plumage::anatomy::{Feather, Side};
use bevy_plumage::maths::query::{mask_vane, mean_coverage};
use bevy_plumage::maths::scattering::{
    FibreTable, fibre_albedo, fibre_shading, kept_at, kept_light, multiple_scattering,
};
use plumage_reference::curves::{CurveOptions, CurveShader, Curves, Ray, furnace_path};
use plumage_reference::fibre_traced::uniform;
use plumage_tools::plot::{Curve, Labels, Result, draw};
use plumage_tools::presets;
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use std::path::Path;

/// What comes back of a white furnace's light from the rays that hit a patch of the vane: all bounces, and the first alone.
fn furnace(curves: &Curves, shader: &CurveShader, albedo: f64) -> [f64; 2] {
    let n = 200;
    let y = 0.55;
    let sums = (0..n)
        .into_par_iter()
        .map(|i| {
            let mut random = Pcg64Mcg::new(i as u128 + 1);
            let mut sums = [0.0; 3];
            for j in 0..n {
                let x = shader.shaft_x(y) - 0.1 + 0.05 * (f64::from(i) + 0.4) / f64::from(n);
                let ray = Ray {
                    origin: [x, y + 0.05 * (f64::from(j) + 0.6) / f64::from(n), 1.0],
                    direction: [0.0, 0.0, -1.0],
                };
                let path = furnace_path(curves, shader, ray, [albedo; 3], 64, || {
                    uniform(&mut random)
                });
                if let Some(escape) = path {
                    sums[0] += escape.weight[0];
                    sums[1] += if escape.bounces == 1 {
                        escape.weight[0]
                    } else {
                        0.0
                    };
                    sums[2] += 1.0;
                }
            }
            sums
        })
        .reduce(|| [0.0; 3], |a, b| [0, 1, 2].map(|k| a[k] + b[k]));
    [sums[0] / sums[2], sums[1] / sums[2]]
}

/// The vane as it is, and twice as dense.
fn vanes() -> Vec<(&'static str, Feather)> {
    let Some(plain) = presets::by_name("macaw_lesser") else {
        return Vec::new();
    };
    let mut dense = plain.clone();
    for vane in [&mut dense.left, &mut dense.right] {
        vane.barb_count *= 2.0;
        vane.barbules.spacing_um *= 0.66;
    }
    vec![("lesser covert", plain), ("dense vane", dense)]
}

/// The plugin's p: what the fibres seen from the front do not keep of light from all around.
fn meeting(feather: &Feather) -> f64 {
    let vane = feather.query_vane::<f64>(Side::Left);
    let eye = [0.0, 0.0, 1.0];
    let seen = mean_coverage(&mask_vane(&vane, eye));
    let optics = &feather.optics;
    let tables = [optics.rachis, optics.barb, optics.distal, optics.proximal]
        .map(|fibre| FibreTable::build(&fibre));
    let light = kept_light(&vane, tables.each_ref(), 0.0, true);
    let kept: f64 = (0..3)
        .map(|i| {
            let energy = tables[i + 1].row(1.0)[0];
            let sides = light[i + 1].each_ref().map(|side| kept_at(side, eye));
            let share: f64 = (0..4)
                .map(|k| energy[k] * (sides[0][k] + sides[1][k]))
                .sum();
            seen[i] * share / energy.iter().sum::<f64>()
        })
        .sum();
    1.0 - kept / seen.iter().sum::<f64>()
}

/// Light that comes back, traced and by the closed form with the plugin's p.
pub fn multiple(folder: &Path) -> Result<()> {
    let albedos = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.97];
    let mut chart: Vec<Curve> = Vec::new();
    for (name, feather) in vanes() {
        let curves = Curves::build(&feather);
        let shader = CurveShader::new(&feather, [0.5; 3], CurveOptions::default());
        let (mut all, mut single) = (Vec::new(), Vec::new());
        for a in albedos {
            let [total, first] = furnace(&curves, &shader, a);
            let p = (a - total) / (a * (1.0 - total));
            println!(
                "{name}, fibre albedo {a}: traced {total:.4} (first bounce {first:.4}), fitted p {p:.3}"
            );
            all.push((a, total));
            single.push((a, first));
        }
        chart.push((format!("{name}, traced"), all));
        chart.push((format!("{name}, first bounce alone"), single));
        let p = meeting(&feather);
        let points = albedos.map(|a| {
            (
                a,
                (1.0 - p) * a + multiple_scattering([a; 3], [p; 3], 0.0).spread[0],
            )
        });
        chart.push((format!("{name}, closed form, p = {p:.3}"), points.to_vec()));
    }
    let labels = Labels {
        title: "A vane in a white furnace: light that meets several fibres",
        x: "albedo of a fibre",
        y: "light that comes back from what is covered",
    };
    draw(
        &folder.join("scattering_multiple.svg"),
        &labels,
        [false; 2],
        &chart,
    )?;
    let table = |feather: &Feather| FibreTable::build(&feather.optics.distal);
    for (name, feather) in vanes() {
        let t = table(&feather);
        let s = fibre_shading(&t.fibre(), &t.row(1.0), [0.5; 3], [0.0, 0.0, 1.0], 0.0, 8);
        let crowding = 2.0 * feather.r_bd(Side::Left) / feather.p_bl(Side::Left);
        println!(
            "{name}: a barbule painted 0.5 has albedo {:.3}; width over period {crowding:.2}",
            fibre_albedo(&s)[0]
        );
    }
    Ok(())
}
