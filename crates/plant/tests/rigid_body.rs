//! The rigid body against exact solutions: NESC check-case 2 and the tops of reliability 1.2 and 1.4.
//!
//! All through `dynamics::runge_kutta`, without thrust, gravity and torque.
// Tests compare bits, take the standard library as their second opinion, and print figures as their
// source prints them.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::approx_constant, clippy::float_cmp)]

mod common;

use common::{Free, body};
use nalgebra::{UnitQuaternion, Vector3};
use stormpetrel_control::math::{Body, Vec3};
use stormpetrel_plant::state::State;

/// The brick of NESC case 2 in kg m^2.
const BRICK: [f64; 3] = [0.002_568_217, 0.008_421_012, 0.009_754_656];
/// The same in slug ft^2, in which the table was computed: more digits.
const BRICK_SLUG: [f64; 3] = [0.001_894_220, 0.006_211_019, 0.007_194_665];

fn from_degrees(p: f64, q: f64, r: f64) -> Vec3<f64, Body> {
    body(p.to_radians(), q.to_radians(), r.to_radians())
}

fn spinning(rate: Vec3<f64, Body>) -> State<f64> {
    State { rate, ..State::default() }
}

fn free([x, y, z]: [f64; 3]) -> Free {
    Free::new(body(x, y, z))
}

fn attitude(state: &State<f64>) -> UnitQuaternion<f64> {
    let q = state.attitude;
    UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(q.w, q.x, q.y, q.z))
}

fn vector<F>(v: Vec3<f64, F>) -> Vector3<f64> {
    Vector3::new(v.x, v.y, v.z)
}

/// Rates at whole seconds, deg/s, with the exact values of reliability 1.2.
#[rustfmt::skip]
const CASE_2: [(u32, [f64; 3]); 8] = [
    (1, [4.25884189865345, 23.1199428974973, 28.3798177750828]),
    (2, [-1.7508153285529, 23.6495577598503, 28.0713200449182]),
    (5, [-16.9394851494413, 9.63193937741517, 33.4066280794463]),
    (10, [-2.41890222169288, -23.5525695195605, 28.1285926300414]),
    (15, [18.4372543136067, 2.38688029912505, 34.3107056116157]),
    (20, [-5.42273468006839, 22.7159305764525, 28.6082817473166]),
    (25, [-15.1840887010873, -13.617799500613, 32.4167961983789]),
    (30, [12.6183907759142, -17.3974747616114, 31.1195888869443]),
];

/// Attitudes w x y z of the same case, about 12 digits.
#[rustfmt::skip]
const CASE_2_ATTITUDE: [(u32, [f64; 4]); 5] = [
    (1, [0.948183502901, 0.059910076574, 0.184838845666, 0.251383031815]),
    (5, [-0.010659276173, -0.025219081539, 0.372972327692, 0.927438418729]),
    (10, [-0.838405866829, 0.542762934808, -0.047887983494, 0.013810868984]),
    (20, [0.997079290350, 0.038721272795, 0.033380224217, -0.056738985013]),
    (30, [-0.881147185310, 0.470182527767, 0.011728252325, 0.048687539472]),
];

#[test]
fn val_nesc_case_2_has_the_exact_rates() {
    let brick = free(BRICK_SLUG);
    for (seconds, want) in CASE_2 {
        let end = brick.fly(spinning(from_degrees(10.0, 20.0, 30.0)), 2e-3, seconds * 500, |_| ());
        for (got, want) in [end.rate.x, end.rate.y, end.rate.z].into_iter().zip(want) {
            let off = (got.to_degrees() - want).abs();
            assert!(off < 1e-11, "{seconds} s: off by {off:e} deg/s");
        }
    }
}

#[test]
fn val_nesc_case_2_has_the_exact_attitude() {
    let brick = free(BRICK_SLUG);
    for (seconds, want) in CASE_2_ATTITUDE {
        let end = brick.fly(spinning(from_degrees(10.0, 20.0, 30.0)), 2e-3, seconds * 500, |_| ());
        let q = end.attitude;
        let sign = if q.w * want[0] + q.x * want[1] < 0.0 { -1.0 } else { 1.0 };
        for (got, want) in [q.w, q.x, q.y, q.z].into_iter().zip(want) {
            assert!((sign * got - want).abs() < 2e-12, "{seconds} s: {:e}", sign * got - want);
        }
    }
}

#[test]
fn val_nesc_case_2_hardly_depends_on_the_rounding_of_the_inertia_in_si() {
    // The printed SI values have seven digits; the ratios, and so the rates, agree to about that.
    let end = free(BRICK).fly(spinning(from_degrees(10.0, 20.0, 30.0)), 2e-3, 15_000, |_| ());
    assert!((end.rate.x.to_degrees() - 12.618_390_775_914_2).abs() < 1e-4);
}

