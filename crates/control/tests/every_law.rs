//! What holds for every law of every registry, in every combination of its options: eight lanes
//! have the bits of eight single runs, `reset` leaves nothing of the past, and a law stays small.
//!
//! A law added to a registry is tested here without a word in this file.
// Tests compare bits, take the standard library as their second opinion, and print figures as their
// source prints them.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::approx_constant, clippy::float_cmp)]
#![allow(clippy::extra_unused_type_parameters)] // one macro calls both checks alike

mod common;

use common::{Signal, bits, each, every, model, scattered, smooth};
use stormpetrel_control::attitude::{AttitudeLaw, AttitudeLawSettings};
use stormpetrel_control::attitude_reference::{AttitudeReference, AttitudeReferenceSettings};
use stormpetrel_control::controller::{Controller, Observer as _};
use stormpetrel_control::guard::{Guarded, GuardedObserver};
use stormpetrel_control::lanes::Lanes;
use stormpetrel_control::observer::{Observer, ObserverSettings};
use stormpetrel_control::position::{Position, PositionSettings};
use stormpetrel_control::rate::{RateLaw, RateLawSettings};
use stormpetrel_control::real::Real;
use stormpetrel_control::record::{Record, RecordExt};
use stormpetrel_control::registry::Settings;
use stormpetrel_control::signals::{Applied, Measurement};
use stormpetrel_control::stack::{Exit, Laws, Rhythm, Stack};

const LANES: usize = 8;
type Wide = Lanes<f64, LANES>;
const TICKS: u64 = 200;

fn time(tick: u64) -> f64 {
    tick as f64 * 0.004
}

/// Time step of a lane at a tick: one changes it, one sends time backwards once.
fn step(lane: u64, tick: u64) -> f64 {
    match (lane, tick) {
        (6, 120..) => 0.003,
        (2, 90) => -0.004,
        _ => 0.004,
    }
}

/// What a lane sees: a smooth signal of its own; in one lane it is broken for a while.
fn signal<S: Signal>(lane: u64, tick: u64) -> S {
    let mut signal: S = smooth(17 * lane, time(tick));
    if lane == 5 && (60..64).contains(&tick) {
        let mut count = 0;
        each(&mut signal, |_, _, x| {
            count += 1;
            *x = if count == tick - 59 { f64::NAN } else { *x };
        });
    }
    signal
}

/// Calls `check::<Law of single numbers, Law of lanes>(label, build)` for every controller.
macro_rules! every_controller {
    ($check:ident) => {
        every_controller!($check: PositionSettings Position, AttitudeReferenceSettings AttitudeReference,
            AttitudeLawSettings AttitudeLaw, RateLawSettings RateLaw);
    };
    ($check:ident: $($settings:ident $law:ident),+) => { $(
        for (label, settings) in every::<$settings>() {
            let build = |seed| scattered(settings, seed).build(&model());
            $check::<$law<f64>, $law<Wide>>(&format!("{}: {label}", stringify!($law)), build);
        }
    )+ };
}

#[test]
fn eight_lanes_have_the_bits_of_eight_single_runs() {
    fn check<L, W>(label: &str, build: impl Fn(u64) -> L)
    where
        L: Controller<f64> + Record<f64, With<Wide> = W>,
        L::Reference: Signal + Record<f64, With<Wide> = W::Reference>,
        L::Command: Default + Record<f64, With<Wide> = W::Command>,
        W: Controller<Wide>,
        W::Command: Record<Wide, With<f64> = L::Command>,
        Guarded<Wide, W, W::Command>: Record<Wide, With<f64> = Guarded<f64, L, L::Command>>,
    {
        let mut singles: [Guarded<f64, L, L::Command>; LANES] =
            core::array::from_fn(|i| Guarded::new(build(i as u64), L::Command::default()));
        let mut lanes: Guarded<Wide, W, W::Command> =
            RecordExt::<f64>::gather(core::array::from_fn(|i| &singles[i]));
        for tick in 0..TICKS {
            let m: [Measurement<f64>; LANES] = core::array::from_fn(|i| signal(i as u64, tick));
            let r: [L::Reference; LANES] = core::array::from_fn(|i| signal(i as u64 + 100, tick));
            let dt = Wide::from_lanes(|i| step(i as u64, tick));
            let wide_m = RecordExt::<f64>::gather(core::array::from_fn(|i| &m[i]));
            let wide_r = RecordExt::<f64>::gather(core::array::from_fn(|i| &r[i]));
            let wide_command = lanes.update(&wide_m, &wide_r, dt);
            for (i, single) in singles.iter_mut().enumerate() {
                let command = single.update(&m[i], &r[i], dt.lane(i));
                assert_eq!(
                    bits(&wide_command.pick(i)),
                    bits(&command),
                    "{label}, lane {i}, {tick}"
                );
                assert_eq!(bits(&lanes.pick(i)), bits(single), "{label}, lane {i}, tick {tick}");
                let broken = (i == 5 && (60..64).contains(&tick)) || (i == 2 && tick == 90);
                assert_eq!(single.flag, f64::from(u8::from(broken)), "{label}, lane {i}, {tick}");
            }
        }
    }
    every_controller!(check);
}

