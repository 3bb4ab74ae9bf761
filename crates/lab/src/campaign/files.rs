//! The files of a campaign, each written beside its place and renamed.

use std::io::{self, BufWriter, Write};
use std::path::Path;

use serde_json::{Value as Json, json};

use super::disk::{Disk, Sink, own_file, replace};
use super::drive::{JOURNAL, rows};
use super::journal::{self, CHUNK, Index, row};
use super::parquet::{Writer, scratch_size};
use super::plan::Campaign;
use super::report::{Story, html};
use super::result::{Columns, Row};
use super::summary::Summary;
use crate::output::{REVISION, VERSION, advise, refuse, with_help};

/// What the campaign is: written first, compared before it is resumed.
pub const CAMPAIGN: &str = "campaign.json";
/// Index, seed and inputs of every flight, written before the first one.
pub const PLAN: &str = "plan.csv";
/// One row for each flight.
pub const RESULTS: &str = "results.parquet";
/// Numbers that sum up all flights.
pub const SUMMARY: &str = "summary.json";
/// The page for a reader.
pub const REPORT: &str = "report.html";
/// Worst flights that are kept for the report.
pub const WORST: usize = 10;

/// What to do where a campaign cannot begin.
const BEGIN: &str = "mend that, or give another --out";
/// What to do where its results cannot be written.
const CONCLUDE: &str =
    "what is flown is kept: mend that, and the same command goes on (`sweep` with --resume)";

/// `campaign.json`.
pub fn about(campaign: &Campaign) -> Json {
    json!({
        "program": "stormpetrel",
        "version": VERSION,
        "revision": REVISION,
        "campaign": campaign.identity(),
    })
}

/// Writes [`CAMPAIGN`] and [`PLAN`].
///
/// # Errors
/// Where they cannot be written.
pub fn begin(disk: &dyn Disk, folder: &Path, campaign: &Campaign) -> io::Result<()> {
    replace(disk, &folder.join(PLAN), BEGIN, |file| {
        let mut out = BufWriter::with_capacity(1 << 16, Pass(file));
        let names: Vec<String> = campaign.columns().inputs.iter().map(|n| cell(n)).collect();
        writeln!(out, "index,seed,{}", names.join(","))?;
        for index in 0..campaign.flights() {
            let inputs = campaign.inputs(index);
            let cells: Vec<String> = inputs.iter().map(|input| cell(&input.to_string())).collect();
            writeln!(out, "{index},{},{}", campaign.seed(index), cells.join(","))?;
        }
        out.flush()
    })?;
    let text = format!("{:#}\n", about(campaign));
    // Last: a folder with this file has its plan.
    replace(disk, &folder.join(CAMPAIGN), BEGIN, |file| file.write_all(text.as_bytes()))
}

/// A cell of a CSV file, in quotes where it needs them.
fn cell(text: &str) -> String {
    if text.contains([',', '"', '\n']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

/// The campaign of a folder, beside one that is asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Held {
    /// There is none.
    Nothing,
    /// This one.
    This,
    /// This one, begun by another version of the program, which may fly it to other bits.
    OfVersion(String),
    /// Another one.
    Another,
}

/// What the folder holds.
///
/// # Errors
/// Where its description cannot be read, or where it has results of which nothing says whose they are.
pub fn holds(folder: &Path, campaign: &Campaign) -> io::Result<Held> {
    let path = folder.join(CAMPAIGN);
    // The journal says for itself whose it is.
    let flown = folder.join(JOURNAL).exists();
    let text = match own_file(&path).and_then(io::read_to_string) {
        Ok(text) => text,
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            return if flown { Ok(Held::Nothing) } else { unclaimed(folder) };
        }
        Err(error) if error.kind() == io::ErrorKind::NotADirectory => {
            return Err(advise(folder, &error));
        }
        Err(error) => return Err(with_help(&path, &error, BEGIN)),
    };
    let help = if flown {
        "remove it and give the same command, without --resume: what is flown is kept"
    } else {
        "restore it from a copy, or give another --out"
    };
    let found: Json =
        serde_json::from_str(&text).map_err(|error| refuse(&path, &error.to_string(), help))?;
    if !found["campaign"].is_object() {
        return Err(refuse(&path, "does not describe a campaign", help));
    }
    let ours = about(campaign);
    Ok(if found["campaign"] != ours["campaign"] {
        Held::Another
    } else if found["version"] == ours["version"] && found["revision"] == ours["revision"] {
        Held::This
    } else {
        let word = |key: &str| found[key].as_str().unwrap_or("?").to_owned();
        Held::OfVersion(format!("{} ({})", word("version"), word("revision")))
    })
}

/// Refuses results without a description: they would be written over.
fn unclaimed(folder: &Path) -> io::Result<Held> {
    for name in [RESULTS, SUMMARY, REPORT] {
        let path = folder.join(name);
        if path.symlink_metadata().is_ok() {
            let message = format!("is there already, and no {CAMPAIGN} says whose it is");
            return Err(refuse(&path, &message, "give another --out, or remove it"));
        }
    }
    Ok(Held::Nothing)
}

