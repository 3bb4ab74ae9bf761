//! The state at the time of a delayed sample, and what a measurement of it says of the state now.
//!
//!   p_d = p - tau v + tau^2/2 a,   v_d = v - tau a,   R_d = R Exp(-tau w)                    (1)
//!
//! with a and w the means over the last tau seconds. To first order in the errors of the state now,
//! with f the specific force that belongs to a (Body):
//!
//!   dp_d = dp - tau dv + tau^2/2 da,   dv_d = dv - tau da,   da = -R (f x dtheta) - R db_a   (2)
//!   dtheta_d = dtheta + tau w x dtheta + tau db_g                                            (3)
//!
//! so a measurement with the gradients (g_p, g_v, g_theta) at that time has the gradients now
//!
//!   h_p = g_p,   h_v = g_v - tau g_p,   h_theta = g_theta + tau g_theta x w + k x f,
//!   h_bg = tau g_theta,   h_ba = k,   k = R'(tau g_v - tau^2/2 g_p)                          (4)
//!
//! There is no buffer of past states. The means are exponential ones whose mean age is tau/2, the
//! middle of the interval. Left out are tau^3/12 of the jerk in p_d, tau^3/12 of its derivative
//! in v_d, and tau^3/12 (|w''| + |w x w'|) in R_d: with 0.1 s, 20 m/s^3 and 100 m/s^4, 2 mm and
//! 8 mm/s; with 10 ms and 1000 rad/s^3, 0.1 mrad. In (3) it is second order in tau |w|. A sample whose age
//! differs from the one that the means are for (jitter) adds half of the difference times tau times
//! the jerk to v_d.
//!
//! Source: the chain rule on the equations of [`eskf`](super::eskf).

use crate::math::{Body, Rotation, Vec3, World};
use crate::real::Real;
use crate::record;

use super::covariance::ErrorState;

record! {
    /// Means of acceleration and rate over the time for which a sensor's samples are under way.
    pub struct Lag {
        /// Mean acceleration.
        acceleration: Vec3<T, World> [m/s^2];
        /// Mean angular velocity.
        rate: Vec3<T, Body> [rad/s];
    }
}

impl<T: Real> Lag<T> {
    /// Takes the means over the last tick, `dt` seconds, for samples of this age in s. Means of single
    /// ticks have the mean age dt/2, the exponential mean adds (1/k - 1) dt.
    #[inline(always)]
    pub fn update(&mut self, tick: &Self, age: T, dt: T) {
        let k = (T::lit(2.0) * dt / (age + dt)).clamp(T::zero(), T::one());
        // Without delay the means are never asked for.
        let k = T::select(T::zero().lt(age), k, T::zero());
        self.acceleration += (tick.acceleration - self.acceleration) * k;
        self.rate += (tick.rate - self.rate) * k;
    }
}

record! {
    /// The state `age` seconds ago.
    pub struct Past {
        /// Position then.
        position: Vec3<T, World> [m];
        /// Velocity then.
        velocity: Vec3<T, World> [m/s];
        /// Attitude then.
        attitude: Rotation<T, Body, World> [1];
        /// How long ago, tau.
        age: T [s];
        /// Attitude now.
        now: Rotation<T, Body, World> [1];
        /// Mean angular velocity since, w.
        rate: Vec3<T, Body> [rad/s];
        /// Mean specific force since, f.
        specific_force: Vec3<T, Body> [m/s^2];
    }
}

record! {
    /// A scalar measurement, linear in the errors of the state: residual = gradient . error + noise.
    pub struct Row {
        /// Derivative by each error, h.
        gradient: ErrorState<T> [];
        /// Measured less predicted.
        residual: T [];
        /// Variance of the noise.
        variance: T [];
    }
}

impl<T: Real> Past<T> {
    /// The row of a measurement with the gradients `position`, `velocity`, `attitude` then (4).
    #[inline(always)]
    pub fn row(
        &self,
        [position, velocity]: [Vec3<T, World>; 2],
        attitude: Vec3<T, Body>,
        residual: T,
        sigma: T,
    ) -> Row<T> {
        let tau = self.age;
        let k = self.now.inverse() * (velocity * tau - position * (tau.sq().half()));
        let gradient = ErrorState {
            position,
            velocity: velocity - position * tau,
            attitude: attitude + attitude.cross(self.rate) * tau + k.cross(self.specific_force),
            gyro_bias: attitude * tau,
            accelerometer_bias: k,
        };
        Row { gradient, residual, variance: sigma.sq() }
    }
}
