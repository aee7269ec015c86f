//! Light at a hit: the plugin's K, one bounce.

use super::{
    CurveHit, Curves, FibreId, Part, Ray, near_field_lobes,
    trace::{lit_point, mirror_point},
};
use bevy_plumage::{
    anatomy::{BAKE_HEIGHT, BAKE_WIDTH, Feather, Side},
    maths::query::{self, grating_frequency, vane_eye, vane_ray, vane_shadow},
    maths::scattering::{
        Fibre, FibreReach, FibreShading, FibreTable, MEDULLA_PLACE, Sheen, fibre_along, fibre_lit,
        fibre_lobes, fibre_local, fibre_sample, fibre_shading, mirror_place, sheen_albedo,
        sheen_evaluate, sheen_lookup, sheen_tint,
    },
};

/// Which part of a fibre's width K is averaged over.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Field {
    /// As the plugin: the place met on barbs and shaft, the whole width of barbules.
    #[default]
    Resolved,
    /// The whole width of every fibre.
    Far,
    /// The very place that the ray met.
    Near,
}

/// How neighboring fibres shadow a hit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Visibility {
    /// Not at all.
    None,
    /// By the plugin's estimate, [`vane_shadow`].
    #[default]
    Estimated,
    /// By a ray to the light.
    Traced,
}

/// What the reference shades with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurveOptions {
    /// Part of the width.
    pub field: Field,
    /// Shadows between fibres.
    pub visibility: Visibility,
    /// Terms of the azimuth series, 1..=8.
    pub harmonics: u32,
    /// Samples of the environment at a hit, 0: no environment.
    pub environment_samples: u32,
}

impl Default for CurveOptions {
    fn default() -> Self {
        Self {
            field: Field::Resolved,
            visibility: Visibility::Estimated,
            harmonics: 8,
            environment_samples: 0,
        }
    }
}

/// One directional light: unit direction towards it in card space, irradiance across its beam (linear RGB).
pub type CurveLight = ([f64; 3], [f64; 3]);

/// Everything that shading a feather's curves needs.
pub struct CurveShader {
    fibres: [(Fibre, FibreTable); 4],
    /// Left and right.
    vanes: [query::Vane<f64>; 2],
    faces: [Vec<[f64; 4]>; 2],
    shares: [f64; 4],
    tint: [f64; 3],
    sheen: Sheen,
    dark_back: f64,
    curve: bevy_plumage::anatomy::FeatherMap,
    /// Where the vanes begin on the rachis.
    begin: f64,
    aspect: f64,
    /// How to shade.
    pub options: CurveOptions,
    /// The lights.
    pub lights: Vec<CurveLight>,
    /// Radiance from a unit direction in card space, used with `environment_samples`.
    pub environment: fn([f64; 3]) -> [f64; 3],
}

fn linear(byte: u8) -> f64 {
    let x = f64::from(byte) / 255.0;
    if x <= 0.04045 {
        x / 12.92
    } else {
        ((x + 0.055) / 1.055).powf(2.4)
    }
}

impl CurveShader {
    /// Prepares fibre tables and albedo. `tint`: the region color that a groom gives, linear RGB.
    pub fn new(feather: &Feather, tint: [f64; 3], options: CurveOptions) -> Self {
        let optics = &feather.optics;
        let share = feather.albedo.share;
        let bake = |pattern: &bevy_plumage::anatomy::Pattern| {
            pattern
                .bake(BAKE_WIDTH, BAKE_HEIGHT, feather)
                .chunks_exact(4)
                .map(|p| {
                    [
                        linear(p[0]),
                        linear(p[1]),
                        linear(p[2]),
                        f64::from(p[3]) / 255.0,
                    ]
                })
                .collect()
        };
        Self {
            fibres: [optics.rachis, optics.barb, optics.distal, optics.proximal]
                .map(|fibre| (fibre, FibreTable::build(&fibre))),
            vanes: Side::BOTH.map(|side| feather.query_vane(side)),
            faces: [
                bake(&feather.albedo.front),
                bake(feather.albedo.back_pattern()),
            ],
            shares: [share.rachis, share.barb, share.barbule, share.barbule].map(f64::from),
            tint,
            sheen: optics.sheen,
            dark_back: f64::from(u8::from(feather.albedo.back.is_none())),
            curve: feather.map(),
            begin: f64::from(feather.shape_table().start),
            aspect: f64::from(feather.aspect),
            options,
            lights: Vec::new(),
            environment: |_| [0.0; 3],
        }
    }

