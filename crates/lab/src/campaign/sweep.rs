//! `[[sweep]]` tables: which settings a campaign varies, and how.

use stormpetrel_control::real::Real;

use super::random::normal_quantile;
use super::result::Input;
use crate::scenario::document::{Entry, Node, Table, Value, dotted};
use crate::scenario::fault::{Fault, Place};
use crate::scenario::read::{unknown, wrong_type};

/// How values are drawn.
#[derive(Clone, Debug, PartialEq)]
pub enum Draw {
    /// Evenly between two values.
    Uniform(f64, f64),
    /// Evenly in the logarithm between two positive values.
    LogUniform(f64, f64),
    /// Around a mean with a standard deviation, cut at four of them.
    Normal(f64, f64),
    /// So many values evenly from one to another, both included.
    Grid(f64, f64, u64),
    /// These values, one after the other.
    List(Vec<Input>),
}

/// One input of a campaign.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// Name of the column: the first path unless the file gives another.
    pub name: String,
    /// Dotted paths that take the value.
    pub paths: Vec<String>,
    /// Whether the value multiplies the file's own number.
    pub relative: bool,
    /// How values are drawn.
    pub draw: Draw,
    /// Where it stands.
    pub place: Place,
}

/// Probability below four standard deviations.
const FOUR_SIGMA: f64 = 3.167_124_183_311_992e-5;

/// A probability that makes no whole number out of ordinary bounds.
const BETWEEN: f64 = 0.367_879_441_171_442_3;

impl Draw {
    /// How many values there are, where they are counted and not drawn.
    pub fn count(&self) -> Option<u64> {
        match self {
            Self::Grid(_, _, count) => Some(*count),
            Self::List(values) => Some(values.len() as u64),
            _ => None,
        }
    }

    /// Value `cell` of a grid or list.
    pub fn cell(&self, cell: u64) -> Input {
        match self {
            Self::Grid(low, high, count) => {
                let step = (high - low) / (*count - 1) as f64;
                if low.fract() == 0.0 && high.fract() == 0.0 && step.fract() == 0.0 {
                    // Whole numbers stay whole.
                    return Input::Number(low + step * cell as f64);
                }
                let share = cell as f64 / (*count - 1) as f64;
                // Both ends exactly as they are written.
                Input::Number(low * (1.0 - share) + high * share)
            }
            Self::List(values) => {
                let at = usize::try_from(cell).unwrap_or(0) % values.len();
                values[at].clone()
            }
            _ => Input::Number(self.at(0.5)),
        }
    }

    /// Whether the values are names and no numbers.
    pub fn is_named(&self) -> bool {
        matches!(self, Self::List(values) if values.iter().any(|value| matches!(value, Input::Text(_))))
    }

    /// The value at the probability 0 < u < 1.
    pub fn at(&self, u: f64) -> f64 {
        match *self {
            Self::Uniform(low, high) => low + (high - low) * u,
            Self::LogUniform(low, high) => low * Real::exp(u * Real::ln(high / low)),
            Self::Normal(mean, sigma) => {
                mean + sigma * normal_quantile(FOUR_SIGMA + u * (1.0 - 2.0 * FOUR_SIGMA))
            }
            Self::Grid(low, ..) => low,
            Self::List(_) => 0.0,
        }
    }

    /// Every value where they are counted, nothing where they are more than `most`; else the extreme ones.
    pub fn corners(&self, most: u64) -> Option<Vec<Input>> {
        match self.count() {
            Some(count) if count > most => None,
            Some(count) => Some((0..count).map(|cell| self.cell(cell)).collect()),
            None => Some(self.extremes()),
        }
    }

    /// The extreme values; every value where there are no others.
    pub fn extremes(&self) -> Vec<Input> {
        match self {
            Self::Uniform(low, high) | Self::LogUniform(low, high) | Self::Grid(low, high, _) => {
                vec![Input::Number(*low), Input::Number(*high)]
            }
            Self::Normal(mean, sigma) => {
                vec![Input::Number(mean - 4.0 * sigma), Input::Number(mean + 4.0 * sigma)]
            }
            Self::List(values) => values.clone(),
        }
    }

    /// A value between the extremes, where there are such.
    pub fn between(&self) -> Option<Input> {
        match self {
            Self::Grid(..) => Some(self.cell(1)),
            Self::List(_) => None,
            _ => Some(Input::Number(self.at(BETWEEN))),
        }
    }

    /// As a report says it.
    pub fn describe(&self) -> String {
        match self {
            Self::Uniform(low, high) => format!("uniform from {low} to {high}"),
            Self::LogUniform(low, high) => format!("log-uniform from {low} to {high}"),
            Self::Normal(mean, sigma) => {
                format!("normal, mean {mean}, standard deviation {sigma}, cut at four of them")
            }
            Self::Grid(low, high, count) => format!("{count} values from {low} to {high}"),
            Self::List(values) => {
                let shown: Vec<String> = values.iter().map(Input::to_string).collect();
                shown.join(", ")
            }
        }
    }
}

