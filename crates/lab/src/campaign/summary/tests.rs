//! Summaries of made-up campaigns.

use super::*;
use crate::campaign::result::Input;
use crate::fly::Failure;

fn columns() -> Columns {
    Columns {
        inputs: vec!["wind".into(), "law".into()],
        metrics: vec!["position.iae".into(), "position.max".into()],
    }
}

fn row(index: u64, wind: f64, score: f64) -> Row {
    let inputs = vec![Input::Number(wind), Input::Text("rate/pid".into())];
    Row { index, seed: index, inputs, failure: None, metrics: vec![score, -score] }
}

fn failed(index: u64, time: f64, cause: Cause) -> Row {
    Row { failure: Some(Failure { time, cause }), ..row(index, 9.0, 0.01) }
}

fn summary(rows: &[Row], worst: usize) -> Summary {
    let mut summary = Summary::new(&columns(), worst);
    for row in rows {
        summary.push(row);
    }
    summary
}

fn indices(rows: &[Row]) -> Vec<u64> {
    rows.iter().map(|row| row.index).collect()
}

#[test]
fn failed_flights_are_the_worst_and_the_earliest_of_them_the_very_worst() {
    let rows = [
        row(0, 1.0, 5.0),
        failed(1, 3.0, Cause::Tilt),
        row(2, 1.0, 7.0),
        failed(3, 2.0, Cause::Ground),
        failed(4, 3.0, Cause::Tilt),
        row(5, 1.0, 7.0),
        row(6, 1.0, f64::NAN),
    ];
    assert_eq!(indices(summary(&rows, 9).worst()), [3, 1, 4, 2, 5, 0, 6]);
    assert_eq!(indices(summary(&rows, 4).worst()), [3, 1, 4, 2]);
    assert!(summary(&rows, 0).worst().is_empty());
}

#[test]
fn flights_are_counted_by_what_became_of_them() {
    let rows = [
        row(0, 1.0, 5.0),
        failed(1, 3.0, Cause::Ground),
        failed(2, 3.0, Cause::Tilt),
        failed(3, 3.0, Cause::Tilt),
    ];
    let summary = summary(&rows, 1);
    assert_eq!((summary.flights(), summary.flown()), (4, 1));
    assert_eq!(summary.failures(), [(Cause::Tilt, 2), (Cause::Ground, 1)]);
    let (share, interval) = summary.success();
    assert!((share - 0.25).abs() < 1e-15);
    assert_eq!(interval, wilson(1, 4));
}

#[test]
fn the_median_flight_is_one_that_was_flown() {
    let mut rows: Vec<Row> = (0..7).map(|i| row(i, 1.0, (i * 3 % 7) as f64)).collect();
    rows.extend((7..20).map(|i| failed(i, 1.0, Cause::Tilt)));
    // Scores 0 3 6 2 5 1 4.
    assert_eq!(summary(&rows, 0).median().map(|row| row.index), Some(1));
    assert_eq!(summary(&rows[..6], 0).median().map(|row| row.index), Some(3));
    assert!(summary(&[], 3).median().is_none());
}

#[test]
fn correlations_are_of_numbers_and_leave_cut_off_flights_out() {
    let mut rows: Vec<Row> = (0..8).map(|i| row(i, i as f64, (i * i) as f64)).collect();
    // Its score is small because it ended early: counted, it would spoil the order.
    rows.push(failed(8, 1.0, Cause::Tilt));
    let summary = summary(&rows, 0);
    let found = summary.correlations();
    let named: Vec<_> = found.iter().map(|c| (c.input.as_str(), c.with, c.flights)).collect();
    assert_eq!(
        named,
        [("wind", "position.iae", 8), ("wind", "position.max", 8), ("wind", SUCCESS, 9)]
    );
    let ranks: Vec<f64> = found.iter().map(|c| c.rank).collect();
    // One failure, at the largest of nine: sums of products -18, of squares 60 and 18.
    for (rank, wanted) in ranks.iter().zip([1.0, -1.0, -18.0 / (60.0_f64 * 18.0).sqrt()]) {
        assert!((rank - wanted).abs() < 1e-14, "{rank} {wanted}");
    }
}

#[test]
fn of_a_flight_only_the_key_metrics_are_kept() {
    let metrics = ["tilt.max", "position.max", "control.effort", "position.iae"];
    let columns = Columns { metrics: metrics.map(String::from).to_vec(), ..columns() };
    let mut summary = Summary::new(&columns, 2);
    for (index, score) in [(0, 3.0), (1, 4.0)] {
        summary.push(&Row { metrics: vec![9.0, 2.0 * score, 8.0, score], ..row(index, 1.0, 0.0) });
    }
    assert_eq!(summary.columns().metrics, ["position.iae", "position.max"]);
    assert_eq!(summary.worst()[0].metrics, [4.0, 8.0]);
    let first = summary.sample().next().expect("a flight");
    assert_eq!([0, 1, 2].map(|at| first.metric(at)), [Some(3.0), Some(6.0), None]);
    assert_eq!(summary.metric("position.max").map(|(_, x)| x).collect::<Vec<_>>(), [6.0, 8.0]);
}

#[test]
fn memory_is_bounded() {
    let mut summary = Summary::new(&columns(), 10);
    for i in 0..100_000 {
        summary.push(&row(i, (i % 16) as f64, i as f64));
    }
    assert!(summary.sampled() <= SAMPLE && summary.sampled() > SAMPLE / 3);
    assert_eq!(summary.worst().len(), 10);
    assert_eq!(summary.sampled_every(), 8);
    assert!((summary.median().and_then(|row| row.metric(0)).unwrap_or(0.0) - 5e4).abs() < 1500.0);
}
