//! From the tree to the settings: every number and option asks the file for its value.

use stormpetrel_control::options::{Cells, OptionVisitor, Shape};
use stormpetrel_control::record::{Meta, Path, VisitorMut};

use super::document::{Node, Table, Value};
use super::fault::{Fault, Place};
use super::rows;

/// Reads one block: a table whose keys are numbers, vectors and options.
pub struct Reader<'a> {
    block: &'a str,
    table: &'a Table,
    known: Vec<&'static str>,
    /// Tables that must be given and are not, each with how to write it.
    missing: Vec<(&'static str, String)>,
    /// What was found wrong.
    pub faults: Vec<Fault>,
}

impl<'a> Reader<'a> {
    /// A reader of `table`, which stands under the name `block`.
    pub fn new(block: &'a str, table: &'a Table) -> Self {
        Self { block, table, known: Vec::new(), missing: Vec::new(), faults: Vec::new() }
    }

    /// Declares a key that somebody else reads.
    pub fn knows(&mut self, key: &'static str) {
        self.known.push(key);
    }

    /// Refuses every key that nobody asked for, and a block at `place` without a table that it needs.
    pub fn finish(mut self, place: &Place) -> Vec<Fault> {
        for (name, help) in std::mem::take(&mut self.missing) {
            let message = format!("`{}` is missing", self.field(name));
            self.faults.push(Fault::new(place, message).help(help));
        }
        for entry in &self.table.0 {
            if !self.known.iter().any(|known| *known == entry.key) {
                let field = format!("{}.{}", self.block, entry.key);
                self.faults.push(unknown(&entry.place, "field", &field, &entry.key, &self.known));
            }
        }
        self.faults.sort_by_key(|fault| fault.place.as_ref().map(|place| place.span.start));
        self.faults
    }

    fn field(&self, key: &str) -> String {
        format!("{}.{key}", self.block)
    }

    /// The node of `kp.x`: an own key, an item of a list, or the one number for all components.
    fn find(&self, path: &Path<'_>) -> Option<&'a Node> {
        let Some(parent) = path.parent() else { return self.table.get(path.name()) };
        let node = self.find(parent)?;
        match &node.value {
            Value::Table(table) => table.get(path.name()),
            Value::List(items) => {
                items.get(["x", "y", "z"].iter().position(|name| *name == path.name())?)
            }
            _ => Some(node),
        }
    }

    /// The field as it is written: one number for all axes has no axis in its name.
    fn written(&self, path: &Path<'_>) -> String {
        match self.table.get(path.first()) {
            Some(Node { value: Value::Number(..), .. }) => self.field(path.first()),
            _ => self.field(&path.to_string()),
        }
    }
}

impl VisitorMut<f64> for Reader<'_> {
    fn vector(&mut self, path: &Path<'_>, meta: &Meta, components: &'static [&'static str]) {
        let key = path.name();
        self.known.push(key);
        let shape = "give one number for all axes, or [x, y, z]";
        let field = || format!("{}.{key}", self.block);
        match self.table.get(key) {
            Some(Node { place, value: Value::List(items) }) if items.len() != components.len() => {
                let message = format!("`{}` has {} numbers: it takes 1 or 3", field(), items.len());
                self.faults.push(Fault::new(place, message).help(shape));
            }
            Some(Node { value: Value::Table(axes), .. }) => {
                for entry in &axes.0 {
                    if !components.contains(&entry.key.as_str()) {
                        let name = format!("{}.{}", field(), entry.key);
                        self.faults.push(unknown(
                            &entry.place,
                            "axis",
                            &name,
                            &entry.key,
                            components,
                        ));
                    }
                }
            }
            Some(Node { place, value: value @ (Value::Text(_) | Value::Flag(_)) }) => {
                let fault = wrong_type(place, &field(), value, meta.unit);
                let comma = matches!(value, Value::Text(text) if decimal_point(text).is_some());
                self.faults.push(if comma { fault } else { fault.help(shape) });
            }
            _ => {}
        }
    }

    fn number(&mut self, path: &Path<'_>, meta: &Meta, value: &mut f64) {
        if path.parent().is_none() {
            self.known.push(path.name());
        }
        let Some(node) = self.find(path) else { return };
        match &node.value {
            Value::Number(x, whole) if fits(*x, *whole, meta.unit, meta.range) => *value = *x,
            Value::Number(x, whole) => {
                let (message, help) =
                    refuse(&self.written(path), *x, *whole, meta.unit, meta.range);
                let fault = Fault { help, ..Fault::new(&node.place, message) };
                // One number for three axes is one mistake.
                let last = self.faults.last().and_then(|fault| fault.place.as_ref());
                if last.is_none_or(|last| !last.is(&node.place)) {
                    self.faults.push(fault);
                }
            }
            Value::Text(_) | Value::Flag(_) if path.parent().is_some() && self.in_vector(path) => {}
            other => {
                let field = self.written(path);
                self.faults.push(wrong_type(&node.place, &field, other, meta.unit));
            }
        }
    }
}

impl Reader<'_> {
    /// Whether the whole vector was refused already.
    fn in_vector(&self, path: &Path<'_>) -> bool {
        let node = self.table.get(path.first());
        matches!(node, Some(Node { value: Value::Text(_) | Value::Flag(_), .. }))
    }
}

