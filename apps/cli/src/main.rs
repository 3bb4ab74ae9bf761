//! The command line of Stormpetrel.
//!
//! Exit codes: 0 good; 1 an expectation failed, or a flight failed that must not; 2 bad input or a
//! file that cannot be read or written; 130 interrupted.

mod args;
mod check;
mod explain;
mod list;
mod reproduce;
mod run;
mod sweep;
mod terminal;

use std::process::ExitCode;

use clap::Parser;

use args::{Args, Command};
use stormpetrel_lab::output::Refused;
use stormpetrel_lab::scenario::fault::Faults;

/// What went wrong, for the exit code.
pub enum Failure {
    /// An expectation or a flight failed; everything is printed already.
    Unmet,
    /// Bad input or a file that cannot be used: the message.
    Input(String),
    /// Interrupted in an orderly way; what to do is printed already.
    Interrupted,
}

impl Failure {
    /// A file or folder that cannot be used.
    pub fn file(path: &std::path::Path, error: &std::io::Error) -> Self {
        if error.kind() == std::io::ErrorKind::Interrupted {
            return Self::Interrupted;
        }
        if error.get_ref().is_some_and(|inner| inner.is::<Refused>()) {
            return Self::Input(format!("error: {error}"));
        }
        Self::Input(format!("error: {}: {error}", path.display()))
    }
}

impl From<stormpetrel_lab::scenario::fault::Faults> for Failure {
    fn from(faults: stormpetrel_lab::scenario::fault::Faults) -> Self {
        Self::Input(faults.to_string())
    }
}

fn main() -> ExitCode {
    let args = Args::parse();
    if ctrlc::set_handler(terminal::interrupted).is_err() {
        anstream::eprintln!("warning: an interrupt may leave a `.stormpetrel-` folder behind");
    }
    let done = match &args.command {
        Command::Reproduce(reproduce) => reproduce::reproduce(reproduce, &args.common),
        Command::Run(run) => run::run(run, &args.common),
        Command::Sweep(sweep) => sweep::sweep(sweep, &args.common),
        Command::Merge(merge) => sweep::merge(merge, &args.common),
        Command::Check(check) => check::check(check, &args.common),
        Command::List(list) => list::list(list, &args.common),
        Command::Explain(explain) => explain::explain(explain, &args.common),
        Command::Schema => terminal::print_json(&stormpetrel_lab::scenario::schema()),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure::Unmet) => ExitCode::from(1),
        Err(Failure::Interrupted) => ExitCode::from(130),
        Err(Failure::Input(message)) => {
            anstream::eprintln!("{message}");
            ExitCode::from(2)
        }
    }
}
