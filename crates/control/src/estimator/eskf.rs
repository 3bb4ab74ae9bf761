//! Error-state Kalman filter: position, velocity, attitude and the biases of gyro and accelerometer.
//!
//! The nominal state follows the inertial sensors at every tick, with w and f the means of the last
//! two samples less the biases, theta = w dt:
//!
//!   R += R Exp(theta),   dv = R (f + theta x f/2) dt,   v += dv - g e_z dt,   p += (v_old + v_new) dt/2   (1)
//!
//! Its errors (true less estimated; attitude local, R = R_est Exp(dtheta)) obey
//!
//!   dp' = dv,   dv' = -R (f x dtheta) - R db_a - R n_a,   dtheta' = -w x dtheta - db_g - n_g,
//!   db_g' = n_wg,   db_a' = n_wa                                                             (2)
//!
//! Over D seconds, with the turn E' = Exp of w and the velocity S = sum of dv gathered on the way, (2)
//! is, up to terms of third order in D,
//!
//!   dp += D/2 dv;  dtheta -= D/2 db_g;  dv += -S x (R_0 dtheta);  dv += -D (R_0 + R_1)/2 db_a;
//!   dtheta := E dtheta;  dtheta -= D/2 db_g;  dp += D/2 dv                                   (3)
//!
//! with half of the noise, D times the densities squared, added before and half after. The covariance
//! moves at its own lower rate, and up to now wherever a measurement comes. Measurements are
//! taken one scalar at a time, see [`covariance`](super::covariance), all from one linearisation.
//!
//! Source: J. Sola, "Quaternion kinematics for the error-state Kalman filter", arXiv:1711.02508 (2017),
//! sections 5 and 6; the covariance's frame is not turned by the injected correction (his section 6.3),
//! a term of second order. Valid while the attitude error is small (tenths of a radian) and a tick
//! turns by less than 0.5 rad.

use crate::guard::mended;
use crate::math::{Body, Vec3};
use crate::real::{Mask, Precision as _, Real};
use crate::record;
use crate::record::{Record as _, blend};
use crate::signals::{Measurement, Model};

use super::covariance::{Covariance, ErrorState, Parts};
use super::nominal::{Imu, Nominal, turn};
use super::past::{Lag, Past, Row};
use super::propagation::Passed;

record! {
    /// What the filter believes of its sensors and of the start.
    pub struct Gains {
        /// Density of the gyro's white noise.
        gyro_noise: T [rad/s/sqrt(Hz)] = 2.5e-4, in 0.0 => 1.0;
        /// Density of the accelerometer's white noise.
        accelerometer_noise: T [m/s^2/sqrt(Hz)] = 2e-3, in 0.0 => 100.0;
        /// Random walk of the gyro bias.
        gyro_walk: T [rad/s/sqrt(s)] = 1e-5, in 0.0 => 1.0;
        /// Random walk of the accelerometer bias.
        accelerometer_walk: T [m/s^2/sqrt(s)] = 1e-4, in 0.0 => 100.0;
        /// Noise that an aiding measurement is believed to have, over what its sensor declares.
        measurement_noise: T [1] = 1.0, in 1e-3 => 1e3;
        /// Innovations beyond this many standard deviations are refused.
        gate: T [1] = 5.0, in 1.0 => 1e6;
        /// Lowest rate at which the covariance moves; a measurement moves it besides.
        covariance_hz: T [Hz] = 100.0, in 1.0 => 250.0;
        /// Standard deviation of each component of the position at the start.
        position_sigma: T [m] = 0.05, in 0.0 => 1e3;
        /// Standard deviation of each component of the velocity at the start.
        velocity_sigma: T [m/s] = 0.05, in 0.0 => 1e3;
        /// Standard deviation of the attitude at the start, about each axis.
        attitude_sigma: T [rad] = 0.02, in 0.0 => 1.0;
        /// Standard deviation of each component of the gyro bias at the start.
        gyro_bias_sigma: T [rad/s] = 5e-3, in 0.0 => 1.0;
        /// Standard deviation of each component of the accelerometer bias at the start.
        accelerometer_bias_sigma: T [m/s^2] = 0.05, in 0.0 => 100.0;
    }
}

/// No choices.
pub type Options = ();

