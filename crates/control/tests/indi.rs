//! INDI on one axis, in a loop small enough to be solved by hand (theory 3.2).
//!
//! The body turns by the torque of the last interval, J omega' = tau + d; the law believes the
//! inertia to be I. lambda = I/J is the ratio of real to believed effectiveness.
// Tests compare bits, take the standard library as their second opinion, and print figures as their
// source prints them.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::approx_constant, clippy::float_cmp)]

use stormpetrel_control::guard::Guarded;
use stormpetrel_control::math::Vec3;
use stormpetrel_control::rate::indi::{Filter, Gains, Indi, Options};
use stormpetrel_control::signals::{Measurement, Model, Rate, Wrench};

const INERTIA: f64 = 2.6e-3;

/// What turns about one axis.
struct Body {
    inertia: f64,
    /// Time constant of the torque, s; zero: at once.
    lag: f64,
    dt: f64,
    rate: f64,
    torque: f64,
}

impl Body {
    /// One interval: the torque follows its command and then acts for `dt`. Returns the acceleration.
    fn turn(&mut self, command: f64, disturbance: f64) -> f64 {
        let share = if self.lag > 0.0 { 1.0 - (-self.dt / self.lag).exp() } else { 1.0 };
        self.torque += share * (command - self.torque);
        let acceleration = (self.torque + disturbance) / self.inertia;
        self.rate += acceleration * self.dt;
        acceleration
    }
}

type Law = Guarded<f64, Indi<f64>, Wrench<f64>>;

fn law(filter: Filter, cutoff_hz: f64, k_omega: f64) -> Law {
    let gains = Gains { k_omega: Vec3::splat(k_omega), cutoff_hz, ..Gains::default() };
    let model = Model { inertia: Vec3::splat(INERTIA), ..Model::default() };
    Guarded::new(Indi::new(gains, Options { filter }, &model), Wrench::default())
}

/// The torque for the angular acceleration `nu`; the other axes rest.
fn torque(law: &mut Law, body: &Body, nu: f64) -> f64 {
    let achieved = Wrench { thrust: 0.0, torque: Vec3::new(0.0, body.torque, 0.0) };
    let m =
        Measurement { rate: Vec3::new(0.0, body.rate, 0.0), achieved, ..Measurement::default() };
    let reference = Rate { acceleration: Vec3::new(0.0, nu, 0.0), ..Rate::default() };
    let wrench = law.update(&m, &reference, body.dt);
    assert_eq!(law.flag, 0.0);
    assert_eq!((wrench.torque.x, wrench.torque.z), (0.0, 0.0), "axes do not mix");
    wrench.torque.y
}

/// Angular accelerations under a constant demand, one per interval.
fn response(lambda: f64, nu: f64, ticks: usize) -> Vec<f64> {
    let mut law = law(Filter::Absent, 50.0, 0.0);
    let mut body = Body { inertia: INERTIA / lambda, lag: 0.0, dt: 1e-3, rate: 0.0, torque: 0.0 };
    (0..ticks)
        .map(|_| {
            let command = torque(&mut law, &body, nu);
            body.turn(command, 0.0)
        })
        .collect()
}

#[test]
fn one_step_indi_has_its_pole_at_one_minus_lambda() {
    let nu = 3.0;
    for lambda in [0.1, 0.5, 0.9, 1.0, 1.1, 1.5, 1.9] {
        let found = response(lambda, nu, 400);
        for (k, acceleration) in (1..).zip(&found) {
            // a_k = nu (1 - (1 - lambda)^k). The difference of rates over 1 ms loses three digits.
            let want = nu * (1.0 - (1.0 - lambda).powi(k));
            assert!((acceleration - want).abs() < 1e-9, "lambda {lambda}, step {k}");
        }
        assert!((found[399] / nu - 1.0).abs() < 1e-9, "lambda {lambda} is stable");
    }
}

