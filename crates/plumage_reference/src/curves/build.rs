//! Enumeration: where every fibre of a feather begins and ends.

use bevy_plumage::anatomy::{CONTOUR_ROWS, Feather, Side, Spline};
use bevy_plumage::maths::card;

/// One barb, a straight cylinder in canonical space of its side (the right vane mirrored to `x < 0`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Barb {
    /// Distance of its axis from the origin along the barb normal, feather lengths.
    pub across: f64,
    /// Where the axis begins, measured along the barb direction: on the rachis.
    pub begin: f64,
    /// Where it ends: on the outline.
    pub end: f64,
}

/// One barbule, measured along its own axis from the axis of its barb.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Barbule {
    /// Place of its root on the axis of its barb, along the barb direction, feather lengths.
    pub root: f64,
    /// Where it begins, feather lengths: on its barb, or where it enters the outline.
    pub begin: f32,
    /// Where it ends: on the next barb, or where it leaves the outline.
    pub end: f32,
    /// Share of the family's radius that shows, 0..1: loose barbules stand on edge.
    pub width: f32,
}

/// What the fibres of one vane have in common.
#[derive(Clone, Debug)]
pub(crate) struct VaneCurves {
    pub sin_b: f64,
    pub cos_b: f64,
    pub sin_bl: f64,
    pub cos_bl: f64,
    /// Distance between neighboring barbs along their normal.
    pub period: f64,
    /// Semi-axes (in the card, along the normal) of barb, distal, proximal barbule.
    pub radius: [[f64; 2]; 3],
    pub barbs: Vec<Barb>,
    /// Index of the first barb in units of the period.
    pub first: i64,
    /// Per gap above barb k: barbules of barb k (distal) and of barb k + 1 (proximal), roots rising.
    pub gaps: Vec<[Vec<Barbule>; 2]>,
}

/// Every fibre of one feather.
#[derive(Clone, Debug)]
pub struct Curves {
    pub(crate) vanes: [VaneCurves; 2],
    pub(crate) spline: Spline,
    pub(crate) aspect: f64,
    /// r_r at base, middle, tip in feather lengths.
    rachis: [f64; 3],
    /// Minor over major axis of the shaft.
    pub(crate) rachis_flatness: f64,
}

/// The outline of one vane, barb-rooted rows joined by straight lines.
struct Outline {
    rows: Vec<f64>,
    start: f64,
    cot: f64,
}

impl Outline {
    fn new(feather: &Feather, side: Side) -> Self {
        let table = feather.shape_table();
        let column = usize::from(side == Side::Right);
        Self {
            rows: table
                .contour
                .iter()
                .map(|row| f64::from(row[column]))
                .collect(),
            start: f64::from(table.start),
            cot: 1.0 / f64::from(feather.vane(side).alpha_b()).tan().max(1e-3),
        }
    }

    fn reach(&self, root: f64) -> f64 {
        let place = (root - self.start) / (1.0 - self.start) * (CONTOUR_ROWS - 1) as f64;
        if !(0.0..=(CONTOUR_ROWS - 1) as f64).contains(&place) {
            return 0.0;
        }
        let i = (place as usize).min(CONTOUR_ROWS - 2);
        self.rows[i] + (self.rows[i + 1] - self.rows[i]) * (place - i as f64)
    }

    /// Is a point at distance `x` from the rachis and height `y` on the vane?
    fn contains(&self, x: f64, y: f64) -> bool {
        x >= 0.0 && x <= self.reach(y - x * self.cot)
    }

    /// The first stretch of `begin..end` on which `at` lies on the vane, to a millionth of the stretch.
    fn clip(&self, begin: f64, end: f64, at: impl Fn(f64) -> [f64; 2]) -> Option<[f64; 2]> {
        const STEPS: usize = 8;
        let place = |i: usize| begin + (end - begin) * i as f64 / STEPS as f64;
        let inside = |t: f64| {
            let [x, y] = at(t);
            self.contains(x, y)
        };
        let first = (0..=STEPS).find(|&i| inside(place(i)))?;
        let last = (first..=STEPS).take_while(|&i| inside(place(i))).last()?;
        let edge = |mut within: f64, mut without: f64| {
            for _ in 0..20 {
                let middle = 0.5 * (within + without);
                if inside(middle) {
                    within = middle
                } else {
                    without = middle
                }
            }
            within
        };
        let low = if first == 0 {
            begin
        } else {
            edge(place(first), place(first - 1))
        };
        let high = if last == STEPS {
            end
        } else {
            edge(place(last), place(last + 1))
        };
        (high > low).then_some([low, high])
    }
}

impl VaneCurves {
    fn new(feather: &Feather, side: Side) -> Self {
        let vane = feather.vane(side);
        let (sin_b, cos_b) = f64::from(vane.alpha_b()).sin_cos();
        let (sin_bl, cos_bl) = f64::from(vane.alpha_bl()).sin_cos();
        let (period, spacing) = (f64::from(feather.p_b(side)), f64::from(feather.d_bl(side)));
        let optics = &feather.optics;
        let axes = |radius: f32, aspect: f32| [f64::from(radius), f64::from(radius * aspect)];
        let mut curves = Self {
            sin_b,
            cos_b,
            sin_bl,
            cos_bl,
            period,
            radius: [
                axes(feather.r_b(side), optics.barb.aspect),
                axes(feather.r_bd(side), optics.distal.aspect),
                axes(feather.r_bp(side), optics.proximal.aspect),
            ],
            barbs: Vec::new(),
            first: 0,
            gaps: Vec::new(),
        };
        let outline = Outline::new(feather, side);
        // Barb k is rooted on the rachis at k / N_b.
        let step = period / sin_b;
        curves.first = (outline.start / step).ceil() as i64;
        let last = (1.0 / step).floor() as i64;
        for k in curves.first..=last {
            let across = k as f64 * period;
            let begin = across * cos_b / sin_b;
            let reach = outline.reach(k as f64 * step);
            curves.barbs.push(Barb {
                across,
                begin,
                end: begin + reach / sin_b,
            });
        }
        // One more gap below the lowest barb: its barbules hang on that barb.
        curves.first -= 1;
        let lowest = curves.first;
        for k in lowest..=last {
            let families = [false, true]
                .map(|proximal| curves.barbules(feather, side, &outline, k, proximal, spacing));
            curves.gaps.push(families);
        }
        curves.first += 1;
        curves
    }

