//! Newton and Euler, and the integrator.
//!
//!   x' = v                                                               (1)
//!   v' = a_T - g e_z + d_f/m                                             (2)
//!   q' = 1/2 q (x) (0, omega)                                            (3)
//!   I omega' = -omega x I omega + tau + d_tau                            (4)
//!
//! a_T is the rotors' thrust per mass. In principal axes (4) is one line for each, the others in turn:
//!   omega_x' = (I_y - I_z)/I_x omega_y omega_z + (tau_x + d_tau_x)/I_x   (5)
//! The quaternion replaces the article's Euler angles, which are singular at 90 deg of pitch; the force
//! disturbance enters divided by the mass, which the article forgets. Classical Runge-Kutta of order 4;
//! the quaternion is normalised after every step. The rotors follow their commands whatever the body
//! does, so their speeds at the three stages are exact.

use stormpetrel_control::math::{Body, Vec3, World};
use stormpetrel_control::real::Real;
use stormpetrel_control::record;

use crate::actuation::Actuate;
use crate::state::{Derivative, State};
use crate::vehicle::Vehicle;

record! {
    /// What pushes the vehicle from outside.
    pub struct Push {
        /// Force on the centre of mass.
        force: Vec3<T, World> [N];
        /// Torque about the centre of mass.
        torque: Vec3<T, Body> [N m];
    }
}

/// Acceleration of the centre of mass (2), m/s^2.
#[inline(always)]
pub fn acceleration<T: Real>(
    thrust_per_mass: Vec3<T, World>,
    push_per_mass: Vec3<T, World>,
    gravity: T,
) -> Vec3<T, World> {
    thrust_per_mass - Vec3::up(gravity) + push_per_mass
}

record! {
    /// One over mass and inertia: divisions are slow, and these are the same at every tick.
    pub struct Reciprocals {
        /// Of the mass.
        mass: T [1/kg];
        /// Of the moments of inertia.
        inertia: Vec3<T, Body> [1/(kg m^2)];
        /// Difference of the two other moments of inertia over the own one.
        coupling: Vec3<T, Body> [1];
    }
}

impl<T: Real> Reciprocals<T> {
    /// Of this vehicle.
    pub fn new(vehicle: &Vehicle<T>) -> Self {
        let i = vehicle.inertia;
        Self {
            mass: T::one() / vehicle.mass,
            inertia: i.map(|i| T::one() / i),
            coupling: Vec3::new((i.y - i.z) / i.x, (i.z - i.x) / i.y, (i.x - i.y) / i.z),
        }
    }
}

impl<T: Real> Push<T> {
    /// Both together.
    #[inline(always)]
    pub fn add(&mut self, other: &Self) {
        self.force += other.force;
        self.torque += other.torque;
    }
}

record! {
    /// What stays constant over a control tick, prepared once.
    pub struct Held {
        /// Disturbance force per mass.
        push_per_mass: Vec3<T, World> [m/s^2];
        /// Disturbance torque.
        torque: Vec3<T, Body> [N m];
        /// Reciprocal moments of inertia.
        per_inertia: Vec3<T, Body> [1/(kg m^2)];
        /// Difference of the two other moments of inertia over the own one.
        coupling: Vec3<T, Body> [1];
    }
}

impl<T: Real> Held<T> {
    /// For this vehicle and push.
    #[inline(always)]
    pub fn new(per: &Reciprocals<T>, push: &Push<T>) -> Self {
        Held {
            push_per_mass: push.force * per.mass,
            torque: push.torque,
            per_inertia: per.inertia,
            coupling: per.coupling,
        }
    }
}

/// The time derivative of the state under the rotors' `torque`, (1) to (4).
#[inline(always)]
fn derivative<T: Real>(
    state: &State<T>,
    torque: Vec3<T, Body>,
    vehicle: &Vehicle<T>,
    actuation: &impl Actuate<T>,
    held: &Held<T>,
) -> Derivative<T> {
    let thrust = actuation.thrust_per_mass(state, vehicle);
    Derivative {
        position: state.velocity,                                            // (1)
        velocity: acceleration(thrust, held.push_per_mass, vehicle.gravity), // (2)
        attitude: spin(state),                                               // (3)
        rate: angular_acceleration(state, held, torque + held.torque),       // (5)
    }
}

/// q (x) (0, omega): twice the derivative of the quaternion (3).
#[inline(always)]
pub fn spin<T: Real>(state: &State<T>) -> [T; 4] {
    let (q, w) = (state.attitude, state.rate);
    [
        -(q.x * w.x + q.y * w.y + q.z * w.z),
        q.w * w.x + q.y * w.z - q.z * w.y,
        q.w * w.y + q.z * w.x - q.x * w.z,
        q.w * w.z + q.x * w.y - q.y * w.x,
    ]
}

/// Angular acceleration under this torque (5).
#[inline(always)]
pub fn angular_acceleration<T: Real>(
    state: &State<T>,
    held: &Held<T>,
    torque: Vec3<T, Body>,
) -> Vec3<T, Body> {
    let w = state.rate;
    let products = Vec3::new(w.y * w.z, w.z * w.x, w.x * w.y);
    products.scale(held.coupling) + torque.scale(held.per_inertia)
}

/// One Runge-Kutta step of `h` seconds; `actuation` has let them pass.
#[inline(always)]
pub fn runge_kutta<T: Real>(
    state: &State<T>,
    h: T,
    vehicle: &Vehicle<T>,
    actuation: &impl Actuate<T>,
    held: &Held<T>,
) -> State<T> {
    let torque = actuation.torque(state);
    let (mut next, _) = along_mean(state, torque, h, vehicle, actuation, held);
    next.attitude = next.attitude.renormalised();
    next
}

/// [`runge_kutta`] before the quaternion is normalised, where the rotors' torque is `torque` in the
/// beginning; also their torque in the end.
#[inline(always)]
pub fn along_mean<T: Real>(
    state: &State<T>,
    torque: Vec3<T, Body>,
    h: T,
    vehicle: &Vehicle<T>,
    actuation: &impl Actuate<T>,
    held: &Held<T>,
) -> (State<T>, Vec3<T, Body>) {
    let [half_way, end] = actuation.rotor_speeds(state);
    let slope = |at: &State<T>, torque| derivative(at, torque, vehicle, actuation, held);
    let k1 = slope(state, torque);
    let second = state.along(&k1, h.half(), half_way);
    let k2 = slope(&second, actuation.torque(&second));
    let third = state.along(&k2, h.half(), half_way);
    let k3 = slope(&third, actuation.torque(&third));
    let fourth = state.along(&k3, h, end);
    let last = actuation.torque(&fourth);
    let k4 = slope(&fourth, last);
    let (two, six) = (T::lit(2.0), T::lit(6.0));
    let mut sum: Derivative<T> =
        record::Record::zip([&k1, &k2, &k3, &k4], &mut |[a, b, c, d]| (a + d) + (b + c) * two);
    // The velocities of the four stages are state.velocity and what the slopes before added to it.
    sum.position = state.velocity * six + (k1.velocity + k2.velocity + k3.velocity) * h;
    (state.along(&sum, h * T::lit(1.0 / 6.0), end), last)
}
