//! `explain`: equations, settings, source.

use serde_json::json;
use stormpetrel_lab::catalogue::{Entry, catalogue};
use stormpetrel_lab::scenario::read::nearest;

use crate::args::{Common, Explain};
use crate::{Failure, terminal};

/// Prints everything about one name; where several kinds share it, about each.
pub fn explain(args: &Explain, common: &Common) -> Result<(), Failure> {
    let lower = args.name.to_lowercase();
    let wanted = lower.as_str();
    let (kind, name) =
        wanted.split_once('/').map_or((None, wanted), |(kind, name)| (Some(kind), name));
    let all = catalogue();
    let metric = |entry: &Entry| {
        // `position.iae` is the signal `position` under the metric `*.iae`.
        entry.kind == "metric"
            && name.rsplit_once('.').is_some_and(|(signal, tail)| {
                entry.name.strip_prefix("*.") == Some(tail)
                    && all.iter().any(|e| e.kind == "signal" && e.name == signal)
            })
    };
    let found: Vec<&Entry> = all
        .iter()
        .filter(|e| (e.name == name && kind.is_none_or(|kind| kind == e.kind)) || metric(e))
        .collect();
    if found.is_empty() {
        return Err(unknown(&all, &args.name, name));
    }
    if common.json {
        return terminal::print_json(&json!(
            found.iter().map(|entry| as_json(entry)).collect::<Vec<_>>()
        ));
    }
    if !common.quiet {
        for entry in found {
            print(entry);
        }
    }
    Ok(())
}

/// Nothing has this name: what may have been meant.
fn unknown(all: &[Entry], wanted: &str, name: &str) -> Failure {
    let of_kind: Vec<&str> =
        all.iter().filter(|entry| entry.kind == name).map(|entry| entry.name.as_str()).collect();
    if !of_kind.is_empty() {
        let help = format!("give one of its names: {}", of_kind.join(", "));
        return Failure::Input(format!(
            "error: `{wanted}` is a kind, not a name\n  = help: {help}"
        ));
    }
    let names: Vec<&str> = all.iter().map(|entry| entry.name.as_str()).collect();
    let near = nearest(name, &names);
    let meant = |entry: &&Entry| {
        let known = entry.name.as_str();
        near == Some(known) || known.contains(name) || name.contains(known)
    };
    let meant: Vec<String> =
        all.iter().filter(meant).map(|entry| format!("{}/{}", entry.kind, entry.name)).collect();
    let help = match meant.as_slice() {
        [] => "`stormpetrel list` shows all names".into(),
        meant => format!("did you mean: {}", meant.join(", ")),
    };
    Failure::Input(format!("error: nothing is called `{wanted}`\n  = help: {help}"))
}

fn as_json(entry: &Entry) -> serde_json::Value {
    let numbers: Vec<_> = entry
        .numbers
        .iter()
        .map(|n| json!({ "name": n.name, "unit": n.unit, "frame": n.frame, "default": n.default, "range": [n.range.0, n.range.1], "meaning": n.doc }))
        .collect();
    let choices: Vec<_> = entry
        .choices
        .iter()
        .map(|c| json!({ "name": c.name, "meaning": c.doc, "default": c.default, "values": c.values.iter().map(|(name, doc)| json!({ "name": name, "meaning": doc })).collect::<Vec<_>>() }))
        .collect();
    let tables: Vec<_> = entry
        .tables
        .iter()
        .map(|t| json!({ "name": t.name, "meaning": t.doc, "columns": t.columns.iter().map(|(name, unit)| json!({ "name": name, "unit": unit })).collect::<Vec<_>>() }))
        .collect();
    json!({ "kind": entry.kind, "name": entry.name, "summary": entry.summary, "text": entry.text, "choices": choices, "tables": tables, "numbers": numbers })
}

fn print(entry: &Entry) {
    let bold = terminal::BOLD;
    let Entry { kind, key, name, summary, text, choices, tables, numbers } = entry;
    let width = terminal::width();
    terminal::say(&format!("{bold}{name}{bold:#} ({kind})"));
    if text.is_empty() {
        terminal::say(&terminal::wrap(summary, width));
    } else {
        terminal::say(&format!("\n{}", terminal::prose(text.trim_end(), width)));
    }
    if !key.is_empty() {
        let list = if ["disturbance", "sensor"].contains(kind) {
            format!("[[{kind}]]\n  {key} = \"{name}\"")
        } else {
            format!("{kind} = {{ {key} = \"{name}\" }}")
        };
        terminal::say(&format!("\n{bold}In a scenario{bold:#}\n  {list}"));
    }
    if !choices.is_empty() {
        terminal::say(&format!("\n{bold}Choices{bold:#}"));
        for choice in choices {
            let line = format!("  {} = \"{}\": {}", choice.name, choice.default, choice.doc);
            terminal::say(&terminal::hang(&line, 2, width));
            for (value, doc) in &choice.values {
                terminal::say(&terminal::hang(&format!("      \"{value}\" {doc}"), 6, width));
            }
        }
    }
    for table in tables {
        terminal::say(&format!("\n{bold}Table{bold:#}"));
        let columns: Vec<_> =
            table.columns.iter().map(|(name, unit)| format!("{name} [{unit}]")).collect();
        let line = format!(
            "  {}: {} Rows [[...], ...] or the name of a CSV file; columns: {}.",
            table.name,
            table.doc,
            columns.join(", ")
        );
        terminal::say(&terminal::hang(&line, 6, width));
    }
    if !numbers.is_empty() {
        terminal::say(&format!("\n{bold}Numbers{bold:#}"));
        for n in numbers {
            let frame = if n.frame.is_empty() { String::new() } else { format!(", {}", n.frame) };
            let head = format!("  {} = {} [{}{frame}]", n.name, n.default, n.unit);
            let line = format!("      {} From {:e} to {:e}.", n.doc, n.range.0, n.range.1);
            terminal::say(&format!("{head}\n{}", terminal::hang(&line, 6, width)));
        }
    }
    terminal::say("");
}
