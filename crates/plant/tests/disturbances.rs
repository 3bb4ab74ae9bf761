//! Disturbances against closed forms: when they act, how strong they are, where they blow.
// Tests take the standard library as their second opinion, and compare what must be exact.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::float_cmp)]

mod common;

use std::f64::consts::{PI, TAU};

use common::{body, source, world};
use stormpetrel_control::math::{Body, Vec3, World};
use stormpetrel_control::options::Cells;
use stormpetrel_plant::disturbance::{
    DisturbanceSettings as Kind, Scene, Site, Source, SourceSettings, Window, chirp, constant,
    gust, imbalance, jet, pulse, ramp, recorded_force, recorded_wind, rotor_efficiency, shear,
    step,
};
use stormpetrel_plant::state::State;

/// Force and torque of everything that pushes.
fn whole() -> (Vec3<f64, World>, Vec3<f64, Body>) {
    (world(3.0, 4.0, -2.0), body(0.2, -0.1, 0.3))
}

fn at(time: f64) -> Scene<f64> {
    Scene { time, tick: time * 1e3, step: 1e-3, ..Scene::default() }
}

fn above(place: Vec3<f64, World>) -> Scene<f64> {
    Scene { state: State { position: place, ..State::default() }, ..at(1.0) }
}

fn built(what: Kind) -> Source<f64> {
    source(what, &common::Scene::default().vehicle)
}

/// The share of force and torque at this time; both must have the same.
fn share(source: &mut Source<f64>, time: f64) -> f64 {
    let ((force, torque), push) = (whole(), source.push(&at(time)));
    let share = push.force.x / force.x;
    assert!((push.force - force * share).norm() < 1e-12, "{time}");
    assert!((push.torque - torque * share).norm() < 1e-12, "{time}");
    share
}

fn near(is: f64, want: f64, what: &str) {
    assert!((is - want).abs() < 1e-12, "{what}: {is} in the place of {want}");
}

#[test]
fn a_disturbance_acts_from_its_onset_until_its_end_on_its_own_clock() {
    let (force, torque) = whole();
    let what = Kind::Ramp(ramp::Gains { force, torque, rise: 4.0 }, ());
    let vehicle = common::Scene::default().vehicle;
    let site = Site { vehicle, step: 1e-3, key: 1 };
    let window = Window { start: 2.0, end: 5.0 };
    let mut ramp = SourceSettings { window, what }.build(&site);
    for (time, want) in
        [(0.0, 0.0), (1.999, 0.0), (2.0, 0.0), (3.0, 0.25), (4.999, 0.74975), (5.0, 0.0)]
    {
        near(share(&mut ramp, time), want, "ramp");
    }
}

#[test]
fn a_constant_a_step_a_ramp_and_a_pulse_have_their_shapes() {
    let (force, torque) = whole();
    let mut constant = built(Kind::Constant(constant::Gains { force, torque }, ()));
    let mut lag = built(Kind::Step(step::Gains { force, torque, rise: 0.5 }, ()));
    let mut sudden = built(Kind::Step(step::Gains { force, torque, rise: 0.0 }, ()));
    let mut ramp = built(Kind::Ramp(ramp::Gains { force, torque, rise: 2.0 }, ()));
    for time in [0.0, 0.3, 0.5, 1.0, 2.0, 7.0] {
        near(share(&mut constant, time), 1.0, "constant");
        near(share(&mut sudden, time), 1.0, "sudden step");
        near(share(&mut lag, time), 1.0 - f64::exp(-time / 0.5), "step");
        near(share(&mut ramp, time), f64::min(time / 2.0, 1.0), "ramp");
    }
    let gains = pulse::Gains { force, torque, width: 0.25, period: 1.0 };
    let mut pulse = built(Kind::Pulse(gains, ()));
    for (time, want) in
        [(0.0, 1.0), (0.249, 1.0), (0.25, 0.0), (0.999, 0.0), (3.1, 1.0), (3.3, 0.0)]
    {
        near(share(&mut pulse, time), want, "pulse");
    }
}

#[test]
fn a_chirp_sweeps_from_one_frequency_to_the_other_and_stays_there() {
    let (force, torque) = whole();
    let gains = chirp::Gains { force, torque, from: 1.0, to: 9.0, sweep: 10.0 };
    let mut chirp = built(Kind::Chirp(gains, ()));
    let mut crossings = [0, 0];
    for tick in 0..20_000 {
        let time = (f64::from(tick) + 0.5) * 1e-3;
        let (before, after) = (share(&mut chirp, time), share(&mut chirp, time + 1e-3));
        crossings[usize::from(time > 10.0)] += i32::from(before * after < 0.0);
    }
    // Turns: the mean of both frequencies times 10 s, then 9 Hz; two crossings each, the one at a seam aside.
    assert!((crossings[0] - 100).abs() <= 1 && (crossings[1] - 180).abs() <= 1, "{crossings:?}");
    near(share(&mut chirp, 5.0), (TAU * (5.0 + 8.0 * 25.0 / 20.0)).sin(), "middle");
}

