//! Lemniscate of Gerono: a lying figure of eight, from rest to full speed.
//!
//!   x = x0 + a sin(theta),  y = y0 + a/2 sin(2 theta),  z = z0,   theta = 2 pi phi(t)/P   (1)
//!
//! It begins and crosses itself in the centre, is 2 a long and a wide, and is symmetric about both axes:
//! (x - x0)^4 = a^2 ((x - x0)^2 - (y - y0)^2). phi' rises from 0 to 1 within `ramp` seconds as a
//! polynomial of degree 7, so the snap is continuous. The speed is largest in the centre, sqrt(2) 2 pi a/P.

use stormpetrel_control::math::{Vec3, World};
use stormpetrel_control::real::Real;
use stormpetrel_control::record;
use stormpetrel_control::signals::Trajectory;

use super::Refer;
use super::phase::{chain, constant, from_rest, sine, trajectory};
use crate::vehicle::Vehicle;

record! {
    /// Numbers of the lemniscate.
    pub struct Gains {
        /// Half of its length, a.
        size: T [m] = 2.0, in 0.0 => 1e4;
        /// Time for the whole figure at full speed.
        period: T [s] = 10.0, in 0.05 => 1e5;
        /// Where it crosses itself.
        center: Vec3<T, World> [m] = 0.0, in -1e6 => 1e6;
        /// Heading.
        yaw: T [rad] = 0.0, in -6.3 => 6.3;
        /// Time from rest to full speed; below 1 ms at once.
        ramp: T [s] = 2.0, in 0.0 => 1e3;
    }
}

/// No choices.
pub type Options = ();

record! {
    /// Lemniscate.
    pub struct Lemniscate {
        /// Numbers.
        gains: Gains<T> [];
    }
}

impl<T: Real> Lemniscate<T> {
    /// The reference.
    pub fn new(gains: Gains<T>, _: Options, _: &Vehicle<T>) -> Self {
        Self { gains }
    }
}

impl<T: Real> Refer<T> for Lemniscate<T> {
    #[inline(always)]
    fn at(&self, time: T) -> Trajectory<T> {
        let Gains { size, period, center, yaw, ramp } = self.gains;
        let two = T::lit(2.0);
        let w = T::lit(core::f64::consts::TAU) / period;
        let phase = from_rest(time, ramp);
        let theta = w * phase[0];
        let mut x = chain(sine(size, w, theta.sin_cos()), phase); // (1)
        let mut y = chain(sine(size.half(), two * w, (two * theta).sin_cos()), phase);
        x[0] += center.x;
        y[0] += center.y;
        trajectory([x, y, constant(center.z)], constant(yaw))
    }
}