record! {
    /// Error-state Kalman filter.
    pub struct Eskf {
        /// What it believes of its sensors.
        gains: Gains<T> [];
        /// Gravitational acceleration that it believes in.
        gravity: T [m/s^2];
        /// The best guess.
        nominal: Nominal<T> [];
        /// Covariance of its errors.
        covariance: Covariance<T> [];
        /// Since the covariance last moved.
        passed: Passed<T> [];
        /// The last good sample of the inertial sensors.
        imu: Imu<T> [];
        /// Mean acceleration and rate over the last tick.
        motion: Lag<T> [];
        /// Scalar measurements refused by the gate since the start.
        rejected: T [count];
        /// 1 where something not finite was ignored or mended at the last tick, else 0.
        flag: T [1];
    }
}

/// Largest specific force that counts, m/s^2, and largest rate, rad/s: no sensor reads more.
const LARGEST: [f64; 2] = [1e4, 1e3];
/// Smallest standard deviations: m, m/s, rad, rad/s, m/s^2.
const NARROWEST: [f64; 5] = [1e-5, 1e-5, 1e-6, 1e-7, 1e-6];

impl<T: Real> Eskf<T> {
    /// The filter at rest in the origin; `reset` moves it to the vehicle.
    pub fn new(gains: Gains<T>, model: &Model<T>) -> Self {
        let mut filter = Self { gains, gravity: model.gravity, ..Self::default() };
        filter.reset(&Measurement::default());
        filter
    }

    /// Standard deviations at the start.
    pub fn initial(&self) -> ErrorState<T> {
        ErrorState {
            position: Vec3::splat(self.gains.position_sigma),
            velocity: Vec3::splat(self.gains.velocity_sigma),
            attitude: Vec3::splat(self.gains.attitude_sigma),
            gyro_bias: Vec3::splat(self.gains.gyro_bias_sigma),
            accelerometer_bias: Vec3::splat(self.gains.accelerometer_bias_sigma),
        }
    }

    /// Begins at this measurement, with the errors that the gains say.
    pub fn reset(&mut self, measurement: &Measurement<T>) {
        let spare = Measurement::default();
        let Measurement { position, velocity, attitude, rate, .. } = mended(measurement, &spare);
        let attitude = attitude.normalised();
        self.nominal = Nominal { position, velocity, attitude, ..Nominal::default() };
        self.nominal = mended(&self.nominal, &Nominal::default());
        self.covariance = Covariance::diagonal(&self.initial());
        self.passed = Passed::default();
        self.imu = Imu { specific_force: Vec3::up(self.gravity), rate };
        self.motion = Lag { acceleration: Vec3::zero(), rate };
        (self.rejected, self.flag) = (T::zero(), T::zero());
    }

    /// Angular velocity: the newest good sample less the bias, rad/s.
    #[inline(always)]
    pub fn rate(&self) -> Vec3<T, Body> {
        self.imu.rate - self.nominal.gyro_bias
    }

    /// The nominal state moves by `dt` seconds to the time of this sample (1). What of it is not finite
    /// or beyond what a sensor can read is replaced by the sample before; no time passes where `dt` is
    /// not one between 0 and 1 s.
    #[cfg_attr(debug_assertions, inline(never))] // a frame of its own without optimisation
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn predict(&mut self, imu: &Imu<T>, dt: T) {
        let (imu, dt) = self.checked(imu, dt);
        let Nominal { position, velocity, attitude, gyro_bias, accelerometer_bias } = self.nominal;
        let rate = (self.imu.rate + imu.rate) * T::lit(0.5) - gyro_bias;
        let force = (self.imu.specific_force + imu.specific_force) * T::lit(0.5);
        let force = force - accelerometer_bias;
        let (theta, weight) = (rate * dt, Vec3::up(self.gravity));

        let specific = attitude * (force + theta.cross(force) * T::lit(0.5)); // (1)
        let by = turn(theta);
        let next = velocity + (specific - weight) * dt;
        self.nominal.position = position + (velocity + next) * dt.half();
        self.nominal.velocity = next;
        self.nominal.attitude = (attitude * by).normalised();

        self.passed.time += dt;
        self.passed.turn = self.passed.turn * by;
        self.passed.velocity += specific * dt;
        self.motion = Lag { acceleration: specific - weight, rate };
        self.imu = imu;
        let all = self.nominal.sum(|x| x) + self.passed.sum(|x| x) + self.rejected;
        if !all.is_finite().all() {
            self.mend();
        }
    }

