//! Lanes, single precision and the turn by a vector.

use crate::common::bits;
use crate::oracle::{Dice, Exact, filter, flat, force, quaternion, rate, vec3};
use nalgebra::UnitQuaternion;
use stormpetrel_control::estimator::{Eskf, Gains, Imu, Lag, turn};
use stormpetrel_control::lanes::{LaneMask, Lanes};
use stormpetrel_control::math::{Vec3, World};
use stormpetrel_control::real::Mask;
use stormpetrel_control::record::RecordExt;
use stormpetrel_control::signals::Measurement;

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
