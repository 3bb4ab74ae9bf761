//! `explain`: equations, settings, source.

use serde_json::json;
use stormpetrel_lab::catalogue::{Entry, catalogue};

use crate::args::{Common, Explain};
use crate::{Failure, terminal};

/// Prints everything about one name; where several kinds share it, about each.
pub fn explain(args: &Explain, common: &Common) -> Result<(), Failure> {
    let wanted = args.name.as_str();
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
        let nearest = all
            .iter()
            .filter(|entry| entry.name.contains(name) || name.contains(entry.name.as_str()))
            .map(|entry| format!("{}/{}", entry.kind, entry.name))
            .collect::<Vec<_>>()
            .join(", ");
        let help = if nearest.is_empty() {
            "`stormpetrel list` shows all names".into()
        } else {
            format!("did you mean: {nearest}")
        };
        return Err(Failure::Input(format!(
            "error: nothing is called `{wanted}`\n  = help: {help}"
        )));
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

fn as_json(entry: &Entry) -> serde_json::Value {
    let numbers: Vec<_> = entry
        .numbers
        .iter()
        .map(|n| json!({ "name": n.name, "unit": n.unit, "frame": n.frame, "default": n.default, "range": [n.range.0, n.range.1], "meaning": n.doc }))
        .collect();
    let choices: Vec<_> = entry
        .choices
        .iter()
        .map(|c| json!({ "name": c.name, "meaning": c.doc, "values": c.values.iter().map(|(name, doc)| json!({ "name": name, "meaning": doc })).collect::<Vec<_>>() }))
        .collect();
    json!({ "kind": entry.kind, "name": entry.name, "summary": entry.summary, "text": entry.text, "choices": choices, "numbers": numbers })
}

fn print(entry: &Entry) {
    let bold = terminal::BOLD;
    let Entry { kind, key, name, summary, text, choices, numbers } = entry;
    let width = terminal::width();
    terminal::say(&format!("{bold}{name}{bold:#} ({kind})"));
    if text.is_empty() {
        terminal::say(&terminal::wrap(summary, width));
    } else {
        terminal::say(&format!("\n{}", text.trim_end()));
    }
    if !key.is_empty() {
        let list = if kind == &"disturbance" {
            format!("[[{kind}]]\n  {key} = \"{name}\"")
        } else {
            format!("{kind} = {{ {key} = \"{name}\" }}")
        };
        terminal::say(&format!("\n{bold}In a scenario{bold:#}\n  {list}"));
    }
    if !choices.is_empty() {
        terminal::say(&format!("\n{bold}Choices{bold:#} (the first is the default)"));
        for choice in choices {
            terminal::say(&format!("  {}: {}", choice.name, choice.doc));
            for (value, doc) in &choice.values {
                terminal::say(&format!("      \"{value}\"  {doc}"));
            }
        }
    }
    if !numbers.is_empty() {
        terminal::say(&format!("\n{bold}Numbers{bold:#}"));
        for n in numbers {
            let frame = if n.frame.is_empty() { String::new() } else { format!(", {}", n.frame) };
            let head = format!("  {} = {} [{}{frame}]", n.name, n.default, n.unit);
            terminal::say(&format!(
                "{head}\n      {} From {:e} to {:e}.",
                n.doc, n.range.0, n.range.1
            ));
        }
    }
    terminal::say("");
}
