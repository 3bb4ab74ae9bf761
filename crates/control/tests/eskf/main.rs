//! The error-state filter against a fine integration, matrix exponentials and a dense Kalman filter.
// Tests compare bits, take the standard library as their second opinion, and print figures as their
// source prints them.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::approx_constant, clippy::float_cmp)]

#[path = "../common/mod.rs"]
mod common;
mod lanes;
mod motion;
mod oracle;
mod totality;
mod updates;
