//! The error-state filter against a fine integration, matrix exponentials and a dense Kalman filter.
// Tests compare bits, take the standard library as their second opinion, and print figures as their
// source prints them.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::approx_constant, clippy::float_cmp)]

mod common;

use common::bits;
use nalgebra::{DMatrix, DVector, Quaternion, UnitQuaternion, Vector3};
use stormpetrel_control::estimator::covariance::{Covariance, ErrorState, Parts};
use stormpetrel_control::estimator::{Eskf, Gains, Imu, Lag, Nominal, Row, turn};
use stormpetrel_control::lanes::{LaneMask, Lanes};
use stormpetrel_control::math::{Frame, Rotation, Vec3, World};
use stormpetrel_control::real::Mask;
use stormpetrel_control::record::{Record, RecordExt};
use stormpetrel_control::signals::{Measurement, Model};

type V = Vector3<f64>;
const G: f64 = 9.8;

fn vec3<F: Frame>(v: V) -> Vec3<f64, F> {
    Vec3::new(v.x, v.y, v.z)
}

fn vector<F: Frame>(v: Vec3<f64, F>) -> V {
    V::new(v.x, v.y, v.z)
}

fn quaternion<A: Frame, B: Frame>(q: Rotation<f64, A, B>) -> UnitQuaternion<f64> {
    UnitQuaternion::new_unchecked(Quaternion::new(q.w, q.x, q.y, q.z))
}

/// Uniform numbers in -1..1 from a counter; nothing of the program is used.
struct Dice(u64);

impl Dice {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 11) as f64) / 4_503_599_627_370_496.0 - 1.0
    }
    fn vector(&mut self) -> V {
        V::new(self.next(), self.next(), self.next())
    }
}

/// The exact state.
#[derive(Clone, Copy)]
struct Exact {
    p: V,
    v: V,
    q: UnitQuaternion<f64>,
    bg: V,
    ba: V,
}

impl Exact {
    fn start() -> Self {
        Self {
            p: V::new(1.0, -2.0, 3.0),
            v: V::new(0.5, 1.5, -0.7),
            q: UnitQuaternion::from_euler_angles(0.3, -0.5, 1.1),
            bg: V::new(0.01, -0.02, 0.03),
            ba: V::new(0.1, 0.2, -0.15),
        }
    }

    /// p' = v, v' = R (f - b_a) - g, R' = R [w - b_g]x by Runge-Kutta on the rotation vector's short way.
    fn flow(
        mut self,
        f: impl Fn(f64) -> V,
        w: impl Fn(f64) -> V,
        from: f64,
        span: f64,
        n: usize,
    ) -> Self {
        let h = span / n as f64;
        for k in 0..n {
            let t = from + k as f64 * h;
            // Magnus to fourth order for the rotation, Simpson for the rest: error of h^4.
            let rate = |s: f64| w(t + s * h) - self.bg;
            let (w0, w1, w2) = (rate(0.0), rate(0.5), rate(1.0));
            let half = (w0 * 5.0 + w1 * 8.0 - w2) * (h / 24.0);
            let whole = (w0 + w1 * 4.0 + w2) * (h / 6.0) + w0.cross(&w2) * (h * h / 12.0);
            let middle = self.q * UnitQuaternion::from_scaled_axis(half);
            let end = self.q * UnitQuaternion::from_scaled_axis(whole);
            let a = |q: UnitQuaternion<f64>, s: f64| q * (f(t + s * h) - self.ba) - V::z() * G;
            let (a0, a1, a2) = (a(self.q, 0.0), a(middle, 0.5), a(end, 1.0));
            self.p += self.v * h + (a0 + a1 * 2.0) * (h * h / 6.0);
            self.v += (a0 + a1 * 4.0 + a2) * (h / 6.0);
            self.q = end;
        }
        self
    }

    fn plus(self, e: &DVector<f64>) -> Self {
        let part = |i: usize| V::new(e[i], e[i + 1], e[i + 2]);
        Self {
            p: self.p + part(0),
            v: self.v + part(3),
            q: self.q * UnitQuaternion::from_scaled_axis(part(6)),
            bg: self.bg + part(9),
            ba: self.ba + part(12),
        }
    }

    fn minus(self, other: Self) -> DVector<f64> {
        let theta = (other.q.inverse() * self.q).scaled_axis();
        let parts =
            [self.p - other.p, self.v - other.v, theta, self.bg - other.bg, self.ba - other.ba];
        DVector::from_iterator(15, parts.iter().flat_map(|v| [v.x, v.y, v.z]))
    }

