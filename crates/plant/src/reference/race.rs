//! Laps of a closed track through gates, from rest in the first gate to rest in the first gate.
//!
//!   minimise sum over x, y, z, psi of the integral of (d^4/ds^4)^2       (1)
//!   subject to x(s_i) = centre of gate i, x'(s_i) = (cos yaw_i, sin yaw_i, 0), closed
//!
//! Each gate is passed in its centre, level, along its heading. The curve is a polynomial of degree 7
//! between two gates, with continuous derivatives up to the fifth. The phase s between two gates is their
//! distance in m, so the derivative by s in the gates is a unit vector: the vehicle passes all at one speed.
//! The vehicle's heading is that of the gates, the short way from gate to gate.
//!   s(t) = p phi(t),   phi' from 0 to 1 in the first `ramp` seconds, back in the last   (2)
//!   p V <= speed,  (p phi')^2 A + p phi'' V <= acceleration,  p Y <= yaw_rate           (3)
//! where V, A, Y are the largest derivatives of the curve. The ramps of start and end do not overlap: p is
//! less if they would.
//!
//! The width of the gates does not change the path; `stormpetrel preview` draws them.
//!
//! Source: as for `minimum-snap`, with given velocities at the joints.

use stormpetrel_control::real::Real;
use stormpetrel_control::signals::Trajectory;
use stormpetrel_control::{columns, options, options::Rows, record};

use super::Refer;
use super::phase::{Jet, from_rest};
use super::piecewise::{Curve, Limits};
use crate::vehicle::Vehicle;

record! {
    /// Numbers of the race.
    pub struct Gains {
        /// Largest speed.
        speed: T [m/s] = 5.0, in 1e-3 => 1e3;
        /// Largest acceleration.
        acceleration: T [m/s^2] = 6.0, in 1e-3 => 1e3;
        /// Largest rate of the heading.
        yaw_rate: T [rad/s] = 4.0, in 1e-3 => 1e3;
        /// Laps to fly.
        laps: T [count] = 1.0, in 1.0 => 1e6;
        /// Time from rest to full pace, and from full pace to rest.
        ramp: T [s] = 2.0, in 0.1 => 1e3;
        /// Width and height of a gate, for drawings.
        gate: T [m] = 1.0, in 1e-2 => 1e2;
    }
}

columns! {
    /// Centres and headings of the gates, in the order of passing.
    pub struct Gates, 2 => 200 rows {
        x [m] in -1e6 => 1e6;
        y [m] in -1e6 => 1e6;
        z [m] in -1e6 => 1e6;
        yaw [rad] in -6.3 => 6.3;
    }
}

options! {
    /// The track.
    pub struct Options {
        /// Centres and headings of the gates, in the order of passing.
        gates: Rows<Gates>;
        /// The closed curve through them.
        curve: Curve;
    }
}

record! {
    /// Race.
    pub struct Race {
        /// Numbers.
        gains: Gains<T> [];
        /// Phase per time at full pace, p.
        pace: T [1/s];
        structure {
            /// The track.
            options: Options;
        }
    }
}

/// Points of the ramp at which (3) is asked; between them it is broken by less than the margin of V and A.
const RAMP_POINTS: u32 = 64;

impl<T: Real> Race<T> {
    /// The reference.
    pub fn new(gains: Gains<T>, options: Options, _: &Vehicle<T>) -> Self {
        let Gains { speed, acceleration, yaw_rate, laps, ramp, .. } = gains;
        let limits = Limits { speed, acceleration, yaw_rate };
        let curve = &options.curve;
        let mut pace = laps * T::lit(curve.end()) / ramp;
        for i in 0..=RAMP_POINTS {
            let time = ramp * T::lit(f64::from(i) / f64::from(RAMP_POINTS));
            let [_, share, change, ..] = from_rest(time, ramp);
            pace = pace.min(curve.pace(&limits, share, change)); // (3)
        }
        Self { gains, pace, options }
    }

    /// Duration of all laps, s.
    pub fn duration(&self) -> T {
        self.gains.laps * T::lit(self.options.curve.end()) / self.pace + self.gains.ramp
    }

    /// Phase of all laps (2): the last half is the first one backwards.
    #[inline(always)]
    fn phase(&self, time: T) -> Jet<T> {
        let (p, duration) = (self.pace, self.duration());
        let late = duration.half().lt(time);
        let time = T::select(late, duration - time, time).max(T::zero());
        let [s, w, w1, w2, w3] = from_rest(time, self.gains.ramp);
        let all = self.gains.laps * T::lit(self.options.curve.end());
        let mirror = |x: T| T::select(late, -(p * x), p * x);
        [T::select(late, all - p * s, p * s), p * w, mirror(w1), p * w2, mirror(w3)]
    }
}

impl<T: Real> Refer<T> for Race<T> {
    #[inline(always)]
    fn at(&self, time: T) -> Trajectory<T> {
        let curve = &self.options.curve;
        let lap = T::lit(curve.end());
        let [all, w, w1, w2, w3] = self.phase(time);
        let laps = (all / lap).floor();
        let within = (all - laps * lap).max(T::zero());
        let mut at = curve.at([within, w, w1, w2, w3]);
        at.yaw += laps * T::lit(curve.turn);
        at
    }
}
