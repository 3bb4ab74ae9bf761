//! Four rotors with lag and speed limits behind an allocation.
//!
//!   Omega_cmd = sqrt(u/k),   u from the allocation                       (1)
//!   Omega(t + h) = Omega_cmd + (Omega(t) - Omega_cmd) exp(-h/tau_m)      (2)
//!   T = k sum Omega_i^2,   tau = B (k Omega_i^2)                         (3)
//!
//! (2) solves Omega' = (Omega_cmd - Omega)/tau_m for a held command. k may differ from the k that the
//! allocation (1) and the laws expect (`efficiency`). The laws see thrust and torque from the measured
//! speeds (3) and the part of the command that the allocation refused.

use stormpetrel_control::allocation::Allocation;
use stormpetrel_control::math::{Body, Vec3, World};
use stormpetrel_control::real::{Mask, Real};
use stormpetrel_control::record;
use stormpetrel_control::record::{each, from_index};
use stormpetrel_control::signals::Wrench;
use stormpetrel_control::stack::Exit;

use super::{Actuate, Sent};
use crate::dispatch::rarely;
use crate::state::State;
use crate::vehicle::Vehicle;

record! {
    /// How the rotors differ from what the laws know of them.
    pub struct Gains {
        /// True thrust and drag torque over what the laws and the allocation expect at the same speed.
        efficiency: T [1] = 1.0, in 1e-3 => 10.0;
    }
}

/// No choices.
pub type Options = ();

record! {
    /// Four rotors.
    pub struct Rotors {
        /// The layout, inverted.
        allocation: Allocation<T> [];
        /// Expected over true thrust.
        belief: T [1];
        /// True thrust coefficient k.
        thrust_coefficient: T [N s^2/rad^2];
        /// Reciprocal of the expected one.
        per_coefficient: T [rad^2/(N s^2)];
        /// k/m.
        thrust_per_mass: T [m/rad^2];
        /// k times the rows of B that give the torque.
        arms: [[T; 4]; 3] [N m s^2/rad^2];
        /// Time constant of the rotors.
        lag: T [s];
        /// Integration step for which the decays hold; zero before the first.
        step: T [s];
        /// exp(-h/(2 tau_m)): what remains of a distance (2) after half of the step.
        half_decay: T [1];
        /// Speed asked of each rotor.
        commanded: [T; 4] [rad/s];
        /// Share of the rotors asked to run at a limit.
        saturation: T [1];
    }
}

impl Rotors<f64> {
    /// At rest.
    pub fn new(gains: Gains<f64>, _: Options, vehicle: &Vehicle<f64>) -> Self {
        let (allocation, expected) = (vehicle.allocation(), vehicle.thrust_coefficient);
        let k = expected * gains.efficiency;
        let [_, roll, pitch, yaw] = allocation.effect;
        Self {
            allocation,
            belief: 1.0 / gains.efficiency,
            thrust_coefficient: k,
            per_coefficient: 1.0 / expected,
            thrust_per_mass: k / vehicle.mass,
            arms: [roll, pitch, yaw].map(|row| row.map(|arm| k * arm)),
            lag: vehicle.motor_lag,
            commanded: [vehicle.hover_speed(); 4],
            ..Self::default()
        }
    }
}

/// a + b + c + d, in pairs.
#[inline(always)]
fn sum<T: Real>([a, b, c, d]: [T; 4]) -> T {
    a + b + (c + d)
}

/// Sum of products, in pairs.
#[inline(always)]
fn dot<T: Real>(a: [T; 4], b: [T; 4]) -> T {
    sum([a[0] * b[0], a[1] * b[1], a[2] * b[2], a[3] * b[3]])
}

/// The squares of the rotor speeds, rad^2/s^2.
#[inline(always)]
fn squares<T: Real>(state: &State<T>) -> [T; 4] {
    each(state.rotor_speed, T::sq)
}

impl<T: Real> Actuate<T> for Rotors<T> {
    fn exit(&self) -> Exit {
        Exit::Wrench
    }
    #[inline(always)]
    fn command(&mut self, sent: &Sent<T>, _: &Vehicle<T>) -> Wrench<T> {
        let allocated = self.allocation.allocate(&sent.wrench);
        self.commanded = each(allocated.thrusts, |u| (u * self.per_coefficient).sqrt()); // (1)
        self.saturation = allocated.saturation;
        allocated.refused
    }
    #[inline(always)]
    fn pass(&mut self, h: T) {
        if !self.step.eq(h).all() {
            (self.step, self.half_decay) = (h, rarely(|| (-h.half() / self.lag).exp()));
        }
    }
    #[inline(always)]
    fn thrust_per_mass(&self, state: &State<T>, _: &Vehicle<T>) -> Vec3<T, World> {
        state.attitude.up(sum(squares(state)) * self.thrust_per_mass)
    }
    #[inline(always)]
    fn torque(&self, state: &State<T>) -> Vec3<T, Body> {
        let squares = squares(state);
        let [roll, pitch, yaw] = self.arms;
        Vec3::new(dot(roll, squares), dot(pitch, squares), dot(yaw, squares)) // (3)
    }
    #[inline(always)]
    fn torque_now(&self, before: Vec3<T, Body>, _: &State<T>) -> Vec3<T, Body> {
        before
    }
    #[inline(always)]
    fn thrust(&self, state: &State<T>) -> T {
        sum(squares(state)) * self.thrust_coefficient // (3)
    }
    #[inline(always)]
    fn rotor_speeds(&self, state: &State<T>) -> [[T; 4]; 2] {
        let away: [T; 4] =
            from_index(|i| (state.rotor_speed[i] - self.commanded[i]) * self.half_decay);
        [
            from_index(|i| self.commanded[i] + away[i]),
            from_index(|i| self.commanded[i] + away[i] * self.half_decay),
        ] // (2)
    }
    #[inline(always)]
    fn belief(&self) -> T {
        self.belief
    }
    #[inline(always)]
    fn saturation(&self) -> T {
        self.saturation
    }
}
