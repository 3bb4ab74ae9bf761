//! Four rotors with lag and speed limits behind an allocation.
//!
//!   Omega_cmd = sqrt(u/k),   u from the allocation                       (1)
//!   Omega' = (Omega_cmd - Omega)/tau_m                                   (2)
//!   T = k sum Omega_i^2,   tau = B (k Omega_i^2)                         (3)
//!
//! Rotor speeds belong to the integrated state. The laws see thrust and torque from the measured
//! speeds (3) and the part of the command that the allocation refused.

use stormpetrel_control::allocation::Allocation;
use stormpetrel_control::math::{Body, Vec3, World};
use stormpetrel_control::real::Real;
use stormpetrel_control::record;
use stormpetrel_control::record::Nothing;
use stormpetrel_control::signals::Wrench;
use stormpetrel_control::stack::{Command, Exit};

use super::Actuate;
use crate::state::State;
use crate::vehicle::Vehicle;

/// Nothing to set: the rotors belong to the vehicle.
pub type Gains<T> = Nothing<T>;
/// No choices.
pub type Options = ();

record! {
    /// Four rotors.
    pub struct Rotors {
        /// The layout, inverted.
        allocation: Allocation<T> [];
        /// Thrust coefficient k.
        thrust_coefficient: T [N s^2/rad^2];
        /// Its reciprocal.
        per_coefficient: T [rad^2/(N s^2)];
        /// Reciprocal mass of the vehicle.
        per_mass: T [1/kg];
        /// Reciprocal time constant of the rotors.
        per_lag: T [1/s];
        /// Speed asked of each rotor.
        commanded: [T; 4] [rad/s];
        /// Share of the rotors asked to run at a limit.
        saturation: T [1];
    }
}

impl Rotors<f64> {
    /// At rest.
    pub fn new(_: Gains<f64>, _: Options, vehicle: &Vehicle<f64>) -> Self {
        Self {
            allocation: vehicle.allocation(),
            thrust_coefficient: vehicle.thrust_coefficient,
            per_coefficient: 1.0 / vehicle.thrust_coefficient,
            per_mass: 1.0 / vehicle.mass,
            per_lag: 1.0 / vehicle.motor_lag,
            commanded: [vehicle.hover_speed(); 4],
            saturation: 0.0,
        }
    }
}

impl<T: Real> Rotors<T> {
    #[inline(always)]
    fn wrench(&self, state: &State<T>) -> Wrench<T> {
        self.allocation.wrench(stormpetrel_control::record::each(state.rotor_speed, |w| self.thrust_coefficient * w.sq())) // (3)
    }
}

impl<T: Real> Actuate<T> for Rotors<T> {
    fn exit(&self) -> Exit {
        Exit::Wrench
    }
    #[inline(always)]
    fn command(&mut self, command: &Command<T>, _: &Vehicle<T>) -> Wrench<T> {
        let (thrusts, granted) = self.allocation.allocate(&command.wrench);
        for (speed, thrust) in self.commanded.iter_mut().zip(thrusts) {
            *speed = (thrust * self.per_coefficient).sqrt(); // (1)
        }
        let Allocation { lowest, highest, .. } = self.allocation;
        let mut limited = T::zero();
        for u in thrusts {
            let free = lowest.lt(u) & u.lt(highest);
            limited += T::select(free, T::zero(), T::lit(0.25));
        }
        self.saturation = limited;
        Wrench {
            thrust: command.wrench.thrust - granted.thrust,
            torque: command.wrench.torque - granted.torque,
        }
    }
    #[inline(always)]
    fn thrust_per_mass(&self, state: &State<T>, _: &Vehicle<T>) -> Vec3<T, World> {
        state.attitude.z_axis() * (self.wrench(state).thrust * self.per_mass)
    }
    #[inline(always)]
    fn torque(&self, state: &State<T>) -> Vec3<T, Body> {
        self.wrench(state).torque
    }
    #[inline(always)]
    fn thrust(&self, state: &State<T>) -> T {
        self.wrench(state).thrust
    }
    #[inline(always)]
    fn rotor_acceleration(&self, state: &State<T>, _: &Vehicle<T>) -> [T; 4] {
        stormpetrel_control::record::from_index(|i| (self.commanded[i] - state.rotor_speed[i]) * self.per_lag) // (2)
    }
    #[inline(always)]
    fn saturation(&self) -> T {
        self.saturation
    }
}
