//! The short form of a fibre: round, and what does not depend on color or light taken out when a feather is packed. FAR cards take all
//! eight terms of the series, MEAN cards four. The same lobes as [`fibre_lobes`](super::fibre_lobes), less those of which no light is
//! left ([`FibreTable::is_plain`]); color enters last, one channel at a time. Twin of `scattering_short.wgsl`.

use super::{
    FIBRE_HARMONICS, FIBRE_ROWS, FibreReach, FibreRow, FibreTable, Lobe, LongitudinalSpread,
    flat::ROUND,
    shading::{FIRST_BLUR, TWICE_SILHOUETTE, damped},
};
use crate::maths::functions::{Real, clamp, real};
use std::f64::consts::PI;

/// Terms of the series that MEAN cards take.
pub const MEAN_COSINES: usize = 4;
/// vec4s before the rows of a table.
///
/// | vec4 | contents |
/// |---|---|
/// | 0 | R: sine and cosine of the shift, one over the squared roughness, what makes the integral 1/2 pi |
/// | 1 | the same of TT (pigment) or TRcT (structural) |
/// | 2 | of the color y inside, `a/(1 - f) - f/(1 - f)` for the lowest albedo f: constant and factor; exponent and factor of its absorption |
/// | 3 | 1: structural, share c of round trips head on, half width of the edge of a dark back |
pub const SHORT_HEAD_VEC4S: usize = 4;
/// vec4s in one row; rows are those of [`FibreTable`].
///
/// | vec4 | pigment | structural |
/// |---|---|---|
/// | 0 | energy of R, TT, medulla; m1 | energy of R, TRcT, 0; share c of round trips |
/// | 1 | t and k of TT and of the medulla | |
/// | 2 | medulla: both terms; how fast light forgets its place around and along the fibre, times t | |
/// | 3 | four terms of R | R |
/// | 4 | of TT without absorption | TRcT |
/// | 5 | of TT at absorption 2 | |
/// | 6 to 11 | eight terms of the same | |
///
/// Terms are damped. What is not an energy itself is multiplied with that of its lobe, so rows are mixed linearly and an empty lobe
/// does not pull the shape of its neighbor.
pub const SHORT_ROW_VEC4S: usize = 12;
/// vec4s of a step from one row to the next: a row, and how the next one differs from it.
pub const SHORT_STEP_VEC4S: usize = 2 * SHORT_ROW_VEC4S;
/// vec4s of a table.
pub const SHORT_TABLE_VEC4S: usize = SHORT_HEAD_VEC4S + (FIBRE_ROWS - 1) * SHORT_STEP_VEC4S;

/// Energy of a lobe below which it is left out.
const LEAST_ENERGY: f64 = 1e-3;
/// Least t of a law of absorption: below it the law is an exponential, and single precision loses it.
const LEAST_T: f64 = 0.01;

/// One row.
pub type ShortRow<T> = [[T; 4]; SHORT_ROW_VEC4S];
/// What a level of detail reads of a row: energies, laws, medulla, and eight terms of each series.
pub type ShortTerms<T> = [[T; 4]; 9];

/// Everything about a fibre and the eye that the lights and colors of a pixel share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShortShading<T> {
    /// Energies of R, of TT or TRcT, and of the medulla, before color.
    pub energy: [T; 3],
    /// Terms of R, TT or TRcT, and the dense TT.
    pub series: [[T; FIBRE_HARMONICS]; 3],
    /// Medulla: both terms, and the slope in the sine of the light's inclination.
    pub medulla: [T; 3],
    /// Sine and cosine of the eye's inclination: R; TT or TRcT.
    pub eye: [(T, T); 2],
    /// Of the same.
    pub spread: [LongitudinalSpread<T>; 2],
    /// Azimuth of the eye.
    pub azimuth: [T; 2],
    /// Half width of the transition to the dark back, and how dark the back is.
    pub back: [T; 2],
    /// Has a mirror core.
    pub structural: bool,
    /// Color inside a fibre by its albedo: constant and factor; exponent and factor of its absorption.
    pub absorption: [T; 4],
    /// Least and largest color inside.
    pub range: [T; 2],
    /// t and k of TT, or the shares of round trips of a mirror core head on and here.
    pub through: [T; 2],
    /// t and k of the medulla; how fast light forgets its place around and along the fibre, times t.
    pub inside: [T; 4],
}

/// K of one light before color; see [`ShortShading`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShortLobes<T> {
    /// R.
    pub surface: T,
    /// TT or TRcT.
    pub clear: T,
    /// TT of a dense fibre.
    pub thick: T,
    /// Medulla.
    pub scattered: T,
    /// Cosine of the azimuth between eye and light.
    pub turn: T,
}

