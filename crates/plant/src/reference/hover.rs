//! Hover: one point, one heading.
//!
//!   x_ref = p,   psi_ref = psi                                           (1)

use stormpetrel_control::math::{Vec3, World};
use stormpetrel_control::real::Real;
use stormpetrel_control::record;
use stormpetrel_control::signals::Trajectory;

use super::Refer;
use crate::vehicle::Vehicle;

record! {
    /// Numbers of the hover.
    pub struct Gains {
        /// The point.
        position: Vec3<T, World> [m] = 0.0, in -1e6 => 1e6;
        /// The heading.
        yaw: T [rad] = 0.0, in -6.3 => 6.3;
    }
}

/// No choices.
pub type Options = ();

record! {
    /// Hover.
    pub struct Hover {
        /// Numbers.
        gains: Gains<T> [];
    }
}

impl<T: Real> Hover<T> {
    /// The reference.
    pub fn new(gains: Gains<T>, _: Options, _: &Vehicle<T>) -> Self {
        Self { gains }
    }
}

impl<T: Real> Refer<T> for Hover<T> {
    #[inline(always)]
    fn at(&self, _: T) -> Trajectory<T> {
        let Gains { position, yaw } = self.gains;
        Trajectory { position, yaw, ..Trajectory::default() } // (1)
    }
}
