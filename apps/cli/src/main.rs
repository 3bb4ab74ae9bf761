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
mod terminal;

use std::process::ExitCode;

use clap::Parser;

use args::{Args, Command};

/// What went wrong, for the exit code.
pub enum Failure {
    /// An expectation or a flight failed; everything is printed already.
    Unmet,
    /// Bad input or a file that cannot be used: the message.
    Input(String),
}

impl Failure {
    /// A file or folder that cannot be used.
    pub fn file(path: &std::path::Path, error: &std::io::Error) -> Self {
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
        Command::Check(check) => check::check(check, &args.common),
        Command::List(list) => list::list(list, &args.common),
        Command::Explain(explain) => explain::explain(explain, &args.common),
        Command::Schema => terminal::print_json(&stormpetrel_lab::scenario::schema()),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure::Unmet) => ExitCode::from(1),
        Err(Failure::Input(message)) => {
            anstream::eprintln!("{message}");
            ExitCode::from(2)
        }
    }
}
