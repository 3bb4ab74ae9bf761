//! Noise, biases, steps and ranges.

use std::f64::consts::TAU;

use crate::common::{body, world};
use crate::rig::{channel, gyro, ideal, samples, still, timed, variance};
use stormpetrel_control::math::{Body, Rotation, Vec3};
use stormpetrel_plant::sensor::link::Timing;
use stormpetrel_plant::sensor::{Sensor, SensorSettings, Truth, barometer, gnss, gyro};
use stormpetrel_plant::state::State;

#[test]
fn the_variance_of_white_noise_is_its_density_squared_over_the_period() {
    for (rate_hz, dt) in [(1000.0, 1e-3), (250.0, 1e-3), (1000.0, 4e-3)] {
        let density = 0.02;
        let mut one =
            channel(gyro(gyro::Gains { noise: density, rate_hz, ..ideal() }), 1, &still());
        let period = (1.0 / (rate_hz * dt)).round().max(1.0);
        let got = samples(&mut one, 70_000 * period as u64, dt, |_| still());
        assert_eq!(got.len(), 70_000);
        let mut all = Vec::new();
        for axis in 0..3 {
            let truth = [0.1, -0.2, 0.3][axis];
            let x: Vec<f64> = got.iter().map(|(_, s)| s.values[axis] - truth).collect();
            // One sample knows nothing of the next: the correlation is zero within four deviations.
            let next = x.windows(2).map(|w| w[0] * w[1]).sum::<f64>() / x.len() as f64;
            assert!((next / variance(&x)).abs() < 4.0 / (x.len() as f64).sqrt());
            all.extend(x);
        }
        let ratio = variance(&all) * period * dt / (density * density);
        assert!((ratio - 1.0).abs() < 0.02, "{rate_hz} Hz, {dt} s: {ratio}");
    }
}

#[test]
fn the_variance_of_a_bias_grows_with_time() {
    let (walk, dt, flights) = (0.3, 0.01, 1000);
    let mut at = [const { Vec::new() }; 4];
    for flight in 0..flights {
        let gains = gyro::Gains { walk, bias_sigma: 0.7, rate_hz: 50.0, ..ideal() };
        let mut one = channel(gyro(gains), 100 + flight, &Truth::default());
        let Sensor::Gyro(begun) = one.sensor else { panic!("a gyro") };
        let start = [begun.triad.bias.x, begun.triad.bias.y, begun.triad.bias.z];
        at[0].extend(start);
        let got = samples(&mut one, 399, dt, |_| Truth::default());
        // The first sample has walked one period already.
        for (k, n) in [(1, 50), (2, 100), (3, 200)] {
            at[k].extend((0..3).map(|axis| got[n - 1].1.values[axis] - start[axis]));
        }
    }
    // A variance from 3000 numbers is known to 2.6 %.
    assert!((variance(&at[0]) / 0.49 - 1.0).abs() < 0.1);
    for (k, t) in [(1, 1.0), (2, 2.0), (3, 4.0)] {
        let ratio = variance(&at[k]) / (walk * walk * t);
        assert!((ratio - 1.0).abs() < 0.1, "{t} s: {ratio}");
    }
}

#[test]
fn steps_and_range_are_exact() {
    let gains = gyro::Gains { resolution: 0.125, range: 1.0, ..ideal() };
    let mut one = channel(gyro(gains), 1, &Truth::default());
    let sweep = |tick: u64| {
        let x = (tick as f64 - 1000.0) / 500.0;
        let state = State { rate: body(x, -x, 10.0 * x), ..State::default() };
        Truth { state, ..Truth::default() }
    };
    for (tick, sample) in samples(&mut one, 2001, 1e-3, sweep) {
        let rate = sweep(tick).state.rate;
        for (got, x) in sample.values.into_iter().zip([rate.x, rate.y, rate.z]) {
            assert_eq!((got / 0.125).fract(), 0.0);
            assert!(got.abs() <= 1.0);
            let wrong = (got - x.clamp(-1.0, 1.0)).abs();
            assert!(wrong <= 0.0625, "{x}: {got}");
            assert!(x.abs() < 1.0 || got == x.signum(), "{x}: {got}");
        }
    }
}

#[test]
fn the_low_pass_has_the_step_response_of_one_pole() {
    let (cutoff_hz, dt) = (20.0, 1e-3);
    let mut one = channel(gyro(gyro::Gains { cutoff_hz, ..ideal() }), 1, &Truth::default());
    let state = State { rate: body(1.0, -2.0, 0.5), ..State::default() };
    for (tick, sample) in samples(&mut one, 100, dt, |_| Truth { state, ..Truth::default() }) {
        let want = 1.0 - (-TAU * cutoff_hz * dt * (tick + 1) as f64).exp();
        assert!(
            (sample.values[0] - want).abs() < 1e-13
                && (sample.values[1] + 2.0 * want).abs() < 1e-13
        );
    }
}

