//! Vectors and rotations that know their frame.

mod matrix;
mod rotation;
mod vector;

pub use matrix::inverse4;
pub use rotation::{Euler, Rotation};
pub use vector::{Body, Frame, Vec3, World};
