//! `preview`: draw, do not fly.

use serde_json::{Map, json};
use stormpetrel_lab::feasible::{Feasibility, feasible};
use stormpetrel_lab::figures::Drawing;
use stormpetrel_lab::fly::on_all_cores;
use stormpetrel_lab::output::{Folder, manifest_json};
use stormpetrel_lab::preview::{drawings, html};
use stormpetrel_lab::scenario::{Scenario, load};

use crate::args::{Common, Preview};
use crate::check::{judgement, print};
use crate::run::{begin, choose, draw, prefix};
use crate::{Failure, terminal};

/// Draws every variant of the file, or the chosen one.
pub fn preview(args: &Preview, common: &Common) -> Result<(), Failure> {
    let file = load(&args.file, &args.sets)?;
    let title = format!("Preview: {}", file.title);
    let scenarios = choose(file, args.variant.as_deref())?;
    let broken = |error| Failure::out(&args.out, &error);
    let folder = begin(&args.out, &scenarios).map_err(broken)?;
    let judged = on_all_cores(&scenarios, feasible);
    let drawn = on_all_cores(&scenarios, drawings);
    write(&folder, &title, &scenarios, &judged, drawn).map_err(broken)?;
    folder.publish().map_err(broken)?;
    if common.json {
        let flights = scenarios.iter().zip(&judged);
        let all: Map<_, _> =
            flights.map(|(s, judged)| (s.name.clone(), judgement(judged))).collect();
        return terminal::print_json(&json!(all));
    }
    if !common.quiet {
        print(&scenarios, &judged);
        terminal::say(&format!("written to {}", args.out.join("preview.html").display()));
    }
    Ok(())
}

fn write(
    folder: &Folder,
    title: &str,
    scenarios: &[Scenario],
    judged: &[Feasibility],
    drawn: Vec<Vec<Drawing>>,
) -> std::io::Result<()> {
    let mut flights = Vec::new();
    for ((scenario, judged), drawings) in scenarios.iter().zip(judged).zip(drawn) {
        let prefix = prefix(scenario, scenarios.len() == 1);
        let manifest = format!("{:#}\n", manifest_json(scenario));
        folder.write(&format!("{prefix}manifest.json"), manifest.as_bytes())?;
        draw(folder, &prefix, &drawings)?;
        flights.push((scenario, judged, drawings));
    }
    folder.write("preview.html", html(title, &flights).as_bytes())
}
