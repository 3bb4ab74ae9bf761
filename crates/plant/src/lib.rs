//! What is controlled: the quadrotor, what pushes it, where it should fly, and the closed loop.
//!
//! [`flight::Flight`] is the only closed loop in the project: single flights, lanes, browser and
//! firmware tests all step that one.

#![cfg_attr(not(any(feature = "std", test)), no_std)]

pub mod actuation;
pub mod aerodynamics;
pub mod dispatch;
pub mod disturbance;
pub mod dynamics;
pub mod flight;
#[cfg(all(feature = "std", target_arch = "x86_64"))]
pub mod pair;
pub mod random;
pub mod reference;
pub mod sensor;
pub mod sling;
pub mod state;
pub mod timing;
pub mod vehicle;
pub mod world;