impl OptionVisitor for Reader<'_> {
    fn choice(
        &mut self,
        name: &'static str,
        _: &'static str,
        names: &'static [&'static str],
        _: &'static [&'static str],
        current: usize,
    ) -> usize {
        self.known.push(name);
        let Some(node) = self.table.get(name) else { return current };
        let given = match &node.value {
            Value::Text(text) => text.clone(),
            Value::Flag(flag) => flag.to_string(),
            _ => {
                let message = format!("`{}` must be one of {}", self.field(name), quoted(names));
                self.faults.push(Fault::new(&node.place, message));
                return current;
            }
        };
        names.iter().position(|known| *known == given).unwrap_or_else(|| {
            let field = self.field(name);
            self.faults.push(unknown(
                &node.place,
                "value",
                &format!("{field} = \"{given}\""),
                &given,
                names,
            ));
            current
        })
    }

    fn rows(
        &mut self,
        name: &'static str,
        _: &'static str,
        shape: &Shape,
        current: Cells,
    ) -> Cells {
        self.known.push(name);
        let node = self.table.get(name);
        let fewest = shape.rows.0;
        match node {
            Some(node) => rows::read(&self.field(name), node, shape, &mut self.faults),
            None if current.cells.is_empty() && fewest > 0 => {
                self.missing.push((name, rows::how(name, shape)));
                None
            }
            None => None,
        }
        .unwrap_or(current)
    }
}

/// Whether a number can be taken.
pub(super) fn fits(x: f64, whole: bool, unit: &str, (lo, hi): (f64, f64)) -> bool {
    x >= lo && x <= hi && x.is_finite() && !is_fraction(x, whole, unit)
}

fn is_fraction(x: f64, whole: bool, unit: &str) -> bool {
    unit == "count" && !whole && x.fract() != 0.0
}

/// Why a number that does not fit cannot be taken, and what may have been meant.
pub(super) fn refuse(
    field: &str,
    x: f64,
    whole: bool,
    unit: &str,
    (lo, hi): (f64, f64),
) -> (String, Option<String>) {
    let shown = if unit == "1" { String::new() } else { format!(" {unit}") };
    let range = format!("{} to {}{shown}", scientific(lo), scientific(hi));
    if !x.is_finite() {
        return (format!("`{field}` = {x}: must be a finite number from {range}"), None);
    }
    if is_fraction(x, whole, unit) {
        let help = format!(
            "write {} or {}; a [[sweep]] gives whole numbers with `list` or `grid`",
            x.floor(),
            x.ceil()
        );
        return (format!("`{field}` = {x}: must be a whole number"), Some(help));
    }
    (format!("`{field}` = {}: must lie in {range}", scientific(x)), slip(x, unit, (lo, hi)))
}

