//! K where a ray met a fibre, not averaged over its width.

use bevy_plumage::maths::scattering::{
    Fibre, FibreKind, FibreLobes, FibreTable, Lobe, attenuation, azimuthal, crossing, exit_angle,
    fibre_color, fibre_shading, fold, gamma_transmittance, lobe_shift, lobe_width, longitudinal,
};
use std::f64::consts::PI;

/// K of a fibre at place `h` (-1..1, see [`CurveHit::offset`](super::CurveHit::offset)) of its width, linear RGB per steradian.
///
/// `table` is that of `fibre`; `eye` and `light`: unit directions in the fibre's frame ([`fibre_local`](bevy_plumage::maths::scattering::fibre_local)); `dark_back` as in
/// [`fibre_shading`]. Round fibres only: a flat one is taken as round. Its mean over h is the far field with unlimited harmonics.
pub fn near_field(
    fibre: &Fibre,
    table: &FibreTable,
    albedo: [f64; 3],
    eye: [f64; 3],
    light: [f64; 3],
    h: f64,
    dark_back: f64,
) -> [f64; 3] {
    near_field_lobes(fibre, table, albedo, eye, light, h, dark_back).sum()
}

/// The same by how the light moves inside the fibre.
pub fn near_field_lobes(
    fibre: &Fibre,
    table: &FibreTable,
    albedo: [f64; 3],
    eye: [f64; 3],
    light: [f64; 3],
    h: f64,
    dark_back: f64,
) -> FibreLobes<f64> {
    let p = table.fibre();
    let polar = |v: [f64; 3]| {
        let across = v[1].hypot(v[2]);
        let azimuth = if across > 1e-9 { v[1].atan2(v[2]) } else { 0.0 };
        (v[0].clamp(-1.0, 1.0).asin(), across.min(1.0), azimuth)
    };
    let (theta_o, cos_o, phi_o) = polar(eye);
    let (theta_i, cos_i, phi_i) = polar(light);
    let row = table.row(cos_o);
    let color = fibre_color(&p, albedo);
    let c = crossing(p.eta, cos_o, h);
    let phi = phi_i - phi_o;
    let spread = |centre: f64| {
        let x = (phi - centre + PI).rem_euclid(2.0 * PI) - PI;
        let b = p.azimuthal_roughness;
        let bell = |x: f64| (-0.5 * (x / b).powi(2)).exp() / (b * (2.0 * PI).sqrt());
        bell(x) + bell(x - 2.0 * PI) + bell(x + 2.0 * PI)
    };
    // Optical depth per fibre radius; the shape and color of the medulla's light are those of the far field.
    let medulla = match fibre.kind {
        FibreKind::Pigment { scattering, .. } => {
            (p.core, f64::from(scattering).clamp(0.0, 16.0) / p.core)
        }
        _ => (0.0, 0.0),
    };
    let far = fibre_shading(&p, &row, albedo, eye, dark_back, 8);
    let half = 0.5 * (phi_o + phi_i);
    let facing = if (phi_i - phi_o).abs() > PI {
        -half.cos()
    } else {
        half.cos()
    };
    let b = far.back[0];
    let x = ((facing + b) / (2.0 * b)).clamp(0.0, 1.0);
    let lit = 1.0 + (x * x * (3.0 - 2.0 * x) - 1.0) * dark_back;
    let mut lobes = FibreLobes {
        mirror: [0.0; 3],
        even: [0.0; 3],
        turn: phi.cos(),
    };
    for channel in 0..3 {
        let core = p.structural.then_some((p.core, color.core[channel]));
        // The color of a mirror core is its reflectance; absorption is for the light that passes beside it.
        let mirrored = p.structural && c.offset.abs() < p.core;
        let absorption = if mirrored {
            0.0
        } else {
            color.absorption[channel]
        };
        let share = attenuation(&c, core, medulla, absorption);
        for lobe in [Lobe::R, Lobe::TT, Lobe::TRT, Lobe::TRcT] {
            let amount = share[lobe as usize];
            if amount <= 0.0 {
                continue;
            }
            let shifted = fold(theta_o - lobe_shift(lobe, p.tilt, p.eta));
            let along = longitudinal(
                (shifted.sin(), shifted.cos()),
                (theta_i.sin(), cos_i),
                lobe_width(lobe, p.longitudinal_roughness, p.eta),
            );
            let back = if lobe == Lobe::TRcT { lit } else { 1.0 };
            let k = amount * along * spread(exit_angle(lobe, &c, p.core)) * back;
            if lobe == Lobe::TT {
                lobes.even[channel] += k;
            } else {
                lobes.mirror[channel] += k;
            }
        }
        if !p.structural {
            let clear = attenuation(&c, None, medulla, 0.0);
            let energy = (1.0 - clear.iter().sum::<f64>()).max(0.0)
                * gamma_transmittance(row[2][0], row[2][1], color.absorption[channel]);
            let mut series = [0.0; 8];
            (series[0], series[1]) = (2.0 * far.medulla[0], 2.0 * far.medulla[1]);
            let shape = azimuthal(&series, phi.cos()) / (2.0 * PI);
            lobes.even[channel] +=
                energy * shape * cos_i * 2.0 / PI * (1.0 + far.medulla[2] * theta_i.sin()).max(0.0);
        }
    }
    lobes
}
