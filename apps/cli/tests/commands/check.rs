//! `check` and `preview`.

use std::fs;

use crate::program::{ends, names, point_mass, stormpetrel, text, two_variants};
use tempfile::TempDir;

#[test]
fn check_reads_every_shipped_file() {
    let output = stormpetrel(&["check", "scenarios/hover.toml", "scenarios/article/literal.toml"]);
    ends(&output, 0);
    assert!(text(&output.stdout).contains("scenarios/article/literal.toml: good, 17 flights"));
}

#[test]
fn check_warns_of_a_reference_that_cannot_be_flown_and_says_when() {
    let circle = "scenarios/references/circle.toml";
    let good = stormpetrel(&["check", circle]);
    ends(&good, 0);
    assert_eq!(text(&good.stderr), "");
    let shown = text(&good.stdout);
    assert!(
        shown.contains("tilt (rad)") && shown.contains("rotor speed, least (rad/s)"),
        "{shown}"
    );
    assert!(shown.lines().all(|line| line.chars().count() <= 60), "{shown}");

    let fast = ["check", circle, "--set", "reference.speed=14"];
    let bad = stormpetrel(&fast);
    ends(&bad, 0);
    let warning = text(&bad.stderr);
    assert_eq!(
        warning.lines().collect::<Vec<_>>(),
        [
            "warning: references/circle: the reference cannot be flown:",
            "  - thrust 61.6 N at 3.01 s, limit 24.5: beyond by 37.0 N; from 1.66 to 20.00 s",
            "  - rotor thrust 15.4 N at 2.82 s, limit 6.13: beyond by 9.30 N; from 1.65 to 20.00 s",
            "  - rotor speed 4629 rad/s at 2.82 s, limit 2917: beyond by 1712 rad/s; from 1.65 to 20.00 s",
        ]
    );
    let quiet = stormpetrel(&[&fast[..], &["--quiet"]].concat());
    assert_eq!(text(&quiet.stdout) + &text(&quiet.stderr), "");

    let json = stormpetrel(&[&fast[..], &["--json"]].concat());
    ends(&json, 0);
    let all: serde_json::Value = serde_json::from_slice(&json.stdout).expect("JSON");
    let judged = &all[0]["feasibility"][0];
    assert_eq!(judged["feasible"], false);
    let quantities = judged["quantities"].as_array().expect("a list");
    let speed = quantities.iter().find(|q| q["name"] == "rotor speed").expect("a rotor speed");
    assert_eq!(speed["limit"], 2917.0);
    assert_eq!(speed["beyond"][0][1], 20.0);
}

#[test]
fn check_shows_once_what_all_variants_need_and_how_well_a_table_is_fitted() {
    let shown = text(&stormpetrel(&["check", "scenarios/article/rotors.toml"]).stdout);
    assert!(shown.contains("article/rotors:pid and 11 more"), "{shown}");
    assert_eq!(shown.matches("the reference needs").count(), 1);
    let shown = text(&stormpetrel(&["check", "scenarios/references/table.toml"]).stdout);
    assert!(shown.contains("fit: within 0.00") && shown.contains("polynomials"), "{shown}");
}

#[test]
fn preview_draws_without_flying() {
    let folder = TempDir::new().expect("a folder");
    let out = folder.path().join("race");
    let file = "scenarios/references/race.toml";
    let output = stormpetrel(&["preview", file, "--out", out.to_str().expect("a path")]);
    ends(&output, 0);
    let figures = ["demand", "motion", "path", "rotors"]
        .iter()
        .flat_map(|name| [format!("preview-{name}.png"), format!("preview-{name}.svg")]);
    let expected: Vec<String> = ["manifest.json".to_owned()]
        .into_iter()
        .chain(figures)
        .chain(["preview.html".to_owned()])
        .collect();
    assert_eq!(names(&out), expected);
    // What a preview wrote, a flight takes away; what somebody else put there stays.
    fs::write(out.join("notes.txt"), "mine").expect("a file");
    let shown = out.to_str().expect("a path");
    let flight = ["run", "scenarios/hover.toml", "--set", "run.duration=0.1", "--out", shown];
    stormpetrel(&flight);
    let left = names(&out);
    assert!(left.contains(&"notes.txt".to_owned()) && left.contains(&"flight.csv".to_owned()));
    assert!(!left.iter().any(|name| name.starts_with("preview")), "{left:?}");
}

#[test]
fn a_preview_draws_the_variant_that_is_asked_for() {
    let folder = TempDir::new().expect("a folder");
    let out = folder.path().to_str().expect("a path");
    let file = "scenarios/article/rotors.toml";
    let output = stormpetrel(&["preview", file, "--variant", "pid", "--json", "--out", out]);
    ends(&output, 0);
    assert!(names(folder.path()).contains(&"preview.html".to_owned()));
    let all: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(all["article/rotors:pid"]["feasible"], true);
    let output = stormpetrel(&["preview", file, "--variant", "pod", "--out", out]);
    ends(&output, 2);
}

#[test]
fn a_colon_in_the_path_leads_nowhere_else() {
    let folder = TempDir::new().expect("a folder");
    let odd = folder.path().join("x:..");
    fs::create_dir(&odd).expect("a folder");
    let file = two_variants(&odd, "");
    let out = folder.path().join("out");
    let flags = ["--set", "run.duration=0.05", "--quiet", "--out", out.to_str().expect("a path")];
    let file = file.to_str().expect("a path");
    ends(&stormpetrel(&[&["run", file][..], &flags].concat()), 0);
    assert_eq!(names(&out), ["a", "b", "manifest.json"]);
    assert_eq!(names(folder.path()), ["out", "x:.."]);
    ends(&stormpetrel(&[&["run", file, "--variant", "b"][..], &flags].concat()), 0);
    assert!(!names(&out).contains(&"a".to_owned()), "flights of the last run are gone");
}

#[test]
fn check_notes_a_disturbance_that_never_acts() {
    let folder = TempDir::new().expect("a folder");
    let step = "[[disturbance]]\nkind = \"step\"\nforce = 1.0\nstart = 50.0\n";
    let path = point_mass(folder.path(), step);
    let output = stormpetrel(&["check", path.to_str().expect("a path")]);
    ends(&output, 0);
    let note =
        "note: `disturbance.0` (step) never acts: it starts at 50 s, the flight ends at 0.2 s";
    assert_eq!(text(&output.stdout).matches(note).count(), 1, "{}", text(&output.stdout));
}
