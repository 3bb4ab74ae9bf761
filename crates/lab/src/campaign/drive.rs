//! Flying a campaign: threads take chunks of the plan, the journal keeps what is done, and at the end
//! the files are written in the order of the plan.

use std::collections::BTreeMap;
use std::io;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, sync_channel};
use std::sync::{Mutex, PoisonError};

use super::disk::Disk;
use super::journal::{self, CHUNK, Index, Journal, Owner, Record, Tally};
use super::plan::Campaign;
use super::summary::wilson;
use super::worker::{Worker, start};
use crate::output::{REVISION, VERSION, refuse, with_help};

/// How a campaign is flown.
#[derive(Clone, Copy, Debug)]
pub struct Drive<'a> {
    /// What is flown.
    pub campaign: &'a Campaign,
    /// Folder of the campaign.
    pub folder: &'a Path,
    /// File operations.
    pub disk: &'a dyn Disk,
    /// Number of threads.
    pub threads: usize,
    /// Which part of the plan, from zero, of how many.
    pub shard: (u64, u64),
    /// Width of the success interval that is narrow enough.
    pub until: Option<f64>,
    /// Set from outside to end after the chunks in hand.
    pub stop: &'a AtomicBool,
}

impl std::fmt::Debug for dyn Disk + '_ {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Disk")
    }
}

/// How far it has come.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Flights to fly, in this shard.
    pub flights: u64,
    /// Flights done, those of earlier runs included.
    pub done: Tally,
    /// Flights done by this run.
    pub flown_now: u64,
}

/// How it ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// All flights that were asked for are in the journal: so many, from the first on.
    Complete(u64),
    /// Stopped from outside; `resume` goes on.
    Stopped,
}

/// The journal of a campaign's folder.
pub const JOURNAL: &str = "journal.bin";

impl Drive<'_> {
    /// Flights of this part of the plan.
    pub fn flights(&self) -> u64 {
        let of = |chunk| {
            let rows = rows(self.campaign, chunk);
            rows.end - rows.start
        };
        self.chunks().map(of).sum()
    }

    /// Flights of this part that the journal does not have yet, to within a chunk.
    pub fn left(&self) -> u64 {
        let has = journal::flights_at(&self.folder.join(JOURNAL), self.owner().metrics);
        self.flights().saturating_sub(has)
    }

    /// What the journal of this part must say of itself.
    pub fn owner(&self) -> Owner {
        Owner {
            identity: identity(self.campaign),
            shard: self.shard.0,
            shards: self.shard.1,
            metrics: self.campaign.columns().metrics.len() as u64,
        }
    }

    /// Refuses a folder whose journal is of another campaign, or of another part of this one.
    ///
    /// # Errors
    /// Whose it is, and what to do; a journal that cannot be read or is damaged at its beginning.
    pub fn claim(&self) -> io::Result<()> {
        let path = self.folder.join(JOURNAL);
        journal::owner(&path)?.map_or(Ok(()), |owner| self.own(&path, owner))
    }

    fn own(&self, path: &Path, owner: Owner) -> io::Result<()> {
        let ours = self.owner();
        if owner == ours {
            return Ok(());
        }
        if owner.identity == ours.identity && owner.shards == 1 {
            let help =
                "leave out --shard and give --resume to go on with it, or give another --out";
            return Err(refuse(path, "holds this campaign as a whole", help));
        }
        if owner.identity == ours.identity {
            let part = format!("{}/{}", owner.shard + 1, owner.shards);
            let message = format!("holds part {part} of this campaign");
            let help = format!("give --resume --shard {part} to go on with it, or another --out");
            return Err(refuse(path, &message, &help));
        }
        Err(foreign(path))
    }

    /// Refuses a journal with chunks that this part of the plan does not have.
    fn fits(&self, path: &Path, index: &Index) -> io::Result<()> {
        let (shard, shards) = self.shard;
        let ours = |(chunk, tally): &(u64, Tally)| {
            let rows = rows(self.campaign, *chunk);
            chunk % shards == shard && rows.end.saturating_sub(rows.start) == tally.flown
        };
        match index.tallies().find(|chunk| !ours(chunk)) {
            None => Ok(()),
            Some((chunk, _)) => {
                let message = format!("its chunk {chunk} is none of this part of the plan");
                let help = "restore it from a copy, or remove the folder and fly again";
                Err(refuse(path, &message, help))
            }
        }
    }

    /// Flies what the journal does not have yet; `watch` is told of every chunk.
    ///
    /// # Errors
    /// Where the journal belongs to another campaign, is damaged or cannot be written, or a flight cannot
    /// be built or breaks the program.
    pub fn fly(&self, watch: &mut dyn FnMut(&Progress)) -> io::Result<End> {
        let path = self.folder.join(JOURNAL);
        let index = Index::read(&path)?;
        if let Some(index) = &index {
            self.own(&path, index.owner())?;
            self.fits(&path, index)?;
        }
        let mut journal = Journal::open(self.disk, &path, &self.owner(), index.as_ref())
            .map_err(|error| halted(&path, &error))?;
        let mut count = Count::new(self, index.iter().flat_map(Index::tallies));
        let has = |chunk: &u64| index.as_ref().is_some_and(|index| index.has(*chunk));
        let waiting = Mutex::new(self.chunks().filter(|chunk| !has(chunk)));
        // A thread that broke held nothing half-done here.
        let next = || waiting.lock().unwrap_or_else(PoisonError::into_inner).next();
        let enough = AtomicBool::new(count.enough());
        watch(&count.progress());
        std::thread::scope(|scope| {
            let (send, receive) = sync_channel(self.threads);
            let (next, enough) = (&next, &enough);
            start(scope, self.threads, move || {
                let mut worker = Worker::new(self.campaign);
                while !self.stop.load(Ordering::Relaxed) && !enough.load(Ordering::Relaxed) {
                    let Some(chunk) = next() else { break };
                    if send.send((chunk, worker.fly_chunk(chunk))).is_err() {
                        break;
                    }
                }
            })?;
            let append =
                |record: &Record| journal.append(record).map_err(|error| halted(&path, &error));
            let kept = keep(receive, append, &mut count, enough, watch);
            if kept.is_err() {
                // Lets the threads end: nothing more can be kept.
                enough.store(true, Ordering::Relaxed);
            }
            kept
        })?;
        Ok(count.end())
    }

    /// The chunks of this part of the plan.
    pub(super) fn chunks(&self) -> impl Iterator<Item = u64> {
        let (shard, shards) = self.shard;
        (0..self.campaign.flights().div_ceil(CHUNK)).filter(move |chunk| chunk % shards == shard)
    }
}

