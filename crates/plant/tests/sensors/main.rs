//! Sensors against the laws of their noise, and what must hold for each of them: exact delays, independent
//! numbers, the same bits in lanes, and no broken number that gets through.
// Tests compare bits, take the standard library as their second opinion, and print figures as their
// source prints them.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::approx_constant, clippy::float_cmp)]
#![allow(clippy::manual_is_multiple_of)] // remainders read better beside each other

#[path = "../common/mod.rs"]
mod common;
mod delays;
mod noise;
mod rig;
mod together;
