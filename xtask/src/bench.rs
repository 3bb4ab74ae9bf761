//! `docs/benchmarks.md`, measured in one run on one machine.

use std::fs;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::run::{Step, root, target_dir};

/// Measures and writes the tables.
pub fn bench() -> Result<(), String> {
    Step::cargo("program", &["build", "--release", "-p", "stormpetrel"]).run()?;
    let tables = Step::cargo("benchmark", &["bench", "-p", "stormpetrel-lab", "--bench", "speed"])
        .output()?;
    let (seconds, megabytes) = reproduce()?;
    let compiler = Step::new("compiler", "rustc", &["--version"]).output()?;
    let text = format!(
        "# Benchmarks\n\nMade by `cargo xtask bench`: the ordinary release build, best of five runs.\n\n\
         Machine: {}, {} processors. Compiler: {}.\n\n{}\n\
         The whole `reproduce` with report and figures: {seconds:.1} s, {megabytes:.0} MB at most.\n",
        processor(),
        std::thread::available_parallelism().map_or(1, usize::from),
        compiler.trim(),
        tables.trim()
    );
    let path = root().join("docs/benchmarks.md");
    fs::write(&path, text).map_err(|e| format!("{}: {e}", path.display()))
}

fn processor() -> String {
    let info = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let line = |key: &str| {
        let found = info.lines().find(|line| line.starts_with(key));
        found
            .and_then(|line| line.split_once(':'))
            .map_or("unknown", |(_, value)| value.trim())
            .to_owned()
    };
    format!("{} (model {}, stepping {})", line("model name"), line("model\t"), line("stepping"))
}

/// Wall time (s) and largest resident size (MB) of `stormpetrel reproduce`.
fn reproduce() -> Result<(f64, f64), String> {
    let target = target_dir();
    let mut child = Command::new(target.join("release/stormpetrel"))
        .args(["reproduce", "--quiet", "--out"])
        .arg(target.join("bench-report"))
        .stdout(Stdio::null())
        .spawn()
        .map_err(|e| format!("stormpetrel: {e}"))?;
    let begin = Instant::now();
    let status = format!("/proc/{}/status", child.id());
    let mut peak = 0.0;
    while child.try_wait().map_err(|e| format!("stormpetrel: {e}"))?.is_none() {
        let text = fs::read_to_string(&status).unwrap_or_default();
        let high = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kilobytes =
            high.and_then(|v| v.split_whitespace().next()).and_then(|v| v.parse::<f64>().ok());
        peak = kilobytes.unwrap_or(peak);
        std::thread::sleep(Duration::from_millis(2));
    }
    Ok((begin.elapsed().as_secs_f64(), peak / 1e3))
}
