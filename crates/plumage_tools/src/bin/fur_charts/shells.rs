//! Opacity of a stack of shells over their number.

use plumage_reference::undercoat::slabs::{columns, published_alpha, slab_alpha};
use plumage_tests::tiles::hair_tile;
use plumage_tools::plot::{Curve, Labels, Result, draw};
use std::{f32::consts::FRAC_1_SQRT_2, path::Path};

const COSINES: [(&str, f32); 3] = [("0", 1.0), ("45", FRAC_1_SQRT_2), ("70", 0.342_020_14)];

pub fn count(folder: &Path) -> Result<()> {
    let tile = hair_tile(64, 32, 2);
    let columns = columns(&tile);
    let layer = 64 * 64;
    let mean = |alpha: &dyn Fn(usize) -> f32| -> f64 {
        (0..layer).map(|i| f64::from(alpha(i))).sum::<f64>() / layer as f64
    };
    let mut curves: Vec<Curve> = Vec::new();
    for (angle, cos) in COSINES {
        let truth = mean(&|i| 1.0 - (-columns[i] / cos).exp());
        let of = |alpha: &dyn Fn(usize, usize, usize) -> f32| -> Vec<(f64, f64)> {
            [4, 8, 16, 32]
                .map(|shells| {
                    let stack = |i: usize| -> f32 {
                        1.0 - (0..shells)
                            .map(|s| 1.0 - alpha(shells, s, i))
                            .product::<f32>()
                    };
                    (shells as f64, mean(&stack) / truth - 1.0)
                })
                .into()
        };
        let slab = of(&|shells, s, i| {
            let at = |k: usize| columns[k * 32 / shells * layer + i];
            slab_alpha(at(s), at(s + 1), cos)
        });
        // The paper samples the middle of each slab.
        let point = of(&|shells, s, i| {
            let z = (2 * s + 1) * 32 / (2 * shells);
            published_alpha(tile.extinction()[z.min(31) * layer + i], shells as f32)
        });
        curves.push((format!("slabs, {angle} deg"), slab));
        curves.push((format!("published, {angle} deg"), point));
    }
    let labels = Labels {
        title: "Opacity of a stack of shells against the exact one (hair)",
        x: "shells",
        y: "relative bias",
    };
    draw(
        &folder.join("fur_shells.svg"),
        &labels,
        [true, false],
        &curves,
    )
}
