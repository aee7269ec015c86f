//! What can be measured of a picture of a bird: outline, specks, proportions, colors, contrast by scale, highlights, light.
//!
//! Bounds and their sources are those of photographs of a golden eagle, a scarlet and a green-winged macaw. Of a barn owl none was
//! measured: it is judged by what holds for any bird.

mod blur;
mod color;

use bevy::color::Srgba;
use blur::gaussian;
use color::{LUMINANCE, hsv, is_mauve, is_olive};
use serde::Deserialize;
use std::{error::Error, fs, path::Path};

/// Most specks among 10,000 pixels: photographs have 0.8 to 3.3.
const SPECKS: f32 = 5.0;
/// How far a speck stands out, share of the median around it.
const STANDS_OUT: f32 = 0.12;
/// Pixels from the edge of feathers within which their color is not judged.
const EDGE: usize = 2;
/// Darkest that a mask shows where there is a bird, 0..1: a hundredth of a pixel.
const SEEN: f32 = 0.1;
/// Darkest blue of a bill or a foot in a mask; darker ones are things around the bird.
const BODY: f32 = 0.5;
/// Finest scale at which contrast is measured, millimetres on the bird: half a pixel of the photographs.
const FINEST: f32 = 0.45;
/// Least by which what is around a bird is darker, stops.
const DARKER: f32 = 0.7;

/// Which bird is judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Species {
    /// Scarlet macaw.
    Macaw,
    /// Golden eagle.
    Eagle,
    /// Barn owl.
    Owl,
}

/// From where it is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum View {
    /// Three-quarter front.
    Front,
    /// From the side.
    Side,
    /// From behind.
    Back,
    /// Head and neck.
    Head,
}

/// One line of the list.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Number in the list.
    pub number: u32,
    /// What is judged.
    pub what: &'static str,
    /// What was found.
    pub found: f32,
    /// Least and most that is accepted.
    pub wanted: (f32, f32),
}

impl Line {
    /// Whether the picture is accepted.
    pub fn passes(&self) -> bool {
        (self.wanted.0..=self.wanted.1).contains(&self.found)
    }
}

/// A picture and which of its pixels show the bird.
pub struct Subject {
    /// What a pixel measures on the bird, millimetres.
    scale: f32,
    width: usize,
    height: usize,
    /// Shown values, sRGB 0..1.
    pixels: Vec<[f32; 3]>,
    /// Where the bird is.
    mask: Vec<bool>,
    /// Where its feathers are: not bill, eyes, feet and bare skin.
    feathers: Vec<bool>,
    /// Where things are that may hide a part of it.
    things: Vec<bool>,
    /// Where the breasts are: feathers of the circles that were told.
    breast: Vec<usize>,
}

/// What the JSON beside a mask says.
#[derive(Deserialize)]
struct Said {
    /// What a pixel measures on the bird, millimetres.
    mm_per_pixel: f32,
    /// Middle and radius of each bird's breast, pixels.
    breasts: Vec<[f32; 3]>,
}

fn median(mut values: Vec<f32>) -> f32 {
    if values.is_empty() {
        return 0.0;
    }
    values.sort_by(f32::total_cmp);
    values[values.len() / 2]
}

impl Subject {
    /// Of a picture and the mask that an example has written for it (`--shot`, `--masks`), beside which a JSON file says what a pixel
    /// measures and where the breasts are.
    ///
    /// # Errors
    /// If a file is missing or cannot be read, or the two pictures differ in size.
    pub fn open(picture: &Path, mask: &Path) -> Result<Self, Box<dyn Error>> {
        let said: Said = serde_json::from_slice(&fs::read(mask.with_extension("json"))?)?;
        let (picture, mask) = (
            image::open(picture)?.to_rgb8(),
            image::open(mask)?.to_rgb8(),
        );
        if picture.dimensions() != mask.dimensions() {
            return Err("the two pictures differ in size".into());
        }
        let width = picture.width() as usize;
        Ok(Self::new(
            &picture,
            &mask,
            width,
            said.mm_per_pixel,
            &said.breasts,
        ))
    }

