//! Sets of sensors, lanes, broken truths, and what a vehicle does to them.

use std::f64::consts::TAU;

use crate::common::{bits, body, named};
use crate::rig::{ALL, clock, height, samples, sensing, still, sway, timed};
use stormpetrel_control::lanes::Lanes;
use stormpetrel_control::record::{Record, RecordExt};
use stormpetrel_control::registry::Settings;
use stormpetrel_plant::actuation::ActuationSettings;
use stormpetrel_plant::sensor::link::Timing;
use stormpetrel_plant::sensor::{
    Fault, Sensing, Sensor, SensorSettings, Truth, accelerometer, check, magnetometer,
    motion_capture, optical_flow, rotor_speed,
};
use stormpetrel_plant::state::State;
use stormpetrel_plant::vehicle::Vehicle;

#[test]
fn another_sensor_does_not_change_the_numbers_of_the_first() {
    let pick = |kinds: &[&str]| kinds.iter().map(|kind| named(kind)).collect::<Vec<_>>();
    let mut few = sensing(&pick(&["gyro", "gnss"]), 11);
    let mut more =
        sensing(&pick(&["barometer", "gnss", "accelerometer", "gyro", "motion-capture"]), 11);
    let mut other = sensing(&pick(&["gyro", "gnss"]), 12);
    for one in [&mut few, &mut more, &mut other] {
        one.begin(&sway(0));
    }
    let mut differs = false;
    for tick in 0..500 {
        for one in [&mut few, &mut more, &mut other] {
            one.measure(&sway(tick), tick as f64, 1e-3);
        }
        assert_eq!(bits(&few.channels[0].sensor), bits(&more.channels[3].sensor), "tick {tick}");
        assert_eq!(bits(&few.imu.rate), bits(&more.imu.rate), "tick {tick}");
        assert_eq!(bits(&few.channels[1].link), bits(&more.channels[1].link), "tick {tick}");
        differs |= bits(&few.imu.rate) != bits(&other.imu.rate);
    }
    assert!(differs, "another seed, other numbers");

    // Two of a kind have numbers of their own.
    let mut two = sensing(&pick(&["gnss", "gnss"]), 11);
    two.begin(&sway(0));
    assert_ne!(bits(&two.channels[0].link.stream), bits(&two.channels[1].link.stream));
}

#[test]
fn eight_lanes_have_the_bits_of_eight_single_flights() {
    const N: usize = 8;
    let build = |i: usize| {
        let x = i as f64;
        let kinds: Vec<SensorSettings> = ALL
            .iter()
            .enumerate()
            .map(|(k, kind)| {
                let rate_hz = [1000.0, 500.0, 250.0, 100.0, 10.0, 50.0, 40.0, 25.0][(i + k) % 8];
                timed(
                    kind,
                    Timing {
                        rate_hz,
                        latency: if (i + k) % 3 == 0 {
                            0.0
                        } else {
                            (i % 4) as f64 * 1.3 / rate_hz
                        },
                        jitter: if (i + k) % 4 == 0 { 0.7 / rate_hz } else { 0.0 },
                        dropout: if k % 2 == 0 { 0.05 * x } else { 0.0 },
                    },
                )
            })
            .collect();
        let mut one = sensing(&kinds, 40 + i as u64);
        for channel in &mut one.channels {
            if let (Sensor::Accelerometer(sensor), true) = (&mut channel.sensor, i % 2 == 0) {
                sensor.triad.errors.vibration = 1e-7 * x;
            }
        }
        one.filter.gains.covariance_hz = 50.0 + 20.0 * x;
        one.begin(&truth(i, 0));
        one
    };
    fn truth(i: usize, tick: u64) -> Truth<f64> {
        let mut truth = sway(tick + 300 * i as u64);
        if i == 4 {
            truth.state.position.z = -0.0;
            truth.state.rate.x = -0.0;
        }
        if i == 5 && (200..204).contains(&tick) {
            truth.state.velocity.y = f64::NAN;
        }
        truth
    }
    let dt = |i: usize, tick: u64| match (i, tick) {
        (6, 150..) => 2e-3,
        (3, 77) => f64::NAN,
        _ => 1e-3,
    };
    let mut singles: [Sensing<f64>; N] = core::array::from_fn(build);
    let mut wide: Sensing<Lanes<f64, N>> =
        RecordExt::<f64>::gather(core::array::from_fn(|i| &singles[i]));
    for tick in 0..600 {
        let truths: [Truth<f64>; N] = core::array::from_fn(|i| truth(i, tick));
        let gathered = RecordExt::<f64>::gather(core::array::from_fn(|i| &truths[i]));
        let steps = Lanes(core::array::from_fn(|i| dt(i, tick)));
        let told = wide.measure(&gathered, Lanes([tick as f64; N]), steps);
        for i in 0..N {
            let one = singles[i].measure(&truths[i], tick as f64, dt(i, tick));
            assert_eq!(bits(&told.pick(i)), bits(&one), "lane {i}, tick {tick}");
            assert_eq!(bits(&wide.pick(i)), bits(&singles[i]), "lane {i}, tick {tick}");
        }
    }
}

