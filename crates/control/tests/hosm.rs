//! The HOSM observer against theory 3.1: its table of steady errors, its orders of accuracy, the
//! half estimate of the article's doubled z2, and homogeneity.
//!
//! The measured position is the exact double integral of d = 0.8 (1 + sin t + cos t).
// Tests compare bits, take the standard library as their second opinion, and print figures as their
// source prints them.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::approx_constant, clippy::float_cmp)]

mod common;

use common::model;
use stormpetrel_control::controller::Observer;
use stormpetrel_control::math::Vec3;
use stormpetrel_control::observer::hosm::{Gains, Hosm, Input, Options, Z2};
use stormpetrel_control::signals::{Applied, Measurement};

const DURATION: f64 = 20.0;

fn disturbance(t: f64) -> f64 {
    0.8 * (1.0 + t.sin() + t.cos())
}

/// Velocity and position under the disturbance alone, from rest in the origin.
fn motion(t: f64) -> (f64, f64) {
    let v = 0.8 * (t - t.cos() + 1.0 + t.sin());
    (v, 0.8 * (t * t / 2.0 - t.sin() + t - t.cos() + 1.0))
}

fn observer(lipschitz: f64, options: Options) -> Hosm<f64> {
    Hosm::new(Gains { lipschitz, ..Gains::default() }, options, &model())
}

fn at(position: f64, velocity: f64) -> Measurement<f64> {
    Measurement {
        position: Vec3::splat(position),
        velocity: Vec3::splat(velocity),
        ..Measurement::default()
    }
}

/// Errors e0, e1, e2 at every tick.
fn errors(lipschitz: f64, dt: f64) -> Vec<[f64; 3]> {
    let mut observer = observer(lipschitz, Options::default());
    observer.reset(&at(0.0, 0.0));
    (0..(DURATION / dt).round() as u64)
        .map(|k| {
            let t = k as f64 * dt;
            let (v, x) = motion(t);
            observer.correct(&at(x, v), dt);
            let e = [observer.z0.x - x, observer.z1.x - v, observer.z2.x - disturbance(t)];
            observer.advance(&Applied::default(), dt);
            e
        })
        .collect()
}

/// Largest magnitudes in the second half.
fn steady(errors: &[[f64; 3]]) -> [f64; 3] {
    let late = &errors[errors.len() / 2..];
    [0, 1, 2].map(|i| late.iter().fold(0.0, |most: f64, e| most.max(e[i].abs())))
}

/// Total variation of the estimate's error per second, in the second half.
fn variation(errors: &[[f64; 3]]) -> f64 {
    let late = &errors[errors.len() / 2..];
    late.windows(2).map(|w| (w[1][2] - w[0][2]).abs()).sum::<f64>() / (DURATION / 2.0)
}

#[test]
fn val_the_steady_errors_are_those_of_the_table() {
    let e = errors(1.2, 2e-3);
    let [e0, e1, e2] = steady(&e);
    // Theory 3.1, row E, to the digits printed there.
    assert!((e0 / 7.1e-8 - 1.0).abs() < 0.05, "e0 {e0:e}");
    assert!((e1 / 1.95e-3 - 1.0).abs() < 0.05, "e1 {e1:e}");
    assert!((e2 / 8.3e-3 - 1.0).abs() < 0.05, "e2 {e2:e}");
    assert!((variation(&e) / 0.861 - 1.0).abs() < 0.05, "TV {}", variation(&e));
}

#[test]
fn val_chattering_grows_with_the_bound() {
    // With L = 10 at 1 ms the table's text gives e2 = 0.025 and a variation of 10.9 per second.
    let e = errors(10.0, 1e-3);
    assert!((variation(&e) / 10.9 - 1.0).abs() < 0.05, "TV {}", variation(&e));
    assert!((steady(&e)[2] / 0.025 - 1.0).abs() < 0.1, "e2 {}", steady(&e)[2]);
}

#[test]
fn the_errors_shrink_with_the_third_first_and_first_power_of_the_step() {
    let steps = [4e-3, 2e-3, 1e-3, 5e-4];
    let found = steps.map(|dt| steady(&errors(1.2, dt)));
    for (i, order) in [(0, 2.98), (1, 1.01), (2, 1.00)] {
        let points: Vec<(f64, f64)> =
            steps.iter().zip(&found).map(|(dt, e)| (dt.ln(), e[i].ln())).collect();
        let n = points.len() as f64;
        let (mx, my) = (
            points.iter().map(|p| p.0).sum::<f64>() / n,
            points.iter().map(|p| p.1).sum::<f64>() / n,
        );
        let slope = points.iter().map(|p| (p.0 - mx) * (p.1 - my)).sum::<f64>()
            / points.iter().map(|p| (p.0 - mx) * (p.0 - mx)).sum::<f64>();
        assert!((slope - order).abs() < 0.1, "e{i}: order {slope}, not {order}");
    }
}

