//! What a synthetic photograph really shows.

use super::{Pose, Setting, color, sheet::Sheet};
use bevy_plumage::anatomy::{Feather, Side};
use image::GrayImage;

/// The barbs of one vane as the picture shows them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BarbTruth {
    /// alpha_b, radians.
    pub angle: f64,
    /// Barbs per millimetre along the shaft.
    pub density: f64,
    /// Distance of neighboring barbs across them, pixels.
    pub period: f64,
    /// Contrast of the barbs that the lens and the sensor leave, over the deviation of the noise.
    pub visible: f64,
    /// Share of the vane's height that is closed (not down).
    pub closed: f64,
}

impl BarbTruth {
    /// Whether the picture shows single barbs: at least 3 pixels each, contrast over the noise, and mostly closed.
    pub fn is_resolved(&self) -> bool {
        self.period >= 3.0 && self.visible >= 1.0 && self.closed > 0.6
    }
}

/// A place where the painted color steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatternEdge {
    /// Where half of the step is done, pixels.
    pub place: [f64; 2],
    /// Unit direction in the frame from the darker to the lighter side.
    pub normal: [f64; 2],
}

/// Everything that an extraction has to find out about a photograph.
pub struct Truth {
    /// 255 where at least half of the pixel lies within the outline or on the shaft.
    pub mask: GrayImage,
    /// Outline P with its splits, pixels, closed.
    pub contour: Vec<[f64; 2]>,
    /// F_P from the skin to the tip, pixels, 256 points.
    pub rachis: Vec<[f64; 2]>,
    /// Barbs of the left and the right vane, as the feather's file names them (its front, tip up).
    pub barbs: [BarbTruth; 2],
    /// The face towards the body lies up.
    pub back: bool,
    /// Length of the feather, millimetres.
    pub length_mm: f64,
    /// Where the feather lies.
    pub pose: Pose,
    sheet: Sheet,
    light: [f32; 3],
    barred: bool,
}

/// Half the length over which an edge's step is looked for, pixels.
pub(super) const EDGE_REACH: f64 = 8.0;

impl Truth {
    pub(super) fn new(feather: &Feather, setting: &Setting, sheet: Sheet, mask: GrayImage) -> Self {
        let pose = sheet.pose.clone();
        let shape = feather
            .contour
            .resampled(256)
            .clumped(&feather.clumps)
            .perturbed(&feather.gaps);
        let contour = shape
            .polyline([feather.left.barb_angle, feather.right.barb_angle])
            .into_iter()
            .map(|point| pose.pixel_of_canonical(point.map(f64::from)))
            .collect();
        let rachis = (0..256)
            .map(|i| pose.pixel_of_canonical([0.0, f64::from(i) / 255.0]))
            .collect();
        let length_mm = f64::from(feather.length_mm);
        let barbs = Side::BOTH.map(|side| {
            let vane = feather.vane(side);
            let period = f64::from(feather.p_b(side)) * pose.scale;
            // Blur of the lens, of the rendered pixel, and of the sensor's own.
            let sigma = f64::from(setting.blur).hypot(0.5);
            let kept = (-2.0 * (std::f64::consts::PI * sigma / period).powi(2)).exp();
            BarbTruth {
                angle: f64::from(vane.alpha_b()),
                density: f64::from(vane.barb_count) / length_mm,
                period,
                visible: 0.05 * kept / f64::from(setting.noise).max(1.0 / 255.0),
                closed: 1.0 - f64::from(vane.downy),
            }
        });
        let pattern = setting.pattern(feather);
        Self {
            mask,
            contour,
            rachis,
            barbs,
            back: setting.back,
            length_mm,
            pose,
            sheet,
            light: setting
                .white_balance
                .map(|factor| factor * setting.exposure),
            barred: pattern.bars.is_some() || pattern.rim.is_some() || pattern.stops.len() > 1,
        }
    }

    /// Color of the vane at a pixel without its fine structure, sRGB 0..1: under even light, as the exposure and the white
    /// balance of this photograph show it (a photograph without a color card leaves both open). Runs on under the shaft.
    pub fn albedo(&self, pixel: [f64; 2]) -> [f32; 3] {
        let linear = self.sheet.albedo(pixel);
        std::array::from_fn(|i| color::encoded(linear[i] * self.light[i]))
    }

