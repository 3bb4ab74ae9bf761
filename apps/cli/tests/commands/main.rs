//! The commands as a user runs them: what they print, what they write, how they end.
// Tests compare bits, take the standard library as their second opinion, and print figures as their
// source prints them.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::approx_constant, clippy::float_cmp)]

mod check;
mod names;
mod program;
mod refused;
mod run;
#[cfg(unix)]
mod streams;
