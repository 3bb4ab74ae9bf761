//! Helix: a circle that climbs.
//!
//!   x = x0 + r sin(w t),  y = y0 + r cos(w t),  z = z0 + c t,  psi = psi0 + psi' t   (1)
//!
//! The article's reference has r = 2 m, w = 0.5 rad/s, c = 0.5 m/s, constant yaw 0.

use stormpetrel_control::math::{Vec3, World};
use stormpetrel_control::real::Real;
use stormpetrel_control::record;
use stormpetrel_control::signals::Trajectory;

use super::Refer;
use crate::vehicle::Vehicle;

record! {
    /// Numbers of the helix; the defaults are the article's.
    pub struct Gains {
        /// Radius.
        radius: T [m] = 2.0, in 0.0 => 1e4;
        /// Angular frequency.
        frequency: T [rad/s] = 0.5, in -1e2 => 1e2;
        /// Climb speed.
        climb: T [m/s] = 0.5, in -1e3 => 1e3;
        /// Centre at the start.
        center: Vec3<T, World> [m] = 0.0, in -1e6 => 1e6;
        /// Heading at the start.
        yaw: T [rad] = 0.0, in -6.3 => 6.3;
        /// Rate of the heading.
        yaw_rate: T [rad/s] = 0.0, in -1e2 => 1e2;
    }
}

/// No choices.
pub type Options = ();

record! {
    /// Helix.
    pub struct Helix {
        /// Numbers.
        gains: Gains<T> [];
    }
}

impl<T: Real> Helix<T> {
    /// The reference.
    pub fn new(gains: Gains<T>, _: Options, _: &Vehicle<T>) -> Self {
        Self { gains }
    }
}

impl<T: Real> Refer<T> for Helix<T> {
    #[inline(always)]
    fn at(&self, time: T) -> Trajectory<T> {
        let Gains { radius, frequency: w, climb, center, yaw, yaw_rate } = self.gains;
        let (sin, cos) = (w * time).sin_cos();
        let (s, c) = (radius * sin, radius * cos);
        let (w2, zero) = (w.sq(), T::zero());
        Trajectory {
            position: center + Vec3::new(s, c, climb * time), // (1)
            velocity: Vec3::new(c * w, -(s * w), climb),
            acceleration: Vec3::new(-(s * w2), -(c * w2), zero),
            jerk: Vec3::new(-(c * w2 * w), s * w2 * w, zero),
            snap: Vec3::new(s * w2.sq(), c * w2.sq(), zero),
            yaw: yaw + yaw_rate * time,
            yaw_rate,
            yaw_acceleration: zero,
        }
    }
}
