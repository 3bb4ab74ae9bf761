//! Sensors against the laws of their noise, and what must hold for each of them: exact delays, independent
//! numbers, the same bits in lanes, and no broken number that gets through.
// Tests compare bits, take the standard library as their second opinion, and print figures as their
// source prints them.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::approx_constant, clippy::float_cmp)]
#![allow(clippy::manual_is_multiple_of)] // remainders read better beside each other

mod common;

use std::f64::consts::TAU;

use common::{bits, body, named, world};
use stormpetrel_control::estimator::Eskf;
use stormpetrel_control::lanes::Lanes;
use stormpetrel_control::math::{Body, Rotation, Vec3};
use stormpetrel_control::record::{Record, RecordExt};
use stormpetrel_control::registry::Settings;
use stormpetrel_control::signals::Model;
use stormpetrel_plant::actuation::ActuationSettings;
use stormpetrel_plant::random::Stream;
use stormpetrel_plant::sensor::link::{Sample, Timing};
use stormpetrel_plant::sensor::{
    Channel, Fault, Moment, Sensing, Sensor, SensorSettings, Truth, accelerometer, barometer,
    check, gnss, gyro, magnetometer, motion_capture, optical_flow, rotor_speed,
};
use stormpetrel_plant::state::State;
use stormpetrel_plant::vehicle::Vehicle;

const ALL: [&str; 8] = [
    "gyro",
    "accelerometer",
    "rotor-speed",
    "motion-capture",
    "gnss",
    "optical-flow",
    "magnetometer",
    "barometer",
];

fn channel(settings: SensorSettings, seed: u64, truth: &Truth<f64>) -> Channel<f64> {
    let mut channel: Channel<f64> = settings.build(&Vehicle::default()).into();
    channel.link.stream = Stream::new(seed, channel.sensor.kind());
    channel.begin(truth);
    channel
}

fn moment(tick: u64, dt: f64) -> Moment<f64> {
    Moment { tick: tick as f64, dt, shake: Vec3::zero(), good: true }
}

/// What arrives, with the tick at which it does.
fn samples(
    channel: &mut Channel<f64>,
    ticks: u64,
    dt: f64,
    mut truth: impl FnMut(u64) -> Truth<f64>,
) -> Vec<(u64, Sample<f64>)> {
    (0..ticks)
        .map(|tick| (tick, channel.sense(&truth(tick), &moment(tick, dt))))
        .filter(|(_, sample)| sample.fresh)
        .collect()
}

fn still() -> Truth<f64> {
    Truth {
        state: State {
            position: world(1.0, 2.0, 3.0),
            velocity: world(0.5, -1.5, 0.25),
            attitude: Rotation::from_quaternion(0.9, 0.1, -0.3, 0.3).normalised(),
            rate: body(0.1, -0.2, 0.3),
            rotor_speed: [1400.0, 1500.0, 1600.0, 1700.0],
        },
        specific_force: body(0.3, 0.2, 9.7),
        ..Truth::default()
    }
}

/// A gyro without errors.
fn ideal() -> gyro::Gains<f64> {
    gyro::Gains {
        noise: 0.0,
        walk: 0.0,
        bias_sigma: 0.0,
        resolution: 0.0,
        range: 1e4,
        cutoff_hz: 1e6,
        ..gyro::Gains::default()
    }
}

fn gyro(gains: gyro::Gains<f64>) -> SensorSettings {
    SensorSettings::Gyro(gains, ())
}

fn variance(x: &[f64]) -> f64 {
    let mean = x.iter().sum::<f64>() / x.len() as f64;
    x.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (x.len() - 1) as f64
}

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

/// Settings of that kind with this timing, and the errors as they are.
fn timed(kind: &str, timing: Timing<f64>) -> SensorSettings {
    let Timing { rate_hz, latency, jitter, dropout } = timing;
    let mut settings: SensorSettings = named(kind);
    macro_rules! set {
        ($($variant:ident)+) => { match &mut settings {
            $( SensorSettings::$variant(gains, _) => {
                (gains.rate_hz, gains.latency) = (rate_hz, latency);
                (gains.jitter, gains.dropout) = (jitter, dropout);
            } )+
            SensorSettings::Unused(..) => {}
        } };
    }
    set!(Gyro Accelerometer RotorSpeed MotionCapture Gnss OpticalFlow Magnetometer Barometer);
    settings
}

/// A height that tells the tick at which it was sampled.
fn clock(tick: u64) -> Truth<f64> {
    Truth {
        state: State { position: world(0.0, 0.0, tick as f64), ..State::default() },
        ..Truth::default()
    }
}

fn height(timing: Timing<f64>, seed: u64) -> Channel<f64> {
    let mut settings = timed("barometer", timing);
    if let SensorSettings::Barometer(gains, _) = &mut settings {
        gains.noise = 0.0;
    }
    channel(settings, seed, &Truth::default())
}

