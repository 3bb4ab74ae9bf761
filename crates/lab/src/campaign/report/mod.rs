//! One page about a campaign, for a reader who has never seen it.

mod bins;
mod dependence;
mod figures;

use std::fmt::Write;

use super::result::{Columns, Input, Row};
use super::summary::{Interval, KEY_METRICS, SCORE, Summary, wilson};
use crate::metric::describe;
use crate::page::{self, escape, number};

/// Everything that the page tells.
#[derive(Clone, Copy, Debug)]
pub struct Story<'a> {
    /// Heading.
    pub title: &'a str,
    /// What the campaign is about; empty for nothing.
    pub about: &'a str,
    /// Name of the scenario.
    pub scenario: &'a str,
    /// What was drawn: name and distribution in words.
    pub inputs: &'a [(String, String)],
    /// Units of the inputs in the same order; an empty or missing one is not shown.
    pub units: &'a [String],
    /// What came of it.
    pub summary: &'a Summary,
    /// The command that flies the median flight again, where there is one.
    pub median: Option<&'a str>,
    /// The worst flights, the worst first, each with the command that flies it again.
    pub worst: &'a [(Row, String)],
    /// The command that flies the campaign again.
    pub command: &'a str,
}

/// The page: HTML that needs neither network nor scripts.
pub fn html(story: &Story) -> String {
    let mut page = page::open(story.title);
    if !story.about.is_empty() {
        let _ = writeln!(page, "<p>{}</p>", escape(story.about));
    }
    page.push_str(STYLE);
    flown(&mut page, story);
    success(&mut page, story.summary);
    distributions(&mut page, story);
    dependence::correlations(&mut page, story.summary);
    dependence::settings(&mut page, story);
    worst(&mut page, story);
    let command = escape(story.command);
    let _ = writeln!(page, "<h2>How to fly it again</h2>\n<pre>{command}</pre>");
    page::close(&mut page, "the command above");
    page
}

const STYLE: &str = "<style>.rank{display:inline-block;position:relative;width:110px;height:.8em;\
background:linear-gradient(90deg,#eee 49.5%,#555 49.5%,#555 50.5%,#eee 50.5%);margin-left:.6em;vertical-align:-.05em}\
.rank i{position:absolute;top:0;bottom:0;background:#0072b2}.rank i.less{background:#d55e00}\
pre{background:#f2f2f2;padding:.6em .8em;white-space:pre-wrap;overflow-wrap:anywhere;font-size:13px}\
td code{white-space:pre-wrap;overflow-wrap:anywhere}td.command{padding-bottom:.8em}\
.answer{font-size:1.25em}.words th,.words td{text-align:left;white-space:normal}.words td:nth-child(2){white-space:nowrap}</style>\n";

fn texts(cells: &[&str]) -> Vec<String> {
    cells.iter().map(|cell| (*cell).to_owned()).collect()
}

fn flown(page: &mut String, story: &Story) {
    let flights = story.summary.flights();
    let _ = writeln!(
        page,
        "<h2>What was flown</h2>\n<p>The scenario <code>{}</code>, {flights} times, each flight with its own seed for \
all that is random.</p>",
        escape(story.scenario)
    );
    if story.inputs.is_empty() {
        page.push_str("<p>Nothing but the seed was varied.</p>\n");
        return;
    }
    let unit = |at: usize| story.units.get(at).filter(|unit| !unit.is_empty());
    let rows = story.inputs.iter().enumerate().map(|(at, (name, distribution))| {
        let unit = unit(at).map_or_else(|| "-".into(), |unit| escape(unit));
        vec![format!("<code>{}</code>", escape(name)), unit, escape(distribution)]
    });
    page.push_str("<p>Each flight had its own values of these settings; everything else is as the scenario has it.</p>\n<div class=\"words\">");
    page::html_table(page, &texts(&["setting", "unit", "drawn"]), &rows.collect::<Vec<_>>());
    page.push_str("</div>\n");
}

fn success(page: &mut String, summary: &Summary) {
    let (share, interval) = summary.success();
    page.push_str("<h2>How often it succeeds</h2>\n");
    if summary.flights() == 0 {
        page.push_str("<p>Nothing has been flown.</p>\n");
        return;
    }
    let _ = writeln!(
        page,
        "<p class=\"answer\"><strong>{}</strong> of the flights were flown to their end: {} of {}.</p>\n\
<p>With 95 % confidence the probability lies between {} and {} (Wilson's interval, which takes the flights as independent).</p>",
        percent(share, interval),
        summary.flown(),
        summary.flights(),
        percent(interval.low, interval),
        percent(interval.high, interval)
    );
    let failures = summary.failures();
    if failures.is_empty() {
        page.push_str("<p>No flight failed.</p>\n");
        return;
    }
    let rows = failures.into_iter().map(|(cause, count)| {
        let share = count as f64 / summary.flights() as f64;
        let interval = wilson(count, summary.flights());
        let count = count.to_string();
        vec![cause.describe().to_owned(), count, percent(share, interval), range(interval)]
    });
    let head = ["failed by", "flights", "share", "95 % interval"];
    page::table(page, &texts(&head), &rows.collect::<Vec<_>>());
}

fn range(interval: Interval) -> String {
    format!("{} to {}", percent(interval.low, interval), percent(interval.high, interval))
}

