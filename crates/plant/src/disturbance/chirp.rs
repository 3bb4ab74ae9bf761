//! A sine whose frequency grows evenly: what a frequency response is measured with.
//!
//!   phi(t) = 2 pi (f0 t + (f1 - f0) t^2/(2 T)),   f1 held after T        (1)
//!   force = f sin phi,   torque = tau sin phi                            (2)

use stormpetrel_control::math::{Body, Vec3, World};
use stormpetrel_control::real::Real;
use stormpetrel_control::record;

use super::{Disturb, Scene, Site};
use crate::dynamics::Push;

record! {
    /// Numbers of the chirp.
    pub struct Gains {
        /// Force.
        force: Vec3<T, World> [N] = 0.0, in -1e6 => 1e6;
        /// Torque.
        torque: Vec3<T, Body> [N m] = 0.0, in -1e6 => 1e6;
        /// Frequency at the onset, f0.
        from: T [Hz] = 0.1, in 0.0 => 1e3;
        /// Frequency at the end of the sweep, f1.
        to: T [Hz] = 10.0, in 0.0 => 1e3;
        /// Length of the sweep, T.
        sweep: T [s] = 20.0, in 1e-3 => 1e5;
    }
}

/// No choices.
pub type Options = ();

record! {
    /// A sine whose frequency grows evenly: what a frequency response is measured with.
    pub struct Chirp {
        /// Numbers.
        gains: Gains<T> [];
    }
}

impl<T: Real> Chirp<T> {
    /// The disturbance.
    pub fn new(gains: Gains<T>, _: Options, _: &Site<T>) -> Self {
        Self { gains }
    }
}

impl<T: Real> Disturb<T> for Chirp<T> {
    #[inline(always)]
    fn push(&mut self, scene: &Scene<T>) -> Push<T> {
        let Gains { force, torque, from, to, sweep } = self.gains;
        let during = scene.time.min(sweep);
        let after = scene.time - during;
        let turns = from * during + (to - from) * during.sq() / (sweep * T::lit(2.0)) + to * after;
        let (h, _) = (turns * T::lit(core::f64::consts::TAU)).sin_cos(); // (1)
        Push { force: force * h, torque: torque * h } // (2)
    }
}
