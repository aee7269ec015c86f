//! How wide a thin line is behind the lens's blur.

use libm::erff;
use std::sync::LazyLock;

/// Widths of the table, over the blur's standard deviation: 0.05 to 6 in steps of 0.05.
const STEPS: usize = 120;
const STEP: f32 = 0.05;
/// Widest of them: wider lines show their full color in the middle.
const WIDEST: f32 = STEP * STEPS as f32;

/// What a line of one width looks like through a Gaussian; lengths over its standard deviation.
struct Line {
    width: f32,
    /// Width at half of its ridge.
    seen: f32,
}

/// Height of a line of width `width` and height 1 at `x` from its middle, blurred; lengths over the standard deviation.
fn blurred(width: f32, x: f32) -> f32 {
    let part = |edge: f32| erff((edge - x) * std::f32::consts::FRAC_1_SQRT_2);
    0.5 * (part(0.5 * width) - part(-0.5 * width))
}

static LINES: LazyLock<Vec<Line>> = LazyLock::new(|| {
    (1..=STEPS)
        .map(|i| {
            let width = STEP * i as f32;
            let ridge = blurred(width, 0.0);
            let (mut low, mut high) = (0.0, 0.5 * width + 3.0);
            for _ in 0..24 {
                let middle = 0.5 * (low + high);
                if blurred(width, middle) > 0.5 * ridge {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            Line {
                width,
                seen: low + high,
            }
        })
        .collect()
});

/// How far outside of its real edge a line seems to end, in pixels, from its width at half of its ridge and the standard deviation
/// of the blur: 0 for a line much wider than that, at most a third of the width.
pub(super) fn excess(seen: f32, blur: f32) -> f32 {
    let share = seen / blur.max(1e-3);
    if !share.is_finite() || share >= WIDEST {
        return 0.0;
    }
    let i = LINES.partition_point(|line| line.seen < share);
    let width = LINES.get(i).map_or(share, |line| line.width);
    (0.5 * (share - width) * blur).clamp(0.0, seen / 3.0)
}
