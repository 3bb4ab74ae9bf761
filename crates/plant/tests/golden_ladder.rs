//! The repair ladder: the golden values of theory 1.3 and 1.4, computed with other programs.
//!
//! Agreement within 2 % or one unit of the last printed digit, whichever is coarser. A debug build
//! flies some rows only; a release build flies all.
// Tests compare bits, take the standard library as their second opinion, and print figures as their
// source prints them.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::approx_constant, clippy::float_cmp)]

mod common;

use common::{Scene, gains, hosm, named, rotation_reference};
use stormpetrel_control::attitude_reference::Rates;
use stormpetrel_control::math::Vec3;
use stormpetrel_control::observer::ObserverSettings;
use stormpetrel_control::observer::hosm::{Input, Z2};
use stormpetrel_plant::disturbance::harmonic;
use stormpetrel_plant::flight::Flight;

/// Integral of the error, of its square, largest error, largest after 10 s, integral of the angle.
#[derive(Default)]
struct Figures {
    iae: f64,
    ise: f64,
    most: f64,
    late: f64,
    attitude: f64,
}

fn fly(mut flight: Flight<f64>, seconds: f64) -> Figures {
    let dt = flight.control_step;
    let mut f = Figures::default();
    for _ in 0..(seconds / dt).round() as u64 {
        let tick = flight.decide();
        let e = (tick.position - tick.reference.position).norm();
        f.iae += e * dt;
        f.ise += e * e * dt;
        f.most = if e > f.most { e } else { f.most };
        f.late = if tick.time >= 10.0 && e > f.late { e } else { f.late };
        f.attitude += (tick.command.attitude.rotation.inverse() * tick.attitude).angle() * dt;
        flight.advance(&tick);
    }
    assert_eq!(flight.alive, 1.0);
    f
}

/// `printed` as the table has it: its digits give the unit.
fn assert_golden(name: &str, got: f64, printed: &str) {
    let want: f64 = printed.parse().expect("a number");
    let mantissa = printed.split('e').next().unwrap_or(printed);
    let digits = mantissa.split('.').nth(1).map_or(0, str::len) as i32;
    let exponent = printed.split('e').nth(1).map_or(0, |e| e.parse().expect("an exponent"));
    let unit = 10f64.powi(exponent - digits);
    let room = if 0.02 * want > unit { 0.02 * want } else { unit };
    assert!((got - want).abs() <= room, "{name}: {got}, not {printed} +- {room:e}");
}

/// In debug builds only the first rows.
fn rows<T>(all: Vec<T>, debug: usize) -> Vec<T> {
    let take = if cfg!(debug_assertions) { debug } else { all.len() };
    all.into_iter().take(take).collect()
}

#[test]
fn val_the_repair_ladder_has_the_golden_values() {
    let none: ObserverSettings = named("none");
    let both = (Input::Measured, Z2::Single);
    let see = |l, (input, z2)| hosm(l, input, z2);
    let (zero, pi, p) = (Rates::Zero, gains(6.0, 2.0, 4.0), gains(6.0, 0.0, 4.0));
    // Observer, gains, rates; IAE, ISE, max, max after 10 s, attitude IAE.
    #[rustfmt::skip]
    let table = vec![
        (see(1.5, both), pi, Rates::Commanded, ["0.508", "0.058", "0.236", "0.0036", "0.056"]),
        (see(1.5, both), pi, Rates::Trajectory, ["0.967", "0.119", "0.319", "0.0437", "0.395"]),
        (none, pi, zero, ["4.82", "1.45", "0.496", "0.369", "0.43"]),
        (see(1.5, (Input::Commanded, Z2::Doubled)), pi, zero, ["2.55", "0.396", "0.3215", "0.202", "0.84"]),
        (see(1.5, (Input::Measured, Z2::Doubled)), pi, zero, ["2.53", "0.402", "0.321", "0.188", "0.43"]),
        (see(1.5, (Input::Commanded, Z2::Single)), pi, zero, ["1.28", "0.158", "0.321", "0.079", "0.71"]),
        (see(1.5, both), pi, zero, ["0.977", "0.121", "0.321", "0.047", "0.40"]),
        (see(2.5, both), p, zero, ["0.642", "0.055", "0.263", "0.041", "0.41"]),
    ];
    for (row, (observer, position, rates, golden)) in rows(table, 2).into_iter().enumerate() {
        let scene = Scene {
            observer,
            position,
            attitude_reference: rotation_reference(rates),
            ..Scene::default()
        };
        let f = fly(scene.flight(), 20.0);
        let found = [f.iae, f.ise, f.most, f.late, f.attitude];
        let names = ["IAE", "ISE", "max", "max after 10 s", "attitude IAE"];
        for ((name, got), printed) in names.into_iter().zip(found).zip(golden) {
            assert_golden(&format!("row {row}, {name}"), got, printed);
        }
    }
}

