//! Prediction: the nominal state, its transition, its noise and its past.

use crate::oracle::{
    Dice, Exact, V, dense, far, filter, force, quaternion, rate, scattered, vec3, vector,
};
use nalgebra::{DMatrix, DVector};
use stormpetrel_control::estimator::covariance::Covariance;
use stormpetrel_control::estimator::{Gains, Imu, Lag};

#[test]
fn the_nominal_state_follows_the_exact_motion_to_second_order() {
    let error = |dt: f64| {
        let mut filter = filter(Gains::default());
        filter.imu = Imu { specific_force: vec3(force(0.0)), rate: vec3(rate(0.0)) };
        let ticks = (2.0 / dt).round() as usize;
        for k in 1..=ticks {
            let t = k as f64 * dt;
            filter.predict(&Imu { specific_force: vec3(force(t)), rate: vec3(rate(t)) }, dt);
        }
        let exact = Exact::start().flow(force, rate, 0.0, 2.0, 20_000);
        exact.minus(Exact::of(&filter.nominal)).norm()
    };
    let (coarse, fine) = (error(4e-3), error(2e-3));
    assert!(fine < 2e-4, "{fine}");
    assert!((coarse / fine).log2() > 1.9, "order {}", (coarse / fine).log2());
    let single = error(1e-3);
    assert!(single < 4e-5, "{single}");
}

/// Continuous error dynamics (2): x' = A x + noise, at the exact state.
fn dynamics(x: &Exact, f: V, w: V) -> DMatrix<f64> {
    let mut a = DMatrix::zeros(15, 15);
    let r = x.q.to_rotation_matrix().into_inner();
    let cross = |v: V| v.cross_matrix();
    a.view_mut((0, 3), (3, 3)).fill_with_identity();
    a.view_mut((3, 6), (3, 3)).copy_from(&(-(r * cross(f - x.ba))));
    a.view_mut((3, 12), (3, 3)).copy_from(&(-r));
    a.view_mut((6, 6), (3, 3)).copy_from(&(-cross(w - x.bg)));
    a.view_mut((6, 9), (3, 3)).copy_from(&(-nalgebra::Matrix3::<f64>::identity()));
    a
}

fn densities(g: &Gains<f64>) -> DMatrix<f64> {
    let d = [0.0, g.accelerometer_noise, g.gyro_noise, g.gyro_walk, g.accelerometer_walk];
    DMatrix::from_diagonal(&DVector::from_fn(15, |i, _| d[i / 3] * d[i / 3]))
}

/// Transition and noise over a span, from many short ones of constant A by Van Loan's formula.
fn van_loan(start: Exact, f: V, w: V, q: &DMatrix<f64>, span: f64) -> (DMatrix<f64>, DMatrix<f64>) {
    let n = 100;
    let h = span / n as f64;
    let (mut phi, mut noise) = (DMatrix::identity(15, 15), DMatrix::zeros(15, 15));
    for k in 0..n {
        let middle = start.flow(|_| f, |_| w, 0.0, (k as f64 + 0.5) * h, 4);
        let a = dynamics(&middle, f, w);
        let mut big = DMatrix::zeros(30, 30);
        big.view_mut((0, 0), (15, 15)).copy_from(&(-&a * h));
        big.view_mut((0, 15), (15, 15)).copy_from(&(q * h));
        big.view_mut((15, 15), (15, 15)).copy_from(&(a.transpose() * h));
        let e = big.exp();
        let step = e.view((15, 15), (15, 15)).transpose();
        noise = &step * noise * step.transpose() + &step * e.view((0, 15), (15, 15));
        phi = step * phi;
    }
    (phi, noise)
}

/// The filter's covariance after a span of constant readings, of one propagation.
fn propagated(gains: Gains<f64>, p: Covariance<f64>, f: V, w: V, span: f64) -> DMatrix<f64> {
    let gains = Gains { covariance_hz: 0.5 / span, ..gains };
    let mut filter = filter(gains);
    filter.covariance = p;
    filter.imu = Imu { specific_force: vec3(f), rate: vec3(w) };
    for _ in 0..10 {
        filter.predict(&filter.imu.clone(), span / 10.0);
    }
    filter.propagate(true);
    dense(&filter.covariance)
}

