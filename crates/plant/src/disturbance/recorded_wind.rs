//! Recorded wind.
//!
//!   straight between two rows, the first row before, the last row after  (1)

use stormpetrel_control::math::{Vec3, World};
use stormpetrel_control::options::Rows;
use stormpetrel_control::real::Real;
use stormpetrel_control::{columns, options, record};

use super::{Disturb, Reach, Scene, Site};
use crate::actuation::curve::look_up_lanes;

record! {
    /// Numbers of the recording.
    pub struct Gains {
        /// Factor on every value.
        scale: T [1] = 1.0, in -1e3 => 1e3;
    }
}

columns! {
    /// Velocity of the air in world axes, by time from the onset.
    pub struct WindRows, 1 => 1_000_000 rows, first grows {
        t [s] in 0.0 => 1e6;
        x [m/s] in -100.0 => 100.0;
        y [m/s] in -100.0 => 100.0;
        z [m/s] in -100.0 => 100.0;
    }
}

options! {
    /// The recording.
    pub struct Options {
        /// Velocity of the air in world axes, by time from the onset.
        recording: Rows<WindRows>;
    }
}

record! {
    /// Recorded wind.
    pub struct RecordedWind {
        /// Numbers.
        gains: Gains<T> [];
        structure {
            /// The recording.
            recording: Rows<WindRows>;
        }
    }
}

impl<T: Real> RecordedWind<T> {
    /// The disturbance.
    pub fn new(gains: Gains<T>, options: Options, _: &Site<T>) -> Self {
        Self { gains, recording: options.recording }
    }
}

impl<T: Real> Disturb<T> for RecordedWind<T> {
    fn reach(&self) -> Reach {
        Reach::Air
    }
    #[inline(always)]
    fn wind(&mut self, scene: &Scene<T>) -> Vec3<T, World> {
        let [x, y, z] = look_up_lanes(&self.recording, scene.time); // (1)
        Vec3::new(x, y, z) * self.gains.scale
    }
}
