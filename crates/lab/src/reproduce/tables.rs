//! The tables of the story, once for terminal and report.

use super::article::TABLE;
use super::sweep::upright_limit;
use super::{Flown, Group, Story};
use crate::page::number;
use crate::sensitivity::STARTS;

/// A table: rows of cells under a head, with what is to be said about it.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// Letter of the section, and title.
    pub title: String,
    /// What the reader should see in it, before the table.
    pub lead: String,
    /// Head cells; the first is above the row labels.
    pub head: Vec<String>,
    /// Rows; the first cell is the label.
    pub rows: Vec<Vec<String>>,
    /// What must be said after it.
    pub notes: Vec<String>,
}

fn cell(flown: &Flown, metric: &str) -> String {
    match &flown.spread {
        None => {
            let value = flown.outcome.get(metric).filter(|value| value.is_finite());
            value.map_or_else(|| "-".into(), number)
        }
        Some(spread) => spread.range(metric).map_or_else(
            || "-".into(),
            |r| format!("{} [{}..{}]", number(r.median), number(r.min), number(r.max)),
        ),
    }
}

/// A row: title, with what happened, and the metrics; a sensitive flight shows its spread.
pub fn row(flown: &Flown, metrics: &[&str]) -> Vec<String> {
    let mut cells = vec![flown.scenario.title.clone()];
    if let Some(spread) = &flown.spread {
        cells[0] += &match spread.failures() {
            0 => " (sensitive)".to_owned(),
            failed => format!(" (sensitive: {failed} of {STARTS} starts fail)"),
        };
    }
    if let Some(failure) = flown.outcome.failure {
        cells[0] += &format!(" (failed at {:.2} s: {})", failure.time, failure.cause.describe());
    }
    cells.extend(metrics.iter().map(|metric| cell(flown, metric)));
    cells
}

fn heads(cells: &[&str]) -> Vec<String> {
    cells.iter().map(|cell| (*cell).to_owned()).collect()
}

/// All tables, in the order of the story.
pub fn tables(story: &Story) -> Vec<Table> {
    let mut all = vec![printed()];
    if let Some(group) = story.group("article/literal") {
        all.push(literal(group));
        all.push(sensitive(group));
    }
    if let Some(group) = story.group("article/consistent") {
        all.push(consistent(group));
    }
    all.push(ladder(story));
    if let Some(group) = story.group("article/literal") {
        all.push(literal_repairs(group));
    }
    if let Some(group) = story.group("article/translational") {
        all.push(translational(group));
    }
    all.push(survival(story));
    all.extend(
        ["article/stress", "article/stress-rotors"]
            .iter()
            .filter_map(|name| story.group(name))
            .map(stress),
    );
    all
}

fn printed() -> Table {
    Table {
        title: "(a) The article's table, and the inequality that every column breaks".into(),
        lead: "For any signal, ISE <= max * IAE. In each printed column the ISE is larger than the other two allow: no flight, however flown, has these numbers.".into(),
        head: heads(&["column", "IAE", "ISE", "max", "ISE/(max IAE)", "least max possible"]),
        rows: TABLE
            .iter()
            .map(|p| {
                vec![
                    format!("{}, {}", p.signal, p.column),
                    number(p.iae),
                    number(p.ise),
                    number(p.max),
                    format!("{:.2} > 1", p.factor()),
                    number(p.implied_max()),
                ]
            })
            .collect(),
        notes: vec![UNITS.into()],
    }
}

const UNITS: &str = "Position in m s, m^2 s, m; attitude in rad s, rad^2 s, rad (Euler-angle norm, against the law's own reference, as in the article).";

const LIKE_THE_ARTICLE: [&str; 6] = [
    "position.iae",
    "position.ise",
    "position.max",
    "attitude.euler.iae",
    "attitude.euler.ise",
    "attitude.euler.max",
];
const LIKE_HEAD: [&str; 7] =
    ["controller", "IAE", "ISE", "max", "att. IAE", "att. ISE", "att. max"];

