//! Constant force and torque from onset to end.
//!
//!   force = f,   torque = tau                                            (1)

use stormpetrel_control::math::{Body, Vec3, World};
use stormpetrel_control::real::Real;
use stormpetrel_control::record;

use super::{Disturb, Scene, Site};
use crate::dynamics::Push;

record! {
    /// Numbers of the constant disturbance.
    pub struct Gains {
        /// Force.
        force: Vec3<T, World> [N] = 0.0, in -1e6 => 1e6;
        /// Torque.
        torque: Vec3<T, Body> [N m] = 0.0, in -1e6 => 1e6;
    }
}

/// No choices.
pub type Options = ();

record! {
    /// Constant force and torque from onset to end.
    pub struct Constant {
        /// Numbers.
        gains: Gains<T> [];
    }
}

impl<T: Real> Constant<T> {
    /// The disturbance.
    pub fn new(gains: Gains<T>, _: Options, _: &Site<T>) -> Self {
        Self { gains }
    }
}

impl<T: Real> Disturb<T> for Constant<T> {
    #[inline(always)]
    fn push(&mut self, _: &Scene<T>) -> Push<T> {
        let Gains { force, torque } = self.gains;
        Push { force, torque } // (1)
    }
}
