//! Wrench whose torque follows the command through a first-order lag.
//!
//!   a_T = (T/m) R e_z                                                    (1)
//!   tau+ = tau + (1 - exp(-h/tau_m)) (tau_cmd - tau)                     (2)
//!
//! Thrust acts at once and without limits; (2) is exact for a held command and is taken before each
//! integration step. The model behind the golden values of the repair ladder.

use stormpetrel_control::math::{Body, Vec3, World};
use stormpetrel_control::real::{Mask, Real};
use stormpetrel_control::record;
use stormpetrel_control::signals::Wrench;
use stormpetrel_control::stack::Exit;

use super::{Actuate, Sent};
use super::wrench::IdealWrench;
use crate::dispatch::rarely;
use crate::state::State;
use crate::vehicle::Vehicle;

record! {
    /// Numbers of the lagged wrench.
    pub struct Gains {
        /// Time constant of the torque.
        lag: T [s] = 0.02, in 1e-4 => 1.0;
    }
}

/// No choices.
pub type Options = ();

record! {
    /// The wrench behind its lag.
    pub struct LaggedWrench {
        /// Numbers.
        gains: Gains<T> [];
        /// What was commanded.
        ideal: IdealWrench<T> [];
        /// Time for which `blend` holds; zero before the first.
        step: T [s];
        /// 1 - exp(-h/tau_m).
        blend: T [1];
        /// Torque that acts.
        torque: Vec3<T, Body> [N m];
    }
}

impl<T: Real> LaggedWrench<T> {
    /// At rest.
    pub fn new(gains: Gains<T>, options: Options, vehicle: &Vehicle<T>) -> Self {
        let ideal = IdealWrench::new(Default::default(), options, vehicle);
        Self { gains, ideal, ..Self::default() }
    }
}

impl<T: Real> Actuate<T> for LaggedWrench<T> {
    fn exit(&self) -> Exit {
        Exit::Wrench
    }
    #[inline(always)]
    fn command(&mut self, sent: &Sent<T>, vehicle: &Vehicle<T>) -> Wrench<T> {
        self.ideal.command(sent, vehicle)
    }
    #[inline(always)]
    fn pass(&mut self, h: T) {
        if !self.step.eq(h).all() {
            (self.step, self.blend) = (h, rarely(|| T::one() - (-h / self.gains.lag).exp()));
        }
        self.torque += (self.ideal.wrench.torque - self.torque) * self.blend; // (2)
    }
    fn reset(&mut self) {
        self.ideal.reset();
        self.torque = Vec3::zero();
    }
    #[inline(always)]
    fn thrust_per_mass(&self, state: &State<T>, vehicle: &Vehicle<T>) -> Vec3<T, World> {
        self.ideal.thrust_per_mass(state, vehicle) // (1)
    }
    #[inline(always)]
    fn torque(&self, _: &State<T>) -> Vec3<T, Body> {
        self.torque
    }
    #[inline(always)]
    fn thrust(&self, _: &State<T>) -> T {
        self.ideal.wrench.thrust
    }
}
