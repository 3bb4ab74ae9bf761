//! From the stack's command to the thrust and torque on the body.

pub mod battery;
pub mod curve;

use stormpetrel_control::controller::Plain;
use stormpetrel_control::math::{Body, Vec3, World};
use stormpetrel_control::real::Real;
use stormpetrel_control::record::RecordExt as _;
use stormpetrel_control::signals::Wrench;
use stormpetrel_control::stack::Exit;
use stormpetrel_control::{record, registry};

use self::battery::Gauge;
use crate::disturbance::RotorFaults;
use crate::dynamics::{Held, along_mean};
use crate::state::State;
use crate::vehicle::Vehicle;
use crate::world::Conditions;

record! {
    /// What the rotors do to the body.
    pub struct Load {
        /// Thrust per mass.
        thrust_per_mass: Vec3<T, World> [m/s^2];
        /// Torque.
        torque: Vec3<T, Body> [N m];
    }
}

record! {
    /// What is sent to the actuation.
    pub struct Sent {
        /// Thrust vector per mass.
        force: Vec3<T, World> [m/s^2];
        /// Thrust and torque.
        wrench: Wrench<T> [];
    }
}

/// Turns commands into thrust and torque.
pub trait Actuate<T: Real>: Plain<T> {
    /// Which level of the stack it listens to.
    fn exit(&self) -> Exit;
    /// Takes what is sent for the coming tick; returns the part that it cannot grant.
    fn command(&mut self, sent: &Sent<T>, vehicle: &Vehicle<T>) -> Wrench<T>;
    /// Told of each integration step of `h` seconds beforehand: a lag of its own passes them.
    #[inline(always)]
    fn pass(&mut self, _h: T) {}
    /// Forgets what was commanded, as at the start of a flight.
    fn reset(&mut self) {}
    /// Told at every tick what is broken; only rotors of their own can break.
    #[inline(always)]
    fn suffer(&mut self, _faults: &RotorFaults<T>, _state: &State<T>, _dt: T) {}
    /// What acts on the body in this state, where it is more than thrust and torque in still air.
    #[inline(always)]
    fn load(&self, _: &State<T>, _: &Vehicle<T>, _: &Conditions<T>) -> Option<Load<T>> {
        None
    }
    /// The rotors' thrust per mass, in still air, m/s^2.
    fn thrust_per_mass(&self, state: &State<T>, vehicle: &Vehicle<T>) -> Vec3<T, World>;
    /// The rotors' torque, in still air, N m.
    fn torque(&self, state: &State<T>) -> Vec3<T, Body>;
    /// [`Actuate::torque`] in the state in which it was `before`, ahead of the last command and of what
    /// [`Actuate::pass`] let pass: the same where the speeds of the rotors alone make it.
    #[inline(always)]
    fn torque_now(&self, _before: Vec3<T, Body>, state: &State<T>) -> Vec3<T, Body> {
        self.torque(state)
    }
    /// Total thrust along the body's up axis, in still air, N.
    fn thrust(&self, state: &State<T>) -> T;
    /// Rotor speeds at the middle and at the end of the step that `pass` was told of, rad/s.
    #[inline(always)]
    fn rotor_speeds(&self, state: &State<T>) -> [[T; 4]; 2] {
        [state.rotor_speed; 2]
    }
    /// Thrust and torque that the laws expect over those in still air.
    #[inline(always)]
    fn belief(&self) -> T {
        T::one()
    }
    /// Share of the rotors at a speed limit, 0..=1.
    #[inline(always)]
    fn saturation(&self) -> T {
        T::zero()
    }
    /// What feeds the rotors, where it sags.
    fn battery(&self) -> Option<Gauge<T>> {
        None
    }
}

