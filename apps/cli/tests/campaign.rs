//! Campaigns as a user runs, interrupts and kills them.
#![cfg(unix)]
#![allow(clippy::expect_used, clippy::print_stdout)] // a test fails by panicking, and prints its figures

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use tempfile::TempDir;

const FILE: &str = r#"
run                = { duration = 2.0, control_step = 0.001, substeps = 1, seed = 3, late = 1.0 }
vehicle            = { model = "article-corrected" }
model              = { mass = 0.625 }
reference          = { shape = "helix" }
position           = { law = "pid" }
observer           = { law = "hosm" }
attitude_reference = { law = "rotation" }
attitude           = { law = "tilt-priority" }
rate               = { law = "indi" }
actuation          = { kind = "rotors" }
failure            = { position_error = 0.3, allowed = true }
campaign           = { flights = 2000, metrics = "position" }
[[sweep]]
path    = "vehicle.mass"
uniform = [0.4, 1.2]
[[sweep]]
path        = "vehicle.motor_lag"
log_uniform = [0.005, 0.2]
"#;

struct Bench {
    folder: TempDir,
}

impl Bench {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("c.toml"), FILE).expect("a file");
        Self { folder }
    }
    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }
    fn command(&self, out: &str, more: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_stormpetrel"));
        command.args(["sweep", "c.toml", "--quiet", "--out", out]).args(more);
        command.current_dir(self.folder.path()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }
    fn start(&self, out: &str, more: &[&str]) -> Child {
        self.command(out, more).spawn().expect("the program starts")
    }
    fn run(&self, out: &str, more: &[&str]) -> Output {
        self.command(out, more).output().expect("the program starts")
    }
    /// Results, summary and report of a finished campaign.
    fn results(&self, out: &str) -> Vec<Vec<u8>> {
        ["results.parquet", "summary.json", "report.html"]
            .map(|name| fs::read(self.path(out).join(name)).expect(name))
            .to_vec()
    }
}

fn signal(child: &Child, name: &str) {
    let sent = Command::new("kill").args([name, &child.id().to_string()]).status();
    assert!(sent.expect("kill exists").success());
}

fn message(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Kills campaigns at random moments until `kills` are reached, resuming each until it is complete.
fn kill_and_resume(kills: u32) -> (u32, u32) {
    let bench = Bench::new();
    let begin = Instant::now();
    assert!(bench.run("whole", &[]).status.success());
    let whole = bench.results("whole");
    let longest = begin.elapsed().as_secs_f64();
    let (mut killed, mut complete, mut state) = (0, 0, 0x9E37_79B9_7F4A_7C15_u64);
    while killed < kills {
        let out = format!("killed{complete}");
        loop {
            let begun = bench.path(&out).join("campaign.json").exists();
            let mut child = bench.start(&out, if begun { &["--resume"] } else { &[] });
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let share = (state >> 33) as f64 / 2_147_483_648.0;
            std::thread::sleep(Duration::from_secs_f64(share * longest));
            if child.try_wait().expect("waits").is_none() && killed < kills {
                signal(&child, "-KILL");
                killed += 1;
            }
            let status = child.wait_with_output().expect("ended");
            if status.status.success() {
                break;
            }
            assert!(status.status.code().is_none(), "{}", message(&status));
        }
        complete += 1;
        assert!(whole == bench.results(&out), "after {killed} kills");
        fs::remove_dir_all(bench.path(&out)).expect("removed");
    }
    (killed, complete)
}

#[test]
fn a_killed_campaign_goes_on_to_the_same_files() {
    // Debug builds fly slowly: one kill is enough there.
    kill_and_resume(if cfg!(debug_assertions) { 1 } else { 6 });
}

#[test]
#[ignore = "200 kills: run by cargo xtask abuse"]
fn abuse_two_hundred_kills() {
    let (killed, complete) = kill_and_resume(200);
    println!("{killed} kills, {complete} campaigns complete, all with the same bytes");
}

#[test]
fn an_interrupt_ends_in_order_and_can_be_resumed() {
    let bench = Bench::new();
    let child = bench.start("stopped", &["--set", "campaign.flights=200000"]);
    let journal = bench.path("stopped").join("journal.bin");
    let flown = |path: &Path| fs::metadata(path).is_ok_and(|meta| meta.len() > 1000);
    let begin = Instant::now();
    while !flown(&journal) && begin.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(5));
    }
    signal(&child, "-INT");
    let asked = Instant::now();
    let output = child.wait_with_output().expect("ended");
    assert_eq!(output.status.code(), Some(130), "{}", message(&output));
    assert!(message(&output).contains("--resume goes on"), "{}", message(&output));
    if !cfg!(debug_assertions) {
        assert!(asked.elapsed() < Duration::from_secs(5), "an orderly end is quick");
    }
    assert!(!bench.path("stopped").join("results.parquet").exists());
    // A narrow answer is reached soon after: what was flown counts.
    let more = ["--set", "campaign.flights=200000", "--resume", "--until-interval", "0.2"];
    let output = bench.run("stopped", &more);
    assert!(output.status.success(), "{}", message(&output));
}

