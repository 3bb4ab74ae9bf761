//! Result folders: built where nobody looks, then put in place in one stroke.
//!
//! A folder that is not there yet appears by renaming. One that is there changes places with the new one
//! in a single operation of the system, after files of others in it were linked into the new one; so a
//! process that is killed leaves the old folder or the new one, whole. Where a folder cannot change places
//! (a mount point, the working folder, a folder of another owner) the files are built in a hidden folder
//! inside it and moved one by one; a process killed meanwhile is finished by the next one.
//!
//! One lock is held by everybody who makes, moves or removes files here, the answer to an interrupt
//! included.

use std::fs::{self, File, Metadata};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use super::own;
use super::refused::{advise, refuse};

/// Beginning of the names of hidden folders.
pub(super) const PREFIX: &str = ".stormpetrel-";
/// Ending of a hidden folder that is complete and whose files are to replace the old ones.
const READY: &str = ".ready";
/// Ending of one whose files are on their way, the old ones removed.
const MOVING: &str = ".moving";
/// Age from which a hidden folder without owner is rubbish.
const DAY: Duration = Duration::from_secs(24 * 3600);

/// What this process has in the making.
struct Making {
    staged: Vec<Staged>,
    /// Names given so far.
    count: u64,
    /// Whether a folder was put in its place.
    published: bool,
    /// Whether an interrupt was answered: nothing is begun any more.
    interrupted: bool,
}

static MAKING: Mutex<Making> =
    Mutex::new(Making { staged: Vec::new(), count: 0, published: false, interrupted: false });

fn making() -> MutexGuard<'static, Making> {
    MAKING.lock().unwrap_or_else(PoisonError::into_inner)
}

fn interrupted() -> io::Error {
    io::Error::new(ErrorKind::Interrupted, "interrupted")
}

/// A hidden folder and the folders that were made to hold it, innermost first.
struct Staged {
    path: PathBuf,
    above: Vec<PathBuf>,
}

impl Staged {
    /// Removes everything; what will not go stays, nothing more can be done about it.
    fn clear(&self) {
        let _ = fs::remove_dir_all(&self.path);
        remove_empty(&self.above);
    }
}

fn remove_empty(folders: &[PathBuf]) {
    for folder in folders {
        match fs::remove_dir(folder) {
            Err(error) if error.kind() != ErrorKind::NotFound => break,
            _ => {}
        }
    }
}

/// While it lives nobody makes or moves a result file: to be kept until the program has ended.
#[must_use]
pub struct Halt {
    _making: MutexGuard<'static, Making>,
}

/// Answers an interrupt: waits for a folder that is being put in its place, removes those in the making.
/// `None` where the results stand already and the program is about to end by itself.
pub fn halt() -> Option<Halt> {
    let mut making = making();
    let again = std::mem::replace(&mut making.interrupted, true);
    if making.published && making.staged.is_empty() && !again {
        return None;
    }
    for staged in making.staged.drain(..) {
        staged.clear();
    }
    Some(Halt { _making: making })
}

/// A result folder in the making.
#[derive(Debug)]
pub struct Folder {
    /// Where it shall be, links followed.
    target: PathBuf,
    /// As the user wrote it.
    shown: PathBuf,
    staging: PathBuf,
    /// Whether the hidden folder lies inside the target.
    inside: bool,
    /// Held while the folder is in the making: it tells other processes so.
    _lock: Option<File>,
}

impl Folder {
    /// Begins a folder; nothing changes at `target` before [`Folder::publish`].
    ///
    /// # Errors
    /// Where the target is no folder or cannot be written.
    pub fn new(target: &Path) -> io::Result<Self> {
        Self::with_parts(target, &[])
    }

    /// Begins a folder with these folders in it.
    ///
    /// # Errors
    /// Where the target is no folder, cannot be written, or holds something that stands in the way.
    pub fn with_parts(target: &Path, parts: &[&str]) -> io::Result<Self> {
        let shown = target.to_owned();
        let target = resolve(&shown)?;
        let mut making = making();
        if making.interrupted {
            return Err(interrupted());
        }
        let there = fs::metadata(&target).ok();
        if there.is_some() {
            own::check(&shown, &target, parts)?;
            finish_others(&target).map_err(|error| advise(&shown, &error))?;
            sweep_rubbish(&target);
        }
        let parent = target.parent().unwrap_or(&target).to_owned();
        let mut inside = there.as_ref().is_some_and(|there| !may_swap(&target, &parent, there));
        let staging = if inside {
            making.stage(&target)
        } else {
            match making.stage(&parent) {
                // The folder above may be closed while the target is open.
                Err(_) if there.is_some() => {
                    inside = true;
                    making.stage(&target)
                }
                staged => staged,
            }
        };
        let staging = staging.map_err(|error| advise(&shown, &error))?;
        if let Err(error) = writable(&target, there.is_some()) {
            making.abandon(&staging);
            return Err(advise(&shown, &error));
        }
        if !inside {
            sweep_rubbish(&parent);
        }
        Ok(Self { target, shown, _lock: own_lock(&staging), staging, inside })
    }

