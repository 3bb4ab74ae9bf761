//! The closed loop's bookkeeping: what ends a flight, how time counts, and what must not matter.
//!
//! The failing flights have no feedback, so that the moment of failure has a closed form.
// Tests compare bits, take the standard library as their second opinion, and print figures as their
// source prints them.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::approx_constant, clippy::float_cmp)]

mod common;

use common::{Scene, bits, body, gains, hosm, named, source, step, world};
use stormpetrel_control::attitude::{AttitudeLawSettings, tilt_priority};
use stormpetrel_control::math::Vec3;
use stormpetrel_control::observer::hosm::{Input, Z2};
use stormpetrel_control::rate::{RateLawSettings, pid};
use stormpetrel_plant::disturbance::{DisturbanceSettings, harmonic};
use stormpetrel_plant::flight::{Cause, Flight};
use stormpetrel_plant::state::State;

/// Hover with all feedback off: the vehicle goes where the constant push sends it.
fn adrift(push: harmonic::Gains<f64>) -> Flight<f64> {
    let still = tilt_priority::Gains { k1: Vec3::zero(), ..tilt_priority::Gains::default() };
    let free = pid::Gains { k_omega: Vec3::zero(), ..pid::Gains::default() };
    let scene = Scene {
        position: gains(0.0, 0.0, 0.0),
        attitude: AttitudeLawSettings::TiltPriority(still, ()),
        rate: RateLawSettings::Pid(free, ()),
        actuation: named("wrench"),
        reference: named("hover"),
        disturbance: harmonic::Gains { sine: 0.0, cosine: 0.0, ..push },
        ..Scene::default()
    };
    scene.flight()
}

/// Flies until the flight ends; ticks flown and cause. Then checks that nothing moves any more.
fn end(flight: &mut Flight<f64>) -> (f64, Option<Cause>) {
    for _ in 0..3000 {
        assert_eq!((flight.alive, flight.cause), (1.0, 0.0));
        step(flight);
        if flight.alive == 0.0 {
            break;
        }
    }
    let result = (flight.flown, Cause::from_code(flight.cause));
    let frozen = bits(&flight.state);
    for _ in 0..100 {
        step(flight);
        assert_eq!(bits(&flight.state), frozen, "a failed flight stands still");
    }
    assert_eq!((flight.flown, Cause::from_code(flight.cause)), result, "the first cause stays");
    result
}

#[test]
fn too_far_from_the_reference_ends_the_flight() {
    // 1 m/s^2 to the east: t^2/2 exceeds 0.50025 m between 1.000 s and 1.001 s.
    let push = harmonic::Gains { force: world(0.625, 0.0, 0.0), ..harmonic::Gains::default() };
    let mut flight = adrift(push);
    flight.limits.position_error = 0.50025;
    assert_eq!(end(&mut flight), (1001.0, Some(Cause::PositionError)));
    assert!((flight.state.position.x - 1.001 * 1.001 / 2.0).abs() < 1e-12);
}

#[test]
fn ground_contact_ends_the_flight() {
    let push = harmonic::Gains { force: world(0.0, 0.0, -0.625), ..harmonic::Gains::default() };
    let mut flight = adrift(push);
    flight.limits.ground = -0.50025;
    assert_eq!(end(&mut flight), (1001.0, Some(Cause::Ground)));
}

#[test]
fn too_much_tilt_ends_the_flight() {
    // 1 rad/s^2 of roll: t^2/2 exceeds 30 deg at 1.0233 s, so at tick 1024.
    let push = harmonic::Gains { torque: body(2.6e-3, 0.0, 0.0), ..harmonic::Gains::default() };
    let mut flight = adrift(push);
    flight.limits.tilt_deg = 30.0;
    flight.limits.position_error = 1e9;
    assert_eq!(end(&mut flight), (1024.0, Some(Cause::Tilt)));
    // A limit of 180 deg allows any attitude: the same vehicle turns over.
    let mut flight = adrift(push);
    flight.limits.position_error = 1e9;
    (0..2600).for_each(|_| step(&mut flight));
    assert_eq!(flight.alive, 1.0);
    assert!(flight.state.attitude.z_axis().z < -0.9, "{:?}", flight.state.attitude);
}

