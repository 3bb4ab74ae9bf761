//! Hover is a fixed point: the error is not small but zero.
// Tests compare bits, take the standard library as their second opinion, and print figures as their
// source prints them.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::approx_constant, clippy::float_cmp)]

mod common;

use common::{Scene, bits, hosm, named, step, world};
use stormpetrel_control::observer::hosm::{Input, Z2};
use stormpetrel_plant::flight::Flight;
use stormpetrel_plant::reference::{ReferenceSettings, hover};

const TICKS: u32 = 20_000;

fn at(position: [f64; 3], yaw: f64) -> ReferenceSettings {
    let [x, y, z] = position;
    ReferenceSettings::Hover(hover::Gains { position: world(x, y, z), yaw }, ())
}

/// Largest distance from the reference.
fn drift(mut flight: Flight<f64>) -> f64 {
    (0..TICKS).fold(0.0, |most, _| {
        let tick = flight.decide();
        flight.advance(&tick);
        let e = (tick.position - tick.reference.position).norm();
        if e > most { e } else { most }
    })
}

#[test]
fn hover_under_an_ideal_wrench_does_not_move_by_a_bit() {
    for actuation in ["wrench", "lagged-wrench", "thrust-vector"] {
        for observer in [named("none"), hosm(1.5, Input::Measured, Z2::Single)] {
            let scene = Scene {
                actuation: named(actuation),
                reference: at([1.25, -3.0, 7.1], 0.0),
                observer,
                ..Scene::default().calm()
            };
            let mut flight = scene.flight();
            let start = bits(&flight.state);
            for tick in 0..TICKS {
                step(&mut flight);
                assert_eq!(bits(&flight.state), start, "{actuation}, tick {tick}");
            }
        }
    }
}

#[test]
fn hover_on_rotors_stays_within_a_picometre() {
    let scene = Scene {
        actuation: named("rotors"),
        reference: at([1.0, -3.0, 0.5], 0.0),
        ..Scene::default().calm()
    };
    let drift = drift(scene.flight());
    assert!(drift < 1e-12, "{drift:e} m");
}

#[test]
fn hover_of_any_vehicle_stays_within_a_picometre() {
    for (mass, yaw) in [(0.027, 0.0), (0.7, 0.0), (1.1, 0.0), (3.3, 0.0)] {
        for actuation in ["wrench", "lagged-wrench"] {
            let mut scene = Scene {
                actuation: named(actuation),
                reference: at([0.1, 0.2, 0.3], yaw),
                ..Scene::default().calm()
            };
            scene.vehicle.mass = mass;
            let drift = drift(scene.flight());
            assert!(drift < 1e-12, "{mass} kg, {actuation}: {drift:e} m");
        }
    }
}
