//! References that follow a table, against what defines them: waypoints, gates and rows are met, joints are
//! smooth, the snap is least, limits are kept.
// Tests compare bits, take the standard library as their second opinion, and print figures as their
// source prints them.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::approx_constant, clippy::float_cmp)]

use std::f64::consts::{PI, TAU};

use stormpetrel_control::lanes::Lanes;
use stormpetrel_control::math::{Vec3, World};
use stormpetrel_control::record::RecordExt;
use stormpetrel_control::signals::Trajectory;
use stormpetrel_lab::curve::fit_error;
use stormpetrel_lab::scenario::{Scenario, load_text};
use stormpetrel_plant::reference::piecewise::Curve;
use stormpetrel_plant::reference::{Refer, Reference, ReferenceSettings};

const REST: &str = "
vehicle = { model = \"article-corrected\" }
position = { law = \"pid\", kp = 6.0, ki = 2.0, kd = 4.0 }
actuation = { kind = \"thrust-vector\" }";

fn scenario(reference: &str) -> Scenario {
    let text = format!("reference = {{ {reference} }}{REST}");
    let file = load_text("test", "test.toml", text, &[]).unwrap_or_else(|f| panic!("{f}"));
    file.scenarios.into_iter().next().expect("a flight")
}

fn reference(text: &str) -> Reference<f64> {
    let scenario = scenario(text);
    scenario.reference.build(&scenario.vehicle.vehicle)
}

fn curve(text: &str) -> Curve {
    match scenario(text).reference {
        ReferenceSettings::MinimumSnap(_, options) => options.curve,
        ReferenceSettings::Race(_, options) => options.curve,
        ReferenceSettings::Table(_, options) => options.curve,
        _ => panic!("no curve"),
    }
}

fn rows(rows: &[Vec<f64>]) -> String {
    let rows: Vec<String> = rows.iter().map(|row| format!("{row:?}")).collect();
    format!("[{}]", rows.join(", "))
}

/// A generator of numbers between -1 and 1 (Numerical Recipes, section 7.1).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

const WAYPOINTS: [[f64; 4]; 5] = [
    [0.0, 0.0, 1.0, 0.0],
    [1.5, 0.5, 1.5, 0.5],
    [2.0, 2.0, 1.0, 1.5],
    [0.5, 2.5, 2.0, 3.0],
    [-0.5, 1.0, 1.0, -3.0],
];

fn waypoints() -> String {
    format!("shape = \"minimum-snap\", waypoints = {}", rows(&WAYPOINTS.map(|row| row.to_vec())))
}

const GATES: [[f64; 4]; 4] =
    [[0.0, 0.0, 1.0, 0.0], [4.0, 2.0, 2.0, 1.6], [1.0, 4.0, 1.5, 3.1], [-3.0, 2.0, 1.0, -1.6]];

fn gates() -> String {
    format!("shape = \"race\", laps = 2, gates = {}", rows(&GATES.map(|row| row.to_vec())))
}

fn recording(noise: f64) -> String {
    let mut random = Random(7);
    let row = |i: usize| {
        let t = 0.05 * i as f64;
        let mut at = |x: f64| x + noise * random.next();
        let yaw = (0.8 * t + PI).rem_euclid(TAU) - PI;
        vec![5.0 + t, at(2.0 * t.sin()), at(t.cos()), at(1.0 + 0.1 * t), yaw]
    };
    let all: Vec<Vec<f64>> = (0..240).map(row).collect();
    format!("shape = \"table\", rows = {}", rows(&all))
}

/// The curve's value and derivatives by the phase.
fn by_phase(curve: &Curve, phase: f64) -> Trajectory<f64> {
    curve.at([phase, 1.0, 0.0, 0.0, 0.0])
}

#[test]
fn every_derivative_is_the_derivative_of_the_one_before() {
    type Part = fn(&Trajectory<f64>) -> Vec3<f64, World>;
    let chain: [(&str, Part, Part); 6] = [
        ("velocity", |r| r.position, |r| r.velocity),
        ("acceleration", |r| r.velocity, |r| r.acceleration),
        ("jerk", |r| r.acceleration, |r| r.jerk),
        ("snap", |r| r.jerk, |r| r.snap),
        ("yaw rate", |r| Vec3::up(r.yaw), |r| Vec3::up(r.yaw_rate)),
        ("yaw acceleration", |r| Vec3::up(r.yaw_rate), |r| Vec3::up(r.yaw_acceleration)),
    ];
    for text in [waypoints(), gates(), recording(0.01)] {
        let reference = reference(&text);
        // To the end of the race and beyond.
        for i in 1..120 {
            let t = 0.2231 * f64::from(i);
            for (label, before, after) in chain {
                const H: f64 = 1e-4;
                let part = |h: f64| before(&reference.at(t + h));
                let want = (part(H) - part(-H)) * (0.5 / H);
                let got = after(&reference.at(t));
                let room = 1e-4 * (1.0 + reference.at(t).snap.norm());
                assert!((got - want).norm() < room, "{label} at {t} s: {got:?} {want:?}");
            }
        }
    }
}

#[test]
fn eight_flights_along_one_curve_have_the_bits_of_single_ones() {
    for text in [waypoints(), gates(), recording(0.0)] {
        let base = scenario(&text);
        let singles: [Reference<f64>; 8] = std::array::from_fn(|i| {
            let share = 1.0 - 0.08 * i as f64;
            let mut settings = base.reference;
            match &mut settings {
                ReferenceSettings::MinimumSnap(gains, _) => gains.acceleration *= share,
                ReferenceSettings::Race(gains, _) => gains.speed *= share,
                ReferenceSettings::Table(gains, _) => gains.pace *= share,
                _ => {}
            }
            settings.build(&base.vehicle.vehicle)
        });
        let lanes: Reference<Lanes<f64, 8>> =
            RecordExt::<f64>::gather(std::array::from_fn(|i| &singles[i]));
        let bits = |at: &Trajectory<f64>| {
            [at.position.x, at.velocity.y, at.acceleration.z, at.jerk.x, at.snap.y, at.yaw_rate]
                .map(f64::to_bits)
        };
        for tick in 0..500 {
            let times: [f64; 8] = std::array::from_fn(|i| tick as f64 * (0.05 + 0.003 * i as f64));
            let at = lanes.at(Lanes(times));
            for (i, single) in singles.iter().enumerate() {
                assert_eq!(bits(&at.pick(i)), bits(&single.at(times[i])), "lane {i}");
            }
        }
        assert_ne!(bits(&singles[0].at(2.0)), bits(&singles[7].at(2.0)), "the paces differ");
    }
}

#[test]
fn one_piece_from_rest_to_rest_is_the_polynomial_of_the_literature() {
    let curve = curve("shape = \"minimum-snap\", waypoints = [[1, 0, 0, 0], [3, 0, 0, 0]]");
    for i in 0..=100 {
        let t = 0.01 * f64::from(i);
        let share = 35.0 * t.powi(4) - 84.0 * t.powi(5) + 70.0 * t.powi(6) - 20.0 * t.powi(7);
        assert!((by_phase(&curve, 2.0 * t).position.x - 1.0 - 2.0 * share).abs() < 1e-13, "{t}");
    }
}

#[test]
fn waypoints_are_met_and_no_derivative_jumps() {
    let curve = curve(&waypoints());
    for (i, piece) in curve.pieces.iter().enumerate() {
        let at = by_phase(&curve, piece.begin);
        let [x, y, z, yaw] = WAYPOINTS[i];
        assert!((at.position - Vec3::new(x, y, z)).norm() < 1e-14, "waypoint {i}");
        assert!(((at.yaw - yaw) / TAU - ((at.yaw - yaw) / TAU).round()).abs() < 1e-14);
    }
    let last = by_phase(&curve, curve.end());
    assert!((last.position - Vec3::new(-0.5, 1.0, 1.0)).norm() < 1e-13);
    assert!((last.yaw - (TAU - 3.0)).abs() < 1e-13, "the short way from 3 rad to -3 rad");
    joints(&curve, 6);
}

/// The derivatives up to this order are equal on both sides of every joint.
fn joints(curve: &Curve, order: usize) {
    let derivative = |terms: &[f64; 8], s: f64, k: usize| {
        let falling = |n: usize| (0..k).map(|j| (n - j) as f64).product::<f64>();
        (k..8).map(|n| terms[n] * falling(n) * s.powi((n - k) as i32)).sum::<f64>()
    };
    for pair in curve.pieces.windows(2) {
        let [a, b] = pair else { panic!() };
        for k in 0..=order {
            let (before, after) = (1.0 / a.length.powi(k as i32), 1.0 / b.length.powi(k as i32));
            for axis in 0..4 {
                let before = derivative(&a.terms[axis], 1.0, k) * before;
                let after = derivative(&b.terms[axis], 0.0, k) * after;
                let size = 1.0 + before.abs();
                assert!((before - after).abs() < 1e-9 * size, "{axis} {k}: {before} {after}");
            }
        }
    }
}

/// Product of polynomials, lowest power first.
fn times(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut product = vec![0.0; a.len() + b.len() - 1];
    for (i, x) in a.iter().enumerate() {
        for (j, y) in b.iter().enumerate() {
            product[i + j] += x * y;
        }
    }
    product
}

#[test]
fn no_other_path_through_the_waypoints_has_less_snap() {
    let curve = curve(&waypoints());
    let end = curve.end();
    // Simpson's rule, piece by piece: the snap has kinks at the waypoints.
    let cost = |change: &dyn Fn(f64) -> f64| {
        let square = |s: f64| (by_phase(&curve, s).snap.x + change(s)).powi(2);
        let piece = |begin: f64, length: f64| {
            let h = length / 400.0;
            let part = |i: i32| {
                let s = begin + h * f64::from(2 * i) + 1e-12;
                square(s) + 4.0 * square(s + h) + square(s + 2.0 * h - 2e-12)
            };
            (0..200).map(part).sum::<f64>() * h / 3.0
        };
        curve.pieces.iter().map(|p| piece(p.begin, p.length)).sum::<f64>()
    };
    let least = cost(&|_| 0.0);
    let mut random = Random(1);
    for _ in 0..100 {
        // Zero at each waypoint, with three derivatives at the ends: s^4 (1 - s)^4 prod (s - s_i) r(s).
        let mut bump = vec![random.next(), random.next(), random.next()];
        for _ in 0..4 {
            bump = times(&times(&bump, &[0.0, 1.0]), &[1.0, -1.0]);
        }
        for piece in &curve.pieces[1..] {
            bump = times(&bump, &[-piece.begin / end, 1.0]);
        }
        for sign in [1e-4, -1e-4] {
            let snap = |s: f64| {
                let fourth = |n: usize| (n * (n - 1) * (n - 2) * (n - 3)) as f64;
                let terms = bump.iter().enumerate().skip(4);
                terms.map(|(n, c)| c * fourth(n) * (s / end).powi(n as i32 - 4)).sum::<f64>()
            };
            let other = cost(&|s| sign * snap(s));
            assert!(other >= least * (1.0 - 1e-12), "{other} < {least}");
        }
    }
}

/// Largest speed, acceleration and rate of the heading on a fine grid.
fn extremes(reference: &Reference<f64>, duration: f64) -> [f64; 3] {
    let mut most = [0.0f64; 3];
    for i in 0..=30_000 {
        let at = reference.at(duration * f64::from(i) / 30_000.0);
        let sizes = [at.velocity.norm(), at.acceleration.norm(), at.yaw_rate.abs()];
        most = std::array::from_fn(|k| most[k].max(sizes[k]));
    }
    most
}

#[test]
fn limits_are_kept_everywhere_and_one_is_reached() {
    for (k, limits) in [[0.7, 50.0, 50.0], [9.0, 1.3, 50.0], [9.0, 50.0, 0.4]].iter().enumerate() {
        for (base, slack) in [(waypoints(), 0.01), (gates() + ", ramp = 20", 0.15)] {
            let [v, a, y] = limits;
            let text = format!("{base}, speed = {v}, acceleration = {a}, yaw_rate = {y}");
            let most = extremes(&reference(&text), 300.0);
            assert!((0..3).all(|k| most[k] <= limits[k]), "{base}: {most:?} above {limits:?}");
            assert!(most[k] > limits[k] * (1.0 - slack), "{base}: {most:?} far below {limits:?}");
        }
    }
}

#[test]
fn after_the_last_waypoint_the_vehicle_rests_there() {
    let reference = reference(&waypoints());
    let at = reference.at(1e4);
    assert!((at.position - Vec3::new(-0.5, 1.0, 1.0)).norm() < 1e-13);
    let moving = [at.velocity, at.acceleration, at.jerk, at.snap];
    assert!(moving.iter().all(|derivative| derivative.norm() == 0.0));
    assert_eq!(at.yaw_rate, 0.0);
    let first = reference.at(0.0);
    assert!(first.velocity.norm() + first.acceleration.norm() + first.jerk.norm() < 1e-13);
}

#[test]
fn a_race_crosses_each_gate_in_its_centre_along_its_heading() {
    let Reference::Race(race) = reference(&gates()) else { panic!() };
    let mut crossed = 0;
    let dt = 1e-3;
    for (i, [x, y, z, yaw]) in GATES.into_iter().enumerate() {
        let center: Vec3<f64, World> = Vec3::new(x, y, z);
        let normal: Vec3<f64, World> = Vec3::new(yaw.cos(), yaw.sin(), 0.0);
        let ahead = |t: f64| (race.at(t).position - center).dot(normal);
        let mut t = 0.05;
        while t < race.duration() - 0.05 {
            let near = (race.at(t).position - center).norm() < 0.2;
            if near && ahead(t) < 0.0 && ahead(t + dt) >= 0.0 {
                let (mut low, mut high) = (t, t + dt);
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    *(if ahead(middle) < 0.0 { &mut low } else { &mut high }) = middle;
                }
                let at = race.at(high);
                assert!((at.position - center).norm() < 1e-9, "gate {i}");
                let along = at.velocity * (1.0 / at.velocity.norm());
                assert!((along - normal).norm() < 1e-9, "gate {i}");
                assert!(((at.yaw - yaw) / TAU - ((at.yaw - yaw) / TAU).round()).abs() < 1e-9);
                crossed += 1;
            }
            t += dt;
        }
    }
    assert_eq!(crossed, 3 * 2 + 1, "two laps, start and end in the first gate at rest");
    for t in [0.0, race.duration(), race.duration() + 50.0] {
        let at = race.at(t);
        assert!((at.position - Vec3::new(0.0, 0.0, 1.0)).norm() < 1e-12, "{t} s");
        assert_eq!(at.velocity.norm() + at.acceleration.norm() + at.jerk.norm(), 0.0, "{t} s");
    }
    assert!((race.at(1e3).yaw - 2.0 * TAU).abs() < 1e-12, "two turns of the heading");
}

#[test]
fn a_race_is_smooth_from_piece_to_piece_and_from_lap_to_lap() {
    let curve = curve(&gates());
    joints(&curve, 5);
    let Reference::Race(race) = reference(&gates()) else { panic!() };
    let middle = 0.5 * race.duration();
    let (before, after) = (race.at(middle - 1e-9), race.at(middle + 1e-9));
    assert!((before.snap - after.snap).norm() < 1e-4 * (1.0 + after.snap.norm()));
    assert!((before.yaw - after.yaw).abs() < 1e-7);
}

#[test]
fn a_table_of_a_polynomial_is_reproduced() {
    let x = |t: f64| 1.0 - 2.0 * t + 0.3 * t.powi(3) - 0.02 * t.powi(5);
    let row = |i: i32| {
        // Unevenly in time.
        let t = 0.1 * f64::from(i) + 0.03 * f64::from(i % 3);
        vec![t, x(t), 2.0 * x(t), t * t, 0.1 * t]
    };
    let all: Vec<_> = (0..40).map(row).collect();
    let reference = reference(&format!("shape = \"table\", rows = {}", rows(&all)));
    for i in 0..390 {
        let t = 0.01 * f64::from(i);
        let at = reference.at(t);
        assert!((at.position - Vec3::new(x(t), 2.0 * x(t), t * t)).norm() < 1e-9, "{t} s");
        assert!((at.snap.x + 0.02 * 120.0 * t).abs() < 1e-6, "{t} s: {}", at.snap.x);
        assert!((at.yaw_rate - 0.1).abs() < 1e-9);
    }
}

#[test]
fn the_fit_error_of_a_table_is_that_of_its_rows() {
    for noise in [0.0, 0.02] {
        let text = recording(noise);
        let scenario = scenario(&text);
        let ReferenceSettings::Table(_, options) = scenario.reference else { panic!() };
        let reference = scenario.reference.build(&scenario.vehicle.vehicle);
        let (mut worst, mut sum, mut truth) = (0.0f64, 0.0, 0.0);
        for row in 0..options.rows.len() {
            let cell = |column| options.rows.cell(row, column);
            let t = cell(0) - 5.0;
            let position = reference.at(t - 1e-12).position;
            let distance = (position - Vec3::new(cell(1), cell(2), cell(3))).norm();
            worst = worst.max(distance);
            sum += distance * distance;
            let clean = Vec3::new(2.0 * t.sin(), t.cos(), 1.0 + 0.1 * t);
            truth += (position - clean).norm_squared();
        }
        let n = options.rows.len() as f64;
        let fit = fit_error(&scenario.reference).expect("a fit");
        assert!((fit.worst - worst).abs() < 1e-9 && (fit.rms - (sum / n).sqrt()).abs() < 1e-9);
        let (truth, rms) = ((truth / n).sqrt(), fit.rms);
        if noise > 0.0 {
            // Three axes with a variance of noise^2/3 each.
            assert!((rms - noise).abs() < 0.1 * noise, "{rms}");
            assert!(truth < 0.4 * noise, "the fit is nearer to the truth than the rows: {truth}");
        } else {
            assert!(worst < 1e-6, "a clean path is followed: {worst}");
        }
        joints(&options.curve, 4);
    }
}

#[test]
fn headings_of_a_table_are_unwrapped() {
    let reference = reference(&recording(0.0));
    for i in 0..1100 {
        let t = 0.01 * f64::from(i);
        assert!((reference.at(t).yaw - 0.8 * t).abs() < 1e-6, "{t} s");
    }
}

#[test]
fn a_fit_between_rests_begins_and_ends_at_rest() {
    let rest = |t: f64| {
        let u = (t / 6.0).clamp(0.0, 1.0);
        35.0 * u.powi(4) - 84.0 * u.powi(5) + 70.0 * u.powi(6) - 20.0 * u.powi(7)
    };
    let mut random = Random(3);
    let row = |i: i32| {
        let t = 0.05 * f64::from(i);
        vec![t, 3.0 * rest(t) + 0.002 * random.next(), 0.002 * random.next(), 1.0, 0.0]
    };
    let all: Vec<_> = (0..=120).map(row).collect();
    let text = format!("shape = \"table\", ends = \"rest\", rows = {}", rows(&all));
    let (reference, curve) = (reference(&text), curve(&text));
    for t in [0.0, curve.end() - 1e-13] {
        let at = by_phase(&curve, t);
        let moving = at.velocity.norm() + at.acceleration.norm() + at.jerk.norm();
        assert!(moving < 1e-8, "{t} s: {moving}");
    }
    for i in 0..600 {
        let t = 0.01 * f64::from(i);
        assert!((reference.at(t).position.x - 3.0 * rest(t)).abs() < 0.003, "{t} s");
    }
}
