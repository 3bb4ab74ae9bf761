//! Reading the text of a scenario or of a table from disk.

use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::Path;

use super::document::LONGEST;
use super::fault::{Fault, Faults};
use crate::shipped;

/// The text of a file; never more of it than a scenario may have.
pub(super) fn read(path: &Path, shown: &str) -> Result<String, Faults> {
    let refuse = |message: &str, help: &str| {
        Faults::from(Fault::general(format!("{shown}: {message}")).help(help))
    };
    let broken = |error: io::Error| {
        let help = match error.kind() {
            ErrorKind::NotFound => "`stormpetrel list scenarios` shows the shipped files",
            _ => "check the path and its permissions",
        };
        refuse(&error.to_string(), help)
    };
    let kind = std::fs::metadata(path).map_err(broken)?.file_type();
    if kind.is_dir() {
        return Err(refuse("is a folder", "give the scenario file in it"));
    }
    // A pipe or a device may never end.
    if !kind.is_file() {
        return Err(refuse("is not a file", "give a scenario file"));
    }
    let mut bytes = Vec::new();
    let limit = LONGEST as u64 + 1;
    File::open(path).and_then(|file| file.take(limit).read_to_end(&mut bytes)).map_err(broken)?;
    if bytes.len() > LONGEST {
        let message = format!("more than {LONGEST} bytes: too long for a scenario");
        return Err(refuse(&message, "is this a scenario file?"));
    }
    decode(bytes).map_err(|(message, help)| refuse(&message, help))
}

/// Largest CSV file that is read, in bytes.
pub(super) const MOST_BYTES_OF_TABLE: u64 = 1 << 26;

/// The text of a CSV file, or why it cannot be had. Those of shipped scenarios are found without a disk.
pub(super) fn table(path: &Path) -> Result<String, String> {
    from_disk(path).or_else(|why| shipped::table(path).map(str::to_owned).ok_or(why))
}

fn from_disk(path: &Path) -> Result<String, String> {
    let size = std::fs::metadata(path).map_err(|error| error.to_string())?;
    if !size.is_file() {
        return Err("is not a file".into());
    }
    if size.len() > MOST_BYTES_OF_TABLE {
        return Err(format!("{} bytes: too long", size.len()));
    }
    let bytes = std::fs::read(path).map_err(|error| error.to_string())?;
    decode(bytes).map_err(|(message, _)| message)
}

/// The bytes as a text, or what they are instead.
fn decode(bytes: Vec<u8>) -> Result<String, (String, &'static str)> {
    let utf16 = bytes.starts_with(&[0xFF, 0xFE]) || bytes.starts_with(&[0xFE, 0xFF]);
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let before = error.as_bytes().get(..at).unwrap_or_default();
        let line = before.split(|byte| *byte == b'\n').count();
        let message = format!("byte {at}, in line {line}, is not UTF-8");
        if utf16 {
            return (message, "the file is UTF-16: save it as UTF-8");
        }
        (message, "a scenario is a text file in UTF-8: save it as such")
    })
}
