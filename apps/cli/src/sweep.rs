//! `sweep` and `merge`: campaigns.

use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use indicatif::ProgressBar;
use stormpetrel_lab::campaign::ahead::estimate;
use stormpetrel_lab::campaign::disk::Native;
use stormpetrel_lab::campaign::drive::{Drive, End, JOURNAL, Progress, identity};
use stormpetrel_lab::campaign::files::{self, Held};
use stormpetrel_lab::campaign::journal::Index;
use stormpetrel_lab::campaign::plan::Campaign;
use stormpetrel_lab::campaign::summary::{Summary, wilson};
use stormpetrel_lab::reproduce::Table;
use stormpetrel_lab::scenario::fault::{Fault, Faults};

use crate::args::{Common, Merge, Plan, Sweep};
use crate::{Failure, terminal};

/// Longest campaign that is begun: a month.
const LONGEST: Duration = Duration::from_secs(30 * 24 * 3600);

/// Flies a campaign, or goes on with it.
pub fn sweep(args: &Sweep, common: &Common) -> Result<(), Failure> {
    let campaign = load(&args.plan)?;
    let shard = shard(args.shard.as_deref())?;
    let until = until(args.until_interval, &campaign)?;
    let logs = args.logs.iter().map(|text| Which::read(text)).collect::<Result<Vec<_>, _>>()?;
    let broken = |error: io::Error| Failure::out(&args.out, &error);
    let drive = Drive {
        campaign: &campaign,
        folder: &args.out,
        disk: &Native,
        threads: args.threads.map_or_else(cores, usize::from),
        shard,
        until,
        stop: &terminal::STOP,
    };
    announce(&drive, args, common)?;
    let held = files::holds(&args.out, &campaign).map_err(broken)?;
    allowed(&held, args.resume, &args.out)?;
    if held == Held::Nothing {
        check(&drive, common)?;
    }
    fs::create_dir_all(&args.out).map_err(broken)?;
    let _lock = lock(&args.out)?;
    // Resumed, the plan is written once more: someone may have changed it.
    files::begin(&Native, &args.out, &campaign).map_err(broken)?;
    terminal::ORDERLY.store(true, Ordering::Relaxed);
    let end = fly(&drive, common).map_err(broken)?;
    let End::Complete(flights) = end else {
        terminal::warn("stopped; what is flown is kept: the same command with --resume goes on");
        return Err(Failure::Interrupted);
    };
    if shard.1 > 1 {
        say(
            common,
            &format!(
                "part {}/{} is flown; `stormpetrel merge` joins the parts",
                shard.0 + 1,
                shard.1
            ),
        );
        return Ok(());
    }
    let index = Index::read(&args.out.join(JOURNAL)).map_err(broken)?;
    let parts: Vec<Index> = index.into_iter().collect();
    conclude(&campaign, &args.plan, &args.out, &parts, flights, common)?;
    refly(&campaign, &args.out, &parts, flights, &logs).map_err(broken)
}

/// Joins the parts of a campaign.
pub fn merge(args: &Merge, common: &Common) -> Result<(), Failure> {
    let campaign = load(&args.plan)?;
    let mut parts = Vec::new();
    for folder in &args.parts {
        let broken = |error: io::Error| Failure::file(folder, &error);
        let index = Index::read(&folder.join(JOURNAL)).map_err(broken)?;
        let Some(index) = index else {
            return Err(input(
                format!("{}: no campaign has been flown here", folder.display()),
                "",
            ));
        };
        if let Held::OfVersion(version) = files::holds(folder, &campaign).map_err(broken)? {
            return Err(of_version(folder, &version));
        }
        if index.owner().identity != identity(&campaign) {
            let message = format!("{}: part of another campaign", folder.display());
            return Err(input(
                message,
                "give the same file, --variant, --set and --plan as to `sweep`",
            ));
        }
        parts.push(index);
    }
    let advice = "give the folders of all parts; `sweep --resume` finishes one that was stopped";
    files::complete(&campaign, &parts).map_err(|error| input(error.to_string(), advice))?;
    let broken = |error: io::Error| Failure::out(&args.out, &error);
    let held = files::holds(&args.out, &campaign).map_err(broken)?;
    // The parts may be joined again, and in the folder of one of them.
    allowed(&held, held == Held::This, &args.out)?;
    fs::create_dir_all(&args.out).map_err(broken)?;
    let _lock = lock(&args.out)?;
    if held == Held::Nothing {
        files::begin(&Native, &args.out, &campaign).map_err(broken)?;
    }
    conclude(&campaign, &args.plan, &args.out, &parts, campaign.flights(), common)
}

