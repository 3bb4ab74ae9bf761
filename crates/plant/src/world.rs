//! The vehicle in the whole world: air, payload, cable and rotors with troubles of their own.
//!
//!   v' = s a_T - g e_z + (d_f + F + T q)/m                               (1)
//!   I omega' = -omega x I omega + tau - r x R^T (s m a_T) + d_tau + tau_F   (2)
//!
//! | symbol | meaning |
//! |---|---|
//! | `a_T`, tau | the rotors' thrust per mass and torque |
//! | s, r | mass without over mass with the payload; centre of mass from the rotors' centre |
//! | F, `tau_F` | the air on the body, see [`crate::aerodynamics`] |
//! | T q | the cable, see [`crate::sling`] |
//!
//! The rest is as in [`crate::dynamics`], which is what remains where nothing but pushes disturbs. The
//! whole world is compiled once for each width, behind a boundary of its own.

use stormpetrel_control::math::{Body, Vec3, World};
use stormpetrel_control::real::Real;
use stormpetrel_control::record;
use stormpetrel_control::record::{Record as _, RecordExt as _};
use stormpetrel_control::signals::Wrench;

use crate::actuation::{Actuate as _, Actuation, Load};
use crate::aerodynamics::drag;
use crate::dispatch::{Work, wide};
use crate::dynamics::{Held, Push, Reciprocals, acceleration, angular_acceleration, spin};
use crate::sling::{Hanging, Sling, hang};
use crate::state::{Derivative, State};
use crate::vehicle::Vehicle;

record! {
    /// What stays constant over a control tick, prepared once.
    pub struct Conditions {
        /// Pushes, and reciprocal moments of inertia.
        held: Held<T> [];
        /// Reciprocal mass.
        per_mass: T [1/kg];
        /// Wind.
        wind: Vec3<T, World> [m/s];
        /// What hangs from the vehicle.
        sling: Sling<T> [];
        /// Mass without over mass with a payload, s.
        share: T [1];
        /// Centre of mass from the rotors' centre, payload included, r.
        shift: Vec3<T, Body> [m];
        structure {
            /// Whether the centre of mass may lie off the rotors' centre.
            laden: bool;
            /// Whether the air acts on the body.
            airy: bool;
            /// Whether something hangs from it.
            hangs: bool;
        }
    }
}

impl<T: Real> Conditions<T> {
    /// For this vehicle and push, in air that does not act and with nothing on a cable.
    pub fn new(per: &Reciprocals<T>, push: &Push<T>) -> Self {
        let held = Held::new(per, push);
        Self { held, per_mass: per.mass, share: T::one(), ..Self::default() }
    }
}

record! {
    /// The state of the vehicle and of what hangs from it.
    pub struct Whole {
        /// The vehicle.
        body: State<T> [];
        /// What hangs from it.
        hanging: Hanging<T> [];
    }
}

record! {
    /// Time derivative of the whole state.
    pub struct Slope {
        /// Of the vehicle.
        body: Derivative<T> [];
        /// Of what hangs from it: relative velocity and acceleration in the places of place and velocity.
        hanging: Hanging<T> [];
    }
}

/// A vehicle and what acts on it during a tick.
#[derive(Clone, Copy, Debug)]
pub struct Scenery<'a, T> {
    /// The vehicle, its payload included.
    pub vehicle: &'a Vehicle<T>,
    /// Its rotors.
    pub actuation: &'a Actuation<T>,
    /// What stays constant over the tick.
    pub conditions: &'a Conditions<T>,
}