/// The record with `x` in place of its `k`-th number.
fn with<R: Record<f64, With<f64> = R>>(record: &R, k: usize, x: f64) -> R {
    let mut count = 0;
    R::zip([record], &mut |[y]| {
        count += 1;
        if count == k + 1 { x } else { y }
    })
}

#[test]
fn a_broken_truth_never_gets_through() {
    let kinds: Vec<SensorSettings> = ALL.iter().map(|kind| named(kind)).collect();
    for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
        for k in 0..bits(&still()).len() {
            let mut one = sensing(&kinds, 9);
            one.begin(&still());
            for tick in 0..60 {
                let broken = (20..31).contains(&tick);
                let truth = if broken { with(&still(), k, x) } else { still() };
                let told = one.measure(&truth, tick as f64, 1e-3);
                assert!(told.sum(|x| x).is_finite(), "{x} in {k}, tick {tick}");
                let flagged = one.flag == 1.0;
                assert!(!broken || x.is_finite() || flagged, "{x} in {k}: no flag");
                // The last broken sample arrives ten ticks late.
                assert!((20..41).contains(&tick) || !flagged, "{x} in {k}: flag at tick {tick}");
            }
            assert!(one.sum(|x| x).is_finite() || x == 1e300, "{x} in {k}");
        }
        let mut one = sensing(&kinds, 9);
        one.begin(&with(&still(), 5, x));
        assert!(one.measure(&still(), 0.0, x).sum(|x| x).is_finite());
        assert_eq!(one.flag, 1.0, "dt {x}");
    }
}

#[test]
fn an_unbalanced_rotor_shakes_at_its_own_frequency() {
    let (dt, speed, amplitude) = (1e-3, TAU * 50.0, 2e-5);
    let gains = accelerometer::Gains {
        noise: 0.0,
        walk: 0.0,
        bias_sigma: 0.0,
        resolution: 0.0,
        cutoff_hz: 1e6,
        vibration: amplitude,
        ..accelerometer::Gains::default()
    };
    let mut one = sensing(&[SensorSettings::Accelerometer(gains, ())], 21);
    let state = State { rotor_speed: [0.0, speed, 0.0, 0.0], ..State::default() };
    let truth = Truth { state, specific_force: body(0.0, 0.0, 9.8), ..Truth::default() };
    one.begin(&truth);
    let phase = one.phase[1];
    for tick in 0..1000 {
        one.measure(&truth, tick as f64, dt);
        let angle = phase + speed * dt * (tick + 1) as f64;
        let want = amplitude * speed * speed;
        let f = one.imu.specific_force;
        assert!((f.x - want * angle.sin()).abs() < 1e-9, "tick {tick}");
        assert!((f.y - want * angle.cos()).abs() < 1e-9 && (f.z - 9.8 - f.x).abs() < 1e-12);
    }
    // Four rotors add up; where the sensor does not vibrate, nothing shakes.
    let mut quiet = sensing(&[named("accelerometer")], 21);
    quiet.begin(&truth);
    assert_eq!(quiet.vibration, 0.0);
}

