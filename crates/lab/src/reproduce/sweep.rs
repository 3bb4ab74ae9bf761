//! The largest disturbance that a variant survives.
//!
//! The force amplitude is raised on a ladder until a flight fails, then the gap is narrowed. A flight
//! survives if it stays within 5 m of the reference and upright (tilt below 90 deg) for its whole time.

use stormpetrel_control::math::Vec3;
use stormpetrel_control::real::Real;
use stormpetrel_plant::disturbance::{DisturbanceSettings, SourceSettings};

use crate::fly::{LANES, fly_batch_position};
use crate::scenario::{File, Scenario};

/// What a variant survived.
#[derive(Clone, Debug, PartialEq)]
pub struct Survival {
    /// Name of the scenario.
    pub name: String,
    /// Its title.
    pub title: String,
    /// Largest force amplitude of an unbroken row of survived flights, N.
    pub survived: f64,
    /// Smallest amplitude at which a flight failed, N; `None` where none did.
    pub failed: Option<f64>,
    /// Why that flight failed.
    pub cause: &'static str,
    /// Largest amplitude for which the observer's bound L covers the slope, N; `None` without one.
    pub observer_limit: Option<f64>,
}

/// Amplitude above which no attitude below 90 deg can hold: m g/(1 + sqrt 2), N (theory 1.2).
pub fn upright_limit(scenario: &Scenario) -> f64 {
    let vehicle = &scenario.vehicle.vehicle;
    vehicle.mass * vehicle.gravity / (1.0 + std::f64::consts::SQRT_2)
}

/// Files and variants whose survival is searched.
const FILES: [&str; 2] = ["article/consistent", "article/rotors"];
const VARIANTS: [&str; 6] =
    ["pid-pid", "pid", "double-commanded", "single-commanded", "single-measured", "rate-commanded"];

/// The scenarios to search, with the limits of an upright flight.
pub fn plan(files: &[(&'static str, File)]) -> Vec<Scenario> {
    let mut plan = Vec::new();
    for (_, file) in files.iter().filter(|(name, _)| FILES.contains(name)) {
        for scenario in &file.scenarios {
            if scenario.variant.as_deref().is_some_and(|variant| VARIANTS.contains(&variant)) {
                let mut scenario = scenario.clone();
                scenario.failure.tilt_deg = 90.0;
                plan.push(scenario);
            }
        }
    }
    plan
}

fn with_force(scenario: &Scenario, amplitude: f64) -> Scenario {
    let mut pushed = scenario.clone();
    if let Some(SourceSettings { what: DisturbanceSettings::Harmonic(gains, ()), .. }) =
        pushed.disturbance.first_mut()
    {
        gains.force = Vec3::splat(amplitude);
    }
    pushed
}

/// Searches the largest survived amplitude: three ladders of eight flights, each within the gap that
/// the one before left.
pub fn search(scenario: &Scenario) -> Survival {
    let (mut survived, mut failed, mut cause) = (0.0, None, "");
    let (mut low, mut high) = (0.25, 16.0);
    for round in 0..3 {
        let rung = |i: usize| {
            let part = i as f64 / (LANES - 1) as f64;
            if round == 0 {
                // The first ladder is geometric: 0.25 N to 16 N.
                low * Real::exp(part * Real::ln(high / low))
            } else {
                low + (high - low) * (i as f64 + 1.0) / (LANES as f64 + 1.0)
            }
        };
        let ladder: Vec<f64> = (0..LANES).map(rung).collect();
        let flights: Vec<_> = ladder.iter().map(|a| with_force(scenario, *a)).collect();
        let mut broken = false;
        for (amplitude, outcome) in ladder.iter().zip(fly_batch_position(&flights)) {
            match outcome.failure {
                None if !broken => survived = *amplitude,
                Some(failure) if !broken => {
                    broken = true;
                    (failed, cause) = (Some(*amplitude), failure.cause.describe());
                }
                _ => {}
            }
        }
        (low, high) = (survived, failed.unwrap_or(high));
        if failed.is_none() {
            break;
        }
    }
    Survival {
        name: scenario.name.clone(),
        title: scenario.title.clone(),
        survived,
        failed,
        cause,
        observer_limit: observer_limit(scenario),
    }
}

/// L m/sqrt 2: |d/dt| of A (1 + sin t + cos t)/m is at most sqrt 2 A/m.
fn observer_limit(scenario: &Scenario) -> Option<f64> {
    use stormpetrel_control::observer::ObserverSettings;
    match scenario.observer {
        ObserverSettings::Hosm(gains, _) => {
            Some(gains.lipschitz * scenario.model.mass / std::f64::consts::SQRT_2)
        }
        ObserverSettings::Absent(..) => None,
    }
}
