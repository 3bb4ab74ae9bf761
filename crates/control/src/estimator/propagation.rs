//! The covariance moves with the state: equation (3) of [`eskf`](super::eskf).

use crate::math::{Body, Rotation, Vec3, World};
use crate::real::{Mask as _, Real};
use crate::record;
use crate::record::blend;

use super::block::{Multiple, columns};
use super::covariance::{
    ACCELEROMETER_BIAS, ATTITUDE, Covariance, ErrorState, GYRO_BIAS, POSITION, VELOCITY,
};
use super::eskf::Eskf;

record! {
    /// What has passed since the covariance last moved.
    pub struct Passed {
        /// Time, D.
        time: T [s];
        /// Turn of the body, from now to then E.
        turn: Rotation<T, Body, Body> [1];
        /// Velocity from the specific force, S.
        velocity: Vec3<T, World> [m/s];
    }
}

/// Largest variance, of any unit.
const WIDEST: f64 = 1e8;

impl<T: Real> Eskf<T> {
    /// The covariance moves to now (3): in the lanes `now`, and where its time has come.
    #[inline(always)]
    pub fn propagate(&mut self, now: T::Mask) {
        let due = T::one().le((self.passed.time * T::lit(1.0 + 1e-6)) * self.gains.covariance_hz);
        let due = (due | now) & T::zero().lt(self.passed.time);
        // What follows changes nothing then.
        if (!due).all() {
            return;
        }
        let mut moved = self.moved();
        let lost = moved.bound(T::lit(WIDEST), &self.initial());
        self.flag = T::select(lost & due, T::one(), self.flag);
        if due.all() {
            (self.covariance, self.passed) = (moved, Passed::default());
        } else {
            self.covariance = blend(due, &moved, &self.covariance);
            self.passed = blend(due, &Passed::default(), &self.passed);
        }
    }

    /// The covariance now, from the last one and what has passed (3).
    #[cfg_attr(debug_assertions, inline(never))] // a frame of its own without optimisation
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn moved(&self) -> Covariance<T> {
        let Passed { time, turn, velocity: s } = self.passed;
        let half = time.half();
        let now = self.nominal.attitude;
        let then = now * turn.inverse();
        let (x, y, z) = (then.x_axis(), then.y_axis(), then.z_axis());
        let tilting = columns(x.cross(s), y.cross(s), z.cross(s)); // -S x R_0
        let (nx, ny, nz) = (now.x_axis(), now.y_axis(), now.z_axis());
        let leaning = columns((x + nx) * -half, (y + ny) * -half, (z + nz) * -half);
        let back = turn.inverse();
        let e = columns(back.x_axis(), back.y_axis(), back.z_axis());

        let mut p = self.covariance;
        let noise = self.noise(half);
        p.add(&noise);
        p.shear(POSITION, VELOCITY, &Multiple(half));
        p.shear(ATTITUDE, GYRO_BIAS, &Multiple(-half));
        p.shear(VELOCITY, ATTITUDE, &tilting);
        p.shear(VELOCITY, ACCELEROMETER_BIAS, &leaning);
        p.turn(ATTITUDE, &e);
        p.shear(ATTITUDE, GYRO_BIAS, &Multiple(-half));
        p.shear(POSITION, VELOCITY, &Multiple(half));
        p.add(&noise);
        p
    }

    /// Variances that the noise adds in `time` seconds.
    #[inline(always)]
    fn noise(&self, time: T) -> ErrorState<T> {
        let gains = &self.gains;
        let variance = |density: T| Vec3::splat(density.sq() * time);
        ErrorState {
            position: Vec3::zero(),
            velocity: variance(gains.accelerometer_noise),
            attitude: variance(gains.gyro_noise).assume_frame(),
            gyro_bias: variance(gains.gyro_walk).assume_frame(),
            accelerometer_bias: variance(gains.accelerometer_walk).assume_frame(),
        }
    }
}