    /// Where the files stand until they are published.
    pub fn staging(&self) -> &Path {
        &self.staging
    }

    /// A new file; folders in its name are made.
    ///
    /// # Errors
    /// Where it cannot be made.
    pub fn create(&self, name: &str) -> io::Result<BufWriter<File>> {
        let path = self.staging.join(name);
        let making = making();
        if making.interrupted {
            return Err(interrupted());
        }
        if let Some(parent) = path.parent() {
            fs::create_dir_all(parent)?;
        }
        Ok(BufWriter::with_capacity(1 << 16, File::create(path)?))
    }

    /// A new file with this content.
    ///
    /// # Errors
    /// Where it cannot be written.
    pub fn write(&self, name: &str, content: &[u8]) -> io::Result<()> {
        let mut file = self.create(name)?;
        file.write_all(content)?;
        file.flush()
    }

    /// Puts the folder in its place. What this program wrote there before is gone, files of others stay.
    ///
    /// # Errors
    /// Where the system refuses; the old folder is whole then.
    pub fn publish(self) -> io::Result<()> {
        let mut making = making();
        if making.interrupted {
            return Err(interrupted());
        }
        self.put().map_err(|error| advise(&self.shown, &error))?;
        // The folders above hold results now.
        making.staged.retain(|staged| staged.path != self.staging);
        making.published = true;
        Ok(())
    }

    fn put(&self) -> io::Result<()> {
        if self.inside {
            return settle(&self.staging, &self.target);
        }
        if !self.target.exists() {
            match fs::rename(&self.staging, &self.target) {
                // Somebody else may have been faster.
                Err(_) if self.target.exists() => {}
                done => return done,
            }
        }
        let free = hidden(&self.target).is_empty();
        if free
            && own::carry(&self.target, &self.staging)?
            && swap(&self.staging, &self.target).is_ok()
        {
            // The new folder stands; of the old one remains what cannot be removed.
            let _ = fs::remove_dir_all(&self.staging);
            return Ok(());
        }
        let moved = self.target.join(self.staging.file_name().unwrap_or_default());
        if fs::rename(&self.staging, &moved).is_err() {
            // Another file system: a mount point that does not look like one.
            own::copy_all(&self.staging, &moved)
                .inspect_err(|_| drop(fs::remove_dir_all(&moved)))?;
            let _ = fs::remove_dir_all(&self.staging);
        }
        let _lock = own_lock(&moved);
        settle(&moved, &self.target)
    }
}

impl Drop for Folder {
    /// Removes what was not published.
    fn drop(&mut self) {
        making().abandon(&self.staging);
    }
}

impl Making {
    /// Makes a hidden folder in `place`, remembered before it is there.
    fn stage(&mut self, place: &Path) -> io::Result<PathBuf> {
        self.count += 1;
        let now = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |now| now.as_nanos());
        let name = format!("{PREFIX}{}-{:x}-{}", std::process::id(), now, self.count);
        let path = place.join(name);
        let above =
            place.ancestors().take_while(|p| !p.exists()).map(Path::to_owned).collect::<Vec<_>>();
        self.staged.push(Staged { path: path.clone(), above });
        match fs::create_dir_all(place).and_then(|()| fs::create_dir(&path)) {
            Ok(()) => Ok(path),
            Err(error) => {
                self.abandon(&path);
                Err(error)
            }
        }
    }

    /// Removes a hidden folder that will not be published; nothing where it was.
    fn abandon(&mut self, staging: &Path) {
        if let Some(at) = self.staged.iter().position(|staged| staged.path == staging) {
            self.staged.swap_remove(at).clear();
        }
    }
}