/// What one channel of the color makes of a fibre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShortColor<T> {
    /// Factor on TT or TRcT.
    pub second: T,
    /// Factor on the medulla's light.
    pub scattered: T,
    /// How far TT goes from the clear to the dense shape.
    pub dense: T,
    /// How much of the medulla's light remembers where it entered, around the fibre and along it.
    pub around: T,
    /// See [`Self::around`].
    pub along: T,
}

impl FibreTable {
    /// Whether R, the medulla and one more lobe are all there is of a round fibre: TRT has no light, nor TT beside a mirror core.
    pub fn is_plain(&self) -> bool {
        let p = self.fibre();
        let dark = |lobe: Lobe| self.rows.iter().all(|r| r[0][lobe as usize] < LEAST_ENERGY);
        p.aspect >= ROUND && dark(Lobe::TRT) && (!p.structural || dark(Lobe::TT))
    }

    /// For the GPU: what `scattering_short.wgsl` reads, [`SHORT_TABLE_VEC4S`] vec4s.
    pub fn pack_short(&self) -> Vec<[f32; 4]> {
        let all = self.short_head().into_iter().chain(self.short_steps());
        all.map(|v| v.map(|x| x as f32)).collect()
    }

    /// The rows as [`short_row_step`] reads them: [`SHORT_STEP_VEC4S`] vec4s for each step.
    pub fn short_steps(&self) -> Vec<[f64; 4]> {
        let rows: Vec<_> = self.rows.iter().map(|row| self.short_row(row)).collect();
        let steps = rows.windows(2).flat_map(|pair| {
            let change =
                std::array::from_fn(|v| std::array::from_fn(|i| pair[1][v][i] - pair[0][v][i]));
            let step: [ShortRow<f64>; 2] = [pair[0], change];
            step.into_iter().flatten()
        });
        steps.collect()
    }

    /// The vec4s before the rows.
    pub fn short_head(&self) -> [[f64; 4]; SHORT_HEAD_VEC4S] {
        let p = self.fibre();
        let lobe = |lobe: Lobe| {
            let at = lobe as usize;
            let (sine, cosine) = p.shift[at];
            let LongitudinalSpread { inverse, scale } = p.spread[at];
            [sine, cosine, inverse, 0.5 / PI * scale]
        };
        let second = if p.structural { Lobe::TRcT } else { Lobe::TT };
        let t = p.color_t.max(LEAST_T);
        let exponent = if p.color_kt > 1e-6 {
            t / p.color_kt
        } else {
            0.0
        };
        [
            lobe(Lobe::R),
            lobe(second),
            [
                -p.fresnel / (1.0 - p.fresnel),
                1.0 / (1.0 - p.fresnel),
                -exponent,
                1.0 / t,
            ],
            [
                f64::from(u8::from(p.structural)),
                p.round_trips,
                p.azimuthal_roughness,
                0.0,
            ],
        ]
    }

    /// A row of [`FibreTable::rows`] as MEAN cards read it.
    pub fn short_row(&self, row: &FibreRow<f64>) -> ShortRow<f64> {
        let p = self.fibre();
        let mut out = [[0.0; 4]; SHORT_ROW_VEC4S];
        let mut put = |series: usize, at: usize, energy: f64| {
            for (first, count) in [
                (3 + series, MEAN_COSINES),
                (6 + 2 * series, FIBRE_HARMONICS),
            ] {
                let blur = p.azimuthal_roughness.max(FIRST_BLUR / count as f64);
                let terms = damped(row, at, blur, count as u32);
                for (n, term) in terms.iter().enumerate().take(count) {
                    out[first + n / 4][n % 4] = energy * term;
                }
            }
        };
        let [surface, through, _, fourth] = row[0];
        put(0, 5, surface);
        if p.structural {
            put(1, 3, fourth);
            out[0] = [surface, fourth, 0.0, fourth * row[2][0]];
            return out;
        }
        put(1, 7, through);
        put(2, 9, through);
        let law = |kt: f64, t: f64| {
            let t = t.max(LEAST_T);
            [t, kt / t]
        };
        let [t, k] = law(row[1][0], row[1][1]);
        let [medulla_t, medulla_k] = law(row[2][0], row[2][1]);
        let slope = clamp(4.0 * row[3][0], -1.0, 1.0);
        let medulla = [
            2.0 * row[2][2],
            2.0 * row[2][3],
            row[3][1] * medulla_t,
            row[3][2] * medulla_t,
        ];
        out[0] = [surface, through, fourth, fourth * slope];
        out[1] = [
            through * t,
            through * k,
            fourth * medulla_t,
            fourth * medulla_k,
        ];
        out[2] = medulla.map(|x| fourth * x);
        out
    }
}

