//! Can the vehicle fly its reference? What the reference needs, by differential flatness, against the rotors'
//! limits.
//!
//!   F = a + g e_z,   T = m |F|,   tilt = angle(F, e_z)                   (1)
//!   omega, omega' from jerk, snap and heading (control::attitude_reference)   (2)
//!   tau = I omega' + omega x I omega                                     (3)
//!   u = B^-1 (T, tau),   Omega_i = sqrt(u_i/k)                           (4)
//!
//! This is the vehicle exactly on its reference in still air. Wind, errors and the lag of the rotors need
//! room beside it: a margin of nothing is too little.

use stormpetrel_control::attitude_reference::{attitude_along, flatness_rates};
use stormpetrel_control::math::Vec3;
use stormpetrel_control::real::Real;
use stormpetrel_control::signals::{Thrust, Trajectory};
use stormpetrel_plant::reference::Refer;
use stormpetrel_plant::vehicle::Vehicle;

use crate::curve::{FitError, fit_error};
use crate::page::number;
use crate::reproduce::Table;
use crate::scenario::Scenario;

/// Most moments that are looked at.
const MOST: u64 = 20_000;

/// What the reference needs at one moment.
#[derive(Clone, Copy, Debug)]
pub struct Demand {
    /// Time since the start, s.
    pub time: f64,
    /// Where to be.
    pub reference: Trajectory<f64>,
    /// Total thrust, N.
    pub thrust: f64,
    /// Angle between thrust and the vertical, rad.
    pub tilt: f64,
    /// Magnitude of the angular velocity, rad/s.
    pub rate: f64,
    /// Magnitude of the angular acceleration, rad/s^2.
    pub acceleration: f64,
    /// Magnitude of the torque, N m.
    pub torque: f64,
    /// Thrust of each rotor, N.
    pub rotor_thrust: [f64; 4],
    /// Speed of each rotor, rad/s; negative where it would have to pull.
    pub rotor_speed: [f64; 4],
}

impl Demand {
    /// What a vehicle needs to follow `reference` at `time` seconds.
    pub fn new(vehicle: &Vehicle<f64>, time: f64, reference: Trajectory<f64>) -> Self {
        let force = reference.acceleration + Vec3::up(vehicle.gravity); // (1)
        let thrust = Thrust {
            force,
            force_rate: reference.jerk,
            force_acceleration: reference.snap,
            yaw: reference.yaw,
            yaw_rate: reference.yaw_rate,
            yaw_acceleration: reference.yaw_acceleration,
        };
        let (rate, acceleration) = flatness_rates(attitude_along(force, reference.yaw), &thrust); // (2)
        let inertia = vehicle.inertia;
        let torque = inertia.scale(acceleration) + rate.cross(inertia.scale(rate)); // (3)
        let total = vehicle.mass * force.norm();
        let wrench = [total, torque.x, torque.y, torque.z];
        let rotor_thrust = vehicle
            .allocation()
            .inverse
            .map(|row| row.iter().zip(wrench).map(|(share, of)| share * of).sum()); // (4)
        let speed = |u: f64| (u.abs() / vehicle.thrust_coefficient).sqrt().with_sign(u);
        Self {
            time,
            reference,
            thrust: total,
            tilt: (force - Vec3::up(force.z)).norm().atan2(force.z),
            rate: rate.norm(),
            acceleration: acceleration.norm(),
            torque: torque.norm(),
            rotor_thrust,
            rotor_speed: rotor_thrust.map(speed),
        }
    }
}

/// What the reference of a scenario needs from the start to the end of the flight, at no more than this
/// many moments.
pub fn course(scenario: &Scenario, most: u64) -> Vec<Demand> {
    let vehicle = &scenario.vehicle.vehicle;
    let reference = scenario.reference.build(vehicle);
    let ticks = scenario.ticks();
    let stride = ticks.div_ceil(most - 1).max(1);
    let last = (!ticks.is_multiple_of(stride)).then_some(ticks);
    let moments = (0..=ticks / stride).map(|i| i * stride).chain(last);
    let time = |tick: u64| tick as f64 * scenario.run.control_step;
    moments.map(|tick| Demand::new(vehicle, time(tick), reference.at(time(tick)))).collect()
}

