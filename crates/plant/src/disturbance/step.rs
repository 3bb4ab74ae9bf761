//! A step that rises like a first-order lag, as a pushing hand or an opening valve does.
//!
//!   h(t) = 1 - exp(-t/T),   h = 1 where T = 0                            (1)
//!   force = f h,   torque = tau h                                        (2)

use stormpetrel_control::math::{Body, Vec3, World};
use stormpetrel_control::real::Real;
use stormpetrel_control::record;

use super::{Disturb, Scene, Site};
use crate::dynamics::Push;

record! {
    /// Numbers of the step.
    pub struct Gains {
        /// Force.
        force: Vec3<T, World> [N] = 0.0, in -1e6 => 1e6;
        /// Torque.
        torque: Vec3<T, Body> [N m] = 0.0, in -1e6 => 1e6;
        /// Time constant of the rise, T; 0 rises at once.
        rise: T [s] = 0.0, in 0.0 => 1e6;
    }
}

/// No choices.
pub type Options = ();

record! {
    /// A step that rises like a first-order lag, as a pushing hand or an opening valve does.
    pub struct Step {
        /// Numbers.
        gains: Gains<T> [];
    }
}

impl<T: Real> Step<T> {
    /// The disturbance.
    pub fn new(gains: Gains<T>, _: Options, _: &Site<T>) -> Self {
        Self { gains }
    }
}

impl<T: Real> Disturb<T> for Step<T> {
    #[inline(always)]
    fn push(&mut self, scene: &Scene<T>) -> Push<T> {
        let Gains { force, torque, rise } = self.gains;
        let lag = T::zero().lt(rise);
        let reached = T::one() - (-scene.time / T::select(lag, rise, T::one())).exp();
        let h = T::select(lag, reached, T::one()); // (1)
        Push { force: force * h, torque: torque * h } // (2)
    }
}
