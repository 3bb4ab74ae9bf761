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
    let (seconds, megabytes) = measured(&["reproduce", "--quiet"], "bench-report")?;
    let campaigns = campaigns()?;
    let compiler = Step::new("compiler", "rustc", &["--version"]).output()?;
    let text = format!(
        "# Benchmarks\n\nMade by `cargo xtask bench`: the ordinary release build, the best of at least five runs.\n\n\
         Machine: {}, {} processors. Compiler: {}.\n\n{}\n\n\
         ## Whole commands\n\nThe whole `reproduce` with report and figures: {seconds:.1} s, {megabytes:.0} MB at most.\n\n{campaigns}",
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

/// Time and memory of campaigns from one flight to a million, 1 s of flight each.
fn campaigns() -> Result<String, String> {
    let mut text = "Campaigns of the scenario `campaign/robustness`, 1 s of flight each, all metrics, results written; the median of \
                    five, of a million one:\n\n\
                    | flights | s | us a flight | MB at most |\n|---|---|---|---|\n"
        .to_owned();
    for flights in [1u32, 100, 10_000, 100_000, 1_000_000] {
        let set = format!("campaign.flights={flights}");
        let file = "scenarios/campaign/robustness.toml";
        let arguments = [
            "sweep",
            file,
            "--quiet",
            "--set",
            "run.duration=1",
            "--set",
            "run.late=0.5",
            "--set",
            &set,
        ];
        let (mut times, mut peaks) = (Vec::new(), Vec::new());
        for _ in 0..if flights < 1_000_000 { 5 } else { 1 } {
            let (time, peak) = measured(&arguments, "bench-campaign")?;
            times.push(time);
            peaks.push(peak);
        }
        let (seconds, megabytes) = (median(times), median(peaks));
        let each = 1e6 * seconds / f64::from(flights);
        text += &format!("| {flights} | {seconds:.2} | {each:.1} | {megabytes:.1} |\n");
    }
    Ok(text)
}

/// The number in the middle, NaN where there is none.
fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_unstable_by(f64::total_cmp);
    numbers.get(numbers.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Wall time (s) and largest resident size (MB) of the program with these arguments.
fn measured(arguments: &[&str], out: &str) -> Result<(f64, f64), String> {
    let target = target_dir();
    let folder = target.join(out);
    // A folder of an earlier run must not count as begun.
    let _ = fs::remove_dir_all(&folder);
    let begin = Instant::now();
    let mut child = Command::new(target.join("release/stormpetrel"))
        .args(arguments)
        .arg("--out")
        .arg(&folder)
        .current_dir(root())
        .stdout(Stdio::null())
        .spawn()
        .map_err(|e| format!("stormpetrel: {e}"))?;
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
    let done = child.wait().map_err(|e| format!("stormpetrel: {e}"))?;
    if !done.success() {
        return Err(format!("stormpetrel {} failed: {done}", arguments.join(" ")));
    }
    let seconds = begin.elapsed().as_secs_f64();
    let _ = fs::remove_dir_all(&folder);
    Ok((seconds, peak / 1e3))
}