#[test]
fn the_transition_is_the_derivative_of_the_motion() {
    let (f, w) = (V::new(2.0, -1.0, 11.0), V::new(1.5, -2.0, 0.8));
    let still = Gains {
        gyro_noise: 0.0,
        accelerometer_noise: 0.0,
        gyro_walk: 0.0,
        accelerometer_walk: 0.0,
        ..Gains::default()
    };
    let error = |span: f64| {
        let end = |x: Exact| x.flow(|_| f, |_| w, 0.0, span, 50);
        let mut phi = DMatrix::zeros(15, 15);
        for j in 0..15 {
            let mut e = DVector::zeros(15);
            e[j] = 1e-5;
            let (plus, minus) = (end(Exact::start().plus(&e)), end(Exact::start().plus(&-e)));
            let base = end(Exact::start());
            phi.set_column(j, &((plus.minus(base) - minus.minus(base)) / 2e-5));
        }
        let p = scattered(&mut Dice(1));
        let want = &phi * dense(&p) * phi.transpose();
        far(&propagated(still, p, f, w, span), &want)
    };
    assert!(error(4e-3) < 1e-5, "{}", error(4e-3));
    // What is left is of third order in the span.
    let order = (error(0.04) / error(0.02)).log2();
    assert!(order > 2.8, "order {order}");
}

#[test]
fn transition_and_noise_are_those_of_the_matrix_exponential() {
    let (f, w) = (V::new(2.0, -1.0, 11.0), V::new(1.5, -2.0, 0.8));
    let gains = Gains {
        gyro_noise: 0.02,
        accelerometer_noise: 0.3,
        gyro_walk: 0.01,
        accelerometer_walk: 0.1,
        ..Gains::default()
    };
    let q = densities(&gains);
    // From a certain start, all that is there is noise.
    let (_, noise) = van_loan(Exact::start(), f, w, &q, 0.01);
    let got = propagated(gains, Covariance::default(), f, w, 0.01);
    for i in 0..15 {
        for j in 0..15 {
            // White noise twice integrated is D^3/3; halves before and after give D^3/2.
            let room = if i < 3 || j < 3 { 0.8 } else { 3e-3 };
            let scale = (noise[(i, i)] * noise[(j, j)]).sqrt();
            let wrong = (got[(i, j)] - noise[(i, j)]).abs() / scale;
            assert!(wrong < room, "{i} {j}: {} {}", got[(i, j)], noise[(i, j)]);
        }
    }
    let p = scattered(&mut Dice(2));
    let error = |span: f64| {
        let (phi, noise) = van_loan(Exact::start(), f, w, &q, span);
        let want = &phi * dense(&p) * phi.transpose() + noise;
        far(&propagated(gains, p, f, w, span), &want)
    };
    assert!(error(4e-3) < 1e-5, "{}", error(4e-3));
    let order = (error(0.02) / error(0.01)).log2();
    assert!(order > 2.5, "order {order}");
}

#[test]
fn the_past_of_a_smooth_motion_is_found_to_third_order() {
    let wrong = |age: f64| {
        let (dt, end) = (1e-3, 1.0);
        let mut filter = filter(Gains::default());
        filter.imu = Imu { specific_force: vec3(force(0.0)), rate: vec3(rate(0.0)) };
        let mut lag = Lag::default();
        for k in 1..=(end / dt) as usize {
            let t = k as f64 * dt;
            filter.predict(&Imu { specific_force: vec3(force(t)), rate: vec3(rate(t)) }, dt);
            lag.update(&filter.motion, age, dt);
        }
        let then = Exact::start().flow(force, rate, 0.0, end - age, 20_000);
        let now = Exact::start().flow(force, rate, 0.0, end, 20_000);
        filter.nominal = now.nominal();
        let past = filter.past(age, &lag);
        let q = (then.q.inverse() * quaternion(past.attitude)).scaled_axis().norm();
        [(vector(past.position) - then.p).norm(), (vector(past.velocity) - then.v).norm(), q]
    };
    // Bounds of the module documentation for this motion: |jerk| < 30, |jerk'| < 250, |w''| + |w x w'| < 60.
    for age in [0.02, 0.05, 0.1] {
        let [p, v, q] = wrong(age);
        let third = age * age * age / 12.0;
        let rest = 1e-5;
        assert!(
            p < 30.0 * third + rest && v < 250.0 * third + rest && q < 60.0 * third + rest,
            "{age}: {p} {v} {q}"
        );
    }
}
