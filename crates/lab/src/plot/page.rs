//! The sheet a figure is drawn on: a few SVG elements, written in order.

use std::fmt::Write;

use super::decimate::{Point, runs};
use super::style::{FONTS, INK, WIDTH, look};
use super::text::{coarse, escape, num, width, wrap};

/// How a line of text looks and where its anchor lies.
#[derive(Clone, Copy, Debug)]
pub(super) struct Font {
    pub size: f64,
    pub anchor: &'static str,
    pub fill: &'static str,
}

/// Ordinary text, anchored at its left end.
pub(super) const LEFT: Font = Font { size: 11.0, anchor: "start", fill: INK };
/// Ordinary text, anchored at its middle.
pub(super) const MIDDLE: Font = Font { size: 11.0, anchor: "middle", fill: INK };
/// Ordinary text, anchored at its right end.
pub(super) const RIGHT: Font = Font { size: 11.0, anchor: "end", fill: INK };
/// The title of the figure.
const TITLE: Font = Font { size: 16.0, anchor: "start", fill: INK };
/// Left and right edge that stays free, in pixels.
pub(super) const EDGE: f64 = 16.0;

/// The elements drawn so far.
#[derive(Debug, Default)]
pub(super) struct Page {
    body: String,
}

impl Page {
    /// Appends to the body; writing to a string cannot fail.
    fn put(&mut self, parts: std::fmt::Arguments<'_>) {
        let _ = self.body.write_fmt(parts);
    }

    /// Writes the title of the figure and gives the height below it, in pixels.
    pub fn heading(&mut self, title: &str) -> f64 {
        let mut y = 8.0;
        for line in wrap(title, TITLE.size, WIDTH - 2.0 * EDGE) {
            y += 20.0;
            self.text((EDGE, y), &line, TITLE);
        }
        y + 10.0
    }

    /// One line of text with its baseline at the point.
    pub fn text(&mut self, (x, y): Point, text: &str, font: Font) {
        self.write_text((x, y), text, font, "");
    }

    /// Text on a white ground, left-anchored or centred, so that lines behind do not disturb.
    pub fn text_on_lines(&mut self, (x, y): Point, text: &str, font: Font) {
        let wide = width(text, font.size) + 4.0;
        let left = if font.anchor == MIDDLE.anchor { x - 0.5 * wide } else { x - 2.0 };
        self.rect((left, y - font.size), (wide, 1.3 * font.size), "fill=\"#fff\"");
        self.text((x, y), text, font);
    }

    /// Text that reads from below to above.
    pub fn text_upwards(&mut self, (x, y): Point, text: &str, font: Font) {
        let turn = format!(" transform=\"rotate(-90 {} {})\"", num(x), num(y));
        self.write_text((x, y), text, font, &turn);
    }

    fn write_text(&mut self, (x, y): Point, text: &str, font: Font, more: &str) {
        let Font { size, anchor, fill } = font;
        self.put(format_args!(
            "<text x=\"{}\" y=\"{}\" font-size=\"{size}\" text-anchor=\"{anchor}\" \
             fill=\"{fill}\"{more}>{}</text>\n",
            num(x),
            num(y),
            escape(text)
        ));
    }

    /// A straight line of a colour, a width in pixels and a dash pattern (empty: solid).
    pub fn line(&mut self, from: Point, to: Point, colour: &str, width: f64, dash: &str) {
        self.put(format_args!(
            "<path d=\"M{} {}L{} {}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\"{}/>\n",
            num(from.0),
            num(from.1),
            num(to.0),
            num(to.1),
            dashes(dash)
        ));
    }

    /// A rectangle; `look` holds its attributes.
    pub fn rect(&mut self, (x, y): Point, (width, height): Point, look: &str) {
        self.put(format_args!(
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" {look}/>\n",
            num(x),
            num(y),
            num(width),
            num(height)
        ));
    }

    /// A dot of a radius in pixels; an open one shows white inside.
    pub fn dot(&mut self, (x, y): Point, radius: f64, colour: &str, open: bool) {
        let fill = if open { "#fff" } else { colour };
        self.put(format_args!(
            "<circle cx=\"{}\" cy=\"{}\" r=\"{radius}\" fill=\"{fill}\" stroke=\"{colour}\"/>\n",
            num(x),
            num(y)
        ));
    }

