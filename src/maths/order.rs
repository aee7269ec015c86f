//! How far behind the nearest feather another one may lie and still be seen, because it lies over it in the coat's order.

use super::functions::{Real, clamp, real, smooth_step};

/// Depth within which a feather comes before the nearest, in the unit of `window`. `window`: the same where it is widest; `facing`:
/// cosine between the eye and the front face; `along`: share of the length, 0 at the root.
///
/// None on back faces: from below the nearest is the right one. None at the root, which lies in the skin.
pub fn order_reach<T: Real>(window: T, facing: T, along: T) -> T {
    let front = clamp(real::<T>(8.0) * facing, T::zero(), T::one());
    window * front * smooth_step(real(0.05), real(0.3), along)
}

/// Window of meshes that keep none, widths of a feather.
pub const UNSETTLED_WINDOW: f32 = 0.1;
/// Widest window of a vertex, widths of a feather.
pub const WINDOW_MOST: f32 = 0.5;
/// Steps of a window, the wider the wider it is: a window is the square of its step.
pub const WINDOW_STEPS: u16 = 7;
/// Window of a feather that wind or ruffle has turned by [`STIRRED_ANGLE`], widths: what was settled is in order no more.
pub const STIRRED_WINDOW: f32 = 0.3;
/// Turn, radians, from which that window is open.
pub const STIRRED_ANGLE: f32 = 0.1;
/// Steps of how far a feather is held down.
pub const HELD_STEPS: u16 = 3;
/// Largest height as it is kept.
pub const RAISED_MOST: i16 = 1023;

/// What a vertex keeps for the poses that its coat was settled in: heights in the further poses over the first, -1..1 in their unit,
/// and windows, widths of a feather: in the first pose, in the others, and on the way from one to another; and how far, 0..1, it is held
/// down in the first pose by stiffer feathers.
///
/// The low 11 bits of each word are a height, the next three the window of its pose; bit 14 of the first three words are the window of
/// the first pose, bit 15 that of the ways between; the high bits of the last say how far it is held.
pub fn raised_pack(heights: [f32; 4], windows: [f32; 6], held: f32) -> [u16; 4] {
    let steps = windows.map(|window| {
        let share = (window / WINDOW_MOST).clamp(0.0, 1.0);
        (f32::from(WINDOW_STEPS) * share.sqrt() - 1.0e-4).ceil() as u16
    });
    let held = (held.clamp(0.0, 1.0) * f32::from(HELD_STEPS)).round() as u16;
    std::array::from_fn(|k| {
        let height = (heights[k].clamp(-1.0, 1.0) * f32::from(RAISED_MOST)).round() as i16;
        let bits = match k {
            3 => held << 14,
            _ => (steps[0] >> k & 1) << 14 | (steps[5] >> k & 1) << 15,
        };
        (height + RAISED_MOST + 1) as u16 | steps[k + 1] << 11 | bits
    })
}

/// The heights of [`raised_pack`].
pub fn raised_heights<T: Real>(words: [u16; 4]) -> [T; 4] {
    words.map(|word| {
        let height = (word & 0x7ff) as i16 - RAISED_MOST - 1;
        real::<T>(f64::from(height)) / real(f64::from(RAISED_MOST))
    })
}

/// Steps of all windows of [`raised_pack`], in its order.
fn window_steps(words: [u16; 4]) -> [u16; 6] {
    let bits = |at: usize| {
        let bit = |k: usize| (words[k] >> at & 1) << k;
        bit(0) | bit(1) | bit(2)
    };
    let [a, b, c, d] = words.map(|word| word >> 11 & 7);
    [bits(14), a, b, c, d, bits(15)]
}

fn window_of<T: Real>(steps: u16) -> T {
    let share = real::<T>(f64::from(steps)) / real(f64::from(WINDOW_STEPS));
    real::<T>(f64::from(WINDOW_MOST)) * share * share
}

/// What a vertex keeps between two others of a card, `share` of the way from the one to the other, or beyond it.
pub fn raised_between(from: [u16; 4], to: [u16; 4], share: f32) -> [u16; 4] {
    let between = |from: f32, to: f32| from + (to - from) * share;
    let (low, high) = (raised_heights::<f32>(from), raised_heights(to));
    let steps = (window_steps(from), window_steps(to));
    // To the nearest step: a window that were widened with every move would not stay.
    let window = |k: usize| {
        let window = between(window_of(steps.0[k]), window_of(steps.1[k]));
        let step = (window / WINDOW_MOST).clamp(0.0, 1.0).sqrt() * f32::from(WINDOW_STEPS);
        window_of::<f32>(step.round() as u16)
    };
    raised_pack(
        std::array::from_fn(|k| between(low[k], high[k])),
        std::array::from_fn(window),
        raised_held(to, [0.0; 4]),
    )
}

/// The window of [`raised_pack`], widths of a feather. `shares`: what the bird wears of the poses after the first; `between`: how far it
/// is on the way from one to another, 0..1.
pub fn raised_window<T: Real>(words: [u16; 4], shares: [T; 4], between: T) -> T {
    let [first, further @ .., ways] = window_steps(words);
    let rest = T::one() - (shares[0] + shares[1] + shares[2] + shares[3]);
    let parts = further.into_iter().zip(shares);
    let own = parts.fold(window_of::<T>(first) * rest, |sum, (steps, share)| {
        sum + window_of::<T>(steps) * share
    });
    own.max(window_of::<T>(ways) * between)
}

/// The widest of all windows of [`raised_pack`], widths of a feather.
pub fn raised_widest<T: Real>(words: [u16; 4]) -> T {
    window_of(window_steps(words).into_iter().fold(0, u16::max))
}

/// How far, 0..1, the feather of [`raised_pack`] is held down by stiffer ones over it. `shares`: of the poses after the first.
pub fn raised_held<T: Real>(words: [u16; 4], shares: [T; 4]) -> T {
    let rest = T::one() - (shares[0] + shares[1] + shares[2] + shares[3]);
    real::<T>(f64::from(words[3] >> 14)) / real(f64::from(HELD_STEPS)) * rest
}

/// The window of a feather that wind and ruffle have turned by `angle`, radians. `window`: of the feather at rest.
pub fn stirred_window<T: Real>(window: T, angle: T) -> T {
    let open = (angle / real(f64::from(STIRRED_ANGLE))).min(T::one());
    window.max(real::<T>(f64::from(STIRRED_WINDOW)) * open)
}