/// The folder that is meant, links followed.
fn resolve(shown: &Path) -> io::Result<PathBuf> {
    match fs::canonicalize(shown) {
        Ok(real) if real.is_dir() => Ok(real),
        Ok(_) => Err(refuse(
            shown,
            "exists and is not a folder",
            "give another --out, or move the file out of the way",
        )),
        Err(error) if error.kind() != ErrorKind::NotFound => Err(advise(shown, &error)),
        Err(_) if fs::symlink_metadata(shown).is_ok() => Err(refuse(
            shown,
            "is a link that leads nowhere",
            "make the folder that it names, or remove the link",
        )),
        Err(_) if shown.file_name().is_none() => {
            Err(refuse(shown, "does not name a folder", "write a folder, as in --out out/run"))
        }
        Err(_) => std::path::absolute(shown),
    }
}

/// Whether the folder may change places with another one beside it.
fn may_swap(target: &Path, parent: &Path, there: &Metadata) -> bool {
    let within = std::env::current_dir()
        .and_then(fs::canonicalize)
        .is_ok_and(|here| here.starts_with(target));
    let above = fs::metadata(parent);
    parent != target && !within && above.is_ok_and(|above| own::same_device(&above, there))
}

/// Whether files may be made and removed in the folder, where it is there.
fn writable(target: &Path, there: bool) -> io::Result<()> {
    #[cfg(unix)]
    if there {
        use rustix::fs::{Access, access};
        access(target, Access::WRITE_OK | Access::EXEC_OK)?;
    }
    #[cfg(not(unix))]
    let _ = (target, there);
    Ok(())
}

/// Two folders change places in one stroke.
#[cfg(any(target_os = "linux", target_os = "macos"))]
fn swap(new: &Path, old: &Path) -> io::Result<()> {
    use rustix::fs::{CWD, RenameFlags, renameat_with};
    Ok(renameat_with(CWD, new, CWD, old, RenameFlags::EXCHANGE)?)
}

/// Elsewhere the files are moved one by one.
#[cfg(not(any(target_os = "linux", target_os = "macos")))]
fn swap(_: &Path, _: &Path) -> io::Result<()> {
    Err(ErrorKind::Unsupported.into())
}

fn with_ending(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(ending);
    path.with_file_name(name)
}

/// Moves everything from a hidden folder inside the target to its place. From the first renaming on
/// another process would finish it.
fn settle(staging: &Path, target: &Path) -> io::Result<()> {
    let ready = with_ending(staging, READY);
    fs::rename(staging, &ready)?;
    settle_ready(&ready, target)
}

fn settle_ready(ready: &Path, target: &Path) -> io::Result<()> {
    own::remove_stale(ready, target)?;
    let moving = ready.with_extension(MOVING.trim_start_matches('.'));
    fs::rename(ready, &moving)?;
    settle_moving(&moving, target)
}

fn settle_moving(moving: &Path, target: &Path) -> io::Result<()> {
    move_into(moving, target)?;
    fs::remove_dir_all(moving)
}

fn move_into(from: &Path, to: &Path) -> io::Result<()> {
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let target = to.join(entry.file_name());
        if entry.file_type()?.is_dir() && target.is_dir() {
            move_into(&entry.path(), &target)?;
        } else {
            fs::rename(entry.path(), target)?;
        }
    }
    Ok(())
}

/// Hidden folders of this program in a folder.
fn hidden(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let entries = entries.flatten().filter(|entry| {
        entry.file_name().to_string_lossy().starts_with(PREFIX)
            && entry.file_type().is_ok_and(|kind| kind.is_dir())
    });
    entries.map(|entry| entry.path()).collect()
}

fn ends(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|e| e.to_string_lossy() == ending.trim_start_matches('.'))
}

/// Finishes what a killed process had begun to move.
fn finish_others(target: &Path) -> io::Result<()> {
    for path in hidden(target) {
        if own_lock(&path).is_none() {
            continue;
        }
        if ends(&path, READY) {
            settle_ready(&path, target)?;
        } else if ends(&path, MOVING) {
            settle_moving(&path, target)?;
        }
    }
    Ok(())
}

/// Removes hidden folders that nobody owns and that are older than a day.
fn sweep_rubbish(folder: &Path) {
    for path in hidden(folder) {
        let age = fs::metadata(&path).and_then(|meta| meta.modified()).map(|at| at.elapsed());
        let old = matches!(age, Ok(Ok(age)) if age > DAY);
        let whole = ends(&path, READY) || ends(&path, MOVING);
        if old && !whole && own_lock(&path).is_some() {
            // Somebody else's may be closed to us: it stays.
            let _ = fs::remove_dir_all(&path);
        }
    }
}

/// The lock of a hidden folder; `None` where another process holds it, or where there are none.
fn own_lock(path: &Path) -> Option<File> {
    let file = File::open(path).ok()?;
    file.try_lock().ok()?;
    Some(file)
}
