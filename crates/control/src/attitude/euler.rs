//! Attitude law on the difference of Euler angles, as the article prints it.
//!
//!   e4 = Theta - Theta_ref                                               (1)
//!   omega_des = R_e^T omega_ref - K1 e4,  alpha = R_e^T alpha_ref - K_theta e4   (2)
//!
//! The article uses the angle difference as a vector in body axes, which holds near level only, and
//! does not wrap it: across +-180 deg the error jumps by a whole turn. `wrap = "turn"` takes the nearest
//! turn.
//!
//! Source: the article, attitude loop. Valid for small tilt.

use super::rate_command;
use crate::controller::Controller;
use crate::math::{Body, Euler, Rotation, Vec3, World};
use crate::real::Real;
use crate::signals::{Attitude, Measurement, Model, Rate};
use crate::{choice, options, record};

record! {
    /// Gains of the Euler-angle law; the defaults are the article's.
    pub struct Gains {
        /// Angular velocity per attitude error, K1.
        k1: Vec3<T, Body> [1/s] = 200.0, in 0.0 => 1e6;
        /// Angular acceleration per attitude error, `K_theta`.
        k_theta: Vec3<T, Body> [1/s^2] = 400.0, in 0.0 => 1e6;
        /// Bound on the magnitude of rates and thrust.
        limit: T [1] = 1e6, in 0.0 => 1e6;
    }
}

choice! {
    /// What becomes of a whole turn in the angle difference.
    pub enum Wrap {
        /// It stays, as printed.
        "none" => Keep,
        /// It is taken off: the error lies in -180..=180 deg.
        "turn" => Turn,
    }
}

options! {
    /// Choices of the Euler-angle law.
    pub struct Options {
        /// What becomes of a whole turn in the angle difference.
        wrap: Wrap;
    }
}

record! {
    /// Euler-angle attitude law.
    pub struct EulerError {
        /// Gains.
        gains: Gains<T> [];
        structure {
            /// Choices.
            options: Options;
        }
    }
}

impl<T: Real> EulerError<T> {
    /// The law; it has no state.
    pub fn new(gains: Gains<T>, options: Options, _: &Model<T>) -> Self {
        Self { gains, options }
    }
}

/// Differences of the Euler angles, roll, pitch and yaw, rad (1).
#[inline(always)]
pub fn difference<T: Real>(
    attitude: Rotation<T, Body, World>,
    reference: Rotation<T, Body, World>,
) -> Vec3<T, Body> {
    let (Euler { roll, pitch, yaw }, r) = (attitude.euler(), reference.euler());
    Vec3::new(roll - r.roll, pitch - r.pitch, yaw - r.yaw)
}

impl<T: Real> Controller<T> for EulerError<T> {
    type Reference = Attitude<T>;
    type Command = Rate<T>;

    #[inline(always)]
    fn update(&mut self, measurement: &Measurement<T>, reference: &Attitude<T>, _: T) -> Rate<T> {
        let e4 = difference(measurement.attitude, reference.rotation); // (1)
        let turn = T::lit(core::f64::consts::TAU);
        let e4 = match self.options.wrap {
            Wrap::Keep => e4,
            Wrap::Turn => e4.map(|a| a - (a / turn).round() * turn),
        };
        let to_body = measurement.attitude.inverse() * reference.rotation;
        rate_command(e4, self.gains.k1, self.gains.k_theta, to_body, reference) // (2)
    }

    fn reset(&mut self, _: &Measurement<T>) {}

    fn limit(&self) -> T {
        self.gains.limit
    }
}