#[test]
fn what_cannot_be_flown_is_refused_with_advice() {
    let bench = Bench::new();
    fs::write(
        bench.path("plain.toml"),
        FILE.split("[[sweep]]").next().expect("a head").replace("campaign ", "# "),
    )
    .expect("a file");
    let grid = r#"sweep=[{ path = "vehicle.mass", grid = [0.5, 0.7, 300] }]"#;
    let cases: [(&[&str], &str); 13] = [
        (
            &["--until-interval", "0.1", "--set", "campaign.flights=0", "--set", grid],
            "grids and lists are counted through",
        ),
        (&["--set", "sweep.0.path=run.seed"], "`run.seed` cannot be swept"),
        (&["--set", "campaign.flights=1e12"], "must lie in 0 to 1e8"),
        (&["--set", "campaign.flights=1e8", "--set", "run.duration=1e4"], "would take"),
        (&["--shard", "9/8"], "must be I/N"),
        (&["--threads", "2000"], "1..=1024"),
        (&["--until-interval", "2"], "must lie between 0 and 1"),
        (&["--logs", "best=3"], "worst=K"),
        (&["--resume"], "there is no campaign to resume"),
        (&["--set", "sweep.0.path=vehicle.mas"], "sweep `vehicle.mas`"),
        (&["--set", "sweep.0.uniform=[0.0, 0.5]"], "must lie in 0.001 to 100 kg"),
        (&["--set", "sweep.0.uniform=[1, 0]"], "1 is not below 0"),
        (
            &["--set", "sweep.0.path=run.substeps", "--set", "sweep.0.uniform=[1, 4]"],
            "sweep `run.substeps` at 2.1",
        ),
    ];
    for (more, expected) in cases {
        let begin = Instant::now();
        let output = bench.run("refused", more);
        assert_eq!(output.status.code(), Some(2), "{more:?}: {}", message(&output));
        assert!(message(&output).contains(expected), "{more:?}: {}", message(&output));
        if !cfg!(debug_assertions) {
            assert!(begin.elapsed() < Duration::from_secs(2), "{more:?} is refused at once");
        }
        assert!(!bench.path("refused").exists(), "{more:?} leaves nothing");
    }
}

/// Short flights, in so many parts that one can be missing.
const SHORT: [&str; 6] =
    ["--set", "campaign.flights=130", "--set", "run.duration=0.02", "--set", "run.late=0.01"];

#[test]
fn flights_of_another_campaign_or_version_are_not_mixed_in() {
    let bench = Bench::new();
    assert!(bench.run("one", &SHORT).status.success());
    let whole = bench.results("one");
    let resume = |more: &[&str]| {
        let output = bench.run("one", &[&SHORT[..], &["--resume"], more].concat());
        (output.status.code(), message(&output))
    };
    for other in ["model.mass=0.7", "model.gravity=9.7", "vehicle.mass=0.6", "run.seed=9"] {
        let (code, message) = resume(&["--set", other]);
        assert!(
            code == Some(2) && message.contains("holds another campaign"),
            "{other}: {message}"
        );
    }
    assert_eq!(resume(&[]), (Some(0), String::new()));
    let about = bench.path("one").join("campaign.json");
    let text = fs::read_to_string(&about).expect("a description");
    let version = format!("\"version\": \"{}\"", env!("CARGO_PKG_VERSION"));
    assert!(text.contains(&version));
    fs::write(&about, text.replace(&version, "\"version\": \"9.9.9\"")).expect("written");
    let (code, message) = resume(&[]);
    assert!(code == Some(2) && message.contains("begun by stormpetrel 9.9.9 ("), "{message}");
    assert!(bench.results("one") == whole, "nothing was touched");
}

