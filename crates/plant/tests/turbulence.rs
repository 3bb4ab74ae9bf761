//! Random disturbances against their theory: discrete matrices, variance, correlation, spectrum.
// Tests take the standard library as their second opinion.
#![allow(clippy::pedantic, clippy::disallowed_methods)]

mod common;

use std::f64::consts::PI;

use common::{Scene, bits, named, world};
use stormpetrel_control::math::{Vec3, World};
use stormpetrel_plant::disturbance::dryden::{self, Lateral, Longitudinal};
use stormpetrel_plant::disturbance::{
    self, DisturbanceSettings, Site, Source, SourceSettings, Window, noise,
};

/// Without optimisation a tenth of the flights must do, and the bounds are wider by the square root of ten.
const THIN: u64 = if cfg!(debug_assertions) { 10 } else { 1 };
/// Widening of the bounds.
const WIDE: f64 = if cfg!(debug_assertions) { 3.2 } else { 1.0 };

const STEPS: [f64; 3] = [0.5e-3, 2e-3, 10e-3];

type M2 = [[f64; 2]; 2];

fn mul(a: M2, b: M2) -> M2 {
    std::array::from_fn(|i| std::array::from_fn(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j]))
}

/// exp(A t) from its series.
fn exponential(a: M2, t: f64) -> M2 {
    let at = a.map(|row| row.map(|x| x * t));
    let mut term = [[1.0, 0.0], [0.0, 1.0]];
    let mut sum = term;
    for k in 1..40 {
        term = mul(term, at).map(|row| row.map(|x| x / k as f64));
        sum = std::array::from_fn(|i| std::array::from_fn(|j| sum[i][j] + term[i][j]));
    }
    sum
}

/// Five nodes and weights of Gauss and Legendre on -1..1.
fn gauss() -> [(f64, f64); 5] {
    let (root, w) = ((10.0f64 / 7.0).sqrt(), 13.0 * 70.0f64.sqrt());
    let (a, b) = ((5.0 - 2.0 * root).sqrt() / 3.0, (5.0 + 2.0 * root).sqrt() / 3.0);
    let (wa, wb) = ((322.0 + w) / 900.0, (322.0 - w) / 900.0);
    [(0.0, 128.0 / 225.0), (a, wa), (-a, wa), (b, wb), (-b, wb)]
}

/// Covariance of a step from the integral of exp(A s) B B^T exp(A s)^T.
fn covariance(a: M2, b: [f64; 2], step: f64) -> M2 {
    let mut q = [[0.0; 2]; 2];
    const PANELS: usize = 20;
    for panel in 0..PANELS {
        for (node, weight) in gauss() {
            let h = step / PANELS as f64;
            let s = h * (panel as f64 + (1.0 + node) / 2.0);
            let e = exponential(a, s);
            let v = [e[0][0] * b[0] + e[0][1] * b[1], e[1][0] * b[0] + e[1][1] * b[1]];
            for i in 0..2 {
                for j in 0..2 {
                    q[i][j] += weight * h / 2.0 * v[i] * v[j];
                }
            }
        }
    }
    q
}

#[test]
fn the_lateral_step_has_the_transition_and_covariance_of_its_equation() {
    for (a, s) in [(0.05f64, 0.4), (0.31, 1.7), (4.0, 0.9)] {
        for step in STEPS {
            // In the coordinates of the code: X1' = a X2, X2' = -a X1 - 2 a X2 + s sqrt(a) n.
            let (matrix, input) = ([[0.0, a], [-a, -2.0 * a]], [0.0, s * a.sqrt()]);
            let lateral = Lateral::new(a, s, step);
            let want = exponential(matrix, step);
            for i in 0..2 {
                for j in 0..2 {
                    assert!((lateral.transition[i][j] - want[i][j]).abs() < 1e-12, "{a} {step}");
                }
            }
            let [l11, l21, l22] = lateral.factor;
            let q = covariance(matrix, input, step);
            let got = [[l11 * l11, l11 * l21], [l11 * l21, l21 * l21 + l22 * l22]];
            for i in 0..2 {
                for j in 0..2 {
                    let scale = (q[i][i] * q[j][j]).sqrt();
                    let error = (got[i][j] - q[i][j]).abs() / scale;
                    assert!(error < 1e-12, "a = {a}, dt = {step}, Q{i}{j}: {error:e}");
                }
            }
        }
    }
}

