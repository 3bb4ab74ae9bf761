//! `check`: read, judge, do not fly.

use std::collections::BTreeSet;

use serde_json::{Value, json};
use stormpetrel_lab::feasible::{Feasibility, Quantity, feasible};
use stormpetrel_lab::fly::on_all_cores;
use stormpetrel_lab::scenario::fault::{Faults, printable};
use stormpetrel_lab::scenario::{File, Scenario, load, too_long};

use crate::args::{Check, Common};
use crate::{Failure, terminal};

/// Reads every file; all faults of all files are printed.
pub fn check(args: &Check, common: &Common) -> Result<(), Failure> {
    let mut faults = Vec::new();
    let mut good = Vec::new();
    for path in &args.files {
        let file = load(path, &args.sets);
        match file
            .and_then(|file| Faults::from_iter(too_long(&file.scenarios)).check().map(|()| file))
        {
            Ok(file) => good.push((path.display().to_string(), file)),
            Err(found) => faults.extend(found.0),
        }
    }
    Faults(faults).check()?;
    let judged = good.iter().map(|(_, file)| on_all_cores(&file.scenarios, feasible));
    let all = good.iter().zip(judged);
    if common.json {
        let all: Vec<Value> = all.map(|((path, file), judged)| one(path, file, &judged)).collect();
        return terminal::print_json(&json!(all));
    }
    if !common.quiet {
        for ((path, file), judged) in all {
            let flights = file.scenarios.len();
            let plural = if flights == 1 { "flight" } else { "flights" };
            terminal::say(&format!("{path}: good, {flights} {plural}"));
            print(&file.scenarios, &judged);
            print_idle(&file.scenarios);
        }
    }
    Ok(())
}

/// A note for each disturbance that never acts; one that several variants share is said once.
fn print_idle(scenarios: &[Scenario]) {
    let notes: BTreeSet<String> = scenarios.iter().flat_map(Scenario::idle).collect();
    for note in notes {
        terminal::say(&terminal::hang(&format!("note: {note}"), 6, terminal::width()));
    }
}

fn one(path: &str, file: &File, judged: &[Feasibility]) -> Value {
    json!({
        "file": path,
        "title": file.title,
        "flights": file.scenarios.iter().map(|s| s.name.clone()).collect::<Vec<_>>(),
        "feasibility": judged.iter().map(judgement).collect::<Vec<_>>(),
        "resolved": file.scenarios.iter().map(Scenario::resolved).collect::<Vec<_>>(),
    })
}

/// What a reference needs, for a program.
pub fn judgement(judged: &Feasibility) -> Value {
    let quantity = |q: &Quantity| {
        json!({
            "name": q.name,
            "unit": q.unit,
            "worst": q.worst,
            "time": q.time,
            "limit": q.limit,
            "margin": q.margin,
            "beyond": q.beyond,
        })
    };
    json!({
        "feasible": judged.broken().next().is_none(),
        "quantities": judged.quantities.iter().map(quantity).collect::<Vec<_>>(),
        "fit": judged.fit.map(|fit| json!({ "worst": fit.worst, "rms": fit.rms, "pieces": fit.pieces })),
    })
}

/// Tables and warnings; flights that need the same share a table.
pub fn print(scenarios: &[Scenario], judged: &[Feasibility]) {
    let mut said: Vec<&Feasibility> = Vec::new();
    for (scenario, feasibility) in scenarios.iter().zip(judged) {
        if said.contains(&feasibility) {
            continue;
        }
        said.push(feasibility);
        let others = judged.iter().filter(|other| *other == feasibility).count() - 1;
        let name = printable(&scenario.name);
        let title = match others {
            0 => name.clone(),
            _ => format!("{name} and {others} more"),
        };
        terminal::print_table(&feasibility.table(&title), terminal::width());
        let warnings = feasibility.warnings();
        if !warnings.is_empty() {
            let head = format!("warning: {title}: the reference cannot be flown:");
            terminal::warn(&terminal::hang(&head, 9, terminal::width()));
            for warning in warnings {
                terminal::warn(&terminal::hang(&format!("  - {warning}"), 4, terminal::width()));
            }
        }
    }
    terminal::say("");
}
