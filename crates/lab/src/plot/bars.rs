//! Horizontal bars, one line each, with the value written at the end.

use super::axis::{Axis, Range, unit};
use super::legend;
use super::page::{EDGE, Font, LEFT, MIDDLE, Page, RIGHT};
use super::style::{FAINT, GREY, GRID, INK, LIMIT_DASH, WIDTH, look};
use super::text::{fit, value, width};
use super::ticks::Ticks;
use super::{Limit, Scale};

/// Height of a line in pixels.
const ROW: f64 = 26.0;
/// Widest label and widest remark in pixels; longer ones are cut.
const ROOM: f64 = 260.0;

/// One bar.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Group {
    /// Name, left of the bar.
    pub label: String,
    /// Length, in the unit `Bars::x_label` names; NaN for no bar.
    pub value: f64,
    /// Remark after the value, in grey; empty for none.
    pub note: String,
}

/// A bar chart, 860 pixels wide.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bars {
    /// Heading of the sheet; long ones are wrapped.
    pub title: String,
    /// What the figure shows, for readers who cannot see it.
    pub description: String,
    /// Quantity and unit of the values, for example "largest error (m)".
    pub x_label: String,
    /// Scale of the values; linear bars begin at zero, logarithmic ones at a power of ten.
    pub scale: Scale,
    /// The bars from top to bottom.
    pub groups: Vec<Group>,
    /// Vertical dashed lines to compare with, in the unit of the values.
    pub limits: Vec<Limit>,
}

impl Bars {
    /// The chart as a complete SVG document; the same chart gives the same text.
    pub fn svg(&self) -> String {
        let mut page = Page::default();
        let top = page.heading(&self.title);
        let range = self.range();
        let axis = Axis { range, from: self.left(), to: WIDTH - self.right() };
        let top = legend::above(&mut page, &self.marks(&axis), top);
        let bottom = self.groups.iter().fold(top + 6.0, |y, _| y + ROW);
        self.grid(&mut page, &axis, (top, bottom));
        let mut middle = top + 3.0 + 0.5 * ROW;
        for group in &self.groups {
            self.bar(&mut page, &axis, group, middle);
            middle += ROW;
        }
        // Behind the texts but before the bars: a limit must be seen across both.
        for (at, _) in self.marks(&axis) {
            page.line((at, top), (at, bottom), GREY, 1.2, LIMIT_DASH);
        }
        middle = top + 3.0 + 0.5 * ROW;
        for group in &self.groups {
            self.words(&mut page, &axis, group, middle);
            middle += ROW;
        }
        page.finish(&self.title, &self.description, bottom + 46.0)
    }

    fn range(&self) -> Range {
        let values = self.groups.iter().map(|g| g.value);
        let all = values.chain(self.limits.iter().map(|l| l.value)).map(|v| unit(v, self.scale));
        match self.scale {
            Scale::Linear => {
                let range = Range::of(all.chain([0.0]));
                let settled = Range::settled(range, Scale::Linear, 0.03);
                // No strip before zero when there is nothing below it.
                let below = range.is_some_and(|r| r.lo < 0.0);
                Range { lo: if below { settled.lo } else { 0.0 }, ..settled }
            }
            Scale::Log => {
                let Range { lo, hi } = Range::of(all).unwrap_or(Range { lo: 0.0, hi: 0.0 });
                // The shortest bar must still be seen.
                let lo = (lo - 0.15).floor();
                Range { lo, hi: hi + 0.03 * (hi - lo) }
            }
        }
    }

    /// Place where bars begin, in pixels.
    fn start(&self, axis: &Axis) -> f64 {
        match self.scale {
            Scale::Linear => axis.at(0.0),
            Scale::Log => axis.from,
        }
    }

    /// Place where a bar ends, in pixels; none when it cannot be drawn.
    fn end(&self, axis: &Axis, value: f64) -> Option<f64> {
        match value {
            v if v == f64::INFINITY => Some(axis.to),
            v => Some(axis.at(unit(v, self.scale))).filter(|at| at.is_finite()),
        }
    }

    /// Room left of the bars, in pixels.
    fn left(&self) -> f64 {
        let labels = self.groups.iter().map(|g| width(&cut(&g.label), LEFT.size));
        EDGE + labels.fold(20.0, |a, b| if b > a { b } else { a }) + 8.0
    }

