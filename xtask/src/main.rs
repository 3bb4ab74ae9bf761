//! The task runner: `cargo xtask test` is everything that must hold before a change lands.

mod bench;
mod binary;
mod code;
mod disassembly;
mod firmware;
mod portable;
mod run;
mod schema;
mod symbols;

use std::process::ExitCode;

use run::Step;

const HELP: &str = "\
cargo xtask <task>

  test         everything below but bench: what the gate runs
  lint         formatting, clippy, documentation, all without warnings
  unit         tests of all crates in debug and release
  schema       is scenarios/schema.json what the program prints? (`schema --write` renews it)
  disassembly  is the loop over several vehicles one function for each register width, nothing fused?
  targets      control and plant build for microcontroller and browser, without std
  firmware     do recorded flights give the same bits on a Cortex-M4F? (in QEMU)
  symbols      is the control stack on a microcontroller free of panics and heap?
  hash         do native, lanes and WASM give the bits in scenarios/experiment.hash? (`hash --write`)
  bench        measure and write docs/benchmarks.md
  abuse        campaigns killed, starved and damaged: the figures of docs/reliability.md
  soak         a day of simulated hover in turbulence: the figures of docs/reliability.md
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
        ["disassembly"] => disassembly::check(),
        ["firmware"] => firmware::replay(),
        ["symbols"] => symbols::check(),
        ["bench"] => bench::bench(),
        ["abuse"] => abuse(),
        ["soak"] => soak(),
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
    disassembly::check()?;
    portable::targets()?;
    firmware::replay()?;
    symbols::check()?;
    portable::hash()
}

/// The tests that take too long for every change.
fn abuse() -> Result<(), String> {
    let arguments = [
        "test",
        "--release",
        "-p",
        "stormpetrel-lab",
        "-p",
        "stormpetrel",
        "--test",
        "campaign",
        "--",
        "--ignored",
        "--nocapture",
    ];
    Step::cargo("campaigns under abuse", &arguments).run()
}

/// A day of simulated hover.
fn soak() -> Result<(), String> {
    let arguments = [
        "test",
        "--release",
        "-p",
        "stormpetrel-lab",
        "--test",
        "soak",
        "--",
        "--ignored",
        "--nocapture",
    ];
    Step::cargo("a day in the wind", &arguments).run()
}

fn lint() -> Result<(), String> {
    Step::cargo("formatting", &["fmt", "--all", "--check"]).run()?;
    Step::cargo("lints", &["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"])
        .run()?;
    Step::cargo("documentation", &["doc", "--workspace", "--no-deps"])
        .env("RUSTDOCFLAGS", "-D warnings")
        .run()?;
    firmware::lint()
}

fn unit() -> Result<(), String> {
    Step::cargo("tests, debug", &["test", "--workspace"]).run()?;
    Step::cargo("tests, release", &["test", "--workspace", "--release"]).run()
}
