//! A train of rectangular pulses.
//!
//!   h(t) = 1 where t - P floor(t/P) < w, else 0                          (1)
//!   force = f h,   torque = tau h                                        (2)

use stormpetrel_control::math::{Body, Vec3, World};
use stormpetrel_control::real::Real;
use stormpetrel_control::record;

use super::{Disturb, Scene, Site};
use crate::dynamics::Push;

record! {
    /// Numbers of the pulse train.
    pub struct Gains {
        /// Force.
        force: Vec3<T, World> [N] = 0.0, in -1e6 => 1e6;
        /// Torque.
        torque: Vec3<T, Body> [N m] = 0.0, in -1e6 => 1e6;
        /// Length of a pulse, w.
        width: T [s] = 0.1, in 0.0 => 1e6;
        /// Time from one pulse to the next, P.
        period: T [s] = 1e6, in 1e-3 => 1e6;
    }
}

/// No choices.
pub type Options = ();

record! {
    /// A train of rectangular pulses.
    pub struct Pulse {
        /// Numbers.
        gains: Gains<T> [];
    }
}

impl<T: Real> Pulse<T> {
    /// The disturbance.
    pub fn new(gains: Gains<T>, _: Options, _: &Site<T>) -> Self {
        Self { gains }
    }
}

impl<T: Real> Disturb<T> for Pulse<T> {
    #[inline(always)]
    fn push(&mut self, scene: &Scene<T>) -> Push<T> {
        let Gains { force, torque, width, period } = self.gains;
        let phase = scene.time - period * (scene.time / period).floor();
        let h = T::select(phase.lt(width), T::one(), T::zero()); // (1)
        Push { force: force * h, torque: torque * h } // (2)
    }
}
