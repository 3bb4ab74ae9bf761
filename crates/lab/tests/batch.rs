//! Flights that share lanes, leave them at different times and make room for others, against single ones.

use stormpetrel_lab::fly::{Outcome, fly, fly_batch_at};
use stormpetrel_lab::scenario::{Scenario, load_text};
use stormpetrel_plant::dispatch::Width;

const BASE: &str = r#"
run                = { duration = 0.4, control_step = 0.001, substeps = 1, late = 0.2 }
vehicle            = { model = "article-corrected" }
reference          = { shape = "helix" }
position           = { law = "pid" }
observer           = { law = "hosm" }
attitude_reference = { law = "rotation", rates = "commanded" }
attitude           = { law = "tilt-priority" }
rate               = { law = "indi" }
actuation          = { kind = "rotors" }
failure            = { allowed = true }
disturbance        = [{ kind = "harmonic", force = 0.5 }]
"#;

fn scenario(sets: &[String]) -> Scenario {
    let file = load_text("batch", "batch", BASE.to_owned(), sets).expect("a good scenario");
    file.scenarios.into_iter().next().expect("one scenario")
}

/// Flights of different mass, length, step and structure; some fail, each at another time.
fn flights() -> Vec<Scenario> {
    let one = |i: u32| {
        let mut sets = vec![
            format!("vehicle.mass={}", 0.4 + 0.03 * f64::from(i)),
            format!("run.duration={}", 0.1 * f64::from(1 + i % 4)),
            format!("run.control_step={}", if i.is_multiple_of(5) { 0.002 } else { 0.001 }),
            format!("start.offset.x={}", 0.2 * f64::from(i % 3)),
        ];
        if i.is_multiple_of(3) {
            sets.push(format!("failure.position_error={}", 0.05 + 0.002 * f64::from(i)));
        }
        if i % 7 == 2 {
            sets.push("observer.law=none".to_owned());
        }
        scenario(&sets)
    };
    (0..30).map(one).collect()
}

/// Flights through the whole world, with loops of their own rates, onsets and seeds of their own.
fn worldly() -> Vec<Scenario> {
    let one = |i: u32| {
        let x = f64::from(i);
        scenario(&[
            "vehicle={ model = \"hummingbird\" }".to_owned(),
            "actuation={ kind = \"propulsion\", supply = \"battery\" }".to_owned(),
            format!(
                "disturbance=[{{ kind = \"dryden\", mean = [4, {x}, 0] }}, {{ kind = \"payload\", mass = 0.1, \
                 start = {}, end = {} }}, {{ kind = \"slung-mass\", start = {} }}]",
                0.02 * x,
                0.05 + 0.03 * x,
                0.01 * x
            ),
            "sensor=[{ kind = \"gyro\" }, { kind = \"accelerometer\" }, { kind = \"gnss\", dropout = 0.2 }, \
             { kind = \"magnetometer\" }]"
                .to_owned(),
            "rates={ position_every = 7, attitude_every = 2 }".to_owned(),
            format!("timing={{ computation_delay = {}, dropped = 0.05 }}", 0.001 * f64::from(i % 3)),
            format!("run.duration={}", 0.1 * f64::from(1 + i % 4)),
            format!("run.seed={i}"),
        ])
    };
    (0..12).map(one).collect()
}

fn bits(outcome: &Outcome) -> Vec<(&str, u64)> {
    let failure = outcome.failure.map_or(-1.0, |failure| failure.time);
    let named = outcome.metrics.iter().map(|(name, value)| (*name, value.to_bits()));
    named.chain([("failure", failure.to_bits())]).collect()
}

/// Lanes share laws, options and rates; what only numbers tell apart flies together.
#[test]
fn flights_with_other_choices_do_not_share_lanes() {
    let structure = |sets: &[&str]| {
        let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
        scenario(&sets).structure()
    };
    let plain = structure(&[]);
    for alike in ["vehicle.mass=0.5", "run.seed=4", "vehicle.model=article", "start.offset.x=0.1"] {
        assert_eq!(structure(&[alike]), plain, "{alike}");
    }
    let others = [
        "observer.law=none",
        "observer.input=commanded",
        "observer.z2=doubled",
        "attitude_reference.rates=none",
        "disturbance=[]",
        "disturbance=[{ kind = \"harmonic\" }, { kind = \"harmonic\" }]",
        "reference.shape=hover",
        "run.substeps=2",
        "rates={ position_every = 2 }",
    ];
    let mut seen = vec![plain];
    for other in others {
        let one = structure(&[other]);
        assert!(!seen.contains(&one), "{other}: {one}");
        seen.push(one);
    }
}

#[test]
fn a_flight_through_the_world_has_the_same_bits_in_any_lane() {
    let flights = worldly();
    let alone: Vec<Outcome> = flights.iter().map(|scenario| fly(scenario, |_, _| {})).collect();
    let together = fly_batch_at(&flights, Width::widest());
    for (i, (a, b)) in alone.iter().zip(&together).enumerate() {
        assert_eq!(bits(a), bits(b), "flight {i}");
    }
    assert_ne!(bits(&alone[0]), bits(&alone[4]), "each has a wind of its own");
}

#[test]
fn a_flight_has_the_same_bits_whoever_flew_in_its_lane_before() {
    let flights = flights();
    let alone: Vec<Outcome> = flights.iter().map(|scenario| fly(scenario, |_, _| {})).collect();
    let failed = alone.iter().filter(|outcome| outcome.failure.is_some()).count();
    assert!((3..25).contains(&failed), "{failed} failures: lanes should empty early and late");
    for width in Width::available().filter(|w| *w == Width::Baseline || !cfg!(debug_assertions)) {
        let together = fly_batch_at(&flights, width);
        assert_eq!(together.len(), alone.len());
        for ((a, b), scenario) in alone.iter().zip(&together).zip(&flights) {
            assert_eq!(
                bits(a),
                bits(b),
                "{}: mass {}",
                width.name(),
                scenario.vehicle.vehicle.mass
            );
            assert_eq!(a.failure.map(|f| f.cause), b.failure.map(|f| f.cause));
        }
    }
}
