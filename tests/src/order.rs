//! Wrong pixels of a coat over poses and views, by part of the body.

use crate::{
    air::Air,
    scene_bird::{PosedCoat, SceneBird},
};
use bevy::{
    color::{ColorToComponents, LinearRgba, Srgba},
    math::{Vec3, Vec3Swizzles},
    mesh::{Mesh, VertexAttributeValues},
};
use bevy_plumage::{
    groom::{Card, Coat, Groom},
    maths::order::stirred_window,
};
use plumage_reference::{
    crossing::{Overlaps, overlaps},
    visible::{Layers, Pixel, Posed, View},
};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Directions to the eye: from the left, the front, the back, above the left shoulder, and below.
const EYES: [Vec3; 5] = [
    Vec3::X,
    Vec3::Z,
    Vec3::NEG_Z,
    Vec3::new(0.6, 0.6, -0.52),
    Vec3::new(0.5, -0.8, 0.33),
];

/// Texels across and along a feather from which its mean color is taken.
const TEXELS: [usize; 2] = [9, 64];

/// Steps in which it is counted how far behind the right feather lies, and how many; the last holds all beyond.
pub const STEP: f32 = 0.05;
pub const STEPS: usize = 11;

/// Time from one picture to the next where flicker is measured, seconds.
const FRAME: f32 = 1.0 / 30.0;

/// Counted pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Count {
    /// Pixels that show a feather.
    pub feathers: usize,
    /// Those that show a feather which another one should cover.
    pub wrong: usize,
    /// Those of them whose color differs.
    pub color: usize,
    /// Pixels that change their feather within a frame without need.
    pub flicker: usize,
    /// Those of them where a front and a back, which have no order, pass each other.
    pub passing: usize,
    /// Those of them where a border of one feather moves over another part of the same feather.
    pub borders: usize,
    /// Pixels of skin, bill and legs that the window paints over.
    pub painted: usize,
    /// Feathers that are shaded at all pixels.
    pub shaded: usize,
    /// Feathers that pass the depth test without a prepass: all from the highest layer down, and with those that show their backs last.
    pub runs: [usize; 2],
    /// Pixels that show the body: skin, bill, legs and eyes.
    pub bare: usize,
}

impl Count {
    /// Share of the pixels of feathers, per cent.
    pub fn wrong(&self) -> f32 {
        100.0 * self.wrong as f32 / self.feathers.max(1) as f32
    }

    /// Share of the pixels of feathers, per cent.
    pub fn color(&self) -> f32 {
        100.0 * self.color as f32 / self.feathers.max(1) as f32
    }

    /// Share of the pixels of feathers, per cent.
    pub fn flicker(&self) -> f32 {
        100.0 * self.flicker as f32 / self.feathers.max(1) as f32
    }

    /// Share of the pixels of feathers, per cent.
    pub fn passing(&self) -> f32 {
        100.0 * self.passing as f32 / self.feathers.max(1) as f32
    }

    /// Share of the pixels of feathers, per cent.
    pub fn borders(&self) -> f32 {
        100.0 * self.borders as f32 / self.feathers.max(1) as f32
    }

    /// Pixels of the body painted over, over the pixels of feathers, per cent.
    pub fn painted(&self) -> f32 {
        100.0 * self.painted as f32 / self.feathers.max(1) as f32
    }

    /// Pixels of the body over the pixels of feathers, per cent.
    pub fn bare(&self) -> f32 {
        100.0 * self.bare as f32 / self.feathers.max(1) as f32
    }

    /// Feathers that are shaded at a pixel of feathers.
    pub fn shaded(&self) -> f32 {
        self.shaded as f32 / self.feathers.max(1) as f32
    }

    /// Feathers that pass the depth test at a pixel of feathers ([`Count::runs`]).
    pub fn passing_depth(&self) -> [f32; 2] {
        self.runs
            .map(|count| count as f32 / self.feathers.max(1) as f32)
    }

    /// Adds another count.
    pub fn add(&mut self, other: &Self) {
        self.feathers += other.feathers;
        self.wrong += other.wrong;
        self.color += other.color;
        self.flicker += other.flicker;
        self.passing += other.passing;
        self.borders += other.borders;
        self.painted += other.painted;
        self.shaded += other.shaded;
        for (own, its) in self.runs.iter_mut().zip(other.runs) {
            *own += its;
        }
        self.bare += other.bare;
    }
}

/// The pixels of one pose.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    /// All.
    pub all: Count,
    /// By part of the body.
    pub parts: BTreeMap<&'static str, Count>,
    /// Wrong pixels by the tract that is shown and the tract that should cover it.
    pub tracts: BTreeMap<(u16, u16), usize>,
    /// Those of them that show another color.
    pub colors: BTreeMap<(u16, u16), usize>,
    /// Pixels that flicker by the tracts that are shown before and after.
    pub flickers: BTreeMap<(u16, u16), usize>,
    /// Those of them that are wrong before or after.
    pub unsettled: usize,
    /// Wrong pixels by how far behind the right feather is, in steps of [`STEP`] widths of the narrower.
    pub gaps: [usize; STEPS],
}

