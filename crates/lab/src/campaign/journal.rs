//! The journal of a campaign: what has been flown, appended chunk by chunk, each with a checksum.
//!
//!   header: mark, identity of the campaign, shard, shards, bytes a flight, checksum
//!   record: chunk number, length, checksum of both; the flights; checksum of the flights
//!
//! All numbers little end first, checksums CRC-32. A record that ends with the file was being written
//! when the program died, and zeros up to the end are room that a file system gave and never filled: both
//! are cut off and flown again. Anything else that does not add up is damage, and is said.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom, Write as _};
use std::path::{Path, PathBuf};

use super::disk::{Disk, Sink};
use super::result::Row;
use crate::fly::Failure;
use crate::output::{advise, refuse, with_help};
use stormpetrel_plant::flight::Cause;

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
        (owner.header() == *bytes).then_some(owner)
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

/// Bytes that the journal takes for so many flights.
pub fn size(flights: u64, metrics: u64) -> u64 {
    let records = flights.div_ceil(CHUNK);
    HEADER as u64 + records * (HEAD as u64 + 4) + flights * (9 + 8 * metrics)
}

/// Where the chunks of a journal stand.
#[derive(Debug)]
pub struct Index {
    path: PathBuf,
    owner: Owner,
    /// In the order of their chunks.
    records: Vec<Place>,
    end: u64,
}

/// Where a chunk stands, and what it came to. A long campaign has many of them.
#[derive(Clone, Copy, Debug)]
struct Place {
    begin: u64,
    chunk: u32,
    flights: u16,
    good: u16,
}

