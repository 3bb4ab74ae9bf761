//! A day in the wind: `cargo xtask soak`. Its figures stand in `docs/reliability.md`.
// A test that is read, with the standard library's arithmetic.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::expect_used, clippy::print_stdout)]

use stormpetrel_lab::fly::fly;
use stormpetrel_lab::scenario::load_text;

const SCENARIO: &str = r#"
run                = { duration = 86400.0, control_step = 0.001, substeps = 1, seed = 1 }
vehicle            = { model = "hummingbird" }
reference          = { shape = "hover", position = [0.0, 0.0, 10.0] }
start              = { attitude = "flatness" }
position           = { law = "pid", kp = 6.0, ki = 2.0, kd = 4.0 }
observer           = { law = "hosm", lipschitz = 3.0, input = "measured" }
attitude_reference = { law = "rotation", rates = "commanded" }
attitude           = { law = "tilt-priority", k1 = 8.0 }
rate               = { law = "indi", filter = "butterworth", cutoff_hz = 50.0, k_omega = 25.0 }
actuation          = { kind = "propulsion" }

[[disturbance]]
kind = "dryden"
mean = [6.0, 2.0, 0.0]
"#;

/// Position errors of one hour.
#[derive(Clone, Copy, Default)]
struct Hour {
    sum: f64,
    count: f64,
    most: f64,
}

/// Slope of a line through the points, and its standard error.
fn trend(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let (x, y) = ((n - 1.0) / 2.0, values.iter().sum::<f64>() / n);
    let square: f64 = (0..values.len()).map(|i| (i as f64 - x).powi(2)).sum();
    let product: f64 = values.iter().enumerate().map(|(i, v)| (i as f64 - x) * (v - y)).sum();
    let slope = product / square;
    let rest = |(i, v): (usize, &f64)| (v - y - slope * (i as f64 - x)).powi(2);
    let left: f64 = values.iter().enumerate().map(rest).sum();
    (slope, (left / (n - 2.0) / square).sqrt())
}

#[test]
#[ignore = "some minutes: cargo xtask soak"]
fn a_day_of_hover_in_turbulence_shows_no_trend() {
    let file = load_text("soak", "soak", SCENARIO.to_owned(), &[]).expect("a scenario");
    let mut hours = vec![Hour::default(); 24];
    let outcome = fly(&file.scenarios[0], |tick, errors| {
        // Rounded up by half a step: a tick belongs to the hour in which it lies.
        let hour = ((tick.time + 5e-4) / 3600.0) as usize;
        if let Some(hour) = hours.get_mut(hour) {
            hour.sum += errors.position;
            hour.count += 1.0;
            hour.most = hour.most.max(errors.position);
        }
    });
    assert!(outcome.failure.is_none(), "{:?}", outcome.failure);
    println!("| hour | mean error (mm) | largest error (mm) |\n|---|---|---|");
    for (i, hour) in hours.iter().enumerate() {
        println!("| {} | {:.3} | {:.2} |", i + 1, hour.sum / hour.count * 1e3, hour.most * 1e3);
    }
    // The first hour has the start in it.
    let means: Vec<f64> = hours[1..].iter().map(|hour| hour.sum / hour.count).collect();
    let (slope, error) = trend(&means);
    let share = slope / means[0];
    println!(
        "\ntrend of the mean: {:.2e} of it an hour, {:.1} standard errors",
        share,
        slope / error
    );
    assert!(slope.abs() < 3.5 * error, "a trend: {slope} +- {error} m an hour");
}