fn compare(group: &Group, title: &str, lead: &str, variants: &[(&str, &str)]) -> Table {
    let rows = variants.iter().filter_map(|(variant, label)| {
        let mut cells = row(group.get(variant)?, &LIKE_THE_ARTICLE);
        let shown = cells[0].find(" (").map(|at| cells[0][at..].to_owned()).unwrap_or_default();
        cells[0] = format!("{label}{shown}");
        Some(cells)
    });
    Table {
        title: title.into(),
        lead: lead.into(),
        head: heads(&LIKE_HEAD),
        rows: rows.collect(),
        notes: vec![UNITS.into()],
    }
}

fn literal(group: &Group) -> Table {
    let mut table = compare(
        group,
        "(b) Ours, the literal reading",
        "The article's equations, gains and disturbances exactly as printed. With the disturbance every controller tumbles.",
        &[
            ("printed", "proposed"),
            ("pid-indi", "PID + INDI attitude"),
            ("pid-pid", "PID + PID attitude"),
            ("calm", "proposed, calm"),
            ("calm-pid-indi", "PID + INDI, calm"),
            ("calm-pid-pid", "PID + PID, calm"),
        ],
    );
    table.notes.push("Sensitive: moving the start by 1e-9 m moves the result by more than 1 %, so no single number means anything; shown are median [least..largest] of 32 starts within 1e-9 m.".into());
    table.notes.push("Calm, the observer makes the attitude worse, not better as the article has it: explicit Euler chatters.".into());
    table
}

/// What can be said of a sensitive flight besides its spread.
fn sensitive(group: &Group) -> Table {
    let rows = group.flights.iter().filter_map(|flown| {
        let spread = flown.spread.as_ref()?;
        let peak = flown.trace.first_peak.map_or_else(
            || "-".into(),
            |(time, height)| format!("{} m at {time:.2} s", number(height)),
        );
        let inverted = spread.range("tilt.inverted_at").map_or_else(
            || "never".into(),
            |r| format!("{:.3} [{:.3}..{:.3}]", r.median, r.min, r.max),
        );
        Some(vec![flown.scenario.title.clone(), inverted, peak, cell(flown, "thrust.max")])
    });
    Table {
        title: "(b) Sensitive flights: what every start has in common".into(),
        lead: "The first seconds are the same for all starts; after the tilt has passed 90 deg the flights part.".into(),
        head: heads(&["variant", "tilt passes 90 deg (s)", "first peak of |e|", "largest thrust (N)"]),
        rows: rows.collect(),
        notes: Vec::new(),
    }
}

fn consistent(group: &Group) -> Table {
    compare(
        group,
        "(b) Ours, the consistent reading",
        "A hundredth of the printed force, gains for rotors with a lag of 20 ms, the defects repaired: now the numbers are numbers.",
        &[
            ("rate-commanded", "proposed, all repairs"),
            ("single-measured", "proposed, no reference rate"),
            ("pid", "PID + INDI attitude"),
            ("pid-pid", "PID + PID attitude"),
            ("calm", "proposed, calm"),
            ("calm-pid", "PID + INDI, calm"),
            ("calm-pid-pid", "PID + PID, calm"),
        ],
    )
}

