//! The vehicle's senses: sensors, and the filter that makes a state of them.
//!
//! At every tick the sensors see the truth, the filter moves to now with the newest samples of gyro and
//! accelerometer, and takes what the other sensors hand over. The laws are told the filter's position,
//! velocity and attitude, and the newest rate less its bias. Without estimation they are told the truth.
//!
//!   phi_i' = w_i,   s = sum w_i^2 (sin phi_i, cos phi_i, sin phi_i)                          (1)
//!
//! is the vibration of four unbalanced rotors, from phases that are drawn at the start. Above half of
//! the sampling rate it is folded, as it is in a real sensor.

use core::f64::consts::TAU;

use stormpetrel_control::estimator::covariance::ErrorState;
use stormpetrel_control::estimator::{Eskf, Imu};
use stormpetrel_control::guard::mended;
use stormpetrel_control::math::{Body, Vec3};
use stormpetrel_control::real::{Mask, Real};
use stormpetrel_control::record;
use stormpetrel_control::record::{Record as _, each, from_index};
use stormpetrel_control::signals::{Measurement, Wrench};

use super::link::Sample;
use super::{Channel, MOST, Moment, Sense as _, Sensor, Truth};
use crate::random::{Stream, key};
use crate::vehicle::Vehicle;

record! {
    /// Sensors and filter.
    pub struct Sensing {
        /// The sensors, each with the way of its samples.
        channels: [Channel<T>; MOST] [];
        /// The filter.
        filter: Eskf<T> [];
        /// Random numbers of what belongs to no sensor: rotor phases, first guess of the filter.
        stream: Stream<T> [];
        /// Newest samples of gyro and accelerometer.
        imu: Imu<T> [];
        /// Newest rotor speeds that telemetry told.
        rotor_speed: [T; 4] [rad/s];
        /// Angle of each rotor.
        phase: [T; 4] [rad];
        /// Whether a sensor vibrates: its amplitude.
        vibration: T [];
        /// Time of the last good tick.
        step: T [s];
        /// 1 where at the last tick something not finite was ignored or mended, else 0.
        flag: T [1];
        structure {
            /// Whether the laws are told the estimate; the truth otherwise.
            estimate: bool;
        }
    }
}

/// The pairs of the stream that the filter's first guess is drawn from; the rotor phases come before.
const FIRST_GUESS: u64 = 16;

impl Sensing<f64> {
    /// Gives each sensor its random numbers: they follow from the key, the kind, and how many of that kind
    /// come before it, so sensors of other kinds do not touch them.
    pub fn seed(&mut self, parent: u64) {
        self.stream = Stream::new(parent, "sensing");
        let kinds = self.channels.each_ref().map(|channel| channel.sensor.kind());
        for (place, channel) in self.channels.iter_mut().enumerate() {
            let kind = channel.sensor.kind();
            let before = kinds.iter().take(place).filter(|other| **other == kind).count();
            channel.link.stream = Stream::new(key(parent, before as u64), kind);
        }
    }
}

impl<T: Real> Sensing<T> {
    /// The flight begins: biases and the filter's first guess are drawn.
    pub fn begin(&mut self, truth: &Truth<T>) {
        if !self.estimate {
            return;
        }
        let truth = &mended(truth, &Truth::default());
        self.vibration = T::zero();
        for channel in &mut self.channels {
            channel.begin(truth);
            self.vibration += channel.sensor.vibration();
        }
        self.imu = Imu { specific_force: truth.specific_force, rate: truth.state.rate };
        self.rotor_speed = truth.state.rotor_speed;
        self.phase = from_index(|i| self.stream.unit(T::zero(), i as u64) * T::lit(TAU));
        (self.step, self.flag) = (T::lit(1e-3), T::zero());
        self.guess(truth);
    }

    /// The filter begins as wrong as it believes to be.
    fn guess(&mut self, truth: &Truth<T>) {
        self.filter.reset(&truth.perfect());
        self.filter.imu = self.imu;
        let deviations = self.filter.initial().parts();
        let mut error = ErrorState::default().parts();
        // Position, velocity and attitude; the biases are the sensors' own draws.
        for part in 0..3 {
            let pair = FIRST_GUESS + 2 * part as u64;
            let [x, y] = self.stream.normals(T::zero(), pair);
            let [z, _] = self.stream.normals(T::zero(), pair + 1);
            error[part] = from_index(|axis| [x, y, z][axis] * deviations[part][axis]);
        }
        self.filter.nominal = self.filter.nominal.plus(&ErrorState::from_parts(error));
    }

