//! The hash of all shipped flights is the one in the repository, in debug and in release, single and
//! in lanes of every width. `cargo xtask hash --write` renews it after a wanted change.
// Tests compare bits, take the standard library as their second opinion, and print figures as their
// source prints them.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::approx_constant, clippy::float_cmp)]
#![cfg(feature = "experiment")]

use stormpetrel_plant::dispatch::Width;
use stormpetrel_portable::experiment::{WHOLE, alone, changed, flights, side_by_side, text};

const EXPECTED: &str = include_str!("../../../scenarios/experiment.hash");

#[test]
fn regress_experiment_hash() {
    let flown = alone(&flights().expect("shipped scenarios can be read"));
    assert_eq!(changed(EXPECTED, &flown), None);
    assert_eq!(EXPECTED, text(&flown));
}

/// In debug, functions are not compiled once more for wide registers, and lanes are slow: one width,
/// and without the whole flights.
#[test]
fn regress_experiment_hash_in_lanes() {
    let mut flights = flights().expect("shipped scenarios can be read");
    if cfg!(debug_assertions) {
        flights.retain(|scenario| !WHOLE.contains(&scenario.name.as_str()));
    }
    for width in Width::available().filter(|&w| w == Width::Baseline || !cfg!(debug_assertions)) {
        let flown = side_by_side(&flights, width);
        assert_eq!(flown.len(), flights.len());
        assert_eq!(changed(EXPECTED, &flown), None, "{}", width.name());
    }
}
