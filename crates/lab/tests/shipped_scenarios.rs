//! Every shipped scenario loads, flies and shows the numbers of its `[expect]` table; the golden values
//! there are those of an independent computation (theory 1.3 and 1.4).
// Tests compare bits, take the standard library as their second opinion, and print figures as their
// source prints them.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::approx_constant, clippy::float_cmp)]

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use stormpetrel_control::registry::Settings as _;
use stormpetrel_lab::fly::{fly, on_all_cores};
use stormpetrel_lab::scenario::{Scenario, load_text};
use stormpetrel_lab::sensitivity::spread;
use stormpetrel_lab::shipped::{SHIPPED, shipped};
use stormpetrel_plant::vehicle::VehicleSettings;

fn scenarios() -> Vec<Scenario> {
    let files = SHIPPED.iter().filter_map(|(name, _)| shipped(name));
    files.flat_map(|file| file.unwrap_or_else(|faults| panic!("{faults}")).scenarios).collect()
}

#[test]
fn val_every_flight_shows_its_expected_numbers() {
    let mut scenarios = scenarios();
    if cfg!(debug_assertions) {
        // Ten kilohertz and no optimisation take minutes: the release run has all of them.
        scenarios.retain(|s| s.ticks() <= 20_000 && !s.expect.is_empty());
    }
    let wrong: Vec<String> = on_all_cores(&scenarios, |scenario| {
        let outcome = fly(scenario, |_, _| {});
        let mut wrong = Vec::new();
        if outcome.failure.is_some() && !scenario.may_fail() {
            wrong.push(format!("{}: {:?}", scenario.name, outcome.failure));
        }
        for expectation in &scenario.expect {
            let value = outcome.get(&expectation.metric).unwrap_or(f64::NAN);
            if !expectation.holds(value) {
                let rule = expectation.describe();
                wrong.push(format!("{}: {} = {value}: {rule}", scenario.name, expectation.metric));
            }
        }
        wrong
    })
    .concat();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Every preset is a vehicle that can exist, and hovers.
#[test]
fn every_preset_hovers() {
    let (_, text) = SHIPPED.iter().find(|(name, _)| *name == "hover").expect("hover is shipped");
    for name in VehicleSettings::NAMES {
        let set = format!("vehicle={{ model = \"{name}\" }}");
        let file = load_text("hover", "hover.toml", (*text).to_owned(), &[set]);
        let file = file.unwrap_or_else(|faults| panic!("{name}: {faults}"));
        let outcome = fly(&file.scenarios[0], |_, _| {});
        assert!(outcome.failure.is_none(), "{name}: {:?}", outcome.failure);
        let most = outcome.get("position.max").unwrap_or(f64::NAN);
        assert!(most < 1e-9, "{name}: {most} m");
    }
}

#[test]
fn golden_values_stand_in_the_files() {
    // A file that lost its [expect] would pass every flight.
    let count = |file: &str| {
        let of_file = |s: &&Scenario| s.name.starts_with(&format!("{file}:"));
        scenarios().iter().filter(of_file).map(|s| s.expect.len()).sum::<usize>()
    };
    assert_eq!(count("article/consistent"), 8 * 5 + 2, "theory 1.4: eight rows, and the PD row");
    assert_eq!(count("article/translational"), 10 * 4, "theory 1.3: ten rows");
    assert_eq!(count("article/literal"), 2 + 3, "theory 1.4 (a)");
    assert_eq!(count("article/stress"), 2 + 4 + 4, "theory 1.4, stress levels");
}

#[test]
fn every_file_in_the_folder_is_shipped() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    let mut found = BTreeSet::new();
    for part in ["", "article/", "references/", "world/"] {
        for entry in fs::read_dir(folder.join(part)).expect("the scenario folder") {
            let name = entry.expect("an entry").file_name().to_string_lossy().into_owned();
            if let Some(stem) = name.strip_suffix(".toml") {
                found.insert(format!("{part}{stem}"));
            }
        }
    }
    let shipped: BTreeSet<String> = SHIPPED.iter().map(|(name, _)| (*name).to_owned()).collect();
    assert_eq!(found, shipped);
}

#[test]
fn the_literal_reading_is_sensitive_and_the_consistent_one_is_not() {
    let find = |name: &str| scenarios().into_iter().find(|s| s.name == name).expect("the scenario");
    let mut literal = find("article/literal:printed");
    let mut consistent = find("article/consistent:rate-commanded");
    if cfg!(debug_assertions) {
        // Chaos takes a few seconds of flight to grow from 1e-9 m to a per cent.
        literal.run.duration = 12.0;
        consistent.run.duration = 2.0;
    }
    let range = spread(&literal).expect("chaos").range("position.iae").expect("an IAE");
    assert!(range.max > range.min * 1.01, "{range:?}");
    assert!(spread(&consistent).is_none());
}