    fn nominal(self) -> Nominal<f64> {
        Nominal {
            position: vec3(self.p),
            velocity: vec3(self.v),
            attitude: Rotation::from_quaternion(self.q.w, self.q.i, self.q.j, self.q.k),
            gyro_bias: vec3(self.bg),
            accelerometer_bias: vec3(self.ba),
        }
    }

    fn of(n: &Nominal<f64>) -> Self {
        Self {
            p: vector(n.position),
            v: vector(n.velocity),
            q: quaternion(n.attitude),
            bg: vector(n.gyro_bias),
            ba: vector(n.accelerometer_bias),
        }
    }
}

fn filter(gains: Gains<f64>) -> Eskf<f64> {
    let mut filter = Eskf::new(gains, &Model { gravity: G, ..Model::default() });
    filter.nominal = Exact::start().nominal();
    filter
}

fn force(t: f64) -> V {
    V::new((3.0 * t).sin(), 0.7 * (2.0 * t).cos(), 9.5 + 2.0 * (4.0 * t).sin())
}

fn rate(t: f64) -> V {
    V::new(1.5 * (5.0 * t).cos(), -0.8 * (3.0 * t).sin(), 0.6 + 0.4 * (2.0 * t).cos())
}

fn dense(p: &Covariance<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(15, 15, |i, j| p.get(i / 3, j / 3)[i % 3][j % 3])
}

fn parts(v: &DVector<f64>) -> Parts<f64> {
    core::array::from_fn(|i| core::array::from_fn(|a| v[3 * i + a]))
}

fn flat(e: &ErrorState<f64>) -> DVector<f64> {
    DVector::from_iterator(15, e.parts().into_iter().flatten())
}

/// A dense covariance with errors of very different sizes.
fn scattered(dice: &mut Dice) -> Covariance<f64> {
    let size = [0.5, 0.2, 0.05, 0.004, 0.03];
    let mut p = Covariance::diagonal(&ErrorState::from_parts(size.map(|s| [s; 3])));
    // Shears between all parts fill the matrix; it stays positive.
    for i in 0..5 {
        for j in (0..5).filter(|j| *j != i) {
            let k = 0.5 * size[i] / size[j] * dice.next();
            let mixed = core::array::from_fn(|a| {
                core::array::from_fn(|b| [k, 0.3 * k, 0.0][(b + 3 - a) % 3])
            });
            p.shear(i, j, &mixed);
        }
    }
    p
}

fn far(a: &DMatrix<f64>, b: &DMatrix<f64>) -> f64 {
    // Each number against the deviations of its row and column.
    (0..15)
        .flat_map(|i| (0..15).map(move |j| (i, j)))
        .map(|(i, j)| (a[(i, j)] - b[(i, j)]).abs() / (b[(i, i)] * b[(j, j)]).sqrt())
        .fold(0.0, f64::max)
}

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

/// The dense update in Joseph's form, about the same linearisation.
fn joseph(p: &DMatrix<f64>, rows: &[Row<f64>]) -> (DMatrix<f64>, DVector<f64>) {
    let m = rows.len();
    let h = DMatrix::from_fn(m, 15, |i, j| flat(&rows[i].gradient)[j]);
    let r = DMatrix::from_diagonal(&DVector::from_fn(m, |i, _| rows[i].variance));
    let y = DVector::from_fn(m, |i, _| rows[i].residual);
    let s = &h * p * h.transpose() + &r;
    let k = p * h.transpose() * s.clone().try_inverse().expect("positive");
    let left = DMatrix::identity(15, 15) - &k * &h;
    (&left * p * left.transpose() + &k * r * k.transpose(), k * y)
}

#[test]
fn scalar_updates_are_the_dense_joseph_update() {
    let mut dice = Dice(3);
    for case in 0..50 {
        let p = scattered(&mut dice);
        let mut gains = Gains { gate: 1e6, ..Gains::default() };
        gains.measurement_noise = 1.0;
        let mut filter = filter(gains);
        filter.covariance = p;
        let rows: Vec<Row<f64>> = (0..1 + case % 6)
            .map(|_| Row {
                gradient: ErrorState::from_parts(core::array::from_fn(|_| {
                    core::array::from_fn(|_| dice.next())
                })),
                residual: 0.01 * dice.next(),
                variance: 0.05 + 0.04 * dice.next(),
            })
            .collect();
        let (want, error) = joseph(&dense(&p), &rows);
        filter.correct(&rows, true);
        assert!(far(&dense(&filter.covariance), &want) < 1e-12, "case {case}");
        let expected = Exact::start().nominal().plus(&ErrorState::from_parts(parts(&error)));
        let off = Exact::of(&filter.nominal).minus(Exact::of(&expected)).norm();
        assert!(off < 1e-12, "case {case}: {off}");
        assert_eq!((filter.flag, filter.rejected), (0.0, 0.0));
    }
}

