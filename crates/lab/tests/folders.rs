//! Result folders: what appears, what disappears, what stays.
// Tests compare bits, take the standard library as their second opinion, and print figures as their
// source prints them.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::approx_constant, clippy::float_cmp)]

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::path::Path;
use std::time::{Duration, SystemTime};

use stormpetrel_lab::output::Folder;
use tempfile::TempDir;

const MANIFEST: &[u8] = br#"{ "program": "stormpetrel" }"#;

fn put(path: &Path, text: &str) {
    fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
    fs::write(path, text).expect("a file");
}

/// Every file below a folder with its content; folders have none.
fn tree(folder: &Path) -> BTreeMap<String, String> {
    let mut all = BTreeMap::new();
    for entry in fs::read_dir(folder).expect("a folder") {
        let entry = entry.expect("an entry");
        let name = entry.file_name().to_string_lossy().into_owned();
        if entry.file_type().expect("a kind").is_dir() {
            let below = tree(&entry.path());
            if below.is_empty() {
                all.insert(format!("{name}/"), String::new());
            }
            all.extend(below.into_iter().map(|(file, text)| (format!("{name}/{file}"), text)));
        } else {
            let text = fs::read_to_string(entry.path()).unwrap_or_else(|_| "?".into());
            all.insert(name, text);
        }
    }
    all
}

fn files(folder: &Path) -> Vec<String> {
    tree(folder).into_keys().collect()
}

fn write(target: &Path, names: &[&str]) {
    let folder = Folder::new(target).expect("a folder");
    for name in names {
        let content = if name.ends_with("manifest.json") { MANIFEST } else { b"new" };
        folder.write(name, content).expect("a file");
    }
    folder.publish().expect("published");
}

#[test]
fn a_new_folder_appears_with_those_above_it_and_not_before() {
    let bench = TempDir::new().expect("a folder");
    let target = bench.path().join("a/b");
    let folder = Folder::new(&target).expect("a folder");
    folder.write("flight.csv", b"1").expect("a file");
    assert!(!target.exists());
    folder.publish().expect("published");
    assert_eq!(files(bench.path()), ["a/b/flight.csv"]);
}

#[test]
fn a_folder_that_is_not_published_leaves_nothing() {
    let bench = TempDir::new().expect("a folder");
    let folder = Folder::new(&bench.path().join("a/b")).expect("a folder");
    folder.write("deep/flight.csv", b"1").expect("a file");
    drop(folder);
    assert_eq!(files(bench.path()), [""; 0]);
}

