//! Ideal wrench: thrust and torque act at once and without limits.
//!
//!   a_T = (T/m) R e_z,   tau = tau_cmd                                   (1)
//!
//! Thrust may go negative, which no fixed-pitch rotor can do: the article's literal reading only.

use stormpetrel_control::math::{Body, Vec3, World};
use stormpetrel_control::real::Real;
use stormpetrel_control::record;
use stormpetrel_control::record::Nothing;
use stormpetrel_control::signals::Wrench;
use stormpetrel_control::stack::Exit;

use super::{Actuate, Sent};
use crate::state::State;
use crate::vehicle::Vehicle;

/// Nothing to set.
pub type Gains<T> = Nothing<T>;
/// No choices.
pub type Options = ();

record! {
    /// The wrench, held.
    pub struct IdealWrench {
        /// Thrust and torque.
        wrench: Wrench<T> [];
        /// Reciprocal mass of the vehicle.
        per_mass: T [1/kg];
    }
}

impl<T: Real> IdealWrench<T> {
    /// At rest.
    pub fn new(_: Gains<T>, _: Options, vehicle: &Vehicle<T>) -> Self {
        Self { wrench: Wrench::default(), per_mass: T::one() / vehicle.mass }
    }
}

impl<T: Real> Actuate<T> for IdealWrench<T> {
    fn exit(&self) -> Exit {
        Exit::Wrench
    }
    #[inline(always)]
    fn command(&mut self, sent: &Sent<T>, _: &Vehicle<T>) -> Wrench<T> {
        self.wrench = sent.wrench;
        Wrench::default()
    }
    fn reset(&mut self) {
        self.wrench = Wrench::default();
    }
    #[inline(always)]
    fn thrust_per_mass(&self, state: &State<T>, _: &Vehicle<T>) -> Vec3<T, World> {
        state.attitude.up(self.wrench.thrust * self.per_mass) // (1)
    }
    #[inline(always)]
    fn torque(&self, _: &State<T>) -> Vec3<T, Body> {
        self.wrench.torque
    }
    #[inline(always)]
    fn thrust(&self, _: &State<T>) -> T {
        self.wrench.thrust
    }
}
