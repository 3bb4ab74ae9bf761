//! Numbers that a flight must show, and whether it did.

use super::document::{Node, Table, Value};
use super::fault::{Fault, Place};
use super::read::{scientific, unknown};

/// What a metric must be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rule {
    /// Within a distance of a value.
    Within {
        /// The value.
        value: f64,
        /// The largest distance.
        tolerance: f64,
    },
    /// At most.
    Max(f64),
    /// At least.
    Min(f64),
}

/// One line of `[expect]`.
#[derive(Clone, Debug)]
pub struct Expectation {
    /// Flat name of the metric, such as `position.iae`.
    pub metric: String,
    /// What it must be.
    pub rule: Rule,
    /// Where the file says so.
    pub place: Place,
}

impl Expectation {
    /// Whether the value obeys; NaN never does.
    pub fn holds(&self, value: f64) -> bool {
        match self.rule {
            Rule::Within { value: expected, tolerance } => (value - expected).abs() <= tolerance,
            Rule::Max(most) => value <= most,
            Rule::Min(least) => value >= least,
        }
    }

    /// Whether some number from `least` to `most` obeys, with room for rounding.
    pub fn possible(&self, least: f64, most: f64) -> bool {
        let most = most * (1.0 + 1e-9);
        match self.rule {
            Rule::Within { value, tolerance } => {
                value + tolerance >= least && value - tolerance <= most
            }
            Rule::Max(max) => max >= least,
            Rule::Min(min) => min <= most,
        }
    }

    /// The rule in words.
    pub fn describe(&self) -> String {
        match self.rule {
            Rule::Within { value, tolerance } => format!("{value} +- {tolerance:.3e}"),
            Rule::Max(most) => format!("at most {most}"),
            Rule::Min(least) => format!("at least {least}"),
        }
    }
}

const KEYS: [&str; 5] = ["value", "within_percent", "within", "max", "min"];

/// Reads an `[expect]` table; dotted keys may be quoted or nested.
pub fn read(table: &Table, prefix: &str, out: &mut Vec<Expectation>, faults: &mut Vec<Fault>) {
    for entry in &table.0 {
        let metric =
            if prefix.is_empty() { entry.key.clone() } else { format!("{prefix}.{}", entry.key) };
        match &entry.node.value {
            Value::Table(inner)
                if !inner.0.iter().any(|e| matches!(e.node.value, Value::Table(_))) =>
            {
                match rule(inner, &entry.node, &metric) {
                    Ok(rule) => out.push(Expectation { metric, rule, place: entry.place.clone() }),
                    Err(fault) => faults.push(fault),
                }
            }
            Value::Table(inner) => read(inner, &metric, out, faults),
            other => {
                let shown = match other {
                    Value::Number(x, _) => scientific(*x),
                    _ => "0.05".to_owned(),
                };
                let fault = Fault::new(
                    &entry.node.place,
                    format!("`expect.{metric}` does not say what is wanted"),
                );
                faults.push(fault.help(format!(
                    "write {{ max = {shown} }}, {{ min = {shown} }} or {{ value = {shown}, within_percent = 2.0 }}"
                )));
            }
        }
    }
}

fn rule(table: &Table, node: &Node, metric: &str) -> Result<Rule, Fault> {
    let field = format!("expect.{metric}");
    for entry in &table.0 {
        if !KEYS.contains(&entry.key.as_str()) {
            let shown = format!("{field}.{}", entry.key);
            return Err(unknown(&entry.place, "field", &shown, &entry.key, &KEYS));
        }
    }
    let number = |key: &str| match table.get(key) {
        None => Ok(None),
        Some(Node { value: Value::Number(x, _), .. }) if x.is_finite() => Ok(Some(*x)),
        Some(node) => {
            Err(Fault::new(&node.place, format!("`{field}.{key}` must be a finite number")))
        }
    };
    let given = [
        number("value")?,
        number("within_percent")?,
        number("within")?,
        number("max")?,
        number("min")?,
    ];
    for key in ["within_percent", "within"] {
        if let Some(Node { value: Value::Number(x, _), place }) = table.get(key)
            && *x < 0.0
        {
            let message = format!("`{field}.{key}` = {}: no distance is below 0", scientific(*x));
            return Err(Fault::new(place, message).help("write it without the sign"));
        }
    }
    match given {
        [Some(value), Some(percent), None, None, None] => {
            Ok(Rule::Within { value, tolerance: value.abs() * percent / 100.0 })
        }
        [Some(value), None, Some(tolerance), None, None] => Ok(Rule::Within { value, tolerance }),
        [None, None, None, Some(max), None] => Ok(Rule::Max(max)),
        [None, None, None, None, Some(min)] => Ok(Rule::Min(min)),
        _ => Err(Fault::new(&node.place, format!("`{field}`: the keys do not fit together"))
            .help("give value and within_percent, value and within, max alone, or min alone")),
    }
}
