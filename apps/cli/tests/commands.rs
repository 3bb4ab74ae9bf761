//! The commands as a user runs them: what they print, what they write, how they end.
// Tests compare bits, take the standard library as their second opinion, and print figures as their
// source prints them.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::approx_constant, clippy::float_cmp)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn stormpetrel(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_stormpetrel"))
        .args(arguments)
        .current_dir(root())
        .output()
        .expect("the program starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

fn ends(output: &Output, code: i32) {
    assert_eq!(
        output.status.code(),
        Some(code),
        "{}{}",
        text(&output.stdout),
        text(&output.stderr)
    );
}

/// Names of everything in a folder.
fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> = fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

const HOVER: [&str; 3] = ["run", "scenarios/hover.toml", "--set"];

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
fn bad_input_ends_with_two_and_writes_nothing() {
    let folder = TempDir::new().expect("a folder");
    let out = folder.path().join("out");
    let out = out.to_str().expect("a path");
    for set in [
        "position.kp=-1",
        "position.kpp=1",
        "observer.law=homs",
        "no-equals-sign",
        "run.duration=inf",
    ] {
        ends(&stormpetrel(&[HOVER[0], HOVER[1], HOVER[2], set, "--out", out]), 2);
    }
    ends(&stormpetrel(&["run", "no-such-file.toml", "--out", out]), 2);
    ends(&stormpetrel(&["run", "scenarios", "--out", out]), 2);
    ends(
        &stormpetrel(&[
            "run",
            "scenarios/article/consistent.toml",
            "--variant",
            "nobody",
            "--out",
            out,
        ]),
        2,
    );
    ends(&stormpetrel(&["fly"]), 2);
    assert_eq!(names(folder.path()), [""; 0]);
}

#[test]
fn a_folder_that_cannot_be_written_is_named() {
    let folder = TempDir::new().expect("a folder");
    let file = folder.path().join("file");
    fs::write(&file, "mine").expect("a file");
    let output =
        stormpetrel(&["run", "scenarios/hover.toml", "--out", file.to_str().expect("a path")]);
    ends(&output, 2);
    assert!(text(&output.stderr).contains("exists and is not a folder"));
    let below = file.join("out");
    ends(
        &stormpetrel(&["run", "scenarios/hover.toml", "--out", below.to_str().expect("a path")]),
        2,
    );
    assert_eq!(fs::read_to_string(&file).expect("a file"), "mine");
}

#[test]
fn strange_files_are_refused_without_a_crash() {
    let folder = TempDir::new().expect("a folder");
    let path = folder.path().join("strange.toml");
    let shown = path.to_str().expect("a path");
    let deep = format!("a = {}{}", "[".repeat(5000), "]".repeat(5000));
    for content in
        [vec![0xFF, 0xFE, 0x00], deep.into_bytes(), b"\x00".to_vec(), vec![b'#'; 2 << 20]]
    {
        fs::write(&path, content).expect("a file");
        let output = stormpetrel(&["check", shown]);
        ends(&output, 2);
        assert!(text(&output.stderr).starts_with("error: "), "{}", text(&output.stderr));
    }
}

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

/// A scenario file with two variants of which the second may have an expectation that is not met.
fn two_variants(folder: &Path, expect: &str) -> PathBuf {
    let hover = fs::read_to_string(root().join("scenarios/hover.toml")).expect("a file");
    let path = folder.join("two.toml");
    let head = hover.split("[expect]").next().expect("a head");
    let variants = format!("[[variant]]\nname = \"a\"\n[[variant]]\nname = \"b\"\n{expect}\n");
    fs::write(&path, format!("{head}\n{variants}")).expect("a file");
    path
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

#[cfg(unix)]
mod streams {
    use std::process::Stdio;

    use super::*;

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
}

#[test]
fn faults_are_json_where_json_is_asked_for() {
    let output =
        stormpetrel(&["check", "scenarios/hover.toml", "--set", "position.kpp=1", "--json"]);
    ends(&output, 2);
    let all: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let fault = &all["faults"][0];
    assert_eq!(fault["message"], "unknown field `position.kpp`");
    assert_eq!((&fault["file"], &fault["line"]), (&"--set".into(), &1.into()));
    assert_eq!(fault["column"], 10);
    assert!(fault["help"].as_str().expect("help").starts_with("did you mean `kp`?"));
    let output = stormpetrel(&["explain", "homs", "--json"]);
    ends(&output, 2);
    let all: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(all["faults"][0]["message"], "nothing is called `homs`");
}

#[test]
fn a_setting_that_does_not_fit_is_explained() {
    for (set, expected) in [
        ("start.offset=[1, 2", "unclosed array"),
        ("variant.0.name=\"x\"", "`variant` cannot be set"),
        ("disturbance.1.force=3", "there is no disturbance at all"),
        ("position.kp=0,6", "write a point in numbers: 0.6"),
        ("position.kp=0x10", "0x10: write the number in decimal"),
        ("run.substeps=1000", "integration steps"),
        ("run.duration=9000", "the log would have 9.0e6 rows"),
    ] {
        let mut flags = vec!["check", "scenarios/hover.toml", "--set", set];
        if set == "run.substeps=1000" {
            flags.extend(["--set", "run.duration=1e4"]);
        }
        let output = stormpetrel(&flags);
        ends(&output, 2);
        let message = text(&output.stderr);
        assert!(message.contains(expected), "{set}: {message}");
    }
}

#[test]
fn what_is_no_scenario_file_is_named() {
    let folder = TempDir::new().expect("a folder");
    let path = folder.path().join("file.toml");
    let check = || text(&stormpetrel(&["check", path.to_str().expect("a path")]).stderr);
    fs::write(&path, b"title = \"a\"\nabout = \"\xE4\"").expect("a file");
    assert!(check().contains("byte 21, in line 2, is not UTF-8"), "{}", check());
    fs::write(&path, b"\xFF\xFEt\0").expect("a file");
    assert!(check().contains("the file is UTF-16: save it as UTF-8"), "{}", check());
    fs::write(&path, "#".repeat(2 << 20)).expect("a file");
    assert!(check().contains("too long for a scenario"), "{}", check());
    fs::remove_file(&path).expect("removed");
    fs::create_dir(&path).expect("a folder");
    assert!(check().contains("is a folder"), "{}", check());
    let zeros = stormpetrel(&["check", "/dev/zero"]);
    ends(&zeros, 2);
}

/// A point mass that hovers for a short time, with these blocks after the others.
fn point_mass(folder: &Path, blocks: &str) -> PathBuf {
    let path = folder.join("mass.toml");
    let flight = "title = \"a mass\"
run = { duration = 0.2 }
vehicle = { model = \"article-corrected\" }
reference = { shape = \"hover\" }
position = { law = \"pid\" }
actuation = { kind = \"wrench\" }
attitude_reference = { law = \"rotation\" }
attitude = { law = \"tilt-priority\" }
rate = { law = \"indi\" }
";
    fs::write(&path, format!("{flight}{blocks}")).expect("a file");
    path
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

#[test]
fn a_file_has_at_most_a_thousand_variants() {
    let folder = TempDir::new().expect("a folder");
    let more: String = (2..=1001).map(|i| format!("[[variant]]\nname = \"v{i}\"\n")).collect();
    let file = two_variants(folder.path(), &more);
    let output = stormpetrel(&["check", file.to_str().expect("a path")]);
    ends(&output, 2);
    assert!(text(&output.stderr).contains("1002 variants: a file has at most 1000"));
}
