//! What surrounds the vehicle at one tick: all disturbances together.

use stormpetrel_control::math::{Body, Vec3, World};
use stormpetrel_control::real::Real;
use stormpetrel_control::record;
use stormpetrel_control::record::same;
use stormpetrel_control::signals::Measurement;

use super::Flight;
use crate::actuation::Actuation;
use crate::aerodynamics::drag;
use crate::dispatch::{Work, wide};
use crate::disturbance::{Cargo, Disturbance, MOST, Reach, RotorFaults, Scene, Source};
use crate::dynamics::{Push, Reciprocals};
use crate::sensor::{Sensing, Truth};
use crate::sling::{Hanging, Sling};
use crate::vehicle::Vehicle;
use crate::world::{Conditions, Scenery, Seen, Whole, look};

record! {
    /// All disturbances of a tick, summed by what they touch.
    pub struct Surroundings {
        /// Force and torque.
        push: Push<T> [];
        /// Velocity of the air.
        wind: Vec3<T, World> [m/s];
        /// Rigid load.
        cargo: Cargo<T> [];
        /// Mass on a cable.
        sling: Sling<T> [];
        /// Broken rotors.
        rotors: RotorFaults<T> [];
    }
}

record! {
    /// The air at one tick.
    pub struct Air {
        /// Velocity of the air.
        wind: Vec3<T, World> [m/s];
        /// Force of the air on the body.
        force: Vec3<T, World> [N];
        /// Torque of the air on the body.
        torque: Vec3<T, Body> [N m];
    }
}

/// What a flight has to look after beside pushes; equal in all lanes of a batch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[allow(clippy::struct_excessive_bools)] // each asks for another part of the world
pub struct Cares {
    /// The air acts on the body or on the rotors.
    pub air: bool,
    /// The centre of mass may lie off the rotors' centre, or a payload may come and go.
    pub laden: bool,
    /// Something may hang on a cable.
    pub sling: bool,
    /// The rotors have troubles of their own.
    pub propulsion: bool,
    /// Some disturbance is not harmonic.
    pub more: bool,
    /// Disturbances there are, those without effect before the last included.
    pub sources: usize,
    /// The laws see through sensors.
    pub sensing: bool,
}

impl Cares {
    /// Whether the whole world is needed: more than pushes.
    #[inline(always)]
    pub fn any(self) -> bool {
        self.air || self.laden || self.sling || self.propulsion || self.sensing
    }
}

impl Flight<f64> {
    /// What this flight has to look after.
    pub(super) fn cares(&self) -> Cares {
        let touches = |reach| self.disturbance.iter().any(|source| source.reach() == reach);
        let center = self.vehicle.center_of_mass;
        Cares {
            air: self.vehicle.feels_air(),
            laden: touches(Reach::Cargo) || center.norm_squared() > 0.0,
            sling: touches(Reach::Sling),
            propulsion: matches!(self.actuation, Actuation::Propulsion(_)),
            sensing: self.sensing.estimate,
            sources: self
                .disturbance
                .iter()
                .rposition(|source| source.reach() != Reach::Nothing)
                .map_or(0, |last| last + 1),
            more: self.disturbance.iter().any(|source| {
                !matches!(source.what, Disturbance::Calm(_) | Disturbance::Harmonic(_))
            }),
        }
    }
}

impl<T: Real> Flight<T> {
    /// What a disturbance may know now.
    #[inline(always)]
    fn scene(&self) -> Scene<T> {
        Scene {
            time: self.time(),
            tick: self.ticks(),
            step: self.control_step,
            state: self.state,
            mass: self.vehicle.mass,
        }
    }

    /// What pushes the vehicle over this tick. The plainest disturbance is asked in the loop itself; the
    /// rest of the world is prepared where there is any.
    #[inline(always)]
    pub(super) fn surroundings(&mut self) -> Push<T> {
        let mut push = Push::default();
        let (time, mass) = (self.time(), self.vehicle.mass);
        for source in self.disturbance.iter().take(self.cares.sources) {
            if let Some(one) = source.harmonic(time, mass) {
                push.add(&one);
            }
        }
        if self.cares.more || self.cares.any() {
            push = self.prepare(&same(&push));
        }
        push
    }