impl<T: Real> Scenery<'_, T> {
    /// The time derivative of the state, (1) and (2).
    #[inline(always)]
    pub fn slope(&self, whole: &Whole<T>) -> Slope<T> {
        self.under(
            whole,
            &self.actuation.load(&whole.body, self.vehicle, self.conditions),
            &self.air(&whole.body),
        )
    }

    /// The time derivative of the state under what rotors and air do. Lane by lane in each part: the loop
    /// vectoriser takes a part as a whole.
    #[inline(always)]
    fn under(&self, whole: &Whole<T>, load: &Load<T>, air: &Push<T>) -> Slope<T> {
        let Self { vehicle, conditions, .. } = *self;
        let mut load = *load;
        if conditions.laden {
            load = self.off_centre(&whole.body, &load);
        }
        let mut body = Derivative::default();
        for i in 0..T::PARTS {
            let (state, around) = (whole.body.pick(i), conditions.pick(i));
            newton_euler(&state, &load.pick(i), &air.pick(i), &vehicle.pick(i), &around)
                .put(&mut body, i);
        }
        let mut hanging = Hanging::default();
        if conditions.hangs {
            let mut pull = Vec3::zero();
            for i in 0..T::PARTS {
                let (now, around) = (whole.hanging.pick(i), conditions.pick(i));
                let free = body.velocity.pick(i) + Vec3::up(vehicle.gravity.part(i));
                let hung = hang(&now, free, around.per_mass, &around.sling);
                hung.pull.put(&mut pull, i);
                Hanging { place: now.velocity, velocity: hung.acceleration }.put(&mut hanging, i);
            }
            body.velocity += pull; // (1)
        }
        Slope { body, hanging }
    }

    /// What the air does to the body.
    #[inline(always)]
    fn air(&self, state: &State<T>) -> Push<T> {
        let mut air = Push::default();
        if self.conditions.airy {
            for i in 0..T::PARTS {
                let (state, vehicle) = (state.pick(i), self.vehicle.pick(i));
                drag(&state, &vehicle, self.conditions.wind.pick(i)).put(&mut air, i);
            }
        }
        air
    }

    /// The rotors' thrust on a body whose centre of mass lies off their centre.
    #[inline(always)]
    fn off_centre(&self, state: &State<T>, load: &Load<T>) -> Load<T> {
        let mut moved = Load::default();
        for i in 0..T::PARTS {
            let (load, around) = (load.pick(i), self.conditions.pick(i));
            let thrust_per_mass = load.thrust_per_mass * around.share;
            let thrust = thrust_per_mass * self.vehicle.mass.part(i);
            let along = state.attitude.pick(i).inverse() * thrust;
            Load { thrust_per_mass, torque: load.torque - around.shift.cross(along) }
                .put(&mut moved, i);
        }
        moved
    }

    /// One Runge-Kutta step of `h` seconds; the actuation has let them pass.
    #[inline(always)]
    fn runge_kutta(&self, state: &Whole<T>, h: T) -> Whole<T> {
        let [half_way, end] = self.actuation.rotor_speeds(&state.body);
        let ahead = [
            (T::zero(), state.body.rotor_speed, 1.0),
            (h.half(), half_way, 2.0),
            (h.half(), half_way, 2.0),
            (h, end, 1.0),
        ];
        let (mut last, mut sum) = (Slope::default(), Slope::default());
        // A loop, so that the world is compiled once and not four times.
        for (ahead, speeds, weight) in ahead {
            last = self.slope(&along(state, &last, ahead, speeds));
            accumulate(&mut sum, &last, weight);
        }
        let mut next = along(state, &sum, h * T::lit(1.0 / 6.0), end);
        next.body.attitude = next.body.attitude.renormalised();
        if self.conditions.hangs {
            self.conditions.sling.tighten(&mut next.hanging);
        }
        next
    }
}

/// Adds a slope with its weight.
#[inline(always)]
fn accumulate<T: Real>(sum: &mut Slope<T>, slope: &Slope<T>, weight: f64) {
    let weight = T::Part::lit(weight);
    for i in 0..T::PARTS {
        let (so_far, one) = (sum.pick(i), slope.pick(i));
        Slope::zip([&so_far, &one], &mut |[sum, k]| sum + k * weight).put(sum, i);
    }
}