    /// What the laws are told at this tick, a whole number since the start of the flight; `dt` is the time
    /// between two ticks, s.
    #[inline(always)]
    pub fn measure(&mut self, truth: &Truth<T>, tick: T, dt: T) -> Measurement<T> {
        if !self.estimate {
            return truth.perfect();
        }
        let passes = T::zero().lt(dt) & dt.le(T::one());
        self.step = T::select(passes, dt, self.step);
        let good = passes & truth.sum(|x| x).is_finite();
        let truth = if good.all() { *truth } else { mended(truth, &Truth::default()) };
        let shake = self.shake(&truth);
        let moment = Moment { tick, dt: self.step, shake, good };
        // The first tick is where the filter began.
        let passed = T::select(passes & T::zero().lt(tick), self.step, T::zero());
        self.fuse(&truth, &moment, passed);
        self.flag = T::select(good, self.filter.flag, T::one());
        self.filter.tell(&truth.perfect())
    }

    /// Sensors, then filter, which moves on by `passed` seconds.
    #[cfg_attr(debug_assertions, inline(never))] // a frame of its own without optimisation
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn fuse(&mut self, truth: &Truth<T>, moment: &Moment<T>, passed: T) {
        let mut samples = [Sample::none(); MOST];
        let mut fresh = T::Mask::splat(false);
        for k in 0..MOST {
            if self.channels[k].is_empty() {
                continue;
            }
            let sample = self.channels[k].sense(truth, moment);
            if !self.read(k, &sample) {
                fresh = fresh | sample.fresh;
                samples[k] = sample;
            }
        }
        self.filter.predict(&self.imu, passed);
        self.filter.propagate(fresh);
        for k in 0..MOST {
            if self.channels[k].is_empty() {
                continue;
            }
            self.channels[k].follow(&self.filter, moment.dt);
            if !(!samples[k].fresh).all() {
                let rows = self.channels[k].rows(&samples[k], &self.filter);
                self.filter.correct(rows.all(), samples[k].fresh);
            }
        }
    }

    /// Takes a sample that is not for the filter to correct itself; says whether it was one.
    #[inline(always)]
    fn read(&mut self, k: usize, sample: &Sample<T>) -> bool {
        let (fresh, [x, y, z, w, ..]) = (sample.fresh, sample.values);
        let vector = Vec3::new(x, y, z);
        match self.channels[k].sensor {
            Sensor::Gyro(_) => self.imu.rate = Vec3::select(fresh, vector, self.imu.rate),
            Sensor::Accelerometer(_) => {
                let held = self.imu.specific_force;
                self.imu.specific_force = Vec3::select(fresh, vector, held);
            }
            Sensor::RotorSpeed(_) => {
                let (new, held) = ([x, y, z, w], self.rotor_speed);
                self.rotor_speed = from_index(|i| T::select(fresh, new[i], held[i]));
            }
            _ => return false,
        }
        true
    }

    /// The vibration (1), in squares of rotor speeds.
    #[inline(always)]
    fn shake(&mut self, truth: &Truth<T>) -> Vec3<T, Body> {
        let still = self.vibration.eq(T::zero());
        if still.all() {
            return Vec3::zero();
        }
        let (mut sines, mut cosines) = (T::zero(), T::zero());
        for i in 0..4 {
            let speed = truth.state.rotor_speed[i];
            let turns = (self.phase[i] + speed * self.step) * T::lit(1.0 / TAU);
            let phase = (turns - turns.floor()) * T::lit(TAU);
            self.phase[i] = T::select(still, self.phase[i], phase);
            let (sin, cos) = phase.sin_cos();
            sines += speed.sq() * sin;
            cosines += speed.sq() * cos;
        }
        Vec3::new(sines, cosines, sines)
    }

    /// Whether the rotor speeds are told by telemetry.
    pub fn has_telemetry(&self) -> bool {
        self.estimate && self.channels.iter().any(|c| matches!(c.sensor, Sensor::RotorSpeed(_)))
    }

    /// Thrust and torque that follow from the rotor speeds told by telemetry.
    #[inline(always)]
    pub fn achieved(&self, vehicle: &Vehicle<T>) -> Wrench<T> {
        let thrust = each(self.rotor_speed, |w| vehicle.thrust_coefficient * w.sq());
        let [u, x, y, z] = each(vehicle.effect(), |row| {
            row[0] * thrust[0] + row[1] * thrust[1] + row[2] * thrust[2] + row[3] * thrust[3]
        });
        Wrench { thrust: u, torque: Vec3::new(x, y, z) }
    }
}

impl<T: Real> Truth<T> {
    /// What perfect sensors tell.
    #[inline(always)]
    pub fn perfect(&self) -> Measurement<T> {
        let Self { state, achieved, unallocated, .. } = *self;
        Measurement {
            position: state.position,
            velocity: state.velocity,
            attitude: state.attitude,
            rate: state.rate,
            achieved,
            unallocated,
        }
    }
}
