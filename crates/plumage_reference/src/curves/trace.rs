//! Rays against the fibres. The layout is the acceleration structure: barbs are ordered across, barbules along each gap.

use super::{Curves, build::VaneCurves};
use bevy_plumage::anatomy::Side;

/// Kind of fibre, in the order of the plugin's weights.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Part {
    /// The shaft.
    Rachis = 0,
    /// A barb.
    Barb = 1,
    /// A distal barbule.
    Distal = 2,
    /// A proximal barbule.
    Proximal = 3,
}

/// One fibre of a feather.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FibreId {
    /// Kind.
    pub part: Part,
    /// Vane; left for the shaft.
    pub side: Side,
    /// Barb or gap, from the base; 0 for the shaft.
    pub row: u32,
    /// Barbule within the gap, from the rachis; 0 for others.
    pub place: u32,
}

/// A ray in card space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub origin: [f64; 3],
    /// Where it goes; any length but 0.
    pub direction: [f64; 3],
}

/// Where a ray meets a fibre first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurveHit {
    /// Along the ray, in units of its direction's length.
    pub distance: f64,
    /// The fibre.
    pub fibre: FibreId,
    /// The point in card space.
    pub point: [f64; 3],
    /// The nearest point of the fibre's axis in card space.
    pub axis: [f64; 3],
    /// Unit direction of the fibre towards its tip, card space.
    pub tangent: [f64; 3],
    /// Semi-axes of the fibre in the card and along its normal, feather lengths.
    pub radius: [f64; 2],
    /// Which side of the fibre was met: -1..1, positive towards `normal x tangent` of an eye that looks along the ray.
    pub offset: f64,
}

/// A cylinder's local problem: the ray in (across, height), its centre line at the origin.
struct Section {
    origin: [f64; 2],
    direction: [f64; 2],
    radius: [f64; 2],
}

impl Section {
    /// Where along the ray it is in the ellipse.
    fn span(&self) -> Option<[f64; 2]> {
        let scale = |v: [f64; 2]| [v[0] / self.radius[0], v[1] / self.radius[1]];
        let (o, d) = (scale(self.origin), scale(self.direction));
        let a = d[0] * d[0] + d[1] * d[1];
        if a < 1e-30 {
            return None;
        }
        // From the point nearest to the axis: no cancellation for distant origins.
        let nearest = -(o[0] * d[0] + o[1] * d[1]) / a;
        let cross = o[0] * d[1] - o[1] * d[0];
        let half2 = 1.0 - cross * cross / a;
        if half2 <= 0.0 {
            return None;
        }
        let half = (half2 / a).sqrt();
        Some([nearest - half, nearest + half])
    }
}

/// The piece of `range` on which `value + t slope` lies within low..high.
fn within(range: [f64; 2], value: f64, slope: f64, low: f64, high: f64) -> Option<[f64; 2]> {
    if slope.abs() < 1e-18 {
        return (low..=high).contains(&value).then_some(range);
    }
    let (a, b) = ((low - value) / slope, (high - value) / slope);
    let piece = [range[0].max(a.min(b)), range[1].min(a.max(b))];
    (piece[0] <= piece[1]).then_some(piece)
}

/// The first hit so far.
struct Best {
    distance: f64,
    fibre: Option<FibreId>,
    skip: Option<FibreId>,
    /// A ray that starts within a fibre meets it.
    from_within: bool,
}

impl Best {
    /// `span`: where the ray is in the fibre; `least`: where it begins.
    fn offer(&mut self, span: [f64; 2], least: f64, fibre: FibreId) {
        let [mut distance, leaves] = span;
        if self.from_within && leaves > least {
            distance = distance.max(least);
        }
        if distance >= least && distance < self.distance && self.skip != Some(fibre) {
            self.distance = distance;
            self.fibre = Some(fibre);
        }
    }
}

/// A ray in the plane of one vane's fibres: (across the barbs, along them, height).
#[derive(Clone, Copy)]
struct VaneRay {
    origin: [f64; 3],
    direction: [f64; 3],
}

