//! Paths through space, seen from above and to the side, without perspective.

use super::axis::{Axis, Range, unit};
use super::decimate::Point;
use super::legend;
use super::page::{EDGE, Font, LEFT, MIDDLE, Page, RIGHT};
use super::style::{GREY, GRID, INK, WIDTH, look};
use super::text::width;
use super::ticks::Ticks;
use super::{Mark, Scale};

/// Screen direction (right, up) of the axes: the view from azimuth −60°, elevation 25°.
const DIRECTIONS: [Point; 3] = [(0.8660, -0.2113), (0.5, 0.3660), (0.0, 0.9063)];
/// Room for the box in pixels, without labels.
const ROOM: Point = (660.0, 400.0);
/// Where the labelled edge of each axis begins, in the unit box.
const EDGES: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]];

/// A path in metres; its beginning is marked by an open dot and its end by a full one. Points that are not
/// finite break it.
#[derive(Clone, Debug, Default)]
pub struct Path<'a> {
    /// Name in the legend; empty for none.
    pub label: String,
    /// First horizontal coordinate in metres.
    pub x: &'a [f64],
    /// Second horizontal coordinate in metres.
    pub y: &'a [f64],
    /// Height in metres, drawn upwards.
    pub z: &'a [f64],
    /// Colour and dash pattern together, as an index that wraps round.
    pub style: usize,
    /// Whether the dots at its ends and its shadow are left out, as for marks.
    pub bare: bool,
}

/// Paths in a box with a floor, 860 pixels wide.
///
/// All axes share one scale unless one range is less than an eighth of the largest; the figure then
/// says so.
#[derive(Clone, Debug, Default)]
pub struct Scene<'a> {
    /// Heading of the sheet; long ones are wrapped.
    pub title: String,
    /// What the figure shows, for readers who cannot see it.
    pub description: String,
    /// The paths, drawn in this order.
    pub paths: Vec<Path<'a>>,
}

/// The box, its ranges in metres and its place on the sheet.
struct View {
    ranges: [Range; 3],
    /// Screen vectors of the whole edges, in pixels with y downwards.
    edges: [Point; 3],
    origin: Point,
    equal: bool,
    bottom: f64,
}