/// A groomed bird whose order is measured.
pub struct Measured<'a> {
    /// Bird.
    pub bird: &'a SceneBird,
    /// Its coat.
    pub coat: &'a Coat,
    /// Side of a picture, pixels.
    pub size: usize,
    /// Windows of the order by rank at most, widths of a feather.
    pub window: f32,
    /// Half the side of a picture, metres.
    pub half: f32,
    /// Wind and ruffle.
    pub air: Air,
    uvs: Vec<[f32; 2]>,
    colors: Vec<[f32; 3]>,
}

impl<'a> Measured<'a> {
    /// Measures in pictures of `size` pixels, with a window in widths of a feather.
    pub fn new(bird: &'a SceneBird, coat: &'a Coat, size: usize, window: f32) -> Self {
        let uvs = match coat.mesh.attribute(Mesh::ATTRIBUTE_UV_0) {
            Some(VertexAttributeValues::Float32x2(uvs)) => uvs.clone(),
            _ => Vec::new(),
        };
        let top = bird.bird.skin.positions.iter().map(|p| p.y);
        Self {
            bird,
            coat,
            size,
            window,
            half: 0.45 * top.fold(0.0, f32::max),
            air: Air::default(),
            uvs,
            colors: colors(&bird.groom, coat),
        }
    }

    /// Pose of a time of the clip (none: bind pose).
    pub fn pose(&self, time: Option<f32>) -> PosedCoat {
        let skinning = self.bird.skinning(time);
        let mut vertices = SceneBird::vertices(self.coat, &skinning);
        let carries = SceneBird::carries(self.coat, &skinning);
        let mut windows = SceneBird::windows(self.coat, &skinning);
        if !self.air.is_still() {
            let blown = self.air.blown(&self.bird.groom, time.unwrap_or(0.0));
            let held = SceneBird::held(self.coat, &skinning);
            for (card, place) in self.coat.cards.iter().zip(&self.coat.geometry) {
                let first = place.first_vertex as usize;
                for i in first..first + place.vertex_count as usize {
                    let (along, place) = (self.uvs[i][1], vertices[i]);
                    let (place, angle) = blown.place(card, along, place, carries[i], held[i]);
                    vertices[i] = place;
                    windows[i] = stirred_window(windows[i], angle);
                }
            }
        }
        PosedCoat {
            windows,
            ..self.bird.pose(&vertices, &carries, &skinning)
        }
    }

