//! Second-order Butterworth low-pass on a vector, bilinear transform with exact cut-off.
//!
//!   K = tan(pi f_c T),  n = 1/(1 + sqrt2 K + K^2)                        (1)
//!   b0 = K^2 n, b1 = 2 b0, b2 = b0,  a1 = 2 (K^2 - 1) n,  a2 = (1 - sqrt2 K + K^2) n   (2)
//!   y = b0 x + s1,  s1 = b1 x - a1 y + s2,  s2 = b2 x - a2 y   (transposed direct form II)   (3)
//!
//! Source: Oppenheim and Schafer, Discrete-Time Signal Processing. |H(f_c)| = 1/sqrt2, H(0) = 1.

use crate::math::{Body, Vec3};
use crate::real::{Mask, Real};
use crate::record;

record! {
    /// The time between two ticks and its reciprocal.
    pub struct Clock {
        /// Time between two ticks; zero before the first.
        step: T [s];
        /// Its reciprocal.
        per_step: T [1/s];
    }
}

impl<T: Real> Clock<T> {
    /// Takes the time between two ticks; divides only where it changes.
    #[inline(always)]
    pub fn tune(&mut self, dt: T) {
        if !self.step.eq(dt).all() {
            *self = Self { step: dt, per_step: T::one() / dt };
        }
    }
}

record! {
    /// Second-order Butterworth low-pass on a body vector.
    pub struct Butterworth {
        /// Sample time for which the coefficients hold; zero before the first.
        sample_time: T [s];
        /// Coefficient b0 = b2.
        b0: T [1];
        /// Coefficient a1.
        a1: T [1];
        /// Coefficient a2.
        a2: T [1];
        /// First state.
        s1: Vec3<T, Body> [];
        /// Second state.
        s2: Vec3<T, Body> [];
    }
}

impl<T: Real> Butterworth<T> {
    /// Takes the coefficients for this cut-off (Hz) and sample time (s). They are kept while the
    /// sample time stays; a cut-off beyond 0.49 of the sample rate counts as that.
    #[inline(always)]
    pub fn tune(&mut self, cutoff_hz: T, sample_time: T) {
        if self.sample_time.eq(sample_time).all() {
            return;
        }
        let turns = (cutoff_hz * sample_time).clamp(T::zero(), T::lit(0.49));
        let (sin, cos) = (turns * T::lit(core::f64::consts::PI)).sin_cos();
        let k = sin / cos; // (1)
        let damping = T::lit(core::f64::consts::SQRT_2) * k;
        let n = T::one() / (T::one() + damping + k.sq());
        self.b0 = k.sq() * n; // (2)
        self.a1 = T::lit(2.0) * (k.sq() - T::one()) * n;
        self.a2 = (T::one() - damping + k.sq()) * n;
        self.sample_time = sample_time;
    }

    /// Sum of what the filter keeps for its next value.
    #[inline(always)]
    pub fn kept(&self) -> T {
        let Vec3 { x, y, z, .. } = self.s1 + self.s2;
        x + y + z
    }

    /// The filtered value.
    #[inline(always)]
    pub fn update(&mut self, x: Vec3<T, Body>) -> Vec3<T, Body> {
        let bx = x * self.b0;
        let y = bx + self.s1; // (3)
        self.s1 = bx * T::lit(2.0) - y * self.a1 + self.s2;
        self.s2 = bx - y * self.a2;
        y
    }
}