impl VaneRay {
    fn at(&self, t: f64, axis: usize) -> f64 {
        self.origin[axis] + t * self.direction[axis]
    }

    /// The piece of `range` on which coordinate `axis` lies within low..high.
    fn within(&self, range: [f64; 2], axis: usize, low: f64, high: f64) -> Option<[f64; 2]> {
        within(range, self.origin[axis], self.direction[axis], low, high)
    }
}

impl VaneCurves {
    /// Heights of the axes of distal and proximal barbules.
    fn heights(&self) -> [f64; 2] {
        let lift = 0.5 * (self.radius[1][1] + self.radius[2][1]);
        [lift, -lift]
    }

    fn tallest(&self) -> f64 {
        let barbule = self.heights()[0] + self.radius[1][1].max(self.radius[2][1]);
        self.radius[0][1].max(barbule)
    }

    fn cast(&self, ray: &VaneRay, side: Side, least: f64, best: &mut Best) {
        let tall = self.tallest();
        let Some(slab) = ray.within([least, best.distance], 2, -tall, tall) else {
            return;
        };
        let (s0, s1) = (ray.at(slab[0], 0), ray.at(slab[1], 0));
        let margin = self.radius[0][0];
        let (low, high) = (s0.min(s1) - margin, s0.max(s1) + margin);
        let first = ((low / self.period).floor() as i64).max(self.first - 1);
        let last =
            ((high / self.period).floor() as i64).min(self.first - 2 + self.gaps.len() as i64);
        for k in first..=last + 1 {
            let Some(barb) = usize::try_from(k - self.first)
                .ok()
                .and_then(|i| self.barbs.get(i))
            else {
                continue;
            };
            let section = Section {
                origin: [ray.origin[0] - barb.across, ray.origin[2]],
                direction: [ray.direction[0], ray.direction[2]],
                radius: self.radius[0],
            };
            if let Some(span) = section.span()
                && let Some(span) = ray.within(span, 1, barb.begin, barb.end)
            {
                let fibre = FibreId {
                    part: Part::Barb,
                    side,
                    row: (k - self.first) as u32,
                    place: 0,
                };
                best.offer(span, least, fibre);
            }
        }
        for k in first..=last {
            self.cast_gap(ray, slab, k, side, least, best);
        }
    }

    fn cast_gap(
        &self,
        ray: &VaneRay,
        slab: [f64; 2],
        k: i64,
        side: Side,
        least: f64,
        best: &mut Best,
    ) {
        let Some(gap) = usize::try_from(k - self.first + 1)
            .ok()
            .and_then(|i| self.gaps.get(i))
        else {
            return;
        };
        let heights = self.heights();
        for (family, list) in gap.iter().enumerate() {
            let radius = self.radius[family + 1];
            let z = heights[family];
            let margin = radius[0];
            let low = k as f64 * self.period - margin;
            let Some(piece) = ray.within(slab, 0, low, low + self.period + 2.0 * margin) else {
                continue;
            };
            let Some(piece) = ray.within(piece, 2, z - radius[1], z + radius[1]) else {
                continue;
            };
            let proximal = family == 1;
            let sign = if proximal { -1.0 } else { 1.0 };
            let across = (k + i64::from(proximal)) as f64 * self.period;
            // Constant along the axis of a barbule: where it is rooted.
            let cot = self.cos_bl / self.sin_bl;
            let root_at = |t: f64| ray.at(t, 1) - sign * (ray.at(t, 0) - across) * cot;
            let (a, b) = (root_at(piece[0]), root_at(piece[1]));
            let reach = margin / self.sin_bl;
            let from = list.partition_point(|barbule| barbule.root < a.min(b) - reach);
            for (i, barbule) in list.iter().enumerate().skip(from) {
                if barbule.root > a.max(b) + reach {
                    break;
                }
                // Across the barbule: the normal of its axis in the card.
                let normal = [-sign * self.cos_bl, self.sin_bl];
                let offset = [ray.origin[0] - across, ray.origin[1] - barbule.root];
                let section = Section {
                    origin: [
                        offset[0] * normal[0] + offset[1] * normal[1],
                        ray.origin[2] - z,
                    ],
                    direction: [
                        ray.direction[0] * normal[0] + ray.direction[1] * normal[1],
                        ray.direction[2],
                    ],
                    radius: [radius[0] * f64::from(barbule.width), radius[1]],
                };
                // Cut to the stretch between the flanks of the two barbs: a ray may enter through the cut.
                let flank = self.radius[0][0];
                let low = k as f64 * self.period;
                let along = |o: f64, v: f64| sign * o * self.sin_bl + v * self.cos_bl;
                let span = section
                    .span()
                    .and_then(|span| ray.within(span, 0, low + flank, low + self.period - flank))
                    .and_then(|span| {
                        within(
                            span,
                            along(offset[0], offset[1]),
                            along(ray.direction[0], ray.direction[1]),
                            f64::from(barbule.begin),
                            f64::from(barbule.end),
                        )
                    });
                if let Some(span) = span {
                    let fibre = FibreId {
                        part: if proximal {
                            Part::Proximal
                        } else {
                            Part::Distal
                        },
                        side,
                        row: (k - self.first + 1) as u32,
                        place: i as u32,
                    };
                    best.offer(span, least, fibre);
                }
            }
        }
    }

