//! PID on the angular velocity, with the gyroscopic torque compensated.
//!
//!   nu  = alpha - K_omega (omega - omega_des) - K_i S,   S' = omega - omega_des   (1)
//!   tau = I nu + omega x I omega                                         (2)
//!
//! With the attitude law above it this is the PID attitude loop of the "standard PID": K_theta and K1
//! act on the angle, `K_omega` on the rate.
//!
//! Source: computed torque, e.g. Mellinger and Kumar, ICRA 2011. It needs the inertia and knows nothing
//! of a disturbance torque but what the integral finds.

use crate::controller::Controller;
use crate::math::{Body, Vec3};
use crate::real::Real;
use crate::record;
use crate::signals::{Measurement, Model, Rate, Wrench};

record! {
    /// Gains of the PID rate law.
    pub struct Gains {
        /// Angular acceleration per rate error, `K_omega`.
        k_omega: Vec3<T, Body> [1/s] = 25.0, in 0.0 => 1e6;
        /// Angular acceleration per integral of the rate error, `K_i`.
        k_i: Vec3<T, Body> [1/s^2] = 0.0, in 0.0 => 1e6;
        /// Bound on each component of the integral.
        integral_limit: T [rad] = 1e6, in 0.0 => 1e6;
        /// Bound on the magnitude of thrust and torque.
        limit: T [1] = 1e6, in 0.0 => 1e6;
    }
}

/// The law has no structural choices.
pub type Options = ();

record! {
    /// PID rate law.
    pub struct Pid {
        /// Gains.
        gains: Gains<T> [];
        /// What the law believes of the vehicle.
        model: Model<T> [];
        /// Integral of the rate error, S.
        integral: Vec3<T, Body> [rad];
    }
}

impl<T: Real> Pid<T> {
    /// The law at rest.
    pub fn new(gains: Gains<T>, _: Options, model: &Model<T>) -> Self {
        Self { gains, model: *model, integral: Vec3::zero() }
    }
}

impl<T: Real> Controller<T> for Pid<T> {
    type Reference = Rate<T>;
    type Command = Wrench<T>;

    #[inline(always)]
    fn update(&mut self, measurement: &Measurement<T>, reference: &Rate<T>, dt: T) -> Wrench<T> {
        let Gains { k_omega, k_i, integral_limit, .. } = self.gains;
        let omega = measurement.rate;
        let e_omega = omega - reference.rate;
        let nu = reference.acceleration - e_omega.scale(k_omega) - self.integral.scale(k_i); // (1)
        self.integral += e_omega * dt;
        self.integral = self.integral.map(|s| s.clamp(-integral_limit, integral_limit));
        let momentum = omega.scale(self.model.inertia);
        Wrench {
            thrust: reference.thrust,
            torque: nu.scale(self.model.inertia) + omega.cross(momentum), // (2)
        }
    }

    fn reset(&mut self, _: &Measurement<T>) {
        self.integral = Vec3::zero();
    }

    fn limit(&self) -> T {
        self.gains.limit
    }
}
