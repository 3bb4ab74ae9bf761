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
use stormpetrel_control::record::Record as _;
use stormpetrel_control::signals::Wrench;

use crate::actuation::{Actuate as _, Actuation};
use crate::aerodynamics::drag;
use crate::dispatch::{Work, wide};
use crate::dynamics::{Held, acceleration, angular_acceleration, quaternion_rate};
use crate::sling::hang;
use crate::state::{Derivative, State};
use crate::vehicle::Vehicle;

record! {
    /// Time derivative of the whole state.
    pub struct Slope {
        /// Of the body.
        body: Derivative<T> [];
        /// Relative velocity of what hangs on a cable.
        cargo: Vec3<T, World> [m/s];
        /// Its relative acceleration.
        cargo_velocity: Vec3<T, World> [m/s^2];
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
    pub held: &'a Held<T>,
}

impl<T: Real> Scenery<'_, T> {
    /// The time derivative of the state, (1) and (2).
    #[inline(always)]
    pub fn slope(&self, state: &State<T>) -> Slope<T> {
        let Self { vehicle, actuation, held } = *self;
        let load = actuation.load(state, vehicle, held);
        let mut torque = load.torque + held.torque;
        let mut thrust = load.thrust_per_mass;
        if held.laden {
            thrust = thrust * held.share;
            let along = state.attitude.inverse() * (thrust * vehicle.mass);
            torque -= held.shift.cross(along);
        }
        let mut a = acceleration(thrust, held.push_per_mass, vehicle.gravity);
        if held.airy {
            let air = drag(state, vehicle, held.wind);
            a += air.force * held.per_mass;
            torque += air.torque;
        }
        let (mut cargo, mut cargo_velocity) = (Vec3::zero(), Vec3::zero());
        if held.hangs {
            let free = a + Vec3::up(vehicle.gravity);
            let hung = hang(state, free, held.per_mass, &held.sling);
            a += hung.pull; // (1)
            (cargo, cargo_velocity) = (state.cargo_velocity, hung.acceleration);
        }
        let body = Derivative {
            position: state.velocity,
            velocity: a,
            attitude: quaternion_rate(state),
            rate: angular_acceleration(state, vehicle, held, torque), // (2)
        };
        Slope { body, cargo, cargo_velocity }
    }

    /// One Runge-Kutta step of `h` seconds; the actuation has let them pass.
    #[inline(always)]
    fn runge_kutta(&self, state: &State<T>, h: T) -> State<T> {
        let [half_way, end] = self.actuation.rotor_speeds(state);
        let ahead =
            [(T::zero(), state.rotor_speed), (h.half(), half_way), (h.half(), half_way), (h, end)];
        let weights = [1.0, 2.0, 2.0, 1.0];
        let (mut last, mut sum) = (Slope::default(), Slope::default());
        // A loop, so that the world is compiled once and not four times.
        for (stage, (ahead, speeds)) in ahead.into_iter().enumerate() {
            last = self.slope(&along(state, &last, ahead, speeds));
            let weight = T::lit(weights[stage]);
            sum = Slope::zip([&sum, &last], &mut |[sum, k]| sum + k * weight);
        }
        let mut next = along(state, &sum, h * T::lit(1.0 / 6.0), end);
        next.attitude = next.attitude.normalised();
        if self.held.hangs {
            self.held.sling.tighten(&mut next);
        }
        next
    }
}

/// The state `h` seconds on along a constant slope, with these rotor speeds.
#[inline(always)]
fn along<T: Real>(state: &State<T>, slope: &Slope<T>, h: T, rotor_speed: [T; 4]) -> State<T> {
    State {
        cargo: state.cargo + slope.cargo * h,
        cargo_velocity: state.cargo_velocity + slope.cargo_velocity * h,
        ..state.along(&slope.body, h, rotor_speed)
    }
}

/// Runge-Kutta steps through the whole world.
struct Moving<'a, T> {
    state: State<T>,
    h: T,
    steps: u32,
    vehicle: &'a Vehicle<T>,
    actuation: &'a mut Actuation<T>,
    held: &'a Held<T>,
}

impl<T: Real> Work for Moving<'_, T> {
    type Output = State<T>;
    #[inline(always)]
    fn run(self) -> State<T> {
        let Self { mut state, h, steps, vehicle, actuation, held } = self;
        for _ in 0..steps {
            actuation.pass(h);
            let scenery = Scenery { vehicle, actuation, held };
            state = scenery.runge_kutta(&state, h);
        }
        state
    }
}

/// The state after so many Runge-Kutta steps of `h` seconds.
#[inline(never)]
pub fn advance<T: Real>(
    state: &State<T>,
    h: T,
    steps: u32,
    vehicle: &Vehicle<T>,
    actuation: &mut Actuation<T>,
    held: &Held<T>,
) -> State<T> {
    wide::<T, _>(Moving { state: *state, h, steps, vehicle, actuation, held })
}

record! {
    /// What acts on the vehicle at one moment.
    pub struct Seen {
        /// Acceleration.
        acceleration: Vec3<T, World> [m/s^2];
        /// Angular acceleration and the rest of the derivative.
        slope: Slope<T> [];
        /// Thrust and torque of the rotors.
        rotors: Wrench<T> [];
        /// Force of the air on the body.
        air_force: Vec3<T, World> [N];
        /// Torque of the air on the body.
        air_torque: Vec3<T, Body> [N m];
    }
}

struct Looking<'a, T> {
    state: State<T>,
    scenery: Scenery<'a, T>,
}

impl<T: Real> Work for Looking<'_, T> {
    type Output = Seen<T>;
    #[inline(always)]
    fn run(self) -> Seen<T> {
        let Self { state, scenery } = self;
        let Scenery { vehicle, actuation, held } = scenery;
        let slope = scenery.slope(&state);
        let load = actuation.load(&state, vehicle, held);
        let along = load.thrust_per_mass.dot(state.attitude.z_axis());
        let mut seen = Seen {
            acceleration: slope.body.velocity,
            slope,
            rotors: Wrench { thrust: along * vehicle.mass * held.share, torque: load.torque },
            ..Seen::default()
        };
        if held.airy {
            let air = drag(&state, vehicle, held.wind);
            (seen.air_force, seen.air_torque) = (air.force, air.torque);
        }
        seen
    }
}

/// What acts on the vehicle now.
#[inline(never)]
pub fn look<T: Real>(state: &State<T>, scenery: Scenery<'_, T>) -> Seen<T> {
    wide::<T, _>(Looking { state: *state, scenery })
}
