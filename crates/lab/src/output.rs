//! Result files: written beside their place, then renamed, so that none is ever seen half-written.

use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use serde_json::{Map, Value, json};
use tempfile::TempDir;

use crate::fly::Outcome;
use crate::log::columns;
use crate::scenario::Scenario;
use crate::sensitivity::Spread;

/// Version of the program.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
/// Revision of the source, or `unknown` outside a checkout.
pub const REVISION: &str = env!("STORMPETREL_REVISION");

/// A result folder in the making.
#[derive(Debug)]
pub struct Folder {
    target: PathBuf,
    staging: TempDir,
}

impl Folder {
    /// Begins a folder; nothing appears at `target` before [`Folder::publish`].
    ///
    /// # Errors
    /// Where the folder above cannot be made or written.
    pub fn new(target: &Path) -> io::Result<Self> {
        let parent = match target.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
            _ => PathBuf::from("."),
        };
        if target.exists() && !target.is_dir() {
            return Err(io::Error::other("exists and is not a folder"));
        }
        fs::create_dir_all(&parent)?;
        let staging = tempfile::Builder::new().prefix(".stormpetrel-").tempdir_in(&parent)?;
        Ok(Self { target: target.to_owned(), staging })
    }

    /// Where the files stand until they are published.
    pub fn staging(&self) -> &Path {
        self.staging.path()
    }

    /// A new file; folders in its name are made.
    ///
    /// # Errors
    /// Where it cannot be made.
    pub fn create(&self, name: &str) -> io::Result<BufWriter<fs::File>> {
        let path = self.staging.path().join(name);
        if let Some(parent) = path.parent() {
            fs::create_dir_all(parent)?;
        }
        Ok(BufWriter::with_capacity(1 << 16, fs::File::create(path)?))
    }

    /// A new file with this content.
    ///
    /// # Errors
    /// Where it cannot be written.
    pub fn write(&self, name: &str, content: &[u8]) -> io::Result<()> {
        let mut file = self.create(name)?;
        file.write_all(content)?;
        file.flush()
    }

    /// Moves every file to its place, replacing those of the same name.
    ///
    /// # Errors
    /// Where a file cannot be moved.
    pub fn publish(self) -> io::Result<()> {
        if self.target.exists() {
            return move_into(self.staging.path(), &self.target);
        }
        // A whole new folder appears in one stroke.
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            fs::set_permissions(self.staging.path(), fs::Permissions::from_mode(0o755))?;
        }
        fs::rename(self.staging.path(), &self.target)
    }
}

fn move_into(from: &Path, to: &Path) -> io::Result<()> {
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let target = to.join(entry.file_name());
        if entry.file_type()?.is_dir() && target.is_dir() {
            move_into(&entry.path(), &target)?;
        } else {
            fs::rename(entry.path(), target)?;
        }
    }
    Ok(())
}

/// `metrics.json`: flat keys; a sensitive flight has median and range in place of numbers.
pub fn metrics_json(outcome: &Outcome, spread: Option<&Spread>) -> Value {
    let mut all = Map::new();
    all.insert("sensitive".into(), json!(spread.is_some()));
    all.insert("failed".into(), json!(outcome.failure.is_some()));
    if let Some(failure) = outcome.failure {
        all.insert("failure.time".into(), json!(failure.time));
        all.insert("failure.cause".into(), json!(failure.cause.describe()));
    }
    for (name, value) in &outcome.metrics {
        match spread.and_then(|spread| spread.range(name)) {
            None => {
                all.insert(name.clone(), json!(value));
            }
            Some(range) => {
                all.insert(format!("{name}.median"), json!(range.median));
                all.insert(format!("{name}.min"), json!(range.min));
                all.insert(format!("{name}.max"), json!(range.max));
            }
        }
    }
    Value::Object(all)
}

/// `manifest.json`: everything needed to fly it again and to read the log.
pub fn manifest_json(scenario: &Scenario) -> Value {
    let columns: Vec<_> = columns()
        .into_iter()
        .map(|c| json!({ "name": c.name, "unit": c.unit, "frame": c.frame, "meaning": c.doc }))
        .collect();
    json!({
        "program": "stormpetrel",
        "version": VERSION,
        "revision": REVISION,
        "scenario": scenario.name,
        "seed": scenario.run.seed,
        "frames": "world ENU (z up), body FLU (x forward, y left, z up), quaternion w x y z body to world, SI units",
        "resolved": scenario.resolved(),
        "columns": columns,
    })
}
