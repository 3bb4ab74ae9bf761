//! Results: the folder that they are put into, and what stands in them.

mod folder;
mod own;
mod refused;

use serde_json::{Map, Value, json};

use crate::fly::Outcome;
use crate::log::columns;
use crate::scenario::Scenario;
use crate::sensitivity::Spread;

pub use folder::{Folder, Halt, halt};
pub use refused::{Refused, advise};
pub(crate) use refused::{is_refused, refuse, with_help};

/// Version of the program.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
/// Name of the program in manifests.
const PROGRAM: &str = "stormpetrel";
/// Revision of the source, or `unknown` outside a checkout.
pub const REVISION: &str = env!("STORMPETREL_REVISION");

/// `metrics.json`: flat keys; a sensitive flight has median and range in place of numbers, and how many of
/// its starts failed. A number that is not finite is `null`.
pub fn metrics_json(outcome: &Outcome, spread: Option<&Spread>) -> Value {
    let mut all = Map::new();
    all.insert("sensitive".into(), json!(spread.is_some()));
    let beside = spread.is_some_and(|spread| spread.failures() > 0);
    all.insert("failed".into(), json!(outcome.failure.is_some() || beside));
    if let Some(failure) = outcome.failure {
        all.insert("failure.time".into(), json!(failure.time));
        all.insert("failure.cause".into(), json!(failure.cause.describe()));
    }
    if let Some(spread) = spread {
        all.insert("starts".into(), json!(spread.outcomes.len()));
        all.insert("starts.failed".into(), json!(spread.failures()));
    }
    for (name, value) in &outcome.metrics {
        match spread.and_then(|spread| spread.range(name)) {
            None => {
                all.insert((*name).to_owned(), json!(value));
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

/// `manifest.json` of a folder with a folder for each variant.
pub fn variants_json(variants: &[&str]) -> Value {
    json!({ "program": PROGRAM, "version": VERSION, "revision": REVISION, "variants": variants })
}

/// `manifest.json`: everything needed to fly it again and to read the log.
pub fn manifest_json(scenario: &Scenario) -> Value {
    let columns: Vec<_> = columns(scenario)
        .into_iter()
        .map(|c| json!({ "name": c.name, "unit": c.unit, "frame": c.frame, "meaning": c.doc }))
        .collect();
    json!({
        "program": PROGRAM,
        "version": VERSION,
        "revision": REVISION,
        "scenario": scenario.name,
        "seed": scenario.run.seed,
        "frames": "world ENU (z up), body FLU (x forward, y left, z up), quaternion w x y z body to world, SI units",
        "resolved": scenario.resolved(),
        "columns": columns,
    })
}
