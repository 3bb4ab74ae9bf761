//! The attitude reference: flatness rates against finite differences, continuity through
//! inversion, and what the article's arctangent does below the horizon.
// Tests compare bits, take the standard library as their second opinion, and print figures as their
// source prints them.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::approx_constant, clippy::float_cmp)]

mod common;

use common::{Random, model};
use stormpetrel_control::attitude_reference::{
    AttitudeReference, AttitudeReferenceSettings, Rates, attitude_along, euler, flatness_rates,
    rotation,
};
use stormpetrel_control::controller::Controller;
use stormpetrel_control::math::{Body, Rotation, Vec3, World};
use stormpetrel_control::signals::{Measurement, Thrust};

type Attitude = Rotation<f64, Body, World>;

/// Amplitude, frequency and phase for each axis, and for the yaw.
const WAVES: [[f64; 3]; 4] = [[3.0, 1.3, 0.2], [2.5, 0.9, 1.1], [4.0, 1.7, -0.4], [1.2, 1.1, 0.7]];

/// The `n`-th derivative of a wave.
fn wave(i: usize, t: f64, n: i32) -> f64 {
    let [a, w, phase] = WAVES[i];
    a * w.powi(n) * (w * t + phase + std::f64::consts::FRAC_PI_2 * f64::from(n)).sin()
}

/// Acceleration on three axes at once, with a swinging heading.
fn thrust(t: f64) -> Thrust<f64> {
    let vector = |n| Vec3::new(wave(0, t, n), wave(1, t, n), wave(2, t, n));
    Thrust {
        force: vector(0) + Vec3::up(9.8),
        force_rate: vector(1),
        force_acceleration: vector(2),
        yaw: wave(3, t, 0),
        yaw_rate: wave(3, t, 1),
        yaw_acceleration: wave(3, t, 2),
    }
}

fn along(t: f64) -> Attitude {
    let thrust = thrust(t);
    attitude_along(thrust.force, thrust.yaw)
}

/// First derivative from eight neighbours, error of order h^8.
fn derivative(f: impl Fn(f64) -> Vec3<f64, Body>) -> Vec3<f64, Body> {
    const H: f64 = 0.01;
    let [a, b, c, d] = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];
    let pair = |k: f64| f(k * H) - f(-k * H);
    (pair(1.0) * a + pair(2.0) * b + pair(3.0) * c + pair(4.0) * d) * (1.0 / H)
}

/// Angular velocity in body axes: twice the derivative of the vector part of q(t)^-1 q(t + h).
fn angular_velocity(t: f64) -> Vec3<f64, Body> {
    derivative(|h| (along(t).inverse() * along(t + h)).shortest().vector() * 2.0)
}

#[test]
fn val_flatness_rates_are_the_derivatives_of_the_attitude() {
    for k in 0..200 {
        let t = 0.1 * f64::from(k);
        let (rate, acceleration) = flatness_rates(along(t), &thrust(t));
        let off = (rate - angular_velocity(t)).norm() / rate.norm();
        assert!(off < 1e-9, "rate at {t} s: {off:e}");
        let numerical = derivative(|h| flatness_rates(along(t + h), &thrust(t + h)).0);
        let off = (acceleration - numerical).norm() / acceleration.norm();
        assert!(off < 1e-9, "acceleration at {t} s: {off:e}");
    }
}

#[test]
fn the_thrust_axis_is_along_the_force_and_the_lateral_axis_normal_to_the_heading() {
    let mut random = Random(5);
    for _ in 0..1000 {
        let mut number = || random.between(-9.0, 9.0);
        let (force, yaw) = (Vec3::new(number(), number(), number()), number());
        let r = attitude_along(force, yaw);
        assert!((r.z_axis() - force * (1.0 / force.norm())).norm() < 1e-14);
        // Z-Y-X: the forward axis has no part along y_c = (-sin psi, cos psi, 0).
        let y_c = Vec3::new(-yaw.sin(), yaw.cos(), 0.0);
        assert!(r.x_axis().dot(y_c).abs() < 1e-13, "{}", r.x_axis().dot(y_c));
        // And on the heading's side, as nothing else is known.
        assert!(r.x_axis().dot(Vec3::new(yaw.cos(), yaw.sin(), 0.0)) >= -1e-13);
    }
}

