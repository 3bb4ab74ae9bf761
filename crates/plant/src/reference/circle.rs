//! Circle at one height, from rest to full speed.
//!
//!   x = x0 + r cos(theta),  y = y0 + r sin(theta),  z = z0               (1)
//!   theta = theta0 + w phi(t),   w = v/r or given                        (2)
//!   psi = psi0, or psi0 + theta + pi/2 sign(w), along the velocity       (3)
//!
//! phi' rises from 0 to 1 within `ramp` seconds as a polynomial of degree 7 (35 u^4 - 84 u^5 + 70 u^6 -
//! 20 u^7), so the snap is continuous. At full speed the acceleration is v^2/r and points inwards. The
//! heading along the velocity turns on without a jump, lap after lap.

use stormpetrel_control::math::{Vec3, World};
use stormpetrel_control::real::Real;
use stormpetrel_control::signals::Trajectory;
use stormpetrel_control::{choice, options, record};

use super::Refer;
use super::phase::{chain, constant, from_rest, sine, trajectory};
use crate::vehicle::Vehicle;

record! {
    /// Numbers of the circle.
    pub struct Gains {
        /// Radius.
        radius: T [m] = 2.0, in 1e-3 => 1e4;
        /// Speed at the end of the ramp, counter-clockwise seen from above; used where `frequency` is 0.
        speed: T [m/s] = 2.0, in -1e3 => 1e3;
        /// Angular frequency at the end of the ramp, counter-clockwise; 0: speed over radius.
        frequency: T [rad/s] = 0.0, in -1e2 => 1e2;
        /// Centre.
        center: Vec3<T, World> [m] = 0.0, in -1e6 => 1e6;
        /// Direction from the centre at the start.
        start: T [rad] = 0.0, in -6.3 => 6.3;
        /// Heading, or its angle from the velocity.
        yaw: T [rad] = 0.0, in -6.3 => 6.3;
        /// Time from rest to full speed; below 1 ms at once.
        ramp: T [s] = 2.0, in 0.0 => 1e3;
    }
}

choice! {
    /// Where the vehicle looks.
    pub enum Heading {
        /// In one direction.
        "constant" => Constant,
        /// Along the velocity.
        "along" => Along,
    }
}

options! {
    /// Choices of the circle.
    pub struct Options {
        /// Where the vehicle looks.
        heading: Heading;
    }
}

record! {
    /// Circle.
    pub struct Circle {
        /// Numbers.
        gains: Gains<T> [];
        structure {
            /// Choices.
            options: Options;
        }
    }
}

impl<T: Real> Circle<T> {
    /// The reference.
    pub fn new(gains: Gains<T>, options: Options, _: &Vehicle<T>) -> Self {
        Self { gains, options }
    }
}

impl<T: Real> Refer<T> for Circle<T> {
    #[inline(always)]
    fn at(&self, time: T) -> Trajectory<T> {
        let Gains { radius, speed, frequency, center, start, yaw, ramp } = self.gains;
        let zero = T::zero();
        let w = T::select(frequency.eq(zero), speed / radius, frequency);
        let phase = from_rest(time, ramp);
        let theta = start + w * phase[0]; // (2)
        let (sin, cos) = theta.sin_cos();
        let mut x = chain(sine(radius, w, (cos, -sin)), phase); // (1)
        let mut y = chain(sine(radius, w, (sin, cos)), phase);
        x[0] += center.x;
        y[0] += center.y;
        let quarter = T::lit(core::f64::consts::FRAC_PI_2).with_sign(w);
        let heading = match self.options.heading {
            Heading::Constant => constant(yaw),
            Heading::Along => chain([yaw + theta + quarter, w, zero, zero, zero], phase), // (3)
        };
        trajectory([x, y, constant(center.z)], heading)
    }
}
