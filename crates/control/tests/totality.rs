//! Whatever comes in, a finite command within the limit goes out: any bits in every field of the
//! measurement, of the reference, of the step, and of the law's own state.
//!
//! Oracle: the bare law on the same input. Where input, step, its state or its command is not
//! finite, the guard must hold its last command and raise the flag; elsewhere it must stay out.
// Tests compare bits, take the standard library as their second opinion, and print figures as their
// source prints them.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::approx_constant, clippy::float_cmp)]

mod common;

use common::{Random, Signal, bits, each, every, model, numbers, smooth};
use proptest::collection::vec;
use proptest::prelude::*;
use stormpetrel_control::attitude::AttitudeLawSettings;
use stormpetrel_control::attitude_reference::AttitudeReferenceSettings;
use stormpetrel_control::controller::{Controller, Observer};
use stormpetrel_control::guard::{Guarded, GuardedObserver};
use stormpetrel_control::observer::ObserverSettings;
use stormpetrel_control::position::PositionSettings;
use stormpetrel_control::rate::RateLawSettings;
use stormpetrel_control::real::Real;
use stormpetrel_control::record::{Record, clamp};
use stormpetrel_control::signals::{Applied, Measurement};

const DT: f64 = 0.004;

/// A number of any kind: ordinary, from the edge of the format, or any bits.
fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -10.0..10.0,
        1 => any::<u64>().prop_map(f64::from_bits),
        1 => prop::sample::select(vec![
            f64::NAN, -f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0, -0.0, f64::MAX, f64::MIN,
            f64::MIN_POSITIVE, 5e-324, 1e150, -1e150, 1e-150, f64::from_bits(0x7FF0_0000_0000_0001),
        ]),
    ]
}

/// One tick of the attack: the numbers to deal out, and which places they hit.
#[derive(Clone, Debug)]
struct Blow {
    numbers: Vec<f64>,
    /// Every how many places one is hit; 1 hits all.
    measurement: usize,
    reference: usize,
    state: usize,
    dt: Option<f64>,
}

fn blow() -> impl Strategy<Value = Blow> {
    let density = || prop_oneof![2 => Just(usize::MAX), 1 => Just(1_usize), 2 => 2..40_usize];
    (vec(any_number(), 60), density(), density(), density(), prop::option::of(any_number()))
        .prop_map(|(numbers, measurement, reference, state, dt)| Blow {
            numbers,
            measurement,
            reference,
            state,
            dt,
        })
}

/// Whether the state was hit by something huge but finite: it then counts as a state like any other.
fn swollen(blows: &[Blow]) -> bool {
    blows
        .iter()
        .any(|b| b.state < usize::MAX && b.numbers.iter().any(|x| x.is_finite() && x.abs() > 1e6))
}

/// Puts the numbers into every `density`-th place; settings are spared, as files are checked.
fn hit<R: Record<f64>>(record: &mut R, numbers: &[f64], density: usize) {
    let mut place = 0;
    each(record, |name, _, value| {
        place += 1;
        if place % density == 0 && !name.starts_with("gains.") && !name.starts_with("model.") {
            *value = numbers[place % numbers.len()];
        }
    });
}

fn finite(record: &impl Record<f64>) -> bool {
    numbers(record).into_iter().all(f64::is_finite)
}

fn within<R: Record<f64>>(record: &R, limit: f64) -> bool {
    numbers(record).into_iter().all(|x| x.is_finite() && x.abs() <= limit)
}

/// A step is a time that can pass, and no gap.
fn passes(dt: f64) -> bool {
    dt > 0.0 && dt <= 1.0
}

