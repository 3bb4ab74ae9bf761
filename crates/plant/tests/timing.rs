//! Loops at their own rates, and commands that come late or not at all.
// Tests compare bits.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::float_cmp)]

mod common;

use common::{Scene, bits, hosm, named, step};
use stormpetrel_control::observer::hosm::{Input, Z2};
use stormpetrel_control::signals::Wrench;
use stormpetrel_control::stack::Rhythm;
use stormpetrel_plant::disturbance::Disturbance;
use stormpetrel_plant::flight::Flight;
use stormpetrel_plant::reference::Refer as _;
use stormpetrel_plant::timing::{Delays, LATEST, Timing};

fn flight(delays: Delays<f64>) -> Flight<f64> {
    let scene = Scene {
        actuation: named("rotors"),
        observer: hosm(1.5, Input::Measured, Z2::Single),
        ..Scene::default()
    };
    let mut flight = scene.flight();
    flight.timing = Timing::new(delays, 5);
    flight.start(flight.state);
    flight
}

/// What reached the rotors and what the laws decided, tick by tick.
fn sent_and_acting(delays: Delays<f64>, ticks: usize) -> (Vec<Wrench<f64>>, Vec<Wrench<f64>>) {
    let mut flight = flight(delays);
    (0..ticks)
        .map(|_| {
            let tick = flight.decide();
            flight.advance(&tick);
            (flight.decided.wrench, tick.command.wrench)
        })
        .unzip()
}

#[test]
fn a_command_arrives_as_many_ticks_late_as_both_delays_say() {
    for (computation_delay, actuator_delay, ticks) in
        [(0.001, 0.0, 1), (0.0, 0.004, 4), (0.002, 0.003, 5), (0.02, 0.011, LATEST)]
    {
        let delays = Delays { computation_delay, actuator_delay, ..Delays::default() };
        let (sent, acting) = sent_and_acting(delays, 200);
        for k in ticks..200 {
            assert_eq!(bits(&acting[k]), bits(&sent[k - ticks]), "{ticks} late, tick {k}");
        }
        assert_ne!(bits(&acting[100]), bits(&sent[100]), "something is decided anew each tick");
        // Before the first command arrives the rotors carry the weight.
        assert_eq!((acting[0].thrust, acting[0].torque.norm()), (0.625 * 9.8, 0.0));
    }
}

#[test]
fn jitter_stays_within_its_bound_and_nothing_overtakes() {
    let delays = Delays { computation_delay: 0.002, jitter: 0.003, ..Delays::default() };
    let mut flight = flight(delays);
    let (mut before, mut seen) = (0.0, [0u32; 6]);
    for tick in 0..4000 {
        step(&mut flight);
        let age = flight.timing.age;
        assert!(age <= before + 1.0 && (age >= 2.0 || tick < 2) && age <= 5.0, "{age}");
        seen[age as usize] += 1;
        before = age;
    }
    // u is uniform over four values; the older ones are cut short by the rule against jumps.
    assert!(seen[2] > 900 && seen[3] > 500 && seen[4] > 100, "{seen:?}");
}

#[test]
fn a_share_of_the_ticks_is_dropped_and_the_command_before_is_sent_again() {
    let mut flight = flight(Delays { dropped: 0.3, ..Delays::default() });
    let mut dropped = 0;
    for _ in 0..4000 {
        let (stack, decided) = (bits(&flight.stack), bits(&flight.decided));
        let tick = flight.decide();
        if bits(&flight.stack) == stack {
            assert_eq!(bits(&flight.decided), decided, "sent again");
            dropped += 1;
        }
        flight.advance(&tick);
    }
    // Four standard deviations of a binomial share.
    let share = f64::from(dropped) / 4000.0;
    assert!((share - 0.3).abs() < 4.0 * (0.3f64 * 0.7 / 4000.0).sqrt(), "{share}");
}

#[test]
fn each_level_acts_at_its_own_rate() {
    let mut flight = flight(Delays::default());
    flight.stack.every = Rhythm { position: 10, attitude: 2, rate: 1 };
    assert_eq!(flight.period(), 10);
    let mut held = [bits(&flight.stack.position), bits(&flight.stack.attitude)];
    for tick in 0..2000u32 {
        step(&mut flight);
        let now = [bits(&flight.stack.position), bits(&flight.stack.attitude)];
        for (level, every) in [(0, 10), (1, 2)] {
            let acted = now[level] != held[level];
            assert!(!acted || tick.is_multiple_of(every), "level {level} at tick {tick}");
            assert!(acted || !tick.is_multiple_of(every), "level {level} rests at tick {tick}");
        }
        held = now;
    }
    let error = flight.state.position - flight.reference.at(flight.time()).position;
    assert!(error.norm() < 0.5, "it still flies: {error:?}");
}

#[test]
fn an_observer_at_a_tenth_of_the_rate_finds_the_same_force() {
    // A steady push: the estimate ends at it, whatever the rate; the mean of what was applied is exact.
    let mut flight = flight(Delays::default());
    for source in &mut flight.disturbance {
        if let Disturbance::Harmonic(push) = &mut source.what {
            (push.gains.sine, push.gains.cosine) = (0.0, 0.0);
        }
    }
    flight.stack.every = Rhythm { position: 10, attitude: 1, rate: 1 };
    for _ in 0..15_000 {
        step(&mut flight);
    }
    let tick = flight.decide();
    let error = tick.estimate.force - tick.disturbance.lumped;
    assert!(error.norm() < 0.1, "{error:?}");
}