/// A share in percent, with as many digits as its interval is worth: two of its width.
fn percent(share: f64, Interval { low, high }: Interval) -> String {
    let (mut digits, mut width) = (0, 100.0 * (high - low));
    while width < 10.0 && digits < 9 {
        (digits, width) = (digits + 1, 10.0 * width);
    }
    // None and all are exact.
    let digits = if share <= 0.0 || share >= 1.0 { 0 } else { digits };
    format!("{:.digits$} %", 100.0 * share)
}

/// The key metrics that the flights have.
fn key_metrics(summary: &Summary) -> impl Iterator<Item = &'static str> {
    KEY_METRICS.into_iter().filter(|name| summary.has(name))
}

/// A metric with its unit, as an axis names it.
fn with_unit(metric: &str) -> String {
    describe(metric).map_or_else(|| metric.to_owned(), |(unit, _)| format!("{metric} ({unit})"))
}

fn distributions(page: &mut String, story: &Story) {
    let summary = story.summary;
    if summary.flown() == 0 {
        return;
    }
    page.push_str(
        "<h2>How well it flies</h2>\n<p>Over the flights that were flown to their end; the others ended early, so their sums are no measure.</p>\n",
    );
    sampled(page, summary);
    let mut rows = Vec::new();
    let mut drawings = String::new();
    for metric in key_metrics(summary) {
        let mut values: Vec<f64> = summary.metric(metric).map(|(_, value)| value).collect();
        values.sort_unstable_by(f64::total_cmp);
        let shown = [0.0, 0.05, 0.5, 0.95, 1.0].map(|q| bins::quantile(&values, q));
        let mut row = vec![with_unit(metric)];
        row.extend(shown.map(|value| value.map_or_else(|| "-".into(), number)));
        rows.push(row);
        let doc = describe(metric).map_or_else(String::new, |(_, doc)| doc);
        let _ = writeln!(
            drawings,
            "<h3>{}</h3>\n<p>{}.</p>",
            escape(metric),
            escape(&page_sentence(&doc))
        );
        drawings.push_str(&figures::histogram(metric, &values));
    }
    let head = ["metric", "least", "5 %", "median", "95 %", "largest"];
    page::table(page, &texts(&head), &rows);
    page::note(page, "Least and largest are those of the flights looked at.");
    if let (Some(row), Some(command)) = (summary.median(), story.median) {
        let (index, command) = (row.index, escape(command));
        let _ = writeln!(
            page,
            "<p>The flight with the median {SCORE} is number {index}:</p>\n<pre>{command}</pre>"
        );
    }
    page.push_str(&drawings);
}

fn page_sentence(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// Says so where not every flight was looked at.
fn sampled(page: &mut String, summary: &Summary) {
    if summary.sampled_every() > 1 {
        let text = format!(
            "This and everything below except the worst cases is from {} flights, one in {}, chosen by their index.",
            summary.sampled(),
            summary.sampled_every()
        );
        page::note(page, &text);
    }
}

/// A metric of a flight, where it has it.
fn metric(row: &Row, columns: &Columns, name: &str) -> Option<f64> {
    let at = columns.metrics.iter().position(|known| known == name)?;
    row.metrics.get(at).copied().filter(|value| !value.is_nan())
}

fn worst(page: &mut String, story: &Story) {
    if story.worst.is_empty() {
        return;
    }
    let columns = story.summary.columns();
    let _ = writeln!(
        page,
        "<h2>The worst cases</h2>\n<p>Failed flights first, the earliest failure before the others; then by falling {SCORE}. \
Each with the command that flies it again, to the same bits.</p>"
    );
    let mut rows = String::new();
    for (row, command) in story.worst {
        let _ = writeln!(
            rows,
            "<tr>{}</tr>\n<tr><td class=\"command\" colspan=\"4\"><code>{}</code></td></tr>",
            worst_cells(row, columns),
            escape(command)
        );
    }
    let _ = writeln!(
        page,
        "<div class=\"table words\"><table>\n<thead><tr><th>flight</th><th>came to</th><th>{SCORE}</th><th>settings</th></tr></thead>\n\
<tbody>\n{rows}</tbody></table></div>"
    );
    let unit = describe(SCORE).map_or_else(String::new, |(unit, _)| unit);
    page::note(page, &format!("{SCORE} in {unit}, until the failure where there is one."));
}

fn worst_cells(row: &Row, columns: &Columns) -> String {
    let came_to = row.failure.map_or_else(
        || "flown to its end".to_owned(),
        |failure| format!("{} at {:.2} s", failure.cause.describe(), failure.time),
    );
    let score = metric(row, columns, SCORE).map_or_else(|| "-".into(), number);
    // In one cell, so that many settings wrap and do not run out of the page.
    let settings = columns.inputs.iter().zip(&row.inputs).map(|(name, input)| match input {
        Input::Number(x) => format!("{name}\u{a0}=\u{a0}{}", number(*x)),
        Input::Text(text) => format!("{name}\u{a0}=\u{a0}{text}"),
    });
    let settings = settings.collect::<Vec<_>>().join(", ");
    let cells = [row.index.to_string(), came_to, score, settings];
    cells.iter().fold(String::new(), |line, cell| line + "<td>" + &escape(cell) + "</td>")
}

#[cfg(test)]
mod tests;
