//! What a person sees: tables that fit, colour and progress on a terminal only.

use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use anstyle::Style;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::Value;
use stormpetrel_lab::reproduce::Table;

use crate::Failure;

/// Headings.
pub const BOLD: Style = Style::new().bold();

/// Folders to remove when the program is interrupted.
static STAGING: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Remembers a folder in the making until the program ends.
pub fn remember(staging: &Path) {
    STAGING.lock().unwrap_or_else(PoisonError::into_inner).push(staging.to_owned());
}

/// Set where the first interrupt must only ask for an end.
pub static ORDERLY: AtomicBool = AtomicBool::new(false);
/// Whether an end was asked for.
pub static STOP: AtomicBool = AtomicBool::new(false);

/// Removes what is half made and leaves with the code of an interrupted program. Where an orderly end is
/// possible the first interrupt asks for it, the second one leaves.
pub fn interrupted() {
    if ORDERLY.load(Ordering::Relaxed) && !STOP.swap(true, Ordering::Relaxed) {
        anstream::eprintln!("\nfinishing the flights in hand; interrupt again to leave at once");
        return;
    }
    for folder in STAGING.lock().unwrap_or_else(PoisonError::into_inner).iter() {
        // Nothing more can be done about a folder that will not go.
        let _ = std::fs::remove_dir_all(folder);
    }
    std::process::exit(130);
}

/// Columns of the terminal; 100 where there is none.
pub fn width() -> usize {
    terminal_size::terminal_size().map_or(100, |(width, _)| usize::from(width.0))
}

/// Prints a line; a reader that closed the pipe ends the program quietly.
pub fn say(text: &str) {
    if writeln!(anstream::stdout(), "{text}").is_err() {
        std::process::exit(0);
    }
}

/// Prints JSON.
pub fn print_json(value: &Value) -> Result<(), Failure> {
    let text =
        serde_json::to_string_pretty(value).map_err(|e| Failure::Input(format!("error: {e}")))?;
    say(&text);
    Ok(())
}

/// A bar on a terminal, nothing elsewhere.
pub fn progress(what: &'static str, quiet: bool) -> ProgressBar {
    if quiet || !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(0).with_message(what);
    if let Ok(style) = ProgressStyle::with_template("{msg} [{bar:30}] {pos}/{len} {elapsed}") {
        bar.set_style(style.progress_chars("=> "));
    }
    bar
}

/// Gives the bar room for a message that tells rate and failures.
pub fn with_rate(bar: &ProgressBar) {
    if let Ok(style) = ProgressStyle::with_template("[{bar:20}] {pos}/{len} {elapsed}\n{wide_msg}")
    {
        bar.set_style(style.progress_chars("=> "));
    }
}

/// Breaks a text into lines of at most `width` letters, between words.
pub fn wrap(text: &str, width: usize) -> String {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let line = lines.last().map_or(0, |line| line.chars().count());
        if line > 0 && line + 1 + word.chars().count() > width {
            lines.push(String::new());
        }
        if let Some(line) = lines.last_mut() {
            if !line.is_empty() {
                line.push(' ');
            }
            line.push_str(word);
        }
    }
    lines.join("\n")
}

/// Prints a table with its title, lead and notes so that it fits the width.
pub fn print_table(table: &Table, width: usize) {
    say(&format!("\n{BOLD}{}{BOLD:#}", wrap(&table.title, width)));
    if !table.lead.is_empty() {
        say(&wrap(&table.lead, width));
    }
    say("");
    say(&grid(table, width));
    for note in &table.notes {
        say(&wrap(note, width));
    }
}

/// The rows: labels beside the numbers where they fit, else above them; where even the numbers do not
/// fit, one line a number.
fn grid(table: &Table, width: usize) -> String {
    let columns = table.head.len();
    let widest = |c: usize| {
        let cells = table.rows.iter().filter_map(|row| row.get(c));
        cells.chain(table.head.get(c)).map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..columns).map(widest).collect();
    let numbers: usize = widths.iter().skip(1).map(|w| w + 2).sum();
    if numbers + 2 > width {
        return records(table, width);
    }
    let above = widths.first().copied().unwrap_or(0) + numbers > width;
    let label = if above { 0 } else { widths.first().copied().unwrap_or(0) };
    let line = |cells: &[String]| {
        let mut text = String::new();
        match (cells.first(), above) {
            (Some(first), true) => text += &format!("{}\n", wrap(first, width)),
            (Some(first), false) => text += &format!("{first:<label$}"),
            (None, _) => {}
        }
        for (cell, width) in cells.iter().zip(&widths).skip(1) {
            text += &format!("  {cell:>width$}");
        }
        text
    };
    let mut lines = vec![line(&table.head), "-".repeat(label + numbers)];
    lines.extend(table.rows.iter().map(|row| line(row)));
    lines.join("\n")
}

fn records(table: &Table, width: usize) -> String {
    let names = table.head.iter().skip(1).map(|name| name.chars().count()).max().unwrap_or(0);
    let mut lines = Vec::new();
    for row in &table.rows {
        lines.push(wrap(row.first().map_or("", String::as_str), width));
        for (name, cell) in table.head.iter().zip(row).skip(1) {
            lines.push(format!("  {name:<names$}  {cell}"));
        }
    }
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> Table {
        let cells = |row: [&str; 3]| row.map(str::to_owned).to_vec();
        Table {
            head: cells(["variant", "IAE", "max"]),
            rows: vec![cells(["a rather long name of a variant", "1.25", "0.5"])],
            ..Table::default()
        }
    }

    #[test]
    fn a_table_keeps_within_the_width_it_is_given() {
        for width in [100, 40, 20, 12] {
            let text = grid(&table(), width);
            assert!(text.lines().all(|line| line.chars().count() <= width), "{width}:\n{text}");
            assert!(text.contains("1.25") && text.contains("0.5"));
        }
    }

    #[test]
    fn words_are_never_broken() {
        assert_eq!(wrap("one two three", 7), "one two\nthree");
        assert_eq!(wrap("immeasurable", 4), "immeasurable");
    }
}
