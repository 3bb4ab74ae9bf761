//! Curves over a common horizontal quantity, in panels stacked on one sheet.

use super::Scale;
use super::axis::{Axis, Range, unit};
use super::extent::{points, ranges};
use super::legend;
use super::page::{EDGE, Font, LEFT, MIDDLE, Page, RIGHT};
use super::style::{FAINT, GREY, GRID, INK, LIMIT_DASH, WIDTH, look};
use super::text::{fit, value, width};
use super::ticks::Ticks;

/// Widest name of a limit in pixels; longer ones are cut.
const NAME_ROOM: f64 = 190.0;
const NAME: Font = Font { size: 10.0, fill: GREY, ..LEFT };

/// How the points of a series are shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mark {
    /// Joined by a line.
    #[default]
    Line,
    /// Each as a dot.
    Dots,
    /// Each as a cross; a value of infinity lies at the upper edge of the plot.
    Crosses,
}

/// One curve. Points that are not finite break it; a point alone is drawn as a dot.
#[derive(Clone, Debug, Default)]
pub struct Series<'a> {
    /// Name in the legend; empty for none.
    pub label: String,
    /// Horizontal values, in the unit the panel's `x_label` names.
    pub x: &'a [f64],
    /// Vertical values, in the unit the panel's `y_label` names; the shorter slice counts.
    pub y: &'a [f64],
    /// Colour and dash pattern together, as an index.
    pub style: usize,
    /// How the points are shown.
    pub mark: Mark,
    /// Lower and upper ends of a vertical bar at each point, in the unit of `y`; empty for none.
    pub spans: &'a [(f64, f64)],
}

/// A column of a histogram, drawn from zero upwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Column {
    /// Left edge, in the unit the panel's `x_label` names.
    pub from: f64,
    /// Right edge, in the same unit.
    pub to: f64,
    /// Height, in the unit the panel's `y_label` names.
    pub height: f64,
}

/// A bound the curves are judged against: a dashed grey line with its name beside the plot.
///
/// A limit so far off that the curves would become flat is only named at the edge, with an arrow.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Limit {
    /// Where the line lies, in the unit of the axis it belongs to.
    pub value: f64,
    /// Name of the limit.
    pub label: String,
}

/// One coordinate system with its curves.
#[derive(Clone, Debug, Default)]
pub struct Panel<'a> {
    /// Heading above the plot; empty for none.
    pub title: String,
    /// Horizontal quantity and unit, for example "time (s)"; empty for none.
    pub x_label: String,
    /// Vertical quantity and unit, for example "error (m)"; empty for none.
    pub y_label: String,
    /// Scale of the vertical axis.
    pub scale: Scale,
    /// Scale of the horizontal axis.
    pub x_scale: Scale,
    /// Values that the horizontal axis reaches at least; without them the points decide.
    pub x_range: Option<(f64, f64)>,
    /// Ends of the vertical axis, around everything drawn; without them the values decide.
    pub y_range: Option<(f64, f64)>,
    /// Number of rows that the vertical axis counts from zero in place of a scale; 0 for a scale.
    pub y_rows: usize,
    /// Columns, drawn behind the curves.
    pub columns: Vec<Column>,
    /// The curves, drawn in this order.
    pub series: Vec<Series<'a>>,
    /// Horizontal lines to compare with.
    pub limits: Vec<Limit>,
    /// Vertical lines to compare with, named above the plot.
    pub x_limits: Vec<Limit>,
}

/// Panels under each other, 860 pixels wide.
#[derive(Clone, Debug, Default)]
pub struct Figure<'a> {
    /// Heading of the sheet; long ones are wrapped.
    pub title: String,
    /// What the figure shows, for readers who cannot see it.
    pub description: String,
    /// The coordinate systems from top to bottom; their plots share left and right edge.
    pub panels: Vec<Panel<'a>>,
}

/// A limit in axis units, held inside the plot, with the text that names it.
struct Bound {
    at: f64,
    text: String,
    inside: bool,
}

/// A panel with its ranges settled.
struct Prepared<'a> {
    panel: &'a Panel<'a>,
    x: Range,
    y: Range,
    x_ticks: Ticks,
    y_ticks: Ticks,
    marks: Vec<Bound>,
}

