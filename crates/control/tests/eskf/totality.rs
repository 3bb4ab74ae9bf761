//! What no input breaks.

use crate::common::bits;
use crate::oracle::{Dice, G, dense, filter, force, rate, vec3};
use nalgebra::{DMatrix, DVector};
use stormpetrel_control::estimator::{Gains, Imu, Lag};
use stormpetrel_control::math::{Rotation, Vec3, World};
use stormpetrel_control::record::Record;
use stormpetrel_control::signals::Measurement;

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