#[test]
fn commanded_rates_are_the_turn_of_the_reference_per_step() {
    let options = rotation::Options { rates: Rates::Commanded };
    let mut law = AttitudeReferenceSettings::RotationMatrix(rotation::Gains::default(), options)
        .build(&model());
    let (dt, m) = (1e-3, Measurement::default());
    assert_eq!(law.update(&m, &thrust(0.0), dt).rate.norm(), 0.0, "no past, no rate");
    for k in 1..1000 {
        let t = f64::from(k) * dt;
        let got = law.update(&m, &thrust(t), dt).rate;
        // The mean over the step is the rate in its middle, to second order.
        let middle = flatness_rates(along(t - dt / 2.0), &thrust(t - dt / 2.0)).0;
        assert!((got - middle).norm() < 3e-5, "{t} s: {:e}", (got - middle).norm());
    }
}

#[test]
fn a_commanded_rate_is_the_antisymmetric_part_of_the_turn() {
    // omega = vee(R_d - R_d^T)/(2 dt): for a turn by an angle about an axis, its sine over dt.
    let options = rotation::Options { rates: Rates::Commanded };
    let mut law = AttitudeReferenceSettings::RotationMatrix(rotation::Gains::default(), options)
        .build(&model());
    let thrust = |yaw| Thrust { force: Vec3::up(9.8), yaw, ..Thrust::default() };
    law.update(&Measurement::default(), &thrust(0.2), 0.01);
    let rate = law.update(&Measurement::default(), &thrust(0.9), 0.01).rate;
    assert!((rate - Vec3::up(0.7f64.sin() / 0.01)).norm() < 1e-12, "{rate:?}");
}

fn law(pitch: Option<euler::Pitch>) -> AttitudeReference<f64> {
    match pitch {
        Some(pitch) => {
            let options = euler::Options { pitch, rates: Rates::Zero };
            AttitudeReferenceSettings::EulerAngles(euler::Gains::default(), options)
        }
        None => {
            let options = rotation::Options { rates: Rates::Zero };
            AttitudeReferenceSettings::RotationMatrix(rotation::Gains::default(), options)
        }
    }
    .build(&model())
}

#[test]
fn the_reference_turns_steadily_through_inversion() {
    // Loops in vertical planes: 0 deg of azimuth is a pitch loop, 90 deg a roll loop, which passes
    // exactly through the singular direction of the heading.
    for azimuth in [0.0, 20.0, 45.0, 70.0, 90.0, 130.0, 180.0, 270.0f64] {
        let (sin, cos) = azimuth.to_radians().sin_cos();
        let (sin, cos) =
            if azimuth % 90.0 == 0.0 { (sin.round(), cos.round()) } else { (sin, cos) };
        let mut law = law(None);
        let mut last: Option<Attitude> = None;
        for k in 0..=7200 {
            let (out, up) = (f64::from(k) * 0.1).to_radians().sin_cos();
            let force = Vec3::new(out * cos, out * sin, up) * 9.8;
            let thrust = Thrust { force, ..Thrust::default() };
            let r = law.update(&Measurement::default(), &thrust, 1e-3).rotation;
            assert!((r.z_axis() * 9.8 - force).norm() < 1e-12);
            if let Some(last) = last {
                let turn = (last.inverse() * r).angle().to_degrees();
                assert!(turn < 1.0, "azimuth {azimuth}, step {k}: {turn} deg");
            }
            last = Some(r);
        }
    }
}

