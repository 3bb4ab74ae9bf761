//! Quadrotor control laws and disturbance observers, as pure values.
//!
//! No heap, no clock, no I/O: the same source flies in a simulation, in eight SIMD lanes, in a
//! browser and on a microcontroller, with the same bits. World frame z up (ENU), body x forward, y
//! left, z up (FLU), Hamilton quaternions `w x y z` body to world, SI units.
//!
//! The ladder of signals, each level with its laws:
//!
//! | from | to | laws |
//! |---|---|---|
//! | [`signals::Trajectory`] | [`signals::Thrust`] | [`position`], with an [`observer`] |
//! | [`signals::Thrust`] | [`signals::Attitude`] | [`attitude_reference`] |
//! | [`signals::Attitude`] | [`signals::Rate`] | [`attitude`] |
//! | [`signals::Rate`] | [`signals::Wrench`] | [`rate`] |
//! | [`signals::Wrench`] | rotor thrusts | [`allocation`] |
//!
//! [`stack::Stack`] is all of them.

#![cfg_attr(not(any(feature = "std", test)), no_std)]

pub mod allocation;
pub mod attitude;
pub mod attitude_reference;
pub mod controller;
pub mod estimator;
pub mod filter;
pub mod guard;
pub mod lanes;
pub mod math;
pub mod observer;
pub mod options;
pub mod position;
pub mod rate;
pub mod real;
pub mod record;
pub mod registry;
mod root;
pub mod signals;
pub mod special;
pub mod stack;
