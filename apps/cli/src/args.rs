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
    /// Read a scenario file and say what is wrong with it, without flying
    #[command(
        after_help = "Example:\n  stormpetrel check scenarios/first-flight.toml --set position.kp=8"
    )]
    Check(Check),
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