#[test]
fn one_step_indi_is_unstable_beyond_lambda_two() {
    let (lambda, nu) = (2.1, 3.0);
    for (k, acceleration) in (1..).zip(response(lambda, nu, 200)) {
        let want = nu * (1.0 - (1.0f64 - lambda).powi(k));
        assert!((acceleration / want - 1.0).abs() < 1e-6, "step {k}");
    }
    assert!(response(lambda, nu, 200)[199].abs() > 1e8);
    assert!(response(2.0, nu, 200)[199].abs() < 7.0, "at two it neither grows nor settles");
}

#[test]
fn with_the_exact_model_the_cutoff_does_not_matter() {
    // omega_dot = A nu, whatever H is: the same filter stands on both signals.
    let demand = |k: u32| 20.0 * (0.01 * f64::from(k)).sin() + 5.0 * (0.07 * f64::from(k)).cos();
    for cutoff in [30.0, 50.0, 100.0, 200.0] {
        let mut law = law(Filter::Butterworth, cutoff, 0.0);
        let mut body = Body { inertia: INERTIA, lag: 0.02, dt: 1e-3, rate: 0.0, torque: 0.0 };
        let mut alone = 0.0; // A nu: the lag alone
        for k in 0..2000 {
            let nu = demand(k);
            let command = torque(&mut law, &body, nu);
            alone += (1.0 - (-0.05f64).exp()) * (nu - alone);
            let acceleration = body.turn(command, 0.0);
            assert!((acceleration - alone).abs() < 1e-9, "{cutoff} Hz, tick {k}");
        }
    }
}

#[test]
fn a_wrong_model_makes_the_cutoff_matter() {
    // The same test must fail where it should, or the one above says nothing.
    let after = |cutoff: f64| {
        let mut law = law(Filter::Butterworth, cutoff, 0.0);
        let mut body = Body { inertia: 2.0 * INERTIA, lag: 0.02, dt: 1e-3, rate: 0.0, torque: 0.0 };
        (0..20)
            .map(|_| {
                let command = torque(&mut law, &body, 10.0);
                body.turn(command, 0.0)
            })
            .last()
            .unwrap_or(0.0)
    };
    assert!((after(30.0) - after(200.0)).abs() > 0.1);
}

#[test]
fn a_slowly_growing_disturbance_leaves_its_slope_times_the_delays() {
    // Theory 3.2 (2): residual d_dot (tau_m + sqrt2/omega_c), here per inertia.
    for (cutoff, lag) in [(50.0, 0.02), (15.0, 0.02), (30.0, 0.05)] {
        let (dt, slope) = (1e-4, 2.6e-3);
        let mut law = law(Filter::Butterworth, cutoff, 0.0);
        let mut body = Body { inertia: INERTIA, lag, dt, rate: 0.0, torque: 0.0 };
        let mut acceleration = 0.0;
        for k in 0..40_000 {
            let command = torque(&mut law, &body, 0.0);
            acceleration = body.turn(command, slope * dt * f64::from(k));
        }
        let want = slope / INERTIA * (lag + 2f64.sqrt() / (2.0 * std::f64::consts::PI * cutoff));
        assert!((acceleration / want - 1.0).abs() < 0.01, "{cutoff} Hz, {lag} s: {acceleration}");
    }
}

#[test]
fn a_constant_disturbance_is_rejected_completely() {
    for filter in [Filter::Butterworth, Filter::Absent] {
        let mut law = law(filter, 50.0, 25.0);
        let mut body = Body { inertia: INERTIA, lag: 0.02, dt: 1e-3, rate: 0.0, torque: 0.0 };
        for _ in 0..4000 {
            let command = torque(&mut law, &body, 0.0);
            body.turn(command, 0.05);
        }
        assert!(body.rate.abs() < 1e-9, "{filter:?}: {}", body.rate);
        assert!((body.torque + 0.05).abs() < 1e-9, "{filter:?}: {}", body.torque);
    }
}
