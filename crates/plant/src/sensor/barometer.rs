//! Barometer: height, one number.
//!
//!   z = p_z + b + n                                                      (1)
//!   b' = -b/tau + noise,   b := phi b + drift sqrt(1 - phi^2) n,   phi = exp(-T/tau)   (2)
//!
//! with b the slow drift of the air pressure, of standard deviation `drift`, exact from sample to sample.
//! The filter takes it for noise that is new in every sample, and trusts the height too much for it.
//!
//! Source: Gelb, Applied Optimal Estimation (1974), the exponentially correlated variable.
//!
//! `latency` and `jitter` together are at most seven sampling periods.

use stormpetrel_control::estimator::Past;
use stormpetrel_control::real::Real;
use stormpetrel_control::record;

use super::link::Timing;
use super::{Draw, Rows, Sense, Truth};
use crate::vehicle::Vehicle;

record! {
    /// Numbers of the barometer.
    pub struct Gains {
        /// Samples a second.
        rate_hz: T [Hz] = 50.0, in 0.01 => 1e5;
        /// Time from sampling to arrival.
        latency: T [s] = 0.0, in 0.0 => 10.0;
        /// Largest additional time, evenly distributed.
        jitter: T [s] = 0.0, in 0.0 => 10.0;
        /// Share of samples that never arrive.
        dropout: T [1] = 0.0, in 0.0 => 1.0;
        /// Standard deviation of the noise.
        noise: T [m] = 0.1, in 1e-4 => 100.0;
        /// Standard deviation of the drift.
        drift: T [m] = 0.0, in 0.0 => 100.0;
        /// Correlation time of the drift, tau.
        drift_time: T [s] = 300.0, in 1e-2 => 1e6;
    }
}

/// No choices.
pub type Options = ();

record! {
    /// Barometer.
    pub struct Barometer {
        /// Numbers.
        gains: Gains<T> [];
        /// Drift now, b.
        offset: T [m];
    }
}

impl<T: Real> Barometer<T> {
    /// The sensor.
    pub fn new(gains: Gains<T>, _: Options, _: &Vehicle<T>) -> Self {
        Self { gains, ..Self::default() }
    }
}

impl<T: Real> Sense<T> for Barometer<T> {
    fn timing(&self) -> Timing<T> {
        let Gains { rate_hz, latency, jitter, dropout, .. } = self.gains;
        Timing { rate_hz, latency, jitter, dropout }
    }
    #[inline(always)]
    fn pairs(&self) -> u64 {
        1
    }
    fn begin(&mut self, _: &Truth<T>, [n, ..]: [T; 6]) {
        self.offset = self.gains.drift * n;
    }
    #[inline(always)]
    fn sample(&mut self, truth: &Truth<T>, draw: &Draw<T>) -> [T; 7] {
        let Gains { noise, drift, drift_time, .. } = self.gains;
        let [n0, n1, ..] = draw.normal;
        let phi = (-(draw.interval / drift_time)).exp();
        let offset = phi * self.offset + drift * (T::one() - phi.sq()).sqrt() * n1; // (2)
        self.offset = T::select(draw.due, offset, self.offset);
        let mut values = [T::zero(); 7];
        values[0] = truth.state.position.z + self.offset + noise * n0; // (1)
        values
    }
    #[inline(always)]
    fn rows(&self, sample: &[T; 7], past: &Past<T>) -> Rows<T> {
        let sigma = (self.gains.noise.sq() + self.gains.drift.sq()).sqrt();
        Rows::none().and([past.height(sample[0], sigma)])
    }
}
