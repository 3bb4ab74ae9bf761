//! Nothing lost, nothing twice, nothing silently wrong: campaigns stopped, broken, damaged and split.
//!
//! Short here; the tests marked `ignore` are the long versions that `cargo xtask abuse` runs.
#![allow(clippy::expect_used, clippy::print_stdout)] // a test fails by panicking, and prints its figures

use std::fs;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use stormpetrel_lab::campaign::ahead::estimate;
use stormpetrel_lab::campaign::disk::{Disk, Native, Scratch, Sink};
use stormpetrel_lab::campaign::drive::{Drive, End, JOURNAL};
use stormpetrel_lab::campaign::files;
use stormpetrel_lab::campaign::journal::{self, CHUNK, Entry, Index, Journal, Owner, Record};
use stormpetrel_lab::campaign::plan::Campaign;
use stormpetrel_lab::scenario::fault::Faults;
use tempfile::TempDir;

const FILE: &str = r#"
run                = { duration = 0.1, control_step = 0.001, substeps = 1, seed = 7, late = 0.05 }
vehicle            = { model = "article-corrected" }
model              = { mass = 0.625 }
reference          = { shape = "helix" }
position           = { law = "pid" }
observer           = { law = "hosm" }
attitude_reference = { law = "rotation" }
attitude           = { law = "tilt-priority" }
rate               = { law = "indi" }
actuation          = { kind = "rotors" }
failure            = { position_error = 0.02, allowed = true }
campaign           = { flights = 300, metrics = "position" }
[[sweep]]
path    = "vehicle.mass"
uniform = [0.4, 0.9]
[[sweep]]
path = "observer.law"
list = ["hosm", "none"]
"#;

/// Hash of results and summary of this campaign.
const REGRESS_HASH: &str = "750215442e71f12e";

/// FNV-1a.
fn hash(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xCBF2_9CE4_8422_2325, |state, byte| {
        (state ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01B3)
    })
}

struct Place {
    folder: TempDir,
    file: PathBuf,
}

impl Place {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("campaign.toml");
        fs::write(&file, FILE).expect("a file");
        Self { folder, file }
    }
    fn campaign(&self, sets: &[&str]) -> Campaign {
        let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
        Campaign::load(&self.file, &sets, None).expect("a good campaign")
    }
    fn sub(&self, name: &str) -> PathBuf {
        let folder = self.folder.path().join(name);
        fs::create_dir_all(&folder).expect("a folder");
        folder
    }
}

fn drive<'a>(campaign: &'a Campaign, folder: &'a Path, stop: &'a AtomicBool) -> Drive<'a> {
    Drive { campaign, folder, disk: &Native, threads: 2, shard: (0, 1), until: None, stop }
}

/// Flies what is missing and writes the files; their bytes.
fn finish(campaign: &Campaign, folder: &Path, threads: usize) -> Vec<Vec<u8>> {
    let stop = AtomicBool::new(false);
    let end = Drive { threads, ..drive(campaign, folder, &stop) }.fly(&mut |_| {}).expect("flown");
    assert_eq!(end, End::Complete(campaign.flights()));
    results(campaign, folder, &[folder.to_owned()], campaign.flights())
}

fn results(campaign: &Campaign, folder: &Path, parts: &[PathBuf], flights: u64) -> Vec<Vec<u8>> {
    let index = |part: &PathBuf| Index::read(&part.join(JOURNAL)).expect("read").expect("there");
    let parts: Vec<Index> = parts.iter().map(index).collect();
    files::finish(&Native, folder, campaign, &parts, flights).expect("written");
    let read = |name| fs::read(folder.join(name)).expect("a result");
    vec![read(files::RESULTS), read(files::SUMMARY)]
}

#[test]
fn regress_the_files_do_not_depend_on_the_number_of_threads() {
    let place = Place::new();
    let campaign = place.campaign(&[]);
    let one = finish(&campaign, &place.sub("1"), 1);
    // The same in debug and release, on every machine.
    assert_eq!(format!("{:016x}", hash(&one.concat())), REGRESS_HASH);
    assert!(one[0].len() > 50_000 && one[1].len() > 500, "something is in them");
    for threads in [2, 8] {
        assert!(one == finish(&campaign, &place.sub(&threads.to_string()), threads), "{threads}");
    }
}

