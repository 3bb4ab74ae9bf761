//! The closed loop does not care which way the world is turned or mirrored.
//!
//! * Mirror y -> -y: position, velocity and force change the sign of y; rate, torque and the vector
//!   part of the quaternion, being axial, change x and z. Every operation of the loop keeps this bit
//!   for bit, because a rounding does not see signs. On rotors the mirror exchanges left and right,
//!   and a sum of four thrusts rounds in another order: there the bound is 1e-12 m.
//! * Cyclic change of axes, for the point mass without weight: bit for bit.
//! * Any yaw of the whole scenario: the sines differ, so the bound is 1e-9 m over 10 s.
// Tests compare bits, take the standard library as their second opinion, and print figures as their
// source prints them.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::approx_constant, clippy::float_cmp)]

mod common;

use common::{Scene, body, hosm, named, rotation_reference, step, unfiltered, world};
use stormpetrel_control::attitude_reference::Rates;
use stormpetrel_control::math::{Body, Euler, Rotation, Vec3, World};
use stormpetrel_control::observer::hosm::{Input, Z2};
use stormpetrel_plant::flight::Flight;
use stormpetrel_plant::reference::{Refer, ReferenceSettings, helix, hover};
use stormpetrel_plant::state::State;

fn mirror(v: Vec3<f64, World>) -> Vec3<f64, World> {
    world(v.x, -v.y, v.z)
}

fn mirror_axial(v: Vec3<f64, Body>) -> Vec3<f64, Body> {
    body(-v.x, v.y, -v.z)
}

fn mirrored(s: &State<f64>) -> State<f64> {
    let (q, [front, right, rear, left]) = (s.attitude, s.rotor_speed);
    State {
        position: mirror(s.position),
        velocity: mirror(s.velocity),
        attitude: Rotation::from_quaternion(q.w, -q.x, q.y, -q.z),
        rate: mirror_axial(s.rate),
        rotor_speed: [front, left, rear, right],
    }
}

/// A scene away from all symmetry, and its mirror image.
fn mirror_pair(actuation: &str, observer: bool) -> [Scene; 2] {
    let mut scene = Scene { actuation: named(actuation), ..Scene::default() };
    if observer {
        scene.observer = hosm(1.5, Input::Measured, Z2::Single);
    }
    let path = helix::Gains { center: world(0.3, -0.7, 1.0), ..helix::Gains::default() };
    scene.reference =
        ReferenceSettings::Helix(helix::Gains { yaw: 0.4, yaw_rate: 0.3, ..path }, ());
    scene.disturbance.force = world(0.5, 0.3, -0.2);
    scene.disturbance.torque = body(0.01, -0.02, 0.005);
    let mut image = scene;
    // r sin(w t) stays and r cos(w t) turns over when r and w change sign together.
    image.reference = ReferenceSettings::Helix(
        helix::Gains {
            radius: -path.radius,
            frequency: -path.frequency,
            center: mirror(path.center),
            yaw: -0.4,
            yaw_rate: -0.3,
            ..path
        },
        (),
    );
    image.disturbance.force = mirror(scene.disturbance.force);
    image.disturbance.torque = mirror_axial(scene.disturbance.torque);
    // Seen in the mirror, every rotor spins the other way.
    image.vehicle.drag_coefficient = -scene.vehicle.drag_coefficient;
    [scene, image]
}

fn start(flight: &mut Flight<f64>) -> State<f64> {
    let state = State {
        position: flight.state.position + world(0.1, 0.2, -0.1),
        velocity: flight.state.velocity,
        attitude: Rotation::from_euler(Euler { roll: 0.2, pitch: -0.1, yaw: 0.3 }),
        rate: body(0.3, -0.2, 0.5),
        rotor_speed: [1400.0, 1450.0, 1500.0, 1420.0],
    };
    flight.start(state);
    state
}

/// What differs in bits; a zero is a zero.
fn same(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits() || (a == 0.0 && b == 0.0)
}

fn components(s: &State<f64>) -> [f64; 13] {
    let (p, v, q, w) = (s.position, s.velocity, s.attitude, s.rate);
    [p.x, p.y, p.z, v.x, v.y, v.z, q.w, q.x, q.y, q.z, w.x, w.y, w.z]
}

#[test]
fn a_mirrored_scenario_gives_the_mirrored_flight_bit_for_bit() {
    for actuation in ["thrust-vector", "wrench", "lagged-wrench"] {
        for observer in [false, true] {
            let [mut flight, mut image] = mirror_pair(actuation, observer).map(|s| s.flight());
            let begin = start(&mut flight);
            image.start(mirrored(&begin));
            for tick in 0..10_000 {
                step(&mut flight);
                step(&mut image);
                let (want, got) = (components(&mirrored(&flight.state)), components(&image.state));
                for (i, (want, got)) in want.into_iter().zip(got).enumerate() {
                    assert!(
                        same(want, got),
                        "{actuation}, tick {tick}, number {i}: {want:e} {got:e}"
                    );
                }
            }
            assert!(flight.alive > 0.0 && flight.state.position.norm() > 1.0, "it flew");
        }
    }
}

