//! Prints the hashes of all shipped flights; fails where lanes give others than single flights. Runs
//! natively and, compiled for `wasm32-wasip1`, under Node.

use std::io::Write as _;
use std::process::ExitCode;

use stormpetrel_plant::dispatch::Width;
use stormpetrel_portable::experiment::{alone, changed, flights, side_by_side, text};

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("experiment-hash: {message}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), String> {
    let flights = flights()?;
    let single = text(&alone(&flights));
    for width in Width::available() {
        if let Some(found) = changed(&single, &side_by_side(&flights, width)) {
            return Err(format!("side by side at {}: {found}", width.name()));
        }
        eprintln!("side by side, {}: the bits of single flights", width.name());
    }
    std::io::stdout().write_all(single.as_bytes()).map_err(|error| error.to_string())
}
