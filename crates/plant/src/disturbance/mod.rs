//! What pushes, blows, hangs and breaks: every disturbance with its onset and its end.
//!
//! A kind touches one thing ([`Reach`]): it pushes with a true force (N, world) and torque (N m, body),
//! moves the air, loads the vehicle, hangs from it, or breaks a rotor.

mod source;

use stormpetrel_control::controller::Plain;
use stormpetrel_control::math::{Body, Vec3, World};
use stormpetrel_control::real::Real;
use stormpetrel_control::record::RecordExt as _;
use stormpetrel_control::{record, registry};

use crate::dynamics::Push;
use crate::random::named;
use crate::sling::Sling;
use crate::state::State;
use crate::vehicle::Vehicle;

pub use source::{Source, SourceSettings, Window};

/// How many disturbances a scenario may combine.
pub const MOST: usize = 8;

record! {
    /// What a disturbance may know of the flight at a tick.
    pub struct Scene {
        /// Time since the onset of the disturbance.
        time: T [s];
        /// Ticks since the flight began: the counter of random draws.
        tick: T [count];
        /// Time between two ticks.
        step: T [s];
        /// True state of the vehicle.
        state: State<T> [];
        /// Mass of the vehicle.
        mass: T [kg];
    }
}

record! {
    /// What is wrong with the rotors.
    pub struct RotorFaults {
        /// Thrust and drag torque over those of a healthy rotor; 0 for a lost one.
        health: [T; 4] [1];
        /// 1 where the rotor keeps its speed whatever is commanded.
        stuck: [T; 4] [1];
    }
}

impl<T: Real> RotorFaults<T> {
    /// Nothing.
    #[inline(always)]
    pub fn none() -> Self {
        Self { health: [T::one(); 4], stuck: [T::zero(); 4] }
    }

    /// Both together.
    #[inline(always)]
    pub fn add(&mut self, other: &Self) {
        for i in 0..4 {
            self.health[i] = self.health[i] * other.health[i];
            self.stuck[i] = self.stuck[i].max(other.stuck[i]);
        }
    }
}

record! {
    /// A rigid load.
    pub struct Cargo {
        /// Mass; 0 while there is none.
        mass: T [kg];
        /// Place from the vehicle's centre of mass.
        place: Vec3<T, Body> [m];
    }
}

/// What a kind of disturbance touches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reach {
    /// Nothing.
    Nothing,
    /// Force and torque on the body.
    Body,
    /// The air around it.
    Air,
    /// Its mass and inertia.
    Cargo,
    /// A mass on a cable.
    Sling,
    /// Its rotors.
    Rotors,
}

/// A kind of disturbance. Each answers the call that its reach names.
pub trait Disturb<T: Real>: Plain<T> {
    /// What it touches.
    fn reach(&self) -> Reach {
        Reach::Body
    }
    /// Whether its own numbers change from tick to tick.
    fn remembers(&self) -> bool {
        false
    }
    /// Force and torque.
    #[inline(always)]
    fn push(&mut self, _scene: &Scene<T>) -> Push<T> {
        Push::default()
    }
    /// Velocity of the air, m/s.
    #[inline(always)]
    fn wind(&mut self, _scene: &Scene<T>) -> Vec3<T, World> {
        Vec3::zero()
    }
    /// Rigid load.
    fn cargo(&self) -> Cargo<T> {
        Cargo::default()
    }
    /// Mass on a cable.
    fn sling(&self) -> Sling<T> {
        Sling::default()
    }
    /// Broken rotors.
    #[inline(always)]
    fn rotors(&self, _scene: &Scene<T>) -> RotorFaults<T> {
        RotorFaults::none()
    }
}

/// What a disturbance is built from: the vehicle, the control step, and the key of its random streams.
#[derive(Clone, Copy, Debug)]
pub struct Site<T> {
    /// The vehicle.
    pub vehicle: Vehicle<T>,
    /// Time between two ticks, s.
    pub step: T,
    /// Key of its random streams.
    pub key: u64,
}

impl<T> Site<T> {
    /// The same with the streams of a block of this name; `occurrence` tells blocks of one name apart.
    pub fn at(self, name: &str, occurrence: usize) -> Self {
        let key = named(self.key.wrapping_add(occurrence as u64), name);
        Self { key, ..self }
    }
}

/// Whether a number from 1 means the rotor at this index.
#[inline(always)]
fn is_rotor<T: Real>(number: T, index: usize) -> T::Mask {
    number.eq(T::lit(index as f64 + 1.0))
}

macro_rules! dispatch_disturb {
    ($name:ident [$($variant:ident)+] ()) => {
        impl<T: Real> Disturb<T> for $name<T> {
            #[inline(always)]
            fn reach(&self) -> Reach {
                match self { $( Self::$variant(all) => all.reach(), )+ }
            }
            #[inline(always)]
            fn remembers(&self) -> bool {
                match self { $( Self::$variant(all) => all.remembers(), )+ }
            }
            #[inline(always)]
            fn push(&mut self, scene: &Scene<T>) -> Push<T> {
                let (mut push, scene) = (Push::default(), *scene);
                match self { $( Self::$variant(all) => {
                    let mut local = *all;
                    for i in 0..T::PARTS {
                        let mut one = local.pick(i);
                        one.push(&scene.pick(i)).put(&mut push, i);
                        if one.remembers() {
                            one.put(&mut local, i);
                        }
                    }
                    if all.remembers() {
                        *all = local;
                    }
                } )+ }
                push
            }
            #[inline(always)]
            fn wind(&mut self, scene: &Scene<T>) -> Vec3<T, World> {
                let (mut wind, scene) = (Vec3::zero(), *scene);
                match self { $( Self::$variant(all) => {
                    let mut local = *all;
                    for i in 0..T::PARTS {
                        let mut one = local.pick(i);
                        one.wind(&scene.pick(i)).put(&mut wind, i);
                        if one.remembers() {
                            one.put(&mut local, i);
                        }
                    }
                    if all.remembers() {
                        *all = local;
                    }
                } )+ }
                wind
            }
            fn cargo(&self) -> Cargo<T> {
                match self { $( Self::$variant(all) => all.cargo(), )+ }
            }
            fn sling(&self) -> Sling<T> {
                match self { $( Self::$variant(all) => all.sling(), )+ }
            }
            #[inline(always)]
            fn rotors(&self, scene: &Scene<T>) -> RotorFaults<T> {
                match self { $( Self::$variant(all) => all.rotors(scene), )+ }
            }
        }
    };
}

registry! {
    /// Disturbances, under their names in scenario files.
    pub enum Disturbance / DisturbanceSettings keyed "kind" from Site;
    dispatch dispatch_disturb () apart;
    "none" => Calm in none;
    "constant" => Constant in constant;
    "step" => Step in step;
    "pulse" => Pulse in pulse;
    "ramp" => Ramp in ramp;
    "harmonic" => Harmonic in harmonic;
    "chirp" => Chirp in chirp;
    "noise" => Noise in noise;
    "recorded-force" => RecordedForce in recorded_force;
    "wind" => Wind in wind;
    "gust" => Gust in gust;
    "shear" => Shear in shear;
    "jet" => Jet in jet;
    "dryden" => Dryden in dryden;
    "recorded-wind" => RecordedWind in recorded_wind;
    "payload" => Payload in payload;
    "slung-mass" => SlungMass in slung_mass;
    "rotor-efficiency" => RotorEfficiency in rotor_efficiency;
    "rotor-stuck" => RotorStuck in rotor_stuck;
    "rotor-lost" => RotorLost in rotor_lost;
    "imbalance" => Imbalance in imbalance;
}
