//! Which files of a result folder this program wrote, and which are somebody else's.
//!
//! A folder is known by its manifest or its report; in it the files with the names that this program
//! gives are its own.

use std::ffi::OsStr;
use std::fs::{self, DirEntry, Metadata};
use std::io;
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::PROGRAM;
use super::folder::PREFIX;
use super::refused::refuse;

/// Data of a flight, report of the article, preview of a flight.
const FILES: [&str; 5] =
    ["flight.csv", "metrics.json", "manifest.json", "report.html", "preview.html"];
/// Figures, as SVG and PNG.
const FIGURES: [&str; 13] = [
    "sources",
    "sensing",
    "preview-disturbance",
    "preview-sensors",
    "path",
    "errors",
    "disturbance",
    "commands",
    "rotors",
    "preview-path",
    "preview-motion",
    "preview-demand",
    "preview-rotors",
];
/// Folder of the report's figures.
const PICTURES: &str = "figures";
/// Longest manifest that is read, in bytes.
const LONGEST: u64 = 1 << 24;
/// Most files of others that move over to a new folder; with more the folder stays where it is.
const MOST: usize = 1000;

/// Whether the program gives this name to files of a folder, or of the report's figures.
fn is_name(name: &OsStr, pictures: bool) -> bool {
    let Some(name) = name.to_str() else { return false };
    let of_flight =
        |stem: &str| FIGURES.iter().any(|f| stem.strip_suffix(f).is_some_and(|s| s.ends_with('-')));
    let figure = |stem: &str| if pictures { of_flight(stem) } else { FIGURES.contains(&stem) };
    let drawn = name.strip_suffix(".svg").or_else(|| name.strip_suffix(".png")).is_some_and(figure);
    drawn || (!pictures && FILES.contains(&name))
}

/// The manifest of a folder of results.
fn manifest(folder: &Path) -> Option<Value> {
    let path = folder.join("manifest.json");
    let meta = fs::symlink_metadata(&path).ok()?;
    if !meta.is_file() || meta.len() > LONGEST {
        return None;
    }
    let manifest: Value = serde_json::from_slice(&fs::read(path).ok()?).ok()?;
    (manifest["program"] == PROGRAM).then_some(manifest)
}

fn is_one_of(folder: &Path, names: &[String]) -> bool {
    folder.file_name().is_some_and(|own| names.iter().any(|name| own == name.as_str()))
}

/// What a folder is to this program.
#[derive(Clone, Debug, PartialEq)]
enum Kind {
    /// Results, with these variants in folders of their own.
    Results(Vec<String>),
    /// The report of the article.
    Report,
    /// Its figures.
    Pictures,
    /// Somebody else's.
    Foreign,
}

impl Kind {
    fn of(folder: &Path) -> Self {
        if let Some(manifest) = manifest(folder) {
            let names = manifest["variants"].as_array().into_iter().flatten();
            return Self::Results(names.filter_map(Value::as_str).map(str::to_owned).collect());
        }
        let report = folder.join("report.html").is_file() && folder.join(PICTURES).is_dir();
        if report { Self::Report } else { Self::Foreign }
    }

    /// Kind of a folder in one of this kind.
    fn below(&self, folder: &Path) -> Self {
        match self {
            Self::Results(variants) if is_one_of(folder, variants) => Self::of(folder),
            Self::Report if folder.ends_with(PICTURES) => Self::Pictures,
            _ => Self::Foreign,
        }
    }

    fn owns(&self, entry: &DirEntry) -> bool {
        *self != Self::Foreign
            && entry.file_type().is_ok_and(|kind| kind.is_file())
            && is_name(&entry.file_name(), *self == Self::Pictures)
    }
}

