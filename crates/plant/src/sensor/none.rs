//! No sensor: fills the places that a scenario leaves empty.
//!
//!   z = nothing                                                          (1)

use stormpetrel_control::real::Real;
use stormpetrel_control::record;
use stormpetrel_control::record::Nothing;

use super::link::Timing;
use super::{Draw, Sense, Truth};
use crate::vehicle::Vehicle;

/// Nothing to set.
pub type Gains<T> = Nothing<T>;
/// No choices.
pub type Options = ();

record! {
    /// An empty place.
    pub struct Unused {
        /// Always zero; a record has at least one number.
        nothing: T [1];
    }
}

impl<T: Real> Unused<T> {
    /// An empty place.
    pub fn new(_: Gains<T>, _: Options, _: &Vehicle<T>) -> Self {
        Self::default()
    }
}

impl<T: Real> Sense<T> for Unused<T> {
    fn timing(&self) -> Timing<T> {
        Timing::default()
    }
    #[inline(always)]
    fn pairs(&self) -> u64 {
        0
    }
    #[inline(always)]
    fn sample(&mut self, _: &Truth<T>, _: &Draw<T>) -> [T; 7] {
        [T::zero(); 7] // (1)
    }
}
