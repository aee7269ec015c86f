//! The frequency domain (Chen et al. 2026, Sec. 5.3): each family of stripes as a sum over the harmonics of its stripes (`k_g`)
//! and of the window between two barbs (`k_q`), the overlap of the two barbule families as the double sum over both.

use bevy_plumage::maths::functions::{Real, cosine_turns, sine_turns, wrap};
use bevy_plumage::maths::query::vane::{Cell, Local};

/// Where the sums are cut off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Orders {
    /// Largest `|k_g|`, harmonics of the stripes, 0..16.
    pub stripes: i32,
    /// Largest `|k_q|`, harmonics of the window, 0..32.
    pub window: i32,
}

/// Coefficient `m` of a train of stripes that covers the share `f`.
fn stripe_coefficient<T: Real>(m: i32, f: T) -> T {
    if m == 0 {
        return f;
    }
    let m = T::of(f64::from(m));
    sine_turns(T::of(0.5) * m * f) / (T::of(core::f64::consts::PI) * m)
}

/// `sin(pi x) / (pi x)`.
fn sinc<T: Real>(x: T) -> T {
    if x.abs() < T::of(1e-3) {
        return T::one();
    }
    sine_turns(T::of(0.5) * x) / (T::of(core::f64::consts::PI) * x)
}

/// `[barb, upper, lower]` coverage by Eq. 23-25.
///
/// The overlap multiplies the two families' series inside one window, which is the convolution of their spectra with the sum
/// over the second window done: kinder than the printed pairwise sum, whose windows would have to be truncated twice.
pub fn frequency<T: Real>(cell: &Cell<T>, local: &Local<T>, orders: Orders) -> [T; 3] {
    let half = T::of(0.5);
    let stripes = orders.stripes.clamp(0, 16);
    let window = orders.window.clamp(0, 32);
    let open = cell.v_high - cell.v_low;
    let middle = half * (cell.v_low + cell.v_high);
    let (f_d, f_p) = (cell.h_d + cell.h_d, cell.h_p + cell.h_p);
    // Phase shifts of the two families from one gap to the next (delta_g of Eq. 22).
    let shift_d = wrap(cell.kappa - cell.e_root);
    let shift_p = wrap(cell.kappa + cell.e_root);
    // One node: frequency (P, q) of (u, tau); `x` is that of the pattern inside the window.
    let node = |x: T, climb: T, q: i32, phase: T| {
        let p = climb - x;
        let q = T::of(f64::from(q));
        let along = p + local.slope * q;
        let damping =
            T::of(-19.739_208_8) * (local.variance * along * along + local.conditional * q * q);
        let turns = wrap(p * local.u) + wrap(q * local.tau) + wrap(x * middle) - phase;
        damping.exp() * open * sinc(x * open) * cosine_turns(turns)
    };
    let mut barb = T::one() - open;
    let mut upper = T::zero();
    let mut lower = T::zero();
    for order in -window..=window {
        let turn = T::of(f64::from(order));
        if order != 0 {
            barb = barb - node(turn, T::zero(), 0, T::zero());
        }
        for m in -stripes..=stripes {
            let mt = T::of(f64::from(m));
            let a = stripe_coefficient(m, f_d);
            let b = stripe_coefficient(m, f_p);
            // Eq. 24 for the distal and for the whole proximal family.
            upper = upper + a * node(-turn - mt * shift_d, -mt * cell.kappa, m, mt * cell.s_d);
            lower = lower
                + b * node(
                    mt * shift_p - turn,
                    mt * cell.kappa,
                    m,
                    mt * (cell.kappa + cell.e_root + cell.s_p),
                );
            // Eq. 25.
            for n in -stripes..=stripes {
                let nt = T::of(f64::from(n));
                let c = a * stripe_coefficient(n, f_p);
                let phase = mt * cell.s_d + nt * (cell.kappa + cell.e_root + cell.s_p);
                let x = nt * shift_p - mt * shift_d - turn;
                lower = lower - c * node(x, (nt - mt) * cell.kappa, m + n, phase);
            }
        }
    }
    [barb, upper, lower]
}