const KEYS: [&str; 8] =
    ["path", "name", "relative", "uniform", "log_uniform", "normal", "grid", "list"];

/// Reads the list under `sweep`; what is wrong goes to `faults`.
pub fn read(node: &Node, faults: &mut Vec<Fault>) -> Vec<Sweep> {
    let Value::List(items) = &node.value else {
        faults.push(wrong_type(&node.place, "sweep", &node.value, "").help("write [[sweep]]"));
        return Vec::new();
    };
    let mut sweeps: Vec<Sweep> = Vec::new();
    for item in items {
        let Value::Table(table) = &item.value else {
            faults.push(wrong_type(&item.place, "sweep", &item.value, ""));
            continue;
        };
        let before = faults.len();
        let read = read_one(table, &item.place, faults);
        if faults.len() > before {
            continue;
        }
        let Some(sweep) = read else { continue };
        sweeps.push(sweep);
    }
    faults.extend(twice(&sweeps));
    sweeps
}

/// Two inputs of one name, and settings that two paths change: one of both would be lost.
fn twice(sweeps: &[Sweep]) -> Vec<Fault> {
    let mut faults = Vec::new();
    let mut seen: Vec<Vec<String>> = Vec::new();
    for (at, sweep) in sweeps.iter().enumerate() {
        let again = |what: &str| {
            let message = format!("`{what}` is swept twice");
            Fault::new(&sweep.place, message).help("one [[sweep]] for one input")
        };
        if sweeps[..at].iter().any(|other| other.name == sweep.name) {
            faults.push(again(&sweep.name));
            continue;
        }
        for path in &sweep.paths {
            let parts = parts(path);
            // One within the other, or the same.
            if seen.iter().any(|other| other.iter().zip(&parts).all(|(a, b)| a == b)) {
                faults.push(again(path));
            }
            seen.push(parts);
        }
    }
    faults
}

/// The parts of a path; items of a list by their number, however it is written.
fn parts(path: &str) -> Vec<String> {
    let part = |part: &str| match part {
        "x" => "0".to_owned(),
        "y" => "1".to_owned(),
        "z" => "2".to_owned(),
        _ => part.parse::<u64>().map_or_else(|_| part.to_owned(), |number| number.to_string()),
    };
    path.split('.').map(part).collect()
}

/// Refuses paths that are none, and those that change no flight.
fn check_path(path: &str, place: &Place) -> Option<Fault> {
    const OTHERS: [&str; 6] = ["campaign", "sweep", "title", "about", "expect", "variant"];
    if let Err(message) = dotted(path) {
        return Some(Fault::new(place, message).help("write it as path = \"vehicle.mass\""));
    }
    let first = path.split('.').next().unwrap_or_default();
    if OTHERS.contains(&first) || path == "run.log_every" {
        let fault = Fault::new(place, format!("`{path}` cannot be swept: it changes no flight"));
        return Some(fault.help("sweep a setting of run, vehicle, laws or world"));
    }
    None
}

fn read_one(table: &Table, place: &Place, faults: &mut Vec<Fault>) -> Option<Sweep> {
    let (mut paths, mut name, mut relative, mut draws) = (Vec::new(), None, false, Vec::new());
    let mut given = 0;
    for Entry { key, node, place, .. } in &table.0 {
        match (key.as_str(), &node.value) {
            ("path", Value::Text(path)) => paths.push(path.clone()),
            ("path", Value::List(all)) => paths.extend(texts(all, faults)),
            ("name", Value::Text(text)) => {
                if ["index", "seed"].contains(&text.as_str()) || text.contains(char::is_control) {
                    let message =
                        format!("`sweep.name` = {text:?} cannot head a column of the plan");
                    let help =
                        "`index` and `seed` are columns of their own, and a name has one line";
                    faults.push(Fault::new(&node.place, message).help(help));
                }
                name = Some(text.clone());
            }
            ("relative", Value::Flag(flag)) => relative = *flag,
            ("path" | "name", other) => {
                faults.push(wrong_type(&node.place, &format!("sweep.{key}"), other, "text"));
            }
            ("relative", _) => {
                faults.push(Fault::new(&node.place, "`sweep.relative` must be true or false"));
            }
            (known, Value::List(items)) if KEYS.contains(&known) => {
                given += 1;
                draws.extend(draw(known, items, &node.place, faults));
            }
            (known, _) if KEYS.contains(&known) => {
                given += 1;
                let message = format!("`sweep.{known}` must be a list");
                faults.push(Fault::new(&node.place, message).help(shape(known)));
            }
            (other, _) => {
                faults.push(unknown(place, "field", &format!("sweep.{other}"), other, &KEYS));
            }
        }
    }
    if paths.is_empty() {
        faults.push(Fault::new(place, "a sweep has no path").help("add path = \"vehicle.mass\""));
    }
    faults.extend(paths.iter().filter_map(|path| check_path(path, place)));
    if paths.iter().any(|path| path == "run.seed") {
        let help = "every flight has a seed of its own, which follows from that of the file";
        faults.push(Fault::new(place, "`run.seed` cannot be swept").help(help));
    }
    if given != 1 {
        let message = format!("a sweep has {given} distributions: it takes one");
        let help = "give one of uniform, log_uniform, normal, grid, list";
        faults.push(Fault::new(place, message).help(help));
    }
    let draw = draws.pop()?;
    if relative && draw.is_named() {
        faults.push(Fault::new(place, "`sweep.relative`: a name cannot be multiplied"));
    }
    let name = name.or_else(|| paths.first().cloned())?;
    Some(Sweep { name, paths, relative, draw, place: place.clone() })
}