    /// Axis through a fibre in (across, along, height): a point, the unit direction, the semi-axes.
    fn axis(&self, fibre: FibreId) -> Option<([f64; 3], [f64; 3], [f64; 2])> {
        let row = fibre.row as usize;
        if fibre.part == Part::Barb {
            let barb = self.barbs.get(row)?;
            return Some((
                [barb.across, barb.begin, 0.0],
                [0.0, 1.0, 0.0],
                self.radius[0],
            ));
        }
        let proximal = fibre.part == Part::Proximal;
        let family = usize::from(proximal);
        let barbule = self.gaps.get(row)?[family].get(fibre.place as usize)?;
        let across =
            (self.first - 1 + i64::from(fibre.row) + i64::from(proximal)) as f64 * self.period;
        let sign = if proximal { -1.0 } else { 1.0 };
        let radius = self.radius[family + 1];
        Some((
            [across, barbule.root, self.heights()[family]],
            [sign * self.sin_bl, self.cos_bl, 0.0],
            [radius[0] * f64::from(barbule.width), radius[1]],
        ))
    }
}

impl Curves {
    /// The shaft's x in card space and its slope d x / d y.
    pub(crate) fn shaft(&self, y: f64) -> [f64; 2] {
        let (curve, slope) = self.spline.at(y);
        [(curve - 0.5) * self.aspect, slope * self.aspect]
    }

    /// First fibre that a ray meets at a distance of at least `least`, `skip` left out.
    ///
    /// Rays along the card within a degree see one barb's thickness of it and are cut to ten feather lengths.
    pub fn hit(&self, ray: &Ray, least: f64, skip: Option<FibreId>) -> Option<CurveHit> {
        self.cast(ray, least, skip, false)
    }

    /// Does a ray meet any fibre but `skip`? One that starts within a fibre does: where two fibres share a place, each shades the
    /// other.
    pub fn blocked(&self, ray: &Ray, skip: FibreId) -> bool {
        self.cast(ray, 0.0, Some(skip), true).is_some()
    }

