//! Accelerometer in the centre of mass: specific force in body axes, three numbers.
//!
//!   z = round((y + b + noise/sqrt(T) n)/q) q,   within +-range            (1)
//!   y' = 2 pi `cutoff_hz` (f + vibration s - y),   b += walk sqrt(T) n     (2)
//!
//! with b the bias, q the resolution, T the time between two samples, n independent standard normal
//! numbers and s the shaking of the rotors, in squares of their speeds. (2) is stepped exactly.
//!
//! Source: IEEE Std 952 for the error terms. The numbers by default are those of a small MEMS sensor.
//!
//! `latency` and `jitter` together are at most seven sampling periods.

use stormpetrel_control::real::Real;
use stormpetrel_control::record;

use super::link::Timing;
use super::triad::{Errors, Triad};
use super::{Draw, Moment, Sense, Truth};
use crate::vehicle::Vehicle;

record! {
    /// Numbers of the accelerometer.
    pub struct Gains {
        /// Samples a second.
        rate_hz: T [Hz] = 1000.0, in 0.1 => 1e5;
        /// Time from sampling to arrival.
        latency: T [s] = 0.0, in 0.0 => 10.0;
        /// Largest additional time, evenly distributed.
        jitter: T [s] = 0.0, in 0.0 => 10.0;
        /// Share of samples that never arrive; the last one is held.
        dropout: T [1] = 0.0, in 0.0 => 1.0;
        /// Density of the white noise.
        noise: T [m/s^2/sqrt(Hz)] = 2e-3, in 0.0 => 100.0;
        /// Random walk of the bias.
        walk: T [m/s^2/sqrt(s)] = 1e-4, in 0.0 => 100.0;
        /// Standard deviation of each component of the bias at the start.
        bias_sigma: T [m/s^2] = 0.05, in 0.0 => 100.0;
        /// Largest magnitude of a component.
        range: T [m/s^2] = 235.0, in 1e-3 => 1e4;
        /// Smallest step between two values; 0 for none.
        resolution: T [m/s^2] = 7e-3, in 0.0 => 100.0;
        /// Cut-off frequency of the low-pass before sampling.
        cutoff_hz: T [Hz] = 1000.0, in 0.1 => 1e6;
        /// Amplitude of the vibration of each rotor per square of its speed.
        vibration: T [m/rad^2] = 0.0, in 0.0 => 1.0;
    }
}

/// No choices.
pub type Options = ();

record! {
    /// Accelerometer.
    pub struct Accelerometer {
        /// When it samples.
        timing: Timing<T> [];
        /// Its three axes.
        triad: Triad<T> [];
    }
}

impl<T: Real> Accelerometer<T> {
    /// The sensor.
    pub fn new(gains: Gains<T>, _: Options, _: &Vehicle<T>) -> Self {
        let Gains { rate_hz, latency, jitter, dropout, .. } = gains;
        let Gains { noise, walk, bias_sigma, range, resolution, cutoff_hz, vibration, .. } = gains;
        let errors = Errors { noise, walk, bias_sigma, range, resolution, cutoff_hz, vibration };
        Self { timing: Timing { rate_hz, latency, jitter, dropout }, triad: Triad::new(errors) }
    }
}

impl<T: Real> Sense<T> for Accelerometer<T> {
    fn timing(&self) -> Timing<T> {
        self.timing
    }
    #[inline(always)]
    fn pairs(&self) -> u64 {
        3
    }
    fn begin(&mut self, truth: &Truth<T>, normal: [T; 6]) {
        self.triad.begin(truth.specific_force, normal);
    }
    #[inline(always)]
    fn settle(&mut self, truth: &Truth<T>, moment: &Moment<T>) {
        self.triad.settle(truth.specific_force, moment);
    }
    #[inline(always)]
    fn sample(&mut self, _: &Truth<T>, draw: &Draw<T>) -> [T; 7] {
        self.triad.sample(draw) // (1)
    }
    fn vibration(&self) -> T {
        self.triad.errors.vibration
    }
}
