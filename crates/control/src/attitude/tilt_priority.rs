//! Tilt-prioritised quaternion attitude law.
//!
//!   q_e = q^-1 (x) q_ref = (w, x, y, z),   N = sqrt(w^2 + z^2)           (1)
//!   tilt: (x_t, y_t) = (w x - y z, w y + x z)/N                          (2)
//!   yaw:  z_y = sign(w) z/N                                              (3)
//!   e = -2 (x_t, y_t, z_y)                                               (4)
//!   omega_des = R_e^T omega_ref - K1 e,  alpha = R_e^T alpha_ref - K_theta e   (5)
//!
//! with R_e = R_ref^T R. The thrust direction is corrected on the shortest way, whatever the yaw error
//! is. At exactly 180 deg of tilt (N = 0) the vehicle turns about its x axis.
//!
//! Source: Brescianini and D'Andrea, IEEE TCST 28 (2020) 498-509; K_theta as in the article.

use super::rate_command;
use crate::controller::Controller;
use crate::math::{Body, Rotation, Vec3};
use crate::real::Real;
use crate::record;
use crate::signals::{Attitude, Measurement, Model, Rate};

record! {
    /// Gains of the tilt-prioritised law.
    pub struct Gains {
        /// Angular velocity per attitude error, K1.
        k1: Vec3<T, Body> [1/s] = 8.0, in 0.0 => 1e6;
        /// Angular acceleration per attitude error, `K_theta`.
        k_theta: Vec3<T, Body> [1/s^2] = 0.0, in 0.0 => 1e6;
        /// Bound on the magnitude of rates and thrust.
        limit: T [1] = 1e6, in 0.0 => 1e6;
    }
}

/// The law has no structural choices.
pub type Options = ();

record! {
    /// Tilt-prioritised attitude law.
    pub struct TiltPriority {
        /// Gains.
        gains: Gains<T> [];
    }
}

impl<T: Real> TiltPriority<T> {
    /// The law; it has no state.
    pub fn new(gains: Gains<T>, _: Options, _: &Model<T>) -> Self {
        Self { gains }
    }
}

/// The attitude error (4) in body axes, from `q_e` (1).
#[inline(always)]
fn error<T: Real>(q_e: Rotation<T, Body, Body>) -> Vec3<T, Body> {
    let Rotation { w, x, y, z, .. } = q_e;
    let (minus_two, n_squared) = (T::lit(-2.0), w.sq() + z.sq());
    let upside_down = n_squared.lt(T::lit(1e-18));
    let k = minus_two.over_root(T::select(upside_down, T::one(), n_squared)); // -2/N
    Vec3::new(
        T::select(upside_down, minus_two, (w * x - y * z) * k), // (2)
        T::select(upside_down, T::zero(), (w * y + x * z) * k),
        (z * T::one().with_sign(w)) * k, // (3)
    )
}

impl<T: Real> Controller<T> for TiltPriority<T> {
    type Reference = Attitude<T>;
    type Command = Rate<T>;

    #[inline(always)]
    fn update(&mut self, measurement: &Measurement<T>, reference: &Attitude<T>, _: T) -> Rate<T> {
        let q_e = measurement.attitude.inverse() * reference.rotation; // (1)
        rate_command(error(q_e), self.gains.k1, self.gains.k_theta, q_e, reference) // (4, 5)
    }

    fn reset(&mut self, _: &Measurement<T>) {}

    fn limit(&self) -> T {
        self.gains.limit
    }
}
