//! The feather under the lamp: color and opacity at a pixel.

use super::{Pose, Setting, color, setting::Stream};
use bevy_plumage::{
    anatomy::{CONTOUR_ROWS, Feather, ShapeTable, Side},
    maths::{self, card, functions::normal_distribution, query},
};
use noise::{NoiseFn, Perlin};

/// Layers of barbules in a closed vane: hooklets and lamellae overlap below the one layer that the range query knows, and a
/// photographed vane lets almost nothing through.
const CLOSED_LAYERS: f64 = 2.5;
/// The same in down, whose barbules stand around the barb.
const LOOSE_LAYERS: f64 = 5.0;
/// Octaves of barb-to-barb differences: every barb, every 4th, every 16th.
const OCTAVES: [f64; 3] = [1.0, 4.0, 16.0];

/// What one pixel sees of the feather.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Texel {
    /// Linear color under the lamp, not multiplied with `alpha`.
    pub color: [f32; 3],
    /// Opacity, 0..1.
    pub alpha: f32,
}

/// One vane, ready for pixels.
struct VaneSheet {
    vane: query::Vane<f64>,
    cell: query::Cell<f64>,
    angle: f64,
    cotangent: f64,
    fringe: f64,
    downy: f64,
    /// Barbs per feather length along the rachis.
    count: f64,
    /// Differences between barbs in -1..1, per octave.
    tone: [Vec<f32>; 3],
    /// Differences between the reaches of barbs, the same way.
    ragged: [Vec<f32>; 3],
    /// Mean share of barbs and of barbules, closed.
    mean: [f64; 2],
}

/// A feather in its pose, ready for pixels.
pub(super) struct Sheet {
    pub pose: Pose,
    shape: ShapeTable,
    vanes: [VaneSheet; 2],
    shares: [f32; 3],
    shaft: f32,
    /// Baked pattern, linear, rows from v = 0.
    pattern: Vec<[f32; 3]>,
    pattern_size: [usize; 2],
    perlin: Perlin,
    /// Towards the lamp in canonical axes, z up.
    lamp: [f64; 3],
    ambient: f32,
    rachis: Vec<f64>,
    budget: query::ErrorBudget<f64>,
    back: bool,
}

fn differences(count: f64, r: &mut Stream) -> [Vec<f32>; 3] {
    OCTAVES.map(|period| {
        let length = (count / period) as usize + 3;
        (0..length).map(|_| r.between(-1.0, 1.0)).collect()
    })
}

/// Octaves of differences at barb `place`, each faded out where `width` (barbs per pixel) no longer resolves it.
fn difference(octaves: &[Vec<f32>; 3], place: f64, width: f64, weights: [f64; 3]) -> f64 {
    let mut sum = 0.0;
    for ((values, period), weight) in octaves.iter().zip(OCTAVES).zip(weights) {
        let at = (place / period).clamp(0.0, (values.len() - 2) as f64);
        let (i, t) = (at as usize, at.fract());
        let value = f64::from(values[i]) * (1.0 - t) + f64::from(values[i + 1]) * t;
        let blur = width / period;
        sum += weight * value * (-2.0 * blur * blur).exp();
    }
    sum
}

impl VaneSheet {
    fn new(feather: &Feather, side: Side, back: bool, r: &mut Stream) -> Self {
        let vane = feather.vane(side);
        let query_vane = feather.query_vane(side);
        let view = [0.0, 0.0, if back { -1.0 } else { 1.0 }];
        let cell = query::mask_vane(&query_vane, view);
        let [barb, upper, lower] = query::mean_coverage(&cell);
        let count = f64::from(vane.barb_count);
        Self {
            vane: query_vane,
            cell,
            angle: f64::from(vane.alpha_b()),
            cotangent: card::barb_cotangent(query_vane.sin_b, query_vane.cos_b),
            fringe: f64::from(vane.fringe),
            downy: f64::from(vane.downy),
            count,
            tone: differences(count * 1.2, r),
            ragged: differences(count * 1.2, r),
            mean: [barb, upper + lower],
        }
    }
}

