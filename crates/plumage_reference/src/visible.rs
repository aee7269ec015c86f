//! What of a coat's order can be seen: pixels that show a feather which another one should cover.
//!
//! Pairs that poke through each other ([`crate::crossing`]) count what lies buried under other feathers. Here the posed cards are
//! drawn from one side, every feather at a pixel is kept, and the pixel is wrong if a feather lies behind the one shown that should
//! cover it. Feathers are rounded blades ([`crate::crossing::blade`]), the view is orthographic, and what lies behind the body
//! does not count.

use crate::crossing::blade;
use bevy::math::{Vec2, Vec3};
use bevy_plumage::{
    groom::{Card, CardGeometry},
    maths::order::order_reach,
};

/// Faces whose normals enclose more than this (cosine; 72 degrees) do not cover each other.
const FACING: f32 = 0.31;
/// Feathers further apart than this share of the narrower one's width do not cover each other.
const REACH: f32 = 0.5;
/// Distance of the mean colors of two feathers, in CIE Lab, from which a pixel counts as being of the wrong color.
const COLOR: f32 = 8.0;
/// Shares of the length by which two fragments of one feather are different parts of it.
const PART: f32 = 0.1;

/// An orthographic view.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// Middle of the picture.
    pub center: Vec3,
    /// Unit direction towards the eye.
    pub eye: Vec3,
    /// Unit direction to the right in the picture, at a right angle to `eye`.
    pub right: Vec3,
    /// Half the side of the square picture, metres.
    pub half: f32,
    /// Its side, pixels.
    pub size: usize,
}

/// A coat in one pose.
#[derive(Clone, Copy)]
pub struct Posed<'a> {
    /// Records; the one with the higher layer lies over the other.
    pub cards: &'a [Card],
    /// Mean colors of their faces, linear.
    pub colors: &'a [[f32; 3]],
    /// Where their vertices are.
    pub geometry: &'a [CardGeometry],
    /// Vertices as posed.
    pub positions: &'a [Vec3],
    /// `UV_0` of the card mesh.
    pub uvs: &'a [[f32; 2]],
    /// How far behind the nearest each vertex is seen, widths of its card, where it faces the eye.
    pub windows: &'a [f32],
    /// The same at most, as the renderer's `FeatherSettings::order_window`; 0: the nearest is shown.
    pub window: f32,
    /// Triangles of the body as posed.
    pub body: &'a [[Vec3; 3]],
}

/// One feather at one pixel.
#[derive(Clone, Copy, Debug)]
pub struct Fragment {
    /// Card.
    pub card: u32,
    /// Distance towards the eye from the plane through the middle, metres.
    pub near: f32,
    /// Normal of the front face times the direction to the eye: negative from behind.
    pub facing: f32,
    /// Place along the feather, 0 to 1.
    pub along: f32,
    /// How far behind the nearest it is seen, metres.
    pub reach: f32,
}

/// Every feather at every pixel of a view, nearest first; what the body hides is not there.
pub struct Layers {
    starts: Vec<u32>,
    list: Vec<Fragment>,
    /// Pixels where the body is seen and a feather lies not far behind it: pixel, depth behind the body, and the feather.
    behind: Vec<(u32, f32, Fragment)>,
    /// Pixels where the body is seen.
    pub bare: usize,
}

/// What a pixel shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pixel {
    /// No feather.
    Empty,
    /// The feather that belongs there.
    Right(u32),
    /// A feather that another one, the second, of nearly the same color should cover.
    Wrong(u32, u32),
    /// A feather that another one, the second, of another color should cover.
    WrongColor(u32, u32),
}

impl Pixel {
    /// The feather shown.
    pub fn card(self) -> Option<u32> {
        match self {
            Self::Empty => None,
            Self::Right(card) | Self::Wrong(card, _) | Self::WrongColor(card, _) => Some(card),
        }
    }

    /// The feather that should cover the one shown.
    pub fn missing(self) -> Option<u32> {
        match self {
            Self::Empty | Self::Right(_) => None,
            Self::Wrong(_, card) | Self::WrongColor(_, card) => Some(card),
        }
    }
}

/// A posed root and the normal in the middle of a card.
struct Stand {
    root: Vec3,
    normal: Vec3,
}

