//! What wind does to a feather: moving air as value noise, and the angle by which it lifts a card. Twin of `wind.wgsl`;
//! amounts: docs/book/wind.md.

use super::{Real, clamp, real, vector};

/// Angle by which a soft feather turns about its root when it is ruffled as far as it goes, radians.
pub const RUFFLE_LIFT: f32 = 45.0 * std::f32::consts::PI / 180.0;
/// Yaw to either side of a feather ruffled as far as it goes, radians: 2 degrees where it is raised by 14.
pub const RUFFLE_YAW: f32 = 6.0 * std::f32::consts::PI / 180.0;

/// Share of a gust that small eddies make.
const EDDY_SHARE: f64 = 0.3;
/// A gust is this many eddies long.
const GUST_CELLS: f64 = 4.0;
/// Share of the opening that wind along the lay presses flat.
const PRESSING: f64 = 0.1;
/// Largest angle downwards over that upwards: the body is in the way.
const FLATTENING: f64 = 0.25;

/// The air over the whole world, every number in its range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Breeze<T> {
    /// Unit vector the air moves along.
    pub direction: [T; 3],
    /// Steady speed, m/s.
    pub speed: T,
    /// Speed that gusts add at most, m/s.
    pub gusts: T,
    /// Size of an eddy, metres.
    pub eddy: T,
    /// How often an eddy changes, 1/s.
    pub frequency: T,
}

/// How a feather of `stiffness` 0..1 answers the wind: (compliance in rad s^2 m^-2.5, largest angle of the tip in radians:
/// 14 degrees for the softest, 8 for a contour feather, 1.5 for a flight feather).
pub fn wind_response<T: Real>(stiffness: T) -> (T, T) {
    let s = clamp(stiffness, T::zero(), T::one());
    let limit = real::<T>(1.5) + real::<T>(12.5) * (T::one() - s) * (T::one() - s);
    (T::one().to_radians() / s.max(real(0.1)), limit.to_radians())
}

/// Integer hash (PCG, O'Neill 2014) of a lattice point, in [0, 1).
fn lattice_value<T: Real>(point: [i32; 3]) -> T {
    let [x, y, z] = point.map(|c| c as u32);
    let mixed =
        x.wrapping_add(1_664_525u32.wrapping_mul(y.wrapping_add(1_013_904_223u32.wrapping_mul(z))));
    let state = mixed.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    T::of(f64::from(((word >> 22) ^ word) >> 8)) / real(16_777_216.0)
}

/// Value noise in [0, 1), smooth, one lattice cell per unit.
pub fn value_noise<T: Real>(p: [T; 3]) -> T {
    let most = real::<T>(1e9);
    let base = p.map(T::floor);
    let i = base.map(|x| clamp(x, -most, most).to_i32().unwrap_or(0));
    let s = std::array::from_fn::<T, 3, _>(|k| {
        let f = p[k] - base[k];
        f * f * (real::<T>(3.0) - real::<T>(2.0) * f)
    });
    let mix = |a: T, b: T, t: T| a * (T::one() - t) + b * t;
    let edge = |y: i32, z: i32| {
        let at = |x: i32| lattice_value([i[0] + x, i[1] + y, i[2] + z]);
        mix(at(0), at(1), s[0])
    };
    mix(
        mix(edge(0, 0), edge(1, 0), s[1]),
        mix(edge(0, 1), edge(1, 1), s[1]),
        s[2],
    )
}

/// Velocity of the air at a place and time (seconds), m/s. Gusts travel with it.
pub fn wind_velocity<T: Real>(breeze: &Breeze<T>, position: [T; 3], time: T) -> [T; 3] {
    let travelled = (breeze.speed + real::<T>(0.5) * breeze.gusts) * time;
    let carried = vector::sub(position, vector::scale(breeze.direction, travelled));
    let eddy = carried.map(|x| x / breeze.eddy.max(real(1e-3)));
    let turned = [eddy[0], eddy[1] + breeze.frequency * time, eddy[2]];
    let gust = real::<T>(1.0 - EDDY_SHARE) * value_noise(eddy.map(|x| x / real(GUST_CELLS)))
        + real::<T>(EDDY_SHARE) * value_noise(turned);
    vector::scale(breeze.direction, breeze.speed + breeze.gusts * gust)
}

/// Angle in radians by which the tip of a feather lifts off (below 0: is pressed down), at most `limit` up and a quarter of it
/// down. Wind against the lay (`along`) opens the coat, wind along it presses it flat. `length` in metres, `wind` in m/s;
/// compliance and limit from [`wind_response`].
pub fn wind_lift<T: Real>(
    wind: [T; 3],
    along: [T; 3],
    normal: [T; 3],
    length: T,
    compliance: T,
    limit: T,
) -> T {
    let zero = T::zero();
    let against = vector::dot(along, wind);
    let under = vector::dot(normal, wind);
    let opening = (-against).max(zero) + under.max(zero);
    let pressing = against.max(zero) + (-under).max(zero);
    let drive = compliance
        * length.max(zero).sqrt()
        * (opening * opening - real::<T>(PRESSING) * pressing * pressing);
    let most = if drive < zero {
        real::<T>(FLATTENING) * limit
    } else {
        limit
    };
    most * drive / (most + drive.abs()).max(real(1e-9))
}

/// `v` turned about the axis of `turn` by its length in radians (Rodrigues).
pub fn turned_by<T: Real>(v: [T; 3], turn: [T; 3]) -> [T; 3] {
    let angle = vector::dot(turn, turn).sqrt();
    if angle < real(1e-7) {
        return v;
    }
    let axis = vector::scale(turn, T::one() / angle);
    let (sin, cos) = angle.sin_cos();
    let aside = vector::scale(vector::cross(axis, v), sin);
    let along = vector::scale(axis, vector::dot(axis, v) * (T::one() - cos));
    vector::add(vector::add(vector::scale(v, cos), aside), along)
}

#[cfg(test)]
mod tests {
    use super::*;

    const X: [f32; 3] = [1.0, 0.0, 0.0];
    const Z: [f32; 3] = [0.0, 0.0, 1.0];

    #[test]
    fn wind_against_the_lay_opens_and_never_past_the_limit() {
        for stiffness in [0.0f32, 0.3, 0.7, 1.0] {
            let (compliance, limit) = wind_response(stiffness);
            let mut last = 0.0;
            for speed in [0.5, 1.0, 3.0, 10.0, 40.0] {
                let lift = |speed| wind_lift([speed, 0.0, 0.0], X, Z, 0.04, compliance, limit);
                let open = lift(-speed);
                assert!(open > last && open < limit, "{stiffness} {speed}: {open}");
                let flat = lift(speed);
                assert!(flat < 0.0 && flat > -(FLATTENING as f32) * limit, "{flat}");
                last = open;
            }
        }
        // A contour feather of 40 mm in a gust of 3 m/s: a few degrees.
        let (compliance, limit) = wind_response(0.3f32);
        let lift = wind_lift([-3.0, 0.0, 0.0], X, Z, 0.04, compliance, limit);
        assert!((1.0..8.0).contains(&lift.to_degrees()), "{lift}");
    }
}
