//! `reproduce`: the article, literal and corrected.

use std::collections::BTreeMap;
use std::time::Instant;

use serde_json::{Map, json};
use stormpetrel_lab::figures::{self, Drawing};
use stormpetrel_lab::fly::on_all_cores;
use stormpetrel_lab::output::{Folder, metrics_json};
use stormpetrel_lab::plot::png;
use stormpetrel_lab::reproduce::{Flown, HEADLINES, Story, html, reproduce as fly_all, tables};

use crate::args::{Common, Reproduce};
use crate::run::print_unmet;
use crate::{Failure, terminal};

/// Flies everything, prints the tables, writes the report.
pub fn reproduce(args: &Reproduce, common: &Common) -> Result<(), Failure> {
    let begin = Instant::now();
    let broken = |error| Failure::out(&args.out, &error);
    let folder = Folder::with_parts(&args.out, &["figures"]).map_err(broken)?;
    let bar = terminal::progress("flying the article", common.quiet || common.json);
    let story = fly_all(|total| {
        bar.set_length(total as u64);
        bar.inc(1);
    })?;
    bar.finish_and_clear();
    write(&folder, &story).map_err(broken)?;
    folder.publish().map_err(broken)?;
    if common.json {
        let mut all = Map::new();
        for flown in story.flights() {
            all.insert(
                flown.scenario.name.clone(),
                metrics_json(&flown.outcome, flown.spread.as_ref()),
            );
        }
        terminal::print_json(&json!(all))?;
    } else if !common.quiet {
        let width = terminal::width();
        for table in tables(&story) {
            terminal::print_table(&table, width);
        }
        terminal::say(&format!(
            "\n{} flights; report and figures in {} ({:.1} s)",
            story.flights().count(),
            args.out.join("report.html").display(),
            begin.elapsed().as_secs_f64()
        ));
    }
    if print_unmet(story.flights(), common.json || common.quiet) {
        Err(Failure::Unmet)
    } else {
        Ok(())
    }
}

/// Draws every flight, on all cores, and writes page and figures.
fn write(folder: &Folder, story: &Story) -> std::io::Result<()> {
    let flights: Vec<&Flown> = story.flights().collect();
    let drawn = on_all_cores(&flights, |flown| draw(flown));
    let mut by_name: BTreeMap<&str, Vec<Drawing>> = BTreeMap::new();
    for (flown, pictures) in flights.iter().zip(drawn) {
        let file = flown.scenario.name.replace([':', '/'], "-");
        let mut drawings = Vec::new();
        for (drawing, image) in pictures {
            folder.write(&format!("figures/{file}-{}.png", drawing.name), &image?)?;
            folder
                .write(&format!("figures/{file}-{}.svg", drawing.name), drawing.svg.as_bytes())?;
            drawings.push(drawing);
        }
        by_name.insert(&flown.scenario.name, drawings);
    }
    let page =
        html(story, |flown| by_name.get(flown.scenario.name.as_str()).cloned().unwrap_or_default());
    folder.write("report.html", page.as_bytes())
}

/// All figures of a headline flight, the errors of every other.
fn draw(flown: &Flown) -> Vec<(Drawing, std::io::Result<Vec<u8>>)> {
    let headline = HEADLINES.iter().any(|(name, _)| *name == flown.scenario.name);
    let drawings = if headline {
        figures::all(&flown.scenario, &flown.trace)
    } else {
        vec![figures::errors(&flown.scenario.title, &flown.trace, flown.scenario.has_attitude())]
    };
    drawings
        .into_iter()
        .map(|drawing| {
            let image = png(&drawing.svg, 1.0).map_err(std::io::Error::other);
            (drawing, image)
        })
        .collect()
}
