//! `run`: fly a file.

use std::path::Path;

use indicatif::ProgressBar;
use serde_json::{Map, Value, json};
use stormpetrel_lab::figures::{self, Drawing};
use stormpetrel_lab::fly::{Cause, Failure as Failed, fly_told_apart};
use stormpetrel_lab::log::Csv;
use stormpetrel_lab::output::{Folder, manifest_json, metrics_json, variants_json};
use stormpetrel_lab::plot::png;
use stormpetrel_lab::reproduce::{Flown, Table};
use stormpetrel_lab::scenario::fault::{Fault, Faults, printable};
use stormpetrel_lab::scenario::{File, Scenario, load, too_long};
use stormpetrel_lab::sensitivity::{STARTS, spread};
use stormpetrel_lab::trace::Trace;

use crate::args::{Common, Run};
use crate::{Failure, terminal};

/// Points of a trace for figures.
const POINTS: u64 = 20_000;

/// Flies every variant of the file, or the chosen one.
pub fn run(args: &Run, common: &Common) -> Result<(), Failure> {
    let file = load(&args.file, &args.sets)?;
    let scenarios = choose(file, args.variant.as_deref())?;
    if let Some(fault) = too_long(&scenarios) {
        return Err(Faults::from(fault).into());
    }
    let broken = |error| Failure::out(&args.out, &error);
    let folder = begin(&args.out, &scenarios).map_err(broken)?;
    let bar = terminal::progress("flying", common.quiet || common.json);
    terminal::with_share(&bar);
    bar.set_length(scenarios.iter().map(Scenario::ticks).sum());
    let single = scenarios.len() == 1;
    let mut flights = Vec::new();
    for scenario in scenarios {
        let (prefix, end) = (prefix(&scenario, single), bar.position() + scenario.ticks());
        flights.push(fly_into(&folder, &prefix, scenario, &bar).map_err(broken)?);
        bar.set_position(end);
    }
    bar.finish_and_clear();
    folder.publish().map_err(broken)?;
    report(&flights, &args.out, common)
}

/// A result folder with a folder for each variant, where there are several.
pub fn begin(out: &Path, scenarios: &[Scenario]) -> std::io::Result<Folder> {
    let parts = parts(scenarios);
    let folder = Folder::with_parts(out, &parts)?;
    if !parts.is_empty() {
        let manifest = format!("{:#}\n", variants_json(&parts));
        folder.write("manifest.json", manifest.as_bytes())?;
    }
    Ok(folder)
}

/// Where in the result folder the files of a flight stand.
pub fn prefix(scenario: &Scenario, single: bool) -> String {
    match &scenario.variant {
        Some(variant) if !single => format!("{variant}/"),
        _ => String::new(),
    }
}

/// Folders in the result folder: one a variant, where there are several.
fn parts(scenarios: &[Scenario]) -> Vec<&str> {
    let several = scenarios.len() > 1;
    scenarios.iter().filter(|_| several).filter_map(|s| s.variant.as_deref()).collect()
}

/// The flights of the file, or the one variant that is asked for.
pub fn choose(file: File, variant: Option<&str>) -> Result<Vec<Scenario>, Failure> {
    let Some(variant) = variant else { return Ok(file.scenarios) };
    let known: Vec<_> = file.scenarios.iter().filter_map(|s| s.variant.clone()).collect();
    let chosen: Vec<_> =
        file.scenarios.into_iter().filter(|s| s.variant.as_deref() == Some(variant)).collect();
    if chosen.is_empty() {
        let help = if known.is_empty() {
            "the file has no variants".into()
        } else {
            format!("known: {}", known.join(", "))
        };
        let fault = Fault::general(format!("unknown variant `{variant}`")).help(help);
        return Err(Faults::from(fault).into());
    }
    Ok(chosen)
}

/// Ticks after which the bar moves.
const STRIDE: u64 = 10_000;