    fn cast(
        &self,
        ray: &Ray,
        least: f64,
        skip: Option<FibreId>,
        from_within: bool,
    ) -> Option<CurveHit> {
        let d = ray.direction;
        // Where the ray meets the card; the map is straightened there.
        let reference = if d[2].abs() > 1e-9 {
            let t = (-ray.origin[2] / d[2]).clamp(-1e3, 1e3);
            ray.origin[1] + t * d[1]
        } else {
            ray.origin[1]
        };
        let [middle, slope] = self.shaft(reference);
        let canonical = Ray {
            origin: [
                ray.origin[0] - middle - slope * (ray.origin[1] - reference),
                ray.origin[1],
                ray.origin[2],
            ],
            direction: [d[0] - slope * d[1], d[1], d[2]],
        };
        let mut best = Best {
            distance: f64::INFINITY,
            fibre: None,
            skip,
            from_within,
        };
        self.cast_rachis(&canonical, reference, least, &mut best);
        if d[2].abs() < 1e-9 {
            best.distance = best.distance.min(least + 10.0);
        }
        for side in Side::BOTH {
            let vane = self.vane(side);
            best_of_side(vane, &canonical, side, least, &mut best);
        }
        let fibre = best.fibre?;
        Some(self.describe(ray, &canonical, fibre, best.distance, reference))
    }

    fn cast_rachis(&self, ray: &Ray, reference: f64, least: f64, best: &mut Best) {
        let r = self.rachis_radius(reference.clamp(0.0, 1.0));
        if r <= 0.0 {
            return;
        }
        let section = Section {
            origin: [ray.origin[0], ray.origin[2]],
            direction: [ray.direction[0], ray.direction[2]],
            radius: [r, r * self.rachis_flatness],
        };
        if let Some(span) = section.span()
            && let Some(span) = within(span, ray.origin[1], ray.direction[1], 0.0, 1.0)
        {
            let fibre = FibreId {
                part: Part::Rachis,
                side: Side::Left,
                row: 0,
                place: 0,
            };
            best.offer(span, least, fibre);
        }
    }

    fn describe(
        &self,
        ray: &Ray,
        canonical: &Ray,
        fibre: FibreId,
        distance: f64,
        reference: f64,
    ) -> CurveHit {
        let slope = self.shaft(reference)[1];
        let point = at(ray, distance);
        let sheared = at(canonical, distance);
        let r = self.rachis_radius(reference.clamp(0.0, 1.0));
        let vane = self.vane(fibre.side);
        let mirror = f64::from(-fibre.side.sign());
        // In (across, along) of the barbs; the shaft is its own axis in the canonical plane.
        let (axis, tangent, radius) = vane
            .axis(fibre)
            .filter(|_| fibre.part != Part::Rachis)
            .map(|(base, along, radius)| {
                let plane = |v: [f64; 3]| {
                    [
                        mirror * (v[0] * vane.cos_b - v[1] * vane.sin_b),
                        v[0] * vane.sin_b + v[1] * vane.cos_b,
                        v[2],
                    ]
                };
                let (base, along) = (plane(base), plane(along));
                let t = (0..3)
                    .map(|i| (sheared[i] - base[i]) * along[i])
                    .sum::<f64>();
                ([0, 1, 2].map(|i| base[i] + t * along[i]), along, radius)
            })
            .unwrap_or((
                [0.0, sheared[1], 0.0],
                [0.0, 1.0, 0.0],
                [r, r * self.rachis_flatness],
            ));
        let card = |v: [f64; 3]| [v[0] + slope * v[1], v[1], v[2]];
        let length = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let tangent = card(tangent);
        let l = length(tangent);
        let tangent = tangent.map(|x| x / l);
        let off = [0, 1, 2].map(|i| sheared[i] - axis[i]);
        let axis = {
            let shift = card(off);
            [0, 1, 2].map(|i| point[i] - shift[i])
        };
        // Across the fibre as the ray sees it.
        let d = canonical.direction;
        let t = [tangent[0] - slope * tangent[1], tangent[1], tangent[2]];
        let across = [
            t[1] * d[2] - t[2] * d[1],
            t[2] * d[0] - t[0] * d[2],
            t[0] * d[1] - t[1] * d[0],
        ];
        let half = silhouette(across, t, radius).max(1e-30);
        let offset = (0..3).map(|i| off[i] * across[i]).sum::<f64>() / half;
        CurveHit {
            distance,
            fibre,
            point,
            axis,
            tangent,
            radius,
            offset: offset.clamp(-1.0, 1.0),
        }
    }
}

