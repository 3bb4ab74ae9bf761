//! The program as it is called, and files for it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

pub fn stormpetrel(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_stormpetrel"))
        .args(arguments)
        .current_dir(root())
        .output()
        .expect("the program starts")
}

pub fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

pub fn ends(output: &Output, code: i32) {
    assert_eq!(
        output.status.code(),
        Some(code),
        "{}{}",
        text(&output.stdout),
        text(&output.stderr)
    );
}

/// Names of everything in a folder.
pub fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> = fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

pub const HOVER: [&str; 3] = ["run", "scenarios/hover.toml", "--set"];

/// A scenario file with two variants of which the second may have an expectation that is not met.
pub fn two_variants(folder: &Path, expect: &str) -> PathBuf {
    let hover = fs::read_to_string(root().join("scenarios/hover.toml")).expect("a file");
    let path = folder.join("two.toml");
    let head = hover.split("[expect]").next().expect("a head");
    let variants = format!("[[variant]]\nname = \"a\"\n[[variant]]\nname = \"b\"\n{expect}\n");
    fs::write(&path, format!("{head}\n{variants}")).expect("a file");
    path
}

/// A point mass that hovers for a short time, with these blocks after the others.
pub fn point_mass(folder: &Path, blocks: &str) -> PathBuf {
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
