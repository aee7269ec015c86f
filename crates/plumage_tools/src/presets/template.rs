//! From a few shape and microstructure figures to a [`Feather`].

use bevy_plumage::anatomy::{
    Albedo, Barbules, ColorShare, Contour, Feather, Gaps, Pattern, Rachis, Rim, Spline, Stop, Vane,
};
use bevy_plumage::maths::scattering::{Fibre, FibreKind, Optics, Sheen};

/// Share of the measured down that a body feather keeps. Cards lie less regularly than follicles do, so that more of each base
/// shows than on a bird, and pale bases would speckle the coat.
pub(super) const DOWN_SHOWN: f32 = 0.5;

/// Half width of one vane along the feather: control points (height, share of the half width) joined by straight lines with
/// rounded knees, closed above `tip` by `(1 - h^p)^(1/q)`, h from 0 at `tip` to 1 at the end.
#[derive(Clone, Copy)]
pub(super) struct Profile {
    pub points: &'static [(f32, f32)],
    pub tip: f32,
    pub power: (f32, f32),
}

impl Profile {
    pub const fn new(points: &'static [(f32, f32)], tip: f32, power: (f32, f32)) -> Self {
        Self { points, tip, power }
    }

    pub(super) fn at(&self, y: f32) -> f32 {
        // A box filter over a small window rounds the knees.
        let width = (-4..=4)
            .map(|i| self.line(y + i as f32 * 0.008))
            .sum::<f32>()
            / 9.0;
        let h = ((y - self.tip) / (1.0 - self.tip).max(1e-3)).clamp(0.0, 1.0);
        width
            * (1.0 - h.powf(self.power.0))
                .max(0.0)
                .powf(1.0 / self.power.1)
    }

    fn line(&self, y: f32) -> f32 {
        let mut last = self.points[0];
        for &point in self.points {
            if y < point.0 {
                let t = ((y - last.0) / (point.0 - last.0).max(1e-6)).clamp(0.0, 1.0);
                // Eased, so that a covert swells and an emargination steps.
                let t = t * t * (3.0 - 2.0 * t);
                return last.1 + (point.1 - last.1) * t;
            }
            last = point;
        }
        last.1
    }
}

/// Microstructure of one row of the table: leading (left) and trailing (right) where two values stand.
#[derive(Clone, Copy)]
pub(super) struct Micro {
    /// Barb spacing along the rachis, mm.
    pub pitch: [f32; 2],
    /// Barb to rachis, degrees.
    pub angle: [f32; 2],
    /// Width of a barb's ramus, micrometres.
    pub ramus: f32,
    /// Distal and proximal barbule spacing along the barb, micrometres.
    pub spacing: [f32; 2],
    /// Distal and proximal barbule angle, degrees.
    pub barbule_angle: [f32; 2],
    /// Share of a vane that distal and proximal barbules cover, head on: their width over their period.
    pub cover: [f32; 2],
    /// Rachis diameter at base, middle, tip, mm.
    pub shaft: [f32; 3],
    /// Share of the length that is down.
    pub downy: f32,
}

/// Of a closed vane. The lamella of a barbule's base, 18 to 25 micrometres high and 8 to 12 thick, stands obliquely, as a slat does: it covers
/// most of its height, and a distal barbule hooks over several proximal ones.
pub(super) const HOOKED: [f32; 2] = [0.745, 0.79];
/// Of soft, half open vanes.
pub(super) const SOFT: [f32; 2] = [0.55, 0.55];
/// Of down: threads.
pub(super) const THREAD: [f32; 2] = [0.203, 0.203];

/// One preset.
#[derive(Clone)]
pub(super) struct Template {
    pub name: &'static str,
    pub length_mm: f32,
    /// Full width, mm.
    pub width_mm: f32,
    /// Share of the width left of the rachis.
    pub left_share: f32,
    /// How far the tip lies to the right of the base's direction, in lengths.
    pub bend: f32,
    /// Height of the lowest barb.
    pub start: f32,
    pub left: Profile,
    pub right: Profile,
    pub micro: Micro,
    pub fringe: f32,
    pub gaps: Gaps,
    pub albedo: Albedo,
    pub structural: bool,
    /// Loose barbs lie in all directions: no broad highlight pales the coat.
    pub matte: bool,
}

