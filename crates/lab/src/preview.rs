//! A scenario drawn without flying: where it leads, and what that asks of the vehicle.

mod plan;

use std::fmt::Write;

use stormpetrel_control::math::{Frame, Vec3};
use stormpetrel_control::real::Real;
use stormpetrel_plant::reference::ReferenceSettings;

use crate::feasible::{Demand, Feasibility, course};
use crate::figures::{Drawing, panel, series};
use crate::page::{self, escape};
use crate::plot::{Figure, Limit, Panel, Path, Scene};
use crate::scenario::Scenario;
use crate::trace::Axes;

/// Points of a curve.
const POINTS: u64 = 2000;

/// Everything that can be drawn of a scenario before it flies.
pub fn drawings(scenario: &Scenario) -> Vec<Drawing> {
    let demands = course(scenario, POINTS);
    let mut all = vec![path(scenario, &demands), motion(scenario, &demands)];
    all.push(needs(scenario, &demands));
    if scenario.has_rotors() {
        all.push(rotors(scenario, &demands));
    }
    if !scenario.disturbance.is_empty() {
        all.push(plan::disturbance(scenario));
    }
    if !scenario.sensor.is_empty() {
        all.push(plan::sensors(scenario));
    }
    all
}

/// The page with tables, warnings and figures of some flights.
pub fn html(title: &str, flights: &[(&Scenario, &Feasibility, Vec<Drawing>)]) -> String {
    let mut page = page::open(title);
    page.push_str(
        "<p>Drawn without flying: the vehicle exactly on its reference, in still air.</p>\n",
    );
    for (scenario, feasibility, drawings) in flights {
        let _ = writeln!(
            page,
            "<h2>{}</h2>\n<p>{}</p>",
            escape(&scenario.name),
            escape(&scenario.title)
        );
        for warning in feasibility.warnings() {
            let _ =
                writeln!(page, "<p><strong>It cannot be flown:</strong> {}</p>", escape(&warning));
        }
        let table = feasibility.table("");
        page::table(&mut page, &table.head, &table.rows);
        for note in &table.notes {
            page::note(&mut page, note);
        }
        for drawing in drawings {
            page.push_str(&drawing.svg);
        }
    }
    page::close(&mut page, "<code>stormpetrel preview</code>");
    page
}

/// One number of every demand.
fn each(demands: &[Demand], of: impl Fn(&Demand) -> f64) -> Vec<f64> {
    demands.iter().map(of).collect()
}

/// One vector of every demand, by axes.
fn axes<F: Frame>(demands: &[Demand], of: impl Fn(&Demand) -> Vec3<f64, F>) -> Axes {
    [each(demands, |d| of(d).x), each(demands, |d| of(d).y), each(demands, |d| of(d).z)]
}

/// The reference in space, with what it leads through.
fn path(scenario: &Scenario, demands: &[Demand]) -> Drawing {
    let [x, y, z] = axes(demands, |d| d.reference.position);
    let marks = marks(&scenario.reference);
    let mut paths =
        vec![Path { label: "reference".into(), x: &x, y: &y, z: &z, ..Path::default() }];
    if let Some((label, [x, y, z])) = &marks {
        paths.push(Path { label: (*label).into(), x, y, z, style: 6, bare: true });
    }
    let scene = Scene {
        title: format!("{}: the reference", scenario.title),
        description: "Three-dimensional view of the reference path.".into(),
        paths,
    };
    Drawing { name: "preview-path", svg: scene.svg() }
}

/// Corners of a gate, to the left and up from its centre, in halves of its width.
const SQUARE: [(f64, f64); 5] = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)];

/// The gates of a race as squares, the waypoints of a flight as crosses: lines with gaps, m.
fn marks(reference: &ReferenceSettings) -> Option<(&'static str, Axes)> {
    let mut marks: Axes = Default::default();
    let mut stroke = |points: &[[f64; 3]]| {
        for point in points.iter().chain([&[f64::NAN; 3]]) {
            for (axis, x) in marks.iter_mut().zip(point) {
                axis.push(*x);
            }
        }
    };
    match reference {
        ReferenceSettings::Race(gains, options) => {
            let half = gains.gate.half();
            for row in 0..options.gates.len() {
                let [x, y, z, yaw] = std::array::from_fn(|column| options.gates.cell(row, column));
                let (sin, cos) = Real::sin_cos(yaw);
                let corner = |(side, up): (f64, f64)| {
                    [x - half * side * sin, y + half * side * cos, z + half * up]
                };
                stroke(&SQUARE.map(corner));
            }
            Some(("gates", marks))
        }
        ReferenceSettings::MinimumSnap(_, options) => {
            let table = &options.waypoints;
            let at = |row: usize| -> [f64; 3] { std::array::from_fn(|axis| table.cell(row, axis)) };
            // Arms of a fiftieth of the way.
            let arm = 0.02 * Real::min(options.curve.end(), 100.0);
            for row in 0..table.len() {
                for axis in 0..3 {
                    let moved = |by: f64| {
                        let mut point = at(row);
                        point[axis] += by;
                        point
                    };
                    stroke(&[moved(-arm), moved(arm)]);
                }
            }
            Some(("waypoints", marks))
        }
        _ => None,
    }
}