/// Every kind of row of a filter that looks `age` seconds back, in the order of `aiding`.
fn every_row(
    filter: &Eskf<f64>,
    lag: &Lag<f64>,
    age: f64,
    of: &Eskf<f64>,
    of_lag: &Lag<f64>,
) -> Vec<Row<f64>> {
    let (past, seen) = (filter.past(age, lag), of.past(age, of_lag));
    let field: Vec3<f64, World> = Vec3::new(0.1, 0.4, -0.8);
    let body = seen.attitude.inverse() * seen.velocity;
    let mut rows = Vec::new();
    rows.extend(past.position(seen.position, Vec3::splat(0.1)));
    rows.extend(past.velocity(seen.velocity, Vec3::splat(0.1)));
    rows.extend(past.attitude(seen.attitude, 0.1));
    rows.extend(past.flow([body.x, body.y], 0.1));
    rows.push(past.height(seen.position.z, 0.1));
    rows.push(past.heading(seen.attitude.inverse() * field, field, 0.1));
    rows
}

#[test]
fn gradients_are_the_derivatives_of_the_predicted_measurements() {
    let (f, w) = (V::new(2.0, -1.0, 11.0), V::new(0.15, -0.2, 0.1));
    // What the filter makes of the same readings, if its state is this one.
    let lag =
        |x: &Exact| Lag { acceleration: vec3(x.q * (f - x.ba) - V::z() * G), rate: vec3(w - x.bg) };
    for age in [0.0, 0.02, 0.1] {
        let guess = filter(Gains::default());
        let believed = lag(&Exact::start());
        for j in 0..15 {
            let residuals = |size: f64| {
                let mut e = DVector::zeros(15);
                e[j] = size;
                let truth = Exact::start().plus(&e);
                let mut other = guess;
                other.nominal = truth.nominal();
                every_row(&guess, &believed, age, &other, &lag(&truth))
            };
            let (plus, minus) = (residuals(1e-4), residuals(-1e-4));
            for (k, (a, b)) in plus.iter().zip(&minus).enumerate() {
                let want = (a.residual - b.residual) / 2e-4;
                let got = flat(&a.gradient)[j];
                // Exact for no delay; else second order in the angle turned meanwhile.
                let room = 1e-6 + 20.0 * (age * w.norm()).powi(2);
                assert!((got - want).abs() < room, "row {k}, error {j}, {age} s: {got} {want}");
            }
        }
    }
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

#[test]
fn the_covariance_stays_symmetric_and_positive_for_a_hundred_thousand_steps() {
    let mut filter = filter(Gains::default());
    let mut dice = Dice(4);
    for k in 1..=100_000u32 {
        let t = f64::from(k) * 1e-3;
        filter.predict(&Imu { specific_force: vec3(force(t)), rate: vec3(rate(t)) }, 1e-3);
        let fresh = k % 20 == 0;
        filter.propagate(fresh);
        if fresh {
            let past = filter.past(0.0, &Lag::default());
            let near = past.position + vec3::<World>(dice.vector() * 1e-3);
            filter.correct(&past.position(near, Vec3::splat(1e-3)), true);
        }
        if k % 5_000 == 0 {
            let p = dense(&filter.covariance);
            assert_eq!(p, p.transpose());
            let scale = DVector::from_fn(15, |i, _| 1.0 / p[(i, i)].sqrt());
            let correlations = DMatrix::from_fn(15, 15, |i, j| p[(i, j)] * scale[i] * scale[j]);
            let least = correlations.symmetric_eigenvalues().min();
            assert!(least > 1e-9, "step {k}: {least}");
        }
    }
    assert_eq!((filter.flag, filter.rejected), (0.0, 0.0));
}

fn finite(filter: &impl Record<f64>) -> bool {
    filter.sum(|x| x).is_finite()
}

#[test]
fn broken_input_is_ignored_and_flagged() {
    let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300];
    for x in bad {
        for axis in 0..6 {
            let mut filter = filter(Gains::default());
            let mut imu = Imu { specific_force: Vec3::up(G), rate: Vec3::zero() };
            let place = [
                &mut imu.specific_force.x,
                &mut imu.specific_force.y,
                &mut imu.specific_force.z,
                &mut imu.rate.x,
                &mut imu.rate.y,
                &mut imu.rate.z,
            ];
            *place.into_iter().nth(axis).expect("six") = x;
            filter.predict(&imu, 1e-3);
            assert!(finite(&filter) && filter.flag == 1.0, "{x} on {axis}");
            filter.predict(&Imu { specific_force: Vec3::up(G), rate: Vec3::zero() }, 1e-3);
            assert_eq!(filter.flag, 0.0);
        }
        let mut filter = filter(Gains::default());
        filter.predict(&filter.imu.clone(), x);
        assert!(finite(&filter) && filter.flag == 1.0, "dt {x}");

        // A measurement that is not finite is flagged, one that is only absurd is refused.
        filter.predict(&filter.imu.clone(), 1e-3);
        let past = filter.past(0.0, &Lag::default());
        let before = bits(&filter.nominal);
        filter.correct(&past.position(Vec3::splat(x), Vec3::splat(0.1)), true);
        filter.correct(&past.velocity(Vec3::splat(x), Vec3::splat(0.1)), true);
        filter.correct(&[past.height(x, 0.1)], true);
        filter.correct(&[past.heading(Vec3::splat(x), Vec3::new(0.0, 1.0, -1.0), 0.1)], true);
        filter.correct(&[past.heading(Vec3::splat(1.0), Vec3::up(1.0), 0.1)], true);
        filter.correct(&past.flow([x, x], 0.1), true);
        let q = Rotation::from_quaternion(x, x, x, x);
        filter.correct(&past.attitude(q, 0.1), true);
        assert_eq!(bits(&filter.nominal), before, "{x}");
        assert!(finite(&filter) && filter.flag == 1.0);
    }
}