#[test]
fn parts_flown_anywhere_join_into_the_same_files() {
    let place = Place::new();
    let campaign = place.campaign(&[]);
    let whole = finish(&campaign, &place.sub("whole"), 2);
    let stop = AtomicBool::new(false);
    let mut parts = Vec::new();
    for shard in [2, 0, 1] {
        let folder = place.sub(&format!("part{shard}"));
        let drive = Drive { shard: (shard, 3), ..drive(&campaign, &folder, &stop) };
        assert!(matches!(drive.fly(&mut |_| {}), Ok(End::Complete(n)) if n < 300));
        parts.push(folder);
    }
    assert!(whole == results(&campaign, &place.sub("joined"), &parts, 300));
    // A missing part is said.
    let index = Index::read(&parts[0].join(JOURNAL)).expect("read").expect("there");
    let error = files::finish(&Native, &place.sub("half"), &campaign, &[index], 300);
    let message = error.map(|_| ()).expect_err("a part is missing").to_string();
    assert_eq!(message, "flights 0 to 63 are missing");
    assert_eq!(fs::read_dir(place.sub("half")).expect("a folder").count(), 0, "nothing half-made");
}

#[test]
fn stopped_and_resumed_is_the_same_as_never_stopped() {
    let place = Place::new();
    // More chunks than can be in hand when the end is asked for.
    let campaign = place.campaign(&["campaign.flights=900", "run.duration=0.06"]);
    let whole = finish(&campaign, &place.sub("whole"), 2);
    let folder = place.sub("stopped");
    for _ in 0..2 {
        let stop = AtomicBool::new(false);
        let mut told = 0;
        let end = Drive { threads: 1, ..drive(&campaign, &folder, &stop) }.fly(&mut |_| {
            told += 1;
            stop.fetch_or(told == 2, Ordering::Relaxed);
        });
        assert_eq!(end.expect("stopped in order"), End::Stopped);
    }
    assert!(whole == finish(&campaign, &folder, 2));
}

#[test]
fn a_replayed_plan_flies_the_same_flights() {
    let place = Place::new();
    let mut campaign = place.campaign(&[]);
    let drawn = finish(&campaign, &place.sub("drawn"), 2);
    files::begin(&Native, &place.sub("plan"), &campaign).expect("written");
    let plan = fs::read_to_string(place.sub("plan").join(files::PLAN)).expect("a plan");
    campaign.replay(&plan).expect("its own plan");
    let folder = place.sub("replayed");
    let replayed = finish(&campaign, &folder, 2);
    assert!(drawn[1] == replayed[1], "the same summary");
}

#[test]
fn the_answer_that_is_good_enough_does_not_depend_on_the_threads() {
    let place = Place::new();
    let campaign = place.campaign(&["campaign.flights=3000"]);
    let mut ends = Vec::new();
    for threads in [1, 3] {
        let stop = AtomicBool::new(false);
        let folder = place.sub(&format!("until{threads}"));
        let drive = Drive { threads, until: Some(0.1), ..drive(&campaign, &folder, &stop) };
        ends.push(drive.fly(&mut |_| {}).expect("flown"));
    }
    assert_eq!(ends[0], ends[1]);
    assert!(matches!(ends[0], End::Complete(n) if n < 1000), "{ends:?}");
}

/// The flights that are looked at are not only the first ones.
#[test]
fn an_estimate_sees_the_longest_flights() {
    let place = Place::new();
    let durations = r#"sweep=[{ path = "run.duration", grid = [0.06, 0.1, 3] }, { path = "vehicle.mass", grid = [0.5, 0.7, 100] }]"#;
    let campaign = place.campaign(&["campaign.flights=0", durations]);
    let few = estimate(&campaign, 1, 2).expect("flights that can be");
    let many = estimate(&campaign, 100_000_000, 2).expect("flights that can be");
    assert_eq!((few.ticks, many.ticks), ((60, 100), (60, 100)));
    assert!(few.time < many.time);
}

