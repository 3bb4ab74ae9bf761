//! The Butterworth filter against the analytic magnitude of its bilinear form.
//!
//! With w = tan(pi f T)/tan(pi f_c T):  |H(f)|^2 = 1/(1 + w^4)  (Butterworth, order 2, prewarped).
// Tests compare bits, take the standard library as their second opinion, and print figures as their
// source prints them.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::approx_constant, clippy::float_cmp)]

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use stormpetrel_control::filter::Butterworth;
use stormpetrel_control::math::Vec3;

/// The impulse response, until nothing is left of it; each axis has its own height.
fn impulse_response(
    cutoff_hz: f64,
    sample_time: f64,
) -> Vec<Vec3<f64, stormpetrel_control::math::Body>> {
    let mut filter = Butterworth::default();
    let length = (40.0 / (cutoff_hz * sample_time)) as usize;
    (0..length)
        .map(|k| {
            filter.tune(cutoff_hz, sample_time);
            filter.update(if k == 0 { Vec3::new(1.0, -2.0, 0.5) } else { Vec3::zero() })
        })
        .collect()
}

/// Magnitude of the discrete-time Fourier transform at `f` Hz.
fn magnitude(response: impl Iterator<Item = f64>, f: f64, sample_time: f64) -> f64 {
    let (re, im) = response.enumerate().fold((0.0, 0.0), |(re, im), (k, h)| {
        let (sin, cos) = (2.0 * PI * f * sample_time * k as f64).sin_cos();
        (re + h * cos, im - h * sin)
    });
    f64::hypot(re, im)
}

const CASES: [(f64, f64); 4] = [(50.0, 1e-3), (8.0, 2e-3), (200.0, 1e-3), (15.0, 1.25e-4)];

#[test]
fn a_constant_passes_unchanged() {
    for (cutoff, t) in CASES {
        // 1 + a1 + a2 = 4 K^2 n cancels: the coefficients' own rounding shows divided by K^2.
        let room = 1e-15 / (PI * cutoff * t).powi(2);
        let sum = impulse_response(cutoff, t).into_iter().fold(Vec3::zero(), |sum, h| sum + h);
        assert!((sum.x - 1.0).abs() < room, "{cutoff} Hz: {}", sum.x - 1.0);
        assert!((sum.y + 2.0).abs() < 2.0 * room && (sum.z - 0.5).abs() < room, "{cutoff} Hz");
    }
}

#[test]
fn half_of_the_power_passes_at_the_cutoff() {
    for (cutoff, t) in CASES {
        let gain = magnitude(impulse_response(cutoff, t).iter().map(|h| h.x), cutoff, t);
        assert!((gain - FRAC_1_SQRT_2).abs() < 1e-12, "{cutoff} Hz: {gain}");
    }
}

#[test]
fn the_magnitude_is_that_of_the_bilinear_form_at_every_frequency() {
    for (cutoff, t) in CASES {
        let h = impulse_response(cutoff, t);
        for share in [0.02, 0.1, 0.3, 0.6, 0.9] {
            let f = share * 0.5 / t; // of half the sample rate
            let w = (PI * f * t).tan() / (PI * cutoff * t).tan();
            let want = 1.0 / (1.0 + w.powi(4)).sqrt();
            let gain = magnitude(h.iter().map(|h| h.y), f, t) / 2.0;
            assert!((gain - want).abs() < 1e-12, "{cutoff} Hz at {f} Hz: {gain}, not {want}");
        }
    }
}

#[test]
fn nothing_passes_at_half_the_sample_rate() {
    let h = impulse_response(50.0, 1e-3);
    assert!(magnitude(h.iter().map(|h| h.x), 500.0, 1e-3) < 1e-12);
}

#[test]
fn a_new_sample_time_brings_new_coefficients() {
    let mut filter = Butterworth::<f64>::default();
    filter.tune(50.0, 1e-3);
    let first = filter.b0;
    filter.tune(50.0, 2e-3);
    // K = tan(pi f_c T), b0 = K^2/(1 + sqrt2 K + K^2)
    let b0 = |t: f64| {
        let k = (PI * 50.0 * t).tan();
        k * k / (1.0 + 2f64.sqrt() * k + k * k)
    };
    assert!((first / b0(1e-3) - 1.0).abs() < 1e-14);
    assert!((filter.b0 / b0(2e-3) - 1.0).abs() < 1e-14);
}

#[test]
fn a_cutoff_beyond_the_sample_rate_leaves_a_stable_filter() {
    for cutoff in [490.0, 500.0, 1e4, 1e300] {
        let mut filter = Butterworth::<f64>::default();
        filter.tune(cutoff, 1e-3);
        // Jury's conditions for z^2 + a1 z + a2: |a2| < 1 and |a1| < 1 + a2.
        assert!(filter.a2.abs() < 1.0 && filter.a1.abs() < 1.0 + filter.a2, "{cutoff} Hz");
    }
}
