//! Lissajous curve: each axis and the heading swing by themselves, from rest to full speed.
//!
//!   x_i = c_i + A_i sin(w_i phi(t) + p_i),   i = x, y, z                 (1)
//!   psi = psi0 + A_psi sin(w_psi phi(t) + p_psi)                         (2)
//!
//! phi' rises from 0 to 1 within `ramp` seconds as a polynomial of degree 7, so the snap is continuous.
//! The curve closes where the frequencies are in the ratio of whole numbers.

use stormpetrel_control::math::{Vec3, World};
use stormpetrel_control::real::Real;
use stormpetrel_control::record;
use stormpetrel_control::signals::Trajectory;

use super::Refer;
use super::phase::{Jet, chain, from_rest, sine, trajectory};
use crate::vehicle::Vehicle;

record! {
    /// Numbers of the Lissajous curve.
    pub struct Gains {
        /// Amplitude of each axis.
        amplitude: Vec3<T, World> [m] = 1.0, in 0.0 => 1e4;
        /// Angular frequency of each axis at full speed.
        frequency: Vec3<T, World> [rad/s] = 0.5, in -1e2 => 1e2;
        /// Phase of each axis at the start.
        phase: Vec3<T, World> [rad] = 0.0, in -6.3 => 6.3;
        /// Centre.
        center: Vec3<T, World> [m] = 0.0, in -1e6 => 1e6;
        /// Mean heading.
        yaw: T [rad] = 0.0, in -6.3 => 6.3;
        /// Amplitude of the heading.
        yaw_amplitude: T [rad] = 0.0, in 0.0 => 6.3;
        /// Angular frequency of the heading at full speed.
        yaw_frequency: T [rad/s] = 0.5, in -1e2 => 1e2;
        /// Phase of the heading at the start.
        yaw_phase: T [rad] = 0.0, in -6.3 => 6.3;
        /// Time from rest to full speed; below 1 ms at once.
        ramp: T [s] = 2.0, in 0.0 => 1e3;
    }
}

/// No choices.
pub type Options = ();

record! {
    /// Lissajous curve.
    pub struct Lissajous {
        /// Numbers.
        gains: Gains<T> [];
    }
}

impl<T: Real> Lissajous<T> {
    /// The reference.
    pub fn new(gains: Gains<T>, _: Options, _: &Vehicle<T>) -> Self {
        Self { gains }
    }
}

/// A swing about `middle`; angles in rad.
#[inline(always)]
fn swing<T: Real>(middle: T, amplitude: T, w: T, at_start: T, phase: Jet<T>) -> Jet<T> {
    let mut x = chain(sine(amplitude, w, (w * phase[0] + at_start).sin_cos()), phase);
    x[0] += middle;
    x
}

impl<T: Real> Refer<T> for Lissajous<T> {
    #[inline(always)]
    fn at(&self, time: T) -> Trajectory<T> {
        let Gains { amplitude: a, frequency: w, phase: p, center: c, .. } = self.gains;
        let Gains { yaw, yaw_amplitude, yaw_frequency, yaw_phase, ramp, .. } = self.gains;
        let phase = from_rest(time, ramp);
        let x = swing(c.x, a.x, w.x, p.x, phase); // (1)
        let y = swing(c.y, a.y, w.y, p.y, phase);
        let z = swing(c.z, a.z, w.z, p.z, phase);
        trajectory([x, y, z], swing(yaw, yaw_amplitude, yaw_frequency, yaw_phase, phase)) // (2)
    }
}
