//! What a person sees: tables that fit, colour and progress on a terminal only.

use std::io::{self, ErrorKind, IsTerminal, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use anstyle::Style;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::Value;
use stormpetrel_lab::output::halt;
use stormpetrel_lab::reproduce::Table;
use stormpetrel_lab::scenario::fault::printable;

use crate::Failure;

/// Headings.
pub const BOLD: Style = Style::new().bold();

/// Why nothing more can be said on standard output.
static LOST: Mutex<Option<io::Error>> = Mutex::new(None);

/// Set where the first interrupt must only ask for an end.
pub static ORDERLY: AtomicBool = AtomicBool::new(false);
/// Whether an end was asked for.
pub static STOP: AtomicBool = AtomicBool::new(false);

/// Removes what is half made and leaves with the code of an interrupted program. Where an orderly end is
/// possible the first interrupt asks for it, the second one leaves.
pub fn interrupted() {
    if ORDERLY.load(Ordering::Relaxed) && !STOP.swap(true, Ordering::Relaxed) {
        warn("\nfinishing what is in hand; interrupt again to leave at once");
        return;
    }
    // Held until the end: no file is made any more.
    if let Some(_halt) = halt() {
        std::process::exit(130);
    }
}

/// Columns of the terminal; 100 where there is none.
pub fn width() -> usize {
    terminal_size::terminal_size().map_or(100, |(width, _)| usize::from(width.0))
}

/// Prints a line. After an error nothing more is printed, and the program goes on: its verdict counts.
pub fn say(text: &str) {
    let mut lost = LOST.lock().unwrap_or_else(PoisonError::into_inner);
    if lost.is_none() {
        *lost = writeln!(anstream::stdout(), "{text}").err();
    }
}

/// Why something could not be printed; a reader that closed the pipe has read enough.
pub fn lost() -> Option<io::Error> {
    let mut lost = LOST.lock().unwrap_or_else(PoisonError::into_inner);
    let error = lost.take().or_else(|| io::stdout().flush().err());
    error.filter(|error| error.kind() != ErrorKind::BrokenPipe)
}

/// Prints a line on standard error, where that is possible.
pub fn warn(text: &str) {
    // There is nowhere left to complain.
    let _ = writeln!(anstream::stderr(), "{text}");
}

/// Prints JSON.
pub fn print_json(value: &Value) -> Result<(), Failure> {
    let text =
        serde_json::to_string_pretty(value).map_err(|e| Failure::Input(format!("error: {e}")))?;
    say(&text);
    Ok(())
}

/// Prints JSON that cannot fail to be written out.
pub fn say_json(value: &Value) {
    say(&format!("{value:#}"));
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

/// Lets the bar show a share and the time that is left.
pub fn with_share(bar: &ProgressBar) {
    if let Ok(style) =
        ProgressStyle::with_template("{msg} [{bar:20}] {percent} % {elapsed}, {eta} left")
    {
        bar.set_style(style.progress_chars("=> "));
    }
}

/// Gives the bar room for a message that tells rate and failures.
pub fn with_rate(bar: &ProgressBar) {
    if let Ok(style) = ProgressStyle::with_template("[{bar:20}] {pos}/{len} {elapsed}\n{wide_msg}")
    {
        bar.set_style(style.progress_chars("=> "));
    }
}

/// Breaks the lines of messages that are prose, with the indentation of their beginning; lines that show
/// a file stay as they are.
pub fn fold(text: &str, width: usize) -> String {
    let folded = text.lines().map(|line| match line {
        _ if line.chars().count() <= width => line.to_owned(),
        _ if line.trim_start().starts_with("= help: ") => {
            hang(line, line.find("= help: ").unwrap_or(0) + 8, width)
        }
        _ if line.starts_with("error: ") => hang(line, 7, width),
        _ => line.to_owned(),
    });
    folded.collect::<Vec<_>>().join("\n")
}

/// A text whose paragraphs are broken anew where they are too wide; indented lines are equations and stay.
pub fn prose(text: &str, width: usize) -> String {
    let is_prose = |line: &str| !line.is_empty() && !line.starts_with([' ', '|', '-', '*', '#']);
    let mut blocks: Vec<(bool, Vec<&str>)> = Vec::new();
    for line in text.lines() {
        match blocks.last_mut() {
            Some((prose, lines)) if *prose && is_prose(line) => lines.push(line),
            _ => blocks.push((is_prose(line), vec![line])),
        }
    }
    let broken = blocks.into_iter().map(|(prose, lines)| {
        let fits = lines.iter().all(|line| line.chars().count() <= width);
        if prose && !fits { wrap(&lines.join(" "), width) } else { lines.join("\n") }
    });
    broken.collect::<Vec<_>>().join("\n")
}

/// A line broken so that all but the first of its lines are indented by `head` letters.
pub fn hang(line: &str, head: usize, width: usize) -> String {
    let (first, rest) = line.split_at_checked(head).unwrap_or(("", line));
    let room = width.saturating_sub(head).max(20);
    format!("{first}{}", wrap(rest, room).replace('\n', &format!("\n{}", " ".repeat(head))))
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
    say(&format!("\n{BOLD}{}{BOLD:#}", wrap(&printable(&table.title), width)));
    if !table.lead.is_empty() {
        say(&wrap(&table.lead, width));
    }
    say("");
    say(&printable(&grid(table, width)));
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
    fn messages_are_folded_and_what_they_show_of_a_file_is_not() {
        let text = "error: one two three four five\n  --> file.toml:1:1\n1 | kp = [1, 2, 3, 4, 5, 6, 7, 8]\n  = help: six seven eight nine ten";
        assert_eq!(
            fold(text, 29),
            "error: one two three four\n       five\n  --> file.toml:1:1\n1 | kp = [1, 2, 3, 4, 5, 6, 7, 8]\n  = help: six seven eight nine\n          ten"
        );
    }

    #[test]
    fn words_are_never_broken() {
        assert_eq!(wrap("one two three", 7), "one two\nthree");
        assert_eq!(wrap("immeasurable", 4), "immeasurable");
    }
}
