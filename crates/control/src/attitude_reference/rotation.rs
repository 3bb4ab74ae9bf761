//! Attitude reference as a rotation matrix: valid upside down.
//!
//!   b_z = F/|F|                                                          (1)
//!   b_x = +-(y_c x b_z)/|y_c x b_z|,   y_c = (-sin psi, cos psi, 0)      (2)
//!   b_y = b_z x b_x,   R_ref = (b_x, b_y, b_z)                           (3)
//!   T   = m F . (R e_z)                                                  (4)
//!
//! The sign in (2) is that of the previous b_x, so the reference is continuous through inversion;
//! within 0.06 deg of b_z || y_c the previous b_x is held.
//!
//! Source: Z-Y-X heading as in Faessler, Franchi and Scaramuzza, RA-L 2018; thrust projection after
//! Lee, Leok and McClamroch, CDC 2010.

use super::{RateMemory, Rates, attitude_beside, heading, projected_thrust};
use crate::controller::Controller;
use crate::math::{Vec3, World};
use crate::real::Real;
use crate::record::RecordExt as _;
use crate::signals::{Attitude, Measurement, Model, Thrust};
use crate::{options, record};

record! {
    /// Numbers of the rotation-matrix reference.
    pub struct Gains {
        /// Bound on the magnitude of thrust (N) and rates (rad/s).
        limit: T [1] = 1e6, in 0.0 => 1e6;
    }
}

options! {
    /// Choices of the rotation-matrix reference.
    pub struct Options {
        /// Where the angular velocity of the reference comes from.
        rates: Rates;
    }
}

record! {
    /// Rotation-matrix reference.
    pub struct RotationMatrix {
        /// Numbers.
        gains: Gains<T> [];
        /// What the law believes of the vehicle.
        model: Model<T> [];
        /// Along the forward axis of the previous reference, of any length; zero before the first.
        forward: Vec3<T, World> [m/s^2];
        /// The previous reference.
        memory: RateMemory<T> [];
        structure {
            /// Choices.
            options: Options;
        }
    }
}

impl<T: Real> RotationMatrix<T> {
    /// The law at rest.
    pub fn new(gains: Gains<T>, options: Options, model: &Model<T>) -> Self {
        Self { gains, options, model: *model, ..Self::default() }
    }
}

impl<T: Real> Controller<T> for RotationMatrix<T> {
    type Reference = Thrust<T>;
    type Command = Attitude<T>;

    #[inline(always)]
    fn tune(&mut self, dt: T) {
        self.memory.tune(dt);
    }

    #[inline(always)]
    fn update(&mut self, measurement: &Measurement<T>, thrust: &Thrust<T>, _: T) -> Attitude<T> {
        let heading = heading(thrust.yaw);
        let ahead = Vec3::new(heading.cos, heading.sin, T::zero());
        let last = Vec3::select(T::zero().lt(self.memory.started), self.forward, ahead);
        let (rotation, side) = attitude_beside(thrust.force, &heading, last); // (1-3)
        self.forward = side;
        let mut attitude = Attitude { rotation, ..Attitude::default() };
        for i in 0..T::PARTS {
            let thrust =
                projected_thrust(&thrust.pick(i), &measurement.pick(i), &self.model.pick(i)); // (4)
            attitude.thrust.set_part(i, thrust);
        }
        let (rate, acceleration) = self.memory.update(self.options.rates, &rotation, thrust);
        Attitude { rate, acceleration, ..attitude }
    }

    #[inline(always)]
    fn hidden(&self) -> T {
        // The previous reference is the command's, and the forward axis was made of what the command was made of.
        self.memory.per_step()
    }

    fn reset(&mut self, _: &Measurement<T>) {
        self.forward = Vec3::zero();
        self.memory = RateMemory::default();
    }

    fn limit(&self) -> T {
        self.gains.limit
    }
}
