//! A rotor that keeps the speed it has at the onset, whatever is commanded.
//!
//!   Omega_i' = 0                                                         (1)

use stormpetrel_control::real::Real;
use stormpetrel_control::record;
use stormpetrel_control::record::from_index;

use super::{Disturb, Reach, RotorFaults, Scene, Site, is_rotor};

record! {
    /// Numbers of the stuck rotor.
    pub struct Gains {
        /// Which rotor, from 1.
        rotor: T [count] = 1.0, in 1.0 => 4.0;
    }
}

/// No choices.
pub type Options = ();

record! {
    /// A rotor that keeps the speed it has at the onset, whatever is commanded.
    pub struct RotorStuck {
        /// Numbers.
        gains: Gains<T> [];
    }
}

impl<T: Real> RotorStuck<T> {
    /// The disturbance.
    pub fn new(gains: Gains<T>, _: Options, _: &Site<T>) -> Self {
        Self { gains }
    }
}

impl<T: Real> Disturb<T> for RotorStuck<T> {
    fn reach(&self) -> Reach {
        Reach::Rotors
    }
    #[inline(always)]
    fn rotors(&self, _: &Scene<T>) -> RotorFaults<T> {
        let stuck = from_index(|i| T::select(is_rotor(self.gains.rotor, i), T::one(), T::zero())); // (1)
        RotorFaults { stuck, ..RotorFaults::none() }
    }
}
