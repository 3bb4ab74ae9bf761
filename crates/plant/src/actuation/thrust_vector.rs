//! Point mass: the thrust vector that the position loop asks for acts exactly.
//!
//!   a_T = F                                                              (1)
//!
//! The attitude levels rest. Shows what position law and observer do on their own.

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
    /// The thrust vector, held.
    pub struct ThrustVector {
        /// Specific thrust F.
        force: Vec3<T, World> [m/s^2];
        /// Mass, which turns it into newtons.
        mass: T [kg];
    }
}

impl<T: Real> ThrustVector<T> {
    /// At rest.
    pub fn new(_: Gains<T>, _: Options, vehicle: &Vehicle<T>) -> Self {
        Self { force: Vec3::zero(), mass: vehicle.mass }
    }
}

impl<T: Real> Actuate<T> for ThrustVector<T> {
    fn exit(&self) -> Exit {
        Exit::Thrust
    }
    #[inline(always)]
    fn command(&mut self, sent: &Sent<T>, _: &Vehicle<T>) -> Wrench<T> {
        self.force = sent.force;
        Wrench::default()
    }
    fn reset(&mut self) {
        self.force = Vec3::zero();
    }
    #[inline(always)]
    fn thrust_per_mass(&self, _: &State<T>, _: &Vehicle<T>) -> Vec3<T, World> {
        self.force // (1)
    }
    #[inline(always)]
    fn torque(&self, _: &State<T>) -> Vec3<T, Body> {
        Vec3::zero()
    }
    #[inline(always)]
    fn thrust(&self, _: &State<T>) -> T {
        self.force.norm() * self.mass
    }
}