fn load(plan: &Plan) -> Result<Campaign, Failure> {
    let mut campaign = Campaign::load(&plan.file, &plan.sets, plan.variant.as_deref())?;
    if let Some(path) = &plan.drawn {
        let text = fs::read_to_string(path).map_err(|error| Failure::file(path, &error))?;
        campaign.replay(&text).map_err(|message| {
            input(
                format!("{}: {message}", path.display()),
                "a plan is what `sweep` writes as plan.csv",
            )
        })?;
    }
    if campaign.sweeps.is_empty() {
        let message = format!("{}: nothing is varied", plan.file.display());
        return Err(input(message, "add a [[sweep]] table; `stormpetrel sweep --help` shows one"));
    }
    Ok(campaign)
}

fn input(message: String, help: &str) -> Failure {
    let fault = Fault::general(message);
    Faults::from(if help.is_empty() { fault } else { fault.help(help) }).into()
}

fn shard(text: Option<&str>) -> Result<(u64, u64), Failure> {
    let Some(text) = text else { return Ok((0, 1)) };
    let number = |text: &str| text.parse::<u64>().ok();
    match text.split_once('/').and_then(|(i, n)| number(i).zip(number(n))) {
        Some((i, n)) if 1 <= i && i <= n && n <= 100_000 => Ok((i - 1, n)),
        _ => Err(input(
            format!("--shard {text}: must be I/N with 1 <= I <= N <= 100000"),
            "the third of eight parts is --shard 3/8",
        )),
    }
}

fn until(width: Option<f64>, campaign: &Campaign) -> Result<Option<f64>, Failure> {
    match width {
        Some(_) if campaign.counts_through() => Err(input(
            "--until-interval: grids and lists are counted through, and their first flights stand for no others".into(),
            "draw the inputs, or ask for more flights than there are combinations",
        )),
        Some(width) if !(width > 0.0 && width < 1.0) => Err(input(
            format!("--until-interval {width}: must lie between 0 and 1"),
            "0.01 stops when the success probability is known to within one per cent",
        )),
        other => Ok(other),
    }
}

fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Says what the campaign will take; refuses what nobody would wait for.
fn announce(drive: &Drive<'_>, args: &Sweep, common: &Common) -> Result<(), Failure> {
    let Drive { campaign, threads, .. } = *drive;
    let flights = drive.flights();
    let estimate = estimate(campaign, flights, threads)?;
    let ticks = campaign.scenario.ticks();
    let time = duration(estimate);
    if estimate > LONGEST {
        let message =
            format!("{flights} flights of {ticks} ticks would take {time} on {threads} threads");
        return Err(input(
            message,
            "fly fewer or shorter flights, or parts of the plan with --shard",
        ));
    }
    let (bytes, most) = files::size(flights, &campaign.columns());
    let size = bytes as f64 / 1e6;
    if let Some(free) = free(&args.out).filter(|free| *free < most && !args.resume) {
        let message = format!(
            "{}: {flights} flights need {:.0} MB, {:.0} MB are free",
            args.out.display(),
            most as f64 / 1e6,
            free as f64 / 1e6
        );
        return Err(input(message, "give an --out on another disk, or fly fewer flights"));
    }
    say(
        common,
        &format!(
            "{flights} flights of {ticks} ticks on {threads} threads: about {time}, {size:.1} MB on disk"
        ),
    );
    Ok(())
}

/// Bytes that are free where the folder is or will be; `None` where the system does not say.
fn free(out: &Path) -> Option<u64> {
    let there = out.ancestors().find(|folder| folder.exists()).unwrap_or(Path::new("."));
    fs4::available_space(there).ok()
}

