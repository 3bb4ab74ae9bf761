//! Paths that cannot be used, with what to do about it.

use std::fmt;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// A path, what is wrong with it, what to do: the payload of an [`io::Error`].
#[derive(Debug)]
pub struct Refused {
    path: PathBuf,
    message: String,
    help: String,
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.path.display(), self.message)?;
        if self.help.is_empty() { Ok(()) } else { write!(f, "\n  = help: {}", self.help) }
    }
}

impl std::error::Error for Refused {}

/// A path that cannot be used.
pub(crate) fn refuse(path: &Path, message: &str, help: &str) -> io::Error {
    refuse_as(ErrorKind::Other, path, message, help)
}

fn refuse_as(kind: ErrorKind, path: &Path, message: &str, help: &str) -> io::Error {
    let (path, message, help) = (path.to_owned(), message.to_owned(), help.to_owned());
    io::Error::new(kind, Refused { path, message, help })
}

/// Whether the error has its path and what to do.
pub(crate) fn is_refused(error: &io::Error) -> bool {
    error.get_ref().is_some_and(<dyn std::error::Error + Send + Sync>::is::<Refused>)
}

/// What the system said of a path, with what to do about it.
pub(crate) fn with_help(path: &Path, error: &io::Error, help: &str) -> io::Error {
    refuse_as(error.kind(), path, &error.to_string(), help)
}

/// What the system refused, with the path and what to do; errors that have both already stay.
pub fn advise(path: &Path, error: &io::Error) -> io::Error {
    if let Some(refused) = error.get_ref().and_then(|inner| inner.downcast_ref::<Refused>()) {
        return refuse_as(error.kind(), &refused.path, &refused.message, &refused.help);
    }
    let help = match error.kind() {
        ErrorKind::NotADirectory => "a part of the path is a file: give another --out",
        ErrorKind::PermissionDenied => {
            "you may not write there: give another --out, or change the permissions"
        }
        ErrorKind::ReadOnlyFilesystem => "give an --out that can be written",
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => {
            "make room, or give an --out with more room; with run.log_every a log takes less"
        }
        ErrorKind::InvalidFilename => "give a shorter name, without special characters",
        _ => "give another --out",
    };
    with_help(path, error, help)
}
