//! Eight flights, side by side in lanes or as four pairs, have the bits of single flights, whatever becomes of
//! each.
//!
//! The eight differ in mass, inertia, gains, disturbance and time step; one leaves its limits half
//! way, one is pushed so hard that its state overflows.
// Tests compare bits, take the standard library as their second opinion, and print figures as their
// source prints them.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::approx_constant, clippy::float_cmp)]

mod common;

use common::{Scene, bits, body, gains, hosm, named, rotation_reference, step};
use stormpetrel_control::attitude_reference::Rates;
use stormpetrel_control::lanes::Lanes;
use stormpetrel_control::observer::ObserverSettings;
use stormpetrel_control::observer::hosm::{Input, Z2};
use stormpetrel_control::options::{Cells, OptionVisitor, Shape};
use stormpetrel_control::real::Real;
use stormpetrel_control::record::{Meta, Path, RecordExt, VisitorMut};
use stormpetrel_control::registry::Settings;
use stormpetrel_plant::disturbance::{Site, SourceSettings};
use stormpetrel_plant::flight::{Cause, Flight, Tick};
use stormpetrel_plant::timing::{Delays, Timing};

const LANES: usize = 8;
const TICKS: u64 = 2000;

fn scene(i: usize, actuation: &str, observer: ObserverSettings) -> Scene {
    let x = i as f64;
    let mut scene = Scene {
        actuation: named(actuation),
        observer,
        position: gains(5.0 + 0.3 * x, 2.0 - 0.1 * x, 3.5 + 0.2 * x),
        ..Scene::default()
    };
    scene.vehicle.mass = 0.5 + 0.05 * x;
    scene.vehicle.inertia = body(2.4e-3 + 1e-5 * x, 2.5e-3, 2.6e-3 + 2e-5 * x);
    scene.vehicle.motor_lag = 0.015 + 1e-3 * x;
    scene.disturbance.force = scene.disturbance.force * (0.2 * x);
    scene.disturbance.torque = scene.disturbance.torque * (0.3 * x);
    scene.disturbance.frequency = 0.7 + 0.1 * x;
    scene.control_step = 1e-3 - 2e-5 * x;
    scene
}

fn singles(actuation: &str, observer: ObserverSettings) -> [Flight<f64>; LANES] {
    core::array::from_fn(|i| {
        let mut scene = scene(i, actuation, observer);
        if i == 6 {
            scene.disturbance.acceleration.x = 1e306;
            scene.disturbance.force.x = 1e308;
            scene.disturbance.offset = -1.0; // -1 + sin t + cos t: zero at first, then growing
            scene.disturbance.torque.x = 1e305;
        }
        let mut flight = scene.flight();
        if i == 3 {
            flight.limits.position_error = 0.01;
        }
        flight
    })
}

type Eight = Lanes<f64, LANES>;
#[cfg(all(feature = "std", target_arch = "x86_64"))]
use stormpetrel_plant::pair::Pair;
/// Where there are no pairs, lanes once more.
#[cfg(not(all(feature = "std", target_arch = "x86_64")))]
type Pair = Eight;

/// Eight flights, as many at a time as the scalar has lanes.
struct Together<T>(Vec<Flight<T>>);

impl<T: Real<Scalar = f64>> Together<T> {
    fn new(singles: &[Flight<f64>; LANES]) -> Self {
        let group = |group: &[Flight<f64>]| {
            let mut all: Flight<T> = group[0].everywhere();
            for (lane, single) in group.iter().enumerate() {
                single.put_lane(&mut all, lane);
            }
            all
        };
        Self(singles.chunks(T::LANES).map(group).collect())
    }

    fn tick(&mut self) -> Vec<Tick<T>> {
        self.0.iter_mut().map(tick_of).collect()
    }

    fn flight(&self, i: usize) -> Flight<f64> {
        self.0[i / T::LANES].pick_lane(i % T::LANES)
    }
}

/// One tick; compiled once for all tests.
#[inline(never)]
fn tick_of<T: Real>(flight: &mut Flight<T>) -> Tick<T> {
    let decided = flight.decide();
    flight.advance(&decided);
    decided
}

