//! Input that cannot be used.

use std::fs;

use crate::program::{HOVER, ends, names, stormpetrel, text, two_variants};
use tempfile::TempDir;

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

#[test]
fn a_file_has_at_most_a_thousand_variants() {
    let folder = TempDir::new().expect("a folder");
    let more: String = (2..=1001).map(|i| format!("[[variant]]\nname = \"v{i}\"\n")).collect();
    let file = two_variants(folder.path(), &more);
    let output = stormpetrel(&["check", file.to_str().expect("a path")]);
    ends(&output, 2);
    assert!(text(&output.stderr).contains("1002 variants: a file has at most 1000"));
}