/// A setting that is read as another quantity, or not at all, would make a campaign about something else.
#[test]
fn settings_that_would_be_lost_are_refused() {
    let bench = Bench::new();
    assert!(bench.run("drawn", &SHORT).status.success());
    let plan = fs::read_to_string(bench.path("drawn/plan.csv")).expect("a plan");
    let row = plan.lines().nth(9).expect("ten lines");
    fs::write(bench.path("spaced.csv"), plan.replace(row, &row.replacen(',', ", ", 2)))
        .expect("written");
    let deep = format!("sweep=[{{ path = \"vehicle{}\", uniform = [1, 2] }}]", ".a".repeat(20_000));
    let cases: [(&[&str], &str); 9] = [
        (&["--plan", "spaced.csv"], "spaced.csv: line 10: seed ` "),
        (&["--set", "sweep.0.path=campaign.flights"], "it changes no flight"),
        (&["--set", "sweep.0.path=run.log_every"], "it changes no flight"),
        (&["--set", "sweep.0.path=vehicle..mass"], "`vehicle..mass` is not a dotted path"),
        (&["--set", &deep], "20001 parts"),
        (&["--set", "sweep.1.path=vehicle.mass"], "`vehicle.mass` is swept twice"),
        (
            &["--set", "sweep.0.path=[\"vehicle.inertia.x\", \"vehicle.inertia.0\"]"],
            "`vehicle.inertia.0` is swept twice",
        ),
        (
            &["--set", "sweep.0.path=timing.jitter", "--set", "sweep.0.relative=true"],
            "no factor changes it",
        ),
        (&["--set", "vehicle.mass=0.6\nvehicle.motor_lag=0.1"], "one setting at a time"),
    ];
    for (more, expected) in cases {
        let output = bench.run("refused", &[&SHORT[..], more].concat());
        assert_eq!(output.status.code(), Some(2), "{expected}: {}", message(&output));
        assert!(message(&output).contains(expected), "{expected}: {}", message(&output));
        assert!(!bench.path("refused").exists());
    }
}

/// The journal says for itself whose it is, also where nothing else is left.
#[test]
fn a_journal_alone_is_gone_on_with_by_its_own_campaign_only() {
    let bench = Bench::new();
    let run = |out: &str, more: &[&str]| {
        let output = bench.run(out, &[&SHORT[..], more].concat());
        (output.status.code(), message(&output))
    };
    assert_eq!(run("one", &[]).0, Some(0));
    let (whole, about) = (bench.results("one"), bench.path("one").join("campaign.json"));
    fs::write(&about, "").expect("written");
    let (code, message) = run("one", &["--resume"]);
    assert!(code == Some(2) && message.contains("campaign.json: EOF"), "{message}");
    assert!(message.contains("remove it and give the same command, without --resume"), "{message}");
    fs::remove_file(&about).expect("removed");
    for (more, wanted) in [
        (["--set", "run.seed=9"], "journal.bin: belongs to another campaign"),
        (["--shard", "1/2"], "journal.bin: holds this campaign as a whole"),
    ] {
        let (code, message) = run("one", &more);
        assert!(code == Some(2) && message.contains(wanted), "{message}");
        assert!(!about.exists(), "the folder was claimed");
    }
    assert_eq!(run("one", &[]), (Some(0), String::new()));
    assert!(bench.results("one") == whole);
    assert_eq!(run("part", &["--shard", "1/2"]).0, Some(0));
    for more in [&["--shard", "2/2"][..], &["--shard", "2/2", "--resume"], &["--resume"]] {
        let (code, message) = run("part", more);
        assert!(code == Some(2) && message.contains("--shard 1/2 to go on"), "{message}");
    }
}