fn compare<T: Real<Scalar = f64>>(actuation: &str, observer: ObserverSettings) {
    let mut singles = singles(actuation, observer);
    let mut lanes = Together::<T>::new(&singles);
    for tick in 0..TICKS {
        let decided = lanes.tick();
        for (i, single) in singles.iter_mut().enumerate() {
            if tick % 50 == 7 {
                let one = single.decide();
                assert_eq!(
                    bits(&decided[i / T::LANES].pick_lane(i % T::LANES)),
                    bits(&one),
                    "{actuation}, lane {i}, tick {tick}"
                );
                single.advance(&one);
                assert_eq!(
                    bits(&lanes.flight(i)),
                    bits(single),
                    "{actuation}, lane {i}, tick {tick}"
                );
            } else {
                step(single);
            }
            let state = lanes.flight(i).state;
            assert_eq!(bits(&state), bits(&single.state), "{actuation}, lane {i}, tick {tick}");
        }
    }
    let cause = |i: usize| Cause::from_code(singles[i].cause);
    assert_eq!(cause(3), Some(Cause::PositionError), "{actuation}: lane 3 fails on its way");
    assert!(singles[3].flown > 20.0 && singles[3].flown < TICKS as f64);
    assert_ne!(cause(6), None, "{actuation}: lane 6 is torn apart");
    for i in [0, 1, 2, 4, 5, 7] {
        assert_eq!(cause(i), None, "{actuation}: lane {i} flies on");
        assert_eq!(singles[i].flown, TICKS as f64);
    }
}

fn all_observers(actuation: &str) {
    for observer in [
        named("none"),
        hosm(1.5, Input::Measured, Z2::Single),
        hosm(2.0, Input::Commanded, Z2::Doubled),
    ] {
        compare::<Eight>(actuation, observer);
        compare::<Pair>(actuation, observer);
    }
}

#[test]
fn eight_point_masses_have_the_bits_of_single_ones() {
    all_observers("thrust-vector");
}

#[test]
fn eight_flights_with_ideal_wrench_have_the_bits_of_single_ones() {
    all_observers("wrench");
}

#[test]
fn eight_flights_with_lagged_wrench_have_the_bits_of_single_ones() {
    all_observers("lagged-wrench");
}

#[test]
fn eight_flights_on_rotors_have_the_bits_of_single_ones() {
    all_observers("rotors");
}

/// Brings every number of a disturbance to life, differently for each lane.
struct Alive(f64);

impl VisitorMut<f64> for Alive {
    fn number(&mut self, path: &Path<'_>, meta: &Meta, value: &mut f64) {
        let (lo, hi) = meta.range;
        let wanted = match (path.name(), meta.unit) {
            ("rotor", _) => 1.0 + self.0 % 4.0,
            ("start", _) => 0.01 * self.0,
            ("end", _) => 0.3 + 0.02 * self.0,
            _ if *value == 0.0 => 0.02 * (self.0 - 3.5),
            _ => *value * (1.0 + 0.02 * self.0),
        };
        *value = wanted.max(lo).min(hi);
    }
}

impl OptionVisitor for Alive {
    fn rows(&mut self, _: &'static str, _: &'static str, shape: &Shape, _: Cells) -> Cells {
        let columns = shape.columns.len();
        let cells: Vec<f64> = (0..4 * columns)
            .map(|k| if k % columns == 0 { 0.1 * (k / columns) as f64 } else { 0.01 * k as f64 })
            .collect();
        Cells { cells: Vec::leak(cells), file: "" }
    }
}