#[test]
fn a_state_that_is_no_number_ends_the_flight_before_it_is_stored() {
    let push = harmonic::Gains { torque: body(1e306, 0.0, 0.0), ..harmonic::Gains::default() };
    let mut flight = adrift(push);
    let start = bits(&flight.state);
    let (flown, cause) = end(&mut flight);
    assert_eq!((flown, cause), (0.0, Some(Cause::NonFinite)));
    assert_eq!(bits(&flight.state), start, "the last finite state stays");
}

#[test]
fn the_first_cause_stays_when_others_follow() {
    // Two limits in one tick: the first in the order of the list counts.
    let push = harmonic::Gains { force: world(0.0, 0.0, -0.625), ..harmonic::Gains::default() };
    let mut flight = adrift(push);
    (flight.limits.ground, flight.limits.position_error) = (-0.50025, 0.50025);
    assert_eq!(end(&mut flight), (1001.0, Some(Cause::PositionError)));
    // The frozen vehicle is left behind by its reference, but it has touched the ground.
    let mut flight = Scene::default().flight();
    flight.limits.ground = flight.state.position.z + 0.001;
    (0..8000).for_each(|_| step(&mut flight));
    let tick = flight.decide();
    assert!((tick.position - tick.reference.position).norm() > flight.limits.position_error);
    assert_eq!(Cause::from_code(flight.cause), Some(Cause::Ground));
}

#[test]
fn every_cause_has_its_number_and_no_number_is_no_cause() {
    assert_eq!(Cause::from_code(0.0), None);
    assert_eq!(Cause::from_code(5.0), None);
    let all = [Cause::PositionError, Cause::Tilt, Cause::Ground, Cause::NonFinite];
    for (code, cause) in [1.0, 2.0, 3.0, 4.0].into_iter().zip(all) {
        assert_eq!(Cause::from_code(code), Some(cause));
        assert!(!cause.describe().is_empty());
    }
}

#[test]
fn a_healthy_flight_ends_for_no_reason() {
    let mut flight = Scene::default().flight();
    flight.limits.tilt_deg = 60.0;
    for _ in 0..5000 {
        let tick = flight.decide();
        assert_eq!(tick.flags, 0.0);
        flight.advance(&tick);
    }
    assert_eq!((flight.alive, flight.cause, flight.flown), (1.0, 0.0, 5000.0));
}

#[test]
fn time_is_a_count_times_the_step_and_never_a_sum() {
    let mut flight = Scene { reference: named("hover"), ..Scene::default().calm() }.flight();
    let ticks = if cfg!(debug_assertions) { 10_000u32 } else { 1_000_000 };
    let (mut sum, dt) = (0.0, flight.control_step);
    for k in 0..ticks {
        let tick = flight.decide();
        assert_eq!(tick.time.to_bits(), (f64::from(k) * dt).to_bits());
        flight.advance(&tick);
        sum += dt;
    }
    assert_eq!(flight.time().to_bits(), (f64::from(ticks) * dt).to_bits());
    assert!(sum.to_bits() != flight.time().to_bits(), "a sum would have drifted");
    // A day, and far beyond the 2^32 of a counter that wraps.
    for tick in [86_400_001u64, (1 << 33) + 1, (1 << 52) + 1] {
        flight.tick = tick;
        assert_eq!(flight.time().to_bits(), (tick as f64 * dt).to_bits());
    }
}

#[test]
fn the_hour_of_the_day_does_not_matter() {
    // Reliability, goal 5: with nothing that depends on time, a shifted clock gives the same bits.
    let steady = harmonic::Gains { sine: 0.0, cosine: 0.0, ..Scene::default().disturbance };
    let scene = Scene {
        reference: named("hover"),
        observer: hosm(1.5, Input::Measured, Z2::Single),
        disturbance: steady,
        actuation: named("rotors"),
        ..Scene::default()
    };
    for late in [2_142_000u64, 4_294_967_295, 4_294_967_296_000] {
        let (mut now, mut later) = (scene.flight(), scene.flight());
        later.tick = late;
        for tick in 0..500 {
            step(&mut now);
            step(&mut later);
            assert_eq!(bits(&now.state), bits(&later.state), "tick {tick}");
        }
    }
}

