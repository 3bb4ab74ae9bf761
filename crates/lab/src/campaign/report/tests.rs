//! A report of a made-up campaign.

use super::*;
use crate::campaign::random::{key, unit};
use crate::fly::Failure;
use stormpetrel_control::real::Real;
use stormpetrel_plant::flight::Cause;

fn drawn(index: u64, stream: u64) -> f64 {
    unit(key(stream, index))
}

fn columns() -> Columns {
    Columns {
        inputs: texts(&["wind.speed", "vehicle.mass", "delay", "stack.rate"]),
        metrics: texts(&["position.iae", "position.max", "attitude.angle.iae"]),
    }
}

/// Wind of up to 15 m/s fails more often than not, mass matters a little, the delay by its logarithm.
fn row(index: u64) -> Row {
    let (wind, mass) = (15.0 * drawn(index, 0), 0.8 + 0.4 * drawn(index, 1));
    let delay = 1e-4 * Real::exp(6.0 * drawn(index, 2));
    let noise = drawn(index, 3);
    let load = wind * wind / 225.0 + 0.3 * (mass - 0.8) + 8.0 * delay + 0.3 * noise;
    let failure = (load > 1.0).then(|| Failure {
        time: 12.0 / load,
        cause: if noise > 0.4 { Cause::PositionError } else { Cause::Tilt },
    });
    let score = 0.05 * Real::exp(5.0 * load) * (0.5 + noise);
    let law = if index.is_multiple_of(2) { "rate/pid" } else { "rate/indi" };
    Row {
        index,
        seed: index.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 12,
        inputs: vec![
            Input::Number(wind),
            Input::Number(mass),
            Input::Number(delay),
            Input::Text(law.into()),
        ],
        failure,
        metrics: vec![score, 0.3 * score.sqrt() + 0.1 * noise, 0.2 + 0.1 * noise + 0.05 * wind],
    }
}

fn page(flights: u64) -> String {
    let mut summary = Summary::new(&columns(), 8);
    (0..flights).for_each(|index| summary.push(&row(index)));
    let inputs = [
        ("wind.speed", "uniform from 0 to 15"),
        ("vehicle.mass", "uniform from 0.8 to 1.2"),
        ("delay", "log-uniform from 1e-4 to 0.04"),
        ("stack.rate", "rate/pid, rate/indi"),
    ]
    .map(|(name, text)| (name.to_owned(), text.to_owned()));
    let command = |row: &Row| {
        format!(
            "stormpetrel run scenarios/gusts.toml --set run.seed={} --set wind.speed={:?}",
            row.seed,
            match row.inputs[0] {
                Input::Number(x) => x,
                Input::Text(_) => 0.0,
            }
        )
    };
    let worst: Vec<_> = summary.worst().iter().map(|r| (r.clone(), command(r))).collect();
    html(&Story {
        title: "Hover in gusts <robustness>",
        about: "How much wind a hovering vehicle withstands, with mass and delay uncertain.",
        scenario: "gusts",
        inputs: &inputs,
        units: &texts(&["m/s", "kg", "s"]),
        summary: &summary,
        median: Some("stormpetrel run scenarios/gusts.toml --set run.seed=11"),
        worst: &worst,
        command: "stormpetrel campaign scenarios/gusts.toml --out results/gusts",
    })
}

#[test]
fn the_page_tells_the_whole_story() {
    let page = page(3000);
    for wanted in [
        "<h1>Hover in gusts &lt;robustness&gt;</h1>",
        "<td>m/s</td><td>uniform from 0 to 15</td>",
        "of the flights were flown to their end",
        "position error beyond its limit",
        "Distribution of position.iae",
        ">position.iae (m s)<",
        ">attitude.angle.iae (rad s)<",
        ">wind.speed (m/s)<",
        "rate/indi",
        "--set run.seed=",
        "with the median position.iae is number",
        "<pre>stormpetrel run scenarios/gusts.toml --set run.seed=11</pre>",
        "stormpetrel campaign scenarios/gusts.toml",
    ] {
        assert!(page.contains(wanted), "{wanted}");
    }
    assert!(!page.contains("NaN") && !page.contains("<script") && !page.contains("href"));
    assert_eq!(page.matches("<svg").count(), 6);
    // The strongest input comes first.
    let place = |name: &str| page.find(&format!("<h3><code>{name}</code></h3>"));
    assert!(place("wind.speed") < place("vehicle.mass"));
}

#[test]
fn the_page_stays_small() {
    let page = page(100_000);
    assert!(page.len() < 400_000, "{}", page.len());
    assert!(page.contains("flights, one in 8, chosen by their index"));
}

#[test]
fn odd_campaigns_have_a_page_too() {
    assert!(page(0).contains("Nothing has been flown."));
    assert!(!page(1).contains("NaN"));
    let mut summary = Summary::new(&columns(), 2);
    let failed = Failure { time: 0.0, cause: Cause::NonFinite };
    (0..4).for_each(|i| {
        summary.push(&Row { failure: Some(failed), metrics: vec![f64::NAN; 3], ..row(i) });
    });
    let story = Story {
        title: "",
        about: "",
        scenario: "",
        inputs: &[],
        units: &[],
        summary: &summary,
        median: None,
        worst: &[],
        command: "",
    };
    assert!(html(&story).contains("0 %") && !html(&story).contains("NaN"));
}

#[test]
fn shares_have_the_digits_that_are_known() {
    let shown = |flown, flights| {
        let interval = wilson(flown, flights);
        (percent(flown as f64 / flights as f64, interval), range(interval))
    };
    assert_eq!(shown(27, 30), ("90 %".into(), "74 % to 97 %".into()));
    assert_eq!(shown(2578, 3000), ("85.9 %".into(), "84.6 % to 87.1 %".into()));
    assert_eq!(shown(99_988, 100_000), ("99.988 %".into(), "99.979 % to 99.993 %".into()));
    assert_eq!(shown(50, 50), ("100 %".into(), "92.9 % to 100 %".into()));
}
