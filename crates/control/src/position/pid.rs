//! PID position law with acceleration feed-forward and anti-windup.
//!
//!   e  = x - x_ref                                                      (1)
//!   f  = -Kp e - Ki S - Kd (v - v_ref) + a_ref                          (2)
//!   S' = e + k_aw (f_cmd - f_granted)                                   (3)
//!   F  = f + g e_z                                                      (4)
//!
//! | article | here       | unit    | frame |
//! |---------|------------|---------|-------|
//! | e1      | `e`        | m       | world |
//! | tau_f'  | `f`        | m/s^2   | world |
//! | int e1  | `integral` | m s     | world |
//!
//! The disturbance estimate of an observer is subtracted from F by the stack: law and observer
//! combine freely. (3) is back-calculation; only the part of the thrust that the allocation refused
//! enters, so a lagging motor does not count as saturation. Its sign is that of e = x - x_ref: thrust
//! that was asked for and refused must make the next request smaller.
//!
//! Source: the article, position control law; anti-windup after Astrom and Rundqwist (ACC 1989).
//! Valid for any attitude: the attitude levels make the thrust vector.

use crate::controller::Controller;
use crate::math::{Vec3, World};
use crate::real::Real;
use crate::record;
use crate::signals::{Measurement, Model, Thrust, Trajectory};

record! {
    /// Gains of the PID position law.
    pub struct Gains {
        /// Proportional gain Kp.
        kp: Vec3<T, World> [1/s^2] = 6.0, in 0.0 => 1e6;
        /// Integral gain Ki.
        ki: Vec3<T, World> [1/s^3] = 2.0, in 0.0 => 1e6;
        /// Derivative gain Kd.
        kd: Vec3<T, World> [1/s] = 4.0, in 0.0 => 1e6;
        /// Anti-windup gain k_aw: how fast refused thrust unloads the integral.
        anti_windup: T [s^2] = 0.0, in 0.0 => 1e3;
        /// Bound on each component of the integral.
        integral_limit: T [m s] = 1e6, in 0.0 => 1e6;
        /// Bound on each component of the specific thrust.
        limit: T [m/s^2] = 1e6, in 0.0 => 1e6;
    }
}

/// The law has no structural choices.
pub type Options = ();

record! {
    /// PID position law.
    pub struct Pid {
        /// Gains.
        gains: Gains<T> [];
        /// What the law believes of the vehicle.
        model: Model<T> [];
        /// Reciprocal mass, as the law believes it.
        per_mass: T [1/kg];
        /// Integral of the position error, S.
        integral: Vec3<T, World> [m s];
    }
}

impl<T: Real> Pid<T> {
    /// The law at rest.
    pub fn new(gains: Gains<T>, _: Options, model: &Model<T>) -> Self {
        Self { gains, model: *model, per_mass: T::one() / model.mass, integral: Vec3::zero() }
    }
}

impl<T: Real> Controller<T> for Pid<T> {
    type Reference = Trajectory<T>;
    type Command = Thrust<T>;

    #[inline(always)]
    fn update(
        &mut self,
        measurement: &Measurement<T>,
        reference: &Trajectory<T>,
        dt: T,
    ) -> Thrust<T> {
        let Gains { kp, ki, kd, anti_windup, integral_limit, .. } = self.gains;
        let e = measurement.position - reference.position; // (1)
        let e_dot = measurement.velocity - reference.velocity;
        let f = (reference.acceleration - self.integral.scale(ki)) - (e.scale(kp) + e_dot.scale(kd)); // (2)

        let refused = measurement.unallocated.thrust * self.per_mass;
        self.integral += (e + measurement.attitude.up(refused * anti_windup)) * dt; // (3)
        // In this order a sum that is not a number stays for the guard to see.
        self.integral = self.integral.map(|s| (-integral_limit).max(integral_limit.min(s)));

        Thrust {
            force: f + Vec3::up(self.model.gravity), // (4)
            force_rate: reference.jerk,
            force_acceleration: reference.snap,
            yaw: reference.yaw,
            yaw_rate: reference.yaw_rate,
            yaw_acceleration: reference.yaw_acceleration,
        }
    }

    fn reset(&mut self, _: &Measurement<T>) {
        // Prepared again, or a number broken in memory would break every command to come.
        self.per_mass = T::one() / self.model.mass;
        self.integral = Vec3::zero();
    }

    fn limit(&self) -> T {
        self.gains.limit
    }
}
