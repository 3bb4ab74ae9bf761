//! Straight line from rest to rest, limited in speed, acceleration and jerk.
//!
//! The distance s along the line has seven segments of constant jerk: +j, 0, -j, 0, -j, 0, +j. With
//! L = |B - A| and the limits v, a, j the durations are
//!   t_j = min(cbrt(L/(2 j)), sqrt(v/j), a/j)                             (1)
//!   t_a = min((sqrt(t_j^2 + 4 L/(j t_j)) - 3 t_j)/2, v/(j t_j) - t_j)    (2)
//!   t_v = L/(j t_j (t_j + t_a)) - (2 t_j + t_a)                          (3)
//! of constant jerk, constant acceleration and constant speed. While it speeds up,
//!   s = j/6 (t^3 - pos(t - t_j)^3 - pos(t - t_j - t_a)^3)                (4)
//! with pos(x) = max(x, 0); the braking is its mirror image, s(t) = L - s(T - t), T = 4 t_j + 2 t_a + t_v.
//!
//! Jerk is constant in each segment and jumps between them; the snap is zero inside and does not exist at
//! the jumps, where zero is given. After T the vehicle rests at B.
//!
//! Source: Lambrechts, Boerlage and Steinbuch, Control Engineering Practice 13 (2005) 145-157, third order.

use stormpetrel_control::math::{Vec3, World};
use stormpetrel_control::real::Real;
use stormpetrel_control::record;
use stormpetrel_control::signals::Trajectory;

use super::Refer;
use crate::vehicle::Vehicle;

record! {
    /// Numbers of the line.
    pub struct Gains {
        /// Beginning, A.
        from: Vec3<T, World> [m] = 0.0, in -1e6 => 1e6;
        /// End, B.
        to: Vec3<T, World> [m] = 1.0, in -1e6 => 1e6;
        /// Largest speed.
        speed: T [m/s] = 2.0, in 1e-3 => 1e3;
        /// Largest acceleration.
        acceleration: T [m/s^2] = 3.0, in 1e-3 => 1e3;
        /// Largest jerk.
        jerk: T [m/s^3] = 10.0, in 1e-3 => 1e6;
        /// Heading.
        yaw: T [rad] = 0.0, in -6.3 => 6.3;
    }
}

/// No choices.
pub type Options = ();

record! {
    /// Straight line.
    pub struct Line {
        /// Numbers.
        gains: Gains<T> [];
        /// Length of the line, L.
        length: T [m];
        /// Duration of each segment of constant jerk, t_j.
        jerking: T [s];
        /// Duration of each segment of constant acceleration, t_a.
        speeding: T [s];
        /// Duration of the segment of constant speed, t_v.
        cruising: T [s];
    }
}

/// Stands in for a divisor of zero where the line has no length.
const TINY: f64 = 1e-30;

impl<T: Real> Line<T> {
    /// The reference.
    pub fn new(gains: Gains<T>, _: Options, _: &Vehicle<T>) -> Self {
        let (v, a, j) = (gains.speed, gains.acceleration, gains.jerk);
        let (zero, tiny) = (T::zero(), T::lit(TINY));
        let length = (gains.to - gains.from).norm();
        let t_j = (length / (T::lit(2.0) * j)).cbrt().min((v / j).sqrt()).min(a / j); // (1)
        let peak = (j * t_j).max(tiny);
        let by_length = (t_j.sq() + T::lit(4.0) * length / peak).sqrt() - T::lit(3.0) * t_j;
        let t_a = by_length.half().min(v / peak - t_j).max(zero); // (2)
        let rise = T::lit(2.0) * t_j + t_a;
        let t_v = (length / (peak * (t_j + t_a)).max(tiny) - rise).max(zero); // (3)
        Self { gains, length, jerking: t_j, speeding: t_a, cruising: t_v }
    }

    /// Duration of the whole motion, T in s.
    pub fn duration(&self) -> T {
        T::lit(4.0) * self.jerking + T::lit(2.0) * self.speeding + self.cruising
    }

    /// Distance, speed, acceleration and jerk `t` seconds after the start, in the first half.
    #[inline(always)]
    fn rise(&self, t: T) -> [T; 4] {
        let (j, t_j, zero) = (self.gains.jerk, self.jerking, T::zero());
        let end = T::lit(2.0) * t_j + self.speeding;
        let flat = end.le(t);
        let t_1 = t.min(end);
        let t_2 = (t_1 - t_j).max(zero);
        let t_3 = (t_1 - t_j - self.speeding).max(zero);
        let speed = j.half() * (t_1.sq() - t_2.sq() - t_3.sq());
        let cubes = t_1.sq() * t_1 - t_2.sq() * t_2 - t_3.sq() * t_3;
        let on = |t: T| T::select(zero.lt(t), j, zero);
        [
            j * T::lit(1.0 / 6.0) * cubes + speed * (t - t_1), // (4)
            speed,
            T::select(flat, zero, j * (t_1 - t_2 - t_3)),
            T::select(flat, zero, on(t_1) - on(t_2) - on(t_3)),
        ]
    }
}

impl<T: Real> Refer<T> for Line<T> {
    #[inline(always)]
    fn at(&self, time: T) -> Trajectory<T> {
        let Gains { from, to, yaw, .. } = self.gains;
        let late = self.duration().half().lt(time);
        let mirrored = T::select(late, self.duration() - time, time).max(T::zero());
        let [s, v, a, j] = self.rise(mirrored);
        let per = T::one() / self.length.max(T::lit(TINY));
        let (along, s) = (to - from, s * per);
        Trajectory {
            // From the nearer end, so that the vehicle rests exactly at B.
            position: Vec3::select(late, to - along * s, from + along * s),
            velocity: along * (v * per),
            acceleration: along * (T::select(late, -a, a) * per),
            jerk: along * (j * per),
            yaw,
            ..Trajectory::default()
        }
    }
}