    /// The views of a pose.
    pub fn views(&self, pose: &PosedCoat) -> Vec<View> {
        let corners = pose.body.iter().flatten();
        let (low, high) = corners.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(a, b), p| {
            (a.min(*p), b.max(*p))
        });
        let view = |eye: &Vec3| {
            let eye = eye.normalize();
            let right = Vec3::Y.cross(eye).xyz().normalize_or(Vec3::X);
            View {
                center: 0.5 * (low + high),
                eye,
                right,
                half: self.half,
                size: self.size,
            }
        };
        EYES.iter().map(view).collect()
    }

    fn posed<'b>(&'b self, pose: &'b PosedCoat) -> Posed<'b> {
        Posed {
            cards: &self.coat.cards,
            colors: &self.colors,
            geometry: &self.coat.geometry,
            positions: &pose.cards,
            uvs: &self.uvs,
            windows: &pose.windows,
            window: self.window,
            body: &pose.body,
        }
    }

    /// Draws and judges one view of a pose.
    pub fn judge(&self, pose: &PosedCoat, view: &View) -> (Layers, Vec<Pixel>) {
        let posed = self.posed(pose);
        let layers = posed.draw(view);
        let pixels = posed.judge(&layers);
        (layers, pixels)
    }

    /// Counts a time of the clip (none: bind pose, without flicker).
    pub fn tally(&self, time: Option<f32>, flicker: bool) -> Tally {
        let pose = self.pose(time);
        let next = time
            .filter(|_| flicker)
            .map(|time| self.pose(Some(time + FRAME)));
        let counted: Vec<Tally> = self
            .views(&pose)
            .par_iter()
            .map(|view| {
                let (layers, pixels) = self.judge(&pose, view);
                let mut tally = Tally::default();
                for (number, pixel) in pixels.iter().enumerate() {
                    let Some(card) = pixel.card() else { continue };
                    let one = Count {
                        feathers: 1,
                        wrong: usize::from(matches!(
                            pixel,
                            Pixel::Wrong(..) | Pixel::WrongColor(..)
                        )),
                        color: usize::from(matches!(pixel, Pixel::WrongColor(..))),
                        shaded: layers.shaded(number),
                        ..Count::default()
                    };
                    tally.all.add(&one);
                    if let Some(missing) = pixel.missing() {
                        let tracts = [card, missing].map(|i| self.coat.cards[i as usize].region);
                        *tally.tracts.entry(tracts.into()).or_default() += 1;
                        if matches!(pixel, Pixel::WrongColor(..)) {
                            *tally.colors.entry(tracts.into()).or_default() += 1;
                        }
                        tally.gaps[self.gap(&layers, number, card, missing)] += 1;
                    }
                    let part = self.bird.part(self.coat.cards[card as usize].region);
                    tally.parts.entry(part).or_default().add(&one);
                }
                let posed = self.posed(&pose);
                tally.all.runs =
                    [false, true].map(|backs_last| posed.runs(&layers, view, backs_last));
                tally.all.bare = layers.bare;
                tally.all.painted = layers.painted_over();
                if let Some(next) = &next {
                    let (its_layers, its) = self.judge(next, view);
                    let changed = layers.flicker(&pixels, &its_layers, &its);
                    tally.all.flicker = changed.len();
                    for number in changed {
                        let shown = [pixels[number], its[number]].map(|pixel| {
                            let card = pixel.card().unwrap_or_default();
                            self.coat.cards[card as usize].region
                        });
                        *tally.flickers.entry(shown.into()).or_default() += 1;
                        if let (Some(a), Some(b)) = (pixels[number].card(), its[number].card()) {
                            let passes = layers.passes(&its_layers, number, a, b);
                            tally.all.passing += usize::from(passes);
                            let borders = layers.moves_in(&its_layers, number, a, b);
                            tally.all.borders += usize::from(borders && !passes);
                        }
                        let wrong = pixels[number].missing().or(its[number].missing());
                        tally.unsettled += usize::from(wrong.is_some());
                    }
                }
                tally
            })
            .collect();
        let mut sum = Tally::default();
        counted.iter().for_each(|tally| sum.add(tally));
        sum
    }

    /// Step of how far one feather of a pixel lies behind another.
    fn gap(&self, layers: &Layers, pixel: usize, shown: u32, missing: u32) -> usize {
        let near = |card: u32| {
            let found = layers.at(pixel).iter().find(|f| f.card == card);
            found.map_or(0.0, |fragment| fragment.near)
        };
        let [a, b] = [shown, missing].map(|card| self.coat.cards[card as usize].width);
        let behind = (near(shown) - near(missing)) / a.min(b).max(f32::MIN_POSITIVE);
        ((behind / STEP).max(0.0) as usize).min(STEPS - 1)
    }

    /// Pairs of neighbors that poke through each other in a pose: those rooted, in bind pose, within a length and a width of each
    /// other that face the same way.
    pub fn pairs(&self, time: Option<f32>) -> Overlaps {
        let cards = &self.coat.cards;
        let pose = self.pose(time);
        let mut found = overlaps(cards, &self.coat.geometry, &pose.cards, &self.uvs);
        found.list.retain(|pair| {
            let [a, b] = [pair.upper, pair.lower].map(|i| &cards[i as usize]);
            let reach = a.length.max(b.length) + a.width.max(b.width);
            a.root.distance(b.root) < reach && a.normal.dot(b.normal) > 0.0
        });
        found
    }

    /// Times of `count` phases of the clip, a tenth into equal parts: none is a key pose.
    pub fn phases(&self, count: usize) -> Vec<f32> {
        let step = self.bird.duration / count.max(1) as f32;
        (0..count).map(|i| step * (i as f32 + 0.1)).collect()
    }
}

impl Tally {
    /// Adds another tally.
    pub fn add(&mut self, other: &Self) {
        self.all.add(&other.all);
        for (part, count) in &other.parts {
            self.parts.entry(part).or_default().add(count);
        }
        for (tracts, count) in &other.tracts {
            *self.tracts.entry(*tracts).or_default() += count;
        }
        for (tracts, count) in &other.colors {
            *self.colors.entry(*tracts).or_default() += count;
        }
        for (tracts, count) in &other.flickers {
            *self.flickers.entry(*tracts).or_default() += count;
        }
        self.unsettled += other.unsettled;
        for (own, its) in self.gaps.iter_mut().zip(other.gaps) {
            *own += its;
        }
    }
}

/// Mean linear color of the outer half of each card's front, which is what others leave to be seen, in the groom's colors.
fn colors(groom: &Groom, coat: &Coat) -> Vec<[f32; 3]> {
    let [across, along] = TEXELS;
    let means: Vec<[f32; 4]> = groom
        .feathers
        .iter()
        .map(|link| {
            let file = link.path().rsplit('/').next().unwrap_or_default();
            let feather = crate::shipped::feather(file.trim_end_matches(".feather.ron"));
            let texels = feather.albedo.front.bake(across, along, &feather);
            let outer = texels.as_chunks::<4>().0[across * along / 2..].iter();
            let count = outer.len() as f32;
            outer.fold([0.0; 4], |mut sum, [r, g, b, tint]| {
                let tint = f32::from(*tint) / 255.0;
                let paint = LinearRgba::from(Srgba::rgb_u8(*r, *g, *b)).to_f32_array_no_alpha();
                for (total, paint) in sum.iter_mut().zip(paint) {
                    *total += (1.0 - tint) * paint / count;
                }
                sum[3] += tint / count;
                sum
            })
        })
        .collect();
    let shown = |card: &Card| {
        let [r, g, b, tint] = means[card.feather as usize % means.len()];
        let [x, y, z] = card.tint.map(|part| tint * part);
        [r + x, g + y, b + z]
    };
    coat.cards.iter().map(shown).collect()
}