/// The state `h` seconds on along a constant slope, with these rotor speeds.
#[inline(always)]
fn along<T: Real>(state: &Whole<T>, slope: &Slope<T>, h: T, rotor_speed: [T; 4]) -> Whole<T> {
    let mut next = Whole::default();
    for i in 0..T::PARTS {
        let (state, slope, h) = (state.pick(i), slope.pick(i), h.part(i));
        let Hanging { place, velocity } = state.hanging;
        Whole {
            body: state.body.along(&slope.body, h, rotor_speed.pick(i)),
            hanging: Hanging {
                place: place + slope.hanging.place * h,
                velocity: velocity + slope.hanging.velocity * h,
            },
        }
        .put(&mut next, i);
    }
    next
}

/// (1) and (2) without what hangs.
#[inline(always)]
fn newton_euler<T: Real>(
    state: &State<T>,
    load: &Load<T>,
    air: &Push<T>,
    vehicle: &Vehicle<T>,
    conditions: &Conditions<T>,
) -> Derivative<T> {
    let held = &conditions.held;
    let a = acceleration(load.thrust_per_mass, held.push_per_mass, vehicle.gravity);
    let torque = load.torque + held.torque + air.torque;
    Derivative {
        position: state.velocity,
        velocity: a + air.force * conditions.per_mass, // (1)
        attitude: spin(state),
        rate: angular_acceleration(state, held, torque), // (2)
    }
}

/// Runge-Kutta steps through the whole world.
struct Moving<'a, T> {
    state: Whole<T>,
    h: T,
    steps: u32,
    vehicle: &'a Vehicle<T>,
    actuation: &'a mut Actuation<T>,
    conditions: &'a Conditions<T>,
}

impl<T: Real> Work for Moving<'_, T> {
    type Output = Whole<T>;
    #[inline(always)]
    fn run(self) -> Whole<T> {
        let Self { mut state, h, steps, vehicle, actuation, conditions } = self;
        for _ in 0..steps {
            actuation.pass(h);
            let scenery = Scenery { vehicle, actuation, conditions };
            state = scenery.runge_kutta(&state, h);
        }
        state
    }
}

/// The state after so many Runge-Kutta steps of `h` seconds.
#[inline(never)]
pub fn advance<T: Real>(
    state: &Whole<T>,
    h: T,
    steps: u32,
    vehicle: &Vehicle<T>,
    actuation: &mut Actuation<T>,
    conditions: &Conditions<T>,
) -> Whole<T> {
    wide::<T, _>(Moving { state: *state, h, steps, vehicle, actuation, conditions })
}

record! {
    /// What acts on the vehicle at one moment.
    pub struct Seen {
        /// Derivative of the state.
        slope: Slope<T> [];
        /// Thrust and torque of the rotors.
        rotors: Wrench<T> [];
        /// The air on the body.
        air: Push<T> [];
    }
}

struct Looking<'a, T> {
    state: Whole<T>,
    scenery: Scenery<'a, T>,
}

impl<T: Real> Work for Looking<'_, T> {
    type Output = Seen<T>;
    #[inline(always)]
    fn run(self) -> Seen<T> {
        let Self { state, scenery } = self;
        let Scenery { vehicle, actuation, conditions } = scenery;
        let body = &state.body;
        let (load, air) = (actuation.load(body, vehicle, conditions), scenery.air(body));
        let slope = scenery.under(&state, &load, &air);
        let along = load.thrust_per_mass.dot(body.attitude.z_axis());
        let thrust = along * vehicle.mass * conditions.share;
        Seen { slope, rotors: Wrench { thrust, torque: load.torque }, air }
    }
}

/// What acts on the vehicle now.
#[inline(never)]
pub fn look<T: Real>(state: &Whole<T>, scenery: Scenery<'_, T>) -> Seen<T> {
    wide::<T, _>(Looking { state: *state, scenery })
}
