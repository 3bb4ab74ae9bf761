//! Flights of a campaign that are flown again with a log.

use std::collections::BTreeSet;
use std::io;
use std::path::Path;
use std::sync::atomic::Ordering;

use indicatif::ProgressBar;
use stormpetrel_lab::campaign::files;
use stormpetrel_lab::campaign::journal::Index;
use stormpetrel_lab::campaign::plan::Campaign;
use stormpetrel_lab::campaign::summary::Summary;
use stormpetrel_lab::output::Folder;

use super::input;
use crate::{Failure, terminal};

/// Flights that are flown again with a log.
pub(super) enum Which {
    Worst(usize),
    Median,
    Failures(usize),
    Every(u64),
}

impl Which {
    /// Reads the argument.
    ///
    /// # Errors
    /// Where it is none of them.
    pub fn read(text: &str) -> Result<Self, Failure> {
        let (name, number) = text.split_once('=').map_or((text, None), |(n, k)| (n, Some(k)));
        let count = number.and_then(|k| k.parse::<usize>().ok()).filter(|k| (1..=1000).contains(k));
        match (name, number.is_some(), count) {
            ("worst", true, Some(k)) if k <= files::WORST => Ok(Self::Worst(k)),
            ("median", false, _) => Ok(Self::Median),
            ("failures", true, Some(k)) => Ok(Self::Failures(k)),
            ("every", true, Some(k)) => Ok(Self::Every(k as u64)),
            _ => Err(input(
                format!("--logs {text}: unknown"),
                "worst=K with K up to 10, median, failures=K or every=K with K up to 1000",
            )),
        }
    }
}

/// Flies the chosen flights again, each into a folder of its own with log and figures.
pub(super) fn refly(
    campaign: &Campaign,
    out: &Path,
    parts: &[Index],
    flights: u64,
    logs: &[Which],
) -> Result<(), Failure> {
    let broken = |error: io::Error| Failure::out(out, &error);
    for index in chosen(campaign, parts, flights, logs).map_err(broken)? {
        if terminal::STOP.load(Ordering::Relaxed) {
            terminal::warn(
                "stopped before all logs were written: the same command with --resume writes them",
            );
            return Err(Failure::Interrupted);
        }
        let scenario = campaign.flight(&campaign.inputs(index), campaign.seed(index))?;
        let folder = Folder::new(&out.join(format!("flights/{index}"))).map_err(broken)?;
        crate::run::fly_into(&folder, "", scenario, &ProgressBar::hidden()).map_err(broken)?;
        folder.publish().map_err(broken)?;
    }
    Ok(())
}

fn chosen(
    campaign: &Campaign,
    parts: &[Index],
    flights: u64,
    logs: &[Which],
) -> io::Result<BTreeSet<u64>> {
    let mut summary = Summary::new(&campaign.columns(), files::WORST);
    let mut failed = Vec::new();
    files::each_row(campaign, parts, flights, &mut |row| {
        summary.push(row);
        if row.failure.is_some() && failed.len() < 1000 {
            failed.push(row.index);
        }
        Ok(())
    })?;
    let mut chosen = BTreeSet::new();
    for which in logs {
        match which {
            Which::Worst(k) => chosen.extend(summary.worst().iter().take(*k).map(|row| row.index)),
            Which::Median => chosen.extend(summary.median().map(|row| row.index)),
            Which::Failures(k) => chosen.extend(failed.iter().take(*k)),
            Which::Every(k) => {
                chosen.extend((0..flights).step_by(usize::try_from(*k).unwrap_or(1)));
            }
        }
    }
    Ok(chosen)
}