    /// A curve through pixels; missing points break it and a point alone becomes a dot.
    pub fn curve(&mut self, points: &[Point], style: usize) {
        let (colour, dash) = look(style);
        let runs = runs(points);
        self.path(&runs, colour, 1.6, &dashes(dash));
        for run in &runs {
            if let [point] = run.as_slice() {
                self.dot(*point, 2.2, colour, false);
            }
        }
    }

    /// Small dots, pale enough that a crowd of them shows what lies below.
    pub fn dots(&mut self, points: &[Point], style: usize) {
        // A line without length and with round ends: the shortest way to write a dot.
        let dot = |p: &Point| format!("M{} {}h0", coarse(p.0), coarse(p.1));
        let look = "stroke-width=\"4\" stroke-linecap=\"round\" stroke-opacity=\"0.6\"";
        self.symbols(points, dot, style, look);
    }

    /// Diagonal crosses.
    pub fn crosses(&mut self, points: &[Point], style: usize) {
        let cross =
            |p: &Point| format!("M{} {}l6 6m0 -6l-6 6", coarse(p.0 - 3.0), coarse(p.1 - 3.0));
        self.symbols(points, cross, style, "stroke-width=\"1.3\"");
    }

    fn symbols(
        &mut self,
        points: &[Point],
        symbol: impl Fn(&Point) -> String,
        style: usize,
        look_more: &str,
    ) {
        let usable = points.iter().filter(|p| p.0.is_finite() && p.1.is_finite());
        let data: String = usable.map(symbol).collect();
        if !data.is_empty() {
            let colour = look(style).0;
            self.put(format_args!(
                "<path d=\"{data}\" fill=\"none\" stroke=\"{colour}\" {look_more}/>\n"
            ));
        }
    }

    /// A vertical bar with feet, and a dot at the value.
    pub fn whisker(&mut self, x: f64, (low, value, high): (f64, f64, f64), style: usize) {
        if !(x.is_finite() && low.is_finite() && high.is_finite()) {
            return;
        }
        let colour = look(style).0;
        self.line((x, low), (x, high), colour, 1.2, "");
        for end in [low, high] {
            self.line((x - 3.0, end), (x + 3.0, end), colour, 1.2, "");
        }
        if value.is_finite() {
            self.dot((x, value), 3.0, colour, false);
        }
    }

    /// A curve that only hints: thin, solid and pale.
    pub fn shadow(&mut self, points: &[Point], style: usize) {
        self.path(&runs(points), look(style).0, 1.0, " stroke-opacity=\"0.3\"");
    }

    fn path(&mut self, runs: &[Vec<Point>], colour: &str, width: f64, more: &str) {
        let mut data = String::new();
        for run in runs.iter().filter(|run| run.len() > 1) {
            for (i, (x, y)) in run.iter().enumerate() {
                data.push(if i == 0 { 'M' } else { ' ' });
                data.push_str(&coarse(*x));
                data.push(' ');
                data.push_str(&coarse(*y));
            }
        }
        if !data.is_empty() {
            self.put(format_args!(
                "<path d=\"{data}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" \
                 stroke-linejoin=\"round\"{more}/>\n"
            ));
        }
    }

    /// The complete document; height in pixels.
    pub fn finish(self, title: &str, description: &str, height: f64) -> String {
        let (title, description, height) = (escape(title), escape(description), num(height.ceil()));
        let spoken = if description.is_empty() { &title } else { &description };
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{height}\" \
             viewBox=\"0 0 {WIDTH} {height}\" role=\"img\" aria-label=\"{spoken}\" \
             font-family=\"{FONTS}\">\n<title>{title}</title>\n<desc>{description}</desc>\n\
             <rect width=\"{WIDTH}\" height=\"{height}\" fill=\"#fff\"/>\n{}</svg>\n",
            self.body
        )
    }
}

fn dashes(dash: &str) -> String {
    if dash.is_empty() { String::new() } else { format!(" stroke-dasharray=\"{dash}\"") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_point_is_a_dot_and_a_gap_starts_anew() {
        let mut page = Page::default();
        page.curve(&[(1.0, 2.0), (2.0, 2.0), (f64::NAN, 0.0), (5.0, 5.0)], 0);
        assert!(page.body.contains("d=\"M1 2 2 2\""));
        assert_eq!(page.body.matches("<circle").count(), 1);
        assert!(!page.body.contains("NaN"));
    }
}
