//! A ramp that stays at its top.
//!
//!   h(t) = min(t/T, 1)                                                   (1)
//!   force = f h,   torque = tau h                                        (2)

use stormpetrel_control::math::{Body, Vec3, World};
use stormpetrel_control::real::Real;
use stormpetrel_control::record;

use super::{Disturb, Scene, Site};
use crate::dynamics::Push;

record! {
    /// Numbers of the ramp.
    pub struct Gains {
        /// Force.
        force: Vec3<T, World> [N] = 0.0, in -1e6 => 1e6;
        /// Torque.
        torque: Vec3<T, Body> [N m] = 0.0, in -1e6 => 1e6;
        /// Time from nothing to the whole, T.
        rise: T [s] = 1.0, in 1e-6 => 1e6;
    }
}

/// No choices.
pub type Options = ();

record! {
    /// A ramp that stays at its top.
    pub struct Ramp {
        /// Numbers.
        gains: Gains<T> [];
    }
}

impl<T: Real> Ramp<T> {
    /// The disturbance.
    pub fn new(gains: Gains<T>, _: Options, _: &Site<T>) -> Self {
        Self { gains }
    }
}

impl<T: Real> Disturb<T> for Ramp<T> {
    #[inline(always)]
    fn push(&mut self, scene: &Scene<T>) -> Push<T> {
        let Gains { force, torque, rise } = self.gains;
        let h = (scene.time / rise).min(T::one()); // (1)
        Push { force: force * h, torque: torque * h } // (2)
    }
}