    /// Painted color at a point of card space seen from the front or the back, linear RGB.
    fn painted(&self, point: [f64; 3], front: bool) -> [f64; 3] {
        let face = &self.faces[usize::from(!front)];
        let (w, h) = (BAKE_WIDTH, BAKE_HEIGHT);
        let place = |x: f64, n: usize| {
            let x = (x * n as f64 - 0.5).clamp(0.0, (n - 1) as f64);
            let i = (x as usize).min(n - 2);
            (i, x - i as f64)
        };
        let (i, fi) = place(point[0] / self.aspect + 0.5, w);
        let (j, fj) = place(point[1], h);
        let texel: [f64; 4] = std::array::from_fn(|c| {
            let at = |i: usize, j: usize| face[j * w + i][c];
            let low = at(i, j) + (at(i + 1, j) - at(i, j)) * fi;
            let high = at(i, j + 1) + (at(i + 1, j + 1) - at(i, j + 1)) * fi;
            low + (high - low) * fj
        });
        std::array::from_fn(|c| texel[c] + (self.tint[c] - texel[c]) * texel[3])
    }

    /// Albedo of the fibre at a hit, seen along `direction`.
    pub fn albedo(&self, hit: &CurveHit, direction: [f64; 3]) -> [f64; 3] {
        let share = self.shares[hit.fibre.part as usize];
        self.painted(hit.point, direction[2] < 0.0)
            .map(|a| (a * share).min(0.98))
    }

    /// K's far field of the fibre at a hit, for an eye that looks along `direction`.
    pub fn prepare(
        &self,
        hit: &CurveHit,
        direction: [f64; 3],
        albedo: [f64; 3],
    ) -> FibreShading<f64> {
        let (_, table) = &self.fibres[hit.fibre.part as usize];
        let eye = fibre_local(hit.tangent, NORMAL, direction.map(|x| -x));
        let row = table.row((1.0 - eye[0] * eye[0]).max(0.0).sqrt());
        let p = table.fibre();
        let shading = fibre_shading(
            &p,
            &row,
            albedo,
            eye,
            self.dark_back,
            self.options.harmonics,
        );
        let vane = &self.vanes[usize::from(hit.fibre.side == Side::Right)];
        let frequency = grating_frequency(vane, direction[2] <= 0.0) / MEDULLA_PLACE.1;
        FibreShading {
            along: fibre_along(&p, &row, shading.absorption, frequency.powi(2)),
            ..shading
        }
    }

    /// What of the light from unit direction `to_light` reaches the fibre at a hit, seen from unit direction `eye`. `u`: uniform,
    /// picks the place on its width where light enters that leaves anywhere (traced shadows are 0 or 1). `turn`: cosine of the
    /// azimuth between eye and light around the fibre. `near`: of the place met, else of the whole width.
    pub fn reach(
        &self,
        curves: &Curves,
        hit: &CurveHit,
        [eye, to_light]: [[f64; 3]; 2],
        u: f64,
        turn: f64,
        near: bool,
    ) -> FibreReach<f64> {
        let whole = FibreReach::whole(turn);
        match self.options.visibility {
            Visibility::None => whole,
            Visibility::Estimated => {
                // The right vane is the left one mirrored.
                let right = hit.fibre.side == Side::Right;
                let vane = &self.vanes[usize::from(right)];
                let hooked = match hit.fibre.part {
                    Part::Rachis if hit.point[1] < self.begin => return whole,
                    Part::Rachis | Part::Barb => 1.0,
                    Part::Distal => hit.radius[0] / vane.r_bd.max(1e-12),
                    Part::Proximal => hit.radius[0] / vane.r_bp.max(1e-12),
                };
                let vane = vane.loosened(hooked);
                let [from, to] = [eye, to_light].map(|d| {
                    let x = if right { -d[0] } else { d[0] };
                    [x, d[1], d[2]]
                });
                let mirrors = [Part::Barb, Part::Distal]
                    .map(|part| mirror_place(&self.fibres[part as usize].1));
                let from = vane_eye(&vane, from, mirrors);
                let light = vane_shadow(&from, &vane_ray(&from, to))[hit.fibre.part as usize];
                FibreReach {
                    mirror: if near { light.lit } else { light.mirror },
                    even: light.even,
                    along: light.along,
                    place: if hit.fibre.part == Part::Rachis {
                        turn
                    } else {
                        light.place
                    },
                }
            }
            Visibility::Traced => {
                let lit = |origin: [f64; 3]| {
                    let ray = Ray {
                        origin,
                        direction: to_light,
                    };
                    f64::from(u8::from(!curves.blocked(&ray, skipped(hit.fibre))))
                };
                let place = mirror_place(&self.fibres[hit.fibre.part as usize].1);
                let rough = place.blur * (u - 0.5);
                FibreReach {
                    mirror: lit(mirror_point(hit, eye, to_light, place.retreat, rough)),
                    even: lit(lit_point(hit, to_light, 2.0 * u - 1.0)),
                    ..whole
                }
            }
        }
    }

