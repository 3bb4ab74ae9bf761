//! Recorded force and torque.
//!
//!   straight between two rows, the first row before, the last row after  (1)

use stormpetrel_control::math::{Vec3};
use stormpetrel_control::options::Rows;
use stormpetrel_control::real::Real;
use stormpetrel_control::{columns, options, record};

use super::{Disturb, Scene, Site};
use crate::actuation::curve::look_up_lanes;
use crate::dynamics::Push;

record! {
    /// Numbers of the recording.
    pub struct Gains {
        /// Factor on every value.
        scale: T [1] = 1.0, in -1e3 => 1e3;
    }
}

columns! {
    /// Force in world axes and torque in body axes, by time from the onset.
    pub struct ForceRows, 1 => 1_000_000 rows, first grows {
        t [s] in 0.0 => 1e6;
        fx [N] in -1e6 => 1e6;
        fy [N] in -1e6 => 1e6;
        fz [N] in -1e6 => 1e6;
        tx [N m] in -1e6 => 1e6;
        ty [N m] in -1e6 => 1e6;
        tz [N m] in -1e6 => 1e6;
    }
}

options! {
    /// The recording.
    pub struct Options {
        /// Force in world axes and torque in body axes, by time from the onset.
        recording: Rows<ForceRows>;
    }
}

record! {
    /// Recorded force and torque.
    pub struct RecordedForce {
        /// Numbers.
        gains: Gains<T> [];
        structure {
            /// The recording.
            recording: Rows<ForceRows>;
        }
    }
}

impl<T: Real> RecordedForce<T> {
    /// The disturbance.
    pub fn new(gains: Gains<T>, options: Options, _: &Site<T>) -> Self {
        Self { gains, recording: options.recording }
    }
}

impl<T: Real> Disturb<T> for RecordedForce<T> {
    #[inline(always)]
    fn push(&mut self, scene: &Scene<T>) -> Push<T> {
        let [fx, fy, fz, tx, ty, tz] = look_up_lanes(&self.recording, scene.time); // (1)
        let scale = self.gains.scale;
        Push { force: Vec3::new(fx, fy, fz) * scale, torque: Vec3::new(tx, ty, tz) * scale }
    }
}
