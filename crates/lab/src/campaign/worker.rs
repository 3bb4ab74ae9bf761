//! One thread of a campaign: it builds the flights of a chunk, flies them, and makes a record of them.

use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::thread::{Builder, Scope, ScopedJoinHandle};

use stormpetrel_plant::dispatch::Width;

use super::drive::rows;
use super::journal::{Entry, Record};
use super::plan::{Campaign, Metrics};
use super::result::Columns;
use crate::fly::{Outcome, Workspace};
use crate::scenario::Scenario;
use crate::scenario::fault::{Fault, Faults};

/// A thread, with the memory that it keeps from chunk to chunk.
pub(super) struct Worker<'a> {
    campaign: &'a Campaign,
    columns: Columns,
    scenarios: Vec<Scenario>,
    workspace: Workspace,
}

impl<'a> Worker<'a> {
    /// A thread of this campaign.
    pub fn new(campaign: &'a Campaign) -> Self {
        let (scenarios, workspace) = (Vec::new(), Workspace::default());
        Self { campaign, columns: campaign.columns(), scenarios, workspace }
    }

    /// Flies a chunk. A flight that breaks the program is told by its numbers.
    ///
    /// # Errors
    /// The [`Faults`] of the first flight that cannot be built; a flight that broke the program.
    pub fn fly_chunk(&mut self, chunk: u64) -> io::Result<Record> {
        let rows = rows(self.campaign, chunk);
        let flown = catch_unwind(AssertUnwindSafe(|| {
            let campaign = self.campaign;
            let flights = rows.clone().map(|index| built(campaign, index));
            let refused = |faults| io::Error::new(io::ErrorKind::InvalidInput, faults);
            Record::new(chunk, self.columns.metrics.len(), self.fly(flights).map_err(refused)?)
        }));
        flown.unwrap_or_else(|_| {
            Err(io::Error::other(format!(
                "a flight from {} to {} broke the program: please report the campaign file and these numbers",
                rows.start,
                rows.end - 1
            )))
        })
    }

    /// Flies these flights with the metrics that the campaign asks for.
    ///
    /// # Errors
    /// Where one of them could not be built.
    pub fn fly(
        &mut self,
        flights: impl Iterator<Item = Result<Scenario, Faults>>,
    ) -> Result<impl ExactSizeIterator<Item = Entry>, Faults> {
        self.scenarios.clear();
        for flight in flights {
            self.scenarios.push(flight?);
        }
        let attitude = self.campaign.choices.metrics == Metrics::All;
        let outcomes = self.workspace.fly(&self.scenarios, Width::widest(), attitude);
        self.scenarios.clear();
        Ok(outcomes.into_iter().map(|outcome| entry(&outcome, &self.columns)))
    }
}

/// Starts so many threads, or as many as the system gives: at least one.
///
/// # Errors
/// Where there is not even one.
pub(super) fn start<'scope, T: Send + 'scope>(
    scope: &'scope Scope<'scope, '_>,
    threads: usize,
    work: impl FnOnce() -> T + Clone + Send + 'scope,
) -> io::Result<Vec<ScopedJoinHandle<'scope, T>>> {
    let mut started = Vec::new();
    for _ in 0..threads {
        match Builder::new().spawn_scoped(scope, work.clone()) {
            Ok(thread) => started.push(thread),
            Err(error) if started.is_empty() => return Err(error),
            Err(_) => break,
        }
    }
    Ok(started)
}

/// A flight of the plan.
///
/// # Errors
/// What is wrong with it, with its number.
pub(super) fn built(campaign: &Campaign, index: u64) -> Result<Scenario, Faults> {
    let flight = campaign.flight(&campaign.inputs(index), campaign.seed(index));
    flight.map_err(|Faults(faults)| {
        let told = |fault: Fault| {
            let message = format!("flight {index} of the plan: {}", fault.message);
            Fault { message, ..fault }
        };
        Faults(faults.into_iter().map(told).collect())
    })
}

fn entry(outcome: &Outcome, columns: &Columns) -> Entry {
    // Both are in the order of `metric::names`, so the next is mostly the one that is looked for.
    let mut next = outcome.metrics.iter().peekable();
    let value = |name: &String| {
        let found = next.next_if(|(known, _)| known == name).map(|(_, value)| *value);
        found.or_else(|| outcome.get(name)).unwrap_or(f64::NAN)
    };
    let metrics = columns.metrics.iter();
    Entry { failure: outcome.failure, metrics: metrics.map(value).collect() }
}
