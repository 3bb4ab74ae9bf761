//! Rates, delays, jitter and losses.

use crate::rig::{ALL, channel, clock, height, samples, still, timed};
use stormpetrel_plant::sensor::link::Timing;

#[test]
fn every_sensor_samples_at_whole_periods_and_arrives_after_the_declared_ticks() {
    let dt = 2e-3;
    for kind in ALL {
        for (rate_hz, late) in
            [(500.0, 0), (500.0, 3), (100.0, 0), (100.0, 1), (100.0, 35), (80.0, 20)]
        {
            let timing = Timing { rate_hz, latency: late as f64 * dt, jitter: 0.0, dropout: 0.0 };
            let period = (1.0 / (rate_hz * dt)).round() as u64;
            let got = samples(&mut channel(timed(kind, timing), 1, &still()), 400, dt, |_| still());
            let ticks: Vec<u64> = got.iter().map(|(tick, _)| *tick).collect();
            let want: Vec<u64> =
                (0..400 - late).step_by(period as usize).map(|t| t + late).collect();
            assert_eq!(ticks, want, "{kind} at {rate_hz} Hz, {late} ticks late");
            assert!(got.iter().all(|(_, s)| s.age == late as f64 * dt), "{kind}");
        }
    }
    for late in [0, 1, 7, 35] {
        let timing = Timing { rate_hz: 100.0, latency: late as f64 * dt, ..Timing::default() };
        for (tick, sample) in samples(&mut height(timing, 1), 400, dt, clock) {
            assert_eq!(sample.values[0], (tick - late) as f64);
        }
    }
}

#[test]
fn jitter_delays_within_its_bounds_and_keeps_the_order() {
    let dt = 1e-3;
    let timing = Timing { rate_hz: 100.0, latency: 5e-3, jitter: 0.03, dropout: 0.0 };
    let got = samples(&mut height(timing, 3), 20_000, dt, clock);
    let taken: Vec<f64> = got.iter().map(|(_, s)| s.values[0]).collect();
    assert!(taken.windows(2).all(|w| w[1] == w[0] + 10.0), "each once and in order");
    let ages: Vec<f64> = got.iter().map(|(tick, s)| *tick as f64 - s.values[0]).collect();
    for ((_, sample), age) in got.iter().zip(&ages) {
        assert!((sample.age - age * dt).abs() < 1e-12 && (5.0..=36.0).contains(age), "{age}");
    }
    // A sample that is overtaken waits; the rest spread evenly, so the mean lies above their middle.
    let mean = ages.iter().sum::<f64>() / ages.len() as f64;
    assert!((20.0..25.0).contains(&mean), "{mean}");
}

#[test]
fn the_declared_share_of_samples_is_lost() {
    for dropout in [0.0, 0.05, 0.5, 1.0] {
        let timing = Timing { rate_hz: 500.0, latency: 4e-3, jitter: 0.0, dropout };
        let n = 40_000.0;
        let got = samples(&mut height(timing, 4), 80_000, 1e-3, clock).len() as f64;
        let room = 4.0 * (n * dropout * (1.0 - dropout)).sqrt() + 2.0;
        assert!((got - n * (1.0 - dropout)).abs() <= room, "{dropout}: {got} of {n}");
    }
}

#[test]
fn what_finds_no_room_is_lost_and_the_rest_arrives_in_order() {
    // Fifty periods of delay, which the check refuses: eight places are left.
    let timing = Timing { rate_hz: 1000.0, latency: 0.05, jitter: 0.0, dropout: 0.0 };
    let mut one = height(timing, 8);
    let got = samples(&mut one, 500, 1e-3, clock);
    let taken: Vec<f64> = got.iter().map(|(_, s)| s.values[0]).collect();
    assert_eq!(taken[..9], [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 51.0]);
    assert!(got.iter().all(|(tick, s)| *tick as f64 - s.values[0] == 50.0));
    assert_eq!(one.link.waiting, 8.0);
}
