//! The control laws on a microcontroller, in an emulator: the bits of recorded flights.

use std::path::PathBuf;
use std::process::Command;

use crate::run::{Step, install, target_dir};

/// Cortex-M4F and M7, without an operating system.
pub const BARE: &str = "thumbv7em-none-eabihf";

const EMULATOR: &str = "qemu-system-arm";

/// Cargo on the workspace of the firmware; `rest` follows the options that say which that is.
fn cargo(title: &str, command: &str, rest: &[&str]) -> Step {
    let folder = folder();
    let folder = folder.to_string_lossy();
    let which =
        ["--manifest-path", "firmware/Cargo.toml", "--target", BARE, "--target-dir", &folder];
    Step::cargo(title, &[&[command], which.as_slice(), rest].concat())
}

/// Programs of other profiles and other dependencies: a folder of their own.
fn folder() -> PathBuf {
    target_dir().join("firmware")
}

/// Where a program of the firmware is once built.
fn program(profile: &str, name: &str) -> PathBuf {
    folder().join(BARE).join(profile).join(name)
}

/// Formatting and clippy of the firmware, which no other workspace sees.
pub fn lint() -> Result<(), String> {
    install(BARE)?;
    let format = ["fmt", "--manifest-path", "firmware/Cargo.toml", "--check"];
    Step::cargo("formatting, firmware", &format).run()?;
    cargo("lints, firmware", "clippy", &["--lib", "--bins", "--", "-D", "warnings"]).run()
}

/// Every recorded flight gives the same bits on the microcontroller, in double and in single precision.
pub fn replay() -> Result<(), String> {
    install(BARE)?;
    emulator()?;
    let recorder = ["--release", "-p", "stormpetrel-portable", "--bin", "record"];
    Step::cargo("recorder", &[&["build"], recorder.as_slice()].concat()).run()?;
    let folder = target_dir().join("recordings");
    let folder = folder.to_string_lossy();
    let record = [&["run"], recorder.as_slice(), &["--", &folder]].concat();
    let written = Step::cargo("recordings", &record).output()?;
    for recording in written.lines() {
        let name = recording.rsplit(['/', '\\']).next().unwrap_or(recording);
        let title = format!("firmware with the flight {name}");
        let build = cargo(&title, "build", &["--release", "--bin", "replay"]);
        build.env("STORMPETREL_RECORDING", recording).run()?;
        run(name)?;
    }
    Ok(())
}

/// One emulated flight; its exit code says whether all bits are the same.
fn run(name: &str) -> Result<(), String> {
    let program = program("release", "replay");
    let program = program.to_string_lossy();
    let semihosting = "enable=on,target=native";
    let arguments =
        ["-M", "mps2-an386", "-nographic", "-semihosting-config", semihosting, "-kernel", &program];
    Step::new(&format!("{name} on a Cortex-M4F"), EMULATOR, &arguments).within(120).run()
}

/// Builds programs of the firmware without debug code, whole; gives their files.
pub fn bare<const N: usize>(names: [&str; N]) -> Result<[PathBuf; N], String> {
    install(BARE)?;
    let bins: Vec<&str> = names.iter().flat_map(|name| ["--bin", name]).collect();
    let title = format!("firmware: {}", names.join(", "));
    cargo(&title, "build", &[&["--profile", "bare"], bins.as_slice()].concat()).run()?;
    Ok(names.map(|name| program("bare", name)))
}

fn starts(program: &str) -> bool {
    Command::new(program).arg("--version").output().is_ok_and(|output| output.status.success())
}

/// Installs the emulator where it is missing and the machine lets us.
fn emulator() -> Result<(), String> {
    if starts(EMULATOR) {
        return Ok(());
    }
    let user = Step::new("user", "id", &["-u"]).output().unwrap_or_default();
    let installed = user.trim() == "0" && starts("apt-get") && {
        let package = ["install", "--yes", "--no-install-recommends", EMULATOR];
        Step::new("package lists", "apt-get", &["update"]).run()?;
        let install = Step::new("emulator", "apt-get", &package);
        install.env("DEBIAN_FRONTEND", "noninteractive").run()?;
        starts(EMULATOR)
    };
    if installed {
        return Ok(());
    }
    Err(format!(
        "{EMULATOR} is missing and cannot be installed from here. Install it, then run the task again: \
         `sudo apt-get install {EMULATOR}` on Debian and Ubuntu, `brew install qemu` on macOS"
    ))
}
