//! The same bits everywhere: bare-metal and browser builds, and the hash of the experiment.

use std::fs;
use std::path::PathBuf;

use crate::firmware::BARE;
use crate::run::{Step, install, root, target_dir};

const BROWSER: &str = "wasm32-unknown-unknown";
const WASI: &str = "wasm32-wasip1";

/// Laws and plant build without the standard library, for a microcontroller and for a browser.
pub fn targets() -> Result<(), String> {
    for target in [BARE, BROWSER] {
        install(target)?;
        let title = format!("control and plant for {target}");
        let laws = [
            "build",
            "--release",
            "-p",
            "stormpetrel-control",
            "-p",
            "stormpetrel-plant",
            "--target",
            target,
        ];
        Step::cargo(&title, &laws).run()?;
    }
    Ok(())
}

fn file() -> PathBuf {
    root().join("scenarios/experiment.hash")
}

fn native() -> Result<String, String> {
    let run = ["run", "--release", "-p", "stormpetrel-portable", "--bin", "experiment-hash"];
    Step::cargo("hash of the experiment, native, single and in lanes", &run).output()
}

fn wasm() -> Result<String, String> {
    install(WASI)?;
    let build = [
        "build",
        "--release",
        "-p",
        "stormpetrel-portable",
        "--bin",
        "experiment-hash",
        "--target",
        WASI,
    ];
    Step::cargo("hash of the experiment for WASM", &build).run()?;
    let program = target_dir().join(WASI).join("release/experiment-hash.wasm");
    let program = program.to_string_lossy();
    Step::new(
        "hash of the experiment in WASM",
        "node",
        &["--no-warnings", "crates/portable/wasi.mjs", &program],
    )
    .output()
}

/// Native and WASM give the hash in the repository.
pub fn hash() -> Result<(), String> {
    let expected = fs::read_to_string(file()).unwrap_or_default();
    for (name, found) in [("native", native()?), ("WASM", wasm()?)] {
        if found != expected {
            return Err(format!(
                "{name}: the hash of the experiment is not the one in scenarios/experiment.hash:\n{found}\n\
                 After a wanted change of results run `cargo xtask hash --write` and say why in the CHANGELOG."
            ));
        }
        eprintln!(
            "== hash of the experiment, {name}: {}",
            found.lines().next().unwrap_or_default()
        );
    }
    Ok(())
}

/// Renews the hash in the repository.
pub fn write_hash() -> Result<(), String> {
    fs::write(file(), native()?).map_err(|e| format!("{}: {e}", file().display()))
}
