//! The figures of a flight.

use crate::plot::{Figure, Limit, Panel, Path, Scene, Series};
use stormpetrel_control::registry::Settings as _;

use crate::scenario::Scenario;
use crate::trace::{Axes, Trace};

/// A figure under its file name.
#[derive(Clone, Debug)]
pub struct Drawing {
    /// File name without ending.
    pub name: &'static str,
    /// The figure as SVG.
    pub svg: String,
}

const AXES: [&str; 3] = ["x", "y", "z"];

pub(crate) fn series<'a>(
    label: impl Into<String>,
    x: &'a [f64],
    y: &'a [f64],
    style: usize,
) -> Series<'a> {
    Series { label: label.into(), x, y, style, ..Series::default() }
}

pub(crate) fn panel<'a>(title: &str, y_label: &str, series: Vec<Series<'a>>) -> Panel<'a> {
    Panel {
        title: title.into(),
        x_label: "time (s)".into(),
        y_label: y_label.into(),
        series,
        ..Panel::default()
    }
}

/// Path against reference.
pub fn path(title: &str, trace: &Trace) -> Drawing {
    fn of<'a>(label: &str, [x, y, z]: &'a Axes, style: usize) -> Path<'a> {
        Path { label: label.into(), x, y, z, style, bare: false }
    }
    let scene = Scene {
        title: format!("{title}: flown path against the reference"),
        description: "Three-dimensional view of the flown path and the reference path.".into(),
        paths: vec![of("reference", &trace.reference, 0), of("flown", &trace.position, 1)],
    };
    Drawing { name: "path", svg: scene.svg() }
}

/// Position and attitude error.
pub fn errors(title: &str, trace: &Trace, has_attitude: bool) -> Drawing {
    let mut panels = vec![panel(
        "Position error",
        "|e| (m)",
        vec![series("position error", &trace.time, &trace.error, 0)],
    )];
    if has_attitude {
        let angle = series("attitude error", &trace.time, &trace.angle, 1);
        panels.push(panel(
            "Attitude error against the law's own reference",
            "angle (rad)",
            vec![angle],
        ));
    }
    let figure = Figure {
        title: format!("{title}: errors"),
        description: "Position error and attitude error over time.".into(),
        panels,
    };
    Drawing { name: "errors", svg: figure.svg() }
}

/// True and estimated disturbance: the article's figure 1.
pub fn disturbance(title: &str, trace: &Trace) -> Drawing {
    let panels = AXES.iter().enumerate().map(|(i, axis)| {
        let lines = vec![
            series("true (lumped)", &trace.time, &trace.lumped[i], 0),
            series("estimated", &trace.time, &trace.estimate[i], 1),
        ];
        panel(&format!("Disturbance, {axis} axis"), "force (N)", lines)
    });
    let figure = Figure {
        title: format!("{title}: true against estimated disturbance"),
        description:
            "True lumped disturbance force and its estimate, one panel for each world axis.".into(),
        panels: panels.collect(),
    };
    Drawing { name: "disturbance", svg: figure.svg() }
}

/// Whether a curve is anything but zero throughout.
fn moves(curve: &[f64]) -> bool {
    curve.iter().any(|value| *value != 0.0)
}

/// A panel for each axis along which some disturbance does something.
fn by_axis<'a>(
    scenario: &Scenario,
    trace: &'a Trace,
    what: &'a [Axes],
    (name, unit): (&str, &str),
) -> Vec<Panel<'a>> {
    let mut panels = Vec::new();
    for (axis, letter) in AXES.iter().enumerate() {
        if !what.iter().any(|axes| moves(&axes[axis])) {
            continue;
        }
        let lines = what.iter().zip(&scenario.disturbance).enumerate();
        let lines = lines.map(|(i, (axes, source))| {
            series(format!("{i} {}", source.name()), &trace.time, &axes[axis], i)
        });
        panels.push(panel(&format!("True {name}, {letter} axis"), unit, lines.collect()));
    }
    panels
}