#[test]
fn eight_observers_have_the_bits_of_eight_single_ones() {
    for (label, settings) in every::<ObserverSettings>() {
        let mut singles: [GuardedObserver<f64, Observer<f64>>; LANES] = core::array::from_fn(|i| {
            GuardedObserver::new(scattered(settings, i as u64).build(&model()))
        });
        let mut lanes: GuardedObserver<Wide, Observer<Wide>> =
            RecordExt::<f64>::gather(core::array::from_fn(|i| &singles[i]));
        for tick in 0..TICKS {
            let m: [Measurement<f64>; LANES] = core::array::from_fn(|i| signal(i as u64, tick));
            let u: [Applied<f64>; LANES] = core::array::from_fn(|i| signal(i as u64 + 100, tick));
            let dt = Wide::from_lanes(|i| step(i as u64, tick));
            lanes.correct(&RecordExt::<f64>::gather(core::array::from_fn(|i| &m[i])), dt);
            lanes.advance(&RecordExt::<f64>::gather(core::array::from_fn(|i| &u[i])), dt);
            for (i, single) in singles.iter_mut().enumerate() {
                single.correct(&m[i], dt.lane(i));
                single.advance(&u[i], dt.lane(i));
                assert_eq!(bits(&lanes.pick(i)), bits(single), "{label}, lane {i}, tick {tick}");
                assert_eq!(bits(&lanes.estimate().pick(i)), bits(&single.estimate()), "{label}");
            }
        }
    }
}

#[test]
fn eight_stacks_have_the_bits_of_eight_single_ones() {
    let positions = every::<PositionSettings>();
    let references = every::<AttitudeReferenceSettings>();
    let (observers, attitudes, rates) =
        (every::<ObserverSettings>(), every::<AttitudeLawSettings>(), every::<RateLawSettings>());
    // Each alternative of each level at least once; the levels are tested one by one above.
    let most = [positions.len(), references.len(), observers.len(), attitudes.len(), rates.len()];
    for (n, rhythm) in (0..most.into_iter().max().unwrap_or(0)).flat_map(|n| {
        let slower = Rhythm { position: 4, attitude: 2, rate: 1 };
        [(n, Rhythm::default()), (n, slower), (n, Rhythm { rate: 3, ..slower })]
    }) {
        let mut singles: [Stack<f64>; LANES] = core::array::from_fn(|i| {
            let (m, i) = (model(), i as u64);
            let laws = Laws {
                position: scattered(positions[n % positions.len()].1, i).build(&m),
                observer: scattered(observers[n % observers.len()].1, i).build(&m),
                attitude_reference: scattered(references[n % references.len()].1, i).build(&m),
                attitude: scattered(attitudes[n % attitudes.len()].1, i).build(&m),
                rate: scattered(rates[n % rates.len()].1, i).build(&m),
            };
            Stack::new(laws, Exit::Wrench, rhythm)
        });
        let mut lanes: Stack<Wide> =
            RecordExt::<f64>::gather(core::array::from_fn(|i| &singles[i]));
        for tick in 50..100 {
            let m: [Measurement<f64>; LANES] = core::array::from_fn(|i| signal(i as u64, tick));
            let r = core::array::from_fn::<_, LANES, _>(|i| signal(i as u64 + 100, tick));
            let u: [Applied<f64>; LANES] = core::array::from_fn(|i| signal(i as u64 + 200, tick));
            let dt = Wide::from_lanes(|i| step(i as u64, tick));
            let command = lanes.update(
                &RecordExt::<f64>::gather(core::array::from_fn(|i| &m[i])),
                &RecordExt::<f64>::gather(core::array::from_fn(|i| &r[i])),
                dt,
            );
            lanes.advance(&RecordExt::<f64>::gather(core::array::from_fn(|i| &u[i])), dt);
            for (i, single) in singles.iter_mut().enumerate() {
                let sent = { *single }.act(&m[i], &r[i], dt.lane(i));
                let one = single.update(&m[i], &r[i], dt.lane(i));
                assert_eq!(
                    bits(&sent.0),
                    bits(&one.thrust.force),
                    "stack {n}, lane {i}, tick {tick}"
                );
                assert_eq!(bits(&sent.1), bits(&one.wrench), "stack {n}, lane {i}, tick {tick}");
                single.advance(&u[i], dt.lane(i));
                assert_eq!(bits(&command.pick(i)), bits(&one), "stack {n}, lane {i}, tick {tick}");
                assert_eq!(bits(&lanes.pick(i)), bits(single), "stack {n}, lane {i}, tick {tick}");
                assert_eq!(lanes.flags().lane(i), single.flags());
            }
        }
    }
}

