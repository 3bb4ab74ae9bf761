//! Lines and closed curves against their closed forms.
// Tests compare bits, take the standard library as their second opinion, and print figures as their
// source prints them.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::approx_constant, clippy::float_cmp)]

mod common;

use common::{Scene, world};
use std::f64::consts::{FRAC_PI_2, TAU};
use stormpetrel_plant::reference::circle::{Gains as CircleGains, Heading, Options};
use stormpetrel_plant::reference::line::{Gains as LineGains, Line};
use stormpetrel_plant::reference::{Refer, Reference, ReferenceSettings};
use stormpetrel_plant::reference::{lemniscate, lissajous};

fn circle(gains: CircleGains<f64>, heading: Heading) -> Reference<f64> {
    ReferenceSettings::Circle(gains, Options { heading }).build(&Scene::default().vehicle)
}

#[test]
fn a_circle_at_speed_falls_towards_its_centre_with_v_squared_over_r() {
    let center = world(3.0, -1.0, 2.0);
    for (radius, speed) in [(2.0, 3.0), (0.5, -1.5), (40.0, 12.0)] {
        let gains = CircleGains { radius, speed, center, start: 0.4, ..CircleGains::default() };
        let circle = circle(gains, Heading::Constant);
        for t in [2.0, 5.3, 60.0] {
            let at = circle.at(t);
            let inwards = (center - at.position) * (1.0 / radius);
            assert!((inwards.norm() - 1.0).abs() < 1e-14);
            assert!((at.velocity.norm() - speed.abs()).abs() < 1e-13);
            let want = inwards * (speed * speed / radius);
            assert!((at.acceleration - want).norm() < 1e-12, "{radius} m, {speed} m/s, {t} s");
            let turn = (at.position - center).cross(at.velocity).z;
            assert_eq!(turn > 0.0, speed > 0.0, "positive speeds turn counter-clockwise");
        }
    }
}

#[test]
fn a_frequency_takes_the_place_of_the_speed() {
    let gains = CircleGains { radius: 3.0, frequency: 0.7, ..CircleGains::default() };
    assert!((circle(gains, Heading::Constant).at(9.0).velocity.norm() - 2.1).abs() < 1e-14);
}

#[test]
fn a_heading_along_the_velocity_follows_it_without_a_jump() {
    for speed in [2.0, -2.0] {
        let gains = CircleGains { speed, start: 1.0, ..CircleGains::default() };
        let circle = circle(gains, Heading::Along);
        let mut last = circle.at(0.0).yaw;
        for i in 1..4000 {
            let at = circle.at(f64::from(i) * 0.01);
            let across = at.velocity.x * at.yaw.sin() - at.velocity.y * at.yaw.cos();
            let ahead = at.velocity.x * at.yaw.cos() + at.velocity.y * at.yaw.sin();
            assert!(across.abs() < 1e-13 && ahead > 0.0, "{i}");
            assert!((at.yaw - last).abs() < 0.011, "{i}");
            last = at.yaw;
        }
        assert!((circle.at(40.0).yaw - circle.at(0.0).yaw).abs() > 5.0 * TAU, "it turns on");
    }
}

#[test]
fn a_ramp_begins_at_rest_and_costs_half_of_its_time() {
    let gains = CircleGains { ramp: 3.0, ..CircleGains::default() };
    let (ramped, plain) = (circle(gains, Heading::Constant), CircleGains { ramp: 0.0, ..gains });
    let plain = circle(plain, Heading::Constant);
    let first = ramped.at(0.0);
    let rest = [first.velocity, first.acceleration, first.jerk, first.snap];
    assert!(rest.iter().all(|derivative| derivative.norm() == 0.0));
    for t in [3.0, 4.5, 20.0] {
        let (a, b) = (ramped.at(t), plain.at(t - 1.5));
        assert!((a.position - b.position).norm() < 1e-13 && (a.snap - b.snap).norm() < 1e-12);
    }
    // At the end of the ramp no derivative jumps.
    let (before, after) = (ramped.at(3.0 - 1e-7), ramped.at(3.0 + 1e-7));
    assert!((before.snap - after.snap).norm() < 1e-4);
}

#[test]
fn the_lemniscate_is_that_of_gerono_and_symmetric() {
    let center = world(1.0, 2.0, 3.0);
    let gains = lemniscate::Gains { size: 2.5, period: 8.0, center, ..Default::default() };
    let curve = ReferenceSettings::Lemniscate(gains, ()).build(&Scene::default().vehicle);
    let at = |t: f64| curve.at(1.0 + t).position - center; // half of the ramp is lost
    let mut fastest: f64 = 0.0;
    for i in 0..400 {
        let t = 1.0 + 0.02 * f64::from(i);
        let p = at(t);
        let (x2, y2) = (p.x * p.x, p.y * p.y);
        assert!((x2 * x2 - 2.5 * 2.5 * (x2 - y2)).abs() < 1e-12, "the curve's own equation");
        assert!((at(t + 4.0) - world(-p.x, p.y, 0.0)).norm() < 1e-13, "mirrored after half");
        assert!((at(8.0 - t + 8.0) - world(-p.x, -p.y, 0.0)).norm() < 1e-13, "and backwards");
        fastest = fastest.max(curve.at(1.0 + t).velocity.norm());
    }
    assert!((fastest - 2.0f64.sqrt() * TAU * 2.5 / 8.0).abs() < 1e-3);
}