impl Sheet {
    pub fn new(feather: &Feather, setting: &Setting) -> Self {
        let pose = setting.pose(feather);
        let mut r = Stream::new(setting.seed ^ 0xba2b);
        let vanes = Side::BOTH.map(|side| VaneSheet::new(feather, side, setting.back, &mut r));
        let height = (pose.scale as usize).clamp(128, 2048);
        let width = ((pose.scale * f64::from(feather.aspect)) as usize).clamp(32, 768);
        let bytes = setting.pattern(feather).bake(width, height, feather);
        let pattern = bytes
            .chunks_exact(4)
            .map(|texel| color::tinted(texel, setting.tint))
            .collect();
        let light = &setting.light;
        let azimuth = f64::from(light.azimuth);
        let [x, y] = pose.plane_direction([azimuth.sin(), -azimuth.cos()]);
        let (up, flat) = f64::from(light.elevation).clamp(0.2, 1.5).sin_cos();
        let share = feather.albedo.share;
        Self {
            shape: feather.shape_table(),
            vanes,
            shares: [share.rachis, share.barb, share.barbule],
            shaft: setting.shaft,
            pattern,
            pattern_size: [width, height],
            perlin: Perlin::new(setting.seed as u32 ^ 77),
            lamp: [x * flat, y * flat, up],
            ambient: light.ambient.clamp(0.0, 1.0),
            rachis: (0..=64)
                .map(|i| f64::from(feather.r_r(i as f32 / 64.0)))
                .collect(),
            budget: query::ErrorBudget {
                epsilon: 0.01,
                quality: query::Quality::draft(),
            },
            back: setting.back,
            pose,
        }
    }

    /// Painted color at `uv`, linear, bilinear between texels.
    fn painted(&self, [u, v]: [f64; 2]) -> [f32; 3] {
        let [width, height] = self.pattern_size;
        let place = |value: f64, count: usize| {
            let at = (value * count as f64 - 0.5).clamp(0.0, (count - 1) as f64);
            let i = (at as usize).min(count - 2);
            (i, (at - i as f64) as f32)
        };
        let ((x, s), (y, t)) = (place(u, width), place(v, height));
        let at = |x: usize, y: usize| self.pattern[y * width + x];
        let (a, b, c, d) = (at(x, y), at(x + 1, y), at(x, y + 1), at(x + 1, y + 1));
        std::array::from_fn(|i| {
            let low = a[i] + (b[i] - a[i]) * s;
            let high = c[i] + (d[i] - c[i]) * s;
            low + (high - low) * t
        })
    }

    /// Color of the vane from a distance under even light, linear: what its fibres together have of the painted color.
    pub fn albedo(&self, pixel: [f64; 2]) -> [f32; 3] {
        let uv = self.pose.uv(pixel);
        let point = self.pose.map().canonical(uv);
        let vane = self.vane(point[0]);
        let hooked = card::hooked(0.0, point[1], 1.0, 0.0, vane.downy);
        let barbule = vane.mean[1] * card::barbule_factor(hooked);
        self.mixed(self.painted(uv), [vane.mean[0], barbule])
    }

    /// How closed the vane is at a pixel, 0 (down, through which the background shows) to 1.
    pub fn closed(&self, pixel: [f64; 2]) -> f64 {
        let [x, y] = self.pose.canonical(pixel);
        let vane = self.vane(x);
        let (reach, _) = self.reach(x >= 0.0, card::barb_root([x, y], vane.cotangent));
        card::hooked(x.abs(), y, reach, vane.fringe, vane.downy)
    }

    /// Painted color times the shares of barbs and barbules.
    fn mixed(&self, painted: [f32; 3], weights: [f64; 2]) -> [f32; 3] {
        let [barb, barbule] = weights.map(|weight| weight as f32);
        let sum = (barb + barbule).max(1e-6);
        painted.map(|value| {
            (barb * (value * self.shares[1]).min(0.96)
                + barbule * (value * self.shares[2]).min(0.96))
                / sum
        })
    }

    fn vane(&self, x: f64) -> &VaneSheet {
        &self.vanes[usize::from(x >= 0.0)]
    }

    /// Reach of the barb rooted at `root` and its slope.
    fn reach(&self, right: bool, root: f64) -> (f64, f64) {
        let rows = CONTOUR_ROWS as f64;
        let place = card::contour_row(root, f64::from(self.shape.start), rows);
        let i = (place as usize).min(CONTOUR_ROWS - 2);
        let t = place - i as f64;
        let (low, high) = (self.shape.contour[i], self.shape.contour[i + 1]);
        let side = usize::from(right);
        let value = f64::from(low[side]) * (1.0 - t) + f64::from(high[side]) * t;
        (value, f64::from(low[2 + side]))
    }

    /// Radius of the shaft; the calamus closes at the very base.
    fn shaft_radius(&self, v: f64) -> f64 {
        let place = v.clamp(0.0, 1.0) * 64.0;
        let i = (place as usize).min(63);
        let t = place - i as f64;
        let radius = self.rachis[i] * (1.0 - t) + self.rachis[i + 1] * t;
        radius * (v / 0.012).clamp(0.35, 1.0)
    }

