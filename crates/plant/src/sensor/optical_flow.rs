//! Optical flow with a range finder: forward velocity, left velocity, height, three numbers.
//!
//!   z = (e_x.R'v + n, e_y.R'v + n, p_z + n_h)                            (1)
//!
//! The camera is taken to know its own turn and height; the ground is the plane z = 0.
//!
//! `latency` and `jitter` together are at most seven sampling periods.

use stormpetrel_control::estimator::Past;
use stormpetrel_control::real::Real;
use stormpetrel_control::record;

use super::link::Timing;
use super::{Draw, Rows, Sense, Truth};
use crate::vehicle::Vehicle;

record! {
    /// Numbers of the optical flow sensor.
    pub struct Gains {
        /// Samples a second.
        rate_hz: T [Hz] = 100.0, in 0.01 => 1e5;
        /// Time from sampling to arrival.
        latency: T [s] = 0.01, in 0.0 => 10.0;
        /// Largest additional time, evenly distributed.
        jitter: T [s] = 0.0, in 0.0 => 10.0;
        /// Share of samples that never arrive.
        dropout: T [1] = 0.0, in 0.0 => 1.0;
        /// Standard deviation of both velocities.
        velocity_noise: T [m/s] = 0.05, in 1e-4 => 100.0;
        /// Standard deviation of the height.
        height_noise: T [m] = 0.02, in 1e-4 => 100.0;
    }
}

/// No choices.
pub type Options = ();

record! {
    /// Optical flow with a range finder.
    pub struct OpticalFlow {
        /// Numbers.
        gains: Gains<T> [];
    }
}

impl<T: Real> OpticalFlow<T> {
    /// The sensor.
    pub fn new(gains: Gains<T>, _: Options, _: &Vehicle<T>) -> Self {
        Self { gains }
    }
}

impl<T: Real> Sense<T> for OpticalFlow<T> {
    fn timing(&self) -> Timing<T> {
        let Gains { rate_hz, latency, jitter, dropout, .. } = self.gains;
        Timing { rate_hz, latency, jitter, dropout }
    }
    #[inline(always)]
    fn pairs(&self) -> u64 {
        2
    }
    #[inline(always)]
    fn sample(&mut self, truth: &Truth<T>, draw: &Draw<T>) -> [T; 7] {
        let Gains { velocity_noise, height_noise, .. } = self.gains;
        let [n0, n1, n2, ..] = draw.normal;
        let v = truth.state.attitude.inverse() * truth.state.velocity;
        let height = truth.state.position.z + height_noise * n2; // (1)
        let (forward, left) = (v.x + velocity_noise * n0, v.y + velocity_noise * n1);
        [forward, left, height, T::zero(), T::zero(), T::zero(), T::zero()]
    }
    #[inline(always)]
    fn rows(&self, sample: &[T; 7], past: &Past<T>) -> Rows<T> {
        let [forward, left, height, ..] = *sample;
        Rows::none()
            .and(past.flow([forward, left], self.gains.velocity_noise))
            .and([past.height(height, self.gains.height_noise)])
    }
}