/// What each disturbance does by itself, and the wind; nothing where none does anything.
fn sources(scenario: &Scenario, trace: &Trace) -> Option<Drawing> {
    let mut panels = by_axis(scenario, trace, &trace.sources, ("force", "force (N)"));
    let torque = ("torque", "torque (N m)");
    panels.extend(by_axis(scenario, trace, &trace.source_torques, torque));
    if trace.wind.iter().any(|axis| moves(axis)) {
        let winds = AXES.iter().enumerate();
        let winds = winds.map(|(i, axis)| series(*axis, &trace.time, &trace.wind[i], i));
        panels.push(panel("Wind", "velocity (m/s)", winds.collect()));
    }
    if panels.is_empty() {
        return None;
    }
    let figure = Figure {
        title: format!("{}: what disturbs", scenario.title),
        description: "True force of each disturbance along the world axes, its torque about the \
                      body axes, and the wind."
            .into(),
        panels,
    };
    Some(Drawing { name: "sources", svg: figure.svg() })
}

/// How wrong the laws are told.
fn sensing(scenario: &Scenario, trace: &Trace) -> Drawing {
    let errors = AXES.iter().enumerate();
    let errors = errors.map(|(i, axis)| series(*axis, &trace.time, &trace.told[i], i));
    let figure = Figure {
        title: format!("{}: what the filter believes", scenario.title),
        description: "Estimated less true position along each world axis.".into(),
        panels: vec![panel("Estimated less true position", "error (m)", errors.collect())],
    };
    Drawing { name: "sensing", svg: figure.svg() }
}

/// Thrust and torques that act.
pub fn commands(title: &str, trace: &Trace) -> Drawing {
    let torques = AXES
        .iter()
        .enumerate()
        .map(|(i, axis)| series(format!("torque {axis}"), &trace.time, &trace.torque[i], i));
    let figure = Figure {
        title: format!("{title}: thrust and torque"),
        description: "Total thrust and the torque about each body axis over time.".into(),
        panels: vec![
            panel("Thrust", "thrust (N)", vec![series("thrust", &trace.time, &trace.thrust, 0)]),
            panel("Torque", "torque (N m)", torques.collect()),
        ],
    };
    Drawing { name: "commands", svg: figure.svg() }
}

/// Rotor speeds with their limits.
pub fn rotors(title: &str, trace: &Trace, limits: (f64, f64)) -> Drawing {
    let lines = trace
        .rotor_speed
        .iter()
        .enumerate()
        .map(|(i, speed)| series(format!("rotor {}", i + 1), &trace.time, speed, i));
    let mut speeds = panel("Rotor speeds", "speed (rad/s)", lines.collect());
    speeds.limits = vec![
        Limit { value: limits.0, label: "lowest".into() },
        Limit { value: limits.1, label: "highest".into() },
    ];
    let figure = Figure {
        title: format!("{title}: rotor speeds"),
        description: "Speed of each rotor over time, with the lowest and highest possible speed."
            .into(),
        panels: vec![speeds],
    };
    Drawing { name: "rotors", svg: figure.svg() }
}

/// What the battery gives.
fn battery(title: &str, trace: &Trace) -> Drawing {
    let [charge, voltage, current] = &trace.battery;
    let line = |name: &str, values, i| vec![series(name, &trace.time, values, i)];
    let figure = Figure {
        title: format!("{title}: battery"),
        description: "Charge, voltage and current of the battery over time.".into(),
        panels: vec![
            panel("Charge", "share that is left (1)", line("charge", charge, 0)),
            panel("Voltage at the rotors", "voltage (V)", line("voltage", voltage, 1)),
            panel("Current", "current (A)", line("current", current, 2)),
        ],
    };
    Drawing { name: "battery", svg: figure.svg() }
}

/// All figures of one flight.
pub fn all(scenario: &Scenario, trace: &Trace) -> Vec<Drawing> {
    let title = &scenario.title;
    let mut drawings = vec![
        path(title, trace),
        errors(title, trace, scenario.has_attitude()),
        disturbance(title, trace),
        commands(title, trace),
    ];
    drawings.extend(sources(scenario, trace));
    if !scenario.sensor.is_empty() {
        drawings.push(sensing(scenario, trace));
    }
    if scenario.has_rotors() {
        let vehicle = &scenario.vehicle.vehicle;
        drawings.push(rotors(title, trace, (vehicle.rotor_speed_min, vehicle.rotor_speed_max)));
    }
    if scenario.has_battery() {
        drawings.push(battery(title, trace));
    }
    drawings
}
