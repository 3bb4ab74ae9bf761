//! Metrics against closed forms, on signals that no flight is needed for.
// Tests compare bits, take the standard library as their second opinion, and print figures as their
// source prints them.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::approx_constant, clippy::float_cmp)]

use stormpetrel_control::math::{Euler, Rotation, Vec3};
use stormpetrel_lab::metric::{Distribution, Setting, Sums, metrics};
use stormpetrel_plant::flight::Tick;

const DT: f64 = 1e-3;
const SETTING: Setting<f64> = Setting { dt: DT, late: 1.0, gravity: 9.8, has_attitude: true };

/// Metrics of a flight whose ticks are given by their number.
fn over(ticks: u32, tick: impl Fn(f64, Tick<f64>) -> Tick<f64>) -> impl Fn(&str) -> f64 {
    let mut sums = Sums::new();
    let mut distribution = Distribution::new(true);
    for k in 0..ticks {
        let time = f64::from(k) * DT;
        let tick = tick(time, Tick { time, ..Tick::default() });
        distribution.push(&sums.push(&tick, &SETTING, 1.0));
    }
    let all = metrics(&sums, &distribution);
    move |name| all.iter().find(|(known, _)| *known == name).unwrap_or_else(|| panic!("{name}")).1
}

fn close(value: f64, expected: f64, relative: f64) {
    assert!((value - expected).abs() <= relative * expected.abs(), "{value} is not {expected}");
}

#[test]
fn a_constant_error_has_the_integrals_of_a_rectangle() {
    // e = 0.5 m over T = 2 s: IAE = 1, ISE = 0.5, ITAE = 0.5 T^2/2 less half a step, RMSE = max = 0.5.
    let get = over(2000, |_, t| Tick { position: Vec3::new(0.3, 0.0, -0.4), ..t });
    close(get("position.iae"), 1.0, 1e-12);
    close(get("position.ise"), 0.5, 1e-12);
    close(get("position.itae"), 0.5 * (2.0 * 2.0 / 2.0 - 2.0 * DT / 2.0), 1e-12);
    close(get("position.rmse"), 0.5, 1e-12);
    close(get("position.max"), 0.5, 1e-15);
    close(get("position.x.iae"), 0.6, 1e-12);
    close(get("position.z.max"), 0.4, 1e-15);
    close(get("time.flown"), 2.0, 1e-12);
    close(get("position.p95"), 0.5, 0.008);
}

#[test]
fn a_ramp_has_the_percentile_and_late_maximum_of_a_ramp() {
    // e = t over 2 s: 95 % lie below 1.9; the late window (from 1 s) holds the maximum.
    let get = over(2000, |time, t| Tick { position: Vec3::new(time, 0.0, 0.0), ..t });
    close(get("position.p95"), 1.9, 0.008);
    close(get("position.late_max"), 1.999, 1e-12);
    let falling = over(2000, |time, t| Tick { position: Vec3::new(2.0 - time, 0.0, 0.0), ..t });
    close(falling("position.max"), 2.0, 1e-12);
    close(falling("position.late_max"), 1.0, 1e-12);
}

#[test]
fn a_sine_has_the_integrals_of_a_sine() {
    // |sin| over two periods of 1 s: IAE = 4/pi, ISE = 1.
    let get = over(2000, |time, t| Tick {
        position: Vec3::new((std::f64::consts::TAU * time).sin(), 0.0, 0.0),
        ..t
    });
    close(get("position.iae"), 4.0 / std::f64::consts::PI, 1e-5);
    close(get("position.ise"), 1.0, 1e-9);
    close(get("position.rmse"), 0.5_f64.sqrt(), 1e-9);
}

#[test]
fn attitude_errors_are_angles_between_the_right_things() {
    // Rolled by 0.2 rad and yawed by 0.3 rad against a level reference at rest.
    let get = over(10, |_, t| Tick {
        attitude: Rotation::from_euler(Euler { roll: 0.2, pitch: 0.0, yaw: 0.3 }),
        ..t
    });
    close(get("attitude.euler.max"), (0.04_f64 + 0.09).sqrt(), 1e-12);
    close(get("tilt.max"), 0.2, 1e-12);
    close(get("yaw.max"), 0.3, 1e-12);
    // Two rotations about normal axes: cos(a/2) = cos(0.1) cos(0.15).
    close(get("attitude.angle.max"), 2.0 * (0.1_f64.cos() * 0.15_f64.cos()).acos(), 1e-9);
}