fn duration(time: Duration) -> String {
    let seconds = time.as_secs_f64();
    match seconds {
        s if s < 90.0 => format!("{s:.0} s"),
        s if s < 5400.0 => format!("{:.0} min", s / 60.0),
        s if s < 172_800.0 => format!("{:.1} h", s / 3600.0),
        s if s < 3e7 => format!("{:.0} days", s / 86_400.0),
        s => format!("{:.0} years", s / 3.156e7),
    }
}

fn say(common: &Common, text: &str) {
    if !common.quiet && !common.json {
        terminal::say(text);
    }
}

/// Whether the folder may be used.
fn allowed(held: &Held, resume: bool, out: &Path) -> Result<(), Failure> {
    let shown = out.display();
    match (held, resume) {
        (Held::Nothing, true) => Err(input(
            format!("{shown}: there is no campaign to resume"),
            "leave out --resume to begin one",
        )),
        (Held::Another, _) => Err(input(
            format!("{shown}: holds another campaign"),
            "give another --out; to resume, give the same file, --variant, --set and --plan as before",
        )),
        (Held::OfVersion(version), _) => Err(of_version(out, version)),
        (Held::This, false) => Err(input(
            format!("{shown}: this campaign was begun here before"),
            "--resume goes on with it; another --out begins it again",
        )),
        _ => Ok(()),
    }
}

fn of_version(folder: &Path, version: &str) -> Failure {
    let message = format!("{}: begun by stormpetrel {version}", folder.display());
    let help = "another version may fly to other bits: go on with that one, or begin again with another --out";
    input(message, help)
}

/// Keeps every other process out of the folder while it lives.
fn lock(folder: &Path) -> Result<File, Failure> {
    let path: PathBuf = folder.join(".lock");
    let broken = |error: io::Error| Failure::out(&path, &error);
    let file = File::create(&path).map_err(broken)?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(input(
            format!("{}: another process flies this campaign", folder.display()),
            "wait for it, or give another --out",
        )),
        Err(TryLockError::Error(error)) => Err(broken(error)),
    }
}

/// Builds every flight where that is in doubt.
fn check(drive: &Drive<'_>, common: &Common) -> Result<(), Faults> {
    let bar = terminal::progress("checking the plan", common.quiet || common.json);
    bar.set_length(drive.flights());
    let checked = drive.check(&|done| bar.set_position(done));
    bar.finish_and_clear();
    checked
}

/// Flies with a bar that tells rate, failures and the success probability so far.
fn fly(drive: &Drive<'_>, common: &Common) -> io::Result<End> {
    let bar = terminal::progress("flying", common.quiet || common.json);
    terminal::with_rate(&bar);
    let begin = Instant::now();
    let end = drive.fly(&mut |progress| tell(&bar, progress, begin));
    bar.finish_and_clear();
    end
}

fn tell(bar: &ProgressBar, progress: &Progress, begin: Instant) {
    bar.set_length(progress.flights);
    bar.set_position(progress.done.flown);
    let rate = (progress.flown_now + 1) as f64 / (begin.elapsed().as_secs_f64() + 1e-3);
    let rest = Duration::from_secs_f64((progress.flights - progress.done.flown) as f64 / rate);
    let interval = wilson(progress.done.good, progress.done.flown);
    bar.set_message(format!(
        "{rate:.0}/s, {} left, {} failed, success {:.4} to {:.4}",
        duration(rest),
        progress.done.flown - progress.done.good,
        interval.low,
        interval.high
    ));
}

/// Writes results, summary and report, and prints the answer.
fn conclude(
    campaign: &Campaign,
    plan: &Plan,
    out: &Path,
    parts: &[Index],
    flights: u64,
    common: &Common,
) -> Result<(), Failure> {
    let broken = |error: io::Error| Failure::out(out, &error);
    let summary = files::finish(&Native, out, campaign, parts, flights).map_err(broken)?;
    let command = |sets: &[String]| command("run", plan, sets);
    let mut again = self::command("sweep", plan, &[]);
    if let Some(path) = &plan.drawn {
        again += &format!(" --plan {}", word(&path.to_string_lossy()));
    }
    files::report(&Native, out, campaign, &summary, &command, &again).map_err(broken)?;
    if common.json {
        return terminal::print_json(&files::summary_json(campaign, &summary));
    }
    if !common.quiet {
        print(campaign, &summary, &command, out);
    }
    Ok(())
}

