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

/// Wall time of a campaign on so many threads, reckoned from its first chunk: all threads fly it at once, as
/// they will share the machine then.
///
/// # Errors
/// Where one of these flights cannot be built.
pub fn estimate(campaign: &Campaign, flights: u64, threads: usize) -> Result<Duration, Faults> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    // More threads than cores take turns.
    let threads = threads.clamp(1, cores);
    let times = std::thread::scope(|scope| {
        let threads =
            start(scope, threads, || time_of_chunk(campaign)).map_err(|error| no_thread(&error))?;
        // A flight that breaks the program is told when its turn comes.
        threads.into_iter().filter_map(|thread| thread.join().ok()).collect::<Result<Vec<_>, _>>()
    })?;
    let slowest = times.into_iter().fold(0.0, Real::max);
    // A thread takes whole chunks, and lanes take their time full or not.
    let chunks = flights.div_ceil(CHUNK).div_ceil(threads as u64);
    let lanes = (if flights < CHUNK { flights } else { CHUNK }).next_multiple_of(LANES as u64);
    let whole = slowest * chunks as f64 * (lanes as f64 / CHUNK as f64);
    // Ten thousand years are enough to say no.
    Ok(Duration::from_secs_f64(if whole < 3e11 { whole } else { 3e11 }))
}

fn no_thread(error: &io::Error) -> Faults {
    Fault::general(format!("no thread could be started: {error}")).into()
}

/// Time for the first chunk (s). It is flown for a few milliseconds, at most 500 ticks: what they take beyond
/// the first grows with their number.
fn time_of_chunk(campaign: &Campaign) -> Result<f64, Faults> {
    const ENOUGH: f64 = 5e-3;
    let ticks = campaign.scenario.ticks() as f64;
    let mut worker = Worker::new(campaign);
    // What the first times wait for, such as memory, a campaign does not wait for again.
    let mut faster_of_two = |ticks: f64| -> Result<f64, Faults> {
        let mut fastest = f64::INFINITY;
        for _ in 0..2 {
            let begin = Instant::now();
            fly_cut(campaign, ticks, &mut worker)?;
            fastest = Real::min(fastest, begin.elapsed().as_secs_f64());
        }
        Ok(fastest)
    };
    let one = faster_of_two(1.0)?;
    let (mut flown, mut all) = (1.0, one);
    while all < one + ENOUGH && flown < Real::min(ticks, 500.0) {
        flown = Real::min(8.0 * flown, Real::min(ticks, 500.0));
        all = faster_of_two(flown)?;
    }
    Ok(if flown > 1.0 { one + (all - one) * (ticks - 1.0) / (flown - 1.0) } else { one })
}

/// Builds and flies the first chunk to so many ticks.
fn fly_cut(campaign: &Campaign, ticks: f64, worker: &mut Worker<'_>) -> Result<(), Faults> {
    // The first ones again where there are fewer: a chunk is full but for the last.
    let indices = (0..campaign.flights()).cycle().zip(0..CHUNK);
    let flights = indices.map(|(index, _)| {
        let mut flight = built(campaign, index)?;
        flight.run.duration = Real::min(flight.run.duration, ticks * flight.run.control_step);
        Ok(flight)
    });
    let entries = worker.fly(flights)?;
    // A record of what is flown is part of the work.
    let _ = Record::new(0, campaign.columns().metrics.len(), entries);
    Ok(())
}
