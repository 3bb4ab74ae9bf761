//! The errors of a sensor with three axes fixed to the body: gyro and accelerometer.
//!
//!   y' = 2 pi f_c (x + a s - y),   y += (1 - exp(-2 pi f_c dt)) (x + a s - y)                (1)
//!   b += walk sqrt(T) n,   z = y + b + density/sqrt(T) n                                     (2)
//!   z := round(z/q) q, within +-range                                                        (3)
//!
//! with x the truth, held over a tick of dt seconds; a s the vibration; T the time between two samples;
//! n independent standard normal numbers. (1) runs at every tick, (2) and (3) at every sample. The
//! bias b begins with a draw of its own.
//!
//! Source: IEEE Std 952 for the error terms; (1) and (2) are exact for held input and white noise.

use stormpetrel_control::math::{Body, Vec3};
use stormpetrel_control::real::{Mask as _, Real};
use stormpetrel_control::record;

use super::{Draw, Moment};

record! {
    /// How wrong the three axes are, in units of what is measured.
    pub struct Errors {
        /// Density of the white noise.
        noise: T [];
        /// Random walk of the bias.
        walk: T [];
        /// Standard deviation of each component of the bias at the start.
        bias_sigma: T [];
        /// Largest magnitude of a component.
        range: T [];
        /// Smallest step between two values, q; 0 for none.
        resolution: T [];
        /// Cut-off frequency of the low-pass before sampling.
        cutoff_hz: T [Hz];
        /// Amplitude of the vibration per square of rotor speed, a.
        vibration: T [];
    }
}

record! {
    /// Three axes.
    pub struct Triad {
        /// How wrong they are.
        errors: Errors<T> [];
        /// Time between two ticks for which the low-pass holds; zero before the first.
        step: T [s];
        /// What of the low-pass' error is left after a tick.
        decay: T [1];
        /// Value behind the low-pass.
        filtered: Vec3<T, Body> [];
        /// Bias.
        bias: Vec3<T, Body> [];
    }
}

impl<T: Real> Triad<T> {
    /// Three axes with these errors.
    pub fn new(errors: Errors<T>) -> Self {
        Self { errors, ..Self::default() }
    }

    /// The flight begins where this is measured; the numbers are standard normal.
    pub fn begin(&mut self, truth: Vec3<T, Body>, [x, y, z, ..]: [T; 6]) {
        self.bias = Vec3::new(x, y, z) * self.errors.bias_sigma;
        self.filtered = truth;
    }

    /// The low-pass over one tick (1).
    #[inline(always)]
    pub fn settle(&mut self, truth: Vec3<T, Body>, moment: &Moment<T>) {
        if !self.step.eq(moment.dt).all() {
            let tau = T::lit(core::f64::consts::TAU);
            self.step = moment.dt;
            self.decay = (-(tau * self.errors.cutoff_hz * moment.dt)).exp();
        }
        let vibration = self.errors.vibration;
        let shaken = truth + moment.shake * vibration;
        let input = Vec3::select(vibration.eq(T::zero()), truth, shaken);
        let filtered = input + (self.filtered - input) * self.decay;
        self.filtered = Vec3::select(moment.good, filtered, self.filtered);
    }

    /// A sample (2), (3).
    #[inline(always)]
    pub fn sample(&mut self, draw: &Draw<T>) -> [T; 7] {
        let Errors { noise, walk, range, resolution, .. } = self.errors;
        let [n0, n1, n2, n3, n4, n5] = draw.normal;
        let root = draw.interval.sqrt();
        let bias = self.bias + Vec3::new(n3, n4, n5) * (walk * root);
        self.bias = Vec3::select(draw.due, bias, self.bias);
        let z = self.filtered + self.bias + Vec3::new(n0, n1, n2) * (noise / root);
        let z = z.map(|x| stepped(x, resolution).clamp(-range, range));
        [z.x, z.y, z.z, T::zero(), T::zero(), T::zero(), T::zero()]
    }
}

/// The nearest multiple of the resolution; the number itself where that is zero.
#[inline(always)]
pub fn stepped<T: Real>(x: T, resolution: T) -> T {
    T::select(T::zero().lt(resolution), (x / resolution).round() * resolution, x)
}
