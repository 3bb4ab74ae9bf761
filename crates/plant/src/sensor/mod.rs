//! Sensors: what of the true motion comes to be known, when, and how wrong.

use stormpetrel_control::controller::Plain;
use stormpetrel_control::estimator::{Past, Row};
use stormpetrel_control::math::{Body, Vec3};
use stormpetrel_control::real::Real;
use stormpetrel_control::signals::Wrench;
use stormpetrel_control::{record, registry};

use crate::state::State;
use crate::vehicle::Vehicle;

pub mod channel;
pub mod fault;
pub mod link;
pub mod sensing;
pub mod triad;

pub use channel::Channel;
pub use fault::{Fault, check};
use link::Timing;
pub use sensing::Sensing;

/// How many sensors a scenario may combine.
pub const MOST: usize = 8;

record! {
    /// What there is to be sensed at one tick.
    pub struct Truth {
        /// The true state.
        state: State<T> [];
        /// What an ideal accelerometer in the centre of mass reads: acceleration less gravity.
        specific_force: Vec3<T, Body> [m/s^2];
        /// Thrust and torque that the rotors deliver, as the law's model of them says.
        achieved: Wrench<T> [];
        /// The part of the previous command that the allocation could not grant.
        unallocated: Wrench<T> [];
    }
}

/// The circumstances of one tick, common to all sensors.
#[derive(Clone, Copy, Debug)]
pub struct Moment<T: Real> {
    /// Whole ticks since the start of the flight.
    pub tick: T,
    /// Time between two ticks, s.
    pub dt: T,
    /// The vibration of the four rotors, in squares of rotor speeds, rad^2/s^2.
    pub shake: Vec3<T, Body>,
    /// Where the truth can be sensed: it is finite.
    pub good: T::Mask,
}

/// What a sensor is given where it samples.
#[derive(Clone, Copy, Debug)]
pub struct Draw<T: Real> {
    /// Where a sample is taken.
    pub due: T::Mask,
    /// Time between two samples, s.
    pub interval: T,
    /// Independent standard normal numbers, as many pairs as the sensor asks for; zeros after those.
    pub normal: [T; 6],
}

/// Rows of the measurement matrix.
#[derive(Clone, Copy, Debug)]
pub struct Rows<T> {
    rows: [Row<T>; 6],
    count: usize,
}

impl<T: Real> Rows<T> {
    /// None at all.
    #[inline(always)]
    pub fn none() -> Self {
        Self { rows: [Row::default(); 6], count: 0 }
    }

    /// These rows after the others; six in all find room.
    #[inline(always)]
    pub fn and<const N: usize>(mut self, more: [Row<T>; N]) -> Self {
        for row in more {
            if let Some(place) = self.rows.get_mut(self.count) {
                *place = row;
                self.count += 1;
            }
        }
        self
    }

    /// The rows.
    #[inline(always)]
    pub fn all(&self) -> &[Row<T>] {
        self.rows.get(..self.count).unwrap_or_default()
    }
}

/// A sensor.
pub trait Sense<T: Real>: Plain<T> {
    /// When it samples and how long its samples are under way.
    fn timing(&self) -> Timing<T>;
    /// How many pairs of normal numbers a sample needs, at most three.
    fn pairs(&self) -> u64;
    /// The flight begins with this truth; the numbers are standard normal.
    fn begin(&mut self, _truth: &Truth<T>, _normal: [T; 6]) {}
    /// One tick, whether it samples or not.
    fn settle(&mut self, _truth: &Truth<T>, _moment: &Moment<T>) {}
    /// Its sample, in the order of its documentation; zeros after that.
    fn sample(&mut self, truth: &Truth<T>, draw: &Draw<T>) -> [T; 7];
    /// What a sample says of the filter's state at the time when it was taken.
    fn rows(&self, _sample: &[T; 7], _past: &Past<T>) -> Rows<T> {
        Rows::none()
    }
    /// How strongly it vibrates; its unit is that of what it measures times s^2/rad^2.
    fn vibration(&self) -> T {
        T::zero()
    }
}

macro_rules! dispatch_sense {
    ($name:ident [$($variant:ident)+] ()) => {
        impl<T: Real> $name<T> {
            /// The name of the kind, under which its random numbers are drawn.
            pub fn kind(&self) -> &'static str {
                match self { $( Self::$variant(_) => stringify!($variant), )+ }
            }
        }

        impl<T: Real> Sense<T> for $name<T> {
            fn timing(&self) -> Timing<T> {
                match self { $( Self::$variant(sensor) => sensor.timing(), )+ }
            }
            #[inline(always)]
            fn pairs(&self) -> u64 {
                match self { $( Self::$variant(sensor) => sensor.pairs(), )+ }
            }
            fn begin(&mut self, truth: &Truth<T>, normal: [T; 6]) {
                match self { $( Self::$variant(sensor) => sensor.begin(truth, normal), )+ }
            }
            #[inline(always)]
            fn settle(&mut self, truth: &Truth<T>, moment: &Moment<T>) {
                match self { $( Self::$variant(sensor) => sensor.settle(truth, moment), )+ }
            }
            #[inline(always)]
            fn sample(&mut self, truth: &Truth<T>, draw: &Draw<T>) -> [T; 7] {
                match self { $( Self::$variant(sensor) => sensor.sample(truth, draw), )+ }
            }
            #[inline(always)]
            fn rows(&self, sample: &[T; 7], past: &Past<T>) -> Rows<T> {
                match self { $( Self::$variant(sensor) => sensor.rows(sample, past), )+ }
            }
            fn vibration(&self) -> T {
                match self { $( Self::$variant(sensor) => sensor.vibration(), )+ }
            }
        }
    };
}

registry! {
    /// Sensors, under their names in scenario files.
    pub enum Sensor / SensorSettings keyed "kind" from Vehicle;
    dispatch dispatch_sense ();
    "none" => Unused in none;
    "gyro" => Gyro in gyro;
    "accelerometer" => Accelerometer in accelerometer;
    "rotor-speed" => RotorSpeed in rotor_speed;
    "motion-capture" => MotionCapture in motion_capture;
    "gnss" => Gnss in gnss;
    "optical-flow" => OpticalFlow in optical_flow;
    "magnetometer" => Magnetometer in magnetometer;
    "barometer" => Barometer in barometer;
}