#[test]
fn a_mirrored_scenario_on_rotors_gives_the_mirrored_flight_to_a_picometre() {
    let [mut flight, mut image] = mirror_pair("rotors", false).map(|s| s.flight());
    let begin = start(&mut flight);
    image.start(mirrored(&begin));
    for _ in 0..10_000 {
        step(&mut flight);
        step(&mut image);
        let off = (mirror(flight.state.position) - image.state.position).norm();
        assert!(off < 1e-12, "{off:e} m");
    }
    assert!(flight.alive > 0.0);
}

#[test]
fn a_point_mass_without_weight_does_not_tell_its_axes_apart() {
    let turn = |v: Vec3<f64, World>| world(v.z, v.x, v.y);
    for observer in [named("none"), hosm(1.5, Input::Commanded, Z2::Single)] {
        let scene = |k: fn(Vec3<f64, World>) -> Vec3<f64, World>| {
            let mut scene =
                Scene { actuation: named("thrust-vector"), observer, ..Scene::default() };
            scene.vehicle.gravity = 0.0;
            let position = k(world(0.3, -1.7, 2.9));
            scene.reference = ReferenceSettings::Hover(hover::Gains { position, yaw: 0.0 }, ());
            scene.disturbance.force = k(world(0.5, -0.3, 0.1));
            let mut flight = scene.flight();
            flight.start(State {
                position: k(world(0.0, -1.0, 2.0)),
                velocity: k(world(0.1, 0.7, -0.4)),
                ..State::default()
            });
            flight
        };
        let (mut flight, mut turned) = (scene(|v| v), scene(|v| world(v.z, v.x, v.y)));
        for tick in 0..10_000 {
            step(&mut flight);
            step(&mut turned);
            let (want, got) = (turn(flight.state.position), turned.state.position);
            assert!(same(want.x, got.x) && same(want.y, got.y) && same(want.z, got.z), "{tick}");
        }
    }
}

#[test]
fn a_scenario_turned_by_any_yaw_gives_the_turned_flight() {
    let all: &[f64] = if cfg!(debug_assertions) { &[1.0] } else { &[0.3, 1.0, 2.5] };
    for &yaw in all {
        for rates in [Rates::Zero, Rates::Trajectory, Rates::Commanded] {
            for actuation in ["lagged-wrench", "rotors"] {
                for rate in [named("indi"), unfiltered(), named("pid")] {
                    if (actuation == "rotors") == (rates == Rates::Commanded) {
                        let off = turned_apart(yaw, rates, actuation, rate);
                        assert!(off < 1e-9, "{yaw} rad, {rates:?}, {actuation}: {off:e} m");
                    }
                }
            }
        }
    }
}

/// Largest distance between a flight, turned by `yaw` afterwards, and that of the turned scenario.
///
/// The helix turned by `yaw` is the helix `yaw/w` earlier; so the first flight begins late, and the
/// disturbance of the second runs ahead by as much.
fn turned_apart(
    yaw: f64,
    rates: Rates,
    actuation: &str,
    rate: stormpetrel_control::rate::RateLawSettings,
) -> f64 {
    let turn = |v: Vec3<f64, World>| {
        let (sin, cos) = yaw.sin_cos();
        world(cos * v.x - sin * v.y, sin * v.x + cos * v.y, v.z)
    };
    let path = helix::Gains { yaw: 0.4, yaw_rate: 0.3, ..helix::Gains::default() };
    let mut scene = Scene {
        actuation: named(actuation),
        attitude_reference: rotation_reference(rates),
        rate,
        ..Scene::default()
    };
    scene.vehicle.inertia = body(2.5e-3, 2.5e-3, 2.6e-3); // equal about x and y
    scene.reference = ReferenceSettings::Helix(path, ());
    scene.disturbance.force = world(0.5, 0.3, -0.2);
    let late = yaw / path.frequency;
    let ticks = (late / scene.control_step).round();

    let mut other = scene;
    other.reference = ReferenceSettings::Helix(
        helix::Gains {
            center: world(0.0, 0.0, path.climb * late),
            yaw: path.yaw + path.yaw_rate * late + yaw,
            ..path
        },
        (),
    );
    let (sin, cos) = (scene.disturbance.frequency * late).sin_cos();
    let (s, c) = (scene.disturbance.sine, scene.disturbance.cosine);
    other.disturbance.force = turn(scene.disturbance.force);
    (other.disturbance.sine, other.disturbance.cosine) = (s * cos - c * sin, s * sin + c * cos);

    let (mut flight, mut turned) = (scene.flight(), other.flight());
    let begin = flight.reference.at(late);
    let state = State {
        position: begin.position + world(0.1, -0.2, 0.0),
        velocity: begin.velocity,
        attitude: Rotation::from_euler(Euler { roll: 0.1, pitch: -0.2, yaw: 0.9 }),
        rate: body(0.2, 0.1, -0.3),
        rotor_speed: [1458.0; 4],
    };
    flight.start(state);
    flight.tick = ticks as u64;
    turned.start(State {
        position: turn(state.position),
        velocity: turn(state.velocity),
        attitude: Rotation::from_euler(Euler { roll: 0.1, pitch: -0.2, yaw: 0.9 + yaw }),
        ..state
    });
    (0..10_000).fold(0.0, |most: f64, _| {
        step(&mut flight);
        step(&mut turned);
        most.max((turn(flight.state.position) - turned.state.position).norm())
    })
}
