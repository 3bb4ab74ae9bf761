//! The scenarios that come with the program, so that it finds them wherever it runs.

use std::path::Path;

use crate::scenario::fault::Faults;
use crate::scenario::{File, load_text};

macro_rules! shipped {
    ($($name:literal),* $(,)?) => {
        /// Name and text of every shipped scenario file.
        pub const SHIPPED: &[(&str, &str)] =
            &[$(($name, include_str!(concat!("../../../scenarios/", $name, ".toml")))),*];
    };
}

shipped![
    "hover",
    "first-flight",
    "article/literal",
    "article/consistent",
    "article/rotors",
    "article/stress",
    "article/stress-rotors",
    "article/translational",
    "references/line",
    "references/circle",
    "references/lemniscate",
    "references/lissajous",
    "references/minimum-snap",
    "references/race",
    "references/table",
    "world/fan",
    "world/payload-drop",
    "world/lost-rotor",
    "world/gnss-dropout",
];

/// Name and text of every table that a shipped scenario names.
const TABLES: &[(&str, &str)] = &[(
    "scenarios/references/recording.csv",
    include_str!("../../../scenarios/references/recording.csv"),
)];

/// The text of a table beside a shipped scenario.
pub fn table(path: &Path) -> Option<&'static str> {
    TABLES.iter().find(|(name, _)| path == Path::new(name)).map(|(_, text)| *text)
}

/// A shipped scenario file by name; `None` where there is none of that name.
pub fn shipped(name: &str) -> Option<Result<File, Faults>> {
    let (name, text) = SHIPPED.iter().find(|(known, _)| *known == name)?;
    Some(load_text(name, &format!("scenarios/{name}.toml"), (*text).to_owned(), &[]))
}
