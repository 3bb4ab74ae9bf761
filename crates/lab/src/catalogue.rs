//! Everything that a scenario can name, with equations, settings and sources.

use std::fmt::Write;

use stormpetrel_control::math::Vec3;
use stormpetrel_control::options::{Cells, OptionVisitor, Options, Shape};
use stormpetrel_control::real::Real;
use stormpetrel_control::record::{Meta, Path, Record, VisitorMut};
use stormpetrel_control::registry::Settings;
use stormpetrel_plant::vehicle::{Vehicle, VehicleSettings};

use crate::metric::{About, OF_FLIGHT, OF_SIGNALS, SIGNALS};
use crate::scenario::{BlockVisitor, Scenario};

/// A number that a file may set.
#[derive(Clone, Debug)]
pub struct Number {
    /// Key in the file.
    pub name: String,
    /// SI unit.
    pub unit: &'static str,
    /// `world`, `body` or empty.
    pub frame: &'static str,
    /// Default.
    pub default: f64,
    /// Smallest and largest.
    pub range: (f64, f64),
    /// Meaning.
    pub doc: &'static str,
}

/// A choice that a file may make.
#[derive(Clone, Debug)]
pub struct Choice {
    /// Key in the file.
    pub name: &'static str,
    /// Meaning.
    pub doc: &'static str,
    /// Alternatives with their meanings.
    pub values: Vec<(&'static str, &'static str)>,
    /// The alternative that is taken where the file does not choose.
    pub default: &'static str,
}

/// A table that a file brings along.
#[derive(Clone, Debug)]
pub struct Table {
    /// Key in the file.
    pub name: &'static str,
    /// Meaning.
    pub doc: &'static str,
    /// Names and SI units of its columns.
    pub columns: Vec<(&'static str, &'static str)>,
}

/// Something that a scenario can name.
#[derive(Clone, Debug)]
pub struct Entry {
    /// Block of the scenario file, or `metric`.
    pub kind: &'static str,
    /// Key in the block that holds the name.
    pub key: &'static str,
    /// Name in scenario files.
    pub name: String,
    /// One line.
    pub summary: String,
    /// Equations, symbols, source.
    pub text: String,
    /// Choices.
    pub choices: Vec<Choice>,
    /// Tables.
    pub tables: Vec<Table>,
    /// Numbers.
    pub numbers: Vec<Number>,
}

/// Everything that a scenario can name, by block.
pub fn catalogue() -> Vec<Entry> {
    let mut collector = Collector::default();
    Scenario::defaults().blocks(&mut collector);
    let mut entries = collector.0;
    entries.extend(SIGNALS.iter().map(|about| metric("signal", about)));
    entries.extend(OF_SIGNALS.iter().chain(&OF_FLIGHT).map(|about| metric("metric", about)));
    entries
}

fn metric(kind: &'static str, about: &About) -> Entry {
    Entry {
        kind,
        key: "",
        name: about.name.to_owned(),
        summary: format!("{} [{}]", about.doc, about.unit),
        text: String::new(),
        choices: Vec::new(),
        tables: Vec::new(),
        numbers: Vec::new(),
    }
}

#[derive(Default)]
struct Collector(Vec<Entry>);

/// The settings of one law.
#[derive(Default)]
struct Block {
    choices: Vec<Choice>,
    tables: Vec<Table>,
    numbers: Vec<Number>,
}

impl VisitorMut<f64> for Block {
    fn number(&mut self, path: &Path<'_>, meta: &Meta, value: &mut f64) {
        let name = path.to_string();
        let whole = name.split('.').next().unwrap_or_default().to_owned();
        // A vector with equal components is one line.
        if let Some(last) = self.numbers.last_mut()
            && name.contains('.')
            && last.name.split('.').next() == Some(whole.as_str())
            && last.default.to_bits() == value.to_bits()
        {
            last.name = whole;
            return;
        }
        let Meta { unit, frame, doc, range } = *meta;
        self.numbers.push(Number { name, unit, frame, default: *value, range, doc: doc.trim() });
    }
}

impl OptionVisitor for Block {
    fn choice(
        &mut self,
        name: &'static str,
        doc: &'static str,
        names: &'static [&'static str],
        docs: &'static [&'static str],
        current: usize,
    ) -> usize {
        let values = names.iter().zip(docs).map(|(name, doc)| (*name, doc.trim())).collect();
        let default = names.get(current).copied().unwrap_or_default();
        self.choices.push(Choice { name, doc: doc.trim(), values, default });
        current
    }

    fn rows(
        &mut self,
        name: &'static str,
        doc: &'static str,
        shape: &Shape,
        current: Cells,
    ) -> Cells {
        let columns = shape.columns.iter().map(|column| (column.name, column.unit)).collect();
        self.tables.push(Table { name, doc: doc.trim(), columns });
        current
    }
}

/// The module documentation at the head of a source text, without links.
fn module_doc(source: &str) -> String {
    let lines = source.lines().take_while(|line| line.starts_with("//!"));
    lines.map(|line| line.trim_start_matches("//!").strip_prefix(' ').unwrap_or("")).fold(
        String::new(),
        |mut text, line| {
            let _ = writeln!(text, "{}", without_links(line));
            text
        },
    )
}

/// A line in which [`name`] and [`name`](path) are `name`.
fn without_links(line: &str) -> String {
    let mut text = String::new();
    let mut rest = line;
    while let Some((before, link)) = rest.split_once("[`") {
        text.push_str(before);
        match link.split_once("`]") {
            Some((name, after)) if !name.contains('`') => {
                let name = name.trim_start_matches("crate::").trim_start_matches("super::");
                let _ = write!(text, "`{name}`");
                let target = after.strip_prefix('(').and_then(|path| path.split_once(')'));
                rest = target.map_or(after, |(_, after)| after);
            }
            _ => {
                text.push_str("[`");
                rest = link;
            }
        }
    }
    text + rest
}