#[test]
fn a_file_that_cannot_be_used_is_named() {
    let bench = Bench::new();
    for name in ["campaign.json", "journal.bin", "plan.csv.part", "results.parquet"] {
        fs::create_dir_all(bench.path("one").join(name)).expect("a folder");
        let output = bench.run("one", &SHORT);
        let message = message(&output);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(&format!("one/{name}: ")), "{message}");
        fs::remove_dir(bench.path("one").join(name)).expect("still empty");
        let _ = fs::remove_file(bench.path("one").join("campaign.json"));
    }
}

#[test]
fn a_merge_writes_over_no_other_campaign() {
    let bench = Bench::new();
    for (out, shard) in [("first", "1/2"), ("second", "2/2")] {
        assert!(bench.run(out, &[&SHORT[..], &["--shard", shard]].concat()).status.success());
    }
    assert!(bench.run("whole", &SHORT).status.success());
    assert!(bench.run("other", &[&SHORT[..], &["--set", "run.seed=4"]].concat()).status.success());
    let other = bench.results("other");
    let merge = |out: &str, parts: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_stormpetrel"));
        command.args(["merge", "c.toml", "--quiet", "--out", out]).args(SHORT).args(parts);
        let output = command.current_dir(bench.folder.path()).output().expect("the program starts");
        (output.status.code(), message(&output))
    };
    let (code, message) = merge("other", &["first", "second"]);
    assert!(code == Some(2) && message.contains("holds another campaign"), "{message}");
    let (code, message) = merge("joined", &["first"]);
    assert!(code == Some(2) && message.contains("flights 64 to 127 are missing"), "{message}");
    assert!(message.contains("give the folders of all parts"), "{message}");
    assert!(!bench.path("joined").exists() && bench.results("other") == other);
    fs::remove_file(bench.path("other").join("campaign.json")).expect("removed");
    let (code, message) = merge("other", &["first", "second"]);
    assert!(code == Some(2) && message.contains("belongs to another campaign"), "{message}");
    assert!(bench.results("other") == other && !bench.path("other/campaign.json").exists());
    for _ in 0..2 {
        assert_eq!(merge("joined", &["first", "second"]), (Some(0), String::new()));
        assert!(bench.results("joined")[..2] == bench.results("whole")[..2]);
    }
}

/// Each input alone makes a flight at its extremes; together they may make a body that cannot be.
#[test]
fn a_plan_with_a_flight_that_cannot_be_is_refused_before_the_first_one() {
    let bench = Bench::new();
    let inertia = |deviation: &str| {
        let axis = |axis: &str| {
            format!("{{ path = \"vehicle.inertia.{axis}\", normal = [2.6e-3, {deviation}] }}")
        };
        format!("sweep=[{}, {}]", axis("x"), axis("z"))
    };
    let (wide, narrow) = (inertia("5e-4"), inertia("3.5e-4"));
    let more = [&SHORT[..], &["--set", "campaign.flights=2000", "--set", &wide]].concat();
    let refused = [["--threads", "1"], ["--threads", "2"]].map(|threads| {
        let output = bench.run("refused", &[&more[..], &threads].concat());
        assert_eq!(output.status.code(), Some(2), "{}", message(&output));
        assert!(!bench.path("refused").exists());
        message(&output)
    });
    assert!(refused[0].contains("of the plan: `vehicle.inertia` = ["), "{}", refused[0]);
    assert!(refused[0].contains("one moment exceeds the sum"), "{}", refused[0]);
    assert_eq!(refused[0], refused[1]);
    // Extremes divide the duration, a value of the grid between them does not.
    let steps = r#"sweep=[{ path = "run.control_step", grid = [0.001, 0.004, 4] }, { path = "vehicle.mass", grid = [0.5, 0.7, 32] }]"#;
    let more = [&SHORT[..], &["--set", "campaign.flights=0", "--set", steps]].concat();
    let output = bench.run("refused", &more);
    assert_eq!(output.status.code(), Some(2), "{}", message(&output));
    assert!(message(&output).contains("flight 64 of the plan"), "{}", message(&output));
    assert!(!bench.path("refused").exists());
    // Whole numbers of a grid stay whole.
    let steps = r#"sweep=[{ path = "run.substeps", grid = [1, 10, 10] }]"#;
    let more = [&SHORT[..], &["--set", "campaign.flights=0", "--set", steps]].concat();
    let output = bench.run("whole", &more);
    assert!(output.status.success(), "{}", message(&output));
    // At four deviations in both directions there is no such body, but no flight of this plan is there.
    let output = bench.run("flown", &[&SHORT[..], &["--set", &narrow]].concat());
    assert!(output.status.success(), "{}", message(&output));
}