#[test]
fn a_broken_state_begins_anew() {
    for x in [f64::NAN, f64::INFINITY, 1e308] {
        let numbers = bits(&filter(Gains::default())).len();
        for k in 0..numbers {
            let mut filter = filter(Gains::default());
            // Gains are settings, checked when loaded; the state is whatever memory holds.
            let mut count = 0;
            filter = Record::<f64>::zip([&filter], &mut |[y]| {
                count += 1;
                if count == k + 1 && count > 14 { x } else { y }
            });
            for _ in 0..40 {
                filter.predict(&Imu { specific_force: Vec3::up(G), rate: Vec3::zero() }, 1e-3);
                filter.propagate(false);
                let past = filter.past(0.0, &Lag::default());
                filter.correct(&past.position(Vec3::zero(), Vec3::splat(0.1)), true);
                let told = filter.tell(&Measurement::default());
                assert!(finite(&told), "{x} in number {k}");
            }
            assert!(finite(&filter), "{x} in number {k}");
        }
    }
}

#[test]
fn an_outlier_is_refused_and_counted_and_a_long_gap_opens_the_gate() {
    let gains = Gains { accelerometer_noise: 0.5, ..Gains::default() };
    let mut filter = filter(gains);
    let place = filter.nominal.position + Vec3::new(2.0, 0.0, 0.0);
    let past = filter.past(0.0, &Lag::default());
    filter.correct(&past.position(place, Vec3::splat(0.1)), true);
    assert_eq!(filter.rejected, 1.0);
    for k in 0..5_000 {
        filter.predict(&Imu { specific_force: Vec3::up(G), rate: Vec3::zero() }, 1e-3);
        filter.propagate(k == 4_999);
    }
    let place = filter.nominal.position + Vec3::new(2.0, 0.0, 0.0);
    filter.correct(&filter.past(0.0, &Lag::default()).position(place, Vec3::splat(0.1)), true);
    assert_eq!(filter.rejected, 1.0);
}