    /// Asks every disturbance beside the harmonic ones, which `push` already, and prepares what stays
    /// constant over the tick; gives the sum of all pushes.
    #[inline(never)]
    fn prepare(&mut self, push: &Push<T>) -> Push<T> {
        let calm = Surroundings { rotors: RotorFaults::none(), ..Surroundings::default() };
        let mut around = Surroundings { push: *push, ..calm };
        if self.cares.more {
            let scene = self.scene();
            around = survey(&mut self.disturbance, scene, around);
        }
        if self.cares.any() {
            self.lade(&around);
        }
        (self.faults, self.conditions.wind) = (around.rotors, around.wind);
        around.push
    }

    /// Prepares the vehicle with its load.
    fn lade(&mut self, around: &Surroundings<T>) {
        let Cargo { mass, place } = around.cargo;
        let (mut per, mut share, mut shift) = (self.per, T::one(), self.vehicle.center_of_mass);
        if self.cares.laden {
            let whole = self.vehicle.mass + mass;
            let reduced = self.vehicle.mass * mass / whole;
            let square = place.norm_squared();
            let parallel = place.map(|r| square - r.sq());
            self.laden = Vehicle {
                mass: whole,
                inertia: self.vehicle.inertia + parallel * reduced,
                ..self.vehicle
            };
            per = Reciprocals::new(&self.laden);
            share = self.vehicle.mass * per.mass;
            shift += place * (mass * per.mass);
        }
        if self.cares.sling {
            self.hanging = around.sling.attach(&self.hanging);
        }
        self.conditions = Conditions {
            sling: around.sling,
            share,
            shift,
            airy: self.cares.air,
            hangs: self.cares.sling,
            laden: self.cares.laden,
            ..Conditions::new(&per, &around.push)
        };
    }

    /// The vehicle as it is now, its load included.
    #[inline(always)]
    pub fn body(&self) -> &Vehicle<T> {
        if self.cares.laden { &self.laden } else { &self.vehicle }
    }

    /// What acts on the vehicle now.
    pub(super) fn look(&self) -> Seen<T> {
        let (vehicle, actuation) = (self.body(), &self.actuation);
        let whole = Whole { body: self.state, hanging: self.hanging };
        look(&whole, Scenery { vehicle, actuation, conditions: &self.conditions })
    }

    /// What there is to be sensed now.
    pub(super) fn truth(&self) -> Truth<T> {
        let Measurement { achieved, unallocated, .. } = self.measure();
        let weightless = self.acceleration() + Vec3::up(self.vehicle.gravity);
        let specific_force = self.state.attitude.inverse() * weightless;
        Truth { state: self.state, specific_force, achieved, unallocated }
    }

    /// What sensors and filter make of the truth.
    #[inline(never)]
    pub(super) fn sense(&mut self) -> Measurement<T> {
        let (truth, tick, step) = (self.truth(), self.ticks(), self.control_step);
        let sensing = &mut self.sensing;
        let mut told = wide::<T, _>(Senses { sensing, truth, tick, step });
        if self.sensing.has_telemetry() {
            told.achieved = self.sensing.achieved(&self.vehicle);
        }
        told
    }

    /// True acceleration, m/s^2.
    pub fn acceleration(&self) -> Vec3<T, World> {
        self.look().slope.body.velocity
    }

    /// What of this acceleration the law's model does not explain, N.
    #[inline(never)]
    pub(super) fn unexplained(&self, acceleration: Vec3<T, World>) -> Vec3<T, World> {
        let a = acceleration + Vec3::up(self.model.gravity);
        let expected = self.thrust_per_mass * (self.vehicle.mass * self.belief);
        a * self.model.mass - expected
    }

