//! Blurring within a mask.

/// A Gaussian of `sigma` pixels over the masked pixels.
pub fn gaussian(values: &[f32], mask: &[bool], width: usize, sigma: f32) -> Vec<f32> {
    let reach = (3.0 * sigma).ceil() as isize;
    let weights: Vec<f32> = (-reach..=reach)
        .map(|d| (-0.5 * (d as f32 / sigma).powi(2)).exp())
        .collect();
    let height = values.len() / width;
    let pass = |field: &[(f32, f32)], across: bool| -> Vec<(f32, f32)> {
        (0..field.len())
            .map(|i| {
                let (x, y) = ((i % width) as isize, (i / width) as isize);
                let mut sum = (0.0, 0.0);
                for (w, d) in weights.iter().zip(-reach..=reach) {
                    let (u, v) = if across { (x + d, y) } else { (x, y + d) };
                    if (0..width as isize).contains(&u) && (0..height as isize).contains(&v) {
                        let (value, weight) = field[(v * width as isize + u) as usize];
                        sum.0 += w * value;
                        sum.1 += w * weight;
                    }
                }
                sum
            })
            .collect()
    };
    let start: Vec<(f32, f32)> = values
        .iter()
        .zip(mask)
        .map(|(v, m)| if *m { (*v, 1.0) } else { (0.0, 0.0) })
        .collect();
    pass(&pass(&start, true), false)
        .into_iter()
        .map(|(sum, weight)| sum / weight.max(1.0e-6))
        .collect()
}
