//! What is known of a campaign before its first flight: whether every flight can be built, and how long
//! all of them take.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::drive::{Drive, built, rows};
use super::plan::Campaign;
use crate::fly::fly_batch;
use crate::scenario::Scenario;
use crate::scenario::fault::Faults;

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
        let found = std::thread::scope(|scope| {
            let threads: Vec<_> = (0..self.threads).map(|_| scope.spawn(first_of_thread)).collect();
            let found = threads.into_iter().filter_map(|thread| thread.join().ok()?);
            found.min_by_key(|(index, _)| *index)
        });
        found.map_or(Ok(()), |(_, faults)| Err(faults))
    }
}

/// Wall time of a campaign on so many threads, reckoned from eight of its flights over at most 2,000 ticks.
///
/// # Errors
/// Where one of these flights cannot be built.
pub fn estimate(campaign: &Campaign, flights: u64, threads: usize) -> Result<Duration, Faults> {
    const TICKS: f64 = 2000.0;
    let mut scenarios = Vec::new();
    for index in 0..if flights < 8 { flights } else { 8 } {
        let mut scenario = built(campaign, index)?;
        let longest = TICKS * scenario.run.control_step;
        if scenario.run.duration > longest {
            scenario.run.duration = longest;
        }
        scenarios.push(scenario);
    }
    let ticks: u64 = scenarios.iter().map(Scenario::ticks).sum();
    // What the first times wait for, such as memory, a campaign does not wait for again.
    let times = (0..4).map(|_| {
        let begin = Instant::now();
        fly_batch(&scenarios);
        begin.elapsed()
    });
    let time = times.min().unwrap_or_default().as_secs_f64();
    let per_tick = time / if ticks > 0 { ticks as f64 } else { 1.0 };
    let whole = flights as f64 * campaign.scenario.ticks() as f64 * per_tick / threads as f64;
    // Ten thousand years are enough to say no.
    let seconds = if whole < 3e11 { whole } else { 3e11 };
    Ok(Duration::from_secs_f64(seconds))
}