/// Every entry of a folder that is there, with whether it is the program's own.
fn walk(
    folder: &Path,
    kind: &Kind,
    each: &mut dyn FnMut(&DirEntry, bool, bool) -> io::Result<bool>,
) -> io::Result<bool> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        if entry.file_name().to_string_lossy().starts_with(PREFIX) {
            continue;
        }
        let path = entry.path();
        let is_dir = entry.file_type()?.is_dir();
        let inner = kind.below(&path);
        let own = if is_dir { inner != Kind::Foreign } else { kind.owns(&entry) };
        if !each(&entry, is_dir, own)? || (is_dir && !walk(&path, &inner, each)?) {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Refuses a target in which something stands where results shall be.
pub(super) fn check(shown: &Path, target: &Path, parts: &[&str]) -> io::Result<()> {
    let figures = FIGURES.iter().flat_map(|f| [format!("{f}.svg"), format!("{f}.png")]);
    let files: Vec<String> = FILES.iter().map(|f| (*f).to_owned()).chain(figures).collect();
    let parts: Vec<&str> = parts.iter().copied().filter(|part| !part.is_empty()).collect();
    let folders = parts.iter().map(|part| part.trim_end_matches('/').to_owned());
    for place in folders.clone() {
        if fs::symlink_metadata(target.join(&place)).is_ok_and(|meta| !meta.is_dir()) {
            let help = "a folder of results goes there: remove it, or give another --out";
            return Err(refuse(&shown.join(place), "is not a folder", help));
        }
    }
    for place in folders.chain([String::new()]) {
        for file in &files {
            if target.join(&place).join(file).is_dir() {
                let help = "a file of results goes there: remove it, or give another --out";
                return Err(refuse(&shown.join(place).join(file), "is a folder", help));
            }
        }
    }
    Ok(())
}

/// Links files of others from the old folder into the new one, where both may change places; `false`
/// where they may not.
pub(super) fn carry(old: &Path, new: &Path) -> io::Result<bool> {
    let (there, here) = (fs::metadata(old)?, fs::metadata(new)?);
    if !same_owner(&there, &here) || !same_device(&there, &here) {
        return Ok(false);
    }
    let mut foreign: Vec<(PathBuf, bool)> = Vec::new();
    let few = walk(old, &Kind::of(old), &mut |entry, is_dir, own| {
        if !own {
            foreign.push((entry.path(), is_dir));
        }
        let alike = entry.metadata().is_ok_and(|meta| same_device(&meta, &there));
        Ok(alike && foreign.len() <= MOST)
    });
    // A folder that cannot be read cannot be carried.
    if !few.unwrap_or(false) {
        return Ok(false);
    }
    for (path, is_dir) in foreign {
        let Ok(tail) = path.strip_prefix(old) else { return Ok(false) };
        let to = new.join(tail);
        if fs::symlink_metadata(&to).is_ok() {
            continue;
        }
        if let Some(above) = to.parent() {
            fs::create_dir_all(above)?;
        }
        let carried = if is_dir {
            fs::create_dir(&to).and_then(|()| same_mode(&path, &to))
        } else {
            fs::hard_link(&path, &to)
        };
        if carried.is_err() {
            return Ok(false);
        }
    }
    same_mode(old, new)?;
    Ok(true)
}

fn same_mode(from: &Path, to: &Path) -> io::Result<()> {
    fs::set_permissions(to, fs::metadata(from)?.permissions())
}

/// Removes what the program wrote to the target before and does not write now.
pub(super) fn remove_stale(new: &Path, target: &Path) -> io::Result<()> {
    let (mut files, mut folders) = (Vec::new(), Vec::new());
    walk(target, &Kind::of(target), &mut |entry, is_dir, own| {
        let path = entry.path();
        let stays = path.strip_prefix(target).is_ok_and(|tail| new.join(tail).exists());
        if own && !stays {
            if is_dir { folders.push(path) } else { files.push(path) }
        }
        Ok(true)
    })?;
    for file in files {
        fs::remove_file(file)?;
    }
    for folder in folders.iter().rev() {
        // With files of others in it, it stays.
        let _ = fs::remove_dir(folder);
    }
    Ok(())
}

/// Copies a folder with everything in it.
pub(super) fn copy_all(from: &Path, to: &Path) -> io::Result<()> {
    fs::create_dir(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let target = to.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            copy_all(&entry.path(), &target)?;
        } else {
            fs::copy(entry.path(), target)?;
        }
    }
    Ok(())
}

#[cfg(unix)]
pub(super) fn same_device(a: &Metadata, b: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    a.dev() == b.dev()
}

#[cfg(unix)]
fn same_owner(a: &Metadata, b: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    (a.uid(), a.gid()) == (b.uid(), b.gid())
}

#[cfg(not(unix))]
pub(super) fn same_device(_: &Metadata, _: &Metadata) -> bool {
    true
}

#[cfg(not(unix))]
fn same_owner(_: &Metadata, _: &Metadata) -> bool {
    true
}