#[test]
fn val_the_intermediate_axis_flips_when_it_should() {
    let top = free([1.0, 2.0, 3.0]);
    // Reliability 1.4.1. Near the separatrix errors grow as exp(lambda t) with lambda near 1/sqrt 3.
    #[rustfmt::skip]
    let exact = [
        (10, [-0.117326383719773, 0.993093912821562, 0.0677433399352767]),
        (20, [-0.105321008009369, -0.9944387790467, 0.0608125938933418]),
        (30, [0.00119439643512387, -0.999999786708555, 0.00106873489763]),
    ];
    for (seconds, want) in exact {
        let end = top.fly(spinning(body(1e-3, 1.0, 1e-3)), 2e-3, seconds * 500, |_| ());
        let off = (vector(end.rate) - Vector3::from(want)).amax();
        assert!(off < 5e-11, "{seconds} s: off by {off:e} rad/s");
    }
}

#[test]
fn val_jsbsim_s_top_has_the_exact_rates() {
    let top = free([10.0, 20.0, 26.0]);
    #[rustfmt::skip]
    let exact = [
        (1, [-3.82816674585264, -14.3803170742024, 3.12299788521526]),
        (10, [-8.93297814787054, 10.9515235719156, 7.17715832767186]),
        (30, [11.1922037980959, -7.70147813880666, 8.9809422817442]),
    ];
    for (seconds, want) in exact {
        // 0.1 ms: it turns at 15 rad/s, and 30 s are 13 periods.
        let steps = if cfg!(debug_assertions) && seconds > 1 { continue } else { seconds * 10_000 };
        let end = top.fly(spinning(body(1.0, 15.0, 1.0)), 1e-4, steps, |_| ());
        let off = (vector(end.rate) - Vector3::from(want)).amax();
        assert!(off < 1e-9, "{seconds} s: off by {off:e} rad/s");
    }
}

#[test]
fn the_angular_momentum_stays_where_it_points() {
    for inertia in [BRICK_SLUG, [1.0, 2.0, 3.0], [0.3, 0.3, 0.5], [2.6e-3, 2.4e-3, 2.6e-3]] {
        let rate = from_degrees(10.0, 20.0, 30.0);
        let momentum =
            |s: &State<f64>| attitude(s) * vector(s.rate).component_mul(&Vector3::from(inertia));
        let energy = |s: &State<f64>| {
            vector(s.rate).component_mul(&vector(s.rate)).dot(&Vector3::from(inertia)) / 2.0
        };
        let start = spinning(rate);
        let (l, e) = (momentum(&start), energy(&start));
        free(inertia).fly(start, 2e-3, 15_000, |s| {
            // As a vector in the world's axes, so that attitude and rate must agree.
            assert!((momentum(s) - l).norm() / l.norm() < 1e-12, "{inertia:?}");
            assert!((energy(s) / e - 1.0).abs() < 1e-12, "{inertia:?}");
            let q = s.attitude;
            let norm = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
            assert!((norm - 1.0).abs() < 1e-15, "{inertia:?}");
        });
    }
}

#[test]
fn the_symmetric_top_precesses_as_in_the_closed_form() {
    // Kane 1983, as in Drake's FreeBody: I = 0.04, J = 0.02.
    let (i, j) = (0.04, 0.02);
    let w = Vector3::new(0.7, -0.3, 2.0);
    let t = 10.0;
    let end = free([i, i, j]).fly(spinning(body(w.x, w.y, w.z)), 1e-3, 10_000, |_| ());
    // Rates turn about the body's axis with Omega = (J - I) w3/I.
    let (sin, cos) = ((j - i) * w.z / i * t).sin_cos();
    let want = Vector3::new(w.x * cos - w.y * sin, w.x * sin + w.y * cos, w.z);
    assert!((vector(end.rate) - want).amax() < 1e-12, "{:e}", (vector(end.rate) - want).amax());
    // Attitude: L/I t about the fixed L, then -Omega t about the body's axis.
    let l = Vector3::new(i * w.x, i * w.y, j * w.z);
    let want = UnitQuaternion::from_scaled_axis(l / i * t)
        * UnitQuaternion::from_scaled_axis(Vector3::z() * (-(j - i) * w.z / i * t));
    assert!(attitude(&end).angle_to(&want) < 1e-11, "{:e}", attitude(&end).angle_to(&want));
}

#[test]
fn a_turn_about_a_principal_axis_is_uniform() {
    for axis in 0..3 {
        let mut w = [0.0; 3];
        w[axis] = 1.5;
        let end = free([1.0, 2.0, 3.0]).fly(spinning(body(w[0], w[1], w[2])), 1e-3, 2000, |s| {
            assert_eq!([s.rate.x, s.rate.y, s.rate.z], w, "the rate does not change by a bit");
        });
        let want = UnitQuaternion::from_scaled_axis(Vector3::from(w) * 2.0);
        assert!(attitude(&end).angle_to(&want) < 1e-12, "axis {axis}");
    }
}

#[test]
fn a_flight_back_in_time_ends_where_it_began() {
    let brick = free(BRICK_SLUG);
    let start = spinning(from_degrees(10.0, 20.0, 30.0));
    let end = brick.fly(brick.fly(start, 2e-3, 5000, |_| ()), -2e-3, 5000, |_| ());
    assert!((end.rate - start.rate).norm() < 1e-12);
    assert!((start.attitude.inverse() * end.attitude).angle() < 1e-12);
}