/// A row and a share of how the next one differs from it; `fine`: with eight terms.
pub fn short_row_step<T: Real>(
    row: &ShortRow<T>,
    change: &ShortRow<T>,
    fraction: T,
    fine: bool,
) -> ShortTerms<T> {
    let mix = |v: usize| std::array::from_fn(|i| row[v][i] + change[v][i] * fraction);
    let mut out = [[T::zero(); 4]; 9];
    for (i, v) in out.iter_mut().enumerate() {
        match i {
            0..3 => *v = mix(i),
            _ if fine => *v = mix(i + 3),
            3 | 5 | 7 => *v = mix((i + 3) / 2),
            _ => {}
        }
    }
    out
}

/// Prepares a fibre for the lights and colors of one pixel; see [`fibre_shading`](super::fibre_shading).
pub fn short_shading<T: Real>(
    head: &[[T; 4]; SHORT_HEAD_VEC4S],
    row: &ShortTerms<T>,
    omega_o: [T; 3],
    dark_back: T,
) -> ShortShading<T> {
    let (zero, one) = (T::zero(), T::one());
    let ((sine, cosine), azimuth) = short_polar(omega_o);
    let eye = [head[0], head[1]]
        .map(|[s, c, _, _]| (sine * c - cosine * s, (cosine * c + sine * s).abs()));
    let spread =
        [head[0], head[1]].map(|[_, _, inverse, scale]| LongitudinalSpread { inverse, scale });
    let structural = head[3][0] > real(0.5);
    let forward = if sine < zero { -one } else { one };
    let [_, second, fourth, last] = row[0];
    let per = |energy: T| one / energy.max(real(1e-9));
    let per_last = per(if structural { second } else { fourth });
    let last = last * per_last;
    let (through, inside) = if structural {
        ([head[3][1], last], [zero; 4])
    } else {
        (
            [row[1][0], row[1][1]].map(|x| x * per(second)),
            [row[1][2], row[1][3], row[2][2], row[2][3]].map(|x| x * per_last),
        )
    };
    ShortShading {
        energy: [row[0][0], row[0][1], row[0][2]],
        series: [3, 5, 7].map(|v| std::array::from_fn(|n| row[v + n / 4][n % 4])),
        medulla: [row[2][0], row[2][1], last * forward],
        eye,
        spread,
        azimuth,
        back: [head[3][2], clamp(dark_back, zero, one)],
        structural,
        absorption: head[2],
        range: [
            head[2][1] * real(0.002),
            head[2][1] * real(0.995) + head[2][0],
        ],
        through,
        inside,
    }
}

/// Sine and cosine of a direction's inclination, and its azimuth. Moved by a millionth, so that there is an azimuth along the fibre.
fn short_polar<T: Real>([x, y, z]: [T; 3]) -> ((T, T), [T; 2]) {
    let z = z + real(1e-6);
    let across = y * y + z * z;
    let per = T::one() / across.max(real(1e-20)).sqrt();
    ((x, across * per), [y * per, z * per])
}

/// `exp(-x) I_0(x)` for x >= 0, within 4e-6 of itself (docs/book/fits/special_functions.py).
fn short_bessel<T: Real>(x: T) -> T {
    let below = [
        0.012_265_066_4,
        0.016_213_450_3,
        0.110_501_287,
        0.284_803_712,
        0.342_285_443,
        1.0,
    ];
    let above = [
        0.077_063_684_7,
        0.082_528_150_5,
        0.666_583_47,
        1.497_924_71,
        2.475_136_68,
        2.341_925_82,
        1.0,
    ];
    let [below, above] =
        [&below[..], &above].map(|list| list.iter().fold(T::zero(), |sum, k| sum * x + real(*k)));
    (below / above).sqrt()
}

/// [`longitudinal_with`](super::longitudinal_with).
fn short_longitudinal<T: Real>(eye: (T, T), light: (T, T), spread: LongitudinalSpread<T>) -> T {
    let (ds, dc) = (light.0 + eye.0, light.1 - eye.1);
    let chord = ds * ds + dc * dc;
    short_bessel(light.1 * eye.1 * spread.inverse)
        * (chord * (real::<T>(-0.5) * spread.inverse)).exp()
        * spread.scale
}

/// One channel of light that met further fibres, where a fibre keeps `kept` of the energy `scattered` and `strength` times the rest
/// meets another one: spread and cone of [`multiple_scattering`](super::multiple_scattering) of the chance
/// `strength (1 - kept / scattered)`.
pub fn short_again<T: Real>(scattered: T, kept: T, strength: T, parallel: T) -> [T; 2] {
    let (zero, one) = (T::zero(), T::one());
    let all = scattered.min(one);
    let lost = (strength * (scattered - kept).max(zero)).min(all * real(0.99));
    let cone = one / (one - parallel * lost);
    let later = real::<T>(0.5) * lost + real::<T>(0.25) * all;
    let spread = lost * (all - later) / (one - later) - (all - lost) * (cone - one);
    [spread, cone]
}