fn attack<L>(label: &str, law: L, limit: f64, blows: &[Blow]) -> Result<(), TestCaseError>
where
    L: Controller<f64>,
    L::Reference: Signal,
    L::Command: Default,
{
    let mut law = law;
    each(&mut law, |name, _, x| *x = if name == "gains.limit" { limit } else { *x });
    let mut guard = Guarded::new(law, L::Command::default());
    for (tick, blow) in (0..).zip(blows) {
        let (mut m, mut r): (Measurement<f64>, L::Reference) = (smooth(tick, 0.0), smooth(1, 0.0));
        hit(&mut m, &blow.numbers, blow.measurement);
        hit(&mut r, &blow.numbers[20..], blow.reference);
        hit(&mut guard, &blow.numbers[40..], blow.state); // what is held and the flag included
        let dt = blow.dt.unwrap_or(DT);
        let mut bare = guard.law;
        bare.tune(dt);
        let raw = bare.update(&m, &r, dt);
        let input = finite(&m) && finite(&r) && passes(dt);
        let good = input && finite(&raw) && finite(&bare);

        let command = guard.update(&m, &r, dt);
        prop_assert!(within(&command, limit), "{label}, tick {tick}: {:?}", numbers(&command));
        prop_assert_eq!(guard.flag, if good { 0.0 } else { 1.0 }, "{}, tick {}", label, tick);
        prop_assert!(finite(&guard), "{label}, tick {tick}: the state stays broken");
        if good {
            prop_assert_eq!(bits(&command), bits(&clamp(&raw, limit)), "{}", label);
        } else {
            // Held again at a second bad tick: the same command.
            let again = guard.update(&m, &r, f64::NAN);
            prop_assert_eq!(bits(&command), bits(&again), "{}: held", label);
        }
    }
    // The first good tick may still meet huge numbers that were taken for real, or a broken state.
    let (m, r): (Measurement<f64>, L::Reference) = (smooth(1, 0.0), smooth(2, 0.0));
    prop_assert!(within(&guard.update(&m, &r, DT), limit), "{label}: after the attack");
    prop_assert!(within(&guard.update(&m, &r, DT), limit), "{label}: after the attack");
    prop_assert!(swollen(blows) || guard.flag == 0.0, "{label}: the flag stays up");
    Ok(())
}

/// Whether the observer's guard waits for a good measurement to begin anew.
fn lost<O: Observer<f64>>(mut guard: GuardedObserver<f64, O>) -> bool {
    let mut lost = None;
    each(&mut guard, |name, _, x| lost = if name == "lost" { Some(*x != 0.0) } else { lost });
    lost.expect("the guard's mark has a name")
}

fn attack_observer<O>(label: &str, law: O, blows: &[Blow]) -> Result<(), TestCaseError>
where
    O: Observer<f64>,
{
    let mut guard = GuardedObserver::new(law);
    let limit = law.limit();
    for (tick, blow) in (0..).zip(blows) {
        let (mut m, mut u): (Measurement<f64>, Applied<f64>) = (smooth(tick, 0.0), smooth(1, 0.0));
        hit(&mut m, &blow.numbers, blow.measurement);
        hit(&mut u, &blow.numbers[20..], blow.reference);
        hit(&mut guard, &blow.numbers[40..], blow.state);
        let dt = blow.dt.unwrap_or(DT);
        let good_dt = passes(dt);

        // An observer that was lost begins anew with a good measurement; that tick counts as mended.
        let (mut bare, lost) = (guard.law, lost(guard));
        let input = finite(&m) && good_dt;
        if lost && input {
            bare.reset(&m);
        }
        bare.correct(&m, dt);
        let good = input && !lost && finite(&bare);
        guard.correct(&m, dt);
        if input && finite(&bare) {
            prop_assert_eq!(bits(&guard.law), bits(&bare), "{}, tick {}", label, tick);
        }
        prop_assert!(within(&guard.estimate(), limit), "{label}, tick {tick}");
        prop_assert_eq!(guard.flag, if good { 0.0 } else { 1.0 }, "{}, tick {}", label, tick);

        let mut bare = guard.law;
        bare.advance(&u, dt);
        let good = good && finite(&u) && good_dt && finite(&bare);
        guard.advance(&u, dt);
        prop_assert!(within(&guard.estimate(), limit), "{label}, tick {tick}");
        prop_assert_eq!(guard.flag, if good { 0.0 } else { 1.0 }, "{}, tick {}", label, tick);
    }
    for _ in 0..2 {
        guard.correct(&smooth(1, 0.0), DT);
        guard.advance(&smooth(2, 0.0), DT);
        prop_assert!(within(&guard.estimate(), limit), "{label}: after the attack");
    }
    prop_assert!(finite(&guard), "{label}: the state stays broken");
    prop_assert!(swollen(blows) || guard.flag == 0.0, "{label}: the flag stays up");
    Ok(())
}

