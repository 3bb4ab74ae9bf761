//! The file operations of a campaign, behind a trait so that every one of them can be made to fail.

use std::fs::{File, OpenOptions};
use std::io::{self, Read, Seek, Write};
use std::path::Path;

use crate::output::{is_refused, with_help};

/// What a campaign asks of the file system.
pub trait Disk: Sync {
    /// A new empty file, replacing one of the same name.
    ///
    /// # Errors
    /// Those of the system.
    fn create(&self, path: &Path) -> io::Result<Box<dyn Sink>>;
    /// The file opened for writing at its end, cut to `length` bytes before.
    ///
    /// # Errors
    /// Those of the system.
    fn append(&self, path: &Path, length: u64) -> io::Result<Box<dyn Sink>>;
    /// Gives a file another name, replacing one of that name in one stroke.
    ///
    /// # Errors
    /// Those of the system.
    fn rename(&self, from: &Path, to: &Path) -> io::Result<()>;
    /// A nameless empty file on the medium of `folder`, gone with its owner.
    ///
    /// # Errors
    /// Those of the system.
    #[cfg(feature = "parquet")]
    fn scratch(&self, folder: &Path) -> io::Result<Box<dyn Scratch>>;
}

/// A file open for writing.
pub trait Sink: Write + Send {
    /// Returns once everything written is on the medium.
    ///
    /// # Errors
    /// Those of the system.
    fn sync(&mut self) -> io::Result<()>;
}

/// A file for what does not fit in memory.
pub trait Scratch: Read + Write + Seek + Send {}

impl<F: Read + Write + Seek + Send> Scratch for F {}

/// The file system of this machine.
#[derive(Clone, Copy, Debug, Default)]
pub struct Native;

impl Disk for Native {
    fn create(&self, path: &Path) -> io::Result<Box<dyn Sink>> {
        Ok(Box::new(File::create(path)?))
    }
    fn append(&self, path: &Path, length: u64) -> io::Result<Box<dyn Sink>> {
        let file = OpenOptions::new().append(true).create(true).open(path)?;
        file.set_len(length)?;
        Ok(Box::new(file))
    }
    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        std::fs::rename(from, to)?;
        // The new name itself must reach the medium, where the system lets folders be synchronised.
        #[cfg(unix)]
        if let Some(folder) = to.parent() {
            File::open(if folder.as_os_str().is_empty() { Path::new(".") } else { folder })?
                .sync_all()?;
        }
        Ok(())
    }
    #[cfg(feature = "parquet")]
    fn scratch(&self, folder: &Path) -> io::Result<Box<dyn Scratch>> {
        Ok(Box::new(tempfile::tempfile_in(folder)?))
    }
}

impl Sink for File {
    fn sync(&mut self) -> io::Result<()> {
        self.sync_all()
    }
}

/// Opens a file that may be read to its end: a pipe would never come to one.
///
/// # Errors
/// Those of the system, and what is no file.
pub(super) fn own_file(path: &Path) -> io::Result<File> {
    if !std::fs::metadata(path)?.is_file() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "is not a file"));
    }
    File::open(path)
}

/// Writes a file beside its place and renames it: it is never seen half-written. What could not be written
/// to its end is removed, so that it takes no room on a full disk.
///
/// # Errors
/// Those of the system with `help`, and what `fill` refuses.
pub fn replace(
    disk: &dyn Disk,
    path: &Path,
    help: &str,
    fill: impl FnOnce(&mut dyn Sink) -> io::Result<()>,
) -> io::Result<()> {
    let mut beside = path.as_os_str().to_owned();
    beside.push(".part");
    let beside = Path::new(&beside);
    // What is no error of the system tells for itself what it is about.
    let told = |at: &Path, error: io::Error| match error.kind() {
        io::ErrorKind::Other => error,
        _ if is_refused(&error) => error,
        _ => with_help(at, &error, help),
    };
    // Left by a program that was killed; a link would be written through.
    let _ = std::fs::remove_file(beside);
    let mut file = disk.create(beside).map_err(|error| told(beside, error))?;
    let filled = fill(file.as_mut()).and_then(|()| file.flush()).and_then(|()| file.sync());
    drop(file);
    let renamed = || disk.rename(beside, path).map_err(|error| told(path, error));
    let done = filled.map_err(|error| told(beside, error)).and_then(|()| renamed());
    if done.is_err() {
        let _ = std::fs::remove_file(beside);
    }
    done
}