/// Flies one scenario and writes log, metrics, manifest and figures; the bar counts its ticks.
pub fn fly_into(
    folder: &Folder,
    prefix: &str,
    scenario: Scenario,
    bar: &ProgressBar,
) -> std::io::Result<Flown> {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // a whole number by rule
    let every = scenario.run.log_every as u64;
    let file = folder.create(&format!("{prefix}flight.csv"))?;
    let mut csv = Csv::new(file, every, &scenario)?;
    let mut trace = Trace::new(scenario.ticks(), POINTS);
    let mut written = Ok(());
    let mut flown = 0u64;
    let outcome = fly_told_apart(&scenario, |seen| {
        flown += 1;
        if flown.is_multiple_of(STRIDE) {
            bar.inc(STRIDE);
        }
        trace.push(seen);
        if written.is_ok() {
            written = csv.push(seen);
        }
    });
    written?;
    csv.finish()?;
    let spread = spread(&scenario);
    let pretty = |value: &Value| format!("{value:#}\n");
    let metrics = pretty(&metrics_json(&outcome, spread.as_ref()));
    folder.write(&format!("{prefix}metrics.json"), metrics.as_bytes())?;
    folder
        .write(&format!("{prefix}manifest.json"), pretty(&manifest_json(&scenario)).as_bytes())?;
    draw(folder, prefix, &figures::all(&scenario, &trace))?;
    Ok(Flown { scenario, outcome, spread, trace })
}

/// Writes figures as SVG and PNG.
pub fn draw(folder: &Folder, prefix: &str, drawings: &[Drawing]) -> std::io::Result<()> {
    for drawing in drawings {
        folder.write(&format!("{prefix}{}.svg", drawing.name), drawing.svg.as_bytes())?;
        let image = png(&drawing.svg, 1.0).map_err(std::io::Error::other)?;
        folder.write(&format!("{prefix}{}.png", drawing.name), &image)?;
    }
    Ok(())
}

/// Says what the flights came to; fails where an expectation or a flight did.
fn report(flights: &[Flown], out: &Path, common: &Common) -> Result<(), Failure> {
    let bad = print_unmet(flights, common.json || common.quiet);
    if common.json {
        let mut all = Map::new();
        for flown in flights {
            all.insert(
                flown.scenario.name.clone(),
                metrics_json(&flown.outcome, flown.spread.as_ref()),
            );
        }
        terminal::print_json(&json!(all))?;
    } else if !common.quiet {
        terminal::print_table(&summary(flights), terminal::width());
        terminal::say(&format!("\nwritten to {}", out.display()));
    }
    if bad { Err(Failure::Unmet) } else { Ok(()) }
}

fn summary(flights: &[Flown]) -> Table {
    const METRICS: [(&str, &str); 6] = [
        ("position.iae", "IAE (m s)"),
        ("position.rmse", "RMSE (m)"),
        ("position.max", "max (m)"),
        ("position.late_max", "late max (m)"),
        ("attitude.angle.iae", "att. IAE (rad s)"),
        ("estimate.rmse", "estimate RMSE (N)"),
    ];
    let mut head = vec!["flight".to_owned()];
    head.extend(METRICS.iter().map(|(_, name)| (*name).to_owned()));
    Table {
        title: "Flown".into(),
        head,
        rows: flights
            .iter()
            .map(|flown| stormpetrel_lab::reproduce::row(flown, &METRICS.map(|(name, _)| name)))
            .collect(),
        ..Table::default()
    }
}

/// What failed: the flight, or starts beside it.
fn describe_failure(flown: &Flown) -> String {
    let told = |failure: Failed| {
        let cause = failure.cause.describe();
        let hint = match failure.cause {
            Cause::NonFinite => " (is the step too long? try a higher run.substeps)",
            _ => "",
        };
        format!("failed at {:.3} s: {cause}{hint}", failure.time)
    };
    let beside = flown.spread.as_ref();
    let (failed, first) =
        beside.map_or((0, None), |spread| (spread.failures(), spread.first_failure()));
    match (flown.outcome.failure, first) {
        (Some(failure), _) => told(failure),
        (None, Some(first)) => {
            format!(
                "sensitive: {failed} of {STARTS} starts within 1e-9 m fail, the first {}",
                told(first)
            )
        }
        (None, None) => String::new(),
    }
}

/// Prints every expectation that is not met and every failure that must not be; whether there is one.
pub fn print_unmet<'a>(flights: impl IntoIterator<Item = &'a Flown>, faults_only: bool) -> bool {
    let mut bad = false;
    let mut expected = 0;
    for flown in flights {
        let name = printable(&flown.scenario.name);
        expected += flown.scenario.expect.len();
        for (rule, value) in flown.unmet() {
            bad = true;
            let sensitive =
                if flown.spread.is_some() { " (sensitive: no number can be expected)" } else { "" };
            terminal::warn(&format!("{name}: expectation failed: {rule}, {value}{sensitive}"));
        }
        if flown.failed() {
            bad = true;
            terminal::warn(&format!("{name}: {}", describe_failure(flown)));
        }
    }
    if !bad && expected > 0 && !faults_only {
        terminal::say(&match expected {
            1 => "the expectation is met".to_owned(),
            _ => format!("all {expected} expectations met"),
        });
    }
    bad
}
