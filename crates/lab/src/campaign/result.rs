//! What a campaign records of each flight.

use std::fmt;

use crate::fly::Failure;

/// A value that was drawn for a flight.
#[derive(Clone, Debug, PartialEq)]
pub enum Input {
    /// A number, SI.
    Number(f64),
    /// The name of a law or an option.
    Text(String),
}

impl fmt::Display for Input {
    /// The shortest text that reads back as the same value.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(x) => write!(f, "{x:?}"),
            Self::Text(text) => f.write_str(text),
        }
    }
}

/// The columns of a campaign, after index and seed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Columns {
    /// Drawn inputs, in the order of the file.
    pub inputs: Vec<String>,
    /// Metrics by flat name.
    pub metrics: Vec<String>,
}

/// One flight.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Position in the plan, from zero.
    pub index: u64,
    /// Seed of the flight's random draws.
    pub seed: u64,
    /// Drawn inputs, one for each of [`Columns::inputs`].
    pub inputs: Vec<Input>,
    /// Present where the flight failed.
    pub failure: Option<Failure>,
    /// One for each of [`Columns::metrics`]; NaN where the flight does not have it.
    pub metrics: Vec<f64>,
}
