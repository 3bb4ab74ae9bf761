//! Updates: the dense form, and gradients of what is predicted.

use crate::oracle::{Dice, Exact, G, V, dense, far, filter, flat, parts, scattered, vec3};
use nalgebra::{DMatrix, DVector};
use stormpetrel_control::estimator::covariance::ErrorState;
use stormpetrel_control::estimator::{Eskf, Gains, Lag, Row};
use stormpetrel_control::math::{Vec3, World};

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
