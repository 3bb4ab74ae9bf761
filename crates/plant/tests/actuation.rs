//! Lags, limits and reports of the actuation, against closed forms and the article's equations.
// Tests compare bits, take the standard library as their second opinion, and print figures as their
// source prints them.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::approx_constant, clippy::float_cmp)]

mod common;

use common::{Scene, body, named};
use stormpetrel_control::math::Vec3;
use stormpetrel_control::registry::Settings;
use stormpetrel_control::signals::Wrench;
use stormpetrel_plant::actuation::Sent;
use stormpetrel_plant::actuation::{Actuate, Actuation, ActuationSettings, lagged_wrench};
use stormpetrel_plant::dynamics::{Held, Push, Reciprocals, runge_kutta};
use stormpetrel_plant::state::State;
use stormpetrel_plant::vehicle::{Vehicle, VehicleSettings};

fn vehicle() -> Vehicle<f64> {
    Scene::default().vehicle
}

fn asking(thrust: f64, torque: [f64; 3]) -> Sent<f64> {
    let [x, y, z] = torque;
    Sent { wrench: Wrench { thrust, torque: body(x, y, z) }, ..Sent::default() }
}

fn rotors() -> Actuation<f64> {
    named::<ActuationSettings>("rotors").build(&vehicle())
}

#[test]
fn the_lagged_torque_follows_its_exponential_exactly() {
    for (lag, h) in [(0.02, 5e-4), (0.05, 1e-3), (0.02, 0.1)] {
        let mut actuation =
            ActuationSettings::LaggedWrench(lagged_wrench::Gains { lag }, ()).build(&vehicle());
        let state = State::default();
        actuation.command(&asking(5.0, [0.3, -0.2, 0.1]), &vehicle());
        assert_eq!(actuation.thrust(&state), 5.0, "thrust acts at once");
        assert_eq!(actuation.torque(&state).norm(), 0.0, "torque does not");
        for k in 1..=400 {
            actuation.pass(h);
            let share = 1.0 - (-h * f64::from(k) / lag).exp();
            let off = actuation.torque(&state) - body(0.3, -0.2, 0.1) * share;
            assert!(off.norm() < 1e-14, "{lag} s, step {k}: {:e}", off.norm());
        }
    }
}

#[test]
fn a_rotor_follows_its_exponential() {
    let (vehicle, mut actuation) = (vehicle(), rotors());
    actuation.command(&asking(8.0, [0.0; 3]), &vehicle);
    let held = Held::new(&Reciprocals::new(&vehicle), &Push::default());
    let target = (8.0 / 4.0 / vehicle.thrust_coefficient).sqrt();
    let (start, mut time) = (1000.0, 0.0);
    let mut state = State { rotor_speed: [start; 4], ..State::default() };
    for k in 1..=400 {
        // Steps of changing length: what is prepared for one must not serve the next.
        let h = if k % 3 == 0 { 5e-4 } else { 2e-3 };
        actuation.pass(h);
        state = runge_kutta(&state, h, &vehicle, &actuation, &held);
        time += h;
        let exact = target + (start - target) * (-time / vehicle.motor_lag).exp();
        for speed in state.rotor_speed {
            assert!((speed / exact - 1.0).abs() < 1e-13, "step {k}");
        }
    }
}

#[test]
fn the_wrench_of_the_rotors_is_that_of_the_article_s_equations() {
    for (name, c) in [("article", 1.98e-6), ("article-corrected", 1.98e-8)] {
        let vehicle = VehicleSettings::named(name).expect("a preset").vehicle;
        let actuation = named::<ActuationSettings>("rotors").build(&vehicle);
        let w = [1100.0, 1700.0, 1450.0, 900.0];
        let state = State { rotor_speed: w, ..State::default() };
        let [s1, s2, s3, s4] = w.map(|w| w * w);
        let (k, l) = (7.2e-7, 0.1275);
        let thrust = k * (s1 + s2 + s3 + s4);
        let torque = body(l * k * (-s2 + s4), l * k * (-s1 + s3), c * (-s1 + s2 - s3 + s4));
        assert!((actuation.thrust(&state) / thrust - 1.0).abs() < 1e-15, "{name}");
        assert!((actuation.torque(&state) - torque).norm() < 1e-14, "{name}");
    }
}