/// Values a side of a preset's contour.
const SAMPLES: usize = 80;

/// Five decimals are a micrometre on a feather of 100 mm, and keep the files short.
fn short(x: f32) -> f32 {
    (f64::from(x) * 1e5).round() as f32 / 1e5
}

fn short_all(values: impl IntoIterator<Item = f32>) -> Vec<f32> {
    values.into_iter().map(short).collect()
}

impl Template {
    pub fn build(&self) -> Feather {
        let micro = &self.micro;
        let half = |share: f32| share * self.width_mm / self.length_mm;
        let (left_half, right_half) = (half(self.left_share), half(1.0 - self.left_share));
        let steps = 400;
        let height = |i: usize| i as f32 / steps as f32;
        let mut outline: Vec<[f32; 2]> = (0..=steps)
            .map(|i| [-left_half * self.left.at(height(i)), height(i)])
            .collect();
        outline.extend(
            (0..=steps)
                .rev()
                .map(|i| [right_half * self.right.at(height(i)), height(i)]),
        );
        let mut contour = Contour::from_polyline(&outline, micro.angle, self.start, SAMPLES);
        contour.left = short_all(contour.left);
        contour.right = short_all(contour.right);

        // The card just holds the bent outline: find its extent, then put the rachis where it fits.
        let bends: Vec<f32> = (0..9)
            .map(|i| self.bend * (i as f32 / 8.0).powf(1.9))
            .collect();
        let shaft = Spline::new(&bends);
        let radius = micro.shaft[0] / 2.0 / self.length_mm;
        let (mut low, mut high) = (-radius, radius);
        for [x, y] in contour.polyline(micro.angle) {
            let x = x + shaft.at(f64::from(y)).0 as f32;
            (low, high) = (low.min(x), high.max(x));
        }
        let margin = 0.02 * (high - low);
        let aspect = short((high - low + 2.0 * margin).clamp(0.01, 2.0));
        let curve = short_all(bends.iter().map(|bend| (bend + margin - low) / aspect));

        let spacing = (micro.spacing[0] + micro.spacing[1]) / 2.0;
        let angle = (micro.barbule_angle[0] + micro.barbule_angle[1]) / 2.0;
        let period = spacing * angle.to_radians().sin();
        let [distal, proximal] = micro
            .cover
            .map(|share| (50.0 * share * period).round() / 100.0);

        let vane = |i: usize| Vane {
            barb_count: (self.length_mm / micro.pitch[i]).round().clamp(4.0, 5000.0),
            barb_angle: micro.angle[i],
            barb_radius_um: micro.ramus / 2.0,
            barbules: Barbules {
                spacing_um: spacing,
                angle,
                distal_radius_um: distal,
                proximal_radius_um: proximal,
            },
            fringe: self.fringe,
            downy: if micro.downy > 0.9 {
                micro.downy
            } else {
                micro.downy * DOWN_SHOWN
            },
        };
        let mut feather = Feather::default();
        feather.name = self.name.to_owned();
        feather.length_mm = self.length_mm;
        feather.aspect = aspect;
        feather.contour = contour;
        feather.rachis = Rachis {
            curve,
            radius_mm: micro.shaft.map(|diameter| short(diameter / 2.0)),
        };
        feather.left = vane(0);
        feather.right = vane(1);
        feather.gaps = self.gaps;
        feather.albedo = Albedo {
            share: color_share(self.structural),
            ..self.albedo.clone()
        };
        feather.optics = optics(self.structural, micro.downy);
        if self.matte {
            feather.optics = matte(feather.optics);
        }
        feather
    }
}