/// Closer than 0.06 deg to the lateral axis of the heading the forward axis stays as it was, made normal to
/// the force; beside that it follows the heading.
#[test]
fn near_the_lateral_axis_the_forward_axis_is_held() {
    for (beside, held) in [(0.9e-3, true), (1.1e-3, false)] {
        let mut law = law(None);
        let mut reference = |force: Vec3<f64, World>| {
            let thrust = Thrust { force: force * 9.8, ..Thrust::default() };
            law.update(&Measurement::default(), &thrust, 1e-3).rotation
        };
        let before: Vec3<f64, World> = reference(Vec3::up(1.0)).x_axis();
        // y_c is the second axis, so that y_c x F shows half to the first and half down.
        let part = beside * std::f64::consts::FRAC_1_SQRT_2;
        let force = Vec3::new(part, (1.0 - beside * beside).sqrt(), part);
        let kept = (before - force * before.dot(force)).unit();
        let follows = Vec3::new(force.z, 0.0, -force.x).unit();
        let forward: Vec3<f64, World> = reference(force).x_axis();
        let expected = if held { kept } else { follows };
        assert!((forward - expected).norm() < 1e-12, "{beside}: {forward:?}, {expected:?}");
    }
}

/// Specific force of a vehicle that has reached the law's reference: (T/m) R e_z.
fn produced(pitch: Option<euler::Pitch>, force: Vec3<f64, World>) -> Vec3<f64, World> {
    let (mut law, thrust) = (law(pitch), Thrust { force, ..Thrust::default() });
    let mut m = Measurement { attitude: Rotation::identity(), ..Measurement::default() };
    m.attitude = law.update(&m, &thrust, 1e-3).rotation;
    m.attitude.z_axis() * (law.update(&m, &thrust, 1e-3).thrust / model().mass)
}

#[test]
fn val_the_article_s_arctangent_mirrors_the_force_below_the_horizon() {
    let mut random = Random(11);
    for _ in 0..1000 {
        let mut number = || random.between(-20.0, 20.0);
        let f = Vec3::new(number(), number(), number());
        // Theory, defect 16, for psi = 0.
        let square = f.x * f.x + f.y * f.y + f.z * f.z;
        let share = (f.x * f.x - f.y * f.y + f.z * f.z) / square;
        let mirrored = Vec3::new(f.x, -f.y, f.z) * share;
        let want = if f.z < 0.0 { mirrored } else { f };
        let got = produced(Some(euler::Pitch::Arctan), f);
        assert!((got - want).norm() < 1e-12, "{f:?}: {got:?}");
        // The repaired forms produce the force itself, whichever way it points.
        assert!((produced(Some(euler::Pitch::Atan2), f) - f).norm() < 1e-12, "{f:?}");
        assert!((produced(None, f) - f).norm() < 1e-12, "{f:?}");
    }
}

#[test]
fn the_thrust_is_projected_on_the_real_axis() {
    // T = m F . (R e_z): a vehicle tilted by 60 deg away from F gives half of it.
    for mut law in [law(None), law(Some(euler::Pitch::Atan2))] {
        let thrust = Thrust { force: Vec3::up(10.0), ..Thrust::default() };
        let (sin, cos) = 30f64.to_radians().sin_cos();
        let attitude = Rotation::from_quaternion(cos, sin, 0.0, 0.0);
        let m = Measurement { attitude, ..Measurement::default() };
        let got = law.update(&m, &thrust, 1e-3).thrust;
        assert!((got - 0.625 * 10.0 * 0.5).abs() < 1e-14, "{got}");
    }
}

#[test]
fn no_force_at_all_asks_for_the_level_attitude() {
    for yaw in [0.0, 0.7, -2.0f64] {
        let thrust = Thrust { yaw, ..Thrust::default() };
        let r = law(None).update(&Measurement::default(), &thrust, 1e-3).rotation;
        assert_eq!(r.z_axis().z, 1.0);
        assert!((r.x_axis() - Vec3::new(yaw.cos(), yaw.sin(), 0.0)).norm() < 1e-15);
    }
}
