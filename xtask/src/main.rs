//! The task runner: `cargo xtask test` is everything that must hold before a change lands.

mod bench;
mod portable;
mod run;
mod schema;

use std::process::ExitCode;

use run::Step;

const HELP: &str = "\
cargo xtask <task>

  test       everything below but bench: what the gate runs
  lint       formatting, clippy, documentation, all without warnings
  unit       tests of all crates in debug and release
  schema     is scenarios/schema.json what the program prints? (`schema --write` renews it)
  targets    control and plant build for microcontroller and browser, without std
  hash       do native, lanes and WASM give the bits in scenarios/experiment.hash? (`hash --write`)
  bench      measure and write docs/benchmarks.md
";

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let args: Vec<&str> = args.iter().map(String::as_str).collect();
    let done = match args.as_slice() {
        ["test"] => test(),
        ["lint"] => lint(),
        ["unit"] => unit(),
        ["targets"] => portable::targets(),
        ["hash"] => portable::hash(),
        ["hash", "--write"] => portable::write_hash(),
        ["bench"] => bench::bench(),
        ["schema"] => schema::check(),
        ["schema", "--write"] => schema::write(),
        _ => {
            eprint!("{HELP}");
            return ExitCode::from(2);
        }
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("xtask: {message}");
            ExitCode::FAILURE
        }
    }
}

fn test() -> Result<(), String> {
    lint()?;
    schema::check()?;
    unit()?;
    portable::targets()?;
    portable::hash()
}

fn lint() -> Result<(), String> {
    Step::cargo("formatting", &["fmt", "--all", "--check"]).run()?;
    Step::cargo("lints", &["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"])
        .run()?;
    Step::cargo("documentation", &["doc", "--workspace", "--no-deps"])
        .env("RUSTDOCFLAGS", "-D warnings")
        .run()
}

fn unit() -> Result<(), String> {
    Step::cargo("tests, debug", &["test", "--workspace"]).run()?;
    Step::cargo("tests, release", &["test", "--workspace", "--release"]).run()
}