    /// The sample and the time, as far as they make sense; raises the flag where not.
    #[inline(always)]
    fn checked(&mut self, imu: &Imu<T>, dt: T) -> (Imu<T>, T) {
        let passes = T::zero().le(dt) & dt.le(T::one());
        let force = imu.specific_force.map(T::abs);
        let rate = imu.rate.map(T::abs);
        let reads = (force.x + force.y + force.z).le(T::lit(LARGEST[0]))
            & (rate.x + rate.y + rate.z).le(T::lit(LARGEST[1]));
        self.flag = T::select(passes & reads, T::zero(), T::one());
        let specific_force = Vec3::select(reads, imu.specific_force, self.imu.specific_force);
        let rate = Vec3::select(reads, imu.rate, self.imu.rate);
        (Imu { specific_force, rate }, T::select(passes, dt, T::zero()))
    }

    /// Begins anew where the state is no longer finite: only broken memory or gains can do that.
    #[cold]
    #[inline(never)]
    fn mend(&mut self) {
        let mut fresh = *self;
        fresh.imu = Imu::default();
        fresh.reset(&Measurement::default());
        fresh.flag = T::one();
        let sound = self.nominal.finite() & self.passed.finite() & self.rejected.is_finite();
        *self = blend(sound, self, &fresh);
    }

    /// The state `age` seconds ago; `lag` is kept by the caller for about this age.
    #[inline(always)]
    pub fn past(&self, age: T, lag: &Lag<T>) -> Past<T> {
        let Nominal { position, velocity, attitude, .. } = self.nominal;
        let Lag { acceleration, rate } = *lag;
        let drop = acceleration * age;
        Past {
            position: position - (velocity - drop * T::lit(0.5)) * age,
            velocity: velocity - drop,
            attitude: attitude * turn(rate * -age),
            age,
            now: attitude,
            rate,
            specific_force: attitude.inverse() * (acceleration + Vec3::up(self.gravity)),
        }
    }

    /// Takes these measurements in the lanes of the mask; all rows are linear about the state as it is
    /// now. A row that is not finite is ignored and raises the flag; one beyond the gate is counted.
    #[inline(always)]
    pub fn correct(&mut self, rows: &[Row<T>], mask: T::Mask) {
        // What follows changes nothing then.
        if (!mask).all() {
            return;
        }
        let mut error = [[T::zero(); 3]; 5];
        for row in rows {
            self.take(row, mask, &mut error);
        }
        self.covariance.raise(NARROWEST);
        let corrected = self.nominal.plus(&ErrorState::from_parts(error));
        let good = mask & corrected.sum(|x| x).is_finite();
        self.nominal = blend(good, &corrected, &self.nominal);
    }

    /// One scalar measurement: the covariance shrinks, the error gathered so far grows.
    #[cfg_attr(debug_assertions, inline(never))] // a frame of its own without optimisation
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn take(&mut self, row: &Row<T>, mask: T::Mask, error: &mut Parts<T>) {
        let gains = &self.gains;
        let h = row.gradient.parts();
        let c = self.covariance.apply(&h);
        let predicted = dot(&h, &c);
        let variance = row.variance * gains.measurement_noise.sq();
        let s = predicted + variance.max(predicted * T::lit(Covariance::<T>::SHARPEST));
        let y = row.residual - dot(&h, error);
        let sound = y.is_finite() & s.is_finite() & T::lit(T::Precision::TINY).le(s);
        let inside = y.sq().le(gains.gate.sq() * s);
        self.flag = T::select(mask & !sound, T::one(), self.flag);
        self.rejected += T::select(mask & sound & !inside, T::one(), T::zero());

        let taken = mask & sound & inside;
        let per_root = T::one() / s.sqrt();
        let scaled = T::select(taken, y * per_root, T::zero());
        let mut u = c;
        for i in 0..5 {
            for a in 0..3 {
                u[i][a] = T::select(taken, c[i][a] * per_root, T::zero());
                error[i][a] += u[i][a] * scaled;
            }
        }
        self.covariance.deflate(&u);
    }

    /// What the laws are told: `measurement` with the estimate in place of the truth.
    #[inline(always)]
    pub fn tell(&self, measurement: &Measurement<T>) -> Measurement<T> {
        let Nominal { position, velocity, attitude, .. } = self.nominal;
        Measurement { position, velocity, attitude, rate: self.rate(), ..*measurement }
    }
}

/// Scalar product of all fifteen numbers.
#[inline(always)]
fn dot<T: Real>(a: &Parts<T>, b: &Parts<T>) -> T {
    let part = |i: usize| a[i][0] * b[i][0] + a[i][1] * b[i][1] + a[i][2] * b[i][2];
    (part(0) + part(1)) + (part(2) + part(3)) + part(4)
}
