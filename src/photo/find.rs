//! What stands out of the ground, be it even or rough.

use super::{
    ExtractError,
    background::Background,
    color::Lab,
    held::{Held, apart, held},
    segment::{Segment, segment},
};
use bevy::math::Vec2;
use imageproc::{distance_transform::Norm, morphology};

/// Radius of thin lines in the overview.
const OVERVIEW_OPEN: u8 = 2;
/// Ground of more noise than this is rough.
pub(super) const ROUGH: f32 = 0.08;
/// Least contrast of color to a rough ground: right finds had 0.85 and more, pieces of rock or feather up to 0.81.
const CONTRAST: f32 = 0.82;

/// Colors along the frame with their places, -1..1.
fn ring(lab: &Lab) -> Vec<(Vec2, [f32; 3])> {
    let (width, height) = (lab.width(), lab.height());
    let thick = (width.min(height) / 40).clamp(2, 12);
    let mut samples = Vec::new();
    for y in 0..height {
        for x in 0..width {
            let edge = x.min(width - 1 - x).min(y.min(height - 1 - y));
            if edge < thick && (x + y) % 2 == 0 {
                samples.push((place(x, y, width, height), lab.at(y * width + x)));
            }
        }
    }
    samples
}

/// A pixel's place, -1..1 over the picture.
pub(super) fn place(x: usize, y: usize, width: usize, height: usize) -> Vec2 {
    Vec2::new(
        (x as f32 + 0.5) / width as f32 * 2.0 - 1.0,
        (y as f32 + 0.5) / height as f32 * 2.0 - 1.0,
    )
}

/// Colors of all that is not near what was found, with their places; none where too little is left.
fn free(lab: &Lab, found: &Segment) -> Option<Vec<(Vec2, [f32; 3])>> {
    let (width, height) = (lab.width(), lab.height());
    let near = morphology::dilate(&found.mask, Norm::L2, 6);
    let step = (width * height / 40_000).max(1);
    let samples: Vec<_> = (0..width * height)
        .step_by(step)
        .filter(|&i| near.as_raw()[i] == 0)
        .map(|i| (place(i % width, i / width, width, height), lab.at(i)))
        .collect();
    (samples.len() * step * 10 >= width * height).then_some(samples)
}

/// The background from the frame first, then from all that is not feather.
fn find_background(lab: &Lab) -> (Background, Segment) {
    let (width, height) = (lab.width(), lab.height());
    let at = |x, y| place(x, y, width, height);
    let ring = ring(lab);
    let mut background = Background::fit(&ring, None);
    background.find_lines(&ring);
    let mut found = segment(lab, &background, &at, None, [OVERVIEW_OPEN, 2], [0.0, 1.0]);
    for _ in 0..2 {
        let Some(samples) = free(lab, &found) else {
            break;
        };
        background = Background::fit(&samples, Some(&background));
        found = segment(lab, &background, &at, None, [OVERVIEW_OPEN, 2], [0.0, 1.0]);
    }
    (background, found)
}

/// The same on rough ground.
fn roughened(lab: &Lab, plain: &Background) -> (Background, Segment) {
    let (width, height) = (lab.width(), lab.height());
    let at = |x, y| place(x, y, width, height);
    let mut background = plain.clone();
    background.roughen(&ring(lab));
    let cut = |background: &Background| {
        segment(lab, background, &at, None, [OVERVIEW_OPEN, 2], [0.0, 1.0])
    };
    let mut found = cut(&background);
    for _ in 0..2 {
        let Some(samples) = free(lab, &found) else {
            break;
        };
        background.roughen(&samples);
        found = cut(&background);
    }
    (background, found)
}

/// What stands out of the ground.
pub(super) struct Found {
    pub background: Background,
    pub segment: Segment,
    pub held: Held,
}

impl Found {
    fn new((background, segment): (Background, Segment), lab: &Lab) -> Self {
        let held = held(&segment.mask, lab);
        Self {
            background,
            segment,
            held,
        }
    }

    /// How far the colors of what stands out are others than those of the ground, 0..1. What reaches the border as one thing may
    /// be a hand alone: 0.
    fn contrast(&self, lab: &Lab) -> f32 {
        let holder = match &self.held {
            Held::Free => None,
            Held::By(holder) => Some(holder),
            Held::Cut | Held::Banded | Held::Unclear { .. } => return 0.0,
        };
        let holds = |i: usize| holder.is_some_and(|holder| holder.as_raw()[i] > 0);
        let mask = self.segment.mask.as_raw();
        apart(lab, &|i| (!holds(i)).then(|| mask[i] > 0))
    }
}

/// Looks for what stands out of the ground; on a rough one in two ways, of which the one is taken whose find has the more other
/// colors.
pub(super) fn find(lab: &Lab) -> Result<Found, ExtractError> {
    let plain = Found::new(find_background(lab), lab);
    let noise = plain.background.most;
    if noise <= ROUGH {
        return Ok(plain);
    }
    let rough = Found::new(roughened(lab, &plain.background), lab);
    let [a, b] = [&plain, &rough].map(|found| found.contrast(lab));
    let (best, contrast) = if a > b { (plain, a) } else { (rough, b) };
    if contrast < CONTRAST {
        return Err(ExtractError::RoughGround {
            noise,
            even: ROUGH,
            measure: "contrast of color",
            value: contrast,
            least: CONTRAST,
        });
    }
    Ok(best)
}
