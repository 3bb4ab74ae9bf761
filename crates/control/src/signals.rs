//! The signals between the blocks of the control diagram.
//!
//! `Trajectory -> Thrust -> Attitude -> Rate -> Wrench`: each carries the feed-forward of the next
//! level, so nothing that the reference knows is lost on the way down.

use crate::math::{Body, Rotation, Vec3, World};
use crate::record;

record! {
    /// What a law may know of the vehicle.
    pub struct Measurement {
        /// Centre of mass.
        position: Vec3<T, World> [m];
        /// Velocity of the centre of mass.
        velocity: Vec3<T, World> [m/s];
        /// Body to world.
        attitude: Rotation<T, Body, World> [1];
        /// Angular velocity.
        rate: Vec3<T, Body> [rad/s];
        /// Thrust and torque that the rotors deliver now, as the law's model of them says.
        achieved: Wrench<T> [];
        /// The part of the previous command that the allocation could not grant (command - granted).
        unallocated: Wrench<T> [];
    }
}

record! {
    /// Where to be: position with derivatives up to snap, and yaw.
    pub struct Trajectory {
        /// Position.
        position: Vec3<T, World> [m];
        /// First derivative.
        velocity: Vec3<T, World> [m/s];
        /// Second derivative.
        acceleration: Vec3<T, World> [m/s^2];
        /// Third derivative.
        jerk: Vec3<T, World> [m/s^3];
        /// Fourth derivative.
        snap: Vec3<T, World> [m/s^4];
        /// Heading, about the world's up axis.
        yaw: T [rad];
        /// First derivative of the yaw.
        yaw_rate: T [rad/s];
        /// Second derivative of the yaw.
        yaw_acceleration: T [rad/s^2];
    }
}

record! {
    /// The thrust vector that the position loop asks for, per mass.
    pub struct Thrust {
        /// Specific thrust, weight included: zero acceleration is gravity, upwards.
        force: Vec3<T, World> [m/s^2];
        /// Its first derivative, as far as the trajectory tells.
        force_rate: Vec3<T, World> [m/s^3];
        /// Its second derivative, as far as the trajectory tells.
        force_acceleration: Vec3<T, World> [m/s^4];
        /// Heading asked for.
        yaw: T [rad];
        /// First derivative of the yaw.
        yaw_rate: T [rad/s];
        /// Second derivative of the yaw.
        yaw_acceleration: T [rad/s^2];
    }
}

record! {
    /// The attitude that turns the rotors' thrust into the wanted direction.
    pub struct Attitude {
        /// Reference body to world.
        rotation: Rotation<T, Body, World> [1];
        /// Angular velocity of the reference, in the reference's own axes.
        rate: Vec3<T, Body> [rad/s];
        /// Angular acceleration of the reference, in the reference's own axes.
        acceleration: Vec3<T, Body> [rad/s^2];
        /// Total thrust.
        thrust: T [N];
    }
}

record! {
    /// The angular motion asked for.
    pub struct Rate {
        /// Angular velocity.
        rate: Vec3<T, Body> [rad/s];
        /// Angular acceleration beside what the rate error adds.
        acceleration: Vec3<T, Body> [rad/s^2];
        /// Total thrust.
        thrust: T [N];
    }
}

record! {
    /// Total thrust along the body's up axis, and torque.
    pub struct Wrench {
        /// Sum of the rotors' thrusts.
        thrust: T [N];
        /// Torque about the centre of mass.
        torque: Vec3<T, Body> [N m];
    }
}

record! {
    /// What drove the vehicle in the interval just commanded, as acceleration without disturbance.
    pub struct Applied {
        /// What the position loop asked for: u = f.
        commanded: Vec3<T, World> [m/s^2];
        /// What the rotors gave along the body's real axis: u = -g e_z + (T/m) R e_z.
        measured: Vec3<T, World> [m/s^2];
    }
}

record! {
    /// What the laws believe of the vehicle; the plant may differ.
    pub struct Model {
        /// Mass.
        mass: T [kg] = 0.625, in 1e-3 => 100.0;
        /// Gravitational acceleration.
        gravity: T [m/s^2] = 9.8, in 0.0 => 30.0;
        /// Principal moments of inertia about the body axes.
        inertia: Vec3<T, Body> [kg m^2] = 2.6e-3, in 1e-7 => 10.0;
    }
}
