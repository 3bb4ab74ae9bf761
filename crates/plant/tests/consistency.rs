//! The filter knows how wrong it is: the normalised squared error over flights of an analytic motion
//! lies inside its chi-square band.
//!
//! With e the fifteen errors and P the filter's covariance, the sum of e' P^-1 e over n flights has the
//! chi-square distribution of 15 n degrees of freedom. Its quantiles are those of Wilson and Hilferty
//! (1931): d (1 - 2/(9 d) + z sqrt(2/(9 d)))^3.
//!
//! Fifty flights would show an error of 20 %. With 1500 flights everything below is inside its band of 3 %
//! as well, but satellites 0.1 s late: 15.1 to 15.6 in place of 15, for what the compensation leaves out.
// Tests compare bits, take the standard library as their second opinion, and print figures as their
// source prints them.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::approx_constant, clippy::float_cmp)]

use nalgebra::{DMatrix, DVector, Quaternion, UnitQuaternion, Vector3};
use stormpetrel_control::estimator::{Eskf, Gains};
use stormpetrel_control::math::{Euler, Frame, Rotation, Vec3};
use stormpetrel_control::signals::Model;
use stormpetrel_plant::sensor::{
    Sensing, Sensor, SensorSettings, Truth, accelerometer, barometer, gnss, gyro, magnetometer,
    motion_capture, optical_flow,
};
use stormpetrel_plant::state::State;
use stormpetrel_plant::vehicle::Vehicle;

type V = Vector3<f64>;
const DT: f64 = 4e-3;
const FLIGHTS: usize = 50;
const G: f64 = 9.8;

fn vector<F: Frame>(v: Vec3<f64, F>) -> V {
    V::new(v.x, v.y, v.z)
}

fn vec3<F: Frame>(v: V) -> Vec3<f64, F> {
    Vec3::new(v.x, v.y, v.z)
}

/// A banked wandering with all its derivatives in closed form.
fn truth(t: f64) -> Truth<f64> {
    let wave = |a: f64, w: f64, s: f64| {
        let (sin, cos) = (w * t + s).sin_cos();
        [a * sin, a * w * cos, -a * w * w * sin]
    };
    let (x, y, z) = (wave(3.0, 1.1, 0.3), wave(2.0, 1.7, 1.0), wave(0.8, 0.9, 2.0));
    let (roll, pitch, yaw) = (wave(0.4, 1.5, 0.2), wave(0.3, 1.2, 0.9), wave(1.2, 0.7, 0.0));
    let attitude = Rotation::from_euler(Euler { roll: roll[0], pitch: pitch[0], yaw: yaw[0] });
    // Body rates of the Z-Y-X angles.
    let ((sr, cr), (sp, cp)) = (roll[0].sin_cos(), pitch[0].sin_cos());
    let rate = Vec3::new(
        roll[1] - sp * yaw[1],
        cr * pitch[1] + sr * cp * yaw[1],
        -sr * pitch[1] + cr * cp * yaw[1],
    );
    let acceleration = V::new(x[2], y[2], z[2]);
    let specific_force = attitude.inverse() * vec3(acceleration + V::z() * G);
    Truth {
        state: State {
            position: Vec3::new(x[0], y[0], z[0]),
            velocity: Vec3::new(x[1], y[1], z[1]),
            attitude,
            rate,
            ..State::default()
        },
        specific_force,
        ..Truth::default()
    }
}

fn satellites(latency: f64) -> Vec<SensorSettings> {
    let gnss = gnss::Gains { latency, ..gnss::Gains::default() };
    let magnetometer = magnetometer::Gains { rate_hz: 25.0, ..magnetometer::Gains::default() };
    let barometer =
        barometer::Gains { rate_hz: 12.5, latency: latency / 5.0, ..barometer::Gains::default() };
    vec![
        SensorSettings::Gnss(gnss, ()),
        SensorSettings::Magnetometer(magnetometer, ()),
        SensorSettings::Barometer(barometer, ()),
    ]
}

fn cameras(latency: f64, jitter: f64) -> Vec<SensorSettings> {
    let gains = motion_capture::Gains {
        rate_hz: 50.0,
        latency,
        jitter,
        ..motion_capture::Gains::default()
    };
    vec![SensorSettings::MotionCapture(gains, ())]
}

fn flow(latency: f64) -> Vec<SensorSettings> {
    let flow = optical_flow::Gains { rate_hz: 50.0, latency, ..optical_flow::Gains::default() };
    let mut all = satellites(0.0);
    all[0] = SensorSettings::OpticalFlow(flow, ());
    all
}

fn sensing(aiding: &[SensorSettings], gains: Gains<f64>, seed: u64) -> Sensing<f64> {
    let imu = [
        SensorSettings::Gyro(gyro::Gains { rate_hz: 1.0 / DT, ..gyro::Gains::default() }, ()),
        SensorSettings::Accelerometer(
            accelerometer::Gains { rate_hz: 1.0 / DT, ..accelerometer::Gains::default() },
            (),
        ),
    ];
    let model = Model { gravity: G, ..Model::default() };
    let mut sensing =
        Sensing { filter: Eskf::new(gains, &model), estimate: true, ..Sensing::default() };
    for (channel, settings) in sensing.channels.iter_mut().zip(imu.iter().chain(aiding)) {
        *channel = settings.build(&Vehicle::default()).into();
    }
    sensing.seed(seed);
    sensing.begin(&truth(0.0));
    sensing
}

