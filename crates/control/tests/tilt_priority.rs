//! The tilt-prioritised attitude error: its two parts, its sign, and its behaviour upside down.
//!
//! With K1 = 1 and a resting reference the law's rate is the negative error, 2 (x_t, y_t, z_y).
// Tests compare bits, take the standard library as their second opinion, and print figures as their
// source prints them.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::approx_constant, clippy::float_cmp)]

mod common;

use common::{Random, bits, model};
use nalgebra::{UnitQuaternion, Vector3};
use stormpetrel_control::attitude::tilt_priority::{Gains, TiltPriority};
use stormpetrel_control::controller::Controller;
use stormpetrel_control::math::{Body, Rotation, Vec3, World};
use stormpetrel_control::signals::{Attitude, Measurement, Rate};

type Q = UnitQuaternion<f64>;

fn ours(q: Q) -> Rotation<f64, Body, World> {
    Rotation::from_quaternion(q.w, q.i, q.j, q.k)
}

fn negative(q: Rotation<f64, Body, World>) -> Rotation<f64, Body, World> {
    Rotation::from_quaternion(-q.w, -q.x, -q.y, -q.z)
}

fn command(
    attitude: Rotation<f64, Body, World>,
    rotation: Rotation<f64, Body, World>,
) -> Rate<f64> {
    let gains = Gains { k1: Vec3::splat(1.0), ..Gains::default() };
    let m = Measurement { attitude, ..Measurement::default() };
    let reference = Attitude { rotation, ..Attitude::default() };
    TiltPriority::new(gains, (), &model()).update(&m, &reference, 1e-3)
}

/// Tilt by `tilt` about the horizontal axis at `azimuth`, then the turn `yaw` about the body axis.
fn tilted(tilt: f64, azimuth: f64, yaw: f64) -> Q {
    let axis = nalgebra::Unit::new_unchecked(Vector3::new(azimuth.cos(), azimuth.sin(), 0.0));
    Q::from_axis_angle(&axis, tilt) * Q::from_axis_angle(&Vector3::z_axis(), yaw)
}

fn any(random: &mut Random) -> Q {
    let mut number = || random.between(-1.0, 1.0);
    Q::new_normalize(nalgebra::Quaternion::new(number(), number(), number(), number()))
}

#[test]
fn tilt_and_yaw_error_do_not_know_of_each_other() {
    let mut random = Random(1);
    for _ in 0..2000 {
        let (tilt, azimuth, yaw) =
            (random.between(0.0, 3.1), random.between(-3.1, 3.1), random.between(-3.1, 3.1));
        let start = any(&mut random);
        let rate = command(ours(start), ours(start * tilted(tilt, azimuth, yaw))).rate;
        // Half-angle sines of either part alone.
        let sin = 2.0 * (tilt / 2.0).sin();
        let want = Vec3::new(sin * azimuth.cos(), sin * azimuth.sin(), 2.0 * (yaw / 2.0).sin());
        // The parts are found by dividing by N = cos(tilt/2).
        let room = 1e-14 / (tilt / 2.0).cos();
        assert!((rate - want).norm() < room, "tilt {tilt}, azimuth {azimuth}, yaw {yaw}");
    }
}

#[test]
fn a_quaternion_and_its_negative_give_the_same_command() {
    let mut random = Random(2);
    for _ in 0..2000 {
        let (q, r) = (ours(any(&mut random)), ours(any(&mut random)));
        let want = bits(&command(q, r));
        assert_eq!(bits(&command(negative(q), r)), want);
        assert_eq!(bits(&command(q, negative(r))), want);
        assert_eq!(bits(&command(negative(q), negative(r))), want);
    }
}

#[test]
fn one_degree_short_of_upside_down_turns_the_right_way() {
    for azimuth in [0.0, 1.0, 2.5, -0.7f64] {
        let q = tilted(179f64.to_radians(), azimuth, 0.4);
        let rate = command(Rotation::identity(), ours(q)).rate;
        let sin = 2.0 * 89.5f64.to_radians().sin();
        let want = Vec3::new(sin * azimuth.cos(), sin * azimuth.sin(), 2.0 * 0.2f64.sin());
        assert!((rate - want).norm() < 1e-12, "{rate:?}");
    }
}

#[test]
fn exactly_upside_down_turns_about_the_forward_axis() {
    for q in [[0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, -0.6, 0.8, 0.0]] {
        let [w, x, y, z] = q;
        let rate = command(Rotation::identity(), Rotation::from_quaternion(w, x, y, z)).rate;
        assert_eq!([rate.x, rate.y, rate.z], [2.0, 0.0, 0.0]);
    }
}

#[test]
fn the_thrust_axis_takes_the_great_circle_whatever_the_yaw() {
    // The velocity of the thrust axis is R (omega x e_z); the great circle to the reference has the
    // normal b_z x b_z,ref.
    let mut random = Random(3);
    for _ in 0..2000 {
        let (q, r) = (any(&mut random), any(&mut random));
        let (q_ours, r_ours) = (ours(q), ours(r));
        let rate = command(q_ours, r_ours).rate;
        let moves = q_ours * rate.cross(Vec3::up(1.0));
        let (b, b_ref) = (q_ours.z_axis(), r_ours.z_axis());
        let normal = b.cross(b_ref);
        if normal.norm() > 1e-3 {
            assert!(moves.dot(normal).abs() < 1e-12, "{}", moves.dot(normal));
            assert!(moves.dot(b_ref) > 0.0, "away from the reference");
        }
    }
}

#[test]
fn a_turn_of_more_than_half_a_circle_goes_the_short_way() {
    for (turn, want) in [(170f64, 1.0), (190.0, -1.0), (350.0, -1.0), (-190.0, 1.0)] {
        let q = Q::from_axis_angle(&Vector3::z_axis(), turn.to_radians());
        let rate = command(Rotation::identity(), ours(q)).rate;
        assert_eq!(rate.z.signum(), want, "{turn} deg");
    }
}

#[test]
fn the_feed_forward_is_turned_into_the_body_s_own_axes() {
    let mut random = Random(4);
    let gains = Gains { k1: Vec3::zero(), ..Gains::default() };
    for _ in 0..500 {
        let (q, r) = (any(&mut random), any(&mut random));
        let (rate, acceleration) = (Vec3::new(1.0, -2.0, 0.5), Vec3::new(0.3, 4.0, -1.0));
        let m = Measurement { attitude: ours(q), ..Measurement::default() };
        let reference = Attitude { rotation: ours(r), rate, acceleration, thrust: 6.0 };
        let got = TiltPriority::new(gains, (), &model()).update(&m, &reference, 1e-3);
        let want = q.inverse() * (r * Vector3::new(1.0, -2.0, 0.5));
        assert!((got.rate - Vec3::new(want.x, want.y, want.z)).norm() < 1e-14);
        let want = q.inverse() * (r * Vector3::new(0.3, 4.0, -1.0));
        assert!((got.acceleration - Vec3::new(want.x, want.y, want.z)).norm() < 1e-14);
        assert_eq!(got.thrust, 6.0);
    }
}
