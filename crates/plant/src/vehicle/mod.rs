//! The vehicle: mass, inertia, rotors, aerodynamics, battery.
//!
//! Symbols and their equations: rotors in [`crate::actuation::propulsion`], air in
//! [`crate::aerodynamics`], battery in [`crate::actuation::battery`].

mod layout;
mod presets;

use stormpetrel_control::allocation::Allocation;
use stormpetrel_control::math::{Body, Vec3, inverse4};
use stormpetrel_control::real::Real;
use stormpetrel_control::record;
use stormpetrel_control::record::from_index;
use stormpetrel_control::signals::Model;

pub use layout::{Arms, Layout, Mount, RotorPlaces};
pub use presets::VehicleSettings;

record! {
    /// Physical constants of a vehicle with four rotors.
    pub struct Vehicle {
        /// Mass.
        mass: T [kg] = 0.625, in 1e-3 => 100.0;
        /// Principal moments of inertia about the body axes.
        inertia: Vec3<T, Body> [kg m^2] = 2.6e-3, in 1e-7 => 10.0;
        /// Gravitational acceleration where it flies.
        gravity: T [m/s^2] = 9.8, in 0.0 => 30.0;
        /// Distance of each rotor from the centre, l; a free layout has its own distances.
        arm: T [m] = 0.1275, in 1e-3 => 10.0;
        /// Centre of mass, from the centre of the rotors; the laws do not know of it.
        center_of_mass: Vec3<T, Body> [m] = 0.0, in -1.0 => 1.0;
        /// Thrust per square of rotor speed, k.
        thrust_coefficient: T [N s^2/rad^2] = 7.2e-7, in 1e-12 => 1.0;
        /// Drag torque per square of rotor speed, c.
        drag_coefficient: T [N m s^2/rad^2] = 1.98e-8, in 1e-14 => 1.0;
        /// Time constant of the rotors' first-order lag.
        motor_lag: T [s] = 0.02, in 1e-4 => 1.0;
        /// Time constant while a rotor slows down; 0 takes `motor_lag`. `propulsion` only.
        motor_lag_fall: T [s] = 0.0, in 0.0 => 1.0;
        /// Lowest rotor speed.
        rotor_speed_min: T [rad/s] = 150.0, in 0.0 => 2e4;
        /// Highest rotor speed.
        rotor_speed_max: T [rad/s] = 2917.0, in 1.0 => 2e4;
        /// Commanded speed below which a rotor stands still. `propulsion` only.
        rotor_dead_zone: T [rad/s] = 0.0, in 0.0 => 2e4;
        /// Moment of inertia of one rotor about its axis, J. `propulsion` only.
        rotor_inertia: T [kg m^2] = 0.0, in 0.0 => 1.0;
        /// Radius of one rotor, for the ground effect. `propulsion` only.
        rotor_radius: T [m] = 0.0, in 0.0 => 5.0;
        /// Thrust lost for each m/s of air against the thrust, per rotor speed. `propulsion` only.
        inflow_loss: T [N s^2/(rad m)] = 0.0, in 0.0 => 1.0;
        /// Moment of blade flapping for each m/s of air across the disc, per rotor speed. `propulsion` only.
        flapping: T [N s^2/rad] = 0.0, in 0.0 => 1.0;
        /// Linear rotor drag along the body axes, D.
        rotor_drag: Vec3<T, Body> [N s/m] = 0.0, in 0.0 => 100.0;
        /// Quadratic drag of the body, `c_q`.
        body_drag: T [N s^2/m^2] = 0.0, in 0.0 => 100.0;
        /// Torque against the angular velocity.
        rate_drag: Vec3<T, Body> [N m s/rad] = 0.0, in 0.0 => 10.0;
        /// Torque against the angular velocity for each m/s of airspeed.
        rate_drag_airspeed: Vec3<T, Body> [N s^2/rad] = 0.0, in 0.0 => 10.0;
        /// Torque against the square of the angular velocity.
        rate_drag_quadratic: Vec3<T, Body> [N m s^2/rad^2] = 0.0, in 0.0 => 10.0;
        structure {
            /// Where the rotors stand.
            layout: Layout;
        }
    }
}

impl<T: Real> Vehicle<T> {
    /// Places and spins of the rotors as the laws know them.
    pub fn mounts(&self) -> [Mount<T>; 4] {
        from_index(|i| self.layout.mount(i, self.arm))
    }

    /// Wrench per rotor thrust as the laws know it: rows thrust (1), torque x, y, z (m); columns rotors.
    /// A rotor at r with thrust u and spin s gives the torque r x u `e_z` - s (c/k) u `e_z`.
    pub fn effect(&self) -> [[T; 4]; 4] {
        let ratio = self.drag_coefficient / self.thrust_coefficient;
        let mounts = self.mounts();
        [
            [T::one(); 4],
            from_index(|i| mounts[i].place.y),
            from_index(|i| -mounts[i].place.x),
            from_index(|i| -(ratio * mounts[i].spin)),
        ]
    }

    /// Rotor speed at which four equal rotors carry the weight, rad/s.
    pub fn hover_speed(&self) -> T {
        (self.mass * self.gravity / (T::lit(4.0) * self.thrust_coefficient)).sqrt()
    }

    /// What a law is told of the vehicle when nothing else is said.
    pub fn model(&self) -> Model<T> {
        Model { mass: self.mass, gravity: self.gravity, inertia: self.inertia }
    }
}

impl Vehicle<f64> {
    /// The layout, inverted; zero where four such rotors cannot make every wrench.
    pub fn allocation(&self) -> Allocation<f64> {
        let effect = self.effect();
        let k = self.thrust_coefficient;
        Allocation {
            inverse: inverse4(effect).unwrap_or_default(),
            effect,
            lowest: k * self.rotor_speed_min * self.rotor_speed_min,
            highest: k * self.rotor_speed_max * self.rotor_speed_max,
        }
    }

    /// Whether moving air pushes it.
    pub fn feels_air(&self) -> bool {
        let sum = |v: Vec3<f64, Body>| v.x + v.y + v.z;
        let drag = [self.rotor_drag, self.rate_drag, self.rate_drag_airspeed];
        let drag = drag.map(sum).iter().sum::<f64>() + sum(self.rate_drag_quadratic);
        drag + self.body_drag > 0.0
    }
}