    /// How far barbs lie off their place at a point, feather lengths: a little everywhere, much where nothing hooks.
    fn stray(&self, point: [f64; 2], hooked: f64, pitch: f64) -> f64 {
        let [x, y] = point;
        let near = self
            .perlin
            .get([x / (9.0 * pitch), y / (14.0 * pitch), 3.1]);
        let mut stray = 0.12 * pitch * near;
        if hooked < 0.999 {
            let wave = self.perlin.get([x * 24.0, y * 11.0, 7.7])
                + 0.25 * self.perlin.get([x * 60.0, y * 40.0, 9.2]);
            // Neighbours part and meet.
            let own = self.perlin.get([x * 26.0, y / pitch * 0.9, 5.3]);
            stray += (1.0 - hooked) * (0.012 * wave + 0.5 * pitch * own);
        }
        stray
    }

    /// The outline's shares of a pixel: vane, shaft, and what follows from the point on the way there.
    fn place(&self, pixel: [f64; 2]) -> Option<Place<'_>> {
        let uv = self.pose.uv(pixel);
        if !(-0.05..=1.05).contains(&uv[0]) || !(-0.02..=1.02).contains(&uv[1]) {
            return None;
        }
        let [dx, dy] = self.pose.uv_derivatives(pixel);
        let foot = self.pose.map().footprint(uv, dx, dy);
        let [x, y] = foot.mean;
        let vane = self.vane(x);
        let right = x >= 0.0;
        let deviation = foot.covariance[2].max(1e-14).sqrt();
        let (plain, _) = self.reach(right, card::barb_root([x, y], vane.cotangent));
        let hooked = card::hooked(x.abs(), y, plain, vane.fringe, vane.downy);
        let height = y + self.stray(
            [x, y],
            card::hooked(0.0, y, 1.0, 0.0, vane.downy),
            1.0 / vane.count,
        );
        let mean = [x, height];
        let root = card::barb_root(mean, vane.cotangent);
        let (reach, slope) = self.reach(right, root);
        let width = 2.0 * deviation * vane.count;
        let ragged = difference(&vane.ragged, root * vane.count, width, [0.5, 0.3, 0.2]);
        let loose = 1.0 - card::hooked(0.0, y, 1.0, 0.0, vane.downy);
        let reach = reach * (1.0 + ragged * (0.006 + 0.04 * vane.fringe + 0.08 * loose));
        let moved = maths::Footprint { mean, ..foot };
        let inside = card::contour_coverage(&moved, reach, slope, vane.cotangent)
            * card::vane_start_coverage(&moved, f64::from(self.shape.start), vane.cotangent);
        let radius = self.shaft_radius(y);
        let across = foot.covariance[0].max(1e-14).sqrt();
        let shaft = (normal_distribution((x + radius) / across)
            - normal_distribution((x - radius) / across))
            * normal_distribution(y / deviation)
            * normal_distribution((1.0 - y) / deviation);
        if inside < 1e-3 && shaft < 1e-3 {
            return None;
        }
        Some(Place {
            uv,
            mean,
            cov: foot.covariance,
            vane,
            root,
            reach,
            hooked,
            width,
            inside,
            shaft: shaft.clamp(0.0, 1.0),
            radius,
        })
    }

    /// Share of the pixel within the outline or on the shaft, 0..1: what the truth's mask is made of.
    pub fn outline(&self, pixel: [f64; 2]) -> f64 {
        self.place(pixel).map_or(0.0, |place| {
            place.shaft + (1.0 - place.shaft) * place.inside
        })
    }

    /// Radius of the shaft at height `v`, pixels.
    pub fn shaft_pixels(&self, v: f64) -> f64 {
        self.shaft_radius(v) * self.pose.scale
    }

    /// What the pixel sees, and [`Self::outline`].
    pub fn texel(&self, pixel: [f64; 2]) -> (Texel, f64) {
        let Some(place) = self.place(pixel) else {
            return (Texel::default(), 0.0);
        };
        let painted = self.painted(place.uv);
        let (color, cover) = if place.inside > 1e-3 && place.shaft < 0.999 {
            self.vane_texel(&place, painted)
        } else {
            ([0.0; 3], 0.0)
        };
        let vane_alpha = (cover * place.inside * (1.0 - place.shaft)) as f32;
        let shaft_alpha = place.shaft as f32;
        let shaft_color = self.shaft_texel(&place, painted);
        let alpha = vane_alpha + shaft_alpha;
        let texel = Texel {
            color: std::array::from_fn(|i| {
                (color[i] * vane_alpha + shaft_color[i] * shaft_alpha) / alpha.max(1e-6)
            }),
            alpha,
        };
        (texel, place.shaft + (1.0 - place.shaft) * place.inside)
    }

    /// Light on a slope (rise per x and per y) over the light on the flat table.
    fn lit(&self, rise: [f64; 2]) -> f32 {
        let [x, y, z] = self.lamp;
        let length = (1.0 + rise[0] * rise[0] + rise[1] * rise[1]).sqrt();
        let facing = (z - x * rise[0] - y * rise[1]).max(0.0) / (length * z);
        self.ambient + (1.0 - self.ambient) * facing as f32
    }

    fn vane_texel(&self, place: &Place, painted: [f32; 3]) -> ([f32; 3], f64) {
        let vane = place.vane;
        let [x, _] = place.mean;
        let side = if x < 0.0 { -1.0 } else { 1.0 };
        let [xx, xy, yy] = place.cov;
        let footprint = maths::Footprint {
            mean: [x * -side, place.mean[1]],
            covariance: [xx, xy * -side, yy],
        };
        let [barb, distal, proximal] = query::vane_coverage(
            &vane.cell,
            &vane.vane,
            &footprint,
            query::Lod::Mixed,
            &self.budget,
        );
        let barbules = (distal + proximal) * card::barbule_factor(place.hooked);
        let layers = LOOSE_LAYERS + (CLOSED_LAYERS - LOOSE_LAYERS) * place.hooked;
        let open: f64 = 1.0 - (barb + barbules).clamp(0.0, 1.0);
        let cover = 1.0 - open.powf(layers);

        // Each vane arches from the shaft to its rim, and the whole feather a little from base to tip.
        let share = (x.abs() / place.reach.max(1e-4)).min(1.0);
        let arch = 0.10 - 0.30 * share * share;
        let arch = if self.back { -arch } else { arch };
        let mut rise = [side * arch, 0.06 - 0.12 * place.mean[1]];
        // Barbs stand out like cords: one side of each is lit, down to where the pixels blur them.
        let local = query::reduce(&vane.cell, &vane.vane, &footprint);
        let shown = (-2.0 * std::f64::consts::PI.powi(2) * local.variance).exp();
        if shown > 1e-3 {
            let wave = 0.22 * shown * (std::f64::consts::TAU * local.u).sin();
            rise[0] += wave * -side * vane.angle.cos();
            rise[1] += wave * vane.angle.sin();
        }
        let tone = difference(
            &vane.tone,
            place.root * vane.count,
            place.width,
            [0.07, 0.05, 0.035],
        );
        // The shaft stands over the vane and shades what lies next to it, most on the side away from the lamp.
        let gap = ((x.abs() - place.radius) / place.radius.max(1e-5)).max(0.0);
        let away = 0.5 - 0.5 * (self.lamp[0] * side).clamp(-1.0, 1.0);
        let shade = 1.0 - (0.12 + 0.25 * away) * (-0.5 * gap * gap).exp();
        let light = self.lit(rise) * (1.0 + tone as f32) * shade as f32;
        let color = self.mixed(painted, [barb, barbules]);
        (color.map(|value| (value * light).max(0.0)), cover)
    }

    fn shaft_texel(&self, place: &Place, painted: [f32; 3]) -> [f32; 3] {
        let offset = (place.mean[0] / place.radius.max(1e-6)).clamp(-0.9, 0.9);
        let round = (1.0 - offset * offset).sqrt();
        let light = self.lit([0.6 * offset / round, 0.0]).min(1.5);
        let [lx, ly, lz] = self.lamp;
        // Half way between the lamp and the camera, for the gloss of keratin.
        let half = [lx, ly, lz + 1.0];
        let length = (half[0] * half[0] + half[1] * half[1] + half[2] * half[2]).sqrt();
        let facing = ((half[0] * offset + half[2] * round) / length).max(0.0);
        let gloss = (0.12 * (1.0 - self.ambient) as f64 * facing.powi(24)) as f32;
        // The calamus is bare, pale horn.
        let base = (1.0 - place.mean[1] as f32 / 0.25).clamp(0.0, 1.0) * 0.6;
        let horn = [0.62, 0.53, 0.41];
        std::array::from_fn(|i| {
            let own = (painted[i] * self.shares[0] * self.shaft).min(0.9);
            ((own + (horn[i] - own) * base) * light + gloss).clamp(0.0, 1.2)
        })
    }
}

/// A pixel's place on the feather.
struct Place<'a> {
    uv: [f64; 2],
    mean: [f64; 2],
    cov: [f64; 3],
    vane: &'a VaneSheet,
    root: f64,
    reach: f64,
    hooked: f64,
    /// Barbs per pixel along the shaft.
    width: f64,
    inside: f64,
    shaft: f64,
    radius: f64,
}
