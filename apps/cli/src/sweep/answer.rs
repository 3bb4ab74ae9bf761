//! What a campaign came to: its files, and the answer in the terminal.

use std::io;
use std::path::Path;

use stormpetrel_lab::campaign::disk::Native;
use stormpetrel_lab::campaign::files;
use stormpetrel_lab::campaign::journal::Index;
use stormpetrel_lab::campaign::plan::Campaign;
use stormpetrel_lab::campaign::summary::Summary;
use stormpetrel_lab::reproduce::Table;

use crate::args::{Common, Plan};
use crate::{Failure, terminal};

/// Writes results, summary and report, and prints the answer.
pub(super) fn conclude(
    campaign: &Campaign,
    plan: &Plan,
    out: &Path,
    parts: Vec<Index>,
    flights: u64,
    common: &Common,
) -> Result<(), Failure> {
    let broken = |error: io::Error| Failure::out(out, &error);
    let summary = files::finish(&Native, out, campaign, &parts, flights).map_err(broken)?;
    // Of a long campaign an index is large, and the report does without.
    drop(parts);
    let command = |sets: &[String]| command("run", plan, sets);
    let mut again = self::command("sweep", plan, &[]);
    if let Some(path) = &plan.drawn {
        again += &format!(" --plan {}", word(&path.to_string_lossy()));
    }
    files::report(&Native, out, campaign, &summary, &command, &again).map_err(broken)?;
    if common.json {
        return terminal::print_json(&files::summary_json(campaign, &summary));
    }
    if !common.quiet {
        print(campaign, &summary, &command, out);
    }
    Ok(())
}

/// The command that flies the file with these settings again.
fn command(what: &str, plan: &Plan, sets: &[String]) -> String {
    let mut words = vec![format!("stormpetrel {what}"), word(&plan.file.to_string_lossy())];
    words.extend(plan.variant.iter().map(|variant| format!("--variant {}", word(variant))));
    words.extend(plan.sets.iter().chain(sets).map(|set| format!("--set {}", word(set))));
    words.join(" ")
}

/// As a shell takes it for one word.
fn word(text: &str) -> String {
    let plain = |letter: char| letter.is_ascii_alphanumeric() || "_-./=:,+@%".contains(letter);
    if !text.is_empty() && text.chars().all(plain) {
        text.to_owned()
    } else {
        format!("'{}'", text.replace('\'', "'\\''"))
    }
}

fn print(
    campaign: &Campaign,
    summary: &Summary,
    command: &dyn Fn(&[String]) -> String,
    out: &Path,
) {
    let (share, interval) = summary.success();
    terminal::say(&format!(
        "{} of {} flights succeeded: {:.2} %, 95 % interval {:.2} to {:.2} %",
        summary.flown(),
        summary.flights(),
        100.0 * share,
        100.0 * interval.low,
        100.0 * interval.high
    ));
    for (cause, count) in summary.failures() {
        terminal::say(&format!("  {count} failed: {}", cause.describe()));
    }
    let rows = summary.correlations().iter().map(|c| {
        // One of the two never changes: no correlation.
        let rank = if c.rank.is_finite() { format!("{:+.3}", c.rank) } else { "-".into() };
        vec![c.input.clone(), c.with.to_owned(), rank, c.flights.to_string()]
    });
    let table = Table {
        title: "What goes with what (Spearman's rank correlation)".into(),
        head: ["input", "with", "rank", "flights"].map(str::to_owned).to_vec(),
        rows: rows.collect(),
        ..Table::default()
    };
    terminal::print_table(&table, terminal::width());
    if let Some(worst) = summary.worst().first() {
        terminal::say("\nworst flight, to fly it again:");
        terminal::say(&format!("  {}", command(&campaign.sets(&worst.inputs, worst.seed))));
    }
    let written = [files::RESULTS, files::SUMMARY, files::PLAN, files::REPORT].join(", ");
    terminal::say(&format!("\nwritten to {}: {written}", out.display()));
}