fn ladder(story: &Story) -> Table {
    const METRICS: [&str; 4] =
        ["position.iae", "position.max", "position.late_max", "attitude.angle.iae"];
    let (Some(golden), Some(rotors)) =
        (story.group("article/consistent"), story.group("article/rotors"))
    else {
        return Table::default();
    };
    let rows =
        golden.flights.iter().filter(|flown| !flown.variant().starts_with("calm")).map(|flown| {
            let mut cells = row(flown, &METRICS);
            let real = rotors.get(flown.variant());
            cells.extend(
                METRICS.iter().map(|metric| real.map_or_else(|| "-".into(), |f| cell(f, metric))),
            );
            cells
        });
    Table {
        title: "(c) The repair ladder, golden model and real rotors".into(),
        lead: "0.5 N and 0.02 N m. Each repair is visible: half an estimate, wanted against real thrust, two integrators, the missing reference rate (a factor 13 in the late error).".into(),
        head: heads(&["variant", "IAE", "max", "late max", "att. IAE", "rotors: IAE", "max", "late max", "att. IAE"]),
        rows: rows.collect(),
        notes: vec!["Golden model: torque lag of 20 ms, thrust at once, no limits. Rotors: lag on every rotor, 150 to 2917 rad/s, allocation. IAE in m s and rad s, max in m; late: after 10 s. Attitude: rotation angle from the law's own reference.".into()],
    }
}

fn literal_repairs(group: &Group) -> Table {
    const METRICS: [&str; 4] = ["position.iae", "position.max", "position.late_max", "thrust.max"];
    let calm = |flown: &&Flown| !flown.variant().starts_with("calm");
    Table {
        title: "(c) The literal reading, each repair alone and one after the other".into(),
        lead: "Only the geometric attitude ends the tumbling; only then do the other repairs show.".into(),
        head: heads(&["variant", "IAE (m s)", "max (m)", "late max (m)", "largest thrust (N)"]),
        rows: group.flights.iter().filter(calm).map(|flown| row(flown, &METRICS)).collect(),
        notes: vec!["Even repaired, the printed disturbance asks for up to 155 N, 25 times the weight, and for thrust downwards most of the time.".into()],
    }
}

fn translational(group: &Group) -> Table {
    const METRICS: [&str; 4] =
        ["position.iae", "position.ise", "position.max", "position.late_max"];
    Table {
        title: "(c) The position loop alone".into(),
        lead: "The wanted thrust vector acts exactly, so nothing but position law and observer is seen. With L0 = 10 the observer makes the printed case worse than the plain PID.".into(),
        head: heads(&["case", "IAE (m s)", "ISE (m^2 s)", "max (m)", "late max (m)"]),
        rows: group.flights.iter().map(|flown| row(flown, &METRICS)).collect(),
        notes: Vec::new(),
    }
}

fn survival(story: &Story) -> Table {
    let limit = story.flights().next().map_or(0.0, |flown| upright_limit(&flown.scenario));
    let rows = story.survival.iter().map(|s| {
        let plant = if s.name.starts_with("article/rotors") { "rotors" } else { "golden" };
        vec![
            format!("{plant}: {}", s.title),
            number(s.survived),
            s.failed.map_or_else(|| "survives all".into(), |_| s.cause.to_owned()),
            s.observer_limit.map_or_else(|| "-".into(), number),
        ]
    });
    Table {
        title: "(d) The largest disturbance that each variant survives".into(),
        lead: format!("Force amplitude raised until the flight leaves 5 m or tilts past 90 deg. Beyond {limit:.2} N no upright flight can hold the force at all."),
        head: heads(&["variant", "survives (N)", "then fails by", "L valid to (N)"]),
        rows: rows.collect(),
        notes: vec!["L valid to: the amplitude up to which the observer's bound L covers the slope of the disturbance, L m/sqrt 2; above it the estimate cannot follow.".into()],
    }
}

fn stress(group: &Group) -> Table {
    const METRICS: [&str; 5] =
        ["position.iae", "position.max", "position.late_max", "thrust.max", "saturation.share"];
    Table {
        title: format!("(d) {}", capital(&group.title)),
        lead: group.about.clone(),
        head: heads(&[
            "variant",
            "IAE",
            "max",
            "late max",
            "largest thrust (N)",
            "saturated share",
        ]),
        rows: group.flights.iter().map(|flown| row(flown, &METRICS)).collect(),
        notes: Vec::new(),
    }
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
