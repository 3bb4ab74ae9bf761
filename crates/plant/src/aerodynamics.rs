//! The body in moving air.
//!
//!   u = R^T (v - w)                                    velocity through the air, body axes   (1)
//!   F = -R (D u + c_q |u| u)                                                                 (2)
//!   tau = -(d + d_u |u| + d_2 |omega|) omega           axis by axis                          (3)
//!
//! | symbol | meaning |
//! |---|---|
//! | w | wind, world, held over a control tick |
//! | D | linear rotor drag, diagonal |
//! | `c_q` | quadratic drag of the body |
//! | d, `d_u`, `d_2` | rotational drag: linear, by airspeed, quadratic |
//!
//! Source: linear rotor drag as in Faessler, Franchi and Scaramuzza, RA-L 2018; rotational damping by
//! airspeed as in NESC check-case 3 (NASA/TM-2015-218675). A rotor that is lost leaves a torque that
//! only (3) balances.

use stormpetrel_control::math::{Body, Vec3, World};
use stormpetrel_control::real::Real;

use crate::dynamics::Push;
use crate::state::State;
use crate::vehicle::Vehicle;

/// Velocity of the body through the air (1), m/s.
#[inline(always)]
pub fn through_air<T: Real>(state: &State<T>, wind: Vec3<T, World>) -> Vec3<T, Body> {
    state.attitude.inverse() * (state.velocity - wind)
}

/// Force (world) and torque (body) of the air on the body, (2) and (3).
#[inline(always)]
pub fn drag<T: Real>(state: &State<T>, vehicle: &Vehicle<T>, wind: Vec3<T, World>) -> Push<T> {
    let u = through_air(state, wind);
    let airspeed = u.norm();
    let force = u.scale(vehicle.rotor_drag) + u * (vehicle.body_drag * airspeed);
    let omega = state.rate;
    let damping = vehicle.rate_drag
        + vehicle.rate_drag_airspeed * airspeed
        + vehicle.rate_drag_quadratic.scale(omega.map(Real::abs));
    Push { force: -(state.attitude * force), torque: -omega.scale(damping) }
}
