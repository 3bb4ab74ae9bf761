//! Filtered noise: force and torque that wander about zero with one correlation time.
//!
//!   x' = -x/T + sqrt(2/T) n,   n white with unit intensity               (1)
//!   x+ = a x + sqrt(1 - a^2) N(0, 1),   a = exp(-dt/T)                    (2)
//!   force = f x,   torque = tau x, each axis with its own x              (3)
//!
//! (2) is the exact solution of (1) over a step, begun in its stationary law: the variance is one at every
//! time, whatever the step. Source: Gillespie, Phys. Rev. E 54 (1996), 2084.

use stormpetrel_control::math::{Body, Vec3, World};
use stormpetrel_control::real::Real;
use stormpetrel_control::record;
use stormpetrel_control::record::from_index;

use super::dryden::gamma_p;
use super::{Disturb, Scene, Site};
use crate::dynamics::Push;
use crate::random::Stream;

record! {
    /// Numbers of the noise.
    pub struct Gains {
        /// Standard deviation of the force.
        force: Vec3<T, World> [N] = 0.0, in 0.0 => 1e6;
        /// Standard deviation of the torque.
        torque: Vec3<T, Body> [N m] = 0.0, in 0.0 => 1e6;
        /// Correlation time, T.
        time_constant: T [s] = 1.0, in 1e-4 => 1e6;
    }
}

/// No choices.
pub type Options = ();

record! {
    /// Filtered noise.
    pub struct Noise {
        /// Numbers.
        gains: Gains<T> [];
        /// a of (2).
        keep: T [1];
        /// sqrt(1 - a^2).
        fresh: T [1];
        /// x of each axis: force, then torque.
        x: [T; 6] [1];
        /// Random numbers.
        stream: Stream<T> [];
    }
}

impl Noise<f64> {
    /// The disturbance.
    pub fn new(gains: Gains<f64>, _: Options, site: &Site<f64>) -> Self {
        let keep = Real::exp(-site.step / gains.time_constant);
        let fresh = gamma_p(1, 2.0 * site.step / gains.time_constant).sqrt();
        Self { gains, keep, fresh, stream: Stream::new(site.key, "axes"), ..Self::default() }
    }
}

impl<T: Real> Disturb<T> for Noise<T> {
    fn remembers(&self) -> bool {
        true
    }
    #[inline(always)]
    fn push(&mut self, scene: &Scene<T>) -> Push<T> {
        let first = scene.tick.eq(T::zero());
        let (keep, fresh) =
            (T::select(first, T::zero(), self.keep), T::select(first, T::one(), self.fresh));
        let (tick, stream) = (scene.tick, &self.stream);
        let (a, b, c) = (stream.normals(tick, 0), stream.normals(tick, 1), stream.normals(tick, 2));
        let n = [a[0], a[1], b[0], b[1], c[0], c[1]];
        self.x = from_index(|i| self.x[i] * keep + n[i] * fresh); // (2)
        let [fx, fy, fz, tx, ty, tz] = self.x;
        Push {
            force: self.gains.force.scale(Vec3::new(fx, fy, fz)),
            torque: self.gains.torque.scale(Vec3::new(tx, ty, tz)),
        } // (3)
    }
}
