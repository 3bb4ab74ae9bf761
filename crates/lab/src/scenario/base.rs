//! One flight of a file, kept as a tree to be flown with other settings.

use std::path::Path;
use std::sync::Arc;

use super::Scenario;
use super::document::{Node, Table, missing_items, parse, parse_set};
use super::fault::{Fault, Faults, Source};
use super::load::{Variant, load_text, read_scenario, read_text, variants};

/// One flight of a file as a tree, to be flown with other settings again and again.
#[derive(Clone, Debug)]
pub struct Base {
    name: String,
    variant: Option<String>,
    tree: Table,
    source: Arc<Source>,
}

impl Base {
    /// Reads a file with its `--set` arguments, and the variant if it has several.
    ///
    /// # Errors
    /// Everything that is wrong with the file; a variant that is missing or unknown.
    pub fn load(path: &Path, sets: &[String], variant: Option<&str>) -> Result<Self, Faults> {
        let (name, shown, text) = read_text(path)?;
        load_text(&name, &shown, text.clone(), sets)?;
        let (base, source) = parse(&shown, text)?;
        let mut faults = Vec::new();
        let variants = variants(&base, &mut faults);
        Faults(faults).check()?;
        let Some(chosen) = variants.iter().find(|v| v.name == variant) else {
            let known: Vec<&str> = variants.iter().filter_map(|v| v.name).collect();
            let (message, help) = match variant {
                _ if known.is_empty() => {
                    (format!("{shown}: the file has no variants"), "leave out --variant".into())
                }
                Some(name) => {
                    (format!("unknown variant `{name}`"), format!("known: {}", known.join(", ")))
                }
                None => (
                    format!("{shown}: the file has {} variants", known.len()),
                    format!("choose one with --variant: {}", known.join(", ")),
                ),
            };
            return Err(Fault::general(message).help(help).into());
        };
        let mut tree = Table(base.0.iter().filter(|e| e.key != "variant").cloned().collect());
        if let Some(set) = chosen.set {
            tree.overlay(set);
        }
        for set in sets {
            tree.overlay(&parse_set(set)?);
        }
        let variant = chosen.name.map(str::to_owned);
        let name = chosen.name.map_or_else(|| name.clone(), |v| format!("{name}:{v}"));
        Ok(Self { name, variant, tree, source })
    }

    /// The block of this name, as the file has it.
    pub fn block(&self, key: &str) -> Option<&Node> {
        self.tree.get(key)
    }

    /// The flight with these settings laid over it.
    ///
    /// # Errors
    /// Everything that is wrong with them.
    pub fn scenario(&self, sets: &[Table]) -> Result<Scenario, Faults> {
        let mut tree = self.tree.clone();
        let mut faults = Vec::new();
        for set in sets {
            missing_items(&tree, set, "", &mut faults);
            tree.overlay(set);
        }
        Faults(faults).check()?;
        let read = read_scenario(self.name.clone(), &tree, &self.source, &Variant::default());
        let mut scenario = read.map_err(Faults)?;
        scenario.variant.clone_from(&self.variant);
        Ok(scenario)
    }
}