/// A number as a human would write it: very large and very small ones with a power of ten.
pub fn scientific(x: f64) -> String {
    let size = x.abs();
    if size >= 1e7 || (size < 1e-5 && size > 0.0) { format!("{x:e}") } else { x.to_string() }
}

/// The unit that was probably meant, if the number fits in it.
fn slip(x: f64, unit: &str, (lo, hi): (f64, f64)) -> Option<String> {
    let (other, factor) = match unit {
        "kg" => ("grams", 1e-3),
        "m" => ("millimetres", 1e-3),
        "s" => ("milliseconds", 1e-3),
        "rad" => ("degrees", std::f64::consts::PI / 180.0),
        "rad/s" => ("revolutions per minute", std::f64::consts::PI / 30.0),
        "kg m^2" => ("g m^2", 1e-3),
        _ => return None,
    };
    let meant = x * factor;
    let fits = meant >= lo && meant <= hi;
    fits.then(|| format!("{x} {other}? write {} ({unit})", round(meant)))
}

/// Five significant digits, as a human would write them.
fn round(x: f64) -> f64 {
    format!("{x:.4e}").parse().unwrap_or(x)
}

/// The known name that was probably meant, whatever the case of its letters.
pub fn nearest<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    // A very long name is near to nothing, and would take long to compare.
    let name = name.chars().take(64).collect::<String>().to_lowercase();
    let distance = |known: &str| strsim::damerau_levenshtein(&name, &known.to_lowercase());
    let near = known.iter().map(|known| (distance(known), *known)).filter(|(distance, known)| {
        *distance <= 1 + known.len() / 3 || known.starts_with(&name) || name.starts_with(known)
    });
    near.min().map(|(_, known)| known)
}

/// A name that nobody knows, with the nearest one that somebody does.
pub fn unknown(place: &Place, what: &str, shown: &str, name: &str, known: &[&str]) -> Fault {
    let nearest = nearest(name, known);
    // A long list of names hides the one that is meant.
    let list = if known.len() > 24 {
        "`stormpetrel list` shows all names".to_owned()
    } else {
        format!("known: {}", known.join(", "))
    };
    let help = match nearest {
        Some(candidate) => format!("did you mean `{candidate}`? {list}"),
        None if known.is_empty() => "this block has no settings".to_owned(),
        None => list,
    };
    Fault::new(place, format!("unknown {what} `{shown}`")).help(help)
}

/// `0,6` with a point.
fn decimal_point(text: &str) -> Option<String> {
    let (whole, digits) = text.trim().split_once(',')?;
    let number = format!("{whole}.{digits}");
    (!whole.is_empty() && number.parse::<f64>().is_ok()).then_some(number)
}

/// A value of the wrong kind.
pub fn wrong_type(place: &Place, field: &str, value: &Value, unit: &str) -> Fault {
    let got = match value {
        Value::Number(..) => "a number",
        Value::Text(_) => "a text",
        Value::Flag(_) => "true or false",
        Value::List(_) => "a list",
        Value::Table(_) => "a table",
    };
    let want = match unit {
        "" => "a table".to_owned(),
        "text" => "a text".to_owned(),
        "tables" => "a list of tables".to_owned(),
        "rows" => "a list of rows, or the name of a CSV file".to_owned(),
        "row" => "a list of numbers".to_owned(),
        "1" | "count" => "a number".to_owned(),
        unit => format!("a number in {unit}"),
    };
    let fault = Fault::new(place, format!("`{field}` is {got}: must be {want}"));
    match value {
        Value::Text(text) if want.starts_with("a number") => {
            if let Some(number) = decimal_point(text) {
                return fault.help(format!("write {number}: with a point, without quotes"));
            }
            let digits: String = text
                .trim()
                .chars()
                .take_while(|c| c.is_ascii_digit() || "+-.eE".contains(*c))
                .collect();
            match digits.parse::<f64>() {
                Ok(_) => fault.help(format!("write {digits} without quotes and without unit")),
                Err(_) => fault,
            }
        }
        _ => fault,
    }
}

fn quoted(names: &[&str]) -> String {
    names.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ")
}