/// Whether nothing else is left to read.
fn only_zeros(file: &mut impl Read) -> io::Result<bool> {
    let mut bytes = [0; 4096];
    loop {
        match file.read(&mut bytes) {
            Ok(0) => return Ok(true),
            Ok(count) if bytes[..count].iter().all(|byte| *byte == 0) => {}
            Ok(_) => return Ok(false),
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
}

/// A message about a journal that cannot be used.
fn damaged(path: &Path, at: u64, what: &str) -> io::Error {
    let message = format!("damaged at byte {at}: {what}; what it holds cannot be trusted");
    refuse(path, &message, "restore it from a copy, or remove the folder and fly again")
}

/// What the journal at `path` belongs to; empty where there is none.
///
/// # Errors
/// Where it cannot be read or is damaged at its beginning.
pub fn owner(path: &Path) -> io::Result<Option<Owner>> {
    Ok(open(path)?.map(|(_, owner)| owner))
}

/// Opens the journal at `path` behind its header; empty where nothing is in it.
fn open(path: &Path) -> io::Result<Option<(File, Owner)>> {
    let mut file = match File::open(path) {
        Ok(file) => file,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(unread(path, &error)),
    };
    let mut header = Vec::new();
    let read = Read::by_ref(&mut file).take(HEADER as u64).read_to_end(&mut header);
    read.map_err(|error| unread(path, &error))?;
    let Ok(header) = <[u8; HEADER]>::try_from(header.as_slice()) else {
        // Died while beginning: a prefix of a header is nothing flown, other bytes are not ours.
        let ours = header.iter().zip(MARK).all(|(a, b)| *a == b);
        return if ours { Ok(None) } else { Err(damaged(path, 0, "not a journal")) };
    };
    match Owner::read(&header) {
        Some(owner) => Ok(Some((file, owner))),
        None => Err(damaged(path, 0, "the header does not have its checksum")),
    }
}

/// A journal that the system does not let us read; errors that say what to do stay.
fn unread(path: &Path, error: &io::Error) -> io::Error {
    if error.get_ref().is_some() {
        return advise(path, error);
    }
    with_help(path, error, "it must be a file that can be read: mend that, or give another --out")
}

impl Index {
    /// Reads the journal at `path`, which may not exist yet.
    ///
    /// # Errors
    /// Where it cannot be read or is damaged.
    pub fn read(path: &Path) -> io::Result<Option<Self>> {
        let Some((file, owner)) = open(path)? else { return Ok(None) };
        let length = file.metadata()?.len();
        let mut file = BufReader::with_capacity(1 << 16, file);
        // In one piece: growing would leave copies behind.
        let record = size(CHUNK, owner.metrics.min(1 << 20)) - HEADER as u64;
        let records = Vec::with_capacity(usize::try_from(length / record + 1).unwrap_or(0));
        let path = path.to_owned();
        let mut index = Self { path, owner, records, end: HEADER as u64 };
        while index.read_record(&mut file, length).map_err(|error| unread(&index.path, &error))? {}
        index.sort()?;
        Ok(Some(index))
    }

    /// Reads one record; `false` at the end or where the last one was cut.
    fn read_record(&mut self, file: &mut impl Read, length: u64) -> io::Result<bool> {
        let at = self.end;
        if length - at < HEAD as u64 {
            return Ok(false);
        }
        let mut head = [0; HEAD];
        file.read_exact(&mut head)?;
        if crc32fast::hash(&head[..12]) != u32_at(&head, 12) {
            if head == [0; HEAD] && only_zeros(file)? {
                return Ok(false);
            }
            return Err(damaged(&self.path, at, "a record's head does not have its checksum"));
        }
        let (chunk, size) = (u64_at(&head, 0), u32_at(&head, 8));
        let begin = at + HEAD as u64;
        if length - begin < u64::from(size) + 4 {
            return Ok(false);
        }
        let (whole, each) = (size as usize, flight_size(self.metrics()));
        let (Ok(chunk), Ok(flights), 0) =
            (u32::try_from(chunk), u16::try_from(whole / each), whole % each)
        else {
            return Err(damaged(&self.path, at, "a record that no campaign writes"));
        };
        let mut record = Place { begin, chunk, flights, good: 0 };
        let entries = self.flights(&record, file)?;
        record.good = entries.iter().map(|entry| u16::from(entry.failure.is_none())).sum();
        self.records.push(record);
        self.end = begin + u64::from(size) + 4;
        Ok(true)
    }

    /// Brings the records into the order of their chunks, of which each must stand once.
    fn sort(&mut self) -> io::Result<()> {
        self.records.sort_unstable_by_key(|record| (record.chunk, record.begin));
        let mut neighbours = self.records.iter().zip(self.records.iter().skip(1));
        match neighbours.find(|(a, b)| a.chunk == b.chunk) {
            Some((_, again)) => {
                Err(damaged(&self.path, again.begin - HEAD as u64, "a chunk stands twice"))
            }
            None => Ok(()),
        }
    }

    /// The flights of a record, at which `file` stands.
    fn flights(&self, record: &Place, file: &mut impl Read) -> io::Result<Vec<Entry>> {
        let size = usize::from(record.flights) * flight_size(self.metrics());
        let mut payload = vec![0; size + 4];
        file.read_exact(&mut payload)?;
        if crc32fast::hash(&payload[..size]) != u32_at(&payload, size) {
            return Err(damaged(&self.path, record.begin, "flights do not have their checksum"));
        }
        Ok(decode(&payload[..size], self.metrics()))
    }

    fn metrics(&self) -> usize {
        usize::try_from(self.owner.metrics).unwrap_or(usize::MAX)
    }

    fn find(&self, chunk: u64) -> Option<&Place> {
        let at =
            self.records.binary_search_by_key(&chunk, |record| u64::from(record.chunk)).ok()?;
        self.records.get(at)
    }

    /// The chunks in their order, and what each came to.
    pub fn tallies(&self) -> impl Iterator<Item = (u64, Tally)> {
        self.records.iter().map(|record| {
            let (flown, good) = (u64::from(record.flights), u64::from(record.good));
            (u64::from(record.chunk), Tally { flown, good })
        })
    }

    /// What the journal belongs to.
    pub fn owner(&self) -> Owner {
        self.owner
    }

    /// Whether the chunk is in it.
    pub fn has(&self, chunk: u64) -> bool {
        self.find(chunk).is_some()
    }

    /// The flights of a chunk; `None` where it is not in the journal.
    ///
    /// # Errors
    /// Where it cannot be read any more, or has changed since.
    pub fn chunk(&self, chunk: u64) -> io::Result<Option<Vec<Entry>>> {
        let Some(record) = self.find(chunk) else { return Ok(None) };
        let read = || {
            let mut file = File::open(&self.path)?;
            file.seek(SeekFrom::Start(record.begin))?;
            self.flights(record, &mut file)
        };
        read().map(Some).map_err(|error| unread(&self.path, &error))
    }
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