#[test]
fn hover_speed_carries_the_weight() {
    // Theory 1.2: 1458.3 rad/s.
    assert!((vehicle().hover_speed() - 1458.3).abs() < 0.05);
    let state = State { rotor_speed: [vehicle().hover_speed(); 4], ..State::default() };
    assert!((rotors().thrust(&state) - 0.625 * 9.8).abs() < 1e-14);
}

#[test]
fn nothing_is_refused_and_no_rotor_counts_as_limited_inside_the_limits() {
    let mut rotors = rotors();
    for (thrust, torque) in [
        (6.125, [0.0; 3]),
        (6.125, [0.1, -0.1, 0.01]),
        (12.0, [-0.05, 0.2, -0.02]),
        (2.0, [0.03, 0.0, 0.005]),
    ] {
        let refused = rotors.command(&asking(thrust, torque), &vehicle());
        // Zero up to the rounding of B B^-1.
        assert!(refused.thrust.abs() < 1e-14 && refused.torque.norm() < 1e-15, "{refused:?}");
        assert_eq!(rotors.saturation(), 0.0);
    }
}

#[test]
fn the_refused_part_is_the_command_less_what_the_limits_allow() {
    let (vehicle, mut rotors) = (vehicle(), rotors());
    let highest = 7.2e-7 * 2917.0 * 2917.0;
    let refused = rotors.command(&asking(30.0, [0.0; 3]), &vehicle);
    assert!((refused.thrust - (30.0 - 4.0 * highest)).abs() < 1e-13, "{refused:?}");
    assert_eq!(rotors.saturation(), 1.0, "all four at their limit");
    let lowest = 7.2e-7 * 150.0 * 150.0;
    let refused = rotors.command(&asking(-1.0, [0.0; 3]), &vehicle);
    assert!((refused.thrust - (-1.0 - 4.0 * lowest)).abs() < 1e-14, "{refused:?}");
    assert_eq!(rotors.saturation(), 1.0);
    // A roll beyond the room of one pair: its two rotors are at their limits, and the other two
    // share the thrust between them.
    let refused = rotors.command(&asking(0.5 * 4.0 * highest, [2.0, 0.0, 0.0]), &vehicle);
    let most = 0.1275 * (highest - lowest);
    assert!((refused.torque.x - (2.0 - most)).abs() < 1e-14, "{refused:?}");
    assert_eq!(rotors.saturation(), 0.5);
}

#[test]
fn the_ideal_kinds_refuse_nothing() {
    for kind in ["thrust-vector", "wrench", "lagged-wrench"] {
        let mut actuation = named::<ActuationSettings>(kind).build(&vehicle());
        let refused = actuation.command(&asking(-1e3, [50.0, 0.0, 1.0]), &vehicle());
        assert_eq!((refused.thrust, refused.torque.norm()), (0.0, 0.0), "{kind}");
        assert_eq!(actuation.saturation(), 0.0, "{kind}");
    }
}

#[test]
fn thrust_acts_along_the_body_s_own_axis() {
    let (vehicle, mut actuation) =
        (vehicle(), named::<ActuationSettings>("wrench").build(&vehicle()));
    actuation.command(&asking(5.0, [0.0; 3]), &vehicle);
    // Rolled by 90 deg: the up axis points to the right, -y.
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let attitude = stormpetrel_control::math::Rotation::from_quaternion(half, half, 0.0, 0.0);
    let state = State { attitude, ..State::default() };
    let a = actuation.thrust_per_mass(&state, &vehicle);
    assert!((a - Vec3::new(0.0, -5.0 / 0.625, 0.0)).norm() < 1e-14, "{a:?}");
}