/// Eight flights through the whole world, with these disturbances.
fn worldly(kinds: &[&str]) -> [Flight<f64>; LANES] {
    let tables: Vec<SourceSettings> = kinds
        .iter()
        .map(|kind| {
            let mut settings: SourceSettings = named(kind);
            settings.settings(&mut Alive(0.0));
            settings
        })
        .collect();
    core::array::from_fn(|i| {
        let mut scene = scene(i, "propulsion", hosm(1.5, Input::Measured, Z2::Single)).calm();
        let vehicle = &mut scene.vehicle;
        vehicle.motor_lag_fall = 0.03 + 1e-3 * i as f64;
        vehicle.rotor_drag = body(0.1 + 0.01 * i as f64, 0.1, 0.05);
        vehicle.rotor_inertia = 1e-6;
        vehicle.rotor_radius = 0.05;
        vehicle.inflow_loss = 1e-6;
        let mut flight = scene.flight();
        let delays = Delays {
            computation_delay: 0.001 * (i % 3) as f64,
            jitter: 0.002,
            dropped: 0.1,
            ..Delays::default()
        };
        flight.timing = Timing::new(delays, 17 + i as u64);
        for (slot, table) in flight.disturbance.iter_mut().zip(&tables) {
            let mut settings = *table;
            struct Numbers(Alive);
            impl VisitorMut<f64> for Numbers {
                fn number(&mut self, path: &Path<'_>, meta: &Meta, value: &mut f64) {
                    self.0.number(path, meta, value);
                }
            }
            impl OptionVisitor for Numbers {}
            settings.settings(&mut Numbers(Alive(i as f64)));
            let site = Site { vehicle: flight.vehicle, step: flight.control_step, key: i as u64 };
            *slot = settings.build(&site);
        }
        flight.start(flight.state);
        flight
    })
}

fn compare_worlds<T: Real<Scalar = f64>>(kinds: &[&str]) {
    let mut singles = worldly(kinds);
    let mut lanes = Together::<T>::new(&singles);
    for tick in 0..400 {
        lanes.tick();
        for (i, single) in singles.iter_mut().enumerate() {
            step(single);
            assert_eq!(bits(&lanes.flight(i)), bits(single), "{kinds:?}, lane {i}, tick {tick}");
        }
    }
}

#[test]
fn every_disturbance_has_the_bits_of_a_single_one_in_every_lane() {
    let many = [
        "dryden",
        "jet",
        "noise",
        "payload",
        "slung-mass",
        "rotor-efficiency",
        "imbalance",
        "gust",
    ];
    for kinds in SourceSettings::NAMES.chunks(1).chain([many.as_slice()]) {
        compare_worlds::<Eight>(kinds);
        compare_worlds::<Pair>(kinds);
    }
}

#[test]
fn a_clock_that_began_long_ago_changes_no_bit() {
    // 71.5 min of microseconds and 49.7 days of milliseconds: where counters of 32 bits wrap.
    for late in [4_290_000u64, 4_294_080_000] {
        for mut early in
            worldly(&["dryden", "noise", "imbalance", "slung-mass", "gust", "rotor-lost"])
        {
            let mut shifted = Flight { tick: late, begin: late as f64, ..early };
            for tick in 0..400 {
                step(&mut early);
                step(&mut shifted);
                assert_eq!(bits(&early.state), bits(&shifted.state), "tick {tick}");
            }
        }
    }
}

#[test]
fn eight_flights_with_other_laws_have_the_bits_of_single_ones() {
    compare_laws::<Eight>();
    compare_laws::<Pair>();
}

fn compare_laws<T: Real<Scalar = f64>>() {
    for (rates, attitude, rate) in
        [(Rates::Commanded, "euler", "pid"), (Rates::Trajectory, "tilt-priority", "pid")]
    {
        let mut singles: [Flight<f64>; LANES] = core::array::from_fn(|i| {
            let mut scene = scene(i, "rotors", named("none"));
            scene.attitude_reference = rotation_reference(rates);
            (scene.attitude, scene.rate) = (named(attitude), named(rate));
            scene.flight()
        });
        let mut lanes = Together::<T>::new(&singles);
        for tick in 0..TICKS / 4 {
            lanes.tick();
            for (i, single) in singles.iter_mut().enumerate() {
                step(single);
                let state = lanes.flight(i).state;
                assert_eq!(bits(&state), bits(&single.state), "lane {i}, {tick}");
            }
        }
    }
}