fn quaternion<A: Frame, B: Frame>(q: Rotation<f64, A, B>) -> UnitQuaternion<f64> {
    UnitQuaternion::new_unchecked(Quaternion::new(q.w, q.x, q.y, q.z))
}

/// True less estimated, in the order of the filter.
fn errors(sensing: &Sensing<f64>, t: f64) -> DVector<f64> {
    let (truth, guess) = (truth(t).state, sensing.filter.nominal);
    let mut biases = [V::zeros(); 2];
    for channel in &sensing.channels {
        match &channel.sensor {
            Sensor::Gyro(gyro) => biases[0] = vector(gyro.triad.bias),
            Sensor::Accelerometer(one) => biases[1] = vector(one.triad.bias),
            _ => {}
        }
    }
    let theta = (quaternion(guess.attitude).inverse() * quaternion(truth.attitude)).scaled_axis();
    let parts = [
        vector(truth.position) - vector(guess.position),
        vector(truth.velocity) - vector(guess.velocity),
        theta,
        biases[0] - vector(guess.gyro_bias),
        biases[1] - vector(guess.accelerometer_bias),
    ];
    DVector::from_iterator(15, parts.iter().flat_map(|v| [v.x, v.y, v.z]))
}

/// Mean of e' P^-1 e over all flights at whole multiples of two seconds.
fn nees(aiding: &[SensorSettings], gains: Gains<f64>) -> Vec<f64> {
    let (moments, ticks) = (4, 500);
    let mut sums = vec![0.0; moments];
    let (mut rejected, mut taken) = (0.0, 0.0);
    for flight in 0..FLIGHTS {
        let mut sensing = sensing(aiding, gains, 1000 + flight as u64);
        for tick in 0..=moments * ticks {
            let t = tick as f64 * DT;
            sensing.measure(&truth(t), tick as f64, DT);
            assert_eq!(sensing.flag, 0.0);
            if tick > 0 && tick % ticks == 0 {
                let mut filter = sensing.filter;
                filter.propagate(true);
                let p = DMatrix::from_fn(15, 15, |i, j| {
                    filter.covariance.get(i / 3, j / 3)[i % 3][j % 3]
                });
                let e = errors(&sensing, t);
                let inverse = p.cholesky().expect("positive definite").inverse();
                sums[tick / ticks - 1] += e.dot(&(inverse * &e));
            }
        }
        rejected += sensing.filter.rejected;
        taken += 3.0 * (moments * ticks) as f64 / 25.0;
    }
    // Five deviations: one in a million, were the filter perfect.
    if gains.measurement_noise == 1.0 {
        assert!(rejected < 1e-3 * taken, "{rejected} refused");
    }
    sums.iter().map(|sum| sum / FLIGHTS as f64).collect()
}

/// The band that holds 99.9 % of the means.
fn band() -> [f64; 2] {
    let d = 15.0 * FLIGHTS as f64;
    [-3.290_527, 3.290_527].map(|z| {
        let r = 2.0 / (9.0 * d);
        15.0 * (1.0 - r + z * r.sqrt()).powi(3)
    })
}

fn inside(name: &str, means: &[f64]) {
    let [lo, hi] = band();
    assert!(means.iter().all(|x| (lo..=hi).contains(x)), "{name}: {means:?} not in {lo}..{hi}");
}

#[test]
fn the_chi_square_band_is_that_of_the_tables() {
    // 0.05 % and 99.95 % quantiles of 750 degrees of freedom, from SciPy's chi2.ppf.
    let [lo, hi] = band().map(|x| x * FLIGHTS as f64);
    assert!((lo - 629.071).abs() < 0.05 && (hi - 884.027).abs() < 0.05, "{lo} {hi}");
}

#[test]
fn with_satellites_compass_and_barometer() {
    inside("satellites", &nees(&satellites(0.0), Gains::default()));
}

#[test]
fn with_late_satellites_compass_and_barometer() {
    inside("late satellites", &nees(&satellites(0.1), Gains::default()));
}

#[test]
fn with_motion_capture() {
    inside("cameras", &nees(&cameras(0.0, 0.0), Gains::default()));
}

#[test]
fn with_late_motion_capture() {
    inside("late cameras", &nees(&cameras(0.012, 0.0), Gains::default()));
    inside("late and irregular cameras", &nees(&cameras(0.012, 0.04), Gains::default()));
}

#[test]
fn with_optical_flow() {
    inside("flow", &nees(&flow(0.0), Gains::default()));
    inside("late flow", &nees(&flow(0.02), Gains::default()));
}

#[test]
fn a_filter_that_trusts_too_much_is_found_out() {
    let [_, hi] = band();
    let blind = Gains { measurement_noise: 0.5, ..Gains::default() };
    for aiding in [satellites(0.0), cameras(0.0, 0.0)] {
        let means = nees(&aiding, blind);
        assert!(means.iter().all(|x| *x > hi), "{means:?} not above {hi}");
    }
    // The same behind the back of the propagation: sensors twice as noisy as believed.
    let blind = Gains { gyro_noise: 1.25e-4, accelerometer_noise: 1e-3, ..Gains::default() };
    let means = nees(&cameras(0.0, 0.0), blind);
    assert!(means.iter().filter(|x| **x > hi).count() >= 3, "{means:?} not above {hi}");
}
