//! A recorded or computed path: rows of time, position and heading, fitted.
//!
//!   minimise sum over the rows of (x(t_i) - x_i)^2,   x a spline of degree 5     (1)
//!   V = n R/(n - p)^2                                                            (2)
//!
//! The spline has continuous derivatives up to the fourth, so velocity to snap exist and are continuous:
//! they are those of the fit, never differences of rows. Its knots lie at equal numbers of rows; there are
//! as many (p coefficients, n rows, R the sum (1) of x, y, z) as make the generalised cross-validation (2)
//! least, so noise is smoothed and a clean path is followed. `stormpetrel check` prints the largest and the
//! root mean square distance of the fit from the rows. Headings that jump by a whole turn are unwrapped.
//!
//! Time zero is the first row. After the last row the vehicle is to rest there. A fit whose `ends` are free
//! stops with a jolt; `ends = "rest"` makes velocity, acceleration and jerk zero at both ends, where the
//! recording begins and ends at rest.
//!
//! Source: de Boor, A Practical Guide to Splines (2001), chapter 14; Craven and Wahba, Numerische Mathematik
//! 31 (1979) 377-403.

use stormpetrel_control::real::Real;
use stormpetrel_control::signals::Trajectory;
use stormpetrel_control::{choice, columns, options, options::Rows, record};

use super::Refer;
use super::phase::until;
use super::piecewise::Curve;
use crate::vehicle::Vehicle;

record! {
    /// Numbers of the recorded path.
    pub struct Gains {
        /// How many times as fast as recorded.
        pace: T [1] = 1.0, in 1e-3 => 1e3;
    }
}

columns! {
    /// A path over time.
    pub struct Recording, 8 => 100_000 rows, first grows {
        t [s] in -1e6 => 1e6;
        x [m] in -1e6 => 1e6;
        y [m] in -1e6 => 1e6;
        z [m] in -1e6 => 1e6;
        yaw [rad] in -1e6 => 1e6;
    }
}

choice! {
    /// How the fit begins and ends.
    pub enum Ends {
        /// As the rows say.
        "free" => Free,
        /// With velocity, acceleration and jerk zero.
        "rest" => Rest,
    }
}

options! {
    /// What is followed.
    pub struct Options {
        /// The path over time.
        rows: Rows<Recording>;
        /// How the fit begins and ends.
        ends: Ends;
        /// The fit.
        curve: Curve;
    }
}

record! {
    /// Recorded path.
    pub struct Table {
        /// Numbers.
        gains: Gains<T> [];
        structure {
            /// What is followed.
            options: Options;
        }
    }
}

impl<T: Real> Table<T> {
    /// The reference.
    pub fn new(gains: Gains<T>, options: Options, _: &Vehicle<T>) -> Self {
        Self { gains, options }
    }
}

impl<T: Real> Refer<T> for Table<T> {
    #[inline(always)]
    fn at(&self, time: T) -> Trajectory<T> {
        let curve = &self.options.curve;
        curve.at(until(time, self.gains.pace, T::lit(curve.end())))
    }
}