/// Rami carry more color than barbules: most so where a spongy layer makes it (the barbules of blue feathers are near black),
/// less where a pigment is in both.
fn color_share(structural: bool) -> ColorShare {
    let (rachis, barb, barbule) = if structural {
        (0.6, 1.35, 0.8)
    } else {
        (0.8, 1.45, 0.7)
    };
    ColorShare {
        rachis,
        barb,
        barbule,
    }
}

/// Structural blue sits in barbs and barbules; the shaft is always pigment. Down scatters more and shines more at the rim.
fn optics(structural: bool, downy: f32) -> Optics {
    let plain = Fibre::default();
    let fibre = if structural {
        Fibre {
            kind: FibreKind::Structural { core_radius: 0.7 },
            ..plain
        }
    } else {
        plain
    };
    // Barbules bend and twist along their length, 20 degrees and more: over a pixel that widens every lobe along the fibre. Straight
    // ones would draw the highlight of a whole bird as one glossy ring.
    let barbule = Fibre {
        longitudinal_roughness: 0.35,
        ..fibre
    };
    let sheen = if downy > 0.9 {
        Sheen {
            strength: 0.5,
            roughness: 0.7,
        }
    } else {
        // Closed vanes shine less at the rim than the model's default: saturated colors would pale.
        Sheen {
            strength: 0.2,
            ..Sheen::default()
        }
    };
    Optics {
        rachis: plain,
        barb: fibre,
        distal: barbule,
        proximal: barbule,
        sheen,
    }
}

/// The same of barbs and barbules that do not lie parallel.
fn matte(optics: Optics) -> Optics {
    let rough = |fibre| Fibre {
        longitudinal_roughness: 0.6,
        ..fibre
    };
    Optics {
        barb: rough(optics.barb),
        distal: rough(optics.distal),
        proximal: rough(optics.proximal),
        sheen: Sheen {
            strength: 0.05,
            ..optics.sheen
        },
        ..optics
    }
}

/// sRGB color of a hexadecimal triple, three decimals.
pub(super) fn hex(rgb: u32) -> [f32; 3] {
    [16, 8, 0].map(|shift| (((rgb >> shift) & 255) as f32 / 255.0 * 1000.0).round() / 1000.0)
}

/// Splits: how many, half width in lengths, depth as a share of the barb.
pub(super) const fn gaps(count: u32, width: f32, depth: f32, seed: u32) -> Gaps {
    Gaps {
        count,
        width,
        depth,
        seed,
    }
}

/// Color stops.
pub(super) fn stops(stops: &[(f32, u32, f32)]) -> Pattern {
    Pattern {
        stops: stops
            .iter()
            .map(|&(v, rgb, tint)| Stop {
                v,
                color: hex(rgb),
                tint,
            })
            .collect(),
        ..Pattern::default()
    }
}

/// A body feather: down of one color, a transition, then `color`, which the groom replaces.
pub(super) fn body(downy: f32, down: u32, transition: u32, color: u32) -> Pattern {
    let downy = downy * DOWN_SHOWN;
    let height = |offset: f32| ((downy + offset) * 1000.0).round().clamp(0.0, 1000.0) / 1000.0;
    Pattern {
        mottle: 0.12,
        ..stops(&[
            (0.0, down, 0.0),
            (height(-0.14), down, 0.0),
            (height(-0.03), transition, 0.0),
            (height(0.08), color, 1.0),
            (1.0, color, 1.0),
        ])
    }
}

/// One pattern for both faces.
pub(super) fn both(front: Pattern) -> Albedo {
    Albedo {
        front,
        back: None,
        image: None,
        share: ColorShare::default(),
    }
}

/// One pattern for both faces with a rim of `width` half widths that runs out over `softness` of it.
pub(super) fn rimmed(pattern: Pattern, width: f32, softness: f32, rgb: u32) -> Albedo {
    both(Pattern {
        rim: Some(Rim {
            width,
            softness,
            color: hex(rgb),
            tint: 0.15,
        }),
        ..pattern
    })
}

/// Two faces.
pub(super) fn faces(front: Pattern, back: Pattern) -> Albedo {
    Albedo {
        front,
        back: Some(back),
        image: None,
        share: ColorShare::default(),
    }
}
