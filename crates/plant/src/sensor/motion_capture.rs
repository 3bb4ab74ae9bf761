//! Motion capture: position, then attitude as a quaternion, seven numbers.
//!
//!   z = (p + n_p, R Exp(n_r))                                            (1)
//!
//! Source: usual camera systems; their errors between cameras are not modelled.
//!
//! `latency` and `jitter` together are at most seven sampling periods.

use stormpetrel_control::estimator::{Past, turn};
use stormpetrel_control::math::{Body, Rotation, Vec3};
use stormpetrel_control::real::Real;
use stormpetrel_control::record;

use super::link::Timing;
use super::{Draw, Rows, Sense, Truth};
use crate::vehicle::Vehicle;

record! {
    /// Numbers of the motion capture.
    pub struct Gains {
        /// Samples a second.
        rate_hz: T [Hz] = 100.0, in 0.01 => 1e5;
        /// Time from sampling to arrival.
        latency: T [s] = 0.005, in 0.0 => 10.0;
        /// Largest additional time, evenly distributed.
        jitter: T [s] = 0.0, in 0.0 => 10.0;
        /// Share of samples that never arrive.
        dropout: T [1] = 0.0, in 0.0 => 1.0;
        /// Standard deviation of each component of the position.
        position_noise: T [m] = 1e-3, in 1e-6 => 100.0;
        /// Standard deviation of the attitude about each axis.
        attitude_noise: T [rad] = 5e-3, in 1e-6 => 1.0;
    }
}

/// No choices.
pub type Options = ();

record! {
    /// Motion capture.
    pub struct MotionCapture {
        /// Numbers.
        gains: Gains<T> [];
    }
}

impl<T: Real> MotionCapture<T> {
    /// The sensor.
    pub fn new(gains: Gains<T>, _: Options, _: &Vehicle<T>) -> Self {
        Self { gains }
    }
}

impl<T: Real> Sense<T> for MotionCapture<T> {
    fn timing(&self) -> Timing<T> {
        let Gains { rate_hz, latency, jitter, dropout, .. } = self.gains;
        Timing { rate_hz, latency, jitter, dropout }
    }
    #[inline(always)]
    fn pairs(&self) -> u64 {
        3
    }
    #[inline(always)]
    fn sample(&mut self, truth: &Truth<T>, draw: &Draw<T>) -> [T; 7] {
        let Gains { position_noise, attitude_noise, .. } = self.gains;
        let [n0, n1, n2, n3, n4, n5] = draw.normal;
        let p = truth.state.position + Vec3::new(n0, n1, n2) * position_noise; // (1)
        let wrong: Vec3<T, Body> = Vec3::new(n3, n4, n5) * attitude_noise;
        let q = (truth.state.attitude * turn(wrong)).normalised();
        [p.x, p.y, p.z, q.w, q.x, q.y, q.z]
    }
    #[inline(always)]
    fn rows(&self, sample: &[T; 7], past: &Past<T>) -> Rows<T> {
        let [x, y, z, qw, qx, qy, qz] = *sample;
        let attitude = Rotation::from_quaternion(qw, qx, qy, qz);
        let sigma = Vec3::splat(self.gains.position_noise);
        Rows::none()
            .and(past.position(Vec3::new(x, y, z), sigma))
            .and(past.attitude(attitude, self.gains.attitude_noise))
    }
}
