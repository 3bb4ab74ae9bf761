//! Proofs of portability: the same bits on every target.
//!
//! | module | on | what |
//! |---|---|---|
//! | [`experiment`] | host, WASM | flies every shipped scenario, alone and side by side, and hashes every number |
//! | [`recipe`] | host | says which flights are recorded: every registered law is in one |
//! | [`record`] | host | writes down what a control stack was told and what it answered |
//! | [`replay`] | everywhere | tells a stack the same again and compares every bit of its answers |
//! | [`exercise`] | bare metal | reaches every registered law, for the search of panics and heap |
//!
//! `refused.rs` holds lines that must not compile, as documentation tests.
//!
//! `cargo xtask hash`, `cargo xtask firmware` and `cargo xtask symbols` run them. Without the feature
//! `experiment` the crate is `no_std`, without heap, and depends on the control laws alone.

#![cfg_attr(not(feature = "experiment"), no_std)]

pub mod bytes;
pub mod exercise;
#[cfg(feature = "experiment")]
pub mod experiment;
pub mod laws;
#[cfg(feature = "experiment")]
pub mod recipe;
#[cfg(feature = "experiment")]
pub mod record;
#[cfg(doctest)]
mod refused;
pub mod replay;