#[test]
fn every_sensor_samples_at_whole_periods_and_arrives_after_the_declared_ticks() {
    let dt = 2e-3;
    for kind in ALL {
        for (rate_hz, late) in
            [(500.0, 0), (500.0, 3), (100.0, 0), (100.0, 1), (100.0, 35), (80.0, 20)]
        {
            let timing = Timing { rate_hz, latency: late as f64 * dt, jitter: 0.0, dropout: 0.0 };
            let period = (1.0 / (rate_hz * dt)).round() as u64;
            let got = samples(&mut channel(timed(kind, timing), 1, &still()), 400, dt, |_| still());
            let ticks: Vec<u64> = got.iter().map(|(tick, _)| *tick).collect();
            let want: Vec<u64> =
                (0..400 - late).step_by(period as usize).map(|t| t + late).collect();
            assert_eq!(ticks, want, "{kind} at {rate_hz} Hz, {late} ticks late");
            assert!(got.iter().all(|(_, s)| s.age == late as f64 * dt), "{kind}");
        }
    }
    for late in [0, 1, 7, 35] {
        let timing = Timing { rate_hz: 100.0, latency: late as f64 * dt, ..Timing::default() };
        for (tick, sample) in samples(&mut height(timing, 1), 400, dt, clock) {
            assert_eq!(sample.values[0], (tick - late) as f64);
        }
    }
}

#[test]
fn jitter_delays_within_its_bounds_and_keeps_the_order() {
    let dt = 1e-3;
    let timing = Timing { rate_hz: 100.0, latency: 5e-3, jitter: 0.03, dropout: 0.0 };
    let got = samples(&mut height(timing, 3), 20_000, dt, clock);
    let taken: Vec<f64> = got.iter().map(|(_, s)| s.values[0]).collect();
    assert!(taken.windows(2).all(|w| w[1] == w[0] + 10.0), "each once and in order");
    let ages: Vec<f64> = got.iter().map(|(tick, s)| *tick as f64 - s.values[0]).collect();
    for ((_, sample), age) in got.iter().zip(&ages) {
        assert!((sample.age - age * dt).abs() < 1e-12 && (5.0..=36.0).contains(age), "{age}");
    }
    // A sample that is overtaken waits; the rest spread evenly, so the mean lies above their middle.
    let mean = ages.iter().sum::<f64>() / ages.len() as f64;
    assert!((20.0..25.0).contains(&mean), "{mean}");
}

#[test]
fn the_declared_share_of_samples_is_lost() {
    for dropout in [0.0, 0.05, 0.5, 1.0] {
        let timing = Timing { rate_hz: 500.0, latency: 4e-3, jitter: 0.0, dropout };
        let n = 40_000.0;
        let got = samples(&mut height(timing, 4), 80_000, 1e-3, clock).len() as f64;
        let room = 4.0 * (n * dropout * (1.0 - dropout)).sqrt() + 2.0;
        assert!((got - n * (1.0 - dropout)).abs() <= room, "{dropout}: {got} of {n}");
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

fn sensing(kinds: &[SensorSettings], seed: u64) -> Sensing<f64> {
    let mut sensing = Sensing {
        filter: Eskf::new(Default::default(), &Model::default()),
        estimate: true,
        ..Sensing::default()
    };
    for (channel, settings) in sensing.channels.iter_mut().zip(kinds) {
        *channel = settings.build(&Vehicle::default()).into();
    }
    sensing.seed(seed);
    sensing
}

/// A hover that sways; the sensors need not know that it is no real flight.
fn sway(tick: u64) -> Truth<f64> {
    let t = tick as f64 * 1e-3;
    let mut truth = still();
    truth.state.position.x += (2.0 * t).sin();
    truth.state.velocity.x += 2.0 * (2.0 * t).cos();
    truth.specific_force.x += -4.0 * (2.0 * t).sin();
    truth.state.rate.y = 0.3 * (3.0 * t).cos();
    truth
}

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
fn what_finds_no_room_is_lost_and_the_rest_arrives_in_order() {
    // Fifty periods of delay, which the check refuses: eight places are left.
    let timing = Timing { rate_hz: 1000.0, latency: 0.05, jitter: 0.0, dropout: 0.0 };
    let mut one = height(timing, 8);
    let got = samples(&mut one, 500, 1e-3, clock);
    let taken: Vec<f64> = got.iter().map(|(_, s)| s.values[0]).collect();
    assert_eq!(taken[..9], [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 51.0]);
    assert!(got.iter().all(|(tick, s)| *tick as f64 - s.values[0] == 50.0));
    assert_eq!(one.link.waiting, 8.0);
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
