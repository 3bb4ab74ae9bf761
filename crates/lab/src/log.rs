//! The log of a flight: every number of a tick under its dotted name.

use std::io::{self, Write};

use stormpetrel_control::record::{Meta, Path, Record, Visitor};
use stormpetrel_plant::actuation::battery::Gauge;
use stormpetrel_plant::disturbance::MOST;
use stormpetrel_plant::dynamics::Push;
use stormpetrel_plant::flight::Tick;

use crate::fly::Seen;
use crate::scenario::Scenario;

/// A column of the log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// Dotted name.
    pub name: String,
    /// SI unit.
    pub unit: &'static str,
    /// `world`, `body` or empty.
    pub frame: &'static str,
    /// Meaning.
    pub doc: &'static str,
}

#[derive(Default)]
struct Columns(Vec<Column>);

impl Visitor<f64> for Columns {
    fn number(&mut self, path: &Path<'_>, meta: &Meta, _: f64) {
        let Meta { unit, frame, doc, .. } = *meta;
        self.0.push(Column { name: path.to_string(), unit, frame, doc: doc.trim() });
    }
}

/// The positions of disturbances, as names.
const NUMBERS: [&str; MOST] = ["0", "1", "2", "3", "4", "5", "6", "7"];

/// Walks over disturbances and battery: `disturbance.0.force.x` and so on, `battery.charge`.
fn visit(sources: &[Push<f64>], battery: Option<Gauge<f64>>, v: &mut impl Visitor<f64>) {
    let root = Path::ROOT.join("disturbance");
    for (push, number) in sources.iter().zip(NUMBERS) {
        push.visit(&root.join(number), &Meta::signal("", ""), v);
    }
    if let Some(gauge) = battery {
        gauge.visit(&Path::ROOT.join("battery"), &Meta::signal("", ""), v);
    }
}

/// All columns of a flight of this scenario, in the order of the rows.
pub fn columns(scenario: &Scenario) -> Vec<Column> {
    let sources = scenario.disturbance.len().min(MOST);
    let battery = scenario.has_battery().then(Gauge::default);
    let mut columns = Columns::default();
    Tick::<f64>::default().visit(&Path::ROOT, &Meta::signal("", ""), &mut columns);
    visit(&[Push::default(); MOST][..sources], battery, &mut columns);
    columns.0
}

struct Row<'a>(&'a mut Vec<f64>);

impl Visitor<f64> for Row<'_> {
    fn number(&mut self, _: &Path<'_>, _: &Meta, value: f64) {
        self.0.push(value);
    }
}

/// The numbers of a tick, in the order of [`columns`].
fn row(seen: &Seen<'_>, into: &mut Vec<f64>) {
    into.clear();
    seen.tick.visit(&Path::ROOT, &Meta::signal("", ""), &mut Row(into));
    visit(seen.sources, seen.battery, &mut Row(into));
}

/// Writes rows as CSV with one header row of dotted names.
pub struct Csv<W: Write> {
    out: W,
    every: u64,
    seen: u64,
    values: Vec<f64>,
}

impl<W: Write> Csv<W> {
    /// Writes the header of a flight of this scenario; every `every`-th tick becomes a row.
    ///
    /// # Errors
    /// What the writer says.
    pub fn new(mut out: W, every: u64, scenario: &Scenario) -> io::Result<Self> {
        let names: Vec<_> = columns(scenario).into_iter().map(|column| column.name).collect();
        writeln!(out, "{}", names.join(","))?;
        Ok(Self { out, every, seen: 0, values: Vec::new() })
    }

    /// Takes a tick. Numbers are written with the digits that read back to the same bits.
    ///
    /// # Errors
    /// What the writer says.
    pub fn push(&mut self, seen: &Seen<'_>) -> io::Result<()> {
        let wanted = self.seen.is_multiple_of(self.every);
        self.seen += 1;
        if !wanted {
            return Ok(());
        }
        row(seen, &mut self.values);
        for (i, value) in self.values.iter().enumerate() {
            if i > 0 {
                self.out.write_all(b",")?;
            }
            write!(self.out, "{value}")?;
        }
        self.out.write_all(b"\n")
    }

    /// Flushes the writer.
    ///
    /// # Errors
    /// What the writer says.
    pub fn finish(mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// Hash of a whole log: FNV-1a over the bits of every number of every tick.
#[derive(Clone, Debug)]
pub struct Hash {
    state: u64,
    values: Vec<f64>,
}

impl Default for Hash {
    fn default() -> Self {
        Self { state: 0xCBF2_9CE4_8422_2325, values: Vec::new() }
    }
}

impl Hash {
    /// Takes a tick.
    pub fn push(&mut self, tick: &Tick<f64>) {
        self.values.clear();
        tick.visit(&Path::ROOT, &Meta::signal("", ""), &mut Row(&mut self.values));
        for value in &self.values {
            self.state = (self.state ^ value.to_bits()).wrapping_mul(0x0100_0000_01B3);
        }
    }

    /// The hash so far.
    pub fn value(&self) -> u64 {
        self.state
    }
}