/// The second chunk is refused at its first flight, long before the first one is at its last.
#[test]
fn of_flights_that_cannot_be_the_first_of_the_plan_is_told() {
    let place = Place::new();
    let mut plan = "index,seed,vehicle.mass,observer.law\n".to_owned();
    for index in 0..4 * CHUNK {
        let mass = if [CHUNK - 1, CHUNK, 3 * CHUNK].contains(&index) { "-1.0" } else { "0.625" };
        plan += &format!("{index},{index},{mass},hosm\n");
    }
    let mut campaign = place.campaign(&[]);
    campaign.replay(&plan).expect("numbers");
    for threads in [1, 2, 8] {
        let folder = place.sub(&format!("bad{threads}"));
        let stop = AtomicBool::new(false);
        let drive = Drive { threads, ..drive(&campaign, &folder, &stop) };
        let error = drive.fly(&mut |_| {}).expect_err("a negative mass");
        let faults = error.get_ref().and_then(|inner| inner.downcast_ref::<Faults>());
        let Faults(faults) = faults.expect("faults");
        assert_eq!(faults.len(), 1);
        let message = &faults[0].message;
        assert!(message.starts_with("flight 63 of the plan: `vehicle.mass` = -1"), "{message}");
    }
}

#[test]
fn a_journal_of_another_campaign_is_refused() {
    let place = Place::new();
    let folder = place.sub("one");
    finish(&place.campaign(&[]), &folder, 2);
    let other = place.campaign(&["run.seed=8"]);
    let stop = AtomicBool::new(false);
    let error = drive(&other, &folder, &stop).fly(&mut |_| {}).expect_err("another seed");
    assert!(error.to_string().contains("belongs to another campaign"), "{error}");
    let claimed = drive(&other, &folder, &stop).claim().expect_err("another seed");
    assert_eq!(claimed.to_string(), error.to_string());
}

/// As a file system may leave it after a power cut.
#[test]
fn zeros_behind_the_last_record_are_cut_off() {
    let place = Place::new();
    let campaign = place.campaign(&[]);
    let whole = finish(&campaign, &place.sub("whole"), 1);
    let journal = fs::read(place.sub("whole").join(JOURNAL)).expect("a journal");
    let metrics = campaign.columns().metrics.len() as u64;
    let two_chunks = journal::size(2 * CHUNK, metrics);
    let path = place.sub("cut").join(JOURNAL);
    let index = |bytes: &[u8]| {
        fs::write(&path, bytes).expect("written");
        Index::read(&path)
    };
    for zeros in [16, 17, 5000] {
        let mut bytes = journal[..usize::try_from(two_chunks).expect("small")].to_vec();
        bytes.resize(bytes.len() + zeros, 0);
        let read = index(&bytes).expect("zeros are nothing").expect("a journal");
        assert_eq!(read.tallies().map(|(chunk, _)| chunk).collect::<Vec<_>>(), [0, 1]);
        assert!(whole == finish(&campaign, &place.sub("cut"), 2), "{zeros} zeros");
        *bytes.last_mut().expect("a zero") = 1;
        assert!(index(&bytes).is_err(), "not only zeros");
    }
    // The third record has its head and some flights, and room for the rest.
    for more in [0, 4096] {
        let mut bytes = journal[..usize::try_from(two_chunks).expect("small") + 1000].to_vec();
        bytes.resize(usize::try_from(journal::size(3 * CHUNK, metrics)).expect("small") + more, 0);
        let read = index(&bytes).expect("zeros are nothing").expect("a journal");
        assert_eq!(read.tallies().count(), 2);
        assert!(whole == finish(&campaign, &place.sub("cut"), 2), "{more} more");
    }
    for zeros in [1, 30, 52, 5000] {
        assert!(index(&vec![0; zeros]).expect("zeros are nothing").is_none());
    }
    assert!(index(b"mine").is_err() && index(&[b'm'; 60]).is_err());
}

/// With checksums that are right, as nobody but a forger writes them.
#[test]
fn a_forged_journal_is_refused() {
    let place = Place::new();
    let campaign = place.campaign(&[]);
    let folder = place.sub("one");
    let path = folder.join(JOURNAL);
    let stop = AtomicBool::new(false);
    let drive = drive(&campaign, &folder, &stop);
    for metrics in [1 << 61, u64::MAX] {
        let owner = Owner { metrics, ..drive.owner() };
        Journal::open(&Native, &path, &owner, None).expect("written");
        assert!(Index::read(&path).is_err(), "{metrics} metrics");
    }
    let metrics = campaign.columns().metrics.len();
    for (chunk, flights) in [(0, 63), (99, 64)] {
        let entry = Entry { failure: None, metrics: vec![0.0; metrics] };
        let record = Record::new(chunk, metrics, vec![entry; flights].into_iter()).expect("small");
        let mut journal = Journal::open(&Native, &path, &drive.owner(), None).expect("written");
        journal.append(&record).expect("written");
        let error = drive.fly(&mut |_| {}).expect_err("no such chunk").to_string();
        assert!(error.contains(&format!("its chunk {chunk} is none of this part")), "{error}");
    }
}

