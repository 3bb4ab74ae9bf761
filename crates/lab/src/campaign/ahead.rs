//! What is known of a campaign before its first flight: whether every flight can be built, and how long
//! all of them take.

use std::io;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use stormpetrel_control::real::Real;

use super::drive::{Drive, rows};
use super::journal::{CHUNK, Record};
use super::plan::Campaign;
use super::worker::{Worker, built, start};
use crate::fly::LANES;
use crate::scenario::fault::{Fault, Faults};

impl Drive<'_> {
    /// Builds every flight of this part of the plan; `watch` is told how many are done.
    ///
    /// Nothing is built where all combinations of the inputs' extreme values, and of all those of grids and
    /// lists, make a flight: what forbids one, such as moments of inertia that no body has, mostly grows or
    /// falls with each input, and what lies between is taken to make a flight too.
    ///
    /// # Errors
    /// The first flight that cannot be built.
    pub fn check(&self, watch: &(dyn Fn(u64) + Sync)) -> Result<(), Faults> {
        if self.campaign.corners_fly() {
            return Ok(());
        }
        let waiting = Mutex::new(self.chunks());
        let (done, bad) = (AtomicU64::new(0), AtomicBool::new(false));
        let next = || {
            let mut waiting = waiting.lock().unwrap_or_else(PoisonError::into_inner);
            // Chunks are handed out in their order and looked at to their end: those before a bad one are.
            waiting.next().filter(|_| !bad.load(Ordering::Relaxed))
        };
        let first_of_thread = || -> Option<(u64, Faults)> {
            while let Some(chunk) = next() {
                let rows = rows(self.campaign, chunk);
                for index in rows.clone() {
                    if let Err(faults) = built(self.campaign, index) {
                        bad.store(true, Ordering::Relaxed);
                        return Some((index, faults));
                    }
                }
                let count = rows.end - rows.start;
                watch(done.fetch_add(count, Ordering::Relaxed) + count);
            }
            None
        };
        std::thread::scope(|scope| {
            let threads =
                start(scope, self.threads, first_of_thread).map_err(|error| no_thread(&error))?;
            // A flight that breaks the program is told when its turn comes.
            let found = threads.into_iter().filter_map(|thread| thread.join().ok()?);
            found.min_by_key(|(index, _)| *index).map_or(Ok(()), |(_, faults)| Err(faults))
        })
    }
}

/// What a campaign will take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Wall time.
    pub time: Duration,
    /// Ticks of the shortest and of the longest flight, of those that were looked at.
    pub ticks: (u64, u64),
}

/// What so many flights will take on so many threads, reckoned from a chunk of flights from all over the plan:
/// all threads fly it at once, as they will share the machine then. A flight that fails late ends sooner.
///
/// # Errors
/// Where one of these flights cannot be built, or no thread can be started.
pub fn estimate(campaign: &Campaign, flights: u64, threads: usize) -> Result<Estimate, Faults> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    // More threads than cores take turns.
    let threads = threads.clamp(1, cores);
    let paces = std::thread::scope(|scope| {
        let threads =
            start(scope, threads, || pace(campaign)).map_err(|error| no_thread(&error))?;
        // A flight that breaks the program is told when its turn comes.
        threads.into_iter().filter_map(|thread| thread.join().ok()).collect::<Result<Vec<_>, _>>()
    })?;
    let slowest = paces.iter().map(|pace| pace.0).fold(0.0, Real::max);
    // A thread takes whole chunks, and lanes take their time full or not.
    let chunks = flights.div_ceil(CHUNK).div_ceil(threads as u64);
    let lanes = (if flights < CHUNK { flights } else { CHUNK }).next_multiple_of(LANES as u64);
    let whole = slowest * chunks as f64 * (lanes as f64 / CHUNK as f64);
    // Ten thousand years are enough to say no.
    let time = Duration::from_secs_f64(if whole < 3e11 { whole } else { 3e11 });
    Ok(Estimate { time, ticks: paces.first().map_or((0, 0), |pace| pace.1) })
}

fn no_thread(error: &io::Error) -> Faults {
    Fault::general(format!("no thread could be started: {error}")).into()
}

/// Time for a chunk (s), and the ticks of its shortest and its longest flight.
type Pace = (f64, (u64, u64));

/// Flies a chunk for a few milliseconds, at most 500 ticks: the last of these tell how time grows with ticks.
fn pace(campaign: &Campaign) -> Result<Pace, Faults> {
    const ENOUGH: f64 = 5e-3;
    let mut worker = Worker::new(campaign);
    // What the first time waits for, such as memory, a campaign does not wait for again.
    let mut faster_of_two = |most: u64| -> Result<(f64, Cut), Faults> {
        let (first, _) = fly_cut(campaign, most, &mut worker)?;
        let (second, cut) = fly_cut(campaign, most, &mut worker)?;
        Ok((Real::min(first, second), cut))
    };
    let (one, mut cut) = faster_of_two(1)?;
    let (mut time, mut slope) = (one, 0.0);
    for most in [8, 64, 500] {
        if time > one + ENOUGH || cut.flown == cut.whole {
            break;
        }
        let (longer, next) = faster_of_two(most)?;
        slope = Real::max(0.0, (longer - time) / (next.flown - cut.flown) as f64);
        (time, cut) = (longer, next);
    }
    Ok((time + slope * (cut.whole - cut.flown) as f64, cut.ticks))
}

/// Ticks of flights that were cut short.
struct Cut {
    /// Ticks to which they were cut, of all together.
    flown: u64,
    /// Ticks that they have, of all together.
    whole: u64,
    /// Ticks of the shortest and of the longest.
    ticks: (u64, u64),
}

/// Builds flights from all over the plan, flies them for at most so many ticks, and makes a record of them;
/// time in s.
fn fly_cut(campaign: &Campaign, most: u64, worker: &mut Worker<'_>) -> Result<(f64, Cut), Faults> {
    let begin = Instant::now();
    let mut cut = Cut { flown: 0, whole: 0, ticks: (u64::MAX, 0) };
    let flights = (0..CHUNK).map(|at| {
        // Some come twice where there are fewer: a chunk is full but for the last.
        let mut flight = built(campaign, at * campaign.flights() / CHUNK)?;
        let ticks = flight.ticks();
        let flown = ticks.min(most);
        cut.flown += flown;
        cut.whole += ticks;
        cut.ticks = (cut.ticks.0.min(ticks), cut.ticks.1.max(ticks));
        flight.run.duration = flown as f64 * flight.run.control_step;
        Ok(flight)
    });
    let entries = worker.fly(flights)?;
    let record = Record::new(0, campaign.columns().metrics.len(), entries);
    drop(std::hint::black_box(record));
    Ok((begin.elapsed().as_secs_f64(), cut))
}
