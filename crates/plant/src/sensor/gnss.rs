//! Satellite navigation: position, then velocity, six numbers.
//!
//!   z = (p + n_p, v + n_v)                                               (1)
//!
//! White noise; the slow errors of real receivers (minutes) and multipath are not modelled.
//!
//! `latency` and `jitter` together are at most seven sampling periods.

use stormpetrel_control::estimator::Past;
use stormpetrel_control::math::{Vec3, World};
use stormpetrel_control::real::Real;
use stormpetrel_control::record;

use super::link::Timing;
use super::{Draw, Rows, Sense, Truth};
use crate::vehicle::Vehicle;

record! {
    /// Numbers of the satellite receiver.
    pub struct Gains {
        /// Samples a second.
        rate_hz: T [Hz] = 10.0, in 0.01 => 1e5;
        /// Time from sampling to arrival.
        latency: T [s] = 0.1, in 0.0 => 10.0;
        /// Largest additional time, evenly distributed.
        jitter: T [s] = 0.0, in 0.0 => 10.0;
        /// Share of samples that never arrive.
        dropout: T [1] = 0.0, in 0.0 => 1.0;
        /// Standard deviation of the horizontal components of the position.
        horizontal_noise: T [m] = 0.5, in 1e-4 => 1e3;
        /// Standard deviation of the height.
        vertical_noise: T [m] = 1.0, in 1e-4 => 1e3;
        /// Standard deviation of each component of the velocity.
        velocity_noise: T [m/s] = 0.05, in 1e-4 => 100.0;
    }
}

/// No choices.
pub type Options = ();

record! {
    /// Satellite navigation.
    pub struct Gnss {
        /// Numbers.
        gains: Gains<T> [];
    }
}

impl<T: Real> Gnss<T> {
    /// The sensor.
    pub fn new(gains: Gains<T>, _: Options, _: &Vehicle<T>) -> Self {
        Self { gains }
    }

    /// Standard deviations of position and velocity.
    #[inline(always)]
    fn sigma(&self) -> [Vec3<T, World>; 2] {
        let Gains { horizontal_noise, vertical_noise, velocity_noise, .. } = self.gains;
        let position = Vec3::new(horizontal_noise, horizontal_noise, vertical_noise);
        [position, Vec3::splat(velocity_noise)]
    }
}

impl<T: Real> Sense<T> for Gnss<T> {
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
        let [position, velocity] = self.sigma();
        let [n0, n1, n2, n3, n4, n5] = draw.normal;
        let p = truth.state.position + Vec3::new(n0, n1, n2).scale(position); // (1)
        let v = truth.state.velocity + Vec3::new(n3, n4, n5).scale(velocity);
        [p.x, p.y, p.z, v.x, v.y, v.z, T::zero()]
    }
    #[inline(always)]
    fn rows(&self, sample: &[T; 7], past: &Past<T>) -> Rows<T> {
        let [x, y, z, vx, vy, vz, _] = *sample;
        let [position, velocity] = self.sigma();
        Rows::none()
            .and(past.position(Vec3::new(x, y, z), position))
            .and(past.velocity(Vec3::new(vx, vy, vz), velocity))
    }
}
