//! What the results depend on.

use std::fmt::Write;

use super::{Story, bins, figures, percent, range, texts, with_unit};
use crate::campaign::summary::{Correlation, SCORE, Sampled, Summary, wilson};
use crate::page::{self, escape, number};

/// The inputs that matter most first, with their correlations.
fn by_strength(summary: &Summary) -> Vec<&[Correlation]> {
    let mut groups: Vec<&[_]> =
        summary.correlations().chunk_by(|a, b| a.input == b.input).collect();
    let strength = |group: &[Correlation]| {
        let ranks = group.iter().map(|c| c.rank.abs()).filter(|rank| rank.is_finite());
        ranks.fold(0.0, |a, b| if b > a { b } else { a })
    };
    groups.sort_by(|a, b| strength(b).total_cmp(&strength(a)));
    groups
}

/// The table of rank correlations.
pub(super) fn correlations(page: &mut String, summary: &Summary) {
    let groups = by_strength(summary);
    let Some(first) = groups.first() else { return };
    page.push_str(
        "<h2>What it depends on</h2>\n<p>Rank correlation (Spearman) of each setting with each metric: 1 where the metric always rises with the \
setting, -1 where it always falls, 0 where the order of one says nothing of the other. \
A setting that hurts at both ends of its range can have 0: see the figures below. The strongest come first.</p>\n",
    );
    let mut head = texts(&["setting"]);
    head.extend(first.iter().map(|c| escape(c.with)));
    let rows = groups.iter().map(|group| {
        let mut row = vec![format!("<code>{}</code>", escape(&group[0].input))];
        row.extend(group.iter().map(|c| rank_cell(c.rank)));
        row
    });
    page::html_table(page, &head, &rows.collect::<Vec<_>>());
    page::note(
        page,
        "Metrics: over the flights flown to their end. Success: 1 for those, 0 for the others; with few failures it cannot come near 1.",
    );
}

/// The number with a bar from the middle, blue to the right or red to the left.
fn rank_cell(rank: f64) -> String {
    if !rank.is_finite() {
        return "-".into();
    }
    let length = 50.0 * rank.abs();
    let (from, class) = if rank < 0.0 { (50.0 - length, " class=\"less\"") } else { (50.0, "") };
    format!(
        "{}<span class=\"rank\"><i{class} style=\"left:{from:.1}%;width:{length:.1}%\"></i></span>",
        format!("{rank:.2}").replace('-', "\u{2212}")
    )
}

/// Each setting with its figure, or its table where it is a name.
pub(super) fn settings(page: &mut String, story: &Story) {
    let summary = story.summary;
    for group in by_strength(summary) {
        let name = &group[0].input;
        let Some(at) = summary.columns().inputs.iter().position(|known| known == name) else {
            continue;
        };
        let _ = writeln!(page, "<h3><code>{}</code></h3>", escape(name));
        if let Some((_, distribution)) = story.inputs.iter().find(|(known, _)| known == name) {
            let _ = writeln!(page, "<p>Drawn: {}.</p>", escape(distribution));
        }
        let unit = story.units.get(at).map_or("", String::as_str);
        page.push_str(&figures::dependence(summary, at, unit));
    }
    choices(page, summary);
}

/// Settings that are names: a table of each.
fn choices(page: &mut String, summary: &Summary) {
    let score = summary.columns().metrics.iter().position(|name| name == SCORE);
    for (at, name) in summary.columns().inputs.iter().enumerate() {
        let mut names: Vec<&str> = summary.sample().filter_map(|row| row.text(at)).collect();
        names.sort_unstable();
        names.dedup();
        if names.is_empty() {
            continue;
        }
        let _ = writeln!(page, "<h3><code>{}</code></h3>", escape(name));
        let rows = names.iter().map(|choice| {
            let with = summary.sample().filter(|row| row.text(at) == Some(choice));
            choice_row(choice, with, score)
        });
        let head = ["choice", "flights", "flown to the end", "95 % interval"];
        let head = texts(&[&head[..], &[&format!("median {}", with_unit(SCORE))]].concat());
        page::table(page, &head, &rows.collect::<Vec<_>>());
    }
}

fn choice_row<'a>(
    choice: &str,
    rows: impl Iterator<Item = Sampled<'a>>,
    score: Option<usize>,
) -> Vec<String> {
    let (mut flights, mut flown, mut scores) = (0_u64, 0_u64, Vec::new());
    for row in rows {
        flights += 1;
        if !row.failed {
            flown += 1;
            scores.extend(score.and_then(|at| row.metric(at)));
        }
    }
    scores.sort_unstable_by(f64::total_cmp);
    let interval = wilson(flown, flights);
    vec![
        choice.to_owned(),
        flights.to_string(),
        percent(flown as f64 / flights as f64, interval),
        range(interval),
        bins::quantile(&scores, 0.5).map_or_else(|| "-".into(), number),
    ]
}