    /// Whether a pixel lies well within the vane: `margin` pixels from the outline and from the shaft.
    pub fn is_inside(&self, pixel: [f64; 2], margin: f64) -> bool {
        let around = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0], [0.0, 0.0]];
        let [x, y] = self.pose.canonical(pixel);
        let off_shaft = x.abs() * self.pose.scale > margin + self.sheet.shaft_pixels(y);
        off_shaft
            && around.iter().all(|[dx, dy]| {
                self.sheet
                    .outline([pixel[0] + dx * margin, pixel[1] + dy * margin])
                    > 0.99
            })
    }

    /// Points inside the vane on a grid with about `count` of them.
    pub fn grid(&self, count: usize, margin: f64) -> Vec<[f64; 2]> {
        let area = self.mask.iter().filter(|&&value| value > 0).count();
        let step = ((area as f64 / count.max(1) as f64).sqrt()).max(1.0);
        let (width, height) = self.mask.dimensions();
        let columns = (f64::from(width) / step) as usize;
        let rows = (f64::from(height) / step) as usize;
        (0..rows)
            .flat_map(|row| (0..columns).map(move |column| (row, column)))
            .map(|(row, column)| [(column as f64 + 0.5) * step, (row as f64 + 0.5) * step])
            .filter(|pixel| {
                self.mask.get_pixel(pixel[0] as u32, pixel[1] as u32).0[0] > 0
                    && self.is_inside(*pixel, margin)
            })
            .collect()
    }

    fn grey(&self, pixel: [f64; 2]) -> f64 {
        grey(self.albedo(pixel))
    }

    /// Whether the vane is closed at a pixel. Through down the background shows, and a photograph alone does not tell the two
    /// apart.
    pub fn is_closed(&self, pixel: [f64; 2]) -> bool {
        self.sheet.closed(pixel) > 0.9
    }

    /// Whether the painted color changes by less than 0.02 (sRGB) within 6 pixels.
    pub fn is_plain(&self, pixel: [f64; 2]) -> bool {
        let here = self.albedo(pixel);
        [[6.0, 0.0], [-6.0, 0.0], [0.0, 6.0], [0.0, -6.0]]
            .iter()
            .all(|[dx, dy]| {
                let there = self.albedo([pixel[0] + dx, pixel[1] + dy]);
                (0..3).all(|c| (there[c] - here[c]).abs() < 0.02)
            })
    }

    /// Edges of the pattern: steps of at least 0.12 (sRGB grey) of which three quarters lie within 6 pixels.
    pub fn pattern_edges(&self) -> Vec<PatternEdge> {
        if !self.barred {
            return Vec::new();
        }
        let points = self.grid(3000, EDGE_REACH + 2.0);
        points
            .into_iter()
            .filter_map(|start| self.edge_near(start))
            .collect()
    }

    /// Follows the gradient from a point to the middle of a step.
    fn edge_near(&self, start: [f64; 2]) -> Option<PatternEdge> {
        let slope = |[x, y]: [f64; 2]| {
            [
                self.grey([x + 1.5, y]) - self.grey([x - 1.5, y]),
                self.grey([x, y + 1.5]) - self.grey([x, y - 1.5]),
            ]
        };
        let [gx, gy] = slope(start);
        let length = gx.hypot(gy);
        if length < 0.03 {
            return None;
        }
        let normal = [gx / length, gy / length];
        let at = |t: f64| self.grey([start[0] + t * normal[0], start[1] + t * normal[1]]);
        let (low, high) = (at(-EDGE_REACH), at(EDGE_REACH));
        if high - low < 0.12 || at(3.0) - at(-3.0) < 0.75 * (high - low) {
            return None;
        }
        let offset = crossing(&at, 0.5 * (low + high))?;
        Some(PatternEdge {
            place: [start[0] + offset * normal[0], start[1] + offset * normal[1]],
            normal,
        })
    }
}

/// Brightness of an sRGB color.
pub(super) fn grey(rgb: [f32; 3]) -> f64 {
    f64::from(0.299 * rgb[0] + 0.587 * rgb[1] + 0.114 * rgb[2])
}

/// Where a profile rises through `level`, nearest to 0, within the reach of an edge.
pub(super) fn crossing(at: &impl Fn(f64) -> f64, level: f64) -> Option<f64> {
    let step = 0.25;
    let count = (EDGE_REACH / step) as i32;
    let mut best: Option<f64> = None;
    let mut last = at(-EDGE_REACH);
    for i in -count + 1..=count {
        let t = f64::from(i) * step;
        let value = at(t);
        if last < level && value >= level {
            let place = t - step * (value - level) / (value - last).max(1e-9);
            if best.is_none_or(|old| place.abs() < old.abs()) {
                best = Some(place);
            }
        }
        last = value;
    }
    best
}
