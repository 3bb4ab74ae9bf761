//! Rotor telemetry: the speed of each rotor, four numbers.
//!
//!   z = round((w + n)/q) q                                               (1)
//!
//! Source: the messages of usual motor controllers, which count electrical turns.
//!
//! `latency` and `jitter` together are at most seven sampling periods.

use stormpetrel_control::real::Real;
use stormpetrel_control::record;
use stormpetrel_control::record::from_index;

use super::link::Timing;
use super::triad::stepped;
use super::{Draw, Sense, Truth};
use crate::vehicle::Vehicle;

record! {
    /// Numbers of the rotor telemetry.
    pub struct Gains {
        /// Samples a second.
        rate_hz: T [Hz] = 500.0, in 0.01 => 1e5;
        /// Time from sampling to arrival.
        latency: T [s] = 0.0, in 0.0 => 10.0;
        /// Largest additional time, evenly distributed.
        jitter: T [s] = 0.0, in 0.0 => 10.0;
        /// Share of samples that never arrive.
        dropout: T [1] = 0.0, in 0.0 => 1.0;
        /// Standard deviation of the noise.
        noise: T [rad/s] = 2.0, in 0.0 => 1e4;
        /// Smallest step between two values, q; 0 for none.
        resolution: T [rad/s] = 1.0, in 0.0 => 1e3;
    }
}

/// No choices.
pub type Options = ();

record! {
    /// Rotor telemetry.
    pub struct RotorSpeed {
        /// Numbers.
        gains: Gains<T> [];
    }
}

impl<T: Real> RotorSpeed<T> {
    /// The sensor.
    pub fn new(gains: Gains<T>, _: Options, _: &Vehicle<T>) -> Self {
        Self { gains }
    }
}

impl<T: Real> Sense<T> for RotorSpeed<T> {
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
        let Gains { noise, resolution, .. } = self.gains;
        let speed: [T; 4] = from_index(|i| {
            stepped(truth.state.rotor_speed[i] + noise * draw.normal[i], resolution) // (1)
        });
        let [a, b, c, d] = speed;
        [a, b, c, d, T::zero(), T::zero(), T::zero()]
    }
}
