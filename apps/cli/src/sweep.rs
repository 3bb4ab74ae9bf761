//! `sweep` and `merge`: campaigns.

mod answer;
mod logs;

use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use indicatif::ProgressBar;
use serde_json::json;
use stormpetrel_lab::campaign::ahead::{Estimate, estimate};
use stormpetrel_lab::campaign::disk::Native;
use stormpetrel_lab::campaign::drive::{Drive, End, JOURNAL, Progress, claim, identity};
use stormpetrel_lab::campaign::files::{self, Held};
use stormpetrel_lab::campaign::journal::Index;
use stormpetrel_lab::campaign::plan::Campaign;
use stormpetrel_lab::campaign::summary::wilson;
use stormpetrel_lab::scenario::fault::{Fault, Faults};

use answer::conclude;
use logs::{Which, refly};

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
    if ask(&drive, args)? == Held::Nothing {
        check(&drive, common)?;
    }
    fs::create_dir_all(&args.out).map_err(broken)?;
    let _lock = lock(&args.out)?;
    // Somebody may have been faster.
    ask(&drive, args)?;
    terminal::ORDERLY.store(true, Ordering::Relaxed);
    // Resumed, the plan is written once more: someone may have changed it.
    files::begin(&Native, &args.out, &campaign).map_err(broken)?;
    let end = fly(&drive, common).map_err(|error| unflown(Failure::out(&args.out, &error)))?;
    let End::Complete(flights) = end else {
        terminal::warn("stopped; what is flown is kept: the same command with --resume goes on");
        return Err(Failure::Interrupted);
    };
    if shard.1 > 1 && common.json {
        let part = format!("{}/{}", shard.0 + 1, shard.1);
        return terminal::print_json(&json!({ "part": part, "flights": flights }));
    }
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
    let parts = || -> Result<Vec<Index>, Failure> {
        Ok(Index::read(&args.out.join(JOURNAL)).map_err(broken)?.into_iter().collect())
    };
    conclude(&campaign, &args.plan, &args.out, parts()?, flights, common)?;
    if logs.is_empty() {
        return Ok(());
    }
    refly(&campaign, &args.out, &parts()?, flights, &logs)
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
    let may = || {
        let held = files::holds(&args.out, &campaign).map_err(broken)?;
        // The parts may be joined again, and in the folder of one of them.
        allowed(&held, held == Held::This, &args.out)?;
        claim(&args.out, &campaign).map_err(broken).map(|()| held)
    };
    may()?;
    fs::create_dir_all(&args.out).map_err(broken)?;
    let _lock = lock(&args.out)?;
    // Somebody may have been faster.
    if may()? == Held::Nothing {
        files::begin(&Native, &args.out, &campaign).map_err(broken)?;
    }
    conclude(&campaign, &args.plan, &args.out, parts, campaign.flights(), common)
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
    let left = if args.resume { drive.left() } else { flights };
    let Estimate { time, ticks } = estimate(campaign, left, threads)?;
    let long = time > LONGEST;
    let (ticks, time) = (span(ticks), duration(time));
    if long {
        let message =
            format!("{left} flights of {ticks} ticks would take {time} on {threads} threads");
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
    let rest = if left < flights { format!(", {left} left") } else { String::new() };
    say(common, &format!("{flights} flights of {ticks} ticks{rest}, on {threads} threads:"));
    say(common, &format!("about {time} if no flight fails, {size:.1} MB on disk"));
    Ok(())
}

/// `50`, or `50 to 1000`.
fn span((low, high): (u64, u64)) -> String {
    if low == high { low.to_string() } else { format!("{low} to {high}") }
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

/// What the folder holds, where it may be used.
fn ask(drive: &Drive<'_>, args: &Sweep) -> Result<Held, Failure> {
    let broken = |error: io::Error| Failure::out(&args.out, &error);
    let held = files::holds(&args.out, drive.campaign).map_err(broken)?;
    if matches!(held, Held::Nothing | Held::This) {
        drive.claim().map_err(broken)?;
    }
    allowed(&held, args.resume, &args.out).map(|()| held)
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
    // Not cut to nothing: it may be a link.
    let file = File::options().create(true).append(true).open(&path).map_err(broken)?;
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

/// What to do with a campaign of which a flight could not be built, when others were flown already.
fn unflown(failure: Failure) -> Failure {
    let Failure::Faults(Faults(mut faults)) = failure else { return failure };
    if let Some(last) = faults.last_mut() {
        let help =
            "mend the file so that every draw makes a flight, and begin anew in another --out";
        last.help =
            Some(last.help.take().map_or_else(|| help.into(), |known| format!("{known}; {help}")));
    }
    Failure::Faults(Faults(faults))
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
    if bar.is_hidden() {
        return;
    }
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
