//! `list`: what a scenario can name.

use serde_json::{Value, json};
use stormpetrel_lab::catalogue::{Entry, catalogue};
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
    let mut kinds: Vec<String> = entries.iter().map(|(kind, ..)| kind.clone()).collect();
    kinds.dedup();
    if let Some(kind) = &args.kind {
        if !kinds.contains(kind) {
            let message =
                format!("error: unknown kind `{kind}`\n  = help: known: {}", kinds.join(", "));
            return Err(Failure::Input(message));
        }
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
    let room = terminal::width().saturating_sub(width + 4).max(20);
    let mut last = String::new();
    for (kind, name, summary) in entries {
        if kind != last {
            terminal::say(&format!("{bold}{kind}{bold:#}"));
            last = kind;
        }
        let summary =
            terminal::wrap(&summary, room).replace('\n', &format!("\n{}", " ".repeat(width + 4)));
        terminal::say(&format!("  {name:<width$}  {summary}"));
    }
    Ok(())
}
