//! Is the shipped JSON schema what the program prints?

use std::fs;

use crate::run::root;

fn current() -> String {
    format!("{:#}\n", stormpetrel_lab::scenario::schema())
}

/// Fails where `scenarios/schema.json` is stale.
pub fn check() -> Result<(), String> {
    let path = root().join("scenarios/schema.json");
    let shipped = fs::read_to_string(&path).unwrap_or_default();
    if shipped == current() {
        return Ok(());
    }
    Err("scenarios/schema.json is stale: run `cargo xtask schema --write`".into())
}

/// Renews `scenarios/schema.json`.
pub fn write() -> Result<(), String> {
    let path = root().join("scenarios/schema.json");
    fs::write(&path, current()).map_err(|e| format!("{}: {e}", path.display()))
}