#[test]
fn a_plan_that_someone_changed_is_written_again() {
    let bench = Bench::new();
    assert!(bench.run("one", &SHORT).status.success());
    let plan = bench.path("one").join("plan.csv");
    let written = fs::read(&plan).expect("a plan");
    fs::write(&plan, "mine").expect("written");
    let again = bench.run("one", &[&SHORT[..], &["--resume"]].concat());
    assert!(again.status.success() && fs::read(&plan).expect("a plan") == written);
}

/// A plan that was written can be flown again: what are names stays names, and the report says how.
#[test]
fn a_plan_of_names_is_flown_again() {
    let bench = Bench::new();
    let forces = r#"sweep=[{ path = "disturbance.0.force", list = ["0.5", "[1, 0, 0]"] }]"#;
    let common = ["--set", "disturbance=[{ kind = \"harmonic\" }]", "--set", forces];
    let more = [&SHORT[..], &common].concat();
    let first = bench.run("first", &more);
    assert!(first.status.success(), "{}", message(&first));
    let again = bench.run("again", &[&more[..], &["--plan", "first/plan.csv"]].concat());
    assert!(again.status.success(), "{}", message(&again));
    let plan = |out: &str| fs::read(bench.path(out).join("plan.csv")).expect("a plan");
    assert!(plan("first") == plan("again"));
    let report = fs::read_to_string(bench.path("again").join("report.html")).expect("a report");
    assert!(report.contains("--plan first/plan.csv"));
    // A shell takes each setting for one word.
    assert!(report.contains("--set 'disturbance=[{ kind = "));
    let named = bench.run("named", &[&more[..], &["--set", "sweep.0.name=seed"]].concat());
    let message = message(&named);
    assert!(
        named.status.code() == Some(2) && message.contains("cannot head a column"),
        "{message}"
    );
}

#[test]
fn whole_numbers_and_rows_without_a_correlation_are_told_plainly() {
    let bench = Bench::new();
    let substeps = ["--set", "sweep.0.path=run.substeps", "--set", "sweep.0.uniform=[1, 4]"];
    let refused = message(&bench.run("refused", &substeps));
    assert!(refused.contains("c.toml:14:1") && !refused.contains("--set:"), "{refused}");
    assert!(refused.contains("with `list` or `grid`"), "{refused}");
    assert!(
        !message(&bench.run("refused", &["--set", "sweep.0.uniform=[1, 0]"])).contains("has 0")
    );

    let mut few = Command::new(env!("CARGO_BIN_EXE_stormpetrel"));
    few.args(["sweep", "c.toml", "--out", "good", "--set", "campaign.flights=20"]);
    few.args(["--set", "failure.position_error=100"]).current_dir(bench.folder.path());
    let output = few.output().expect("the program starts");
    let shown = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success() && !shown.contains("NaN"), "{shown}");
    let success = shown.lines().find(|line| line.contains("success")).expect("a row");
    assert!(success.split_whitespace().any(|word| word == "-"), "{success}");
}

#[test]
fn two_processes_do_not_share_a_campaign() {
    let bench = Bench::new();
    let child = bench.start("shared", &["--set", "campaign.flights=200000"]);
    let begin = Instant::now();
    while !bench.path("shared").join("journal.bin").exists() && begin.elapsed().as_secs() < 60 {
        std::thread::sleep(Duration::from_millis(5));
    }
    let second = bench.run("shared", &["--set", "campaign.flights=200000", "--resume"]);
    assert_eq!(second.status.code(), Some(2));
    assert!(
        message(&second).contains("another process flies this campaign"),
        "{}",
        message(&second)
    );
    signal(&child, "-INT");
    assert_eq!(child.wait_with_output().expect("ended").status.code(), Some(130));
}