impl Figure<'_> {
    /// The figure as a complete SVG document; the same figure gives the same text.
    pub fn svg(&self) -> String {
        let mut page = Page::default();
        let mut top = page.heading(&self.title);
        let height = match self.panels.len() {
            0 | 1 => 320.0,
            2 => 220.0,
            _ => 170.0,
        };
        let ready: Vec<_> = self.panels.iter().map(|p| Prepared::new(p, height)).collect();
        let left = ready.iter().map(Prepared::left).fold(0.0, greater);
        let right = WIDTH - ready.iter().map(Prepared::right).fold(0.0, greater);
        for panel in &ready {
            top = panel.draw(&mut page, (left, right), top, height);
        }
        page.finish(&self.title, &self.description, top)
    }
}

impl<'a> Prepared<'a> {
    fn new(panel: &'a Panel<'a>, height: f64) -> Self {
        let scale = panel.scale;
        let (x, y) = ranges(panel);
        Self {
            panel,
            x,
            y,
            x_ticks: Ticks::new(x, panel.x_scale, 9),
            y_ticks: match panel.y_rows {
                0 => Ticks::new(y, scale, if height > 200.0 { 6 } else { 4 }),
                rows => Ticks::rows(rows),
            },
            marks: panel.limits.iter().filter_map(|l| mark(l, y, scale)).collect(),
        }
    }

    /// Room needed left of the plot, in pixels.
    fn left(&self) -> f64 {
        let labels = self.y_ticks.major.iter().map(|t| width(&t.label, LEFT.size));
        let widest = labels.fold(width(&self.y_ticks.factor, NAME.size), greater);
        EDGE + widest + 8.0 + if self.panel.y_label.is_empty() { 0.0 } else { 18.0 }
    }

    /// Room needed right of the plot, in pixels.
    fn right(&self) -> f64 {
        let names = self.marks.iter().map(|m| width(&m.text, NAME.size) + 6.0 + EDGE);
        names.fold(26.0, greater)
    }

    /// Draws the panel below `top` and gives the height where the next one may begin.
    fn draw(&self, page: &mut Page, (left, right): (f64, f64), top: f64, height: f64) -> f64 {
        let x = Axis { range: self.x, from: left, to: right };
        let top = self.header(page, (left, right), top);
        let x_marks = self.x_marks(&x);
        let top = legend::above(page, &x_marks, top);
        let bottom = top + height;
        let y = Axis { range: self.y, from: bottom, to: top };
        self.grid(page, &x, &y);
        self.columns(page, &x, &y);
        self.limits(page, &x, &y);
        for (at, _) in x_marks {
            page.line((at, top), (at, bottom), GREY, 1.2, LIMIT_DASH);
        }
        let size = (right - left, height);
        page.rect((left, top), size, &format!("fill=\"none\" stroke=\"{INK}\""));
        let mut empty = self.panel.columns.is_empty();
        for series in &self.panel.series {
            empty &= !self.series(page, series, &x, &y);
        }
        if empty {
            let font = Font { fill: GREY, ..MIDDLE };
            page.text_on_lines(
                (f64::midpoint(left, right), f64::midpoint(top, bottom)),
                "no data",
                font,
            );
        }
        self.names(page, &x, bottom)
    }

    /// Draws a series and tells whether any of it can be seen.
    fn series(&self, page: &mut Page, series: &Series<'_>, x: &Axis, y: &Axis) -> bool {
        // A symbol at the upper edge keeps clear of the frame.
        let height = |b: f64| if b == f64::INFINITY { y.to + 9.0 } else { y.at(b) };
        let places: Vec<_> =
            points(series, self.panel).map(|(a, b)| (x.at(a), height(b))).collect();
        match series.mark {
            Mark::Line => page.curve(&places, series.style),
            Mark::Dots => page.dots(&places, series.style),
            Mark::Crosses => page.crosses(&places, series.style),
        }
        for ((at, value), (low, high)) in places.iter().zip(series.spans) {
            let end = |v: f64| y.at(unit(v, self.panel.scale));
            page.whisker(*at, (end(*low), *value, end(*high)), series.style);
        }
        places.iter().any(|p| p.0.is_finite() && p.1.is_finite())
    }

    fn columns(&self, page: &mut Page, x: &Axis, y: &Axis) {
        let fill = format!("fill=\"{}\" fill-opacity=\"0.6\" stroke=\"#fff\"", look(0).0);
        for column in &self.panel.columns {
            let [from, to] = [column.from, column.to].map(|v| x.at(unit(v, self.panel.x_scale)));
            let top = y.at(unit(column.height, self.panel.scale));
            if from < to && top < y.from {
                page.rect((from, top), (to - from, y.from - top), &fill);
            }
        }
    }

