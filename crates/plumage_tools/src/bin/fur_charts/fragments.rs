//! Error over the number of virtual fragments.

use plumage_tests::pixel::{Pixel, pixel_error, pixels};
use plumage_tools::plot::{Curve, Labels, Result, draw};
use std::path::Path;

/// The paper's Eq. (4) with the attenuation that suits these pixels best.
fn published(pixels: &[Pixel], exact: &[[f64; 3]], product: bool) -> f64 {
    (0..=12)
        .map(|i| {
            let attenuation = 2f64.powf(f64::from(i) * 0.5);
            pixel_error(pixels, exact, |p| p.published(attenuation, product))
        })
        .fold(f64::INFINITY, f64::min)
}

pub fn count(folder: &Path) -> Result<()> {
    let mut curves: Vec<Curve> = Vec::new();
    let mut level = |name: String, points: Vec<(f64, f64)>| curves.push((name, points));
    for strands in [1, 3, 8, 20] {
        let pixels = pixels(strands);
        let exact: Vec<_> = pixels.iter().map(Pixel::exact).collect();
        let points = (1..=8u32)
            .map(|count| {
                let error = pixel_error(&pixels, &exact, |p| p.virtual_fragments(count, 4.0));
                (f64::from(count), error)
            })
            .collect();
        level(format!("{strands} strands"), points);
        if strands == 8 {
            for (name, product) in [("Eq. (4), 8 strands", false), ("its product form", true)] {
                let error = published(&pixels, &exact, product);
                level(name.into(), vec![(1.0, error), (8.0, error)]);
            }
        }
    }
    let labels = Labels {
        title: "Fur and strands in a pixel: virtual fragments of equal opacity",
        x: "fragments",
        y: "RMS error over mean radiance",
    };
    draw(
        &folder.join("fur_fragments.svg"),
        &labels,
        [true, true],
        &curves,
    )
}