/// Support of the fibre's cross-section along `across` (any length): half its apparent width times that length.
fn silhouette(across: [f64; 3], tangent: [f64; 3], radius: [f64; 2]) -> f64 {
    let l = tangent[0].hypot(tangent[1]).max(1e-30);
    let in_card = (across[0] * tangent[1] - across[1] * tangent[0]) / l;
    (in_card * radius[0]).hypot(across[2] * radius[1])
}

/// The place of the fibre, at the hit's place along it, that mirrors light from unit direction `to_light` to unit direction `eye`;
/// light enters it by a share `retreat` of the way from there towards its direction. `turn`: what roughness turns it by, radians.
pub(crate) fn mirror_point(
    hit: &CurveHit,
    eye: [f64; 3],
    to_light: [f64; 3],
    retreat: f64,
    turn: f64,
) -> [f64; 3] {
    let t = hit.tangent;
    let l = t[0].hypot(t[1]).max(1e-30);
    let across = [t[1] / l, -t[0] / l];
    let unit = |v: [f64; 2]| {
        let size = v[0].hypot(v[1]).max(1e-12);
        v.map(|x| x / size)
    };
    let flat = |v: [f64; 3]| unit([v[0] * across[0] + v[1] * across[1], v[2]]);
    let (eye, light) = (flat(eye), flat(to_light));
    let middle = unit([eye[0] + light[0], eye[1] + light[1]]);
    // The normal of an ellipse to its parametric angle.
    let normal = unit([0, 1].map(|k| middle[k] + (light[k] - middle[k]) * retreat));
    let (sin, cos) = turn.sin_cos();
    let normal = [
        normal[0] * cos + normal[1] * sin,
        normal[1] * cos - normal[0] * sin,
    ];
    let [aside, up] = unit([normal[0] * hit.radius[0], normal[1] * hit.radius[1]]);
    [
        hit.axis[0] + hit.radius[0] * aside * across[0],
        hit.axis[1] + hit.radius[0] * aside * across[1],
        hit.axis[2] + hit.radius[1] * up,
    ]
}

/// Where light from unit direction `to_light` meets the fibre at the hit's place along it, at share `h` in -1..1 of the width that
/// the light sees.
pub(crate) fn lit_point(hit: &CurveHit, to_light: [f64; 3], h: f64) -> [f64; 3] {
    let t = hit.tangent;
    let l = t[0].hypot(t[1]).max(1e-30);
    let across = [t[1] / l, -t[0] / l];
    // The section as a unit circle.
    let light = [
        (to_light[0] * across[0] + to_light[1] * across[1]) / hit.radius[0],
        to_light[2] / hit.radius[1],
    ];
    let size = light[0].hypot(light[1]);
    if size < 1e-9 {
        return hit.axis;
    }
    let light = light.map(|x| x / size);
    let depth = (1.0 - h * h).max(0.0).sqrt();
    let aside = hit.radius[0] * (h * light[1] + depth * light[0]);
    let up = hit.radius[1] * (depth * light[1] - h * light[0]);
    [
        hit.axis[0] + aside * across[0],
        hit.axis[1] + aside * across[1],
        hit.axis[2] + up,
    ]
}

fn at(ray: &Ray, t: f64) -> [f64; 3] {
    [0, 1, 2].map(|i| ray.origin[i] + t * ray.direction[i])
}

/// Casts at one vane, the right one mirrored to the left.
fn best_of_side(vane: &VaneCurves, ray: &Ray, side: Side, least: f64, best: &mut Best) {
    let mirror = f64::from(-side.sign());
    let plane = |v: [f64; 3]| {
        let x = mirror * v[0];
        [
            x * vane.cos_b + v[1] * vane.sin_b,
            v[1] * vane.cos_b - x * vane.sin_b,
            v[2],
        ]
    };
    let local = VaneRay {
        origin: plane(ray.origin),
        direction: plane(ray.direction),
    };
    vane.cast(&local, side, least, best);
}