/// Each value of a sensor at rest, less what it should be, over its declared deviation.
fn scaled(settings: SensorSettings, truth: [f64; 7], sigma: [f64; 7]) -> Vec<Vec<f64>> {
    let mut one = channel(settings, 5, &still());
    let got = samples(&mut one, 20_000, 1e-3, |_| still());
    (0..7)
        .filter(|k| sigma[*k] > 0.0)
        .map(|k| got.iter().map(|(_, s)| (s.values[k] - truth[k]) / sigma[k]).collect())
        .collect()
}

#[test]
fn every_aiding_sensor_errs_by_its_declared_deviation() {
    let all = Timing { rate_hz: 1000.0, ..Timing::default() };
    let state = still().state;
    let q = state.attitude;
    let (p, v) = (state.position, state.velocity);
    let (u, m) = (q.inverse() * v, q.inverse() * world(0.0, 2e-5, -4.5e-5));
    let [w0, w1, w2, w3] = state.rotor_speed;
    let g = gnss::Gains::<f64>::default();
    let cases = [
        (
            "gnss",
            [p.x, p.y, p.z, v.x, v.y, v.z, 0.0],
            [g.horizontal_noise, g.horizontal_noise, g.vertical_noise, 0.05, 0.05, 0.05, 0.0],
        ),
        (
            "optical-flow",
            [u.x, u.y, p.z, 0.0, 0.0, 0.0, 0.0],
            [0.05, 0.05, 0.02, 0.0, 0.0, 0.0, 0.0],
        ),
        (
            "magnetometer",
            [m.x, m.y, m.z, 0.0, 0.0, 0.0, 0.0],
            [3e-7, 3e-7, 3e-7, 0.0, 0.0, 0.0, 0.0],
        ),
        ("barometer", [p.z, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], [0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
        ("rotor-speed", [w0, w1, w2, w3, 0.0, 0.0, 0.0], [2.0, 2.0, 2.0, 2.0, 0.0, 0.0, 0.0]),
        (
            "motion-capture",
            [p.x, p.y, p.z, q.w, q.x, q.y, q.z],
            [1e-3, 1e-3, 1e-3, 0.0, 0.0, 0.0, 0.0],
        ),
    ];
    for (kind, truth, sigma) in cases {
        let values = scaled(timed(kind, all), truth, sigma);
        for (k, x) in values.iter().enumerate() {
            let n = x.len() as f64;
            let mean = x.iter().sum::<f64>() / n;
            // Rotor speeds come in steps of 1 rad/s: a twelfth more variance.
            let want = if kind == "rotor-speed" { 1.0 + 1.0 / 48.0 } else { 1.0 };
            assert!(mean.abs() < 4.5 / n.sqrt(), "{kind} {k}: mean {mean}");
            assert!((variance(x) / want - 1.0).abs() < 4.5 * (2.0 / n).sqrt(), "{kind} {k}");
            for (other, y) in values.iter().enumerate().filter(|(other, _)| *other > k) {
                let both = x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>() / n;
                assert!(both.abs() < 4.5 / n.sqrt(), "{kind}: {k} and {other}");
            }
        }
    }
    // The attitude of the cameras turns about each body axis.
    let mut one = channel(timed("motion-capture", all), 6, &still());
    let got = samples(&mut one, 20_000, 1e-3, |_| still());
    let wrong: Vec<Vec3<f64, Body>> = got
        .iter()
        .map(|(_, s)| {
            let [.., w, x, y, z] = s.values;
            let e: Rotation<f64, Body, Body> = q.inverse() * Rotation::from_quaternion(w, x, y, z);
            e.shortest().vector() * 2.0
        })
        .collect();
    for axis in [|v: &Vec3<f64, Body>| v.x, |v: &Vec3<f64, Body>| v.y, |v: &Vec3<f64, Body>| v.z] {
        let x: Vec<f64> = wrong.iter().map(axis).collect();
        assert!((variance(&x) / 2.5e-5 - 1.0).abs() < 0.05);
    }
}

#[test]
fn the_drift_of_a_barometer_is_exponentially_correlated() {
    let gains = barometer::Gains {
        noise: 0.0,
        drift: 2.0,
        drift_time: 0.5,
        rate_hz: 100.0,
        ..barometer::Gains::default()
    };
    let mut one = channel(SensorSettings::Barometer(gains, ()), 7, &Truth::default());
    let x: Vec<f64> = samples(&mut one, 200_000, 1e-2, |_| Truth::default())
        .iter()
        .map(|(_, s)| s.values[0])
        .collect();
    // 2000 s of 0.5 s each: some 2000 independent numbers.
    assert!((variance(&x) / 4.0 - 1.0).abs() < 0.15, "{}", variance(&x));
    for lag in [10, 50, 100] {
        let pairs = x.iter().zip(&x[lag..]);
        let got = pairs.map(|(a, b)| a * b).sum::<f64>() / x.len() as f64 / variance(&x);
        let want = (-(lag as f64) * 0.01 / 0.5).exp();
        assert!((got - want).abs() < 0.08, "{lag}: {got} {want}");
    }
}
