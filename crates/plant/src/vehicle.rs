//! The vehicle: mass, inertia, rotors.

use stormpetrel_control::allocation::Allocation;
use stormpetrel_control::math::{Body, Vec3, inverse4};
use stormpetrel_control::real::Real;
use stormpetrel_control::record;
use stormpetrel_control::record::{Meta, Path, Record};
use stormpetrel_control::registry::{Settings, SettingsVisitor};
use stormpetrel_control::signals::Model;

record! {
    /// Physical constants of a vehicle with four rotors; layout `article-plus`.
    pub struct Vehicle {
        /// Mass.
        mass: T [kg] = 0.625, in 1e-3 => 100.0;
        /// Principal moments of inertia about the body axes.
        inertia: Vec3<T, Body> [kg m^2] = 2.6e-3, in 1e-7 => 10.0;
        /// Gravitational acceleration where it flies.
        gravity: T [m/s^2] = 9.8, in 0.0 => 30.0;
        /// Distance of each rotor from the centre of mass, l.
        arm: T [m] = 0.1275, in 1e-3 => 10.0;
        /// Thrust per square of rotor speed, k.
        thrust_coefficient: T [N s^2/rad^2] = 7.2e-7, in 1e-12 => 1.0;
        /// Drag torque per square of rotor speed, c.
        drag_coefficient: T [N m s^2/rad^2] = 1.98e-8, in 1e-14 => 1.0;
        /// Time constant of the rotors' first-order lag.
        motor_lag: T [s] = 0.02, in 1e-4 => 1.0;
        /// Lowest rotor speed.
        rotor_speed_min: T [rad/s] = 150.0, in 0.0 => 2e4;
        /// Highest rotor speed.
        rotor_speed_max: T [rad/s] = 2917.0, in 1.0 => 2e4;
    }
}

/// Layout `article-plus`: direction of each rotor from the centre (forward, left) and spin seen from
/// above, +1 counter-clockwise. 1 front, 2 right, 3 rear, 4 left.
pub const ARTICLE_PLUS: [(f64, f64, f64); 4] =
    [(1.0, 0.0, 1.0), (0.0, -1.0, -1.0), (-1.0, 0.0, 1.0), (0.0, 1.0, -1.0)];

impl<T: Real> Vehicle<T> {
    /// Wrench per rotor thrust: rows thrust (1), torque x, y, z (m); columns rotors. A rotor at r with
    /// thrust u and spin s gives the torque r x u `e_z` - s (c/k) u `e_z`.
    pub fn effect(&self) -> [[T; 4]; 4] {
        let ratio = self.drag_coefficient / self.thrust_coefficient;
        let column = |i: usize| ARTICLE_PLUS[i];
        [
            [T::one(); 4],
            stormpetrel_control::record::from_index(|i| self.arm * T::lit(column(i).1)),
            stormpetrel_control::record::from_index(|i| -(self.arm * T::lit(column(i).0))),
            stormpetrel_control::record::from_index(|i| -(ratio * T::lit(column(i).2))),
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
    /// The layout, inverted. The inverse exists for every vehicle inside the declared ranges.
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
}

/// A vehicle by the name of its preset; each number may be changed.
#[derive(Clone, Copy, Debug)]
pub struct VehicleSettings {
    preset: usize,
    /// The numbers.
    pub vehicle: Vehicle<f64>,
}

impl VehicleSettings {
    /// One sentence on each preset.
    pub const DOCS: [&'static str; 2] = [
        "The article's vehicle with its printed constants; its drag coefficient gives c/k = 2.75 m.",
        "The article's vehicle with the drag coefficient corrected to c/k = 0.0275 m.",
    ];
    /// Rotor drag as printed in the article, N m s^2/rad^2.
    const PRINTED_DRAG: f64 = 1.98e-6;
}

impl Settings for VehicleSettings {
    const KEY: &'static str = "model";
    const NAMES: &'static [&'static str] = &["article", "article-corrected"];
    const SOURCES: &'static [&'static str] = &[include_str!("vehicle.rs"); 2];

    fn named(name: &str) -> Option<Self> {
        let preset = Self::NAMES.iter().position(|known| *known == name)?;
        let mut vehicle =
            Vehicle { inertia: Vec3::new(2.6e-3, 2.4e-3, 2.6e-3), ..Vehicle::default() };
        if preset == 0 {
            vehicle.drag_coefficient = Self::PRINTED_DRAG;
        }
        Some(Self { preset, vehicle })
    }

    fn name(&self) -> &'static str {
        Self::NAMES[self.preset % Self::NAMES.len()]
    }

    fn settings(&mut self, v: &mut impl SettingsVisitor) {
        self.vehicle.visit_mut(&Path::ROOT, &Meta::signal("", ""), v);
    }
}
