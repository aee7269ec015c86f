//! How different two colors look: CIEDE2000 (CIE 142-2001; form and test data of Sharma, Wu and Dalal 2005).

/// CIE L*a*b* under D65 of linear sRGB, white at (1, 1, 1); channels may be negative.
pub fn lab([r, g, b]: [f64; 3]) -> [f64; 3] {
    // Each row over the white point's coordinate: the sums of the rows.
    let row = |k: [f64; 3]| (k[0] * r + k[1] * g + k[2] * b) / (k[0] + k[1] + k[2]);
    let f = |t: f64| {
        if t > (6.0_f64 / 29.0).powi(3) {
            t.cbrt()
        } else {
            t * (29.0_f64 / 6.0).powi(2) / 3.0 + 4.0 / 29.0
        }
    };
    let x = f(row([0.4124564, 0.3575761, 0.1804375]));
    let y = f(row([0.2126729, 0.7151522, 0.0721750]));
    let z = f(row([0.0193339, 0.1191920, 0.9503041]));
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// CIEDE2000 of two colors in L*a*b*.
pub fn delta_e_2000(one: [f64; 3], two: [f64; 3]) -> f64 {
    let chroma = |a: f64, b: f64| a.hypot(b);
    let seventh = |c: f64| (c.powi(7) / (c.powi(7) + 25.0_f64.powi(7))).sqrt();
    let mean = 0.5 * (chroma(one[1], one[2]) + chroma(two[1], two[2]));
    let stretch = 1.0 + 0.5 * (1.0 - seventh(mean));
    let polar = |lab: [f64; 3]| {
        let a = stretch * lab[1];
        let hue = lab[2].atan2(a).to_degrees();
        (chroma(a, lab[2]), if hue < 0.0 { hue + 360.0 } else { hue })
    };
    let ((c1, h1), (c2, h2)) = (polar(one), polar(two));
    let grey = c1 * c2 == 0.0;
    let mut turn = h2 - h1;
    if turn.abs() > 180.0 {
        turn -= 360.0 * turn.signum();
    }
    if grey {
        turn = 0.0;
    }
    let hue = match (grey, (h1 - h2).abs() > 180.0) {
        (true, _) => h1 + h2,
        (_, false) => 0.5 * (h1 + h2),
        _ if h1 + h2 < 360.0 => 0.5 * (h1 + h2 + 360.0),
        _ => 0.5 * (h1 + h2 - 360.0),
    };
    let cos = |degrees: f64| degrees.to_radians().cos();
    let light = 0.5 * (one[0] + two[0]) - 50.0;
    let chroma = 0.5 * (c1 + c2);
    let weight = 1.0 - 0.17 * cos(hue - 30.0) + 0.24 * cos(2.0 * hue) + 0.32 * cos(3.0 * hue + 6.0)
        - 0.20 * cos(4.0 * hue - 63.0);
    let l = (two[0] - one[0]) / (1.0 + 0.015 * light * light / (20.0 + light * light).sqrt());
    let c = (c2 - c1) / (1.0 + 0.045 * chroma);
    let h =
        2.0 * (c1 * c2).sqrt() * (0.5 * turn).to_radians().sin() / (1.0 + 0.015 * chroma * weight);
    let angle = 60.0 * (-((hue - 275.0) / 25.0).powi(2)).exp();
    let rotation = -2.0 * seventh(chroma) * angle.to_radians().sin();
    (l * l + c * c + h * h + rotation * c * h).max(0.0).sqrt()
}