#[test]
fn variation_counts_steps_and_effort_counts_squares() {
    // Thrust alternates between 5 and 7 N: 999 steps of 2 N over 1 s, mean square 37.
    let get = over(1000, |time, mut t| {
        let even = (time / DT).round().rem_euclid(2.0) < 0.5;
        t.applied.thrust = if even { 5.0 } else { 7.0 };
        t.command.wrench.torque = Vec3::new(0.0, if even { 1.0 } else { -1.0 }, 0.5);
        t.saturation = 0.25;
        t
    });
    close(get("thrust.variation"), 999.0 * 2.0, 1e-12);
    close(get("thrust.effort"), 37.0, 1e-12);
    close(get("thrust.max"), 7.0, 1e-15);
    close(get("torque.variation"), 999.0 * 2.0, 1e-12);
    close(get("torque.effort"), 1.25, 1e-12);
    close(get("saturation.share"), 0.25, 1e-12);
}

#[test]
fn the_lag_of_a_delayed_estimate_is_its_delay() {
    let delay = 0.02;
    let get = over(20_000, |time, mut t| {
        t.disturbance.lumped = Vec3::new(time.sin(), 0.0, 0.0);
        t.estimate.force = Vec3::new((time - delay).sin(), 0.0, 0.0);
        t
    });
    // The slope is a backward difference, half a step old.
    close(get("estimate.lag"), delay, 0.03);
    close(get("estimate.rmse"), 2.0 * (delay / 2.0).sin() * 0.5_f64.sqrt(), 0.05);
}

#[test]
fn nothing_counts_after_a_flight_has_failed() {
    let mut sums = Sums::<f64>::new();
    let mut tick = Tick { position: Vec3::new(1.0, 0.0, 0.0), ..Tick::default() };
    sums.push(&tick, &SETTING, 1.0);
    tick.position.x = 100.0;
    tick.time = DT;
    sums.push(&tick, &SETTING, 0.0);
    let all = metrics(&sums, &Distribution::new(true));
    assert!(all.contains(&("position.max", 1.0)));
    assert!(all.contains(&("time.flown", DT)));
}

/// Error signals of a whole flight, tick by tick, and its metrics as summed on line.
fn logged() -> (Vec<stormpetrel_lab::metric::Errors<f64>>, stormpetrel_lab::fly::Outcome) {
    let file = stormpetrel_lab::shipped::shipped("first-flight").expect("shipped").expect("good");
    let mut log = Vec::new();
    let outcome = stormpetrel_lab::fly::fly(&file.scenarios[0], |_, errors| log.push(*errors));
    (log, outcome)
}

#[test]
fn metrics_on_line_are_those_of_the_whole_log() {
    let (log, outcome) = logged();
    assert_eq!(log.len(), 20_000);
    let get = |name: &str| outcome.get(name).unwrap_or_else(|| panic!("{name}"));
    for (name, of) in [
        ("position", (|e| e.position) as fn(&stormpetrel_lab::metric::Errors<f64>) -> f64),
        ("position.y", |e| e.axis.y),
        ("attitude.angle", |e| e.angle),
        ("attitude.euler", |e| e.euler),
        ("tilt", |e| e.tilt),
    ] {
        let errors: Vec<f64> = log.iter().map(|e| of(e).abs()).collect();
        // The definitions of `explain`, in the order of the log: exactly the same sums.
        let iae: f64 = errors.iter().fold(0.0, |sum, e| sum + e * DT);
        let ise: f64 = errors.iter().fold(0.0, |sum, e| sum + e * e * DT);
        let max = errors.iter().fold(0.0, |a, b| f64::max(a, *b));
        let late = errors[10_000..].iter().fold(0.0, |a, b| f64::max(a, *b));
        assert_eq!(get(&format!("{name}.iae")), iae, "{name}");
        assert_eq!(get(&format!("{name}.ise")), ise, "{name}");
        assert_eq!(get(&format!("{name}.max")), max, "{name}");
        assert_eq!(get(&format!("{name}.late_max")), late, "{name}");
        // The percentile is that of a histogram.
        let mut sorted = errors;
        sorted.sort_by(f64::total_cmp);
        close(get(&format!("{name}.p95")), sorted[18_999], 0.008);
    }
}
