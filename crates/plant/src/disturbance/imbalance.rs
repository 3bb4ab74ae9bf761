//! A propeller out of balance.
//!
//!   phi' = s Omega                                                       (1)
//!   F = R u Omega^2 (cos phi, sin phi, 0),   tau = r x R^T F             (2)
//!
//! u is the unbalanced mass times its distance from the axis, r the place of the rotor, s its spin. The
//! force is held over a control tick: a step above a quarter of a turn blurs it.

use stormpetrel_control::math::{Body, Vec3};
use stormpetrel_control::real::Real;
use stormpetrel_control::record;

use super::{Disturb, Scene, Site, is_rotor};
use crate::dynamics::Push;
use crate::vehicle::Mount;

record! {
    /// Numbers of the imbalance.
    pub struct Gains {
        /// Which rotor, from 1.
        rotor: T [count] = 1.0, in 1.0 => 4.0;
        /// Mass times distance from the axis, u.
        unbalance: T [kg m] = 1e-6, in 0.0 => 1.0;
    }
}

/// No choices.
pub type Options = ();

record! {
    /// A propeller out of balance.
    pub struct Imbalance {
        /// Numbers.
        gains: Gains<T> [];
        /// Place and spin of each rotor.
        mounts: [Mount<T>; 4] [];
        /// Angle of the rotor, phi.
        angle: T [rad];
    }
}

impl<T: Real> Imbalance<T> {
    /// The disturbance.
    pub fn new(gains: Gains<T>, _: Options, site: &Site<T>) -> Self {
        Self { gains, mounts: site.vehicle.mounts(), angle: T::zero() }
    }
}

impl<T: Real> Disturb<T> for Imbalance<T> {
    fn remembers(&self) -> bool {
        true
    }
    #[inline(always)]
    fn push(&mut self, scene: &Scene<T>) -> Push<T> {
        let state = &scene.state;
        let (mut speed, mut spin, mut place) = (T::zero(), T::zero(), Vec3::<T, Body>::zero());
        for (i, mount) in self.mounts.iter().enumerate() {
            let this = is_rotor(self.gains.rotor, i);
            speed = T::select(this, state.rotor_speed[i], speed);
            spin = T::select(this, mount.spin, spin);
            place = Vec3::select(this, mount.place, place);
        }
        let turn = T::lit(core::f64::consts::TAU);
        let angle = self.angle + spin * speed * scene.step; // (1)
        self.angle = angle - turn * (angle / turn).floor();
        let (sin, cos) = self.angle.sin_cos();
        let force = Vec3::new(cos, sin, T::zero()) * (self.gains.unbalance * speed.sq());
        Push { force: state.attitude * force, torque: place.cross(force) } // (2)
    }
}
