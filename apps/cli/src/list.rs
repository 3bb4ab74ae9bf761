//! `list`: what a scenario can name.

use serde_json::{Value, json};
use stormpetrel_lab::catalogue::{Entry, catalogue};
use stormpetrel_lab::scenario::fault::printable;
use stormpetrel_lab::scenario::read::nearest;
use stormpetrel_lab::shipped::{SHIPPED, shipped};

use crate::args::{Common, List};
use crate::{Failure, terminal};

/// Prints names and summaries by kind.
pub fn list(args: &List, common: &Common) -> Result<(), Failure> {
    let mut entries: Vec<(String, String, String)> = catalogue()
        .into_iter()
        .map(|Entry { kind, name, summary, .. }| (kind.to_owned(), name, summary))
        .collect();
    for (name, _) in SHIPPED {
        if let Some(file) = shipped(name) {
            entries.push(("scenarios".into(), format!("scenarios/{name}.toml"), file?.title));
        }
    }
    let mut kinds: Vec<String> = Vec::new();
    for (kind, ..) in &entries {
        if !kinds.contains(kind) {
            kinds.push(kind.clone());
        }
    }
    // Each kind in one piece.
    entries.sort_by_key(|(kind, ..)| kinds.iter().position(|known| known == kind));
    if let Some(kind) = &args.kind {
        let Some(kind) = kinds.iter().find(|known| known.eq_ignore_ascii_case(kind)) else {
            return Err(unknown(kind, &kinds));
        };
        entries.retain(|(known, ..)| known == kind);
    }
    if common.json {
        let all: Vec<Value> = entries
            .iter()
            .map(|(kind, name, summary)| json!({ "kind": kind, "name": name, "summary": summary }))
            .collect();
        return terminal::print_json(&json!(all));
    }
    if common.quiet {
        return Ok(());
    }
    let bold = terminal::BOLD;
    let width = entries.iter().map(|(_, name, _)| name.len()).max().unwrap_or(0);
    // Where there is no room beside the names the summaries stand below them.
    let below = terminal::width() < 60;
    let indent = if below { 6 } else { width + 4 };
    let room = terminal::width().saturating_sub(indent).max(20);
    let mut last = String::new();
    for (kind, name, summary) in entries {
        if kind != last {
            terminal::say(&format!("{bold}{kind}{bold:#}"));
            last = kind;
        }
        let start = format!("\n{}", " ".repeat(indent));
        let summary = terminal::wrap(&printable(&summary), room).replace('\n', &start);
        if below {
            terminal::say(&format!("  {name}{start}{summary}"));
        } else {
            terminal::say(&format!("  {name:<width$}  {summary}"));
        }
    }
    Ok(())
}

fn unknown(kind: &str, kinds: &[String]) -> Failure {
    let known: Vec<&str> = kinds.iter().map(String::as_str).collect();
    let meant = nearest(kind, &known).map_or(String::new(), |n| format!("did you mean `{n}`? "));
    let list = known.join(", ");
    Failure::Input(format!("error: unknown kind `{kind}`\n  = help: {meant}known: {list}"))
}