    /// Radiance towards the eye, linear RGB: the lights, the environment, sheen. `direction`: unit, from the eye; `random`:
    /// uniform numbers 0..1 by index.
    pub fn radiance(
        &self,
        curves: &Curves,
        hit: &CurveHit,
        direction: [f64; 3],
        random: impl Fn(u32) -> f64,
    ) -> [f64; 3] {
        let eye = direction.map(|x| -x);
        let facing = [0.0, 0.0, eye[2].signum()];
        let ltc = sheen_lookup(eye[2].abs(), f64::from(self.sheen.roughness));
        let strength = f64::from(self.sheen.strength);
        let albedo = self.albedo(hit, direction);
        // The sheen has the color of the barbules.
        let share = self.shares[2];
        let tint = sheen_tint(
            self.painted(hit.point, direction[2] < 0.0)
                .map(|a| a * share),
        );
        let strongest = tint.iter().fold(0.0_f64, |m, t| m.max(*t));
        let base = 1.0 - sheen_albedo(ltc, strength) * strongest;
        let far = self.prepare(hit, direction, albedo);
        // Rachis and barb come first.
        let place = match self.options.field {
            Field::Resolved => (hit.fibre.part as usize) < 2,
            Field::Far => false,
            Field::Near => true,
        };
        let scatter = |to_light: [f64; 3], u: f64| {
            let local = |v| fibre_local(hit.tangent, NORMAL, v);
            let lobes = if place {
                let (fibre, table) = &self.fibres[hit.fibre.part as usize];
                let (eye, light) = (local(eye), local(to_light));
                near_field_lobes(fibre, table, albedo, eye, light, hit.offset, self.dark_back)
            } else {
                fibre_lobes(&far, local(to_light))
            };
            let reach = self.reach(curves, hit, [eye, to_light], u, lobes.turn, place);
            fibre_lit(&far, &lobes, &reach)
        };
        let mut sum = [0.0; 3];
        for (i, (to_light, irradiance)) in self.lights.iter().enumerate() {
            let k = scatter(*to_light, random(i as u32));
            let rim = strength * sheen_evaluate(ltc, facing, eye, *to_light);
            for c in 0..3 {
                sum[c] += irradiance[c] * (base * k[c] + rim * tint[c]);
            }
        }
        let n = self.options.environment_samples;
        for i in 0..n {
            let u = [0, 1, 2, 3].map(|k| random(4 * i + k + 8));
            let Some(sample) = fibre_sample(&far, u) else {
                continue;
            };
            let to_light = world(hit.tangent, sample.direction);
            let lobes = fibre_lobes(&far, sample.direction);
            let u = random(4 * i + 12);
            let reach = self.reach(curves, hit, [eye, to_light], u, lobes.turn, false);
            let k = fibre_lit(&far, &lobes, &reach);
            let light = (self.environment)(to_light);
            for c in 0..3 {
                sum[c] += base * k[c] / sample.pdf * light[c] / f64::from(n);
            }
        }
        sum
    }

    /// F_P's point of a card point: where the shaft is at that height, card space.
    pub fn shaft_x(&self, y: f64) -> f64 {
        (self.curve.curve(y).0 - 0.5) * self.aspect
    }
}

/// The card's normal in card space.
pub(crate) const NORMAL: [f64; 3] = [0.0, 0.0, 1.0];

/// A direction of the fibre's frame (see [`fibre_local`]) in card space.
pub(crate) fn world(tangent: [f64; 3], local: [f64; 3]) -> [f64; 3] {
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    axes.map(|axis| {
        let column = fibre_local(tangent, NORMAL, axis);
        (0..3).map(|i| column[i] * local[i]).sum()
    })
}

fn skipped(fibre: FibreId) -> FibreId {
    match fibre.part {
        Part::Rachis => FibreId {
            part: Part::Rachis,
            side: Side::Left,
            row: 0,
            place: 0,
        },
        _ => fibre,
    }
}
