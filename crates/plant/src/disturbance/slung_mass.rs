//! A mass on a cable from the centre of mass, attached at the onset and dropped at the end.
//!
//!   the equations are those of the module `sling`                        (1)
//!
//! It hangs straight down when it is attached.

use stormpetrel_control::real::Real;
use stormpetrel_control::record;

use super::{Disturb, Reach, Site};
use crate::sling::Sling;

record! {
    /// Numbers of the slung mass.
    pub struct Gains {
        /// Mass.
        mass: T [kg] = 0.1, in 0.0 => 100.0;
        /// Length of the cable.
        length: T [m] = 1.0, in 0.01 => 100.0;
        /// Damping across the cable.
        damping: T [N s/m] = 0.0, in 0.0 => 100.0;
    }
}

/// No choices.
pub type Options = ();

record! {
    /// A mass on a cable from the centre of mass, attached at the onset and dropped at the end.
    pub struct SlungMass {
        /// Numbers.
        gains: Gains<T> [];
    }
}

impl<T: Real> SlungMass<T> {
    /// The disturbance.
    pub fn new(gains: Gains<T>, _: Options, _: &Site<T>) -> Self {
        Self { gains }
    }
}

impl<T: Real> Disturb<T> for SlungMass<T> {
    fn reach(&self) -> Reach {
        Reach::Sling
    }
    fn sling(&self) -> Sling<T> {
        let Gains { mass, length, damping } = self.gains;
        Sling { mass, length, damping } // (1)
    }
}
