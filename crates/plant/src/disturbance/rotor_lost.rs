//! A rotor that is gone.
//!
//!   T_i = Q_i = 0,   Omega_i -> 0 with the rotor's lag                   (1)

use stormpetrel_control::real::Real;
use stormpetrel_control::record;
use stormpetrel_control::record::from_index;

use super::{Disturb, Reach, RotorFaults, Scene, Site, is_rotor};

record! {
    /// Numbers of the lost rotor.
    pub struct Gains {
        /// Which rotor, from 1.
        rotor: T [count] = 1.0, in 1.0 => 4.0;
    }
}

/// No choices.
pub type Options = ();

record! {
    /// A rotor that is gone.
    pub struct RotorLost {
        /// Numbers.
        gains: Gains<T> [];
    }
}

impl<T: Real> RotorLost<T> {
    /// The disturbance.
    pub fn new(gains: Gains<T>, _: Options, _: &Site<T>) -> Self {
        Self { gains }
    }
}

impl<T: Real> Disturb<T> for RotorLost<T> {
    fn reach(&self) -> Reach {
        Reach::Rotors
    }
    #[inline(always)]
    fn rotors(&self, _: &Scene<T>) -> RotorFaults<T> {
        let health = from_index(|i| T::select(is_rotor(self.gains.rotor, i), T::zero(), T::one())); // (1)
        RotorFaults { health, ..RotorFaults::none() }
    }
}