#[test]
fn val_the_article_s_doubled_z2_estimates_half_of_the_disturbance() {
    for (z2, share) in [(Z2::Doubled, 0.5), (Z2::Single, 1.0)] {
        let mut observer = observer(1.2, Options { z2, ..Options::default() });
        observer.reset(&at(0.0, 0.0));
        let (mut along, mut square, dt) = (0.0, 0.0, 1e-3);
        for k in 0..20_000 {
            let t = f64::from(k) * dt;
            let (v, x) = motion(t);
            observer.correct(&at(x, v), dt);
            if t > 5.0 {
                along += observer.estimate().x * disturbance(t);
                square += disturbance(t) * disturbance(t);
            }
            observer.advance(&Applied::default(), dt);
        }
        let projection = along / square;
        assert!((projection - share).abs() < 1e-3, "{z2:?}: {projection}");
    }
}

/// Ticks until the homogeneous norm of the error stays below 5 % of its start, L = 1, no motion.
fn convergence(start: [f64; 3], dt: f64) -> (u32, Vec<[f64; 3]>) {
    let norm = |e: [f64; 3]| e[0].abs().cbrt() + e[1].abs().sqrt() + e[2].abs();
    let mut observer = observer(1.0, Options::default());
    [observer.z0, observer.z1, observer.z2] = start.map(Vec3::splat);
    let (mut last, mut path) = (0, Vec::new());
    for k in 0..100_000 {
        let e = [observer.z0.x, observer.z1.x, observer.z2.x];
        if norm(e) > 0.05 * norm(start) {
            last = k;
        }
        path.push(e);
        observer.correct(&at(0.0, 0.0), dt);
        observer.advance(&Applied::default(), dt);
    }
    (last + 1, path)
}

#[test]
fn errors_scaled_by_the_cube_square_and_first_power_take_so_much_longer() {
    for start in [[1.0, 0.0, 0.0], [0.3, -0.5, 0.7], [-0.1, 0.2, 1.0]] {
        let dt = 2e-4;
        let seconds = |k: f64| {
            let scaled = [start[0] * k * k * k, start[1] * k * k, start[2] * k];
            f64::from(convergence(scaled, dt).0) * dt
        };
        let once = seconds(1.0);
        for k in [0.5, 1.5, 2.0] {
            assert!((seconds(k) / once / k - 1.0).abs() < 0.01, "{start:?}, {k}: {}", seconds(k));
        }
    }
}

#[test]
fn doubling_error_and_step_alike_doubles_the_path_bit_for_bit() {
    // Scheme E is homogeneous itself, and powers of two are exact.
    let (once, path) = convergence([0.3, -0.5, 0.7], 1e-3);
    let (twice, scaled) = convergence([2.4, -2.0, 1.4], 2e-3);
    assert_eq!(once, twice);
    for (a, b) in path.iter().zip(&scaled) {
        assert_eq!([a[0] * 8.0, a[1] * 4.0, a[2] * 2.0].map(f64::to_bits), b.map(f64::to_bits));
    }
}

#[test]
fn scaling_bound_and_disturbance_alike_scales_the_path_bit_for_bit() {
    // L by 64 and d by 64: [e]^(2/3) L^(1/3), [e]^(1/2) L^(1/2) and L all grow by 64, exactly.
    let paths = [1.0, 64.0].map(|k| {
        let mut observer = observer(1.2 * k, Options::default());
        observer.reset(&at(0.0, 0.0));
        let mut path = Vec::new();
        for tick in 0..3000 {
            let (v, x) = motion(f64::from(tick) * 1e-3);
            observer.correct(&at(x * k, v * k), 1e-3);
            observer.advance(&Applied::default(), 1e-3);
            path.push([observer.z0.x / k, observer.z1.x / k, observer.z2.x / k].map(f64::to_bits));
        }
        path
    });
    assert!(paths[0] == paths[1]);
}

#[test]
fn the_input_option_chooses_which_acceleration_is_known() {
    let applied = Applied { commanded: Vec3::splat(3.0), measured: Vec3::new(-1.0, -2.0, -4.0) };
    let dt = 1e-3;
    for (input, want) in [(Input::Measured, [-1.0, -2.0, -4.0]), (Input::Commanded, [3.0; 3])] {
        let mut observer = observer(1.2, Options { input, ..Options::default() });
        observer.reset(&at(0.0, 0.0));
        observer.correct(&at(0.0, 0.0), dt);
        // All errors are zero: z1 moves by u dt alone.
        observer.advance(&applied, dt);
        let z1 = observer.z1;
        assert_eq!([z1.x, z1.y, z1.z], want.map(|u| u * dt), "{input:?}");
    }
}