#[test]
fn an_observer_that_sees_nothing_is_no_observer_bit_for_bit() {
    // Without disturbance in hover every error of the observer is exactly zero; with L = 0 it
    // cannot move its estimate at all.
    let hover = Scene { reference: named("hover"), ..Scene::default().calm() };
    for (scene, lipschitz) in [(hover, 1.5), (Scene::default(), 0.0)] {
        for z2 in [Z2::Single, Z2::Doubled] {
            let observed = Scene { observer: hosm(lipschitz, Input::Measured, z2), ..scene };
            let (mut with, mut without) = (observed.flight(), scene.flight());
            for tick in 0..3000 {
                step(&mut with);
                step(&mut without);
                assert_eq!(bits(&with.state), bits(&without.state), "tick {tick}, {z2:?}");
            }
        }
    }
}

#[test]
fn a_disturbance_of_zero_is_no_disturbance_bit_for_bit() {
    let (mut zero, mut none) = (Scene::default().calm().flight(), Scene::default().calm().flight());
    none.disturbance[0] = source(named::<DisturbanceSettings>("none"), &none.vehicle);
    for tick in 0..3000 {
        step(&mut zero);
        step(&mut none);
        assert_eq!(bits(&zero.state), bits(&none.state), "tick {tick}");
    }
}

#[test]
fn disturbances_add_up() {
    let scene = Scene::default();
    let mut one = scene.flight();
    let half = harmonic::Gains {
        force: scene.disturbance.force * 0.5,
        torque: scene.disturbance.torque * 0.5,
        ..scene.disturbance
    };
    let mut two = Scene { disturbance: half, ..scene }.flight();
    two.disturbance[3] = two.disturbance[0];
    two.start(two.state); // a flight counts its disturbances when it starts
    let (a, b) = (one.decide().disturbance, two.decide().disturbance);
    // h(0) = 2: 1 N and 0.04 N m.
    assert_eq!(bits(&a), bits(&b));
    assert_eq!((a.force.x, a.torque.y), (1.0, 0.04));
    step(&mut one);
}

#[test]
fn the_lumped_disturbance_is_what_the_law_s_model_leaves_unexplained() {
    // m_law (a + g e_z) - T R e_z: with the true mass it is the force itself; a law that believes
    // in 1.2 times the mass sees the force and 0.2 m (a + g e_z) more.
    let scene = Scene { actuation: named("rotors"), ..Scene::default() };
    let mut flight = scene.flight();
    (0..200).for_each(|_| step(&mut flight));
    let tick = flight.decide();
    assert!((tick.disturbance.lumped - tick.disturbance.force).norm() < 1e-14);
    let thrust = tick.attitude.z_axis() * tick.applied.thrust;
    let mass = flight.vehicle.mass;
    flight.model.mass = 1.2 * mass;
    let want = tick.disturbance.force + (thrust + tick.disturbance.force) * 0.2;
    let got = flight.decide().disturbance.lumped;
    assert!((got - want).norm() < 1e-13, "{got:?}, not {want:?}");
}

#[test]
fn a_start_leaves_nothing_of_the_flight_before() {
    for actuation in ["thrust-vector", "wrench", "lagged-wrench", "rotors"] {
        let observer = hosm(1.5, Input::Measured, Z2::Single);
        let scene = Scene { observer, actuation: named(actuation), ..Scene::default() };
        let (mut used, mut fresh) = (scene.flight(), scene.flight());
        let start: State<f64> = used.state;
        (0..500).for_each(|_| step(&mut used));
        used.start(start);
        for tick in 0..500 {
            let (a, b) = (used.decide(), fresh.decide());
            assert_eq!(bits(&a), bits(&b), "{actuation}, tick {tick}");
            used.advance(&a);
            fresh.advance(&b);
        }
    }
}
