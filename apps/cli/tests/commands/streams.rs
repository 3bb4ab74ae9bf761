//! Streams that are closed or full.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use tempfile::TempDir;

use crate::program::{ends, names, root, text};

fn unmet(folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stormpetrel"));
    command.current_dir(root()).args(["run", "scenarios/hover.toml", "--set"]);
    command.args(["run.duration=0.05", "--set", "start.offset=0.1", "--out"]);
    command.arg(folder.join("out"));
    command
}

fn full() -> Stdio {
    fs::OpenOptions::new().write(true).open("/dev/full").expect("a full device").into()
}

#[test]
fn a_reader_that_leaves_does_not_change_the_verdict() {
    let folder = TempDir::new().expect("a folder");
    let mut child = unmet(folder.path()).stdout(Stdio::piped()).spawn().expect("started");
    drop(child.stdout.take());
    assert_eq!(child.wait().expect("an end").code(), Some(1));
}

#[test]
#[cfg(target_os = "linux")]
fn what_cannot_be_said_is_an_error_and_no_panic() {
    let folder = TempDir::new().expect("a folder");
    let output = unmet(folder.path()).stdout(full()).output().expect("an end");
    ends(&output, 2);
    assert!(text(&output.stderr).contains("error: standard output: "));
    let output = unmet(folder.path()).stderr(full()).output().expect("an end");
    ends(&output, 1);
}

#[test]
fn an_interrupted_flight_leaves_the_old_results_and_nothing_else() {
    let folder = TempDir::new().expect("a folder");
    let out = folder.path().join("out");
    fs::create_dir(&out).expect("a folder");
    fs::write(out.join("flight.csv"), "old").expect("a file");
    let mut command = Command::new(env!("CARGO_BIN_EXE_stormpetrel"));
    command.current_dir(root()).args(["run", "scenarios/hover.toml", "--out"]).arg(&out);
    let more = ["run.duration=5000", "--set", "run.log_every=100000"];
    let mut child = command.arg("--set").args(more).spawn().expect("started");
    while names(folder.path()).len() < 2 {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let interrupt = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(interrupt.expect("sent").success());
    assert_eq!(child.wait().expect("an end").code(), Some(130));
    assert_eq!(names(folder.path()), ["out"]);
    assert_eq!(names(&out), ["flight.csv"]);
}