/// Old results with files of others among them.
fn old(target: &Path) {
    let manifest = r#"{ "program": "stormpetrel", "variants": ["letter", "noted"] }"#;
    put(&target.join("manifest.json"), manifest);
    put(&target.join("other/manifest.json"), manifest);
    put(&target.join("flight.csv"), "old");
    put(&target.join("rotors.svg"), "old");
    put(&target.join("notes.txt"), "mine");
    put(&target.join("mine/flight.csv"), "mine");
    fs::create_dir(target.join("empty")).expect("a folder");
    put(&target.join("letter/manifest.json"), r#"{ "program": "stormpetrel" }"#);
    put(&target.join("letter/path.png"), "old");
    put(&target.join("noted/manifest.json"), r#"{ "program": "stormpetrel" }"#);
    put(&target.join("noted/why.md"), "mine");
}

/// What must be there after `manifest.json` and `flight.csv` were written anew.
fn renewed(target: &Path) {
    let names = files(target);
    let expected = [
        "empty/",
        "flight.csv",
        "manifest.json",
        "mine/flight.csv",
        "noted/why.md",
        "notes.txt",
        "other/manifest.json",
    ];
    assert_eq!(names, expected);
    let tree = tree(target);
    assert_eq!((tree["flight.csv"].as_str(), tree["notes.txt"].as_str()), ("new", "mine"));
    assert_eq!(tree["mine/flight.csv"], "mine");
}

#[test]
fn old_results_disappear_and_files_of_others_stay() {
    let bench = TempDir::new().expect("a folder");
    let target = bench.path().join("out");
    old(&target);
    write(&target, &["manifest.json", "flight.csv"]);
    renewed(&target);
    assert_eq!(fs::read_dir(bench.path()).expect("a folder").count(), 1, "nothing beside it");
}

#[cfg(unix)]
#[test]
fn a_link_to_a_folder_stays_a_link() {
    let bench = TempDir::new().expect("a folder");
    let (real, link) = (bench.path().join("real/out"), bench.path().join("link"));
    old(&real);
    std::os::unix::fs::symlink(&real, &link).expect("a link");
    write(&link, &["manifest.json", "flight.csv"]);
    assert!(fs::symlink_metadata(&link).expect("a link").is_symlink());
    renewed(&real);
}

/// A folder with too many files of others to move: the files are moved one by one.
#[test]
fn a_folder_that_cannot_change_places_is_renewed_in_its_place() {
    let bench = TempDir::new().expect("a folder");
    let target = bench.path().join("out");
    old(&target);
    for i in 0..1001 {
        put(&target.join(format!("photos/{i}")), "mine");
    }
    write(&target, &["manifest.json", "flight.csv"]);
    assert_eq!(fs::read_dir(target.join("photos")).expect("a folder").count(), 1001);
    fs::remove_dir_all(target.join("photos")).expect("removed");
    renewed(&target);
}

#[test]
fn what_a_killed_process_had_begun_to_move_is_finished() {
    for ending in ["ready", "moving"] {
        let bench = TempDir::new().expect("a folder");
        let target = bench.path().join("out");
        old(&target);
        let hidden = target.join(format!(".stormpetrel-1-2-3.{ending}"));
        put(&hidden.join("manifest.json"), r#"{ "program": "stormpetrel" }"#);
        put(&hidden.join("flight.csv"), "new");
        drop(Folder::new(&target).expect("a folder"));
        assert_eq!(tree(&target)["flight.csv"], "new");
        assert!(!hidden.exists());
        if ending == "ready" {
            renewed(&target);
        }
    }
}

#[cfg(unix)]
#[test]
fn old_hidden_folders_without_owner_are_removed() {
    let bench = TempDir::new().expect("a folder");
    let age = |path: &Path| {
        let long_ago = SystemTime::now() - Duration::from_secs(2 * 24 * 3600);
        File::open(path).expect("a folder").set_modified(long_ago).expect("aged");
    };
    let [old, owned, young] = [1, 2, 3].map(|i| bench.path().join(format!(".stormpetrel-{i}")));
    for path in [&old, &owned, &young] {
        put(&path.join("flight.csv"), "half");
    }
    age(&old);
    age(&owned);
    let owner = File::open(&owned).expect("a folder");
    owner.try_lock().expect("a lock");
    write(&bench.path().join("out"), &["flight.csv"]);
    assert!(!old.exists() && owned.exists() && young.exists());
}

#[test]
fn what_stands_in_the_way_is_named_before_anything_is_written() {
    let bench = TempDir::new().expect("a folder");
    let file = bench.path().join("file");
    put(&file, "mine");
    let refused = |target: &Path, parts: &[&str]| {
        Folder::with_parts(target, parts).expect_err("refused").to_string()
    };
    assert!(refused(&file, &[]).contains("file: exists and is not a folder\n  = help: "));
    assert!(refused(&file.join("out"), &[]).contains("help: a part of the path is a file"));
    let target = bench.path().join("out");
    put(&target.join("flight.csv/mine"), "mine");
    put(&target.join("letter"), "mine");
    assert!(refused(&target, &[]).contains("flight.csv: is a folder"));
    assert!(refused(&target, &["letter"]).contains("letter: is not a folder"));
    assert_eq!(files(bench.path()), ["file", "out/flight.csv/mine", "out/letter"]);
}

#[cfg(unix)]
#[test]
fn the_permissions_of_the_user_count() {
    use std::os::unix::fs::PermissionsExt;
    let bench = TempDir::new().expect("a folder");
    let mode = |path: &Path| fs::metadata(path).expect("a folder").permissions().mode() & 0o777;
    let plain = bench.path().join("plain");
    fs::create_dir(&plain).expect("a folder");
    let target = bench.path().join("out");
    write(&target, &["flight.csv"]);
    assert_eq!(mode(&target), mode(&plain), "a new folder is like any other");
    fs::set_permissions(&target, fs::Permissions::from_mode(0o710)).expect("set");
    write(&target, &["flight.csv"]);
    assert_eq!(mode(&target), 0o710, "an old one stays as it was");
}