/// A quantity that the reference needs, where it needs most of it (or least).
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    /// Name; with `least` where a lower limit counts.
    pub name: &'static str,
    /// SI unit.
    pub unit: &'static str,
    /// The value nearest to its limit or beyond it.
    pub worst: f64,
    /// When that is, s.
    pub time: f64,
    /// The limit, where the scenario has rotors and they have one.
    pub limit: Option<f64>,
    /// Distance from the limit as a share of the room between the lowest and the highest; negative beyond.
    pub margin: Option<f64>,
    /// From when to when the limit is passed, s.
    pub beyond: Vec<(f64, f64)>,
}

/// Whether a reference can be flown.
#[derive(Clone, Debug, PartialEq)]
pub struct Feasibility {
    /// What it needs.
    pub quantities: Vec<Quantity>,
    /// How well it follows its table, where it has one to fit.
    pub fit: Option<FitError>,
}

/// What of a demand is looked at: name, unit, value.
type Part = (&'static str, &'static str, fn(&Demand) -> f64);

/// The greatest of four.
fn most(x: [f64; 4]) -> f64 {
    x.into_iter().fold(f64::NEG_INFINITY, Real::max)
}

/// The least of four.
fn least(x: [f64; 4]) -> f64 {
    x.into_iter().fold(f64::INFINITY, Real::min)
}

const THRUST: Part = ("thrust", "N", |d| d.thrust);
const THRUST_LEAST: Part = ("thrust, least", "N", |d| d.thrust);
const TILT: Part = ("tilt", "rad", |d| d.tilt);
const RATE: Part = ("body rate", "rad/s", |d| d.rate);
const ACCELERATION: Part = ("ang. accel.", "rad/s^2", |d| d.acceleration);
const TORQUE: Part = ("torque", "N m", |d| d.torque);
const ROTOR: Part = ("rotor thrust", "N", |d| most(d.rotor_thrust));
const ROTOR_LEAST: Part = ("rotor thrust, least", "N", |d| least(d.rotor_thrust));
const SPEED: Part = ("rotor speed", "rad/s", |d| most(d.rotor_speed));
const SPEED_LEAST: Part = ("rotor speed, least", "rad/s", |d| least(d.rotor_speed));

/// Walks along the reference of a scenario: every control step, or 20,000 moments of a longer flight.
pub fn feasible(scenario: &Scenario) -> Feasibility {
    let course = course(scenario, MOST);
    let vehicle = &scenario.vehicle.vehicle;
    let allocation = vehicle.allocation();
    // Without rotors nothing is limited; a point mass has no attitude.
    let limits = |low: f64, high: f64| scenario.has_rotors().then_some((low, high));
    let thrusts = (allocation.lowest, allocation.highest);
    let speeds = limits(vehicle.rotor_speed_min, vehicle.rotor_speed_max);
    let total = limits(4.0 * thrusts.0, 4.0 * thrusts.1);
    let single = limits(thrusts.0, thrusts.1);
    let mut quantities = vec![
        upper(&course, THRUST, total),
        lower(&course, THRUST_LEAST, total),
        upper(&course, TILT, None),
    ];
    if scenario.has_attitude() {
        quantities.extend([
            upper(&course, RATE, None),
            upper(&course, ACCELERATION, None),
            upper(&course, TORQUE, None),
            upper(&course, ROTOR, single),
            lower(&course, ROTOR_LEAST, single),
            upper(&course, SPEED, speeds),
            lower(&course, SPEED_LEAST, speeds),
        ]);
    }
    Feasibility { quantities, fit: fit_error(&scenario.reference) }
}

/// A quantity that must not be too great.
fn upper(course: &[Demand], (name, unit, of): Part, room: Option<(f64, f64)>) -> Quantity {
    // What cannot be computed cannot be flown.
    let value = |d: &Demand| Some(of(d)).filter(|x| !x.is_nan()).unwrap_or(f64::INFINITY);
    let limit = room.map(|(_, high)| high);
    quantity(course, (name, unit), limit, room, value, |x| x)
}

