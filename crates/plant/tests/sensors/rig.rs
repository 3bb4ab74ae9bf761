//! Sensors set up by hand, and what they look at.

use crate::common::{body, named, world};
use stormpetrel_control::estimator::Eskf;
use stormpetrel_control::math::{Rotation, Vec3};
use stormpetrel_control::signals::Model;
use stormpetrel_plant::random::Stream;
use stormpetrel_plant::sensor::link::{Sample, Timing};
use stormpetrel_plant::sensor::{Channel, Moment, Sensing, SensorSettings, Truth, gyro};
use stormpetrel_plant::state::State;
use stormpetrel_plant::vehicle::Vehicle;

pub const ALL: [&str; 8] = [
    "gyro",
    "accelerometer",
    "rotor-speed",
    "motion-capture",
    "gnss",
    "optical-flow",
    "magnetometer",
    "barometer",
];

pub fn channel(settings: SensorSettings, seed: u64, truth: &Truth<f64>) -> Channel<f64> {
    let mut channel: Channel<f64> = settings.build(&Vehicle::default()).into();
    channel.link.stream = Stream::new(seed, channel.sensor.kind());
    channel.begin(truth);
    channel
}

pub fn moment(tick: u64, dt: f64) -> Moment<f64> {
    Moment { tick: tick as f64, dt, shake: Vec3::zero(), good: true }
}

/// What arrives, with the tick at which it does.
pub fn samples(
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

pub fn still() -> Truth<f64> {
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
pub fn ideal() -> gyro::Gains<f64> {
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

pub fn gyro(gains: gyro::Gains<f64>) -> SensorSettings {
    SensorSettings::Gyro(gains, ())
}

pub fn variance(x: &[f64]) -> f64 {
    let mean = x.iter().sum::<f64>() / x.len() as f64;
    x.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (x.len() - 1) as f64
}

/// Settings of that kind with this timing, and the errors as they are.
pub fn timed(kind: &str, timing: Timing<f64>) -> SensorSettings {
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
pub fn clock(tick: u64) -> Truth<f64> {
    Truth {
        state: State { position: world(0.0, 0.0, tick as f64), ..State::default() },
        ..Truth::default()
    }
}

pub fn height(timing: Timing<f64>, seed: u64) -> Channel<f64> {
    let mut settings = timed("barometer", timing);
    if let SensorSettings::Barometer(gains, _) = &mut settings {
        gains.noise = 0.0;
    }
    channel(settings, seed, &Truth::default())
}

pub fn sensing(kinds: &[SensorSettings], seed: u64) -> Sensing<f64> {
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
pub fn sway(tick: u64) -> Truth<f64> {
    let t = tick as f64 * 1e-3;
    let mut truth = still();
    truth.state.position.x += (2.0 * t).sin();
    truth.state.velocity.x += 2.0 * (2.0 * t).cos();
    truth.specific_force.x += -4.0 * (2.0 * t).sin();
    truth.state.rate.y = 0.3 * (3.0 * t).cos();
    truth
}