    /// Width and height, pixels.
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// Of bytes RGB. In a mask of the same camera feathers have any color but blue, bill, eyes, feet and bare skin are blue, things
    /// that may hide a part of it are dark blue, the rest is black. `scale`: what a pixel measures on the bird, millimetres; `breasts`: middle and radius of circles that show feathers of the
    /// breast alone, pixels.
    pub fn new(
        picture: &[u8],
        mask: &[u8],
        width: usize,
        scale: f32,
        breasts: &[[f32; 3]],
    ) -> Self {
        let shown = |bytes: &[u8]| -> Vec<[f32; 3]> {
            let pixels = bytes.chunks_exact(3);
            pixels
                .map(|p| [p[0], p[1], p[2]].map(|c| f32::from(c) / 255.0))
                .collect()
        };
        let (pixels, shapes) = (shown(picture), shown(mask));
        let mask: Vec<bool> = shapes
            .iter()
            .map(|p| p[0].max(p[1]) > SEEN || p[2] > BODY)
            .collect();
        let things = shapes.iter().zip(&mask);
        let things = things.map(|(p, bird)| !bird && p[2] > SEEN).collect();
        let feathers: Vec<bool> = shapes.iter().map(|p| p[0].max(p[1]) > SEEN).collect();
        let height = pixels.len() / width.max(1);
        let mut subject = Self {
            scale,
            width,
            height,
            pixels,
            mask,
            feathers,
            things,
            breast: Vec::new(),
        };
        let is_breast = |i: &usize| {
            let at = [(i % width) as f32 + 0.5, (i / width) as f32 + 0.5];
            let holds = |[x, y, radius]: &[f32; 3]| (at[0] - x).hypot(at[1] - y) < *radius;
            breasts.iter().any(holds) && subject.is_inside(&subject.feathers, *i, EDGE)
        };
        subject.breast = (0..subject.feathers.len()).filter(is_breast).collect();
        subject
    }