#[test]
fn reset_leaves_nothing_of_the_past() {
    fn check<L, W>(label: &str, build: impl Fn(u64) -> L)
    where
        L: Controller<f64>,
        L::Reference: Signal,
        L::Command: Default,
    {
        let (mut used, mut fresh) = (build(1), build(1));
        for tick in 0..TICKS {
            used.tune(0.004);
            used.update(&smooth(1, time(tick)), &smooth(2, time(tick)), 0.004);
        }
        let begin: Measurement<f64> = smooth(3, 0.0);
        used.reset(&begin);
        fresh.reset(&begin);
        assert_eq!(bits(&used), bits(&fresh), "{label}");
        used.tune(0.004);
        fresh.tune(0.004);
        for tick in 0..20 {
            let (m, r): (Measurement<f64>, L::Reference) = (smooth(3, time(tick)), smooth(4, 0.0));
            let (a, b) = (used.update(&m, &r, 0.004), fresh.update(&m, &r, 0.004));
            assert_eq!(bits(&a), bits(&b), "{label}, tick {tick}");
        }
        // The guard forgets too: a flight that begins with a broken tick holds nothing old.
        let mut guard = Guarded::new(used, L::Command::default());
        guard.update(&smooth(1, 0.0), &smooth(2, 0.0), 0.004);
        guard.reset(&begin);
        let held = guard.update(&begin, &smooth(2, 0.0), f64::NAN);
        assert_eq!(
            bits(&held),
            bits(&L::Command::default()),
            "{label}: held from before the reset"
        );
    }
    every_controller!(check);
}

#[test]
fn reset_leaves_nothing_of_an_observer_s_past() {
    for (label, settings) in every::<ObserverSettings>() {
        let (mut used, mut fresh) = (settings.build(&model()), settings.build(&model()));
        for tick in 0..TICKS {
            used.correct(&smooth(1, time(tick)), 0.004);
            used.advance(&smooth(2, time(tick)), 0.004);
        }
        let begin: Measurement<f64> = smooth(3, 0.0);
        used.reset(&begin);
        fresh.reset(&begin);
        assert_eq!(bits(&used), bits(&fresh), "{label}");
    }
}

#[test]
fn a_law_is_smaller_than_two_kilobytes() {
    fn check<L, W>(label: &str, _: impl Fn(u64) -> L) {
        assert!(size_of::<L>() < 2048, "{label}: {} bytes", size_of::<L>());
    }
    every_controller!(check);
    assert!(size_of::<Observer<f64>>() < 2048);
}

#[test]
fn the_walk_visits_every_law_and_every_option() {
    let labels = |all: Vec<String>| all.join("; ");
    let rates = every::<RateLawSettings>().into_iter().map(|(label, _)| label).collect();
    assert_eq!(labels(rates), "indi, filter = butterworth; indi, filter = none; pid");
    assert_eq!(every::<ObserverSettings>().len(), 1 + 4);
    assert_eq!(every::<AttitudeReferenceSettings>().len(), 2 * 3 + 3);
    assert_eq!(RateLawSettings::named("INDI").map(|s| s.name()), None);
}