impl Collector {
    fn laws<S: Settings>(&mut self, kind: &'static str) {
        for (i, name) in S::NAMES.iter().enumerate() {
            let mut block = Block::default();
            if let Some(mut settings) = S::named(name) {
                settings.settings(&mut block);
            }
            let mut text = module_doc(S::SOURCES.get(i).copied().unwrap_or_default());
            if kind == "vehicle" {
                let doc = VehicleSettings::DOCS.get(i).copied().unwrap_or_default();
                let made = VehicleSettings::named(name).map(|settings| rotors(&settings.vehicle));
                text = format!("{doc}\n\n{}", made.unwrap_or_default());
            }
            if *name == "rotors" {
                text = format!("{text}\n{}", rotors(&Vehicle::default()));
            }
            let summary = text.lines().next().unwrap_or_default().trim_end_matches('.').to_owned();
            let Block { choices, tables, numbers } = block;
            self.0.push(Entry {
                kind,
                key: S::KEY,
                name: (*name).to_owned(),
                summary,
                text,
                choices,
                tables,
                numbers,
            });
        }
    }
}

impl BlockVisitor for Collector {
    fn block<S: Settings>(&mut self, key: &'static str, _: &'static str, _: &mut S) {
        self.laws::<S>(key);
    }

    fn list<S: Settings>(&mut self, key: &'static str, _: &'static str, _: &mut Vec<S>) {
        self.laws::<S>(key);
    }

    fn plain<R: Record<f64>, O: Options>(
        &mut self,
        key: &'static str,
        doc: &'static str,
        numbers: &mut R,
        options: &mut O,
    ) {
        let mut block = Block::default();
        options.visit(&mut block);
        numbers.visit_mut(&Path::ROOT, &Meta::signal("", ""), &mut block);
        let Block { choices, tables, numbers } = block;
        let summary = doc.trim_end_matches('.').to_owned();
        self.0.push(Entry {
            kind: "block",
            key: "",
            name: key.to_owned(),
            text: doc.to_owned(),
            summary,
            choices,
            tables,
            numbers,
        });
    }
}

/// Rows and columns of the drawing of a layout.
const DRAWING: (usize, usize) = (7, 37);

/// The rotors seen from above, x forward (up) and y left, and the wrench that they make.
fn rotors(vehicle: &Vehicle<f64>) -> String {
    let mounts = vehicle.mounts();
    let reach = mounts.iter().fold(1e-9, |most, mount| {
        let Vec3 { x, y, .. } = mount.place;
        Real::max(most, Real::max(Real::abs(x), Real::abs(y)))
    });
    let (rows, columns) = DRAWING;
    let mut grid = vec![vec![' '; columns]; rows];
    let mut write = |x: f64, y: f64, text: &str| {
        let middle = |count: usize| (count as f64 - 1.0) / 2.0;
        let row = Real::round(middle(rows) * (1.0 - x / reach));
        let column = Real::round(middle(columns) - y / reach * 12.0);
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // inside the grid
        let (row, column) = (row as usize, (column as usize).saturating_sub(text.len() / 2));
        for (cell, letter) in grid.get_mut(row).into_iter().flatten().skip(column).zip(text.chars())
        {
            *cell = letter;
        }
    };
    write(0.0, 0.0, "+");
    for (i, mount) in mounts.iter().enumerate() {
        let spin = if mount.spin > 0.0 { "ccw" } else { "cw" };
        write(mount.place.x, mount.place.y, &format!("{} ({spin})", i + 1));
    }
    let drawn: Vec<String> =
        grid.iter().map(|row| format!("  {}", row.iter().collect::<String>().trim_end())).collect();
    let places: Vec<String> = mounts
        .iter()
        .enumerate()
        .map(|(i, m)| {
            format!(
                "  rotor {}  x {:+.3} m  y {:+.3} m  spin {:+}",
                i + 1,
                m.place.x,
                m.place.y,
                m.spin
            )
        })
        .collect();
    let equations = [
        "  T_i   = k w_i^2,  T = T_1 + T_2 + T_3 + T_4",
        "  tau_x = sum y_i T_i",
        "  tau_y = -sum x_i T_i",
        "  tau_z = -sum spin_i c w_i^2",
    ];
    format!(
        "Rotors seen from above, x forward (up), y left:\n\n{}\n\n{}\n\n{}\n",
        drawn.join("\n"),
        places.join("\n"),
        equations.join("\n")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_become_names() {
        assert_eq!(without_links("as in [`triad`](super::triad), (1)"), "as in `triad`, (1)");
        assert_eq!(without_links("[`A`] and [`crate::b`], x[3]"), "`A` and `b`, x[3]");
        assert_eq!(without_links("[`a`, `b`]"), "[`a`, `b`]");
    }

    #[test]
    fn no_text_has_links_or_points_into_the_source() {
        for Entry { name, text, .. } in catalogue() {
            for syntax in ["](", "[`", "::"] {
                assert!(!text.contains(syntax), "{name}: {syntax} in {text}");
            }
        }
    }

    #[test]
    fn a_preset_has_its_own_default_layout() {
        let all = catalogue();
        let layout = |name: &str| {
            let entry = all.iter().find(|e| e.kind == "vehicle" && e.name == name);
            entry.and_then(|e| e.choices.first()).map(|choice| choice.default)
        };
        assert_eq!(layout("x500"), Some("px4-x"));
        assert_eq!(layout("hummingbird"), Some("px4-x"));
        assert_eq!(layout("article"), Some("article-plus"));
        assert_eq!(layout("racer"), Some("free"));
    }
}