const CASES: u32 = if cfg!(debug_assertions) { 500 } else { 20_000 };

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(CASES) })]

    #[test]
    fn every_command_is_finite_and_within_its_limit(
        blows in vec(blow(), 1..6), limit in prop_oneof![Just(1e6), 1.0..30.0],
    ) {
        for (label, settings) in every::<PositionSettings>() {
            attack(&label, settings.build(&model()), limit, &blows)?;
        }
        for (label, settings) in every::<AttitudeReferenceSettings>() {
            attack(&label, settings.build(&model()), limit, &blows)?;
        }
        for (label, settings) in every::<AttitudeLawSettings>() {
            attack(&label, settings.build(&model()), limit, &blows)?;
        }
        for (label, settings) in every::<RateLawSettings>() {
            attack(&label, settings.build(&model()), limit, &blows)?;
        }
    }

    #[test]
    fn every_estimate_is_finite_and_within_its_limit(blows in vec(blow(), 1..6)) {
        for (label, settings) in every::<ObserverSettings>() {
            attack_observer(&label, settings.build(&model()), &blows)?;
        }
    }
}

#[test]
fn a_step_that_cannot_pass_holds_the_command_and_the_state() {
    for dt in [0.0, -0.0, -DT, 1.1, f64::MAX, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for (label, settings) in every::<RateLawSettings>() {
            let mut guard = Guarded::new(settings.build(&model()), Default::default());
            let first = guard.update(&smooth(1, 0.0), &smooth(2, 0.0), DT);
            let before = bits(&guard.law);
            let held = guard.update(&smooth(3, 0.0), &smooth(4, 0.0), dt);
            assert_eq!((bits(&held), guard.flag), (bits(&first), 1.0), "{label}, dt {dt}");
            assert_eq!(bits(&guard.law), before, "{label}, dt {dt}");
        }
    }
}

#[test]
fn a_sum_without_a_value_does_not_load_the_integral() {
    // Finite, but its square is not: the thrust axis is infinite, and infinity times nothing
    // refused is not a number. It must not end as an integral at its limit.
    let (_, settings) = every::<PositionSettings>()[0].clone();
    let mut guard = Guarded::new(settings.build(&model()), Default::default());
    let mut m: Measurement<f64> = smooth(1, 0.0);
    let mut r = smooth(2, 0.0);
    guard.update(&m, &r, DT);
    let good = guard.law;
    m.attitude.x = 1e200;
    guard.update(&m, &r, DT);
    assert_eq!(guard.flag, 1.0, "an integral that is not a number is not a good state");
    m = smooth(1, DT);
    r = smooth(2, DT);
    let command = guard.update(&m, &r, DT);
    assert!(numbers(&command).into_iter().all(|x| x.abs() < 1e3), "{command:?}");
    assert!(numbers(&good).len() == numbers(&guard.law).len());
}

#[test]
fn broken_gains_still_give_finite_commands() {
    let mut random = Random(3);
    for (label, settings) in every::<RateLawSettings>() {
        for _ in 0..200 {
            let mut guard = Guarded::new(settings.build(&model()), Default::default());
            each(&mut guard, |_, _, x| {
                if random.bits().is_multiple_of(5) {
                    *x = f64::from_bits(random.bits() | 0x7FF0_0000_0000_0000);
                }
            });
            for _ in 0..3 {
                let command = guard.update(&smooth(1, 0.0), &smooth(2, 0.0), DT);
                assert!(finite(&command), "{label}: {command:?} of {guard:?}");
            }
        }
    }
    assert!(Real::is_finite(DT));
}