/// Also what only the laws believe, and numbers in a file beside the scenario.
#[test]
fn everything_that_a_flight_depends_on_makes_another_campaign() {
    let place = Place::new();
    let plain = place.campaign(&[]).identity();
    assert_eq!(plain["resolved"]["model"]["mass"], 0.625);
    let believed = place.campaign(&["model.mass=0.7"]).identity();
    assert_eq!(believed["resolved"]["model"]["mass"], 0.7);

    let file = place.file.with_file_name("route.csv");
    let route = |height: f64| {
        let text = format!("x,y,z,yaw\n0,0,0,0\n1,0,{height},0\n2,1,1,0\n");
        fs::write(&file, text).expect("a table");
        let shape = "{ shape = \"minimum-snap\", waypoints = ";
        place.campaign(&[&format!("reference={shape} \"{}\" }}", file.display())]).identity()
    };
    let (low, high) = (route(0.5), route(0.6));
    assert_eq!(low["resolved"], high["resolved"]);
    assert_ne!(low["tables"], high["tables"]);

    // A plan that is read may name files that the scenario does not.
    let other = place.file.with_file_name("other.csv");
    fs::copy(&file, &other).expect("a table");
    let reference = format!("reference={{ shape = \"minimum-snap\", waypoints = {file:?} }}");
    let sweep = format!("sweep=[{{ path = \"reference.waypoints\", list = [{file:?}] }}]");
    let mut campaign = place.campaign(&[&reference, &sweep]);
    let plan = format!("index,seed,reference.waypoints\n0,1,{}\n", other.display());
    campaign.replay(&plan).expect("a good plan");
    let identity = campaign.identity();
    let tables = identity["tables"].as_object().expect("tables");
    assert_eq!(tables.len(), 2);
}

/// How an operation fails.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Break {
    Full,
    Short,
    Interrupted,
}

/// A disk whose k-th operation fails.
struct Faulty {
    kind: Break,
    at: u64,
    done: std::sync::Arc<AtomicU64>,
}

impl Faulty {
    fn next(&self) -> io::Result<()> {
        let number = self.done.fetch_add(1, Ordering::SeqCst) + 1;
        if number != self.at {
            return Ok(());
        }
        Err(match self.kind {
            Break::Interrupted => io::ErrorKind::Interrupted.into(),
            _ => io::Error::from_raw_os_error(28),
        })
    }
    fn wrap(&self, file: Box<dyn Sink>) -> Box<dyn Sink> {
        let disk = Self { done: self.done.clone(), ..*self };
        Box::new(FaultyFile { disk, file })
    }
}

impl Disk for Faulty {
    fn create(&self, path: &Path) -> io::Result<Box<dyn Sink>> {
        self.next()?;
        Ok(self.wrap(Native.create(path)?))
    }
    fn append(&self, path: &Path, length: u64) -> io::Result<Box<dyn Sink>> {
        self.next()?;
        Ok(self.wrap(Native.append(path, length)?))
    }
    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        self.next()?;
        Native.rename(from, to)
    }
    fn scratch(&self, folder: &Path) -> io::Result<Box<dyn Scratch>> {
        self.next()?;
        let disk = Self { done: self.done.clone(), ..*self };
        Ok(Box::new(FaultyFile { disk, file: Native.scratch(folder)? }))
    }
}

struct FaultyFile<F: ?Sized> {
    disk: Faulty,
    file: Box<F>,
}

impl<F: Write + ?Sized> Write for FaultyFile<F> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let failed = self.disk.next();
        if failed.is_err() && self.disk.kind == Break::Short {
            // Half of it arrives; what comes after finds the disk full.
            return self.file.write(&bytes[..bytes.len() / 2]).and(failed.map(|()| 0));
        }
        failed?;
        self.file.write(bytes)
    }
    fn flush(&mut self) -> io::Result<()> {
        self.disk.next()?;
        self.file.flush()
    }
}

impl<F: Read + ?Sized> Read for FaultyFile<F> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.disk.next()?;
        self.file.read(bytes)
    }
}

impl<F: Seek + ?Sized> Seek for FaultyFile<F> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.disk.next()?;
        self.file.seek(to)
    }
}