    /// Point at distance `t` along a barbule in (distance from the rachis, height).
    pub(crate) fn along_barbule(&self, k: i64, root: f64, proximal: bool, t: f64) -> [f64; 2] {
        let across = (k + i64::from(proximal)) as f64 * self.period;
        let sign = if proximal { -1.0 } else { 1.0 };
        let s = across + sign * t * self.sin_bl;
        let v = root + t * self.cos_bl;
        // From (across, along) of the barbs to the canonical plane; the distance is -x of the left vane.
        [
            v * self.sin_b - s * self.cos_b,
            s * self.sin_b + v * self.cos_b,
        ]
    }

    fn barbules(
        &self,
        feather: &Feather,
        side: Side,
        outline: &Outline,
        k: i64,
        proximal: bool,
        spacing: f64,
    ) -> Vec<Barbule> {
        let owner = k + i64::from(proximal);
        let first_root = owner as f64 * self.period * self.cos_b / self.sin_b;
        let (flank, far) = (
            self.radius[0][0] / self.sin_bl,
            (self.period - self.radius[0][0]) / self.sin_bl,
        );
        let mut list = Vec::new();
        if far <= flank {
            return list;
        }
        let vane = feather.vane(side);
        // Roots beyond the shaft: barbules that grow from it into the gap.
        let before = ((far * self.cos_bl + self.period) / (spacing * self.sin_b)).ceil() as i64 + 2;
        let longest = outline.rows.iter().copied().fold(0.0, f64::max) / self.sin_b;
        let after = (longest / spacing).ceil() as i64 + before;
        for j in -before..=after {
            let root = first_root + j as f64 * spacing;
            let at = |t: f64| self.along_barbule(k, root, proximal, t);
            let Some([begin, end]) = outline.clip(flank, far, at) else {
                continue;
            };
            let [x, y] = at(0.5 * (begin + end));
            let reach = outline.reach(y - x * outline.cot);
            let hooked = card::hooked(x, y, reach, f64::from(vane.fringe), f64::from(vane.downy));
            // A barbule that reaches a barb is cut along the barb's flank, when a ray meets it, and not across its own axis.
            let whole = (self.period / self.sin_bl) as f32;
            list.push(Barbule {
                root,
                begin: if begin > flank { begin as f32 } else { 0.0 },
                end: if end < far { end as f32 } else { whole },
                width: card::barbule_factor(hooked) as f32,
            });
        }
        list
    }
}

impl Curves {
    /// Enumerates the fibres of `feather`, which should be a valid one; takes time and memory in proportion to their number.
    pub fn build(feather: &Feather) -> Self {
        Self {
            vanes: Side::BOTH.map(|side| VaneCurves::new(feather, side)),
            spline: feather.rachis.spline(),
            aspect: f64::from(feather.aspect),
            rachis: feather
                .rachis
                .radius_mm
                .map(|r| f64::from(feather.from_mm(r))),
            rachis_flatness: f64::from(feather.optics.rachis.aspect),
        }
    }

    pub(crate) fn vane(&self, side: Side) -> &VaneCurves {
        &self.vanes[usize::from(side == Side::Right)]
    }

    /// r_r at v, feather lengths: the parabola through base, middle and tip.
    pub(crate) fn rachis_radius(&self, v: f64) -> f64 {
        let [base, middle, tip] = self.rachis;
        let parabola = base * (1.0 - v) * (1.0 - 2.0 * v)
            + middle * 4.0 * v * (1.0 - v)
            + tip * v * (2.0 * v - 1.0);
        parabola.max(0.0)
    }

    /// Barbs of a side, in the order of their roots.
    pub fn barbs(&self, side: Side) -> &[Barb] {
        &self.vane(side).barbs
    }

    /// Number of barbs and barbules.
    pub fn counts(&self) -> [usize; 2] {
        let barbs = self.vanes.iter().map(|vane| vane.barbs.len()).sum();
        let gaps = self.vanes.iter().flat_map(|vane| &vane.gaps);
        [barbs, gaps.map(|[d, p]| d.len() + p.len()).sum()]
    }

    /// Bytes of the fibres as they lie here (angles and radii shared), the smallest explicit form.
    pub fn bytes(&self) -> usize {
        let [barbs, barbules] = self.counts();
        barbs * size_of::<Barb>() + barbules * size_of::<Barbule>()
    }

    /// Bytes of the same fibres as ray tracers take curves: two control points of three coordinates and a radius, f32.
    pub fn curve_bytes(&self) -> usize {
        let [barbs, barbules] = self.counts();
        (barbs + barbules + 1) * 2 * 16
    }
}
