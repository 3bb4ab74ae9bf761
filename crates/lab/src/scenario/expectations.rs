//! Whether what a scenario expects can be met at all.

use crate::metric::{names, of_attitude};

use super::Scenario;
use super::expect::{Expectation, Rule};
use super::fault::Fault;
use super::read::{scientific, unknown};

/// Every expectation must name a metric that the flight has.
pub(super) fn check(scenario: &Scenario, broken: &[&str], faults: &mut Vec<Fault>) {
    let all = scenario.has_attitude() || broken.contains(&"actuation");
    let known = names().iter().map(String::as_str).filter(|name| all || !of_attitude(name));
    let known: Vec<&str> = known.collect();
    for expectation in &scenario.expect {
        let name = expectation.metric.as_str();
        if !known.contains(&name) {
            faults.push(unknown(&expectation.place, "metric", name, name, &known));
        } else if !broken.contains(&"run") {
            faults.extend(impossible(expectation, scenario));
        }
    }
}

/// What is wrong with an expectation that no flight can meet.
fn impossible(expectation: &Expectation, scenario: &Scenario) -> Option<Fault> {
    let (name, run) = (expectation.metric.as_str(), &scenario.run);
    let fault = |message: String| Fault::new(&expectation.place, message);
    if name.ends_with(".late_max") && run.late >= run.duration {
        let (late, duration) = (scientific(run.late), scientific(run.duration));
        let message =
            format!("`expect.{name}`: no sample after run.late = {late} s in {duration} s");
        return Some(fault(message).help("lower run.late or raise run.duration"));
    }
    let (least, most) = bounds(name, run.duration);
    if expectation.possible(least, most) {
        return None;
    }
    let bound = match expectation.rule {
        Rule::Min(_) => format!("never more than {}", scientific(most)),
        Rule::Max(_) => format!("never less than {}", scientific(least)),
        Rule::Within { .. } => {
            format!("never outside {} to {}", scientific(least), scientific(most))
        }
    };
    let message =
        format!("`expect.{name}` must be {}: the metric is {bound}", expectation.describe());
    Some(fault(message).help("no flight can meet it: correct the number"))
}

/// Least and greatest value that a metric can have.
fn bounds(name: &str, duration: f64) -> (f64, f64) {
    match name {
        "estimate.lag" => (f64::NEG_INFINITY, f64::INFINITY),
        "saturation.share" => (0.0, 1.0),
        "time.flown" | "tilt.inverted_at" => (0.0, duration),
        _ => (0.0, f64::INFINITY),
    }
}
