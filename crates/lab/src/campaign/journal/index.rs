//! Where the chunks of a journal stand: reading it back.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use super::{
    CHUNK, Entry, HEAD, HEADER, MARK, Owner, Tally, decode, flight_size, size, u32_at, u64_at,
};
use crate::campaign::disk::own_file;
use crate::output::{advise, is_refused, refuse, with_help};

/// Where the chunks of a journal stand.
#[derive(Debug)]
pub struct Index {
    path: PathBuf,
    owner: Owner,
    /// In the order of their chunks.
    records: Vec<Place>,
    /// Behind the last whole record.
    pub(super) end: u64,
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

/// Whether a payload has the checksum that it ends with.
fn is_whole(payload: &[u8]) -> bool {
    let size = payload.len() - 4;
    crc32fast::hash(&payload[..size]) == u32_at(payload, size)
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
    let mut file = match own_file(path) {
        Ok(file) => file,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(unread(path, &error)),
    };
    let mut header = Vec::new();
    let read = Read::by_ref(&mut file).take(HEADER as u64).read_to_end(&mut header);
    read.map_err(|error| unread(path, &error))?;
    // Died while beginning: a prefix of a header, or room that was never filled, is nothing flown.
    let short = header.len() < HEADER && header.iter().zip(MARK).all(|(a, b)| *a == b);
    if short || header.iter().all(|byte| *byte == 0) && only_zeros(&mut file)? {
        return Ok(None);
    }
    if !header.starts_with(&MARK) {
        return Err(refuse(path, "is not a journal of ours", "give another --out"));
    }
    match <[u8; HEADER]>::try_from(header.as_slice()).ok().and_then(|bytes| Owner::read(&bytes)) {
        Some(owner) => Ok(Some((file, owner))),
        None => Err(damaged(path, 0, "the header does not have its checksum")),
    }
}

/// A journal that the system does not let us read; errors that say what to do stay.
fn unread(path: &Path, error: &io::Error) -> io::Error {
    if is_refused(error) {
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
        let record = size(CHUNK, owner.metrics) - HEADER as u64;
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
        let payload = self.payload(&record, file)?;
        if !is_whole(&payload) {
            // Its end was never filled.
            if payload.ends_with(&[0; 4]) && only_zeros(file)? {
                return Ok(false);
            }
            return Err(self.changed(&record));
        }
        let entries = self.decode(&payload);
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

    /// The flights of a record and their checksum; `file` stands at the first.
    fn payload(&self, record: &Place, file: &mut impl Read) -> io::Result<Vec<u8>> {
        let size = usize::from(record.flights) * flight_size(self.metrics());
        let mut payload = vec![0; size + 4];
        file.read_exact(&mut payload)?;
        Ok(payload)
    }

    fn decode(&self, payload: &[u8]) -> Vec<Entry> {
        decode(&payload[..payload.len() - 4], self.metrics())
    }

    fn changed(&self, record: &Place) -> io::Error {
        damaged(&self.path, record.begin, "flights do not have their checksum")
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
            let payload = self.payload(record, &mut file)?;
            if is_whole(&payload) { Ok(self.decode(&payload)) } else { Err(self.changed(record)) }
        };
        read().map(Some).map_err(|error| unread(&self.path, &error))
    }
}
