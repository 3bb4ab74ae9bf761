//! The figures of the page.

use super::bins::{Bins, quantile, scale_of_inputs, scale_of_results};
use super::with_unit;
use crate::campaign::summary::{SCORE, Sampled, Summary, wilson};
use crate::page::number;
use crate::plot::{Column, Figure, Limit, Mark, Panel, Scale, Series};

/// Points in a scatter figure.
const POINTS: usize = 2000;
/// Points of a success curve.
const CURVE: usize = 20;

/// How often each value of a metric came about; the values rise.
pub(super) fn histogram(metric: &str, sorted: &[f64]) -> String {
    let Some(bins) = Bins::new(sorted, scale_of_results(sorted), columns(sorted.len())) else {
        return String::new();
    };
    let mut counts = vec![0_u32; bins.count()];
    for value in sorted {
        counts[bins.of(*value)] += 1;
    }
    let column = |(bin, count): (usize, &u32)| {
        let (from, to) = bins.edges(bin);
        Column { from, to, height: f64::from(*count) }
    };
    let mark = |(name, q): (&str, f64)| {
        let value = quantile(sorted, q)?;
        Some(Limit { value, label: format!("{name} {}", number(value)) })
    };
    let marks = [("5 %:", 0.05), ("median:", 0.5), ("95 %:", 0.95)];
    let panel = Panel {
        x_label: with_unit(metric),
        x_scale: bins.scale(),
        y_label: "flights".into(),
        columns: counts.iter().enumerate().map(column).collect(),
        x_limits: marks.into_iter().filter_map(mark).collect(),
        ..Panel::default()
    };
    let figure = Figure {
        title: format!("Distribution of {metric}"),
        description: format!("Histogram of {metric} over the flights flown to their end."),
        panels: vec![panel],
    };
    figure.svg()
}

/// Enough columns to show the shape, few enough that each holds some flights.
fn columns(values: usize) -> usize {
    values.isqrt().clamp(8, 50)
}

/// Success and score against one input, one panel each.
pub(super) fn dependence(summary: &Summary, at: usize, unit: &str) -> String {
    let name = summary.columns().inputs.get(at).map_or("", String::as_str);
    let x_label = if unit.is_empty() { name.to_owned() } else { format!("{name} ({unit})") };
    let values = summary.sample().filter_map(|row| row.number(at));
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let scale = scale_of_inputs(&sorted);
    let Some(bins) = Bins::new(&sorted, scale, columns(sorted.len()).min(CURVE)) else {
        return String::new();
    };
    // Both panels reach as far as the values, so that one can be read off below the other.
    let x_range = sorted.first().copied().zip(sorted.last().copied());
    let curve = Curve::new(summary.sample(), at, &bins);
    let cloud = Cloud::new(summary, at);
    let figure = Figure {
        title: format!("Success and {SCORE} against {name}"),
        description: format!(
            "Above, the share of flights flown to their end; below, {SCORE} of single flights; both against {name}."
        ),
        panels: vec![
            Panel { x_scale: bins.scale(), x_range, ..curve.panel() },
            Panel { x_scale: bins.scale(), x_range, x_label, ..cloud.panel() },
        ],
    };
    figure.svg()
}

/// Share of flights flown to their end, bin by bin.
#[derive(Default)]
struct Curve {
    x: Vec<f64>,
    share: Vec<f64>,
    spans: Vec<(f64, f64)>,
}

impl Curve {
    fn new<'a>(rows: impl Iterator<Item = Sampled<'a>>, at: usize, bins: &Bins) -> Self {
        // Sum of the inputs, flights, successes: a point stands where its flights are.
        let mut sums = vec![(0.0, 0_u64, 0_u64); bins.count()];
        for row in rows {
            if let Some(x) = row.number(at) {
                let (sum, flights, flown) = &mut sums[bins.of(x)];
                *sum += x;
                *flights += 1;
                *flown += u64::from(!row.failed);
            }
        }
        let mut curve = Self::default();
        for (sum, flights, flown) in sums.into_iter().filter(|(_, flights, _)| *flights > 0) {
            let interval = wilson(flown, flights);
            curve.x.push(sum / flights as f64);
            curve.share.push(flown as f64 / flights as f64);
            curve.spans.push((interval.low, interval.high));
        }
        curve
    }

    fn panel(&self) -> Panel<'_> {
        let least = self.spans.iter().fold(1.0, |a, span| if span.0 < a { span.0 } else { a });
        // Half of the height for a campaign that hardly ever fails, and never a curve below nothing.
        let low = if least < 0.5 { 0.0 } else { 1.0 - 1.2 * (1.0 - least) };
        let margin = 0.03 * (1.0 - low);
        Panel {
            title: "Flown to the end, with 95 % interval".into(),
            y_label: "share of flights (1)".into(),
            y_range: Some((low - if low > 0.0 { 0.0 } else { margin }, 1.0 + margin)),
            series: vec![Series {
                x: &self.x,
                y: &self.share,
                spans: &self.spans,
                ..Series::default()
            }],
            ..Panel::default()
        }
    }
}

/// Single flights: those flown to their end by their score, the others at the upper edge.
#[derive(Default)]
struct Cloud {
    x: Vec<f64>,
    score: Vec<f64>,
    failed: Vec<f64>,
    edge: Vec<f64>,
}

impl Cloud {
    fn new(summary: &Summary, at: usize) -> Self {
        let score = summary.columns().metrics.iter().position(|name| name == SCORE);
        let mut cloud = Self::default();
        for row in summary.few(POINTS) {
            let Some(x) = row.number(at) else { continue };
            if row.failed {
                cloud.failed.push(x);
                cloud.edge.push(f64::INFINITY);
            } else if let Some(y) = score.and_then(|at| row.metric(at)) {
                cloud.x.push(x);
                cloud.score.push(y);
            }
        }
        cloud
    }

    fn panel(&self) -> Panel<'_> {
        let flown = Series {
            label: "flown to the end".into(),
            x: &self.x,
            y: &self.score,
            mark: Mark::Dots,
            ..Series::default()
        };
        let failed = Series {
            label: "failed (at the upper edge: no comparable value)".into(),
            x: &self.failed,
            y: &self.edge,
            style: 1,
            mark: Mark::Crosses,
            ..Series::default()
        };
        let mut series = vec![flown];
        if !self.failed.is_empty() {
            series.push(failed);
        }
        Panel {
            title: format!("{SCORE} of single flights"),
            y_label: with_unit(SCORE),
            scale: Scale::Log,
            series,
            ..Panel::default()
        }
    }
}
