//! `run`: what is written, and what the exit code says.

use std::fs;
use std::path::Path;

use crate::program::{HOVER, ends, names, point_mass, stormpetrel, text, two_variants};
use tempfile::TempDir;

#[test]
fn run_writes_log_metrics_manifest_and_figures() {
    let folder = TempDir::new().expect("a folder");
    let out = folder.path().join("hover");
    let out = out.to_str().expect("a path");
    ends(&stormpetrel(&[HOVER[0], HOVER[1], HOVER[2], "run.duration=0.5", "--out", out]), 0);
    let expected = [
        "commands.png",
        "commands.svg",
        "disturbance.png",
        "disturbance.svg",
        "errors.png",
        "errors.svg",
        "flight.csv",
        "manifest.json",
        "metrics.json",
        "path.png",
        "path.svg",
        "rotors.png",
        "rotors.svg",
    ];
    assert_eq!(names(Path::new(out)), expected);
    assert_eq!(names(folder.path()), ["hover"], "nothing half-written is left beside it");

    let csv = fs::read_to_string(Path::new(out).join("flight.csv")).expect("a log");
    let header: Vec<_> = csv.lines().next().expect("a header").split(',').collect();
    for name in ["time", "position.x", "attitude.w", "disturbance.lumped.x", "estimate.force.x"] {
        assert!(header.contains(&name), "{name} in {header:?}");
    }
    assert_eq!(csv.lines().count(), 1 + 500);
    assert!(csv.lines().skip(1).all(|row| row.split(',').count() == header.len()));

    let json = |name: &str| -> serde_json::Value {
        let text = fs::read_to_string(Path::new(out).join(name)).expect("a file");
        serde_json::from_str(&text).expect("JSON")
    };
    assert!(json("metrics.json")["position.iae"].is_number());
    let manifest = json("manifest.json");
    assert_eq!(manifest["columns"].as_array().map(Vec::len), Some(header.len()));
    assert_eq!(manifest["resolved"]["run"]["duration"], 0.5);
    assert_eq!(manifest["columns"][1]["unit"], "m");
    assert_eq!(manifest["columns"][1]["frame"], "world");
}

#[test]
fn the_log_is_the_same_bytes_each_time() {
    let folder = TempDir::new().expect("a folder");
    let fly = |name: &str| {
        let out = folder.path().join(name);
        let out = out.to_str().expect("a path");
        let arguments = [
            "run",
            "scenarios/first-flight.toml",
            "--set",
            "run.duration=0.3",
            "--set",
            "run.late=0.1",
            "--set",
            "expect.position.late_max.max=1",
            "--quiet",
            "--out",
            out,
        ];
        // The late maximum of a short flight says nothing; the file is all that matters here.
        ends(&stormpetrel(&arguments), 0);
        fs::read(Path::new(out).join("flight.csv")).expect("a log")
    };
    assert!(fly("a") == fly("b"));
}

#[test]
fn an_unmet_expectation_ends_with_one_and_says_which() {
    let folder = TempDir::new().expect("a folder");
    let out = folder.path().join("out");
    let out = out.to_str().expect("a path");
    let output = stormpetrel(&[
        "run",
        "scenarios/hover.toml",
        "--set",
        "run.duration=0.1",
        "--set",
        "start.offset=0.1",
        "--out",
        out,
    ]);
    ends(&output, 1);
    assert!(text(&output.stderr).contains("hover: expectation failed"));
    assert!(text(&output.stderr).contains("position.max must be at most 0.000000000001"));
    assert!(Path::new(out).join("flight.csv").exists(), "the flight can be looked at");
}

#[test]
fn a_failed_flight_ends_with_one_and_tells_the_cause() {
    let folder = TempDir::new().expect("a folder");
    let out = folder.path().join("out");
    let out = out.to_str().expect("a path");
    let output = stormpetrel(&[
        "run",
        "scenarios/hover.toml",
        "--set",
        "start.offset=[20, 0, 0]",
        "--out",
        out,
    ]);
    ends(&output, 1);
    assert!(text(&output.stderr).contains("failed at 0.000 s: position error beyond its limit"));
}

#[test]
fn a_flight_without_late_samples_has_no_late_maximum() {
    let folder = TempDir::new().expect("a folder");
    let file = two_variants(folder.path(), "expect.position.late_max = { max = 1.0 }");
    let out = folder.path().join("out");
    let output = stormpetrel(&[
        "run",
        file.to_str().expect("a path"),
        "--variant",
        "b",
        "--set",
        "start.offset=[20, 0, 0]",
        "--set",
        "run.late=1.0",
        "--out",
        out.to_str().expect("a path"),
    ]);
    ends(&output, 1);
    assert!(text(&output.stderr).contains("no sample after run.late = 1 s"));
    let metrics = fs::read_to_string(out.join("metrics.json")).expect("metrics");
    assert!(!metrics.contains("late_max"), "{metrics}");
}

#[test]
fn the_figure_of_the_disturbances_shows_what_is_not_zero() {
    let folder = TempDir::new().expect("a folder");
    let out = folder.path().join("out");
    let figure = |blocks: &str| {
        let path = point_mass(folder.path(), blocks);
        let (path, out) = (path.to_str().expect("a path"), out.to_str().expect("a path"));
        ends(&stormpetrel(&["run", path, "--out", out]), 0);
        fs::read_to_string(Path::new(out).join("sources.svg")).ok()
    };
    let pushes =
        "[[disturbance]]\nkind = \"constant\"\nforce = [0.1, 0, 0]\ntorque = [0, 0, 1e-5]\n";
    let svg = figure(pushes).expect("a figure");
    assert!(svg.contains("True force, x axis") && svg.contains("True torque, z axis"));
    assert!(!svg.contains("True force, y axis") && !svg.contains("True torque, x axis"));
    let late = "[[disturbance]]\nkind = \"step\"\nforce = 1.0\nstart = 50.0\n";
    assert!(figure(late).is_none());
}