impl Scene<'_> {
    /// The scene as a complete SVG document; the same scene gives the same text.
    pub fn svg(&self) -> String {
        let mut page = Page::default();
        let mut top = page.heading(&self.title);
        let entries = || self.paths.iter().map(|p| (p.label.as_str(), p.style, Mark::Line));
        if entries().any(|(label, ..)| !label.is_empty()) {
            top = legend::draw(&mut page, entries(), (EDGE, top + 8.0), (EDGE, WIDTH - EDGE));
        }
        let view = View::new(self.ranges(), top + 16.0);
        view.walls(&mut page);
        for axis in 0..3 {
            view.labels(&mut page, axis);
        }
        let lines: Vec<_> = self.paths.iter().map(|p| (p, view.lines(p))).collect();
        for (path, (_, shadow)) in lines.iter().filter(|(path, _)| !path.bare) {
            page.shadow(shadow, path.style);
        }
        for (path, (line, _)) in &lines {
            page.curve(line, path.style);
            if !path.bare {
                ends(&mut page, line, path.style);
            }
        }
        let mut note = "open dot: start, full dot: end, pale: shadow on the floor".to_owned();
        if !view.equal {
            note.push_str("; axes not to the same scale");
        }
        let bottom = view.bottom + 54.0;
        page.text((EDGE, bottom), &note, Font { size: 10.0, fill: GREY, ..LEFT });
        page.finish(&self.title, &self.description, bottom + 12.0)
    }

    fn ranges(&self) -> [Option<Range>; 3] {
        let coordinates: [fn(&Path<'_>) -> Vec<f64>; 3] =
            [|p| p.x.to_vec(), |p| p.y.to_vec(), |p| p.z.to_vec()];
        coordinates
            .map(|of| Range::of(self.paths.iter().flat_map(of).map(|v| unit(v, Scale::Linear))))
    }
}

/// Ranges with room, lengths of the box edges relative to the longest, and whether both agree.
fn proportions(ranges: [Option<Range>; 3]) -> ([Range; 3], [f64; 3], bool) {
    let raw = ranges.map(|r| r.unwrap_or(Range { lo: 0.0, hi: 1.0 }));
    let longest = raw.iter().map(|r| r.span()).fold(0.0, |a, b| if b > a { b } else { a });
    let all = raw.map(|r| {
        // A flat path lies in the middle of a box that is flat, but still a box.
        let flat = r.span() < 0.01 * longest;
        let by = if flat { 0.12 * longest } else { 0.0 };
        Range::settled(Some(Range { lo: r.lo - by, hi: r.hi + by }), Scale::Linear, 0.05)
    });
    let longest = all.iter().map(|r| r.span()).fold(0.0, |a, b| if b > a { b } else { a });
    let equal = all.iter().all(|r| r.span() >= longest / 8.0);
    let relative = |r: Range| {
        let length = r.span() / longest;
        if equal || length > 0.4 { length } else { 0.4 }
    };
    (all, all.map(relative), equal)
}

impl View {
    fn new(ranges: [Option<Range>; 3], top: f64) -> Self {
        let (ranges, lengths, equal) = proportions(ranges);
        let ([x, y, z], [a, b, c]) = (DIRECTIONS, lengths);
        // The box seen from outside: as wide as its two horizontal edges, as high as all three.
        let across = a * x.0 + b * y.0;
        let high = -a * x.1 + b * y.1 + c * z.1;
        let (wide, tall) = (ROOM.0 / across, ROOM.1 / high);
        let scale = if wide < tall { wide } else { tall };
        let edge = |d: Point, length: f64| (d.0 * length * scale, -d.1 * length * scale);
        let edges = [edge(x, a), edge(y, b), edge(z, c)];
        let bottom = top + high * scale;
        let left = 0.5 * (WIDTH - across * scale);
        Self { ranges, edges, origin: (left, bottom - edges[0].1), equal, bottom }
    }

    /// Pixel of a place in the unit box.
    fn pixel(&self, place: [f64; 3]) -> Point {
        let steps = self.edges.iter().zip(place);
        steps.fold(self.origin, |at, (edge, part)| (at.0 + edge.0 * part, at.1 + edge.1 * part))
    }

    /// A path and its shadow on the floor, in pixels.
    fn lines(&self, path: &Path<'_>) -> (Vec<Point>, Vec<Point>) {
        let [x, y, z] = self.ranges.map(|range| Axis { range, from: 0.0, to: 1.0 });
        let part = |axis: &Axis, v: f64| axis.at(unit(v, Scale::Linear));
        let points = path.x.iter().zip(path.y).zip(path.z);
        let places = points.map(|((a, b), c)| [part(&x, *a), part(&y, *b), part(&z, *c)]);
        // The shadow keeps the height as a factor of zero, so that gaps stay gaps.
        places.map(|[a, b, c]| (self.pixel([a, b, c]), self.pixel([a, b, 0.0 * c]))).unzip()
    }

    /// The three sides behind the paths with their grid.
    fn walls(&self, page: &mut Page) {
        let mut line = |from: [f64; 3], to: [f64; 3], colour: &str| {
            page.line(self.pixel(from), self.pixel(to), colour, 1.0, "");
        };
        for axis in 0..3 {
            for (part, _) in self.ticks(axis).1 {
                let [from, corner, to] = match axis {
                    0 => [[part, 0.0, 0.0], [part, 1.0, 0.0], [part, 1.0, 1.0]],
                    1 => [[1.0, part, 0.0], [0.0, part, 0.0], [0.0, part, 1.0]],
                    _ => [[0.0, 0.0, part], [0.0, 1.0, part], [1.0, 1.0, part]],
                };
                line(from, corner, GRID);
                line(corner, to, GRID);
            }
        }
        let far = [[1.0, 1.0, 0.0], [1.0, 1.0, 1.0], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0]];
        for pair in far.windows(2) {
            if let [from, to] = pair {
                line(*from, *to, GREY);
            }
        }
        for to in [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 1.0]] {
            line([0.0, 1.0, 0.0], to, GREY);
        }
        line([0.0; 3], [1.0, 0.0, 0.0], INK);
        line([1.0, 0.0, 0.0], [1.0, 1.0, 0.0], INK);
        line([0.0; 3], [0.0, 0.0, 1.0], INK);
    }

    /// Factor and ticks of an axis: part of the edge and label.
    fn ticks(&self, axis: usize) -> (String, Vec<(f64, String)>) {
        let (Some(range), Some(edge)) = (self.ranges.get(axis), self.edges.get(axis)) else {
            return (String::new(), Vec::new());
        };
        let count = match edge.0.abs() + edge.1.abs() {
            length if length > 300.0 => 6,
            length if length > 120.0 => 4,
            _ => 2,
        };
        let ticks = Ticks::new(*range, Scale::Linear, count);
        let parts = Axis { range: *range, from: 0.0, to: 1.0 };
        let all = ticks.major.into_iter().map(|t| (parts.at(t.at), t.label));
        (ticks.factor, all.collect())
    }

    /// Numbers and name of an axis, outside the box.
    fn labels(&self, page: &mut Page, axis: usize) {
        // Away from the box along the floor, and leftwards for the height.
        let (out, font, name) = match axis {
            0 => ((-0.45, 0.9), RIGHT, "x"),
            1 => ((0.97, 0.24), LEFT, "y"),
            _ => ((-1.0, 0.0), RIGHT, "z"),
        };
        let along = |part: f64| {
            let mut place = EDGES.get(axis).copied().unwrap_or_default();
            if let Some(coordinate) = place.get_mut(axis) {
                *coordinate = part;
            }
            self.pixel(place)
        };
        let away = |(x, y): Point, by: f64| (x + out.0 * by, y + out.1 * by);
        let (factor, ticks) = self.ticks(axis);
        let mut widest = 0.0;
        for (part, label) in &ticks {
            let at = along(*part);
            page.line(at, away(at, 5.0), INK, 1.0, "");
            let (x, y) = away(at, 9.0);
            page.text((x, y + 4.0), label, font);
            let wide = width(label, font.size);
            widest = if wide > widest { wide } else { widest };
        }
        let space = if factor.is_empty() { "" } else { " " };
        let text = format!("{name} ({factor}{space}m)");
        let (x, y) = away(along(0.5), 9.0);
        match axis {
            0 => page.text((x - widest - 4.0, y + 28.0), &text, MIDDLE),
            1 => page.text((x + widest + 12.0, y + 16.0), &text, LEFT),
            _ => page.text_upwards((x - widest - 14.0, y), &text, MIDDLE),
        }
    }
}

/// Marks where a path begins and ends.
fn ends(page: &mut Page, line: &[Point], style: usize) {
    let known = |p: &&Point| p.0.is_finite() && p.1.is_finite();
    if let (Some(first), Some(last)) = (line.iter().find(known), line.iter().rfind(known)) {
        page.dot(*first, 4.0, look(style).0, true);
        page.dot(*last, 3.0, look(style).0, false);
    }
}

#[cfg(test)]
#[path = "path3d_tests.rs"]
mod tests;
