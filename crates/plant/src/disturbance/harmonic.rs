//! Harmonic force and torque.
//!
//!   h(t) = offset + sine sin(w t) + cosine cos(w t)                      (1)
//!   force = (f + m a) h,   torque = tau h                                (2)
//!
//! The article's disturbances are h = 1 + sin t + cos t with 50 (1,1,1) "N" and 0.5 (1,1,1) N m. Its
//! equations add the first one to an acceleration: that literal reading is `acceleration`, from which
//! the true force follows with the vehicle's mass.

use stormpetrel_control::math::{Body, Vec3, World};
use stormpetrel_control::real::Real;
use stormpetrel_control::record;

use super::{Disturb, Scene, Site};
use crate::dynamics::Push;

record! {
    /// Numbers of the harmonic disturbance.
    pub struct Gains {
        /// Amplitude of the force, f.
        force: Vec3<T, World> [N] = 0.0, in -1e6 => 1e6;
        /// Amplitude of the torque, tau.
        torque: Vec3<T, Body> [N m] = 0.0, in -1e6 => 1e6;
        /// Amplitude as an acceleration, a: the article's literal reading.
        acceleration: Vec3<T, World> [m/s^2] = 0.0, in -1e6 => 1e6;
        /// Constant part of h.
        offset: T [1] = 1.0, in -1e3 => 1e3;
        /// Sine part of h.
        sine: T [1] = 1.0, in -1e3 => 1e3;
        /// Cosine part of h.
        cosine: T [1] = 1.0, in -1e3 => 1e3;
        /// Angular frequency w.
        frequency: T [rad/s] = 1.0, in 0.0 => 1e3;
    }
}

/// No choices.
pub type Options = ();

record! {
    /// Harmonic force and torque.
    pub struct Harmonic {
        /// Numbers.
        gains: Gains<T> [];
    }
}

impl<T: Real> Harmonic<T> {
    /// The disturbance.
    pub fn new(gains: Gains<T>, _: Options, _: &Site<T>) -> Self {
        Self { gains }
    }
}

impl<T: Real> Harmonic<T> {
    /// The push `time` seconds after the onset on a vehicle of this mass (kg).
    #[inline(always)]
    pub fn at(&self, time: T, mass: T) -> Push<T> {
        let Gains { force, torque, acceleration, offset, sine, cosine, frequency } = self.gains;
        let (sin, cos) = (frequency * time).sin_cos();
        let h = offset + sine * sin + cosine * cos; // (1)
        Push { force: (force + acceleration * mass) * h, torque: torque * h } // (2)
    }
}

impl<T: Real> Disturb<T> for Harmonic<T> {
    #[inline(always)]
    fn push(&mut self, scene: &Scene<T>) -> Push<T> {
        self.at(scene.time, scene.mass)
    }
}