/// Bytes that the files of so many flights take: those that stay, and the most while they are written.
pub fn size(flights: u64, columns: &Columns) -> (u64, u64) {
    let (inputs, metrics) = (columns.inputs.len() as u64, columns.metrics.len() as u64);
    let results = flights * 8 * (4 + inputs + metrics);
    // Index and seed have up to 24 digits with their commas, a drawn number 20.
    let plan = flights * (24 + 20 * inputs);
    let stay = journal::size(flights, metrics) + results + plan;
    (stay, stay + scratch_size(flights, columns))
}

/// Whether the parts have every flight of the plan.
///
/// # Errors
/// Which flights are missing.
pub fn complete(campaign: &Campaign, parts: &[Index]) -> io::Result<()> {
    let chunks = 0..campaign.flights().div_ceil(CHUNK);
    let mut missing = chunks.filter(|chunk| !parts.iter().any(|part| part.has(*chunk)));
    missing.next().map_or(Ok(()), |chunk| Err(absent(campaign, chunk)))
}

fn absent(campaign: &Campaign, chunk: u64) -> io::Error {
    let rows = rows(campaign, chunk);
    io::Error::other(format!("flights {} to {} are missing", rows.start, rows.end - 1))
}

/// Shows the first `flights` rows of the plan in order, from the journals of its parts.
///
/// # Errors
/// Where a journal cannot be read or a flight is missing.
pub fn each_row(
    campaign: &Campaign,
    parts: &[Index],
    flights: u64,
    see: &mut dyn FnMut(&Row) -> io::Result<()>,
) -> io::Result<()> {
    for chunk in 0..flights.div_ceil(CHUNK) {
        let mut found = None;
        for part in parts {
            found = part.chunk(chunk)?;
            if found.is_some() {
                break;
            }
        }
        let rows = rows(campaign, chunk);
        let Some(entries) = found.filter(|all| all.len() as u64 == rows.end - rows.start) else {
            return Err(absent(campaign, chunk));
        };
        for (index, entry) in rows.zip(entries) {
            see(&row(index, campaign.seed(index), campaign.inputs(index), entry))?;
        }
    }
    Ok(())
}

/// Writes [`RESULTS`] and [`SUMMARY`]; returns what was learnt.
///
/// # Errors
/// As [`each_row`], and where a file cannot be written.
pub fn finish(
    disk: &dyn Disk,
    folder: &Path,
    campaign: &Campaign,
    parts: &[Index],
    flights: u64,
) -> io::Result<Summary> {
    let mut summary = Summary::new(&campaign.columns(), WORST);
    replace(disk, &folder.join(RESULTS), CONCLUDE, |file| {
        let about = [("campaign".to_owned(), campaign.identity().to_string())];
        let scratch = disk.scratch(folder)?;
        let mut writer = Writer::new(Pass(file), scratch, &campaign.columns(), &about);
        each_row(campaign, parts, flights, &mut |row| {
            summary.push(row);
            writer.push(row)
        })?;
        writer.finish().map(|_| ())
    })?;
    let text = format!("{:#}\n", summary_json(campaign, &summary));
    replace(disk, &folder.join(SUMMARY), CONCLUDE, |file| file.write_all(text.as_bytes()))?;
    Ok(summary)
}

/// Writes [`REPORT`]; `command` makes the command that flies a flight with these settings again, `again`
/// is the one that flies the whole campaign.
///
/// # Errors
/// Where it cannot be written.
pub fn report(
    disk: &dyn Disk,
    folder: &Path,
    campaign: &Campaign,
    summary: &Summary,
    command: &dyn Fn(&[String]) -> String,
    again: &str,
) -> io::Result<()> {
    let refly = |row: &Row| (row.clone(), command(&campaign.sets(&row.inputs, row.seed)));
    let worst: Vec<(Row, String)> = summary.worst().iter().map(refly).collect();
    let median = summary
        .median()
        .map(|row| command(&campaign.sets(&campaign.inputs(row.index), campaign.seed(row.index))));
    let page = html(&Story {
        title: &campaign.scenario.title,
        about: &campaign.scenario.about,
        scenario: campaign.name(),
        inputs: &campaign.describe(),
        units: &campaign.units(),
        summary,
        median: median.as_deref(),
        worst: &worst,
        command: again,
    });
    replace(disk, &folder.join(REPORT), CONCLUDE, |file| file.write_all(page.as_bytes()))
}

/// `summary.json`.
pub fn summary_json(campaign: &Campaign, summary: &Summary) -> Json {
    let (share, interval) = summary.success();
    let failures: serde_json::Map<String, Json> = summary
        .failures()
        .into_iter()
        .map(|(cause, count)| (cause.describe().to_owned(), json!(count)))
        .collect();
    let correlations: Vec<Json> = summary
        .correlations()
        .iter()
        .map(|c| json!({ "input": c.input, "with": c.with, "rank": c.rank, "flights": c.flights }))
        .collect();
    let worst: Vec<Json> = summary
        .worst()
        .iter()
        .map(|row| json!({ "index": row.index, "set": campaign.sets(&row.inputs, row.seed) }))
        .collect();
    json!({
        "scenario": campaign.name(),
        "flights": summary.flights(),
        "flown": summary.flown(),
        "success": { "share": share, "low": interval.low, "high": interval.high },
        "failures": failures,
        "rank_correlations": correlations,
        "worst": worst,
    })
}

/// A file lent to a writer that wants to own one.
struct Pass<'a>(&'a mut dyn Sink);

impl Write for Pass<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.write(bytes)
    }
    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}
