//! How far each result can be trusted, and why not.

use thiserror::Error;

/// A reason for low confidence.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum Doubt {
    /// The feather differs little from the background around it.
    #[error("low contrast to the background: {0:.1} times its noise")]
    LowContrast(f32),
    /// The background is uneven (texture, grid, clutter).
    #[error("uneven background: noise of {0:.3} in lightness")]
    UnevenBackground(f32),
    /// Other objects lie beside the feather.
    #[error("{0} other objects in the picture")]
    OtherObjects(u32),
    /// Objects of the background's hue that repeat another's shape without its detail were taken for shadows.
    #[error("{0} objects taken for shadows")]
    ShadowsApart(u32),
    /// The feather touches the frame.
    #[error("cut by the frame along {0:.3} of its length")]
    CutByFrame(f32),
    /// The feather is short of pixels.
    #[error("only {0:.0} pixels long")]
    FewPixels(f32),
    /// The outline is not that of a feather.
    #[error("shape unlike a feather: {0}")]
    Shape(&'static str),
    /// Bays in the outline that are deeper than their mouths are wide, and wider than splits: parts of the background's color
    /// may be missing.
    #[error("bays in the outline of {0:.3} of the feather's area")]
    Bitten(f32),
    /// The outline is longer than it is once smoothed over a fiftieth of its extent: torn, downy, or parts of the background's
    /// color are missing.
    #[error("ragged outline, {0:.2} times as long as its smoothed course")]
    Ragged(f32),
    /// No shaft stands out from the vane.
    #[error("faint shaft: {0:.2} of the path stands out")]
    FaintRachis(f32),
    /// The shaft found bends more sharply than shafts do.
    #[error("the shaft found turns by {0:.0} degrees within a tenth of its length")]
    Kink(f32),
    /// Both ends look alike.
    #[error("tip and base look alike")]
    EndsAlike,
    /// Barbs are too fine for the photograph.
    #[error("barbs not resolved")]
    BarbsNotResolved,
    /// Barb directions disagree.
    #[error("barb angles spread by {0:.0} degrees")]
    BarbsSpread(f32),
    /// The asset's barb angle was chosen to follow the outline.
    #[error("the asset takes {0:.0} degrees, which follow the outline best")]
    AngleFromOutline(f32),
    /// The asset's outline (single barb angle, one reach per barb) does not cover the mask.
    #[error("the asset's outline overlaps the mask by a Dice of {0:.3} only")]
    OutlineLost(f32),
    /// Light or dark clipping.
    #[error("{0:.2} of the feather is over- or underexposed")]
    Clipped(f32),
    /// No length was given.
    #[error("no length given, a typical one is assumed")]
    NoScale,
    /// Only the back was seen.
    #[error("the back was photographed, the front is taken to have its color")]
    BackSeen,
    /// A hand or a clamp that reaches the picture's border hides the end by which it holds the feather.
    #[error("held by what reaches the picture's border: the end there is hidden")]
    Held,
    /// A shadow lies along the outline.
    #[error("shadow along {0:.2} of the outline")]
    Shadow(f32),
}

/// Trust in one result.
#[derive(Clone, Debug, PartialEq)]
pub struct Trust {
    /// 0 (a guess) to 1.
    pub value: f32,
    /// Why it is below 1.
    pub doubts: Vec<Doubt>,
}

impl Default for Trust {
    fn default() -> Self {
        Self {
            value: 1.0,
            doubts: Vec::new(),
        }
    }
}

impl Trust {
    /// Notes a doubt; `factor` 0..1 is what is left of the confidence.
    pub(super) fn doubt(&mut self, doubt: Doubt, factor: f32) {
        let factor = if factor.is_finite() {
            factor.clamp(0.0, 1.0)
        } else {
            0.0
        };
        self.value *= factor;
        self.doubts.push(doubt);
    }
}

/// Confidence of each result.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Confidence {
    /// Mask and outline.
    pub contour: Trust,
    /// Shaft curve.
    pub rachis: Trust,
    /// Which end is the tip.
    pub direction: Trust,
    /// Barb angle and density of the left and right vane.
    pub barbs: [Trust; 2],
    /// Color.
    pub albedo: Trust,
    /// Millimetres.
    pub scale: Trust,
    /// Is it one feather at all?
    pub one_feather: Trust,
}

impl Confidence {
    /// Confidence in the shape as a whole: the least of outline, shaft, direction and "is it one feather". Color, barbs and
    /// scale have defaults that do no harm and are left out.
    pub fn overall(&self) -> f32 {
        [
            &self.contour,
            &self.rachis,
            &self.direction,
            &self.one_feather,
        ]
        .iter()
        .fold(1.0, |least, trust| least.min(trust.value))
    }

    /// Every doubt with the name of the result it concerns.
    pub fn doubts(&self) -> impl Iterator<Item = (&'static str, &Doubt)> {
        [
            ("one feather", &self.one_feather),
            ("outline", &self.contour),
            ("shaft", &self.rachis),
            ("direction", &self.direction),
            ("left barbs", &self.barbs[0]),
            ("right barbs", &self.barbs[1]),
            ("color", &self.albedo),
            ("scale", &self.scale),
        ]
        .into_iter()
        .flat_map(|(name, trust)| trust.doubts.iter().map(move |doubt| (name, doubt)))
    }
}
