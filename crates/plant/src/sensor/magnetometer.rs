//! Magnetometer: the magnetic field in body axes, three numbers.
//!
//!   z = R'm + n                                                          (1)
//!
//! The filter takes the heading from it. Fields of the vehicle itself are not modelled. The field by
//! default is that of middle latitudes in the north.
//!
//! `latency` and `jitter` together are at most seven sampling periods.

use stormpetrel_control::estimator::Past;
use stormpetrel_control::math::{Body, Vec3, World};
use stormpetrel_control::real::Real;
use stormpetrel_control::record;

use super::link::Timing;
use super::{Draw, Rows, Sense, Truth};
use crate::vehicle::Vehicle;

record! {
    /// Numbers of the magnetometer.
    pub struct Gains {
        /// Samples a second.
        rate_hz: T [Hz] = 100.0, in 0.01 => 1e5;
        /// Time from sampling to arrival.
        latency: T [s] = 0.0, in 0.0 => 10.0;
        /// Largest additional time, evenly distributed.
        jitter: T [s] = 0.0, in 0.0 => 10.0;
        /// Share of samples that never arrive.
        dropout: T [1] = 0.0, in 0.0 => 1.0;
        /// Standard deviation of each component.
        noise: T [T] = 3e-7, in 1e-10 => 1.0;
        /// Field to the east.
        east: T [T] = 0.0, in -1.0 => 1.0;
        /// Field to the north.
        north: T [T] = 2e-5, in -1.0 => 1.0;
        /// Field upwards.
        up: T [T] = -4.5e-5, in -1.0 => 1.0;
    }
}

/// No choices.
pub type Options = ();

record! {
    /// Magnetometer.
    pub struct Magnetometer {
        /// Numbers.
        gains: Gains<T> [];
    }
}

impl<T: Real> Magnetometer<T> {
    /// The sensor.
    pub fn new(gains: Gains<T>, _: Options, _: &Vehicle<T>) -> Self {
        Self { gains }
    }

    /// The field, m.
    #[inline(always)]
    fn field(&self) -> Vec3<T, World> {
        Vec3::new(self.gains.east, self.gains.north, self.gains.up)
    }
}

impl<T: Real> Sense<T> for Magnetometer<T> {
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
        let [n0, n1, n2, ..] = draw.normal;
        let noise: Vec3<T, Body> = Vec3::new(n0, n1, n2) * self.gains.noise;
        let z = truth.state.attitude.inverse() * self.field() + noise; // (1)
        [z.x, z.y, z.z, T::zero(), T::zero(), T::zero(), T::zero()]
    }
    #[inline(always)]
    fn rows(&self, sample: &[T; 7], past: &Past<T>) -> Rows<T> {
        let [x, y, z, ..] = *sample;
        Rows::none().and([past.heading(Vec3::new(x, y, z), self.field(), self.gains.noise)])
    }
}