#[test]
fn the_longitudinal_step_has_the_transition_and_variance_of_its_equation() {
    for (a, s) in [(0.05f64, 0.4), (0.31, 1.7), (4.0, 0.9)] {
        for step in STEPS {
            let one = Longitudinal::new(a, s, step);
            assert!((one.keep - (-a * step).exp()).abs() < 1e-14);
            let variance = s * s * -(-2.0 * a * step).exp_m1();
            assert!((one.fresh * one.fresh / variance - 1.0).abs() < 1e-12, "{a} {step}");
        }
    }
}

#[test]
fn scales_and_intensities_are_those_of_the_specification() {
    // MIL-F-8785C at 100 ft with 30 kn at 20 ft: Lw = 100 ft, Lu = 100/(0.2593)^1.2 ft, sw = 3 kn.
    let knot = 1852.0 / 3600.0;
    let ([lu, lw], [su, sw]) = dryden::scales(30.48, 30.0 * knot);
    assert!((lw - 30.48).abs() < 1e-12);
    assert!((lu - 30.48 / 0.2593f64.powf(1.2)).abs() < 1e-11);
    assert!((sw - 3.0 * knot).abs() < 1e-12);
    assert!((su - 3.0 * knot / 0.2593f64.powf(0.4)).abs() < 1e-12);
    // At 1000 ft all three are the same.
    let ([lu, lw], [su, sw]) = dryden::scales(304.8, 10.0);
    assert!((lu / lw - 1.0).abs() < 1e-12 && (su / sw - 1.0).abs() < 1e-12);
}

fn build(what: DisturbanceSettings, step: f64, key: u64) -> Source<f64> {
    let site = Site { vehicle: Scene::default().vehicle, step, key };
    SourceSettings { window: Window::default(), what }.build(&site)
}

const MEAN: f64 = 12.0;
const HEIGHT: f64 = 20.0;

fn turbulence(step: f64, key: u64) -> Source<f64> {
    let gains =
        dryden::Gains { mean: world(0.0, MEAN, 0.0), height: HEIGHT, ..dryden::Gains::default() };
    build(DisturbanceSettings::Dryden(gains, ()), step, key)
}

/// Components u, v, w of the turbulence: u along the wind (here y), v to its left (-x), w up.
fn components(wind: Vec3<f64, World>) -> [f64; 3] {
    [wind.y - MEAN, -wind.x, wind.z]
}

fn at(tick: usize, step: f64) -> disturbance::Scene<f64> {
    let (tick, step) = (tick as f64, step);
    disturbance::Scene { tick, time: tick * step, step, ..disturbance::Scene::default() }
}

fn deviations() -> [f64; 3] {
    let (_, [su, sw]) = dryden::scales(HEIGHT, MEAN);
    [su, su, sw]
}

#[test]
fn the_variance_is_that_of_the_specification_at_every_time_and_for_every_step() {
    const STARTS: u64 = 220_000 / THIN;
    for step in STEPS {
        let mut squares = [[0.0; 3]; 2];
        for key in 0..STARTS {
            let mut source = turbulence(step, key);
            for tick in 0..3 {
                let found = components(source.wind(&at(tick, step)));
                if tick != 1 {
                    for axis in 0..3 {
                        squares[tick / 2][axis] += found[axis] * found[axis];
                    }
                }
            }
        }
        for sums in squares {
            for (sum, s) in sums.iter().zip(deviations()) {
                // 99.9 % of such samples lie within 1 %.
                let ratio = sum / STARTS as f64 / (s * s);
                assert!((ratio - 1.0).abs() < 0.02 * WIDE, "dt = {step}: {ratio}");
            }
        }
    }
}

#[test]
fn correlation_in_time_is_that_of_the_specification() {
    let (flights, step) = (20_000 / THIN, 0.05);
    let lags = [4usize, 12, 24, 40];
    let mut sums = [[0.0; 3]; 4];
    for key in 0..flights {
        let mut source = turbulence(step, key);
        let first = components(source.wind(&at(0, step)));
        for tick in 1..=lags[3] {
            let now = components(source.wind(&at(tick, step)));
            if let Some(row) = lags.iter().position(|lag| *lag == tick) {
                for axis in 0..3 {
                    sums[row][axis] += first[axis] * now[axis];
                }
            }
        }
    }
    let ([lu, lw], _) = dryden::scales(HEIGHT, MEAN);
    for (lag, row) in lags.iter().zip(sums) {
        let t = *lag as f64 * step;
        let (a, aw) = (MEAN / lu, MEAN / lw);
        let want = [
            (-a * t).exp(),
            (-a * t).exp() * (1.0 - a * t / 2.0),
            (-aw * t).exp() * (1.0 - aw * t / 2.0),
        ];
        for axis in 0..3 {
            let found = row[axis] / flights as f64 / deviations()[axis].powi(2);
            // Four standard errors of a correlation over so many flights are 3 %.
            assert!(
                (found - want[axis]).abs() < 0.05 * WIDE,
                "{axis}, {t} s: {found} {}",
                want[axis]
            );
        }
    }
}