#[test]
fn val_a_plain_attitude_loop_in_place_of_indi_is_worse() {
    let scene = Scene { rate: named("pid"), ..Scene::default() };
    let f = fly(scene.flight(), 20.0);
    // Theory: IAE 5.2-5.3, max after 10 s 0.40-0.41, depending on details; again within 2 %.
    assert!((5.2 * 0.98..5.3 * 1.02).contains(&f.iae), "IAE {}", f.iae);
    assert!((0.40 * 0.98..0.41 * 1.02).contains(&f.late), "max after 10 s {}", f.late);
}

#[test]
fn val_the_point_mass_has_the_golden_values() {
    let none: ObserverSettings = named("none");
    let see = |l, z2| hosm(l, Input::Measured, z2);
    // Amplitude in m/s^2, observer; IAE, ISE, max, max after 10 s. Theory 1.3.
    #[rustfmt::skip]
    let table = vec![
        (0.8, see(10.0, Z2::Single), ["0.0047", "2.2e-5", "0.0109", "9e-6"]),
        (50.0, none, ["14.9", "14.0", "2.08", "1.105"]),
        (50.0, see(10.0, Z2::Doubled), ["17.3", "18.4", "2.04", "1.295"]),
        (50.0, see(10.0, Z2::Single), ["17.3", "18.4", "2.04", "1.308"]),
        (50.0, see(75.0, Z2::Single), ["2.30", "2.01", "1.78", "0.0018"]),
        (50.0, see(75.0, Z2::Doubled), ["7.58", "4.03", "1.78", "0.552"]),
        (8.0, none, ["2.38", "0.360", "0.333", "0.177"]),
        (8.0, see(10.0, Z2::Single), ["0.562", "0.078", "0.293", "0.0020"]),
        (0.8, none, ["0.238", "0.0036", "0.0333", "0.0177"]),
        (0.8, see(10.0, Z2::Doubled), ["0.119", "9.0e-4", "0.0168", "0.0088"]),
    ];
    for (amplitude, observer, golden) in rows(table, 1) {
        let scene = Scene {
            observer,
            position: gains(100.0, 60.0, 10.0),
            actuation: named("thrust-vector"),
            disturbance: harmonic::Gains {
                acceleration: Vec3::splat(amplitude),
                ..harmonic::Gains::default()
            },
            control_step: 1e-4,
            substeps: 1,
            ..Scene::default()
        };
        let f = fly(scene.flight(), 20.0);
        let names = ["IAE", "ISE", "max", "max after 10 s"];
        for ((name, got), printed) in
            names.into_iter().zip([f.iae, f.ise, f.most, f.late]).zip(golden)
        {
            let label = format!("A = {amplitude}, {}, {name}", golden[0]);
            assert_golden(&label, got, printed);
        }
    }
}

#[test]
fn the_figures_obey_the_inequality_that_the_article_s_table_breaks() {
    // max IAE >= ISE >= IAE^2/T, theory 1.3.
    let f = fly(Scene::default().flight(), 2.0);
    assert!(f.most * f.iae >= f.ise && f.ise >= f.iae * f.iae / 2.0);
}