/// Visits the pixels of a triangle: number of the pixel, height towards the eye, and the shares of its corners.
fn cover(view: &View, corners: [Vec3; 3], mut visit: impl FnMut(usize, f32, [f32; 3])) {
    let up = view.eye.cross(view.right);
    let scale = 0.5 * view.size as f32 / view.half;
    let project = |p: Vec3| {
        let d = p - view.center;
        Vec3::new(
            0.5 * view.size as f32 + d.dot(view.right) * scale,
            0.5 * view.size as f32 - d.dot(up) * scale,
            d.dot(view.eye),
        )
    };
    let [a, b, c] = corners.map(project);
    let area = (b - a).truncate().perp_dot((c - a).truncate());
    if area.abs() < 1.0e-9 || !area.is_finite() {
        return;
    }
    let last = Vec2::splat(view.size as f32 - 1.0);
    let low = a.min(b).min(c).truncate().max(Vec2::ZERO).ceil();
    let high = a.max(b).max(c).truncate().min(last).floor();
    for y in low.y as i64..=high.y as i64 {
        for x in low.x as i64..=high.x as i64 {
            let p = Vec2::new(x as f32, y as f32);
            let u = (b.truncate() - p).perp_dot(c.truncate() - p) / area;
            let v = (c.truncate() - p).perp_dot(a.truncate() - p) / area;
            let w = 1.0 - u - v;
            if u >= 0.0 && v >= 0.0 && w >= 0.0 {
                let near = a.z * u + b.z * v + c.z * w;
                visit(y as usize * view.size + x as usize, near, [u, v, w]);
            }
        }
    }
}

/// Vertices across a card.
fn columns(uvs: &[[f32; 2]]) -> usize {
    uvs.iter().take_while(|uv| uv[1] == 0.0).count()
}

