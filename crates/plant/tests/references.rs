//! References and disturbances: every derivative is the derivative of the one before, and values are
//! those of the article.
// Tests compare bits, take the standard library as their second opinion, and print figures as their
// source prints them.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::approx_constant, clippy::float_cmp)]

mod common;

use common::{Scene, bits, body, named, source, world};
use stormpetrel_control::lanes::Lanes;
use stormpetrel_control::math::{Vec3, World};
use stormpetrel_control::options::OptionVisitor;
use stormpetrel_control::record::{Meta, Path, RecordExt, VisitorMut};
use stormpetrel_control::registry::Settings;
use stormpetrel_control::signals::Trajectory;
use stormpetrel_plant::disturbance::{self, DisturbanceSettings, harmonic};
use stormpetrel_plant::dynamics::Push;
use stormpetrel_plant::reference::{Refer, Reference, ReferenceSettings};

/// Gives every number another value inside its range.
struct Stir(f64);

impl VisitorMut<f64> for Stir {
    fn number(&mut self, _: &Path<'_>, meta: &Meta, value: &mut f64) {
        self.0 += 0.37;
        let stirred = *value + self.0.sin();
        if stirred > meta.range.0 && stirred < meta.range.1 {
            *value = stirred;
        }
    }
}

impl OptionVisitor for Stir {}

fn reference(name: &str, seed: f64) -> Reference<f64> {
    let mut settings = named::<ReferenceSettings>(name);
    settings.settings(&mut Stir(seed));
    settings.build(&Scene::default().vehicle)
}

/// First derivative from six neighbours, error of order h^6.
fn derivative(f: impl Fn(f64) -> Vec3<f64, World>) -> Vec3<f64, World> {
    const H: f64 = 0.004;
    let pair = |k: f64| f(k * H) - f(-k * H);
    (pair(1.0) * 0.75 - pair(2.0) * 0.15 + pair(3.0) * (1.0 / 60.0)) * (1.0 / H)
}

#[test]
fn every_derivative_of_every_reference_is_the_derivative_of_the_one_before() {
    type Part = fn(&Trajectory<f64>) -> Vec3<f64, World>;
    let chain: [(&str, Part, Part); 6] = [
        ("velocity", |r| r.position, |r| r.velocity),
        ("acceleration", |r| r.velocity, |r| r.acceleration),
        ("jerk", |r| r.acceleration, |r| r.jerk),
        ("snap", |r| r.jerk, |r| r.snap),
        ("yaw rate", |r| Vec3::up(r.yaw), |r| Vec3::up(r.yaw_rate)),
        ("yaw acceleration", |r| Vec3::up(r.yaw_rate), |r| Vec3::up(r.yaw_acceleration)),
    ];
    for name in ReferenceSettings::NAMES {
        for seed in 0..20 {
            let reference = reference(name, f64::from(seed));
            // The snap of a ramp has kinks at its ends; the jerk of a line jumps between its segments.
            for t in [0.2, 0.7, 3.1, 12.0] {
                let jerk = |h: f64| reference.at(t + h).jerk;
                if name == &"line" && (jerk(-0.012) - jerk(0.012)).norm() > 1e-9 {
                    continue;
                }
                for (label, before, after) in chain {
                    let want = derivative(|h| before(&reference.at(t + h)));
                    let got = after(&reference.at(t));
                    let room = 1e-9 * (1.0 + want.norm());
                    assert!((got - want).norm() < room, "{name}, {label} at {t} s, seed {seed}");
                }
            }
        }
    }
}

#[test]
fn eight_references_side_by_side_have_the_bits_of_single_ones() {
    for name in ReferenceSettings::NAMES {
        let singles: [Reference<f64>; 8] = std::array::from_fn(|i| reference(name, i as f64));
        let lanes: Reference<Lanes<f64, 8>> =
            RecordExt::<f64>::gather(std::array::from_fn(|i| &singles[i]));
        for tick in 0..400 {
            let times: [f64; 8] = std::array::from_fn(|i| tick as f64 * (0.01 + 0.003 * i as f64));
            let at = lanes.at(Lanes(times));
            for (i, single) in singles.iter().enumerate() {
                assert_eq!(bits(&at.pick(i)), bits(&single.at(times[i])), "{name}, lane {i}");
            }
        }
    }
}

#[test]
fn the_helix_is_that_of_the_article() {
    let helix = named::<ReferenceSettings>("helix").build(&Scene::default().vehicle);
    for t in [0.0f64, 1.0, 7.5, 20.0] {
        let want = world(2.0 * (0.5 * t).sin(), 2.0 * (0.5 * t).cos(), 0.5 * t);
        assert!((helix.at(t).position - want).norm() < 1e-14, "{t} s");
        assert_eq!(helix.at(t).yaw, 0.0);
    }
}

fn pushed(gains: harmonic::Gains<f64>, time: f64) -> Push<f64> {
    let vehicle = Scene::default().vehicle;
    let at = disturbance::Scene { time, mass: vehicle.mass, ..disturbance::Scene::default() };
    source(DisturbanceSettings::Harmonic(gains, ()), &vehicle).push(&at)
}

#[test]
fn the_disturbance_is_that_of_the_article_in_either_reading() {
    // As a force in newtons, and literally, as an acceleration, which is m times as much force.
    let force = harmonic::Gains {
        force: Vec3::splat(50.0),
        torque: Vec3::splat(0.5),
        ..harmonic::Gains::default()
    };
    let literal = harmonic::Gains { acceleration: Vec3::splat(50.0), ..harmonic::Gains::default() };
    for t in [0.0f64, 0.4, 2.0, 17.3] {
        let h = 1.0 + t.sin() + t.cos();
        let push = pushed(force, t);
        assert!((push.force - Vec3::splat(50.0 * h)).norm() < 1e-13, "{t} s");
        assert!((push.torque - body(0.5, 0.5, 0.5) * h).norm() < 1e-15, "{t} s");
        let push = pushed(literal, t);
        assert!((push.force - Vec3::splat(0.625 * 50.0 * h)).norm() < 1e-13, "{t} s");
    }
}

#[test]
fn each_part_of_the_disturbance_has_its_own_amplitude_and_the_clock_its_own_rate() {
    let gains = harmonic::Gains {
        force: world(1.0, -2.0, 3.0),
        offset: 0.3,
        sine: -0.7,
        cosine: 1.9,
        frequency: 2.5,
        ..harmonic::Gains::default()
    };
    for t in [0.0f64, 0.9, 4.2] {
        let h = 0.3 - 0.7 * (2.5 * t).sin() + 1.9 * (2.5 * t).cos();
        let push = pushed(gains, t);
        assert!((push.force - world(1.0, -2.0, 3.0) * h).norm() < 1e-14, "{t} s");
        assert_eq!(push.torque.norm(), 0.0);
    }
}
