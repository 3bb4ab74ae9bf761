//! The allocation: exact inverse where the rotors allow it, roll and pitch first where they do not.
//!
//! Which wrenches the rotors allow is found here by another argument. With equal arms, roll is
//! l (u4 - u2) and pitch l (u3 - u1): the pairs are independent, and thrust and yaw only shift a
//! pair as a whole. So roll and pitch can be granted exactly if neither difference exceeds the
//! room of one rotor.
// Tests compare bits, take the standard library as their second opinion, and print figures as their
// source prints them.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::approx_constant, clippy::float_cmp)]

mod common;

use common::Random;
use nalgebra::{Matrix4, Vector4};
use stormpetrel_control::allocation::Allocation;
use stormpetrel_control::math::Vec3;
use stormpetrel_control::signals::Wrench;

/// The article's vehicle with the corrected drag: arm, m; torque per thrust, m; thrust limits, N.
const ARM: f64 = 0.1275;
const RATIO: f64 = 0.0275;
const LOW: f64 = 7.2e-7 * 150.0 * 150.0;
const HIGH: f64 = 7.2e-7 * 2917.0 * 2917.0;
const ROOM: f64 = HIGH - LOW;

/// The article's equations: rows thrust and three torques, columns rotors.
#[rustfmt::skip]
fn effect() -> Matrix4<f64> {
    Matrix4::new(
        1.0,    1.0,   1.0,    1.0,
        0.0,    -ARM,  0.0,    ARM,
        -ARM,   0.0,   ARM,    0.0,
        -RATIO, RATIO, -RATIO, RATIO,
    )
}

fn rows(m: &Matrix4<f64>) -> [[f64; 4]; 4] {
    core::array::from_fn(|i| core::array::from_fn(|j| m[(i, j)]))
}

fn allocation() -> Allocation<f64> {
    let inverse = effect().try_inverse().expect("a layout with an inverse");
    Allocation { inverse: rows(&inverse), effect: rows(&effect()), lowest: LOW, highest: HIGH }
}

fn wrench(v: Vector4<f64>) -> Wrench<f64> {
    Wrench { thrust: v[0], torque: Vec3::new(v[1], v[2], v[3]) }
}

fn vector(w: &Wrench<f64>) -> Vector4<f64> {
    Vector4::new(w.thrust, w.torque.x, w.torque.y, w.torque.z)
}

/// Thrusts and the wrench that they make; what is refused must be the rest.
fn allocate(allocation: &Allocation<f64>, asked: &Wrench<f64>) -> ([f64; 4], Wrench<f64>) {
    let allocated = allocation.allocate(asked);
    let granted = allocation.wrench(allocated.thrusts);
    let rest = vector(asked) - vector(&granted) - vector(&allocated.refused);
    assert!(rest.amax() < 5e-14 * (1.0 + vector(asked).amax()), "{rest:?}");
    if allocated.saturation == 0.0 {
        assert_eq!(vector(&allocated.refused), Vector4::zeros());
    }
    (allocated.thrusts, granted)
}

/// Wrenches from far below to far above what the rotors can do.
fn any_wrench(random: &mut Random) -> Wrench<f64> {
    let reach = 10f64.powi((random.bits() % 3) as i32 - 1);
    let mut number = |most: f64| random.between(-most * reach, most * reach);
    let torque = Vec3::new(number(2.0 * ARM * ROOM), number(2.0 * ARM * ROOM), number(RATIO * 9.0));
    Wrench { thrust: number(4.0 * HIGH), torque }
}

#[test]
fn what_the_rotors_can_make_is_inverted_exactly() {
    let (allocation, mut random) = (allocation(), Random(1));
    for _ in 0..100_000 {
        let u = Vector4::from_fn(|_, _| random.between(LOW, HIGH));
        let asked = wrench(effect() * u);
        let (thrusts, granted) = allocate(&allocation, &asked);
        assert!((Vector4::from(thrusts) - u).amax() < 2e-14, "{u:?}");
        assert!((vector(&granted) - vector(&asked)).amax() < 5e-14, "{u:?}");
    }
}

#[test]
fn no_wrench_asks_a_rotor_beyond_its_limits() {
    let (allocation, mut random) = (allocation(), Random(2));
    for _ in 0..100_000 {
        let (thrusts, _) = allocate(&allocation, &any_wrench(&mut random));
        assert!(thrusts.iter().all(|u| (LOW..=HIGH).contains(u)), "{thrusts:?}");
    }
}

#[test]
fn the_reported_wrench_is_what_the_thrusts_make() {
    let (allocation, mut random) = (allocation(), Random(3));
    for _ in 0..100_000 {
        let (thrusts, granted) = allocate(&allocation, &any_wrench(&mut random));
        let made = effect() * Vector4::from(thrusts);
        assert!((vector(&granted) - made).amax() < 1e-14, "{thrusts:?}");
    }
}

