//! The best guess at the state, and how an error is taken into it.

use crate::math::{Body, Rotation, Vec3, World};
use crate::real::Real;
use crate::record;

use super::covariance::ErrorState;

record! {
    /// What the inertial sensors say.
    pub struct Imu {
        /// Acceleration less gravity.
        specific_force: Vec3<T, Body> [m/s^2];
        /// Angular velocity.
        rate: Vec3<T, Body> [rad/s];
    }
}

record! {
    /// The best guess at the state.
    pub struct Nominal {
        /// Centre of mass.
        position: Vec3<T, World> [m];
        /// Velocity of the centre of mass.
        velocity: Vec3<T, World> [m/s];
        /// Body to world.
        attitude: Rotation<T, Body, World> [1];
        /// What the gyro reads at rest.
        gyro_bias: Vec3<T, Body> [rad/s];
        /// What the accelerometer reads too much.
        accelerometer_bias: Vec3<T, Body> [m/s^2];
    }
}

/// The rotation by this vector; its error is 2e-11 at 0.1 rad, 2e-6 at 0.5 rad.
#[inline(always)]
pub fn turn<T: Real>(vector: Vec3<T, Body>) -> Rotation<T, Body, Body> {
    let h2 = vector.norm_squared() * T::lit(0.25);
    let cos = T::one() - h2 * (T::lit(0.5) - h2 * T::lit(1.0 / 24.0));
    let sin = T::lit(0.5) - h2 * (T::lit(1.0 / 12.0) - h2 * T::lit(1.0 / 240.0));
    Rotation::from_quaternion(cos, vector.x * sin, vector.y * sin, vector.z * sin)
}

impl<T: Real> Nominal<T> {
    /// The state with this error taken in.
    #[inline(always)]
    pub fn plus(&self, error: &ErrorState<T>) -> Self {
        let half = error.attitude * T::lit(0.5);
        let by = Rotation::<T, Body, Body>::from_quaternion(T::one(), half.x, half.y, half.z);
        Self {
            position: self.position + error.position,
            velocity: self.velocity + error.velocity,
            attitude: (self.attitude * by).normalised(),
            gyro_bias: self.gyro_bias + error.gyro_bias,
            accelerometer_bias: self.accelerometer_bias + error.accelerometer_bias,
        }
    }
}