impl Posed<'_> {
    fn vertices(&self, card: usize) -> Option<(&[Vec3], &[[f32; 2]])> {
        let place = self.geometry.get(card)?;
        let range = place.first_vertex as usize..(place.first_vertex + place.vertex_count) as usize;
        Some((self.positions.get(range.clone())?, self.uvs.get(range)?))
    }

    /// Draws the coat.
    pub fn draw(&self, view: &View) -> Layers {
        let count = view.size * view.size;
        let mut wall = vec![f32::NEG_INFINITY; count];
        for corners in self.body {
            cover(view, *corners, |pixel, near, _| {
                wall[pixel] = wall[pixel].max(near);
            });
        }
        let mut found: Vec<(u32, Fragment)> = Vec::new();
        let mut behind: Vec<(u32, f32, Fragment)> = Vec::new();
        for card in 0..self.cards.len() {
            let Some((points, uvs)) = self.vertices(card) else {
                continue;
            };
            let first = self.geometry[card].first_vertex as usize;
            let width = self.cards[card].width;
            let wide = columns(uvs);
            if wide < 2 {
                continue;
            }
            for i in 0..points.len() / wide - 1 {
                for j in 0..wide - 1 {
                    let at = i * wide + j;
                    for corners in [[at, at + 1, at + wide + 1], [at, at + wide + 1, at + wide]] {
                        let [a, b, c] = corners.map(|k| points[k]);
                        let normal = (b - a).cross(c - a).normalize_or_zero();
                        let facing = normal.dot(view.eye);
                        // As the renderer has it at the vertices.
                        let reaches = corners.map(|k| {
                            let window = self
                                .windows
                                .get(first + k)
                                .map_or(0.0, |own| own.min(self.window));
                            order_reach(window * width, facing, uvs[k][1])
                        });
                        cover(view, [a, b, c], |pixel, near, shares| {
                            let uv: Vec2 = corners
                                .iter()
                                .zip(shares)
                                .map(|(k, share)| Vec2::from_array(uvs[*k]) * share)
                                .sum();
                            if (2.0 * uv.x - 1.0).abs() > blade(uv.y) {
                                return;
                            }
                            let fragment = Fragment {
                                card: card as u32,
                                near,
                                facing,
                                along: uv.y,
                                reach: reaches
                                    .iter()
                                    .zip(shares)
                                    .map(|(own, share)| own * share)
                                    .sum(),
                            };
                            let depth = wall[pixel] - near;
                            if depth < 0.0 {
                                found.push((pixel as u32, fragment));
                            } else if depth < REACH * width {
                                behind.push((pixel as u32, depth, fragment));
                            }
                        });
                    }
                }
            }
        }
        found.sort_unstable_by(|a, b| {
            a.0.cmp(&b.0)
                .then(b.1.near.total_cmp(&a.1.near))
                .then(a.1.card.cmp(&b.1.card))
        });
        let mut starts = vec![0_u32; count + 1];
        found
            .iter()
            .for_each(|(pixel, _)| starts[*pixel as usize + 1] += 1);
        for i in 0..count {
            starts[i + 1] += starts[i];
        }
        behind.retain(|(pixel, ..)| starts[*pixel as usize] == starts[*pixel as usize + 1]);
        let empty = |pixel: &usize| starts[*pixel] == starts[*pixel + 1];
        let bare = (0..count).filter(|pixel| wall[*pixel].is_finite() && empty(pixel));
        Layers {
            bare: bare.count(),
            behind,
            starts,
            list: found.into_iter().map(|(_, fragment)| fragment).collect(),
        }
    }

    fn stands(&self) -> Vec<Stand> {
        (0..self.cards.len())
            .map(|card| {
                let Some((points, uvs)) = self.vertices(card) else {
                    return Stand {
                        root: Vec3::ZERO,
                        normal: Vec3::ZERO,
                    };
                };
                let wide = columns(uvs).max(1);
                let rows = points.len() / wide;
                let at = |i: usize, j: usize| points[i.min(rows - 1) * wide + j];
                let middle = rows / 2;
                let across = at(middle, wide - 1) - at(middle, 0);
                let along = at(middle + 1, wide / 2) - at(middle.saturating_sub(1), wide / 2);
                Stand {
                    root: 0.5 * (at(0, 0) + at(0, wide - 1)),
                    normal: across.cross(along).normalize_or_zero(),
                }
            })
            .collect()
    }

    /// Feathers that pass a depth test at the pixels of a view, where what was drawn before is in front of the rest; drawn from the highest
    /// layer to the lowest or, with `backs_last`, cards that turn their backs to the eye after all others, the other way round.
    pub fn runs(&self, layers: &Layers, view: &View, backs_last: bool) -> usize {
        let stands = self.stands();
        let turns = |card: usize| backs_last && stands[card].normal.dot(view.eye) < 0.0;
        let turned: Vec<bool> = (0..self.cards.len()).map(turns).collect();
        let place = |fragment: &&Fragment| {
            let card = fragment.card as usize;
            let layer = self.cards[card].layer;
            (turned[card], if turned[card] { layer } else { -layer })
        };
        (0..layers.starts.len() - 1)
            .map(|pixel| {
                let mut list: Vec<&Fragment> = layers.at(pixel).iter().collect();
                list.sort_by(|a, b| {
                    let ((back, layer), (its_back, its_layer)) = (place(a), place(b));
                    back.cmp(&its_back).then(layer.total_cmp(&its_layer))
                });
                let mut nearest = f32::NEG_INFINITY;
                list.retain(|fragment| {
                    let passes = fragment.near >= nearest;
                    nearest = nearest.max(fragment.near);
                    passes
                });
                list.len()
            })
            .sum()
    }

    /// Judges every pixel.
    pub fn judge(&self, layers: &Layers) -> Vec<Pixel> {
        let stands = self.stands();
        let colors: Vec<Vec3> = self.colors.iter().copied().map(lab).collect();
        (0..layers.starts.len() - 1)
            .map(|pixel| {
                let list = layers.at(pixel);
                let Some(shown) = windowed(list, self.cards) else {
                    return Pixel::Empty;
                };
                let covers = |other: &&Fragment| {
                    let (a, b) = (shown.card as usize, other.card as usize);
                    let (own, its) = (&self.cards[a], &self.cards[b]);
                    let over = if shown.facing >= 0.0 {
                        its.layer > own.layer
                    } else {
                        its.layer < own.layer
                    };
                    let reach = own.length.max(its.length) + own.width.max(its.width);
                    a != b
                        && over
                        && other.near <= shown.near
                        && other.facing.signum() == shown.facing.signum()
                        && shown.near - other.near < REACH * own.width.min(its.width)
                        && stands[a].normal.dot(stands[b].normal) > FACING
                        && stands[a].root.distance(stands[b].root) < reach
                };
                let card = shown.card;
                match list.iter().find(covers) {
                    None => Pixel::Right(card),
                    Some(right) => {
                        let away = colors[card as usize].distance(colors[right.card as usize]);
                        if away > COLOR {
                            Pixel::WrongColor(card, right.card)
                        } else {
                            Pixel::Wrong(card, right.card)
                        }
                    }
                }
            })
            .collect()
    }
}

impl Layers {
    /// Feathers at a pixel, nearest first.
    pub fn at(&self, pixel: usize) -> &[Fragment] {
        let range = self.starts[pixel] as usize..self.starts[pixel + 1] as usize;
        &self.list[range]
    }

    /// Pixels of skin, bill and legs that windows paint over with a feather from behind them.
    pub fn painted_over(&self) -> usize {
        let comes = |(_, depth, fragment): &&(u32, f32, Fragment)| fragment.reach > *depth;
        let mut pixels: Vec<u32> = self
            .behind
            .iter()
            .filter(comes)
            .map(|(pixel, ..)| *pixel)
            .collect();
        pixels.sort_unstable();
        pixels.dedup();
        pixels.len()
    }

    /// Feathers of a pixel that are shaded: those no further behind the nearest than their windows allow.
    pub fn shaded(&self, pixel: usize) -> usize {
        let list = self.at(pixel);
        let comes = |fragment: &&Fragment| fragment.near + fragment.reach >= list[0].near;
        list.iter().filter(comes).count()
    }

