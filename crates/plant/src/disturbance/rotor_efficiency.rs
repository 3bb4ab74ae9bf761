//! A rotor that gives less, as with a chipped blade.
//!
//!   T_i = e k Omega^2,   Q_i = e c Omega^2                               (1)

use stormpetrel_control::real::Real;
use stormpetrel_control::record;
use stormpetrel_control::record::from_index;

use super::{Disturb, Reach, RotorFaults, Scene, Site, is_rotor};

record! {
    /// Numbers of the weak rotor.
    pub struct Gains {
        /// Which rotor, from 1.
        rotor: T [count] = 1.0, in 1.0 => 4.0;
        /// Thrust and torque over those of a healthy rotor, e.
        efficiency: T [1] = 0.8, in 1e-3 => 1.5;
    }
}

/// No choices.
pub type Options = ();

record! {
    /// A rotor that gives less, as with a chipped blade.
    pub struct RotorEfficiency {
        /// Numbers.
        gains: Gains<T> [];
    }
}

impl<T: Real> RotorEfficiency<T> {
    /// The disturbance.
    pub fn new(gains: Gains<T>, _: Options, _: &Site<T>) -> Self {
        Self { gains }
    }
}

impl<T: Real> Disturb<T> for RotorEfficiency<T> {
    fn reach(&self) -> Reach {
        Reach::Rotors
    }
    #[inline(always)]
    fn rotors(&self, _: &Scene<T>) -> RotorFaults<T> {
        let Gains { rotor, efficiency } = self.gains;
        let health = from_index(|i| T::select(is_rotor(rotor, i), efficiency, T::one())); // (1)
        RotorFaults { health, ..RotorFaults::none() }
    }
}