fn texts(items: &[Node], faults: &mut Vec<Fault>) -> Vec<String> {
    let mut all = Vec::new();
    for item in items {
        match &item.value {
            Value::Text(text) => all.push(text.clone()),
            other => faults.push(wrong_type(&item.place, "sweep.path", other, "text")),
        }
    }
    all
}

fn shape(key: &str) -> &'static str {
    match key {
        "uniform" | "log_uniform" => "write [low, high]",
        "normal" => "write [mean, standard deviation]",
        "grid" => "write [low, high, count]",
        _ => "write [value, value, ...]",
    }
}

fn draw(key: &str, items: &[Node], place: &Place, faults: &mut Vec<Fault>) -> Option<Draw> {
    if key == "list" {
        return list(items, place, faults);
    }
    let numbers: Vec<f64> = items
        .iter()
        .filter_map(|item| match item.value {
            Value::Number(x, _) if x.is_finite() => Some(x),
            _ => None,
        })
        .collect();
    let mut bad = |message: String| {
        faults.push(Fault::new(place, message).help(shape(key)));
        None
    };
    match (key, numbers.as_slice()) {
        _ if numbers.len() != items.len() => bad(format!("`sweep.{key}` takes finite numbers")),
        ("uniform", [low, high]) if low < high => Some(Draw::Uniform(*low, *high)),
        ("log_uniform", [low, high]) if 0.0 < *low && low < high => {
            Some(Draw::LogUniform(*low, *high))
        }
        ("normal", [mean, sigma]) if *sigma > 0.0 => Some(Draw::Normal(*mean, *sigma)),
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // a whole number by rule
        ("grid", [low, high, count])
            if low < high && *count >= 2.0 && *count <= 1e6 && count.fract() == 0.0 =>
        {
            Some(Draw::Grid(*low, *high, *count as u64))
        }
        ("uniform", [low, high]) => bad(format!("`sweep.uniform`: {low} is not below {high}")),
        ("log_uniform", [low, high]) => {
            bad(format!("`sweep.log_uniform`: 0 < {low} < {high} does not hold"))
        }
        ("normal", [_, sigma]) => {
            bad(format!("`sweep.normal`: deviation {sigma} must be positive"))
        }
        ("grid", [low, high, count]) => bad(format!(
            "`sweep.grid`: {low} must be below {high}, and {count} a whole number from 2 to 1000000"
        )),
        _ => bad(format!("`sweep.{key}` has {} numbers", numbers.len())),
    }
}

fn list(items: &[Node], place: &Place, faults: &mut Vec<Fault>) -> Option<Draw> {
    let mut values = Vec::new();
    for item in items {
        match &item.value {
            Value::Number(x, _) if x.is_finite() => values.push(Input::Number(*x)),
            Value::Text(text) => values.push(Input::Text(text.clone())),
            Value::Flag(flag) => values.push(Input::Text(flag.to_string())),
            Value::Number(x, _) => {
                let message = format!("`sweep.list` holds {x}: must be finite");
                faults.push(Fault::new(&item.place, message));
            }
            other => faults.push(wrong_type(&item.place, "sweep.list", other, "1")),
        }
    }
    let texts = values.iter().filter(|value| matches!(value, Input::Text(_))).count();
    if texts != 0 && texts != values.len() {
        faults.push(Fault::new(place, "`sweep.list` mixes numbers and names"));
        return None;
    }
    if items.is_empty() {
        faults.push(Fault::new(place, "`sweep.list` is empty").help(shape("list")));
    }
    (!values.is_empty()).then_some(Draw::List(values))
}
