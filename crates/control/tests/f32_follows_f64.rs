//! The whole stack in single precision follows the one in double precision.
//!
//! Both see the same 2000 ticks of a smooth flight near the helix: position, velocity and known
//! acceleration belong together, under a disturbance that the observer can find. Bounds:
//!
//! * without observer, 5e-7 of the largest force and attitude (four units of 2^-23) and 5e-6 of the
//!   largest rate and torque, which gains of about ten make of them; where the rate is a difference
//!   of two attitudes divided by the step, 1e-3, as 2 x 1.2e-7/1 ms is 2.4e-4 rad/s;
//! * with it, 0.02 m/s^2 of force: the sliding mode chatters by 1.1 L dt = 1.7e-3 a tick, out of
//!   step in the two, and takes the rounding of the position, eps = 2.4e-7 m, for noise; its
//!   accuracy is of the order L^(2/3) eps^(1/3) = 8e-3 (Levant 2003).
// Tests compare bits, take the standard library as their second opinion, and print figures as their
// source prints them.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::approx_constant, clippy::float_cmp)]

mod common;

use common::{every, model, numbers};
use stormpetrel_control::attitude::AttitudeLawSettings;
use stormpetrel_control::attitude_reference::AttitudeReferenceSettings;
use stormpetrel_control::math::{Euler, Rotation, Vec3};
use stormpetrel_control::observer::{Observer, ObserverSettings};
use stormpetrel_control::position::PositionSettings;
use stormpetrel_control::rate::RateLawSettings;
use stormpetrel_control::record::{Record, RecordExt};
use stormpetrel_control::signals::{Applied, Measurement, Trajectory, Wrench};
use stormpetrel_control::stack::{Command, Exit, Laws, Rhythm, Stack};

const DT: f64 = 1e-3;
const TICKS: u32 = 2000;

/// A circle with derivatives up to the fourth; amplitudes and phases make the measured one differ.
fn circle(t: f64, n: i32, radius: f64, phase: f64) -> Vec3<f64, stormpetrel_control::math::World> {
    let w = 0.5 * t + phase + std::f64::consts::FRAC_PI_2 * f64::from(n);
    let r = radius * 0.5f64.powi(n);
    let climb = [0.5 * t, 0.5, 0.0, 0.0, 0.0][n as usize];
    Vec3::new(r * w.sin(), r * w.cos(), climb)
}

fn reference(t: f64) -> Trajectory<f64> {
    Trajectory {
        position: circle(t, 0, 2.0, 0.0),
        velocity: circle(t, 1, 2.0, 0.0),
        acceleration: circle(t, 2, 2.0, 0.0),
        jerk: circle(t, 3, 2.0, 0.0),
        snap: circle(t, 4, 2.0, 0.0),
        yaw: 0.1 * t,
        yaw_rate: 0.1,
        yaw_acceleration: 0.0,
    }
}

fn measurement(t: f64) -> Measurement<f64> {
    let angles = Euler { roll: 0.1 * t.sin(), pitch: 0.08 * (1.3 * t).cos(), yaw: 0.1 * t };
    Measurement {
        position: circle(t, 0, 2.05, 0.02),
        velocity: circle(t, 1, 2.05, 0.02),
        attitude: Rotation::from_euler(angles),
        rate: Vec3::new(0.1 * t.cos(), -0.1 * (1.3 * t).sin(), 0.1),
        achieved: Wrench { thrust: 6.1, torque: Vec3::new(1e-3 * t.sin(), 2e-3, -1e-3 * t.cos()) },
        unallocated: Wrench::default(),
    }
}

/// The acceleration measured less the disturbance (0.5 (1 + sin t + cos t) on each axis).
fn applied(t: f64) -> Applied<f64> {
    let known = circle(t, 2, 2.05, 0.02) - Vec3::splat(0.5 * (1.0 + t.sin() + t.cos()));
    Applied { commanded: known, measured: known }
}

fn single<R: Record<f64>>(record: &R) -> R::With<f32> {
    RecordExt::<f64>::cast::<f32>(record)
}

fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |most, x| if x.abs() > most { x.abs() } else { most })
}

fn apart(a: &impl Record<f64>, b: &impl Record<f64>) -> f64 {
    largest(numbers(a).into_iter().zip(numbers(b)).map(|(a, b)| a - b))
}

/// Largest difference of the two stacks at each level, relative to the largest command there.
fn differences(laws: Laws<f64>) -> [f64; 4] {
    let mut double = Stack::new(laws, Exit::Wrench, Rhythm::default());
    double.reset(&measurement(0.0));
    let mut half: Stack<f32> = single(&double);
    let (mut off, mut size) = ([0.0; 4], [0.0; 4]);
    for k in 0..TICKS {
        let t = f64::from(k) * DT;
        let a = double.update(&measurement(t), &reference(t), DT);
        let b = half.update(&single(&measurement(t)), &single(&reference(t)), DT as f32);
        double.advance(&applied(t), DT);
        half.advance(&single(&applied(t)), DT as f32);
        assert_eq!((double.flags(), half.flags()), (0.0, 0.0), "tick {k}");
        let b: Command<f64> = RecordExt::<f32>::cast(&b);
        let (w, v) = (a.wrench.torque, b.wrench.torque);
        let now = [
            apart(&a.thrust.force, &b.thrust.force),
            apart(&a.attitude.rotation, &b.attitude.rotation),
            apart(&a.rate.rate, &b.rate.rate),
            apart(&w, &v),
        ];
        let scale = [
            largest(numbers(&a.thrust.force)),
            1.0,
            largest(numbers(&a.rate.rate)),
            largest(numbers(&w)),
        ];
        off = core::array::from_fn(|i| largest([off[i], now[i]]));
        size = core::array::from_fn(|i| largest([size[i], scale[i]]));
    }
    core::array::from_fn(|i| off[i] / size[i])
}

/// Every attitude reference, each with another pair of the laws below it, so that all pairs occur.
fn stacks(observer: Observer<f64>) -> Vec<(String, Laws<f64>)> {
    let (m, mut all) = (model(), Vec::new());
    let (attitudes, rates) = (every::<AttitudeLawSettings>(), every::<RateLawSettings>());
    for (n, (label, attitude_reference)) in
        every::<AttitudeReferenceSettings>().into_iter().enumerate()
    {
        let (a, attitude) = &attitudes[n % attitudes.len()];
        let (r, rate) = &rates[n / attitudes.len() % rates.len()];
        let laws = Laws {
            position: every::<PositionSettings>()[0].1.build(&m),
            observer,
            attitude_reference: attitude_reference.build(&m),
            attitude: attitude.build(&m),
            rate: rate.build(&m),
        };
        all.push((format!("{label} / {a} / {r}"), laws));
    }
    all
}

#[test]
fn without_observer_single_precision_follows_to_its_rounding() {
    let (_, none) = every::<ObserverSettings>()[0].clone();
    for (label, laws) in stacks(none.build(&model())) {
        let off = differences(laws);
        let room = if label.contains("commanded") { 1e-3 } else { 5e-6 };
        assert!(off[0] < 5e-7 && off[1] < 5e-7, "{label}: {off:?}");
        assert!(off[2] < room && off[3] < room, "{label}: {off:?}");
    }
}

#[test]
fn with_an_observer_single_precision_follows_to_its_accuracy() {
    for (label, observer) in every::<ObserverSettings>() {
        let off = differences(stacks(observer.build(&model()))[0].1);
        // The force is about 10 m/s^2.
        assert!(off[0] < 2e-3, "{label}: {off:?}");
    }
}
