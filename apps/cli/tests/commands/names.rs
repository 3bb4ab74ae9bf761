//! Names, helps and what is printed.

use crate::program::{HOVER, ends, point_mass, stormpetrel, text};
use tempfile::TempDir;

#[test]
fn list_and_explain_know_everything_that_a_file_can_name() {
    let output = stormpetrel(&["list", "--json"]);
    ends(&output, 0);
    let all: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let all = all.as_array().expect("a list");
    assert!(all.len() > 40);
    for entry in all.iter().filter(|entry| entry["kind"] != "scenarios") {
        let name = format!(
            "{}/{}",
            entry["kind"].as_str().expect("a kind"),
            entry["name"].as_str().expect("a name")
        );
        assert!(entry["summary"].as_str().is_some_and(|s| !s.is_empty()), "{name}");
        ends(&stormpetrel(&["explain", &name]), 0);
    }
    let hosm = text(&stormpetrel(&["explain", "hosm"]).stdout);
    for part in ["lambda2 L^(1/3)", "Levant", "lipschitz = 1.5 [m/s^3]", "\"doubled\""] {
        assert!(hosm.contains(part), "{part} in {hosm}");
    }
    assert!(text(&stormpetrel(&["explain", "article"]).stdout).contains("3 (ccw)"));
    assert!(text(&stormpetrel(&["explain", "position.iae"]).stdout).contains("sum |e| dt"));
    ends(&stormpetrel(&["explain", "homs"]), 2);
    ends(&stormpetrel(&["list", "lawz"]), 2);
}

#[test]
fn every_help_shows_an_example() {
    for command in ["reproduce", "run", "check", "preview", "list", "explain", "schema"] {
        let output = stormpetrel(&[command, "--help"]);
        ends(&output, 0);
        let help = text(&output.stdout);
        assert!(
            help.contains("Example") && help.contains(&format!("stormpetrel {command}")),
            "{help}"
        );
    }
}

#[test]
fn quiet_is_quiet_and_json_is_json() {
    let folder = TempDir::new().expect("a folder");
    let out = folder.path().join("out");
    let out = out.to_str().expect("a path");
    let quiet =
        stormpetrel(&[HOVER[0], HOVER[1], HOVER[2], "run.duration=0.1", "--quiet", "--out", out]);
    ends(&quiet, 0);
    assert!(quiet.stdout.is_empty() && quiet.stderr.is_empty());
    let json =
        stormpetrel(&[HOVER[0], HOVER[1], HOVER[2], "run.duration=0.1", "--json", "--out", out]);
    ends(&json, 0);
    let all: serde_json::Value = serde_json::from_slice(&json.stdout).expect("JSON");
    assert!(all["hover"]["position.iae"].is_number(), "{all}");
}

#[test]
fn variants_without_a_title_can_be_told_apart() {
    let folder = TempDir::new().expect("a folder");
    let variants = "[[variant]]\nname = \"a\"\n[[variant]]\nname = \"b\"\ntitle = \"other\"\n";
    let path = point_mass(folder.path(), variants);
    let output = stormpetrel(&["check", "--json", path.to_str().expect("a path")]);
    let all: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(all[0]["resolved"][0]["title"], "a mass (a)");
    assert_eq!(all[0]["resolved"][1]["title"], "other");
}

#[test]
fn each_kind_is_listed_once_and_names_are_found_in_any_case() {
    let list = text(&stormpetrel(&["list"]).stdout);
    assert_eq!(list.lines().filter(|line| *line == "block").count(), 1, "{list}");
    ends(&stormpetrel(&["list", "Observer"]), 0);
    ends(&stormpetrel(&["explain", "HOSM"]), 0);
    let message = |arguments: &[&str]| text(&stormpetrel(arguments).stderr);
    assert!(message(&["list", "Obsrver"]).contains("did you mean `observer`?"));
    assert!(message(&["explain", "Homs"]).contains("did you mean: observer/hosm"));
    assert!(message(&["explain", "observer"]).contains("give one of its names: none, hosm"));
}
