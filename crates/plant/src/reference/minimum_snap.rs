//! Through waypoints with the least snap, from rest to rest.
//!
//!   minimise sum over x, y, z, psi of the integral of (d^4/ds^4)^2       (1)
//!   subject to x(s_i) = waypoint i; speed, acceleration, jerk zero at both ends
//!
//! The solution is a polynomial of degree 7 between two waypoints, with continuous derivatives up to the
//! sixth at each. The phase s between two waypoints is their distance in m, where 1 rad of heading counts
//! as 1 m, so that a turn on the spot takes its time. The heading goes the short way from row to row.
//! The flight goes on at a constant pace p = ds/dt, the largest for which
//!   p V <= speed,  p^2 A <= acceleration,  p Y <= yaw_rate               (2)
//! where V, A, Y are the largest derivatives of the curve. After the last waypoint the vehicle rests.
//!
//! Two waypoints far apart beside two close together make the curve swing out between them; look at it
//! with `stormpetrel preview`.
//!
//! Source: Mellinger and Kumar, ICRA 2011; the solution for the free derivatives as in Richter, Bry and Roy,
//! ISRR 2013.

use stormpetrel_control::real::Real;
use stormpetrel_control::signals::Trajectory;
use stormpetrel_control::{columns, options, options::Rows, record};

use super::Refer;
use super::phase::until;
use super::piecewise::{Curve, Limits};
use crate::vehicle::Vehicle;

record! {
    /// Numbers of the flight through waypoints.
    pub struct Gains {
        /// Largest speed.
        speed: T [m/s] = 3.0, in 1e-3 => 1e3;
        /// Largest acceleration.
        acceleration: T [m/s^2] = 4.0, in 1e-3 => 1e3;
        /// Largest rate of the heading.
        yaw_rate: T [rad/s] = 2.0, in 1e-3 => 1e3;
    }
}

columns! {
    /// Points to fly through, with headings.
    pub struct Waypoints, 2 => 200 rows {
        x [m] in -1e6 => 1e6;
        y [m] in -1e6 => 1e6;
        z [m] in -1e6 => 1e6;
        yaw [rad] in -6.3 => 6.3;
    }
}

options! {
    /// What the flight goes through.
    pub struct Options {
        /// Points to fly through, with headings.
        waypoints: Rows<Waypoints>;
        /// The curve through them.
        curve: Curve;
    }
}

record! {
    /// Flight through waypoints.
    pub struct MinimumSnap {
        /// Numbers.
        gains: Gains<T> [];
        /// Phase per time, p.
        pace: T [1/s];
        structure {
            /// What the flight goes through.
            options: Options;
        }
    }
}

impl<T: Real> MinimumSnap<T> {
    /// The reference.
    pub fn new(gains: Gains<T>, options: Options, _: &Vehicle<T>) -> Self {
        let Gains { speed, acceleration, yaw_rate } = gains;
        let limits = Limits { speed, acceleration, yaw_rate };
        let pace = options.curve.pace(&limits, T::one(), T::zero()); // (2)
        Self { gains, pace, options }
    }
}

impl<T: Real> Refer<T> for MinimumSnap<T> {
    #[inline(always)]
    fn at(&self, time: T) -> Trajectory<T> {
        let curve = &self.options.curve;
        curve.at(until(time, self.pace, T::lit(curve.end())))
    }
}