#[test]
fn the_spectrum_is_that_of_the_specification() {
    const SAMPLES: usize = 2048;
    const FLIGHTS: u64 = 3000 / THIN;
    let step = 0.02;
    let length = SAMPLES as f64 * step;
    let ([lu, lw], _) = dryden::scales(HEIGHT, MEAN);
    let orders = [6usize, 12, 24, 60];
    let mut power = [[0.0; 3]; 4];
    let hann: Vec<f64> = (0..SAMPLES)
        .map(|k| (8.0f64 / 3.0).sqrt() * (PI * k as f64 / SAMPLES as f64).sin().powi(2))
        .collect();
    for key in 0..FLIGHTS {
        let mut source = turbulence(step, key);
        let mut sums = [[[0.0; 2]; 3]; 4];
        for (tick, window) in hann.iter().enumerate() {
            let found = components(source.wind(&at(tick, step)));
            for (row, order) in orders.iter().enumerate() {
                let angle = 2.0 * PI * (order * tick % SAMPLES) as f64 / SAMPLES as f64;
                let (sin, cos) = angle.sin_cos();
                for axis in 0..3 {
                    sums[row][axis][0] += window * found[axis] * cos;
                    sums[row][axis][1] += window * found[axis] * sin;
                }
            }
        }
        for row in 0..4 {
            for axis in 0..3 {
                let [c, s] = sums[row][axis];
                power[row][axis] += (c * c + s * s) * step * step / length / FLIGHTS as f64;
            }
        }
    }
    for (order, row) in orders.iter().zip(power) {
        let w = 2.0 * PI * *order as f64 / length;
        for axis in 0..3 {
            let s = deviations()[axis];
            let l = [lu, lu, lw][axis];
            let x = (l * w / MEAN).powi(2);
            // One-sided in w, as theory 3.7 has it; a two-sided one in frequency is pi times that.
            let shape =
                if axis == 0 { 2.0 / (1.0 + x) } else { (1.0 + 3.0 * x) / (1.0 + x).powi(2) };
            let want = s * s * l / (PI * MEAN) * shape * PI;
            let ratio = row[axis] / want;
            assert!((ratio - 1.0).abs() < 0.05 * WIDE, "axis {axis}, {w:.2} rad/s: {ratio}");
        }
    }
}

#[test]
fn filtered_noise_has_its_variance_and_its_correlation_time() {
    let gains =
        noise::Gains { force: world(2.0, 0.0, 0.5), time_constant: 0.3, ..Default::default() };
    const STARTS: u64 = 220_000 / THIN;
    for step in STEPS {
        let (mut first, mut last, mut both) = (0.0, 0.0, 0.0);
        for key in 0..STARTS {
            let mut source = build(DisturbanceSettings::Noise(gains, ()), step, key);
            let a = source.push(&at(0, step)).force.x;
            source.push(&at(1, step));
            let b = source.push(&at(2, step)).force.x;
            (first, last, both) = (first + a * a, last + b * b, both + a * b);
        }
        let n = STARTS as f64 * 4.0;
        assert!(
            (first / n - 1.0).abs() < 0.02 * WIDE && (last / n - 1.0).abs() < 0.02 * WIDE,
            "dt = {step}"
        );
        assert!((both / n - (-2.0 * step / 0.3).exp()).abs() < 0.02 * WIDE, "dt = {step}");
    }
}

#[test]
fn streams_do_not_know_of_each_other() {
    let mut alone = turbulence(1.0, 7);
    let mut again = turbulence(1.0, 7);
    let mut neighbour = build(named("noise"), 1.0, 7);
    let mut other = turbulence(1.0, 8);
    let (mut same, mut cross, mut square) = (0, 0.0, 0.0);
    for tick in 0..20_000 {
        let scene = at(tick, 1.0);
        let a = alone.wind(&scene);
        neighbour.push(&scene);
        let b = again.wind(&scene);
        let c = other.wind(&scene);
        assert_eq!(bits(&a), bits(&b));
        same += usize::from(a.z == c.z);
        (cross, square) = (cross + a.z * c.z, square + a.z * a.z);
    }
    assert_eq!(same, 0, "two keys draw the same numbers");
    assert!(cross.abs() < 0.05 * square, "{cross} {square}");
}