/// The command that flies the file with these settings again.
fn command(what: &str, plan: &Plan, sets: &[String]) -> String {
    let mut words = vec![format!("stormpetrel {what}"), word(&plan.file.to_string_lossy())];
    words.extend(plan.variant.iter().map(|variant| format!("--variant {}", word(variant))));
    words.extend(plan.sets.iter().chain(sets).map(|set| format!("--set {}", word(set))));
    words.join(" ")
}

/// As a shell takes it for one word.
fn word(text: &str) -> String {
    let plain = |letter: char| letter.is_ascii_alphanumeric() || "_-./=:,+@%".contains(letter);
    if !text.is_empty() && text.chars().all(plain) {
        text.to_owned()
    } else {
        format!("'{}'", text.replace('\'', "'\\''"))
    }
}

fn print(
    campaign: &Campaign,
    summary: &Summary,
    command: &dyn Fn(&[String]) -> String,
    out: &Path,
) {
    let (share, interval) = summary.success();
    terminal::say(&format!(
        "{} of {} flights succeeded: {:.2} %, 95 % interval {:.2} to {:.2} %",
        summary.flown(),
        summary.flights(),
        100.0 * share,
        100.0 * interval.low,
        100.0 * interval.high
    ));
    for (cause, count) in summary.failures() {
        terminal::say(&format!("  {count} failed: {}", cause.describe()));
    }
    let rows = summary.correlations().iter().map(|c| {
        // One of the two never changes: no correlation.
        let rank = if c.rank.is_finite() { format!("{:+.3}", c.rank) } else { "-".into() };
        vec![c.input.clone(), c.with.to_owned(), rank, c.flights.to_string()]
    });
    let table = Table {
        title: "What goes with what (Spearman's rank correlation)".into(),
        head: ["input", "with", "rank", "flights"].map(str::to_owned).to_vec(),
        rows: rows.collect(),
        ..Table::default()
    };
    terminal::print_table(&table, terminal::width());
    if let Some(worst) = summary.worst().first() {
        terminal::say("\nworst flight, to fly it again:");
        terminal::say(&format!("  {}", command(&campaign.sets(&worst.inputs, worst.seed))));
    }
    let written = [files::RESULTS, files::SUMMARY, files::PLAN, files::REPORT].join(", ");
    terminal::say(&format!("\nwritten to {}: {written}", out.display()));
}

/// Flights that are flown again with a log.
enum Which {
    Worst(usize),
    Median,
    Failures(usize),
    Every(u64),
}

impl Which {
    fn read(text: &str) -> Result<Self, Failure> {
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
fn refly(
    campaign: &Campaign,
    out: &Path,
    parts: &[Index],
    flights: u64,
    logs: &[Which],
) -> io::Result<()> {
    if logs.is_empty() {
        return Ok(());
    }
    for index in chosen(campaign, parts, flights, logs)? {
        let scenario = campaign
            .flight(&campaign.inputs(index), campaign.seed(index))
            .map_err(|faults| io::Error::other(faults.to_string()))?;
        let folder = stormpetrel_lab::output::Folder::new(&out.join(format!("flights/{index}")))?;
        crate::run::fly_into(&folder, "", scenario, &ProgressBar::hidden())?;
        folder.publish()?;
    }
    Ok(())
}

fn chosen(
    campaign: &Campaign,
    parts: &[Index],
    flights: u64,
    logs: &[Which],
) -> io::Result<std::collections::BTreeSet<u64>> {
    let mut summary = Summary::new(&campaign.columns(), files::WORST);
    let mut failed = Vec::new();
    files::each_row(campaign, parts, flights, &mut |row| {
        summary.push(row);
        if row.failure.is_some() && failed.len() < 1000 {
            failed.push(row.index);
        }
        Ok(())
    })?;
    let mut chosen = std::collections::BTreeSet::new();
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