    fn neighbors(&self, i: usize, reach: usize) -> impl Iterator<Item = usize> + '_ {
        let (x, y) = (i % self.width, i / self.width);
        let columns = x.saturating_sub(reach)..=(x + reach).min(self.width - 1);
        let rows = y.saturating_sub(reach)..=(y + reach).min(self.height - 1);
        rows.flat_map(move |v| columns.clone().map(move |u| v * self.width + u))
    }

    /// Pieces of what is marked, each a list of pixels; what is at most `reach` pixels apart is one piece.
    fn pieces(&self, marked: &[bool], reach: usize) -> Vec<Vec<usize>> {
        let mut seen = vec![false; marked.len()];
        let mut pieces = Vec::new();
        for start in 0..marked.len() {
            if !marked[start] || seen[start] {
                continue;
            }
            seen[start] = true;
            let mut piece = vec![start];
            let mut next = 0;
            while let Some(i) = piece.get(next).copied() {
                next += 1;
                for k in self.neighbors(i, reach) {
                    if marked[k] && !seen[k] {
                        seen[k] = true;
                        piece.push(k);
                    }
                }
            }
            pieces.push(piece);
        }
        pieces
    }

    /// Pixels of the pieces of the mask that hold at least a hundredth of it. Things that may hide what joins a piece to the body join
    /// them, and so does a gap of a pixel.
    fn body(&self) -> Vec<bool> {
        let shown: Vec<bool> = self
            .mask
            .iter()
            .zip(&self.things)
            .map(|(m, t)| *m || *t)
            .collect();
        let least = self.mask.iter().filter(|m| **m).count().div_ceil(100);
        let mut body = vec![false; shown.len()];
        for piece in self.pieces(&shown, 2) {
            let bird: Vec<usize> = piece.into_iter().filter(|i| self.mask[*i]).collect();
            if bird.len() >= least {
                bird.into_iter().for_each(|i| body[i] = true);
            }
        }
        body
    }

    /// Largest region of feathers of which `is` holds, percent of all feathers. Pixels at the edge of the feathers are left out: they
    /// show what is behind, too.
    fn largest(&self, is: impl Fn([f32; 3]) -> bool) -> f32 {
        let marked: Vec<bool> = (0..self.feathers.len())
            .map(|i| self.is_inside(&self.feathers, i, EDGE) && is(self.pixels[i]))
            .collect();
        let pieces = self.pieces(&marked, 1);
        let largest = pieces.iter().map(Vec::len).max().unwrap_or(0);
        let count = self.feathers.iter().filter(|m| **m).count();
        100.0 * largest as f32 / count.max(1) as f32
    }

    fn is_inside(&self, mask: &[bool], i: usize, reach: usize) -> bool {
        let (x, y) = (i % self.width, i / self.width);
        x >= reach
            && y >= reach
            && x + reach < self.width
            && y + reach < self.height
            && self.neighbors(i, reach).all(|k| mask[k])
    }

    fn luminance(&self, i: usize) -> f32 {
        (0..3).map(|c| LUMINANCE[c] * self.pixels[i][c]).sum()
    }

    /// Pixels that stand out from all eight neighbors, and how many were looked at.
    fn specks(&self) -> (Vec<usize>, usize) {
        let inside: Vec<usize> = (0..self.mask.len())
            .filter(|i| self.is_inside(&self.mask, *i, 4))
            .collect();
        let stands_out = |i: usize| {
            let own = self.luminance(i);
            let around = median(self.neighbors(i, 2).map(|k| self.luminance(k)).collect());
            let off = |k: usize| own - self.luminance(k);
            let margin = STANDS_OUT * around;
            let others = || self.neighbors(i, 1).filter(|k| *k != i);
            others().all(|k| off(k) > margin) || others().all(|k| off(k) < -margin)
        };
        let specks = inside.iter().copied().filter(|i| stands_out(*i)).collect();
        (specks, inside.len())
    }

    /// The picture, dark, with what the judge objects to: specks white, stray pixels yellow, olive green, mauve magenta, pale pixels of
    /// the breast cyan; the breast is bright. Bytes RGB.
    pub fn marks(&self, species: Species) -> Vec<u8> {
        let mut marks: Vec<[f32; 3]> = self.pixels.iter().map(|p| p.map(|c| 0.4 * c)).collect();
        for i in &self.breast {
            marks[*i] = self.pixels[*i];
        }
        for i in self.pale() {
            marks[i] = [0.0, 1.0, 1.0];
        }
        for i in (0..marks.len()).filter(|i| self.is_inside(&self.feathers, *i, EDGE)) {
            if species == Species::Macaw && is_olive(self.pixels[i]) {
                marks[i] = [0.0, 1.0, 0.0];
            } else if is_mauve(self.pixels[i]) {
                marks[i] = [1.0, 0.0, 1.0];
            }
        }
        let body = self.body();
        for i in (0..marks.len()).filter(|i| self.mask[*i] && !body[*i]) {
            for k in self.neighbors(i, 3) {
                marks[k] = [1.0, 1.0, 0.0];
            }
        }
        for i in self.specks().0 {
            for k in self.neighbors(i, 1) {
                marks[k] = [1.0; 3];
            }
        }
        let bytes = marks.into_iter().flatten();
        bytes.map(|c| (255.0 * c).round() as u8).collect()
    }

    /// Median of a property over the breast.
    fn of_breast(&self, part: impl Fn([f32; 3]) -> f32) -> f32 {
        median(self.breast.iter().map(|i| part(self.pixels[*i])).collect())
    }

    /// Pixels of the breast that haze makes pale.
    fn pale(&self) -> Vec<usize> {
        let saturation = self.of_breast(|p| hsv(p)[1]);
        let is_pale = |i: &usize| hsv(self.pixels[*i])[1] < 0.55 * saturation;
        self.breast.iter().copied().filter(is_pale).collect()
    }

    /// Each bird of the picture: columns of the body that empty ones part from the rest, where they are at least a twentieth of the
    /// picture wide.
    fn birds(&self, body: &[bool]) -> Vec<std::ops::Range<usize>> {
        let shows: Vec<bool> = (0..self.width)
            .map(|x| body.iter().skip(x).step_by(self.width).any(|b| *b))
            .collect();
        let mut birds = Vec::new();
        let mut start = None;
        for x in 0..=self.width {
            match (start, shows.get(x).copied().unwrap_or(false)) {
                (None, true) => start = Some(x),
                (Some(first), false) => {
                    if 20 * (x - first) >= self.width {
                        birds.push(first..x);
                    }
                    start = None;
                }
                _ => {}
            }
        }
        birds
    }

    /// Width of the widest row but a hundredth over the height of a bird; of several, that of the slimmest, which is seen least from
    /// the side.
    fn slenderness(&self, body: &[bool]) -> f32 {
        let of = |columns: std::ops::Range<usize>| {
            let mut widths: Vec<usize> = (0..body.len() / self.width)
                .map(|y| {
                    let row = &body[y * self.width..(y + 1) * self.width][columns.clone()];
                    let first = row.iter().position(|b| *b);
                    let last = row.iter().rposition(|b| *b);
                    first.zip(last).map_or(0, |(a, b)| b + 1 - a)
                })
                .collect();
            let top = widths.iter().position(|w| *w > 0).unwrap_or(0);
            let low = widths.iter().rposition(|w| *w > 0).unwrap_or(0);
            widths.sort_unstable();
            let rank = widths.len().saturating_sub(1 + widths.len() / 100);
            let widest = widths.get(rank).copied().unwrap_or(0);
            widest as f32 / (low + 1 - top) as f32
        };
        let all = self.birds(body).into_iter().map(of);
        all.fold(f32::MAX, f32::min)
    }

    /// Contrast of the red channel in four octaves of scale from 0.45 mm around the pixels: the difference of two Gaussians over the mean.
    pub fn octaves(&self, at: &[usize]) -> [f32; 4] {
        let red: Vec<f32> = self
            .pixels
            .iter()
            .map(|p| Srgba::gamma_function(p[0]))
            .collect();
        let levels: Vec<Vec<f32>> = [1.0, 2.0, 4.0, 8.0, 16.0]
            .map(|octave| FINEST * octave / self.scale)
            .map(|sigma| gaussian(&red, &self.mask, self.width, sigma))
            .into();
        let n = at.len().max(1) as f32;
        let mean = at.iter().map(|i| red[*i]).sum::<f32>() / n;
        std::array::from_fn(|k| {
            let square: f32 = at
                .iter()
                .map(|i| (levels[k][*i] - levels[k + 1][*i]).powi(2))
                .sum();
            (square / n).sqrt() / mean.max(1.0e-6)
        })
    }

    /// By how much what is around the bird is darker on the average.
    fn stops(&self) -> f32 {
        let mean = |bird: bool| {
            let (mut sum, mut count) = (0.0, 0.0);
            for (pixel, _) in self.pixels.iter().zip(&self.mask).filter(|p| *p.1 == bird) {
                sum += (0..3)
                    .map(|c| LUMINANCE[c] * Srgba::gamma_function(pixel[c]))
                    .sum::<f32>();
                count += 1.0;
            }
            f32::max(sum / f32::max(count, 1.0), 1.0e-5)
        };
        (mean(true) / mean(false)).log2()
    }

    /// The lines of the list that a program can judge.
    pub fn judge(&self, species: Species, view: View) -> Vec<Line> {
        let mut lines = Vec::new();
        let mut line = |number, what, found, wanted| {
            lines.push(Line {
                number,
                what,
                found,
                wanted,
            });
        };
        let (macaw, eagle) = (species == Species::Macaw, species == Species::Eagle);
        let body = self.body();
        let count = self.feathers.iter().filter(|m| **m).count().max(1) as f32;
        let share = |of: &dyn Fn([f32; 3]) -> bool| {
            let inside = (0..self.feathers.len()).filter(|i| self.feathers[*i]);
            100.0 * inside.filter(|i| of(self.pixels[*i])).count() as f32 / count
        };
        let stray = (0..body.len()).filter(|i| self.mask[*i] && !body[*i]);
        line(
            1,
            "pixels away from the body",
            stray.count() as f32,
            (0.0, 0.0),
        );
        let (specks, inside) = self.specks();
        let specks = 1.0e4 * specks.len() as f32 / inside.max(1) as f32;
        line(2, "specks in 10,000", specks, (0.0, SPECKS));
        if macaw && view == View::Side {
            let yellow = |p: [f32; 3]| {
                let [h, s, v] = hsv(p);
                (38.0..62.0).contains(&h) && s > 0.6 && v > 0.4
            };
            line(
                3,
                "yellow of the wing, % of the feathers",
                share(&yellow),
                (3.0, 12.0),
            );
        }
        if view == View::Back && (macaw || eagle) {
            let wanted = if macaw { (0.22, 0.26) } else { (0.38, 0.45) };
            line(4, "width over height", self.slenderness(&body), wanted);
            let light: Vec<f32> = (0..body.len())
                .filter(|i| body[*i])
                .map(|i| 255.0 * self.luminance(i))
                .collect();
            let mean = light.iter().sum::<f32>() / light.len().max(1) as f32;
            let least = if macaw { 45.0 } else { 35.0 };
            line(4, "mean of the back, of 255", mean, (least, 255.0));
        }
        if eagle && view == View::Front {
            line(
                5,
                "width over height",
                self.slenderness(&body),
                (0.45, 0.55),
            );
        }
        let breast = &self.breast;
        if matches!(view, View::Front | View::Side) && (macaw || eagle) {
            // Hues around red: 0 lies in the middle.
            let hue = self.of_breast(|p| (hsv(p)[0] + 180.0).rem_euclid(360.0) - 180.0);
            if macaw {
                line(6, "hue of the breast", hue, (3.0, 14.0));
                let saturation = self.of_breast(|p| hsv(p)[1]);
                line(6, "saturation of the breast", saturation, (0.75, 0.92));
                let ratio = self.of_breast(|p| {
                    Srgba::gamma_function(p[1]) / Srgba::gamma_function(p[2]).max(1.0e-4)
                });
                line(6, "green over blue of the breast", ratio, (1.5, 100.0));
            } else {
                line(6, "hue of the breast", hue, (12.0, 32.0));
            }
            let pale = 100.0 * self.pale().len() as f32 / breast.len().max(1) as f32;
            line(8, "pale pixels of the breast, %", pale, (0.0, 0.1));
        }
        if macaw {
            line(
                6,
                "largest olive region, % of the feathers",
                self.largest(is_olive),
                (0.0, 0.2),
            );
        }
        line(
            6,
            "largest mauve region, % of the feathers",
            self.largest(is_mauve),
            (0.0, 0.2),
        );
        if view == View::Front && (macaw || eagle) {
            let wanted = if macaw {
                [0.040, 0.039, 0.046, 0.053]
            } else {
                [0.193, 0.212, 0.177, 0.152]
            };
            let names = [
                "contrast, 0.45 to 0.9 mm",
                "contrast, 0.9 to 1.8 mm",
                "contrast, 1.8 to 3.6 mm",
                "contrast, 3.6 to 7.2 mm",
            ];
            let found = self.octaves(breast);
            for ((name, wanted), found) in names.into_iter().zip(wanted).zip(found) {
                line(7, name, found, (0.65 * wanted, 1.35 * wanted));
            }
        }
        let clipped = share(&|p| p.iter().any(|c| *c >= 254.5 / 255.0));
        line(9, "clipped, % of the feathers", clipped, (0.0, 0.5));
        line(
            12,
            "surroundings darker, stops",
            self.stops(),
            (DARKER, 100.0),
        );
        lines
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A disc with stripes of a period in pixels before a darker ground, and its mask: feathers, the lowest fifth bare.
    fn striped(side: usize, period: f32, scale: f32) -> Subject {
        let (mut picture, mut mask) = (Vec::new(), Vec::new());
        for i in 0..side * side {
            let (x, y) = ((i % side) as f32, (i / side) as f32);
            let middle = 0.5 * side as f32;
            let inside = (x - middle).hypot(y - middle) < 0.4 * side as f32;
            let red = 160.0 + 40.0 * (std::f32::consts::TAU * x / period).sin();
            picture.extend(if inside {
                [red as u8, 30, 20]
            } else {
                [40, 40, 40]
            });
            mask.extend(match (inside, y > 0.8 * side as f32) {
                (true, false) => [90, 200, 0],
                (true, true) => [0, 0, 255],
                _ => [0, 0, 0],
            });
        }
        let middle = 0.5 * side as f32;
        Subject::new(
            &picture,
            &mask,
            side,
            scale,
            &[[middle, middle, 0.2 * middle]],
        )
    }

    #[test]
    fn contrast_is_that_of_the_bird_whatever_the_size_of_the_picture() {
        let inner = |side: usize| -> Vec<usize> {
            (0..side * side)
                .filter(|i| {
                    let off = |at: usize| (at as f32 / side as f32 - 0.5).abs() < 0.15;
                    off(i % side) && off(i / side)
                })
                .collect()
        };
        let small = striped(120, 6.0, 0.9).octaves(&inner(120));
        let large = striped(240, 12.0, 0.45).octaves(&inner(240));
        for (a, b) in small.into_iter().zip(large) {
            assert!((a - b).abs() < 0.01 + 0.05 * b, "{small:?} {large:?}");
        }
        assert!(small[1] > 3.0 * small[3], "{small:?}");
    }

    #[test]
    fn a_mask_parts_feathers_bare_parts_and_what_is_around() {
        let subject = striped(120, 6.0, 0.9);
        let bird = subject.mask.iter().filter(|m| **m).count();
        let feathers = subject.feathers.iter().filter(|m| **m).count();
        assert!(
            feathers < bird && feathers * 10 > bird * 8,
            "{feathers} {bird}"
        );
        let lines = subject.judge(Species::Owl, View::Head);
        let found = |number| {
            let line = lines.iter().find(|line| line.number == number);
            line.map_or(f32::NAN, |line| line.found)
        };
        assert_eq!(found(1), 0.0);
        // Luminance 0.1 against 0.02.
        assert!((1.0..3.0).contains(&found(12)), "{}", found(12));
    }
}