    fn has(&self, pixel: usize, card: u32) -> bool {
        self.at(pixel).iter().any(|fragment| fragment.card == card)
    }

    /// Whether of two feathers of a pixel, here and in the next picture, one shows its front and the other its back in either, and each is
    /// shown where it is the nearer: sheets without an order, one of which moves in front of the other.
    pub fn passes(&self, next: &Self, pixel: usize, own: u32, its: u32) -> bool {
        let find = |layers: &Self, card: u32| {
            let found = layers.at(pixel).iter().find(|f| f.card == card);
            found.copied()
        };
        let pairs = [
            (find(self, own), find(self, its)),
            (find(next, its), find(next, own)),
        ];
        pairs.into_iter().all(|pair| match pair {
            (Some(shown), Some(other)) => {
                shown.near >= other.near && (shown.facing >= 0.0) != (other.facing >= 0.0)
            }
            _ => false,
        })
    }

    /// Whether a part of a feather that one picture shows is not at the pixel in the other, where the same feather lies further behind
    /// with another part: a border moves over the pixel, as of any two feathers of which one ends there.
    pub fn moves_in(&self, next: &Self, pixel: usize, own: u32, its: u32) -> bool {
        let part = |layers: &Self, card: u32| {
            let found = layers.at(pixel).iter().find(|f| f.card == card);
            found.map_or(f32::NAN, |fragment| fragment.along)
        };
        let stays = |card: u32| (part(self, card) - part(next, card)).abs() < PART;
        !(stays(own) && stays(its))
    }

    /// Pixels whose feather changes from one picture to the next although both feathers are there in both.
    pub fn flicker(&self, own: &[Pixel], next: &Self, its: &[Pixel]) -> Vec<usize> {
        let changes = |pixel: &usize| match (own[*pixel].card(), its[*pixel].card()) {
            (Some(a), Some(b)) => a != b && self.has(*pixel, b) && next.has(*pixel, a),
            _ => false,
        };
        (0..own.len().min(its.len())).filter(changes).collect()
    }
}

/// The fragment that is shown: of those no further behind the nearest than their windows allow, the one of the highest layer, as the
/// renderer decides it behind a depth prepass.
fn windowed(list: &[Fragment], cards: &[Card]) -> Option<Fragment> {
    let first = list.first()?;
    let mut best = *first;
    for fragment in &list[1..] {
        let higher = cards[fragment.card as usize].layer > cards[best.card as usize].layer;
        if higher && fragment.reach > 0.0 && fragment.near + fragment.reach >= first.near {
            best = *fragment;
        }
    }
    Some(best)
}

/// CIE Lab of linear sRGB, white D65.
fn lab(color: [f32; 3]) -> Vec3 {
    let [r, g, b] = color;
    let xyz = [
        (0.412_4 * r + 0.357_6 * g + 0.180_5 * b) / 0.950_5,
        0.212_6 * r + 0.715_2 * g + 0.072_2 * b,
        (0.019_3 * r + 0.119_2 * g + 0.950_5 * b) / 1.089,
    ];
    let [x, y, z] = xyz.map(|t| {
        if t > 0.008_856 {
            t.cbrt()
        } else {
            7.787 * t + 16.0 / 116.0
        }
    });
    Vec3::new(116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One pixel with fragments of feathers: card, height, and place along the feather.
    fn layers(list: &[(u32, f32, f32)]) -> Layers {
        let fragment = |&(card, near, along): &(u32, f32, f32)| Fragment {
            card,
            near,
            facing: 1.0,
            along,
            reach: 0.0,
        };
        Layers {
            starts: vec![0, list.len() as u32],
            list: list.iter().map(fragment).collect(),
            behind: Vec::new(),
            bare: 0,
        }
    }

    #[test]
    fn a_border_moves_in_where_another_part_of_the_feather_was() {
        let before = layers(&[(0, 0.2, 0.5), (1, 0.1, 0.4)]);
        // The tip of the second comes over the first.
        let border = layers(&[(1, 0.3, 0.95), (0, 0.2, 0.5), (1, 0.1, 0.4)]);
        assert!(before.moves_in(&border, 0, 0, 1));
        assert!(border.moves_in(&before, 0, 1, 0));
        // The same parts change their order: that is a fault.
        let crossed = layers(&[(1, 0.3, 0.41), (0, 0.2, 0.5)]);
        assert!(!before.moves_in(&crossed, 0, 0, 1));
        for after in [&border, &crossed] {
            let (own, its) = ([Pixel::Right(0)], [Pixel::Right(1)]);
            assert_eq!(
                before.flicker(&own, after, &its),
                [0],
                "both count as flicker"
            );
        }
    }
}
