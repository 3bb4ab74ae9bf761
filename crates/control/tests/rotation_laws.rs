//! Rotations against nalgebra, which was written by others: group laws, vectors, matrices, angles.
//!
//! Quaternions are drawn from the whole unit sphere, with half turns and tiny angles more often
//! than chance would have them.
// Tests compare bits, take the standard library as their second opinion, and print figures as their
// source prints them.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::approx_constant, clippy::float_cmp)]

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use proptest::prelude::*;
use stormpetrel_control::math::{Body, Euler, Rotation, Vec3, World};

type R = Rotation<f64, Body, World>;

/// A dozen roundings of numbers near one.
const TINY: f64 = 3e-15;

fn quaternion() -> impl Strategy<Value = [f64; 4]> {
    let component =
        || prop_oneof![4 => -1.0..1.0, 1 => Just(0.0), 1 => -1e-9..1e-9, 1 => Just(1.0)];
    [component(), component(), component(), component()]
        .prop_map(|q: [f64; 4]| {
            let norm = q.iter().map(|c| c * c).sum::<f64>().sqrt();
            q.map(|c| c / norm)
        })
        .prop_filter("a direction", |q| q[0].is_finite())
}

fn vector() -> impl Strategy<Value = [f64; 3]> {
    [-10.0..10.0, -10.0..10.0, -10.0..10.0]
}

fn ours([w, x, y, z]: [f64; 4]) -> R {
    Rotation::from_quaternion(w, x, y, z)
}

fn theirs([w, x, y, z]: [f64; 4]) -> UnitQuaternion<f64> {
    UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(w, x, y, z))
}

fn plain<F>(v: Vec3<f64, F>) -> Vector3<f64> {
    Vector3::new(v.x, v.y, v.z)
}

fn matrix(r: R) -> Matrix3<f64> {
    Matrix3::from_columns(&[plain(r.x_axis()), plain(r.y_axis()), plain(r.z_axis())])
}