#[test]
fn telemetry_tells_the_thrust_and_torque_of_the_rotors() {
    let gains = rotor_speed::Gains { noise: 0.0, resolution: 0.0, ..rotor_speed::Gains::default() };
    let mut one = sensing(&[SensorSettings::RotorSpeed(gains, ())], 1);
    let truth = still();
    one.begin(&truth);
    one.measure(&truth, 0.0, 1e-3);
    assert!(one.has_telemetry() && !sensing(&[named("gyro")], 1).has_telemetry());
    let vehicle = Vehicle::default();
    let rotors: ActuationSettings = named("rotors");
    let want = rotors.build(&vehicle).wrench(&truth.state);
    let got = one.achieved(&vehicle);
    assert!((got.thrust - want.thrust).abs() < 1e-12);
    assert!((got.torque - want.torque).norm() < 1e-12);
}

#[test]
fn perfect_sensors_tell_the_truth_bit_by_bit() {
    let mut perfect = Sensing::<f64>::default();
    perfect.begin(&still());
    let before = bits(&perfect);
    let told = perfect.measure(&still(), 5.0, 1e-3);
    let truth = still().state;
    assert_eq!(bits(&told.position), bits(&truth.position));
    assert_eq!(bits(&told.velocity), bits(&truth.velocity));
    assert_eq!(bits(&told.attitude), bits(&truth.attitude));
    assert_eq!(bits(&told.rate), bits(&truth.rate));
    assert_eq!(bits(&perfect), before);
}

#[test]
fn a_set_of_sensors_is_checked_when_it_is_loaded() {
    let pick =
        |kinds: &[&str]| kinds.iter().map(|kind| named(kind)).collect::<Vec<SensorSettings>>();
    assert_eq!(check(&pick(&ALL), 1e-3), Ok(()));
    assert_eq!(check(&pick(&["gyro", "gnss"]), 1e-3), Err(Fault::Missing("accelerometer")));
    assert_eq!(
        check(&pick(&["gyro", "accelerometer", "gnss", "gyro"]), 1e-3),
        Err(Fault::Twice("gyro"))
    );
    assert_eq!(check(&pick(&["gyro", "accelerometer", "barometer"]), 1e-3), Err(Fault::Unaided));
    let late = |latency, jitter| {
        let mut all = pick(&["gyro", "accelerometer", "none"]);
        let timing = Timing { rate_hz: 100.0, latency, jitter, dropout: 0.0 };
        all.push(timed("motion-capture", timing));
        all
    };
    assert_eq!(check(&late(0.07, 0.0), 1e-3), Ok(()));
    assert_eq!(check(&late(0.05, 0.02), 1e-3), Ok(()));
    let late_by = [0.06, 0.011];
    let fault = Fault::Crowded { sensor: 3, kind: "motion-capture", late: late_by, longest: 0.07 };
    assert_eq!(check(&late(0.06, 0.011), 1e-3), Err(fault));
    assert_eq!(
        fault.to_string(),
        "sensor 3 (motion-capture): latency 0.06 s and jitter 0.011 s together must not exceed 7 sampling periods, here 0.07 s"
    );
    // What passes the check loses nothing.
    let timing = Timing { rate_hz: 100.0, latency: 0.04, jitter: 0.03, dropout: 0.0 };
    let got = samples(&mut height(timing, 8), 10_000, 1e-3, clock);
    assert!(got.windows(2).all(|w| w[1].1.values[0] == w[0].1.values[0] + 10.0));
}

#[test]
fn every_kind_is_in_the_registry_with_settings_in_range() {
    assert_eq!(SensorSettings::NAMES[0], "none");
    assert_eq!(SensorSettings::NAMES[1..], ALL);
    let defaults = (
        magnetometer::Gains::<f64>::default(),
        motion_capture::Gains::<f64>::default(),
        optical_flow::Gains::<f64>::default(),
    );
    assert!(defaults.0.up < 0.0 && defaults.1.rate_hz > 0.0 && defaults.2.latency > 0.0);
}
