//! The command line of Stormpetrel.
//!
//! Exit codes: 0 good; 1 an expectation failed, or a flight failed that must not; 2 bad input or a
//! file that cannot be read or written, standard output included; 130 interrupted.

mod args;
mod check;
mod explain;
mod list;
mod preview;
mod reproduce;
mod run;
mod sweep;
mod terminal;

use std::io::IsTerminal;
use std::process::ExitCode;

use clap::Parser;
use serde_json::{Value, json};
use stormpetrel_lab::output::{Refused, advise};
use stormpetrel_lab::scenario::fault::{Fault, Faults};

use args::{Args, Command};

/// What went wrong, for the exit code.
pub enum Failure {
    /// An expectation or a flight failed; everything is printed already.
    Unmet,
    /// Bad input or a file that cannot be used: the message.
    Input(String),
    /// Faults of scenario files.
    Faults(Faults),
    /// Interrupted in an orderly way; what to do is printed already.
    Interrupted,
}

impl Failure {
    /// A result folder that cannot be used, with what to do.
    pub fn out(path: &std::path::Path, error: &std::io::Error) -> Self {
        if error.kind() == std::io::ErrorKind::Interrupted {
            return Self::Interrupted;
        }
        if let Some(faults) = error.get_ref().and_then(|inner| inner.downcast_ref::<Faults>()) {
            return Self::Faults(faults.clone());
        }
        Self::file(path, &advise(path, error))
    }

    /// A file or folder that cannot be used.
    pub fn file(path: &std::path::Path, error: &std::io::Error) -> Self {
        if error.kind() == std::io::ErrorKind::Interrupted {
            return Self::Interrupted;
        }
        if error.get_ref().is_some_and(<dyn std::error::Error + Send + Sync>::is::<Refused>) {
            return Self::Input(format!("error: {error}"));
        }
        Self::Input(format!("error: {}: {error}", path.display()))
    }
}

impl From<Faults> for Failure {
    fn from(faults: Faults) -> Self {
        Self::Faults(faults)
    }
}

fn main() -> ExitCode {
    let args = Args::parse();
    if ctrlc::set_handler(terminal::interrupted).is_err() {
        terminal::warn("warning: an interrupt may leave a `.stormpetrel-` folder behind");
    }
    let done = match &args.command {
        Command::Reproduce(reproduce) => reproduce::reproduce(reproduce, &args.common),
        Command::Run(run) => run::run(run, &args.common),
        Command::Sweep(sweep) => sweep::sweep(sweep, &args.common),
        Command::Merge(merge) => sweep::merge(merge, &args.common),
        Command::Check(check) => check::check(check, &args.common),
        Command::Preview(preview) => preview::preview(preview, &args.common),
        Command::List(list) => list::list(list, &args.common),
        Command::Explain(explain) => explain::explain(explain, &args.common),
        Command::Schema => terminal::print_json(&stormpetrel_lab::scenario::schema()),
    };
    let code = match done {
        Ok(()) => 0,
        Err(Failure::Unmet) => 1,
        Err(Failure::Interrupted) => 130,
        Err(failure) => {
            refused(&failure, args.common.json);
            2
        }
    };
    // What was not said must not look like success.
    match terminal::lost() {
        Some(error) => {
            terminal::warn(&format!("error: standard output: {error}"));
            ExitCode::from(2)
        }
        None => ExitCode::from(code),
    }
}

/// Says what is wrong with the input, to a person or to a program.
fn refused(failure: &Failure, json: bool) {
    let text = match failure {
        Failure::Faults(faults) if json => return terminal::say_json(&faults_json(faults)),
        Failure::Faults(faults) => faults.to_string(),
        Failure::Input(message) if json => {
            let message = message.trim_start_matches("error: ");
            let (message, help) = match message.split_once("\n  = help: ") {
                Some((message, help)) => (message, Some(help)),
                None => (message, None),
            };
            let fault = Fault::general(message);
            let fault = Fault { help: help.map(str::to_owned), ..fault };
            return terminal::say_json(&faults_json(&fault.into()));
        }
        Failure::Input(message) => message.clone(),
        Failure::Unmet | Failure::Interrupted => return,
    };
    // Only people want lines that end.
    let person = std::io::stderr().is_terminal();
    terminal::warn(&if person { terminal::fold(&text, terminal::width()) } else { text });
}

/// `{"faults": [...]}`: what is wrong, where, and what to do.
fn faults_json(faults: &Faults) -> Value {
    let one = |fault: &Fault| {
        let (line, column) = fault.position().unzip();
        let file = fault.place.as_ref().map(|place| place.source.name.as_str());
        let (message, help) = (&fault.message, &fault.help);
        json!({ "message": message, "file": file, "line": line, "column": column, "help": help })
    };
    json!({ "faults": faults.0.iter().map(one).collect::<Vec<_>>() })
}