#[test]
fn a_lissajous_curve_swings_as_its_numbers_say() {
    let gains = lissajous::Gains {
        amplitude: world(1.0, 2.0, 0.5),
        frequency: world(1.0, 2.0, 3.0),
        phase: world(0.3, 0.0, -1.0),
        center: world(0.0, 1.0, 2.0),
        yaw: 0.2,
        yaw_amplitude: 0.6,
        yaw_frequency: 1.5,
        yaw_phase: FRAC_PI_2,
        ramp: 0.0,
    };
    let curve = ReferenceSettings::Lissajous(gains, ()).build(&Scene::default().vehicle);
    for t in [0.0f64, 0.9, 7.7] {
        let want =
            world((t + 0.3).sin(), 1.0 + 2.0 * (2.0 * t).sin(), 2.0 + 0.5 * (3.0 * t - 1.0).sin());
        assert!((curve.at(t).position - want).norm() < 1e-14);
        assert!((curve.at(t).yaw - 0.2 - 0.6 * (1.5 * t).cos()).abs() < 1e-14);
    }
}

fn line(length: f64, [speed, acceleration, jerk]: [f64; 3]) -> Line<f64> {
    let from = world(1.0, 2.0, 3.0);
    let to = from + world(2.0, -1.0, 2.0) * (length / 3.0);
    let gains = LineGains { from, to, speed, acceleration, jerk, yaw: 0.4 };
    Line::new(gains, (), &Scene::default().vehicle)
}

/// Duration by the case distinction of the textbook: Biagiotti and Melchiorri, Trajectory Planning for
/// Automatic Machines and Robots (2008), section 3.4, for rest to rest. Also the peaks of speed and
/// acceleration.
fn textbook(length: f64, [v, a, j]: [f64; 3]) -> (f64, f64, f64) {
    let (t_j, t_a) =
        if v * j < a * a { ((v / j).sqrt(), 2.0 * (v / j).sqrt()) } else { (a / j, a / j + v / a) };
    if length / v >= t_a {
        return (length / v + t_a, v, j * t_j);
    }
    if length >= 2.0 * a * a * a / (j * j) {
        let t_a = 0.5 * a / j + ((0.5 * a / j).powi(2) + length / a).sqrt();
        return (2.0 * t_a, a * (t_a - a / j), a);
    }
    let t_j = (length / (2.0 * j)).powf(1.0 / 3.0);
    (4.0 * t_j, j * t_j * t_j, j * t_j)
}

#[test]
fn a_line_takes_the_time_of_the_textbook_in_every_regime() {
    for (what, length, limits) in [
        ("speed and acceleration reached", 20.0, [2.0, 3.0, 10.0]),
        ("speed reached, acceleration not", 20.0, [2.0, 9.0, 10.0]),
        ("acceleration reached, speed not", 5.0, [9.0, 2.0, 10.0]),
        ("neither reached", 0.1, [2.0, 3.0, 10.0]),
        ("on the edge of both", 2.0 * 27.0 / 100.0, [9.0, 3.0, 10.0]),
    ] {
        let line = line(length, limits);
        let (duration, speed, acceleration) = textbook(length, limits);
        assert!((line.duration() - duration).abs() < 1e-12 * duration, "{what}");
        let (mut fastest, mut hardest) = (0.0f64, 0.0f64);
        for i in 0..=20_000 {
            let at = line.at(duration * f64::from(i) / 20_000.0);
            fastest = fastest.max(at.velocity.norm());
            hardest = hardest.max(at.acceleration.norm());
            assert!(at.jerk.norm() <= limits[2] * (1.0 + 1e-12));
        }
        assert!(fastest <= limits[0] * (1.0 + 1e-12) && hardest <= limits[1] * (1.0 + 1e-12));
        assert!((fastest - speed).abs() < 1e-3 * speed, "{what}: {fastest}");
        assert!((hardest - acceleration).abs() < 1e-3 * acceleration, "{what}: {hardest}");
    }
}

#[test]
fn a_line_rests_at_both_ends() {
    let line = line(7.0, [2.0, 3.0, 10.0]);
    let end = line.gains.to;
    for t in [line.duration(), line.duration() + 1e-9, line.duration() + 100.0] {
        let at = line.at(t);
        assert_eq!((at.position - end).norm(), 0.0);
        let moving = [at.velocity, at.acceleration, at.jerk, at.snap];
        assert!(moving.iter().all(|derivative| derivative.norm() == 0.0), "{t} s");
    }
    assert_eq!((line.at(0.0).position - line.gains.from).norm(), 0.0);
    assert_eq!(line.at(0.0).velocity.norm(), 0.0);
    let before = line.at(line.duration() - 1e-6);
    assert!(before.velocity.norm() < 1e-9 && (before.position - end).norm() < 1e-12);
}

#[test]
fn a_line_without_length_is_a_point() {
    let at = line(0.0, [2.0, 3.0, 10.0]).at(0.5);
    assert_eq!((at.position - world(1.0, 2.0, 3.0)).norm(), 0.0);
    assert_eq!(at.velocity.norm() + at.acceleration.norm() + at.jerk.norm(), 0.0);
}