#[test]
fn eight_lanes_have_the_bits_of_eight_filters() {
    const N: usize = 8;
    let mut singles: [Eskf<f64>; N] = core::array::from_fn(|i| {
        let i = i as f64;
        let mut filter = filter(Gains {
            covariance_hz: 40.0 + 30.0 * i,
            gate: if i == 3.0 { 1.0 } else { 5.0 },
            ..Gains::default()
        });
        filter.nominal.position.x = -0.0;
        filter
    });
    let mut wide: Eskf<Lanes<f64, N>> =
        RecordExt::<f64>::gather(core::array::from_fn(|i| &singles[i]));
    let mut dice = Dice(5);
    for tick in 1..400usize {
        let imus: [Imu<f64>; N] = core::array::from_fn(|i| {
            let t = tick as f64 * 2e-3 + i as f64;
            let specific_force = vec3(force(t) + dice.vector() * 0.1);
            let mut imu = Imu { specific_force, rate: vec3(rate(t)) };
            if i == 5 && tick % 90 == 3 {
                imu.rate.y = f64::NAN;
            }
            imu
        });
        let dt: [f64; N] =
            core::array::from_fn(
                |i| if i == 2 && tick == 50 { -1.0 } else { 2e-3 + 1e-4 * i as f64 },
            );
        let fresh: [bool; N] = core::array::from_fn(|i| tick % (5 + i) == 0);
        let places: [Measurement<f64>; N] = core::array::from_fn(|i| Measurement {
            position: singles[i].nominal.position + vec3::<World>(dice.vector() * 0.1),
            attitude: singles[i].nominal.attitude,
            ..Measurement::default()
        });
        let mask = LaneMask::from_lanes(|i| fresh[i]);
        wide.predict(&RecordExt::<f64>::gather(core::array::from_fn(|i| &imus[i])), Lanes(dt));
        wide.propagate(mask);
        let all: Measurement<Lanes<f64, N>> =
            RecordExt::<f64>::gather(core::array::from_fn(|i| &places[i]));
        let lag = wide.motion;
        let past = wide.past(Lanes([0.01; N]), &lag);
        let mut rows = past.position(all.position, Vec3::splat(Lanes([0.05; N]))).to_vec();
        rows.extend(past.attitude(all.attitude, Lanes([0.01; N])));
        wide.correct(&rows, mask);
        for i in 0..N {
            let single = &mut singles[i];
            single.predict(&imus[i], dt[i]);
            single.propagate(fresh[i]);
            let past = single.past(0.01, &single.motion);
            let mut rows = past.position(places[i].position, Vec3::splat(0.05)).to_vec();
            rows.extend(past.attitude(places[i].attitude, 0.01));
            single.correct(&rows, fresh[i]);
            assert_eq!(bits(&wide.pick(i)), bits(single), "lane {i}, tick {tick}");
        }
    }
    assert!(singles[3].rejected > 0.0);
}

#[test]
fn single_precision_follows_double() {
    let mut double = filter(Gains::default());
    let mut single: Eskf<f32> = RecordExt::<f64>::cast(&double);
    let mut dice = Dice(6);
    for k in 1..=10_000u32 {
        let t = f64::from(k) * 1e-3;
        let imu = Imu { specific_force: vec3(force(t)), rate: vec3(rate(t)) };
        double.predict(&imu, 1e-3);
        single.predict(&RecordExt::<f64>::cast(&imu), 1e-3);
        double.propagate(k % 50 == 0);
        single.propagate(k % 50 == 0);
        if k % 50 == 0 {
            let near = double.nominal.position + vec3::<World>(dice.vector() * 0.01);
            double.correct(
                &double.past(0.0, &Lag::default()).position(near, Vec3::splat(0.02)),
                true,
            );
            let past = single.past(0.0, &Lag::default());
            single.correct(&past.position(RecordExt::<f64>::cast(&near), Vec3::splat(0.02)), true);
        }
    }
    let other: Eskf<f64> = RecordExt::<f32>::cast(&single);
    let off = Exact::of(&double.nominal).minus(Exact::of(&other.nominal));
    for i in 0..15 {
        let sigma = flat(&double.covariance.variances())[i].sqrt();
        assert!(off[i].abs() < 0.3 * sigma, "error {i}: {} of {sigma}", off[i]);
        let ratio = flat(&other.covariance.variances())[i].sqrt() / sigma;
        assert!((ratio - 1.0).abs() < 0.05, "error {i}: {ratio}");
    }
}

#[test]
fn the_turn_by_a_vector_is_the_exponential() {
    let mut dice = Dice(7);
    for _ in 0..1000 {
        let v = dice.vector();
        for (length, room) in [(0.1, 2e-10), (0.5, 3e-6)] {
            let v = v.normalize() * length;
            let want = UnitQuaternion::from_scaled_axis(v);
            assert!(want.angle_to(&quaternion(turn(vec3(v)).normalised())) < room);
        }
    }
}
