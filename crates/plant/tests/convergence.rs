//! The integrator has order four: for the body alone, with forces, and with rotors that lag.
//!
//! The order is the least-squares slope of the error against the step on a ladder of five.
// Tests compare bits, take the standard library as their second opinion, and print figures as their
// source prints them.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::approx_constant, clippy::float_cmp)]

mod common;

use common::{Free, Scene, body, named, slope, world};
use stormpetrel_control::math::Rotation;
use stormpetrel_control::signals::Wrench;
use stormpetrel_plant::actuation::Sent;
use stormpetrel_plant::actuation::{Actuate, Actuation, ActuationSettings};
use stormpetrel_plant::dynamics::{Held, Push, Reciprocals, runge_kutta};
use stormpetrel_plant::state::State;
use stormpetrel_plant::vehicle::Vehicle;

#[test]
fn val_nesc_case_2_has_the_tabulated_error_at_every_step() {
    // Reliability 1.2: error in rad/s at 30 s, of the worst of the three components.
    let table = [
        (0.2, 6.195e-7),
        (0.1, 4.013e-8),
        (0.05, 2.551e-9),
        (0.025, 1.607e-10),
        (0.0125, 1.008e-11),
    ];
    let exact = [12.6183907759142, -17.3974747616114, 31.1195888869443f64].map(f64::to_radians);
    let brick = Free::new(body(0.001_894_220, 0.006_211_019, 0.007_194_665));
    let [p, q, r] = [10.0, 20.0, 30.0f64].map(f64::to_radians);
    let start = State { rate: body(p, q, r), ..State::default() };
    let mut points = Vec::new();
    for (h, want) in table {
        let end = brick.fly(start, h, (30.0 / h).round() as u32, |_| ());
        let off = end.rate - body(exact[0], exact[1], exact[2]);
        let error = [off.x, off.y, off.z].into_iter().fold(0.0, |most: f64, e| most.max(e.abs()));
        assert!((error / want - 1.0).abs() < 0.05, "{h} s: {error:e}, not {want:e}");
        points.push((h.ln(), error.ln()));
    }
    assert!((slope(&points) - 4.0).abs() < 0.05, "order {}", slope(&points));
}

/// All numbers of the state but the rotor speeds, which are in larger units.
fn distance(a: &State<f64>, b: &State<f64>) -> f64 {
    let turn = (a.attitude.inverse() * b.attitude).angle();
    let rotors: f64 =
        a.rotor_speed.iter().zip(b.rotor_speed).map(|(x, y)| ((x - y) / 1e3).powi(2)).sum();
    ((a.position - b.position).norm_squared()
        + (a.velocity - b.velocity).norm_squared()
        + (a.rate - b.rate).norm_squared()
        + turn * turn
        + rotors)
        .sqrt()
}

struct Setup {
    vehicle: Vehicle<f64>,
    actuation: Actuation<f64>,
    push: Push<f64>,
    start: State<f64>,
}

impl Setup {
    /// A constant command, given once, and constant pushes.
    fn new(kind: &str, wrench: Wrench<f64>) -> Self {
        let vehicle = Scene::default().vehicle;
        let mut actuation = named::<ActuationSettings>(kind).build(&vehicle);
        actuation.command(&Sent { wrench, ..Sent::default() }, &vehicle);
        let push = Push { force: world(0.3, -0.2, 0.1), torque: body(2e-3, -1e-3, 3e-3) };
        let start = State {
            velocity: world(1.0, 0.5, -0.5),
            attitude: Rotation::from_quaternion(0.9, 0.3, -0.2, 0.1).normalised(),
            rate: body(2.0, -3.0, 1.0),
            rotor_speed: [1200.0, 1500.0, 1400.0, 1300.0],
            ..State::default()
        };
        Self { vehicle, actuation, push, start }
    }

    fn fly(&self, seconds: f64, steps: u32) -> State<f64> {
        let held = Held::new(&Reciprocals::new(&self.vehicle), &self.push);
        let h = seconds / f64::from(steps);
        let mut actuation = self.actuation;
        actuation.pass(h);
        (0..steps)
            .fold(self.start, |state, _| runge_kutta(&state, h, &self.vehicle, &actuation, &held))
    }

    fn order(&self, seconds: f64, coarsest: u32) -> f64 {
        let truth = self.fly(seconds, coarsest * 16 * 16);
        let points: Vec<(f64, f64)> = (0..5)
            .map(|k| coarsest << k)
            .map(|n| ((seconds / f64::from(n)).ln(), distance(&self.fly(seconds, n), &truth).ln()))
            .collect();
        slope(&points)
    }
}

#[test]
fn a_body_under_constant_thrust_and_torque_converges_with_order_four() {
    let wrench = Wrench { thrust: 7.0, torque: body(4e-3, 2e-3, -1e-3) };
    let order = Setup::new("wrench", wrench).order(2.0, 50);
    assert!((order - 4.0).abs() < 0.05, "order {order}");
}

#[test]
fn rotors_with_lag_converge_with_order_four() {
    let wrench = Wrench { thrust: 7.0, torque: body(0.02, -0.01, 0.005) };
    let order = Setup::new("rotors", wrench).order(0.2, 100);
    assert!((order - 4.0).abs() < 0.05, "order {order}");
}

#[test]
fn a_free_fall_is_exact() {
    // Order four integrates a parabola without error.
    let mut fall = Free::new(body(1.0, 1.0, 1.0));
    fall.vehicle.gravity = 9.8;
    fall.push.force = world(0.5, 0.0, 0.0);
    let start = State { velocity: world(1.0, -2.0, 3.0), ..State::default() };
    let end = fall.fly(start, 0.125, 16, |_| ());
    let want = world(1.0 * 2.0 + 0.25 * 4.0, -4.0, 3.0 * 2.0 - 4.9 * 4.0);
    assert!((end.position - want).norm() < 1e-13, "{:?}", end.position);
    assert!((end.velocity - world(2.0, -2.0, 3.0 - 19.6)).norm() < 1e-13);
}