fn lines<'a>(title: &str, label: &str, time: &'a [f64], of: &'a Axes) -> Panel<'a> {
    let names = ["x", "y", "z"].iter().zip(of).enumerate();
    panel(title, label, names.map(|(i, (name, y))| series(*name, time, y, i)).collect())
}

/// Position, velocity, acceleration and heading over time.
fn motion(scenario: &Scenario, demands: &[Demand]) -> Drawing {
    let time = each(demands, |d| d.time);
    let position = axes(demands, |d| d.reference.position);
    let velocity = axes(demands, |d| d.reference.velocity);
    let acceleration = axes(demands, |d| d.reference.acceleration);
    let yaw = each(demands, |d| d.reference.yaw);
    let figure = Figure {
        title: format!("{}: motion of the reference", scenario.title),
        description: "Position, velocity, acceleration and heading of the reference over time."
            .into(),
        panels: vec![
            lines("Position", "position (m)", &time, &position),
            lines("Velocity", "velocity (m/s)", &time, &velocity),
            lines("Acceleration", "acceleration (m/s²)", &time, &acceleration),
            panel("Heading", "yaw (rad)", vec![series("", &time, &yaw, 0)]),
        ],
    };
    Drawing { name: "preview-motion", svg: figure.svg() }
}

/// Thrust, tilt, body rate and torque that the reference needs.
fn needs(scenario: &Scenario, demands: &[Demand]) -> Drawing {
    let time = each(demands, |d| d.time);
    let thrust = each(demands, |d| d.thrust);
    let tilt = each(demands, |d| d.tilt);
    let rate = each(demands, |d| d.rate);
    let torque = each(demands, |d| d.torque);
    let mut first = panel("Thrust", "thrust (N)", vec![series("", &time, &thrust, 0)]);
    if scenario.has_rotors() {
        let allocation = scenario.vehicle.vehicle.allocation();
        first.limits = limits(4.0 * allocation.lowest, 4.0 * allocation.highest);
    }
    let mut panels = vec![first, panel("Tilt", "tilt (rad)", vec![series("", &time, &tilt, 1)])];
    if scenario.has_attitude() {
        panels.push(panel("Body rate", "rate (rad/s)", vec![series("", &time, &rate, 2)]));
        panels.push(panel("Torque", "torque (N m)", vec![series("", &time, &torque, 3)]));
    }
    let figure = Figure {
        title: format!("{}: what the reference needs", scenario.title),
        description: "Thrust, tilt, body rate and torque that the reference needs, over time."
            .into(),
        panels,
    };
    Drawing { name: "preview-demand", svg: figure.svg() }
}

/// Rotor speeds that the reference needs, with their limits.
fn rotors(scenario: &Scenario, demands: &[Demand]) -> Drawing {
    let time = each(demands, |d| d.time);
    let speeds: [Vec<f64>; 4] = std::array::from_fn(|i| each(demands, |d| d.rotor_speed[i]));
    let rotors = speeds.iter().enumerate();
    let rotors = rotors.map(|(i, speed)| series(format!("rotor {}", i + 1), &time, speed, i));
    let mut speeds = panel("Rotor speeds", "speed (rad/s)", rotors.collect());
    let vehicle = &scenario.vehicle.vehicle;
    speeds.limits = limits(vehicle.rotor_speed_min, vehicle.rotor_speed_max);
    let figure = Figure {
        title: format!("{}: rotor speeds that the reference needs", scenario.title),
        description: "Speed that each rotor needs over time, with the lowest and highest possible."
            .into(),
        panels: vec![speeds],
    };
    Drawing { name: "preview-rotors", svg: figure.svg() }
}

fn limits(low: f64, high: f64) -> Vec<Limit> {
    let limit = |value: f64, label: &str| Limit { value, label: label.into() };
    vec![limit(low, "lowest"), limit(high, "highest")]
}