/// Largest difference between two quaternions that may differ in sign.
fn apart<A, B>(a: Rotation<f64, A, B>, b: &UnitQuaternion<f64>) -> f64 {
    let b = b.quaternion();
    let difference = |s: f64| {
        [a.w - s * b.w, a.x - s * b.i, a.y - s * b.j, a.z - s * b.k]
            .into_iter()
            .fold(0.0, |worst: f64, d| worst.max(d.abs()))
    };
    difference(1.0).min(difference(-1.0))
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn composing_is_the_quaternion_product(a in quaternion(), b in quaternion()) {
        let second: Rotation<f64, World, World> = {
            let [w, x, y, z] = a;
            Rotation::from_quaternion(w, x, y, z)
        };
        let product = second * ours(b);
        let want = (theirs(a) * theirs(b)).into_inner();
        // No freedom of sign here: the Hamilton product itself is meant.
        for (got, want) in [(product.w, want.w), (product.x, want.i), (product.y, want.j), (product.z, want.k)] {
            prop_assert!((got - want).abs() < TINY);
        }
    }

    #[test]
    fn the_inverse_undoes(q in quaternion(), v in vector()) {
        let r = ours(q);
        let both = r.inverse() * r;
        prop_assert!((both.w - 1.0).abs() < TINY && both.vector().norm() < TINY);
        let v = Vec3::new(v[0], v[1], v[2]);
        prop_assert!((r.inverse() * (r * v) - v).norm() < 20.0 * TINY);
        prop_assert!(apart(r.inverse(), &theirs(q).inverse()) < TINY);
    }

    #[test]
    fn vectors_turn_as_in_nalgebra(q in quaternion(), v in vector()) {
        let got = ours(q) * Vec3::new(v[0], v[1], v[2]);
        let want = theirs(q) * Vector3::from(v);
        prop_assert!((plain(got) - want).norm() < 20.0 * TINY);
    }

    #[test]
    fn the_axes_are_the_columns_of_a_proper_orthogonal_matrix(q in quaternion()) {
        let m = matrix(ours(q));
        prop_assert!((m - theirs(q).to_rotation_matrix().into_inner()).abs().max() < TINY);
        prop_assert!((m.determinant() - 1.0).abs() < TINY);
        prop_assert!((m.transpose() * m - Matrix3::identity()).abs().max() < TINY);
    }

    #[test]
    fn the_article_s_matrix_has_the_article_s_entries(
        roll in -3.1..3.1, pitch in -1.5..1.5, yaw in -3.1..3.1,
    ) {
        let ((sr, cr), (sp, cp)) = (f64::sin_cos(roll), f64::sin_cos(pitch));
        let (sy, cy) = f64::sin_cos(yaw);
        // As printed in the article.
        #[rustfmt::skip]
        let want = Matrix3::new(
            cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,
            sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,
            -sp,     cp * sr,                cp * cr,
        );
        let r = R::from_euler(Euler { roll, pitch, yaw });
        prop_assert!((matrix(r) - want).abs().max() < TINY);
        let oracle = Rotation3::from_euler_angles(roll, pitch, yaw).into_inner();
        prop_assert!((matrix(r) - oracle).abs().max() < TINY);
    }

    #[test]
    fn euler_angles_come_back(roll in -3.14..3.14, pitch in -1.57..1.57, yaw in -3.14..3.14) {
        let back = R::from_euler(Euler { roll, pitch, yaw }).euler();
        // Near 90 deg of pitch the angles are ill-conditioned: an error of one rounding in the
        // matrix grows by 1/cos(pitch).
        let room = 10.0 * TINY / f64::cos(pitch);
        prop_assert!((back.roll - roll).abs() < room);
        prop_assert!((back.pitch - pitch).abs() < room);
        prop_assert!((back.yaw - yaw).abs() < room);
    }

    #[test]
    fn a_rotation_comes_back_from_its_axes(q in quaternion()) {
        let (r, m) = (ours(q), theirs(q).to_rotation_matrix());
        let column = |i: usize| Vec3::new(m[(0, i)], m[(1, i)], m[(2, i)]);
        let back = R::from_axes(column(0), column(1), column(2));
        prop_assert!(apart(back, &theirs(q)) < TINY);
        prop_assert!(apart(R::from_axes(r.x_axis(), r.y_axis(), r.z_axis()), &theirs(q)) < TINY);
        prop_assert!((back.w.powi(2) + back.vector().norm_squared() - 1.0).abs() < TINY);
    }

    #[test]
    fn the_angle_is_that_of_nalgebra_and_ignores_the_sign(q in quaternion()) {
        let want = theirs(q).angle();
        prop_assert!((ours(q).angle() - want).abs() < TINY);
        prop_assert_eq!(ours(q).angle(), ours(q.map(|c| -c)).angle());
        prop_assert!((0.0..=std::f64::consts::PI + TINY).contains(&ours(q).angle()));
    }

    #[test]
    fn small_angles_keep_all_their_digits(exponent in -150.0..-1.0) {
        let angle = 10f64.powf(exponent);
        let r = R::from_quaternion((angle / 2.0).cos(), (angle / 2.0).sin(), 0.0, 0.0);
        prop_assert!((r.angle() / angle - 1.0).abs() < TINY);
    }

    #[test]
    fn normalising_restores_the_norm_and_keeps_the_rotation(q in quaternion(), k in 1e-3..1e3) {
        let r = ours(q.map(|c| c * k)).normalised();
        prop_assert!(apart(r, &theirs(q)) < TINY);
    }

    #[test]
    fn a_norm_that_is_nearly_one_is_restored_like_any_other(
        q in quaternion(), exponent in -16.0..1.0, sign in prop_oneof![Just(-1.0), Just(1.0)],
    ) {
        let k: f64 = 1.0 + 0.9 * sign * 10f64.powf(exponent).min(1.0);
        let r = ours(q.map(|c| c * k)).renormalised();
        let norm = [r.w, r.x, r.y, r.z].iter().map(|c| c * c).sum::<f64>().sqrt();
        prop_assert!((norm - 1.0).abs() < 1e-15, "norm {norm} after {k}");
        prop_assert!(apart(r, &theirs(q)) < 1e-15);
    }

    #[test]
    fn the_shortest_form_is_the_same_rotation_with_positive_scalar(q in quaternion()) {
        let r = ours(q).shortest();
        prop_assert!(r.w >= 0.0);
        prop_assert!(apart(r, &theirs(q)) == 0.0);
    }

    #[test]
    fn products_of_vectors_are_those_of_nalgebra(a in vector(), b in vector()) {
        let (u, v): (Vec3<f64, Body>, Vec3<f64, Body>) =
            (Vec3::new(a[0], a[1], a[2]), Vec3::new(b[0], b[1], b[2]));
        let (p, q) = (Vector3::from(a), Vector3::from(b));
        prop_assert!((u.dot(v) - p.dot(&q)).abs() < 1e-13);
        prop_assert!((plain(u.cross(v)) - p.cross(&q)).norm() < 1e-13);
        prop_assert!((u.norm() - p.norm()).abs() < 1e-14);
    }
}