/// One channel of a fibre's color. `frequency`: see [`fibre_along`](super::fibre_along), 0 where no shadow lies along the fibre.
pub fn short_color<T: Real>(s: &ShortShading<T>, albedo: T, frequency: T) -> ShortColor<T> {
    let (zero, one) = (T::zero(), T::one());
    let [least, rise, exponent, per_t] = s.absorption;
    let y = clamp(albedo * rise + least, s.range[0], s.range[1]);
    let mut color = ShortColor {
        second: zero,
        scattered: zero,
        dense: zero,
        around: zero,
        along: zero,
    };
    if s.structural {
        // Core and round trips in one fraction.
        let [head_on, here] = s.through;
        color.second = y * (one - here) / (one - head_on + (head_on - here) * y);
        return color;
    }
    let grown = (y.log2() * exponent).min(real(86.0)).exp2();
    let sigma = ((grown - one) * per_t).min(real(1e4));
    let [t, k] = s.through;
    let [medulla_t, medulla_k, around, along] = s.inside;
    color.dense = ((sigma + sigma) / (real::<T>(2.0) + sigma)).min(real(1.3));
    color.second = (-k * (one + sigma * t).log2()).exp2();
    let paths = one + sigma * medulla_t;
    let before = paths.log2();
    color.scattered = (-medulla_k * before).exp2();
    let memory = |rate: T| (medulla_k * (before - (paths + rate).log2())).exp2();
    color.around = memory(around) * real(TWICE_SILHOUETTE);
    if frequency > zero {
        let left = memory(along);
        color.along = left / (left + frequency * (one - left)).max(real(1e-6));
    }
    color
}

/// K for light from `omega_i` before color; see [`fibre_lobes`](super::fibre_lobes).
pub fn short_lobes<T: Real>(s: &ShortShading<T>, omega_i: [T; 3]) -> ShortLobes<T> {
    let (zero, one, two) = (T::zero(), T::one(), real::<T>(2.0));
    let (light, azimuth) = short_polar(omega_i);
    let o = s.azimuth;
    let turn = o[0] * azimuth[0] + o[1] * azimuth[1];
    let density = |energy: T, terms: &[T; FIBRE_HARMONICS]| {
        let (mut sum, mut now, mut before) = (energy, turn, one);
        for term in terms {
            sum = sum + *term * now;
            (now, before) = (two * turn * now - before, now);
        }
        sum
    };
    let m = |i: usize| short_longitudinal(s.eye[i], light, s.spread[i]);
    let surface = density(s.energy[0], &s.series[0]).max(zero) * m(0);
    let clear = density(s.energy[1], &s.series[1]);
    let second = m(1);
    if s.structural {
        let raw = [o[0] + azimuth[0], o[1] + azimuth[1]];
        let square = raw[0] * raw[0] + raw[1] * raw[1];
        let half = if square > real(1e-12) {
            raw[1] / square.sqrt()
        } else {
            -o[0]
        };
        let b = s.back[0];
        let x = clamp((half + b) / (b + b), zero, one);
        let lit = x * x * (real::<T>(3.0) - x - x);
        return ShortLobes {
            surface,
            clear: clear.max(zero) * second * (one + (lit - one) * s.back[1]),
            thick: zero,
            scattered: zero,
            turn,
        };
    }
    let [first, twice, slope] = s.medulla;
    let scattered = (s.energy[2] + first * turn + twice * (two * turn * turn - one)).max(zero)
        * light.1
        * (one + slope * light.0).max(zero)
        * real(1.0 / (PI * PI));
    ShortLobes {
        surface,
        clear: clear * second,
        thick: density(s.energy[1], &s.series[2]) * second,
        scattered,
        turn,
    }
}

/// K of one channel, of a fibre among others; see [`fibre_lit`](super::fibre_lit).
pub fn short_lit<T: Real>(
    s: &ShortShading<T>,
    color: &ShortColor<T>,
    lobes: &ShortLobes<T>,
    reach: &FibreReach<T>,
) -> T {
    let (zero, one) = (T::zero(), T::one());
    if s.structural {
        return reach.mirror * (lobes.surface + color.second * lobes.clear);
    }
    let share = (reach.even + reach.along * color.along).max(zero);
    let around = (one + color.around * reach.place).max(zero)
        / (one + color.around * lobes.turn).max(real(0.1));
    let through = (lobes.clear + (lobes.thick - lobes.clear) * color.dense).max(zero);
    reach.mirror * lobes.surface
        + (share * around).min(one + one)
            * (color.second * through + color.scattered * lobes.scattered)
}
