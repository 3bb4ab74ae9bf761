//! The journal of a campaign: what has been flown, appended chunk by chunk, each with a checksum.
//!
//!   header: mark, identity of the campaign, shard, shards, bytes a flight, checksum
//!   record: chunk number, length, checksum of both; the flights; checksum of the flights
//!
//! All numbers little end first, checksums CRC-32. A record that ends with the file was being written
//! when the program died, and zeros up to the end are room that a file system gave and never filled: both
//! are cut off and flown again. Anything else that does not add up is damage, and is said.

mod index;

use std::io::{self, Write as _};
use std::path::Path;

use super::disk::{Disk, Sink};
use super::result::Row;
use crate::fly::Failure;
use stormpetrel_plant::flight::Cause;

pub use index::{Index, owner};

/// Flights in a record.
pub const CHUNK: u64 = 64;

const MARK: [u8; 16] = *b"stormpetrel\0jr1\n";
const HEADER: usize = 16 + 8 + 8 + 8 + 8 + 4;
const HEAD: usize = 8 + 4 + 4;

/// What a journal belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Owner {
    /// Hash of everything that the results depend on.
    pub identity: u64,
    /// Which part of the plan, from zero.
    pub shard: u64,
    /// Number of parts.
    pub shards: u64,
    /// Metrics of one flight.
    pub metrics: u64,
}

impl Owner {
    fn header(&self) -> [u8; HEADER] {
        let mut bytes = [0; HEADER];
        bytes[..16].copy_from_slice(&MARK);
        for (slot, word) in bytes[16..48].chunks_exact_mut(8).zip([
            self.identity,
            self.shard,
            self.shards,
            self.metrics,
        ]) {
            slot.copy_from_slice(&word.to_le_bytes());
        }
        let sum = crc32fast::hash(&bytes[..48]);
        bytes[48..].copy_from_slice(&sum.to_le_bytes());
        bytes
    }

    fn read(bytes: &[u8; HEADER]) -> Option<Self> {
        let word = |at: usize| u64_at(bytes, at);
        let owner =
            Self { identity: word(16), shard: word(24), shards: word(32), metrics: word(40) };
        // More metrics than any program of ours ever had.
        let sane = owner.metrics <= 1 << 16;
        (owner.header() == *bytes && sane).then_some(owner)
    }
}

fn u64_at(bytes: &[u8], at: usize) -> u64 {
    let mut word = [0; 8];
    word.copy_from_slice(&bytes[at..at + 8]);
    u64::from_le_bytes(word)
}

fn u32_at(bytes: &[u8], at: usize) -> u32 {
    let mut word = [0; 4];
    word.copy_from_slice(&bytes[at..at + 4]);
    u32::from_le_bytes(word)
}

/// What one chunk came to, as far as its success goes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Flights.
    pub flown: u64,
    /// Those that did not fail.
    pub good: u64,
}

/// Outcome and metrics of one flight; index, seed and inputs follow from the plan.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Present where the flight failed.
    pub failure: Option<Failure>,
    /// Metrics in the order of the columns; NaN where there is none.
    pub metrics: Vec<f64>,
}

const CAUSES: [Cause; 4] = [Cause::PositionError, Cause::Tilt, Cause::Ground, Cause::NonFinite];

/// A chunk of flights as it stands in the journal.
#[derive(Clone, Debug)]
pub struct Record {
    chunk: u64,
    tally: Tally,
    bytes: Vec<u8>,
}

impl Record {
    /// From the flights of the chunk, each with so many metrics.
    ///
    /// # Errors
    /// Where they take more than 4 GiB.
    pub fn new(
        chunk: u64,
        metrics: usize,
        entries: impl ExactSizeIterator<Item = Entry>,
    ) -> io::Result<Self> {
        let size = entries.len() * flight_size(metrics);
        let mut bytes = Vec::with_capacity(HEAD + size + 4);
        bytes.extend(chunk.to_le_bytes());
        bytes.extend(u32::try_from(size).map_err(io::Error::other)?.to_le_bytes());
        bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
        let mut tally = Tally::default();
        for entry in entries {
            entry.encode(&mut bytes);
            tally.flown += 1;
            tally.good += u64::from(entry.failure.is_none());
        }
        bytes.extend(crc32fast::hash(&bytes[HEAD..]).to_le_bytes());
        Ok(Self { chunk, tally, bytes })
    }

    /// Which chunk it is.
    pub fn chunk(&self) -> u64 {
        self.chunk
    }

    /// What it came to.
    pub fn tally(&self) -> Tally {
        self.tally
    }
}

impl Entry {
    fn encode(&self, bytes: &mut Vec<u8>) {
        let Self { failure, metrics } = self;
        let code = failure.and_then(|f| CAUSES.iter().position(|cause| *cause == f.cause));
        let code = code.and_then(|at| u8::try_from(at + 1).ok()).unwrap_or(0);
        bytes.push(code);
        bytes.extend(failure.map_or(0.0, |f| f.time).to_le_bytes());
        for x in metrics {
            bytes.extend(x.to_le_bytes());
        }
    }
}

fn decode(bytes: &[u8], metrics: usize) -> Vec<Entry> {
    let float = |at: &[u8], i: usize| f64::from_bits(u64_at(at, i));
    let entry = |bytes: &[u8]| Entry {
        failure: CAUSES
            .get(usize::from(bytes[0]).wrapping_sub(1))
            .map(|cause| Failure { time: float(bytes, 1), cause: *cause }),
        metrics: (0..metrics).map(|i| float(bytes, 9 + 8 * i)).collect(),
    };
    bytes.chunks_exact(flight_size(metrics)).map(entry).collect()
}

/// Bytes of one flight.
fn flight_size(metrics: usize) -> usize {
    9 + 8 * metrics
}

/// Flights that the journal at `path` has by its size; none where it cannot be asked.
pub fn flights_at(path: &Path, metrics: u64) -> u64 {
    let length = path.metadata().map_or(0, |about| about.len()).saturating_sub(HEADER as u64);
    let record = size(CHUNK, metrics) - HEADER as u64;
    length / record * CHUNK + length % record / (9 + 8 * metrics)
}

/// Bytes that the journal takes for so many flights.
pub fn size(flights: u64, metrics: u64) -> u64 {
    let records = flights.div_ceil(CHUNK);
    HEADER as u64 + records * (HEAD as u64 + 4) + flights * (9 + 8 * metrics)
}

/// A journal open for writing.
pub struct Journal {
    file: Box<dyn Sink>,
}

impl Journal {
    /// Goes on behind what `index` has, or begins a new journal.
    ///
    /// # Errors
    /// Where the file cannot be written.
    pub fn open(
        disk: &dyn Disk,
        path: &Path,
        owner: &Owner,
        index: Option<&Index>,
    ) -> io::Result<Self> {
        let Some(index) = index else {
            let mut file = disk.create(path)?;
            file.write_all(&owner.header())?;
            file.sync()?;
            return Ok(Self { file });
        };
        Ok(Self { file: disk.append(path, index.end)? })
    }

    /// Appends a chunk and waits until it is on the medium.
    ///
    /// # Errors
    /// Where it cannot be written; the file may then end in half a record.
    pub fn append(&mut self, record: &Record) -> io::Result<()> {
        self.file.write_all(&record.bytes)?;
        self.file.sync()
    }
}

/// The row of a flight: what the journal has, and what follows from the plan.
pub fn row(index: u64, seed: u64, inputs: Vec<super::result::Input>, entry: Entry) -> Row {
    Row { index, seed, inputs, failure: entry.failure, metrics: entry.metrics }
}
