//! A mass on a cable from the centre of mass, attached at the onset and dropped at the end.
//!
//!   r = `x_cargo` - x,   |r| = length,   q = r/|r|                         (1)
//!   T (1/m + 1/mass) = |r'|^2/length - q.u,   T >= 0                     (2)
//!   r'' = -u - T q (1/m + 1/mass) - damping/mass (r' - q (q.r'))         (3)
//!   pull on the vehicle: T q                                             (4)
//!
//! with T the tension, m the mass of the vehicle and u the force on it per mass, without weight and
//! tension. (2) is Newton's law for both masses while the cable is tight, the range of validity; a cable
//! pulls and never pushes. It hangs straight down when it is attached.

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
        Sling { mass, length, damping } // (1) to (4)
    }
}
