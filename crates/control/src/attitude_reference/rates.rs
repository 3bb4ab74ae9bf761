//! Rates of the attitude reference.
//!
//! Flatness, Z-Y-X heading, with F = c b_z, jerk j, snap s, x_c and y_c the heading axes:
//!   p  = -(j . b_y)/c,   q = (j . b_x)/c,   c' = j . b_z                 (1)
//!   r  = (psi' b_x . x_c + q b_z . y_c)/(b_y . y_c)                      (2)
//!   p' = -(s . b_y + 2 c' p)/c + q r                                     (3)
//!   q' =  (s . b_x - 2 c' q)/c - p r                                     (4)
//!   r' = [psi'' b_x . x_c + 2 psi' (r b_y . x_c - q b_z . x_c)
//!         + q' b_z . y_c - p q b_y . y_c - p r b_z . y_c]/(b_y . y_c)    (5)
//! Backward difference of the law's own reference, R_d = R_(k-1)^T R_k:
//!   omega = vee(R_d - R_d^T)/(2 dt)                                      (6)
//!
//! Source: differentiating F and b_x = y_c x b_z; compare Faessler, Franchi and Scaramuzza, RA-L 2018.

use crate::filter::Clock;
use crate::math::{Body, Rotation, Vec3, World};
use crate::real::Real;
use crate::record::RecordExt as _;
use crate::signals::Thrust;
use crate::{choice, record};

choice! {
    /// Where the angular velocity of the attitude reference comes from.
    pub enum Rates {
        /// Zero, as the article has it.
        "none" => Zero,
        /// From the trajectory's jerk and snap, by differential flatness.
        "trajectory" => Trajectory,
        /// Backward difference of the commanded attitude, feedback included.
        "commanded" => Commanded,
    }
}

record! {
    /// The attitude reference of the previous tick.
    pub struct RateMemory {
        /// Previous reference, body to world.
        previous: Rotation<T, Body, World> [1];
        /// 1 once there is a previous reference.
        started: T [1];
        /// Time between two references.
        clock: Clock<T> [];
    }
}

impl<T: Real> RateMemory<T> {
    /// Takes the time between two references.
    #[inline(always)]
    pub fn tune(&mut self, dt: T) {
        self.clock.tune(dt);
    }

    /// Reciprocal of the time between two references, 1/s.
    #[inline(always)]
    pub fn per_step(&self) -> T {
        self.clock.per_step
    }

    /// Angular velocity and acceleration of the reference in its own axes.
    #[inline(always)]
    pub fn update(
        &mut self,
        source: Rates,
        rotation: &Rotation<T, Body, World>,
        thrust: &Thrust<T>,
    ) -> (Vec3<T, Body>, Vec3<T, Body>) {
        let (mut rate, mut acceleration) = (Vec3::zero(), Vec3::zero());
        match source {
            Rates::Zero => {}
            Rates::Trajectory => {
                for i in 0..T::PARTS {
                    let (omega, alpha) = flatness_rates(rotation.pick(i), &thrust.pick(i));
                    omega.put(&mut rate, i);
                    alpha.put(&mut acceleration, i);
                }
            }
            Rates::Commanded => {
                for i in 0..T::PARTS {
                    let omega = self.pick(i).difference(rotation.pick(i));
                    omega.put(&mut rate, i);
                }
            }
        }
        self.previous = *rotation;
        self.started = T::one();
        (rate, acceleration)
    }

    /// Backward difference of the attitude, in its own axes.
    #[inline(always)]
    fn difference(&self, rotation: Rotation<T, Body, World>) -> Vec3<T, Body> {
        let step = self.previous.inverse() * rotation;
        step.vector() * (T::lit(2.0) * step.w * self.started * self.clock.per_step) // (6)
    }
}

/// Angular velocity (1, 2) and acceleration (3-5) of an attitude along `thrust.force`, by flatness.
#[inline(always)]
pub fn flatness_rates<T: Real>(
    rotation: Rotation<T, Body, World>,
    thrust: &Thrust<T>,
) -> (Vec3<T, Body>, Vec3<T, Body>) {
    let two = T::lit(2.0);
    let (b_x, b_y, b_z): (Vec3<T, World>, _, _) =
        (rotation.x_axis(), rotation.y_axis(), rotation.z_axis());
    let (sin, cos) = thrust.yaw.sin_cos();
    let (x_c, y_c) = (Vec3::new(cos, sin, T::zero()), Vec3::new(-sin, cos, T::zero()));
    let (j, s) = (thrust.force_rate, thrust.force_acceleration);
    let per_c = T::one() / thrust.force.dot(b_z);
    let per_y = T::one() / b_y.dot(y_c);
    let (psi_dot, psi_ddot) = (thrust.yaw_rate, thrust.yaw_acceleration);

    let p = -j.dot(b_y) * per_c; // (1)
    let q = j.dot(b_x) * per_c;
    let c_dot = j.dot(b_z);
    let r = (psi_dot * b_x.dot(x_c) + q * b_z.dot(y_c)) * per_y; // (2)
    let p_dot = -(s.dot(b_y) + two * c_dot * p) * per_c + q * r; // (3)
    let q_dot = (s.dot(b_x) - two * c_dot * q) * per_c - p * r; // (4)
    let r_dot = (psi_ddot * b_x.dot(x_c)
        + two * psi_dot * (r * b_y.dot(x_c) - q * b_z.dot(x_c))
        + q_dot * b_z.dot(y_c)
        - p * q * b_y.dot(y_c)
        - p * r * b_z.dot(y_c))
        * per_y; // (5)
    (Vec3::new(p, q, r), Vec3::new(p_dot, q_dot, r_dot))
}