macro_rules! dispatch_actuate {
    ($name:ident [$($variant:ident)+] ()) => {
        impl<T: Real> $name<T> {
            /// Thrust and torque of the rotors in this state, in still air.
            #[inline(always)]
            pub fn wrench(&self, state: &State<T>) -> Wrench<T> {
                let mut wrench = Wrench::default();
                match self { $( Self::$variant(all) => for i in 0..T::PARTS {
                    let (one, state) = (all.pick(i), state.pick(i));
                    Wrench { thrust: one.thrust(&state), torque: one.torque(&state) }.put(&mut wrench, i);
                } )+ }
                wrench
            }

            /// What the rotors do to the body in this state, vehicle by vehicle.
            #[inline(always)]
            pub fn load(&self, state: &State<T>, vehicle: &Vehicle<T>, around: &Conditions<T>) -> Load<T> {
                match self { $( Self::$variant(all) => {
                    // No closure: the compiler would not always inline it.
                    if let Some(load) = all.load(state, vehicle, around) {
                        return load;
                    }
                    let mut load = Load::default();
                    for i in 0..T::PARTS {
                        let (one, state) = (all.pick(i), state.pick(i));
                        let thrust_per_mass = one.thrust_per_mass(&state, &vehicle.pick(i));
                        Load { thrust_per_mass, torque: one.torque(&state) }.put(&mut load, i);
                    }
                    load
                } )+ }
            }

            /// The state `h` seconds on and the rotors' torque then, vehicle by vehicle, where nothing but
            /// pushes disturbs it. `torque` is theirs before the last command.
            #[inline(always)]
            pub fn step(&mut self, state: &State<T>, torque: Vec3<T, Body>, h: T, vehicle: &Vehicle<T>, held: &Held<T>) -> (State<T>, Vec3<T, Body>) {
                let (mut next, mut last) = (*state, Vec3::zero());
                match self { $( Self::$variant(all) => {
                    all.pass(h);
                    for i in 0..T::PARTS {
                        let (one, state) = (all.pick(i), state.pick(i));
                        let torque = one.torque_now(torque.pick(i), &state);
                        let (moved, turned) =
                            along_mean(&state, torque, h.part(i), &vehicle.pick(i), &one, &held.pick(i));
                        moved.put(&mut next, i);
                        turned.put(&mut last, i);
                    }
                } )+ }
                // All vehicles at once: only together can they pass by what none of them needs.
                next.attitude = next.attitude.renormalised();
                (next, last)
            }
        }

        impl<T: Real> Actuate<T> for $name<T> {
            #[inline(always)]
            fn exit(&self) -> Exit {
                match self { $( Self::$variant(x) => x.exit(), )+ }
            }
            #[inline(always)]
            fn command(&mut self, sent: &Sent<T>, vehicle: &Vehicle<T>) -> Wrench<T> {
                match self { $( Self::$variant(x) => x.command(sent, vehicle), )+ }
            }
            #[inline(always)]
            fn pass(&mut self, h: T) {
                match self { $( Self::$variant(x) => x.pass(h), )+ }
            }
            #[inline(always)]
            fn suffer(&mut self, faults: &RotorFaults<T>, state: &State<T>, dt: T) {
                match self { $( Self::$variant(x) => x.suffer(faults, state, dt), )+ }
            }
            fn reset(&mut self) {
                match self { $( Self::$variant(x) => x.reset(), )+ }
            }
            #[inline(always)]
            fn thrust_per_mass(&self, state: &State<T>, vehicle: &Vehicle<T>) -> Vec3<T, World> {
                let mut thrust = Vec3::zero();
                match self { $( Self::$variant(all) => for i in 0..T::PARTS {
                    all.pick(i).thrust_per_mass(&state.pick(i), &vehicle.pick(i)).put(&mut thrust, i);
                } )+ }
                thrust
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
            fn rotor_speeds(&self, state: &State<T>) -> [[T; 4]; 2] {
                match self { $( Self::$variant(x) => x.rotor_speeds(state), )+ }
            }
            #[inline(always)]
            fn belief(&self) -> T {
                match self { $( Self::$variant(x) => x.belief(), )+ }
            }
            #[inline(always)]
            fn saturation(&self) -> T {
                match self { $( Self::$variant(x) => x.saturation(), )+ }
            }
            fn battery(&self) -> Option<Gauge<T>> {
                match self { $( Self::$variant(x) => x.battery(), )+ }
            }
        }
    };
}

registry! {
    /// Actuations, under their names in scenario files.
    pub enum Actuation / ActuationSettings keyed "kind" from Vehicle;
    dispatch dispatch_actuate ();
    "thrust-vector" => ThrustVector in thrust_vector;
    "wrench" => IdealWrench in wrench;
    "lagged-wrench" => LaggedWrench in lagged_wrench;
    "rotors" => Rotors in rotors;
    "propulsion" => Propulsion in propulsion;
}
