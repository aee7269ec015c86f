//! How different two pictures look: the difference evaluator FLIP (Andersson et al. 2020), by the crate that wgpu's own tests use.

use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageRgb8, FlipPool};

/// What an eye sees of the difference of two pictures, 0..1 a pixel, and the root mean square of it in numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Difference {
    /// Mean of FLIP.
    pub flip: f32,
    /// FLIP that 99 of 100 pixels do not exceed.
    pub flip_99: f32,
    /// FLIP of the pixels up to which 99 of 100 parts of all of it lie: the worst ones.
    pub flip_worst: f32,
    /// Root mean square over all channels, of 255.
    pub rmse: f32,
}

/// Compares pictures of RGB bytes as shown.
///
/// # Panics
/// If they are not of this size.
pub fn difference(truth: &[u8], shown: &[u8], (width, height): (u32, u32)) -> Difference {
    assert_eq!(truth.len(), shown.len(), "pictures of one size");
    let [reference, test] =
        [truth, shown].map(|bytes| FlipImageRgb8::with_data(width, height, bytes));
    let map = nv_flip::flip(reference, test, DEFAULT_PIXELS_PER_DEGREE);
    let mut pool = FlipPool::from_image(&map);
    let squares = truth.iter().zip(shown).map(|(a, b)| {
        let step = f64::from(*a) - f64::from(*b);
        step * step
    });
    Difference {
        flip: pool.mean(),
        flip_99: pool.get_percentile(0.99, false),
        flip_worst: pool.get_percentile(0.99, true),
        rmse: (squares.sum::<f64>() / truth.len().max(1) as f64).sqrt() as f32,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: (u32, u32) = (64, 48);

    #[test]
    fn one_picture_is_itself_and_a_step_is_small() {
        let gray = vec![100; 3 * 64 * 48];
        assert_eq!(difference(&gray, &gray, SIZE), Difference::default());
        let step = difference(&gray, &vec![101; gray.len()], SIZE);
        assert!((step.rmse - 1.0).abs() < 1e-6, "{step:?}");
        let far = difference(&gray, &vec![180; gray.len()], SIZE);
        assert!(
            0.0 < step.flip && step.flip < 0.05 && 0.3 < far.flip,
            "{step:?}, {far:?}"
        );
        // One edge among much that is equal: the mean says little of it, the percentile all.
        let mut edge = gray.clone();
        edge.chunks_mut(3 * 64).for_each(|row| row[90..96].fill(0));
        let edge = difference(&gray, &edge, SIZE);
        assert!(edge.flip_worst > 5.0 * edge.flip, "{edge:?}");
    }
}
