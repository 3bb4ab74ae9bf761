//! The state of the vehicle and its time derivative.

use stormpetrel_control::math::{Body, Rotation, Vec3, World};
use stormpetrel_control::real::Real;
use stormpetrel_control::record;

record! {
    /// State of the vehicle.
    pub struct State {
        /// Centre of mass.
        position: Vec3<T, World> [m];
        /// Velocity of the centre of mass.
        velocity: Vec3<T, World> [m/s];
        /// Body to world.
        attitude: Rotation<T, Body, World> [1];
        /// Angular velocity.
        rate: Vec3<T, Body> [rad/s];
        /// Speed of each rotor.
        rotor_speed: [T; 4] [rad/s];
    }
}

record! {
    /// Time derivative of the body's state; rotor speeds are known in closed form.
    pub struct Derivative {
        /// Velocity.
        position: Vec3<T, World> [m/s];
        /// Acceleration.
        velocity: Vec3<T, World> [m/s^2];
        /// Twice the derivative of the quaternion, w x y z.
        attitude: [T; 4] [1/s];
        /// Angular acceleration.
        rate: Vec3<T, Body> [rad/s^2];
    }
}

impl<T: Real> State<T> {
    /// The state `h` seconds on along a constant derivative, with these rotor speeds; the quaternion is
    /// not normalised.
    #[inline(always)]
    pub fn along(&self, d: &Derivative<T>, h: T, rotor_speed: [T; 4]) -> Self {
        let (q, [w, x, y, z], half) = (self.attitude, d.attitude, h.half());
        Self {
            position: self.position + d.position * h,
            velocity: self.velocity + d.velocity * h,
            attitude: Rotation::from_quaternion(
                q.w + w * half,
                q.x + x * half,
                q.y + y * half,
                q.z + z * half,
            ),
            rate: self.rate + d.rate * h,
            rotor_speed,
        }
    }
}