    /// True force (N, world) and torque (N m, body) of each disturbance at the tick that `decide` began, in
    /// the order of the scenario; `before` are the disturbances as they were before it. The force of a wind
    /// is what the air does to the body with it, less what it does without it; that of a load is what the
    /// vehicle feels of it.
    pub fn attributed(&self, before: [Source<T>; MOST]) -> [Push<T>; MOST] {
        let (scene, wind, acceleration) = (self.scene(), self.conditions.wind, self.acceleration());
        let gravity = Vec3::up(self.vehicle.gravity);
        let mut pushes = [Push::default(); MOST];
        for (push, source) in pushes.iter_mut().zip(before) {
            let mut source = source;
            *push = match source.reach() {
                Reach::Nothing | Reach::Rotors => Push::default(),
                Reach::Body => source.push(&scene),
                Reach::Air => {
                    let without = wind - source.wind(&scene);
                    let with = drag(&self.state, &self.vehicle, wind);
                    let rest = drag(&self.state, &self.vehicle, without);
                    Push { force: with.force - rest.force, torque: with.torque - rest.torque }
                }
                Reach::Cargo => {
                    let Cargo { mass, place } = source.cargo(&scene);
                    let force = -(acceleration + gravity) * mass;
                    Push { force, torque: place.cross(self.state.attitude.inverse() * force) }
                }
                Reach::Sling => {
                    let Sling { mass, length, .. } = source.sling(&scene);
                    let per_length = T::one() / length;
                    let Hanging { place, velocity } = self.hanging;
                    let q = place * per_length;
                    // Newton's law for what hangs, along the cable.
                    let along = q.dot(acceleration + gravity);
                    let tension = mass * (velocity.norm_squared() * per_length - along);
                    Push { force: q * tension.max(T::zero()), torque: Vec3::zero() }
                }
            };
        }
        pushes
    }
}

/// Sensors and filter, on the widest registers.
struct Senses<'a, T: Real> {
    sensing: &'a mut Sensing<T>,
    truth: Truth<T>,
    tick: T,
    step: T,
}

impl<T: Real> Work for Senses<'_, T> {
    type Output = Measurement<T>;
    #[inline(always)]
    fn run(self) -> Measurement<T> {
        self.sensing.measure(&self.truth, self.tick, self.step)
    }
}

/// Disturbances, asked on the widest registers.
struct Survey<'a, T> {
    sources: &'a mut [Source<T>; MOST],
    scene: Scene<T>,
    all: Surroundings<T>,
}

impl<T: Real> Work for Survey<'_, T> {
    type Output = Surroundings<T>;
    #[inline(always)]
    fn run(self) -> Surroundings<T> {
        let Self { sources, scene, mut all } = self;
        for source in sources {
            match source.reach() {
                Reach::Body if !matches!(source.what, Disturbance::Harmonic(_)) => {
                    all.push.add(&source.push(&scene));
                }
                Reach::Nothing | Reach::Body => {}
                Reach::Air => all.wind += source.wind(&scene),
                Reach::Cargo => {
                    let cargo = source.cargo(&scene);
                    all.cargo.place = joint(&all.cargo, &cargo);
                    all.cargo.mass += cargo.mass;
                }
                Reach::Sling => all.sling = source.sling(&scene),
                Reach::Rotors => all.rotors.add(&source.rotors(&scene)),
            }
        }
        all
    }
}

/// All together: what the harmonic ones do, and what the others add.
#[inline(never)]
fn survey<T: Real>(
    sources: &mut [Source<T>; MOST],
    scene: Scene<T>,
    all: Surroundings<T>,
) -> Surroundings<T> {
    wide::<T, _>(Survey { sources, scene, all })
}

/// Common place of two loads.
#[inline(always)]
fn joint<T: Real>(a: &Cargo<T>, b: &Cargo<T>) -> Vec3<T, Body> {
    let mass = a.mass + b.mass;
    let some = T::zero().lt(mass);
    let per_mass = T::one() / T::select(some, mass, T::one());
    Vec3::select(some, (a.place * a.mass + b.place * b.mass) * per_mass, b.place)
}