#[test]
fn roll_and_pitch_are_granted_whenever_the_rotors_can() {
    let (allocation, mut random, mut reachable) = (allocation(), Random(4), 0);
    for _ in 0..100_000 {
        let asked = any_wrench(&mut random);
        let (roll, pitch) = (asked.torque.x / ARM, asked.torque.y / ARM);
        let (_, granted) = allocate(&allocation, &asked);
        if roll.abs() <= ROOM && pitch.abs() <= ROOM {
            reachable += 1;
            assert!((granted.torque.x - asked.torque.x).abs() < 1e-14, "{asked:?}");
            assert!((granted.torque.y - asked.torque.y).abs() < 1e-14, "{asked:?}");
        } else {
            // Else the largest torque in the same direction.
            let share = ROOM / if roll.abs() > pitch.abs() { roll.abs() } else { pitch.abs() };
            assert!((granted.torque.x - share * asked.torque.x).abs() < 1e-14, "{asked:?}");
            assert!((granted.torque.y - share * asked.torque.y).abs() < 1e-14, "{asked:?}");
        }
    }
    assert!((30_000..90_000).contains(&reachable), "both kinds must occur: {reachable}");
}

#[test]
fn thrust_is_granted_before_yaw_as_far_as_roll_and_pitch_leave_it() {
    let (allocation, mut random) = (allocation(), Random(5));
    for _ in 0..100_000 {
        let asked = any_wrench(&mut random);
        let within = |x: f64| if x.abs() > ROOM { ROOM / x.abs() } else { 1.0 };
        let (roll, pitch) = (asked.torque.x / ARM, asked.torque.y / ARM);
        let share = if roll.abs() > pitch.abs() { within(roll) } else { within(pitch) };
        let (roll, pitch) = (share * roll.abs(), share * pitch.abs());
        // d = (u2 + u4) - (u1 + u3) makes the yaw. The pair sums (t - d)/2 and (t + d)/2 have limits
        // of their own, so d narrows the thrust; any part of the wish may be granted.
        let wish = asked.torque.z / RATIO;
        let crossing = roll - pitch;
        let part = crossing / wish;
        let candidates = [0.0, wish, if (0.0..=1.0).contains(&part) { crossing } else { 0.0 }];
        let opposite = [0.0, wish, if (-1.0..=0.0).contains(&part) { -crossing } else { 0.0 }];
        let larger = |a: f64, b: f64| if a > b { a } else { b };
        let least = candidates
            .map(|d| 4.0 * LOW + larger(2.0 * pitch + d, 2.0 * roll - d))
            .into_iter()
            .fold(f64::MAX, |a, b| -larger(-a, -b));
        let most = opposite
            .map(|d| 4.0 * HIGH - larger(2.0 * pitch - d, 2.0 * roll + d))
            .into_iter()
            .fold(f64::MIN, larger);
        let want = if asked.thrust < least {
            least
        } else if asked.thrust > most {
            most
        } else {
            asked.thrust
        };
        let (_, granted) = allocate(&allocation, &asked);
        assert!((granted.thrust - want).abs() < 1e-13, "{asked:?}: {granted:?}, not {want}");
    }
}

#[test]
fn yaw_is_granted_as_far_as_a_rotor_has_room_and_never_reversed() {
    let (allocation, mut random, mut cut) = (allocation(), Random(6), 0);
    for _ in 0..100_000 {
        let asked = any_wrench(&mut random);
        let (thrusts, granted) = allocate(&allocation, &asked);
        let share = granted.torque.z / asked.torque.z;
        let room = 1e-15 / asked.torque.z.abs();
        assert!((-room..=1.0 + room).contains(&share), "{asked:?}: {share}");
        if share < 1.0 - 1e-9 {
            cut += 1;
            // A rotor that more yaw would push outside stands at that limit.
            let blocked = (0..4).any(|i| {
                let up = effect()[(3, i)] * asked.torque.z > 0.0;
                (thrusts[i] - if up { HIGH } else { LOW }).abs() < 1e-14
            });
            assert!(blocked, "{asked:?}: {share} of the yaw, {thrusts:?}");
        }
    }
    assert!(cut > 10_000, "saturation must occur: {cut}");
}

#[test]
fn too_much_yaw_takes_nothing_from_the_rest() {
    let allocation = allocation();
    let asked = Wrench { thrust: 6.125, torque: Vec3::new(0.05, -0.08, 5.0) };
    let (thrusts, granted) = allocate(&allocation, &asked);
    assert!((granted.thrust - 6.125).abs() < 1e-14);
    assert!((granted.torque.x - 0.05).abs() < 1e-15 && (granted.torque.y + 0.08).abs() < 1e-15);
    // Rotors 1 and 3 (counter-clockwise) go down for positive yaw until the lower of them, which
    // the pitch unloads to 6.125/4 - 0.04/l or loads to + 0.04/l, meets its limit.
    let down = 6.125 / 4.0 - 0.08 / (2.0 * ARM) - LOW;
    assert!((granted.torque.z - 4.0 * RATIO * down).abs() < 1e-14, "{granted:?} {thrusts:?}");
}

#[test]
fn each_rotor_pushes_as_the_article_s_equations_say() {
    let allocation = allocation();
    // 1 front, 2 right, 3 rear, 4 left: lift at the front pitches the nose up, which is negative
    // about the left axis; a counter-clockwise rotor turns the body clockwise.
    let signs = [[0, -1, -1], [-1, 0, 1], [0, 1, -1], [1, 0, 1]];
    for (rotor, want) in signs.into_iter().enumerate() {
        let mut thrusts = [0.0; 4];
        thrusts[rotor] = 1.0;
        let Wrench { thrust, torque } = allocation.wrench(thrusts);
        assert_eq!(thrust, 1.0);
        let sign = |x: f64| i32::from(x > 0.0) - i32::from(x < 0.0);
        assert_eq!([torque.x, torque.y, torque.z].map(sign), want, "rotor {}", rotor + 1);
    }
}
