//! Arguments and help.

use std::path::PathBuf;

use clap::{Args as Group, Parser, Subcommand};

/// Design, prove and compare quadrotor controllers that hold their line in the wind.
#[derive(Parser)]
#[command(
    name = "stormpetrel",
    version,
    after_help = "Examples:\n  stormpetrel reproduce\n  stormpetrel run scenarios/first-flight.toml\n  stormpetrel explain hosm\n\nExit codes: 0 good; 1 an expectation failed or a flight failed that must not; 2 bad input; 130 interrupted"
)]
pub struct Args {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// How to speak.
    #[command(flatten)]
    pub common: Common,
}

/// Switches of every command.
#[derive(Group)]
pub struct Common {
    /// Print results as JSON on standard output, nothing else
    #[arg(long, global = true)]
    pub json: bool,
    /// Print nothing but errors
    #[arg(long, short, global = true)]
    pub quiet: bool,
}

/// What to do.
#[derive(Subcommand)]
pub enum Command {
    /// Fly the article to the letter and repaired, compare, and write a report with figures
    #[command(
        after_help = "Example:\n  stormpetrel reproduce --out out/article\n\nThen open out/article/report.html in a browser."
    )]
    Reproduce(Reproduce),
    /// Fly a scenario file: log, metrics, manifest and figures
    #[command(
        after_help = "Examples:\n  stormpetrel run scenarios/first-flight.toml\n  stormpetrel run scenarios/first-flight.toml --set observer.law=none --out out/without\n  stormpetrel run scenarios/article/consistent.toml --variant rate-commanded --json"
    )]
    Run(Run),
    /// Fly a scenario many times with drawn inputs: how often does it fail, and what decides?
    #[command(
        after_help = "Examples:\n  stormpetrel sweep scenarios/campaign/robustness.toml\n  stormpetrel sweep FILE --set campaign.flights=100000 --out out/big\n  stormpetrel sweep FILE --out out/big --resume\n  stormpetrel sweep FILE --shard 3/8 --out out/part3\n\nA file says what to vary in [[sweep]] tables:\n  campaign = { flights = 1000 }\n  [[sweep]]\n  path    = \"vehicle.mass\"\n  uniform = [0.5, 0.8]\nor log_uniform = [low, high], normal = [mean, sigma], grid = [low, high, count], list = [...];\nrelative = true multiplies the file's own number."
    )]
    Sweep(Sweep),
    /// Join the parts of a campaign that was flown with --shard
    #[command(
        after_help = "Example:\n  stormpetrel merge FILE out/part1 out/part2 --out out/whole"
    )]
    Merge(Merge),
    /// Read a scenario file and say what is wrong with it and whether its reference can be flown
    #[command(
        after_help = "Example:\n  stormpetrel check scenarios/first-flight.toml --set position.kp=8"
    )]
    Check(Check),
    /// Draw what a scenario asks for, without flying: path, motion, thrust, rotor speeds
    #[command(
        after_help = "Examples:\n  stormpetrel preview scenarios/references/race.toml\n  stormpetrel preview scenarios/references/race.toml --set reference.speed=8 --out out/fast\n\nThen open out/preview/preview.html in a browser."
    )]
    Preview(Preview),
    /// List what a scenario can name: laws, vehicles, references, metrics, shipped files
    #[command(
        after_help = "Examples:\n  stormpetrel list\n  stormpetrel list observer\n  stormpetrel list --json"
    )]
    List(List),
    /// Explain a law or metric: equations, settings with units and defaults, source
    #[command(
        after_help = "Examples:\n  stormpetrel explain hosm\n  stormpetrel explain rate/pid\n  stormpetrel explain article"
    )]
    Explain(Explain),
    /// Print the JSON schema of scenario files, for editors
    #[command(after_help = "Example:\n  stormpetrel schema > scenarios/schema.json")]
    Schema,
}

/// Arguments of `reproduce`.
#[derive(Group)]
pub struct Reproduce {
    /// Folder for report and figures
    #[arg(long, value_name = "DIR", default_value = "out/article")]
    pub out: PathBuf,
}

/// Arguments of `run`.
#[derive(Group)]
pub struct Run {
    /// Scenario file
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Fly this variant only
    #[arg(long, value_name = "NAME")]
    pub variant: Option<String>,
    /// Change a setting: dotted path and value; may be given often
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub sets: Vec<String>,
    /// Folder for the results
    #[arg(long, value_name = "DIR", default_value = "out/run")]
    pub out: PathBuf,
}

/// Which scenario with which changes, of `sweep` and `merge`.
#[derive(Group)]
pub struct Plan {
    /// Scenario file that says what to vary in `[[sweep]]` tables
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Vary this variant of the file
    #[arg(long, value_name = "NAME")]
    pub variant: Option<String>,
    /// Change a setting: dotted path and value; may be given often
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub sets: Vec<String>,
    /// Fly the inputs of this plan.csv instead of drawing them
    #[arg(long = "plan", value_name = "CSV")]
    pub drawn: Option<PathBuf>,
}

/// Arguments of `sweep`.
#[derive(Group)]
pub struct Sweep {
    /// What to fly
    #[command(flatten)]
    pub plan: Plan,
    /// Folder of the campaign
    #[arg(long, value_name = "DIR", default_value = "out/sweep")]
    pub out: PathBuf,
    /// Go on with the campaign in the folder
    #[arg(long)]
    pub resume: bool,
    /// Threads, at most 1024; all cores unless given
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Fly part I of N only, I from 1; `merge` joins the parts
    #[arg(long, value_name = "I/N", conflicts_with_all = ["until_interval", "logs"])]
    pub shard: Option<String>,
    /// Stop once the 95 % interval of the success probability is this narrow; not over grids flown through once
    #[arg(long, value_name = "WIDTH")]
    pub until_interval: Option<f64>,
    /// Fly again with log and figures: worst=K, median, failures=K, every=K, separated by commas
    #[arg(long, value_name = "WHICH", value_delimiter = ',')]
    pub logs: Vec<String>,
}

/// Arguments of `merge`.
#[derive(Group)]
pub struct Merge {
    /// What was flown
    #[command(flatten)]
    pub plan: Plan,
    /// Folders of the parts
    #[arg(value_name = "DIR", required = true)]
    pub parts: Vec<PathBuf>,
    /// Folder of the whole
    #[arg(long, value_name = "DIR", default_value = "out/sweep")]
    pub out: PathBuf,
}

/// Arguments of `check`.
#[derive(Group)]
pub struct Check {
    /// Scenario files
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,
    /// Change a setting: dotted path and value; may be given often
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub sets: Vec<String>,
}

/// Arguments of `preview`.
#[derive(Group)]
pub struct Preview {
    /// Scenario file
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Draw this variant only
    #[arg(long, value_name = "NAME")]
    pub variant: Option<String>,
    /// Change a setting: dotted path and value; may be given often
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub sets: Vec<String>,
    /// Folder for page and figures
    #[arg(long, value_name = "DIR", default_value = "out/preview")]
    pub out: PathBuf,
}

/// Arguments of `list`.
#[derive(Group)]
pub struct List {
    /// Only this kind: position, observer, vehicle, metric, scenarios ...
    #[arg(value_name = "KIND")]
    pub kind: Option<String>,
}

/// Arguments of `explain`.
#[derive(Group)]
pub struct Explain {
    /// A name from `stormpetrel list`; `kind/name` where two kinds share it
    #[arg(value_name = "NAME")]
    pub name: String,
}