impl Sink for FaultyFile<dyn Sink> {
    fn sync(&mut self) -> io::Result<()> {
        self.disk.next()?;
        self.file.sync()
    }
}

/// Flies with every k-th operation failing once, then resumes; returns how many failures there were.
fn fail_every_operation(step: u64) -> u64 {
    let place = Place::new();
    let campaign = place.campaign(&[]);
    let whole = finish(&campaign, &place.sub("whole"), 2);
    let mut failures = 0;
    for kind in [Break::Full, Break::Short, Break::Interrupted] {
        for at in (1..).step_by(usize::try_from(step).expect("small")) {
            let folder = place.sub(&format!("{kind:?}{at}"));
            let done = std::sync::Arc::new(AtomicU64::new(0));
            let disk = Faulty { kind, at, done: done.clone() };
            let stop = AtomicBool::new(false);
            let begun = files::begin(&disk, &folder, &campaign);
            let flown = begun.and_then(|()| {
                Drive { disk: &disk, ..drive(&campaign, &folder, &stop) }.fly(&mut |_| {})
            });
            let written = flown.and_then(|_| {
                let index = Index::read(&folder.join(JOURNAL))?;
                let parts: Vec<Index> = index.into_iter().collect();
                files::finish(&disk, &folder, &campaign, &parts, campaign.flights())
            });
            let reached = done.load(Ordering::SeqCst) >= at;
            match written {
                Ok(_) if reached => assert_eq!(kind, Break::Interrupted, "operation {at}"),
                Ok(_) => break,
                Err(_) => assert!(reached),
            }
            failures += 1;
            assert!(whole == finish(&campaign, &folder, 2), "{kind:?} at operation {at}");
            fs::remove_dir_all(folder).expect("removed");
        }
    }
    failures
}

#[test]
fn a_failing_disk_loses_nothing() {
    // Debug builds fly slowly.
    let step = if cfg!(debug_assertions) { 40 } else { 5 };
    assert!(fail_every_operation(step) > 3);
}

#[test]
#[ignore = "every operation: run by cargo xtask abuse"]
fn abuse_every_operation_fails_once() {
    println!("operations that failed once: {}", fail_every_operation(1));
}

/// Damages a journal in every way that `step` leaves; returns how many were detected and how many did
/// no harm.
fn damage(step: usize) -> (u64, u64) {
    let place = Place::new();
    let campaign = place.campaign(&["campaign.flights=130", "run.duration=0.05", "run.late=0.01"]);
    let folder = place.sub("good");
    let whole = finish(&campaign, &folder, 1);
    let good = fs::read(folder.join(JOURNAL)).expect("a journal");
    let broken = place.sub("broken");
    let (mut detected, mut harmless) = (0, 0);
    let mut judge = |bytes: &[u8], what: String, resume: bool| {
        fs::write(broken.join(JOURNAL), bytes).expect("written");
        match Index::read(&broken.join(JOURNAL)) {
            Err(_) => detected += 1,
            Ok(index) => {
                harmless += 1;
                let reference = Index::read(&folder.join(JOURNAL)).expect("read").expect("there");
                for chunk in index.iter().flat_map(|i| (0..3).filter(|c| i.has(*c))) {
                    let left = index.as_ref().map(|i| i.chunk(chunk).expect("read"));
                    let right = reference.chunk(chunk).expect("read");
                    assert_eq!(format!("{:?}", left.flatten()), format!("{right:?}"), "{what}");
                }
                if resume {
                    assert!(whole == finish(&campaign, &broken, 1), "{what}");
                }
            }
        }
    };
    for bit in (0..good.len() * 8).step_by(step) {
        let mut bytes = good.clone();
        bytes[bit / 8] ^= 1 << (bit % 8);
        judge(&bytes, format!("bit {bit}"), false);
    }
    for length in (0..good.len()).step_by(step) {
        judge(&good[..length], format!("cut at {length}"), length % (16 * step) == 0);
    }
    (detected, harmless)
}

#[test]
fn a_damaged_journal_is_noticed_or_harmless() {
    let (detected, harmless) = damage(997);
    assert!(detected > 100 && harmless > 10, "{detected} detected, {harmless} harmless");
}

#[test]
#[ignore = "every bit and every length: run by cargo xtask abuse"]
fn abuse_every_bit_flipped_and_every_length_cut() {
    let (detected, harmless) = damage(1);
    println!("journals with one bit flipped or cut: {detected} detected, {harmless} harmless");
}
