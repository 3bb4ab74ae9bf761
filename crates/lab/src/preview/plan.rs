//! What will disturb, and when sensors will tell: drawn along the reference, without flying.

use stormpetrel_control::math::Vec3;
use stormpetrel_control::real::Real;
use stormpetrel_control::registry::Settings as _;
use stormpetrel_plant::disturbance::{MOST, Reach, Scene, SourceSettings};
use stormpetrel_plant::flight::Flight;
use stormpetrel_plant::reference::Refer as _;
use stormpetrel_plant::sensor::Sense as _;

use super::POINTS;
use crate::figures::{Drawing, panel, series};
use crate::plot::{Figure, Panel};
use crate::scenario::Scenario;
use crate::trace::Axes;

/// Force and wind of all disturbances over time.
#[derive(Default)]
struct Plan {
    time: Vec<f64>,
    force: [Axes; MOST],
    wind: Axes,
}

fn note(axes: &mut Axes, v: [f64; 3]) {
    for (axis, x) in axes.iter_mut().zip(v) {
        axis.push(x);
    }
}

/// Asks every disturbance at every tick, as random ones must be, of a vehicle exactly on its reference.
fn plan(scenario: &Scenario) -> Plan {
    let mut flight: Flight<f64> = scenario.flight();
    let stride = scenario.ticks().div_ceil(POINTS).max(1);
    let mut plan = Plan::default();
    for tick in 0..scenario.ticks() {
        let time = tick as f64 * flight.control_step;
        let at = flight.reference.at(time);
        (flight.state.position, flight.state.velocity) = (at.position, at.velocity);
        let scene = Scene {
            time,
            tick: tick as f64,
            step: flight.control_step,
            state: flight.state,
            mass: flight.vehicle.mass,
        };
        let kept = tick % stride == 0;
        let mut wind = Vec3::zero();
        for (source, axes) in flight.disturbance.iter_mut().zip(&mut plan.force) {
            let force = match source.reach() {
                Reach::Air => {
                    wind += source.wind(&scene);
                    Vec3::zero()
                }
                Reach::Body => source.push(&scene).force,
                Reach::Cargo => Vec3::up(-source.cargo(&scene).mass * flight.vehicle.gravity),
                Reach::Sling => Vec3::up(-source.sling(&scene).mass * flight.vehicle.gravity),
                Reach::Nothing | Reach::Rotors => Vec3::zero(),
            };
            if kept {
                note(axes, [force.x, force.y, force.z]);
            }
        }
        if kept {
            plan.time.push(time);
            note(&mut plan.wind, [wind.x, wind.y, wind.z]);
        }
    }
    plan
}

/// When each disturbance acts, its force, and the wind that the vehicle will meet.
pub(super) fn disturbance(scenario: &Scenario) -> Drawing {
    let plan = plan(scenario);
    let named = |i: usize| format!("{i} {}", scenario.disturbance.get(i).map_or("", |s| s.name()));
    let windows = windows(scenario);
    let duration = scenario.run.duration;
    let mut acts = strokes("When it acts", "disturbance", &windows);
    acts.x_range = Some((0.0, duration));
    let mut panels = vec![acts];
    for (axis, name) in ["x", "y", "z"].iter().enumerate() {
        let pushes = (0..scenario.disturbance.len())
            .filter(|i| plan.force[*i].iter().flatten().any(|f| *f != 0.0));
        let lines: Vec<_> =
            pushes.map(|i| series(named(i), &plan.time, &plan.force[i][axis], i)).collect();
        if lines.iter().any(|line| line.y.iter().any(|force| *force != 0.0)) {
            panels.push(panel(&format!("Force, {name} axis"), "force (N)", lines));
        }
    }
    if plan.wind.iter().flatten().any(|w| *w != 0.0) {
        let axes = ["x", "y", "z"].iter().enumerate();
        let lines = axes.map(|(i, axis)| series(*axis, &plan.time, &plan.wind[i], i));
        panels.push(panel("Wind on the reference", "velocity (m/s)", lines.collect()));
    }
    let figure = Figure {
        title: format!("{}: what will disturb", scenario.title),
        description: "When each disturbance acts, its force, and the wind along the reference."
            .into(),
        panels,
    };
    Drawing { name: "preview-disturbance", svg: figure.svg() }
}

/// A name and the line that belongs to it.
type Stroke = (String, Vec<f64>, Vec<f64>);

/// A panel of strokes in rows numbered from zero; `what` is numbered.
fn strokes<'a>(title: &str, what: &str, strokes: &'a [Stroke]) -> Panel<'a> {
    let lines = strokes.iter().enumerate();
    let lines = lines.map(|(i, (name, x, y))| series(name, x, y, i)).collect();
    Panel { y_rows: strokes.len(), ..panel(title, what, lines) }
}

/// From onset to end of each disturbance within the flight, one line each.
fn windows(scenario: &Scenario) -> Vec<Stroke> {
    let duration = scenario.run.duration;
    let one = |(i, source): (usize, &SourceSettings)| {
        let (name, window) = (source.name(), source.window);
        if !window.meets(duration) {
            return (format!("{i} {name} (not in this flight)"), Vec::new(), Vec::new());
        }
        let until = Real::min(window.end, duration);
        (format!("{i} {name}"), vec![window.start, until], vec![i as f64; 2])
    };
    scenario.disturbance.iter().enumerate().map(one).collect()
}

/// Time of the sensor plan, s.
const SHOWN: f64 = 0.5;

/// When each sensor samples and when the sample is there: one slanted stroke for each sample.
pub(super) fn sensors(scenario: &Scenario) -> Drawing {
    let vehicle = scenario.vehicle.vehicle;
    let samples = scenario.sensor.iter().enumerate().map(|(i, sensor)| {
        let timing = sensor.build(&vehicle).timing();
        // Never finer than the control step: that is when sensors are asked.
        let period = Real::max(1.0 / timing.rate_hz, scenario.run.control_step);
        let (mut x, mut y) = (Vec::new(), Vec::new());
        let mut taken = 0.0;
        while taken < SHOWN {
            x.extend([taken, taken + timing.latency, f64::NAN]);
            y.extend([i as f64 - 0.3, i as f64 + 0.3, f64::NAN]);
            taken += period;
        }
        let name = format!(
            "{i} {}, {} Hz, {} ms late",
            sensor.name(),
            timing.rate_hz,
            timing.latency * 1e3
        );
        (name, x, y)
    });
    let samples: Vec<Stroke> = samples.collect();
    let figure = Figure {
        title: format!("{}: when sensors tell", scenario.title),
        description: "A stroke for each sample, from when it is taken to when it is there.".into(),
        panels: vec![strokes("Samples of the first half second", "sensor", &samples)],
    };
    Drawing { name: "preview-sensors", svg: figure.svg() }
}
