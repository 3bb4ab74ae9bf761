//! Steady wind, everywhere the same.
//!
//!   w = v                                                                (1)

use stormpetrel_control::math::{Vec3, World};
use stormpetrel_control::real::Real;
use stormpetrel_control::record;

use super::{Disturb, Reach, Scene, Site};

record! {
    /// Numbers of the wind.
    pub struct Gains {
        /// Velocity of the air, v.
        velocity: Vec3<T, World> [m/s] = 0.0, in -100.0 => 100.0;
    }
}

/// No choices.
pub type Options = ();

record! {
    /// Steady wind, everywhere the same.
    pub struct Wind {
        /// Numbers.
        gains: Gains<T> [];
    }
}

impl<T: Real> Wind<T> {
    /// The disturbance.
    pub fn new(gains: Gains<T>, _: Options, _: &Site<T>) -> Self {
        Self { gains }
    }
}

impl<T: Real> Disturb<T> for Wind<T> {
    fn reach(&self) -> Reach {
        Reach::Air
    }
    #[inline(always)]
    fn wind(&mut self, _: &Scene<T>) -> Vec3<T, World> {
        self.gains.velocity // (1)
    }
}
