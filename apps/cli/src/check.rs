//! `check`: read, judge, do not fly.

use serde_json::json;
use stormpetrel_lab::scenario::fault::Faults;
use stormpetrel_lab::scenario::{load, too_long};

use crate::args::{Check, Common};
use crate::{Failure, terminal};

/// Reads every file; all faults of all files are printed.
pub fn check(args: &Check, common: &Common) -> Result<(), Failure> {
    let mut faults = Vec::new();
    let mut good = Vec::new();
    for path in &args.files {
        let file = load(path, &args.sets);
        match file.and_then(|file| Faults::from_iter(too_long(&file.scenarios)).check().map(|()| file)) {
            Ok(file) => good.push(json!({
                "file": path.display().to_string(),
                "title": file.title,
                "flights": file.scenarios.iter().map(|s| s.name.clone()).collect::<Vec<_>>(),
                "resolved": file.scenarios.iter().map(stormpetrel_lab::scenario::Scenario::resolved).collect::<Vec<_>>(),
            })),
            Err(found) => faults.extend(found.0),
        }
    }
    Faults(faults).check()?;
    if common.json {
        return terminal::print_json(&json!(good));
    }
    if !common.quiet {
        for file in good {
            let flights = file["flights"].as_array().map_or(0, Vec::len);
            let name = file["file"].as_str().unwrap_or_default();
            let plural = if flights == 1 { "flight" } else { "flights" };
            terminal::say(&format!("{name}: good, {flights} {plural}"));
        }
    }
    Ok(())
}
