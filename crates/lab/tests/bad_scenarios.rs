//! Every way to get a scenario wrong gets a message that tells how to mend it, to the letter.
//!
//! Each `bad/NAME.toml` has its message in `bad/NAME.txt`. After a deliberate change of a message, run
//! once with `STORMPETREL_BLESS=1` and read the difference.
// Tests compare bits, take the standard library as their second opinion, and print figures as their
// source prints them.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::approx_constant, clippy::float_cmp)]

use std::fs;
use std::path::Path;

use stormpetrel_lab::scenario::load_text;

#[test]
fn every_bad_scenario_gets_its_message() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad");
    let bless = std::env::var_os("STORMPETREL_BLESS").is_some();
    let mut count = 0;
    let mut wrong = Vec::new();
    let mut files: Vec<_> = fs::read_dir(&folder)
        .expect("the folder of bad scenarios")
        .map(|entry| entry.expect("a readable entry").path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "toml"))
        .collect();
    files.sort();
    for path in files {
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        let text = fs::read_to_string(&path).expect("a text");
        let message = match load_text(&name, &format!("{name}.toml"), text, &[]) {
            Ok(_) => panic!("{name}: accepted"),
            Err(faults) => format!("{faults}\n"),
        };
        let snapshot = path.with_extension("txt");
        if bless {
            fs::write(&snapshot, &message).expect("a writable snapshot");
        }
        if fs::read_to_string(&snapshot).unwrap_or_default() != message {
            wrong.push(format!("--- {name}\n{message}"));
        }
        count += 1;
    }
    assert!(count >= 20, "only {count} bad scenarios");
    assert!(wrong.is_empty(), "messages differ from their snapshots:\n{}", wrong.join("\n"));
}