/// A quantity that must not be too small.
fn lower(course: &[Demand], (name, unit, of): Part, room: Option<(f64, f64)>) -> Quantity {
    let value = |d: &Demand| Some(of(d)).filter(|x| !x.is_nan()).unwrap_or(f64::NEG_INFINITY);
    let limit = room.map(|(low, _)| low);
    quantity(course, (name, unit), limit, room, value, |x| -x)
}

/// `rank` orders values: the greater, the worse.
fn quantity(
    course: &[Demand],
    (name, unit): (&'static str, &'static str),
    limit: Option<f64>,
    room: Option<(f64, f64)>,
    value: impl Fn(&Demand) -> f64,
    rank: impl Fn(f64) -> f64,
) -> Quantity {
    let (mut worst, mut time) = (-rank(f64::INFINITY), 0.0);
    let mut beyond: Vec<(f64, f64)> = Vec::new();
    let mut before = false;
    for demand in course {
        let x = value(demand);
        if rank(x) > rank(worst) {
            (worst, time) = (x, demand.time);
        }
        let broken = limit.is_some_and(|limit| rank(x) > rank(limit) + ROUNDING * limit.abs());
        match beyond.last_mut() {
            Some(last) if broken && before => last.1 = demand.time,
            _ if broken => beyond.push((demand.time, demand.time)),
            _ => {}
        }
        before = broken;
    }
    let share = |limit: f64| room.map(|(low, high)| (rank(limit) - rank(worst)) / (high - low));
    Quantity { name, unit, worst, time, limit, margin: limit.and_then(share), beyond }
}

/// A limit is passed beyond this share of it.
const ROUNDING: f64 = 1e-9;

impl Feasibility {
    /// The quantities that pass their limits.
    pub fn broken(&self) -> impl Iterator<Item = &Quantity> {
        self.quantities.iter().filter(|quantity| !quantity.beyond.is_empty())
    }

    /// The quantity of that name.
    pub fn get(&self, name: &str) -> Option<&Quantity> {
        self.quantities.iter().find(|quantity| quantity.name == name)
    }

    /// As a table under this title.
    pub fn table(&self, title: &str) -> Table {
        let head = ["the reference needs", "worst", "limit", "margin", "at (s)"];
        let row = |q: &Quantity| {
            let margin = q.margin.map_or("-".into(), |m| format!("{:.0} %", 100.0 * m));
            let limit = q.limit.map_or("-".into(), number);
            let name = format!("{} ({})", q.name, q.unit);
            vec![name, number(q.worst), limit, margin, format!("{:.2}", q.time)]
        };
        let fit = |fit: &FitError| {
            let (worst, rms) = (number(fit.worst), number(fit.rms));
            format!("fit: within {worst} m of every row, RMS {rms} m, {} polynomials", fit.pieces)
        };
        Table {
            title: title.to_owned(),
            head: head.map(str::to_owned).to_vec(),
            rows: self.quantities.iter().map(row).collect(),
            notes: self.fit.iter().map(fit).collect(),
            ..Table::default()
        }
    }

    /// What cannot be flown, a line for each limit: by how much, and when.
    pub fn warnings(&self) -> Vec<String> {
        self.broken().map(warning).collect()
    }
}

/// Intervals that are named one by one.
const NAMED: usize = 3;

fn warning(quantity: &Quantity) -> String {
    let Quantity { name, unit, worst, time, limit, beyond, .. } = quantity;
    let limit = limit.unwrap_or_default();
    let mut text = format!(
        "{name} {} {unit} at {time:.2} s, limit {}: beyond by {} {unit}; ",
        number(*worst),
        number(limit),
        number((worst - limit).abs())
    );
    let spans: Vec<String> = beyond.iter().take(NAMED).map(span).collect();
    text += &spans.join(", ");
    if beyond.len() > NAMED {
        text += &format!(" and {} more times", beyond.len() - NAMED);
    }
    text
}

fn span((from, to): &(f64, f64)) -> String {
    format!("from {from:.2} to {to:.2} s")
}