    /// Vertical lines inside the plot with their places in pixels, from left to right.
    fn x_marks(&self, x: &Axis) -> Vec<(f64, &'a str)> {
        let place = |l: &'a Limit| (x.at(unit(l.value, self.panel.x_scale)), l.label.as_str());
        let mut marks: Vec<_> = self.panel.x_limits.iter().map(place).collect();
        marks.retain(|m| (x.from..=x.to).contains(&m.0));
        marks.sort_by(|a, b| a.0.total_cmp(&b.0));
        marks
    }

    /// Title and legend; gives the top of the plot.
    fn header(&self, page: &mut Page, (left, right): (f64, f64), top: f64) -> f64 {
        let font = Font { size: 13.0, ..LEFT };
        let room = WIDTH - EDGE - left;
        let title = fit(&self.panel.title, font.size, room);
        let mut y = top + if title.is_empty() { 0.0 } else { 13.0 };
        page.text((left, y), &title, font);
        let entries = || self.panel.series.iter().map(|s| (s.label.as_str(), s.style, s.mark));
        if entries().any(|(label, ..)| !label.is_empty()) {
            // The legend has rows of its own, so that it begins at the same place in every panel.
            let first = y + if title.is_empty() { 12.0 } else { legend::ROW + 2.0 };
            y = legend::draw(page, entries(), (left, first), (left, right));
        }
        y + if self.y_ticks.factor.is_empty() { 9.0 } else { 20.0 }
    }

    fn grid(&self, page: &mut Page, x: &Axis, y: &Axis) {
        for at in &self.y_ticks.minor {
            page.line((x.from, y.at(*at)), (x.to, y.at(*at)), FAINT, 1.0, "");
        }
        for tick in &self.x_ticks.major {
            let at = x.at(tick.at);
            page.line((at, y.from), (at, y.to), GRID, 1.0, "");
            page.text((at, y.from + 15.0), &tick.label, MIDDLE);
        }
        for tick in &self.y_ticks.major {
            let at = y.at(tick.at);
            page.line((x.from, at), (x.to, at), GRID, 1.0, "");
            page.text((x.from - 6.0, at + 4.0), &tick.label, RIGHT);
        }
        let font = Font { size: NAME.size, ..RIGHT };
        page.text((x.from - 6.0, y.to - 9.0), &self.y_ticks.factor, font);
        if !self.panel.y_label.is_empty() {
            let label = fit(&self.panel.y_label, LEFT.size, y.from - y.to + 20.0);
            page.text_upwards((EDGE + 8.0, f64::midpoint(y.from, y.to)), &label, MIDDLE);
        }
    }

    fn limits(&self, page: &mut Page, x: &Axis, y: &Axis) {
        let mut marks: Vec<_> = self.marks.iter().map(|m| (y.at(m.at), m)).collect();
        marks.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut places: Vec<f64> = marks.iter().map(|m| m.0 + 3.5).collect();
        legend::spread(&mut places, 12.0, (y.to + 7.0, y.from));
        for ((at, mark), place) in marks.iter().zip(places) {
            if mark.inside {
                page.line((x.from, *at), (x.to, *at), GREY, 1.2, LIMIT_DASH);
            }
            page.text((x.to + 6.0, place), &mark.text, NAME);
        }
    }

    /// Name of the horizontal axis; gives the lower end of the panel.
    fn names(&self, page: &mut Page, x: &Axis, bottom: f64) -> f64 {
        let label = &self.panel.x_label;
        let factor = &self.x_ticks.factor;
        page.text((f64::midpoint(x.from, x.to), bottom + 31.0), label, MIDDLE);
        page.text((x.to, bottom + 31.0), factor, Font { size: NAME.size, ..RIGHT });
        bottom + if label.is_empty() && factor.is_empty() { 28.0 } else { 46.0 }
    }
}

fn greater(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

fn mark(limit: &Limit, range: Range, scale: Scale) -> Option<Bound> {
    let at = Some(unit(limit.value, scale)).filter(|v| v.is_finite())?;
    let beyond = |end, arrow| {
        let text = format!("{arrow} {} ({})", limit.label, value(limit.value));
        Bound { at: end, text: fit(&text, NAME.size, NAME_ROOM), inside: false }
    };
    Some(match at {
        v if v > range.hi => beyond(range.hi, '\u{2191}'),
        v if v < range.lo => beyond(range.lo, '\u{2193}'),
        v => Bound { at: v, text: fit(&limit.label, NAME.size, NAME_ROOM), inside: true },
    })
}

#[cfg(test)]
#[path = "figure_tests.rs"]
mod tests;