/// Refuses a folder whose journal is of another campaign; which part of this one it has does not matter.
///
/// # Errors
/// That it is, and what to do; a journal that cannot be read or is damaged at its beginning.
pub fn claim(folder: &Path, campaign: &Campaign) -> io::Result<()> {
    let path = folder.join(JOURNAL);
    match journal::owner(&path)? {
        Some(owner) if owner.identity != identity(campaign) => Err(foreign(&path)),
        _ => Ok(()),
    }
}

fn foreign(path: &Path) -> io::Error {
    let help =
        "give another --out; to resume, give the same file, --variant, --set and --plan as before";
    refuse(path, "belongs to another campaign, or to another version of the program", help)
}

/// The flights of a chunk.
pub fn rows(campaign: &Campaign, chunk: u64) -> std::ops::Range<u64> {
    let begin = chunk * CHUNK;
    let end = begin + CHUNK;
    begin..if end < campaign.flights() { end } else { campaign.flights() }
}

/// A hash of everything that the results depend on, the version of the program with it (FNV-1a).
pub fn identity(campaign: &Campaign) -> u64 {
    let all = format!("{VERSION} {REVISION} {}", campaign.identity());
    all.bytes().fold(0xCBF2_9CE4_8422_2325, |state, byte| {
        (state ^ u64::from(byte)).wrapping_mul(0x0100_0000_01B3)
    })
}

/// A journal that could not be written on.
fn halted(path: &Path, error: &io::Error) -> io::Error {
    let help = "what is flown is kept: mend that, and the same command with --resume goes on";
    with_help(path, error, help)
}

/// A chunk and what came of it.
type Flown = (u64, io::Result<Record>);

/// Takes chunks as they come and keeps them. Where some cannot be flown the first of them in the plan is
/// told: all chunks before it were handed out before it, and are waited for.
fn keep(
    receive: Receiver<Flown>,
    mut append: impl FnMut(&Record) -> io::Result<()>,
    count: &mut Count,
    enough: &AtomicBool,
    watch: &mut dyn FnMut(&Progress),
) -> io::Result<()> {
    let mut first_bad: Option<(u64, io::Error)> = None;
    for (chunk, record) in receive {
        match record {
            Ok(record) => {
                append(&record)?;
                count.add(record.chunk(), record.tally());
                watch(&count.progress());
            }
            Err(error) => {
                if first_bad.as_ref().is_none_or(|(bad, _)| chunk < *bad) {
                    first_bad = Some((chunk, error));
                }
            }
        }
        if first_bad.is_some() || count.enough() {
            enough.store(true, Ordering::Relaxed);
        }
    }
    // What comes after the flights that are enough does not count.
    first_bad.filter(|_| !count.enough()).map_or(Ok(()), |(_, error)| Err(error))
}

/// Counts what is done, and how far the plan is done without a gap: only that may decide when there is
/// enough, or the answer would depend on which thread was faster.
struct Count {
    flights: u64,
    until: Option<f64>,
    tallies: BTreeMap<u64, Tally>,
    done: Tally,
    flown_now: u64,
    /// Chunks done without a gap, and what they came to.
    prefix: (u64, Tally),
    /// Flights that are enough.
    answer: Option<u64>,
}

impl Count {
    fn new(drive: &Drive<'_>, tallies: impl Iterator<Item = (u64, Tally)>) -> Self {
        let mut count = Self {
            flights: drive.flights(),
            until: drive.until,
            tallies: BTreeMap::new(),
            done: Tally::default(),
            flown_now: 0,
            prefix: (0, Tally::default()),
            answer: None,
        };
        for (chunk, tally) in tallies {
            count.add(chunk, tally);
        }
        count.flown_now = 0;
        count
    }

    fn add(&mut self, chunk: u64, tally: Tally) {
        self.done.flown += tally.flown;
        self.done.good += tally.good;
        self.flown_now += tally.flown;
        self.tallies.insert(chunk, tally);
        while let Some(tally) = self.tallies.remove(&self.prefix.0) {
            self.prefix.0 += 1;
            self.prefix.1.flown += tally.flown;
            self.prefix.1.good += tally.good;
            let Some(width) = self.until.filter(|_| self.answer.is_none()) else { continue };
            let interval = wilson(self.prefix.1.good, self.prefix.1.flown);
            if interval.high - interval.low <= width {
                self.answer = Some(self.prefix.1.flown);
            }
        }
    }

    fn enough(&self) -> bool {
        self.answer.is_some()
    }

    fn progress(&self) -> Progress {
        Progress { flights: self.flights, done: self.done, flown_now: self.flown_now }
    }

    fn end(&self) -> End {
        match self.answer {
            Some(flights) => End::Complete(flights),
            None if self.done.flown == self.flights => End::Complete(self.flights),
            None => End::Stopped,
        }
    }
}