#[test]
fn a_gust_is_half_at_half_time_whole_at_its_top_and_gone_after_twice() {
    let velocity = world(4.0, -2.0, 1.0);
    let mut gust = built(Kind::Gust(gust::Gains { velocity, rise: 3.0 }, ()));
    for (time, want) in [(0.0, 0.0), (1.5, 0.5), (3.0, 1.0), (4.5, 0.5), (6.0, 0.0), (60.0, 0.0)] {
        assert!((gust.wind(&at(time)) - velocity * want).norm() < 1e-12, "{time}");
    }
    near(gust.wind(&at(1.0)).x, 2.0 * (1.0 - (PI / 3.0).cos()), "a third of the way");
}

#[test]
fn shear_follows_the_logarithmic_law_of_the_specification() {
    // MIL-F-8785C, 3.7.3.4: ln(h/0.15 ft)/ln(20/0.15) times the wind at 20 ft; 1.3289 at 100 ft.
    let foot = 0.3048;
    let velocity = world(6.0, 0.0, 0.0);
    let gains = shear::Gains { velocity, height: 20.0 * foot, roughness: 0.15 * foot, ground: 5.0 };
    let mut shear = built(Kind::Shear(gains, ()));
    let mut wind = |feet: f64| shear.wind(&above(world(7.0, 1.0, 5.0 + feet * foot))).x / 6.0;
    near(wind(20.0), 1.0, "20 ft");
    assert!((wind(100.0) - 1.3289).abs() < 1e-4, "{}", wind(100.0));
    near(wind(0.15), 0.0, "roughness");
    near(wind(-3.0), 0.0, "below the ground");
}

#[test]
fn a_jet_decays_and_spreads_as_the_published_self_similar_one() {
    // Pope 2000, table 5.1: u0/u = x/(5.8 d), half width 0.096 x.
    let outlet = world(1.0, 2.0, 3.0);
    let along = world(0.6, 0.0, 0.8);
    let gains = jet::Gains { outlet, velocity: along * 10.0, diameter: 0.1 };
    let mut jet = built(Kind::Jet(gains, ()));
    let across = world(0.8, 0.0, -0.6);
    for distance in [3.0, 4.0, 6.0] {
        let axis = jet.wind(&above(outlet + along * distance));
        assert!((axis - along * (10.0 * 5.8 * 0.1 / distance)).norm() < 1e-12, "{distance}");
        let aside = outlet + along * distance + across * (0.096 * distance);
        assert!((jet.wind(&above(aside)) - axis * 0.5).norm() < 1e-12, "{distance}");
    }
    assert_eq!(jet.wind(&above(outlet - along)).norm(), 0.0, "behind the outlet");
}

#[test]
fn recordings_are_straight_between_rows_and_constant_outside() {
    let cells: &'static [f64] = Vec::leak(vec![1.0, 2.0, 0.0, -4.0, 3.0, 6.0, 0.0, 4.0]);
    let options = recorded_wind::Options { recording: Cells { cells, file: "" }.into() };
    let mut wind = built(Kind::RecordedWind(recorded_wind::Gains { scale: 0.5 }, options));
    for (time, x, z) in
        [(0.0, 2.0, -4.0), (1.0, 2.0, -4.0), (1.5, 3.0, -2.0), (3.0, 6.0, 4.0), (9.0, 6.0, 4.0)]
    {
        assert!((wind.wind(&at(time)) - world(x, 0.0, z) * 0.5).norm() < 1e-12, "{time}");
    }
    let rows = vec![0.0, 1.0, 2.0, 3.0, 0.1, 0.2, 0.3, 2.0, 3.0, 2.0, 1.0, 0.3, 0.2, 0.1];
    let cells: &'static [f64] = Vec::leak(rows);
    let options = recorded_force::Options { recording: Cells { cells, file: "" }.into() };
    let mut force = built(Kind::RecordedForce(recorded_force::Gains { scale: 2.0 }, options));
    let push = force.push(&at(1.0));
    assert!((push.force - world(4.0, 4.0, 4.0)).norm() < 1e-12);
    assert!((push.torque - body(0.4, 0.4, 0.4)).norm() < 1e-12);
}

#[test]
fn an_unbalanced_propeller_turns_its_centrifugal_force_with_the_rotor() {
    let vehicle = common::Scene::default().vehicle;
    let gains = imbalance::Gains { rotor: 2.0, unbalance: 1e-5 };
    let mut imbalance = built(Kind::Imbalance(gains, ()));
    let mount = vehicle.mounts()[1];
    // A quarter of a turn in each tick.
    let mut scene = at(0.0);
    scene.state.rotor_speed = [100.0, PI / 2.0 * 1e3, 200.0, 300.0];
    let size = 1e-5 * (PI / 2.0 * 1e3).powi(2);
    let mut before = imbalance.push(&scene).force;
    for _ in 0..8 {
        let push = imbalance.push(&scene);
        near(push.force.norm() / size, 1.0, "size");
        let turned = world(-before.y, before.x, 0.0) * mount.spin;
        assert!((push.force - turned).norm() < 1e-9 * size, "a quarter of a turn");
        let torque = mount.place.cross(push.force.assume_frame());
        assert!((push.torque - torque).norm() < 1e-12);
        before = push.force;
    }
}

#[test]
fn a_weak_rotor_is_that_rotor_and_no_other() {
    let gains = rotor_efficiency::Gains { rotor: 3.0, efficiency: 0.7 };
    let faults = built(Kind::RotorEfficiency(gains, ())).rotors(&at(1.0));
    assert_eq!((faults.health, faults.stuck), ([1.0, 1.0, 0.7, 1.0], [0.0; 4]));
}