    /// Room right of the bars for value and remark, in pixels.
    fn right(&self) -> f64 {
        let words = self.groups.iter().map(|g| {
            let note = if g.note.is_empty() { 0.0 } else { 10.0 + width(&cut(&g.note), 10.0) };
            width(&value(g.value), LEFT.size) + note
        });
        EDGE + words.fold(20.0, |a, b| if b > a { b } else { a }) + 8.0
    }

    /// Limits with their places in pixels, from left to right.
    fn marks(&self, axis: &Axis) -> Vec<(f64, &str)> {
        let place = |l: &Limit| axis.at(unit(l.value, self.scale));
        let all = self.limits.iter().map(|l| (place(l), l.label.as_str()));
        let mut marks: Vec<_> = all.filter(|m| m.0.is_finite()).collect();
        marks.sort_by(|a, b| a.0.total_cmp(&b.0));
        marks
    }

    fn grid(&self, page: &mut Page, axis: &Axis, (top, bottom): (f64, f64)) {
        let ticks = Ticks::new(axis.range, self.scale, 6);
        for at in &ticks.minor {
            page.line((axis.at(*at), top), (axis.at(*at), bottom), FAINT, 1.0, "");
        }
        for tick in &ticks.major {
            let at = axis.at(tick.at);
            page.line((at, top), (at, bottom), GRID, 1.0, "");
            page.text((at, bottom + 15.0), &tick.label, MIDDLE);
        }
        page.line((axis.from, bottom), (axis.to, bottom), INK, 1.0, "");
        page.text((f64::midpoint(axis.from, axis.to), bottom + 32.0), &self.x_label, MIDDLE);
        page.text((axis.to, bottom + 32.0), &ticks.factor, Font { size: 10.0, ..RIGHT });
    }

    fn bar(&self, page: &mut Page, axis: &Axis, group: &Group, middle: f64) {
        let Some(end) = self.end(axis, group.value) else { return };
        let start = self.start(axis);
        let (from, to) = if end < start { (end, start) } else { (start, end) };
        // A value without bound is pale, so that it is not taken for the largest finite one.
        let opacity = if group.value.is_finite() { "" } else { " fill-opacity=\"0.3\"" };
        let fill = format!("fill=\"{}\"{opacity}", look(0).0);
        page.rect((from, middle - 7.0), (to - from, 14.0), &fill);
    }

    fn words(&self, page: &mut Page, axis: &Axis, group: &Group, middle: f64) {
        page.text((axis.from - 8.0, middle + 4.0), &cut(&group.label), RIGHT);
        let start = self.start(axis);
        let end = self.end(axis, group.value).unwrap_or(start);
        let x = 6.0 + if end < start { start } else { end };
        let text = value(group.value);
        page.text_on_lines((x, middle + 4.0), &text, LEFT);
        if !group.note.is_empty() {
            let x = x + width(&text, LEFT.size) + 10.0;
            let font = Font { size: 10.0, fill: GREY, ..LEFT };
            page.text_on_lines((x, middle + 4.0), &cut(&group.note), font);
        }
    }
}

fn cut(text: &str) -> String {
    fit(text, LEFT.size, ROOM)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bars(scale: Scale, values: &[f64]) -> String {
        let groups = values.iter().map(|v| Group {
            label: "step <1>".into(),
            value: *v,
            note: "note & more".into(),
        });
        let limit = Limit { value: 0.5, label: "limit".into() };
        let bars = Bars { scale, groups: groups.collect(), limits: vec![limit], ..Bars::default() };
        let svg = bars.svg();
        let tree = resvg::usvg::Tree::from_str(&svg, &resvg::usvg::Options::default());
        assert!(tree.is_ok() && !svg.contains("NaN"), "{svg}");
        assert_eq!(svg, bars.svg());
        svg
    }

    #[test]
    fn every_value_is_written() {
        let odd = [0.25, -1.0, 0.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e-9];
        for scale in [Scale::Linear, Scale::Log] {
            let svg = bars(scale, &odd);
            assert!(
                svg.contains(">0.25<") && svg.contains(">no value<") && svg.contains(">\u{221e}<")
            );
            bars(scale, &[]);
            bars(scale, &[3.0]);
        }
    }

    #[test]
    fn negative_lengths_never_appear() {
        assert!(!bars(Scale::Linear, &[-3.0, 2.0]).contains("width=\"-"));
    }
}
