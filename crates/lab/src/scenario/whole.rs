//! Rules that look at more than one field of a scenario.

use stormpetrel_control::record::Record as _;
use stormpetrel_control::registry::Settings as _;
use stormpetrel_plant::actuation::ActuationSettings;
use stormpetrel_plant::disturbance::{DisturbanceSettings, SourceSettings};
use stormpetrel_plant::sensor;
use stormpetrel_plant::timing::LATEST;
use stormpetrel_plant::vehicle::{Arms, Vehicle};

use super::document::{Table, Value};
use super::fault::{Fault, Place};
use super::{ATTITUDE_LEVELS, Scenario};

/// Most control ticks of one flight.
const MOST_TICKS: f64 = 1e8;
/// Most integration steps of one flight: some minutes.
const MOST_STEPS: f64 = 1e9;
/// Most rows of one log.
const MOST_ROWS: f64 = 5e6;
/// Most rows of the logs of one command.
const MOST_ROWS_OF_ALL: f64 = 2e7;
/// Bytes of a row of the log, about.
const ROW: f64 = 1000.0;
/// What of a vehicle only real propulsion asks.
const OF_PROPULSION: [&str; 6] = [
    "motor_lag_fall",
    "rotor_dead_zone",
    "rotor_inertia",
    "rotor_radius",
    "inflow_loss",
    "flapping",
];

/// What of the propulsion only a battery asks.
const OF_BATTERY: [&str; 7] = [
    "battery_full",
    "battery_empty",
    "battery_resistance",
    "battery_capacity",
    "battery_charge",
    "speed_per_volt",
    "open_circuit",
];

/// Collects faults with the places of their blocks.
struct Judge<'a> {
    scenario: &'a Scenario,
    tree: &'a Table,
    broken: &'a [&'a str],
    faults: &'a mut Vec<Fault>,
}

/// What is wrong with the scenario as a whole. A block with a fault of its own has defaults in it, so
/// nothing is said about the whole of it.
pub(super) fn check(scenario: &Scenario, tree: &Table, broken: &[&str], faults: &mut Vec<Fault>) {
    let mut judge = Judge { scenario, tree, broken, faults };
    judge.levels();
    judge.steps();
    judge.inertia();
    judge.rotors();
    judge.layout();
    judge.propulsion();
    judge.disturbances();
    judge.timing();
    judge.sensors();
    judge.start();
}

impl Judge<'_> {
    fn say(&mut self, block: &str, message: String, help: &str) {
        let place = self.tree.get(block).map(|node| node.place.clone());
        self.say_at(block, place, message, help);
    }

    fn say_at(&mut self, block: &str, place: Option<Place>, message: String, help: &str) {
        if !self.broken.contains(&block) {
            self.faults.push(Fault { place, message, help: Some(help.to_owned()) });
        }
    }

    /// The place of a key in a block, if the file has it.
    fn key(&self, block: &str, key: &str) -> Option<Place> {
        match &self.tree.get(block)?.value {
            Value::Table(table) => table.get(key).map(|node| node.place.clone()),
            _ => None,
        }
    }

    /// The place of an item of a list of blocks.
    fn item(&self, list: &str, number: usize) -> Option<Place> {
        match &self.tree.get(list)?.value {
            Value::List(items) => items.get(number).map(|node| node.place.clone()),
            _ => None,
        }
    }

    fn actuation(&self) -> &'static str {
        self.scenario.actuation.name()
    }

    fn levels(&mut self) {
        if self.scenario.has_attitude() || self.broken.contains(&"actuation") {
            return;
        }
        for block in ATTITUDE_LEVELS {
            if self.tree.get(block).is_some() {
                let message = format!("`{block}` is never asked: actuation is `thrust-vector`");
                self.say(block, message, "take the block out, or choose another actuation");
            }
        }
    }

    fn steps(&mut self) {
        let run = &self.scenario.run;
        let ticks = run.duration / run.control_step;
        let steps = ticks * run.substeps;
        if ticks > MOST_TICKS {
            let message =
                format!("`run`: {ticks:.3e} control steps: a flight has at most {MOST_TICKS:e}");
            self.say("run", message, "shorten run.duration or lengthen run.control_step");
        } else if (ticks - ticks.round()).abs() > 1e-6 * ticks || ticks < 1.0 {
            let message = format!(
                "`run.duration` = {} is not a multiple of `run.control_step` = {}",
                run.duration, run.control_step
            );
            self.say("run", message, "a flight is a whole number of control steps");
        }
        if steps > MOST_STEPS && ticks <= MOST_TICKS {
            let minutes = steps / 2e6 / 60.0;
            let message = format!(
                "`run`: {steps:.1e} integration steps, about {minutes:.0} min: a flight has at most {MOST_STEPS:e}"
            );
            let help = "lower run.substeps, shorten run.duration or lengthen run.control_step";
            self.say("run", message, help);
        }
    }

    fn inertia(&mut self) {
        let inertia = self.scenario.vehicle.vehicle.inertia;
        let (x, y, z) = (inertia.x, inertia.y, inertia.z);
        for (a, b, c) in [(x, y, z), (y, z, x), (z, x, y)] {
            if a > (b + c) * (1.0 + 1e-12) {
                let message = format!(
                    "`vehicle.inertia` = [{x}, {y}, {z}]: one moment exceeds the sum of the others"
                );
                let help = "no rigid body has such moments: check their order and units";
                self.say("vehicle", message, help);
            }
        }
    }

    fn rotors(&mut self) {
        let Vehicle { rotor_speed_min: min, rotor_speed_max: max, rotor_dead_zone, .. } =
            self.scenario.vehicle.vehicle;
        if min >= max {
            let message = format!(
                "`vehicle.rotor_speed_min` = {min} is not below `vehicle.rotor_speed_max` = {max}"
            );
            self.say("vehicle", message, "are the two swapped?");
        }
        if rotor_dead_zone >= max {
            let message = format!(
                "`vehicle.rotor_dead_zone` = {rotor_dead_zone} is not below `vehicle.rotor_speed_max` = {max}"
            );
            self.say("vehicle", message, "no rotor would ever turn: lower it");
        }
    }

    fn layout(&mut self) {
        let vehicle = &self.scenario.vehicle.vehicle;
        let (free, rows) = (vehicle.layout.arms == Arms::Free, vehicle.layout.rotors);
        if let (false, Some(place)) = (free, self.key("vehicle", "rotors")) {
            let message = "`vehicle.rotors` is never asked: the layout has a name".to_owned();
            self.say_at("vehicle", Some(place), message, "write layout = \"free\" beside it");
            return;
        }
        if free && rows.len() != 4 {
            let message = format!(
                "`vehicle.rotors` has {} rows: a free layout has four, each with a spin of 1 or -1",
                rows.len()
            );
            self.say(
                "vehicle",
                message,
                "write rotors = [[x, y, z, spin], ...], spin 1 counter-clockwise",
            );
        } else if vehicle.allocation().inverse == <[[f64; 4]; 4]>::default() {
            let message = "`vehicle.rotors`: four such rotors cannot make every thrust and torque";
            let help = "two diagonal pairs with opposite spins can: check places and spins";
            self.say("vehicle", message.to_owned(), help);
        }
    }

    fn propulsion(&mut self) {
        let actuation = self.actuation();
        if let ActuationSettings::Propulsion(gains, _) = &self.scenario.actuation {
            let (full, empty) = (gains.battery_full, gains.battery_empty);
            if empty > full {
                let message = format!(
                    "`actuation.battery_empty` = {empty} exceeds `actuation.battery_full` = {full}"
                );
                self.say("actuation", message, "are the two swapped?");
            }
            if !self.scenario.has_battery() {
                self.never_asked(
                    "actuation",
                    &OF_BATTERY,
                    "supply is `ideal`",
                    "add supply = \"battery\", or take it out",
                );
            }
            return;
        }
        let why = format!("actuation is `{actuation}`");
        let help = "choose actuation = { kind = \"propulsion\" }, or take it out";
        self.never_asked("vehicle", &OF_PROPULSION, &why, help);
    }

    /// Keys that the file gives and nothing asks.
    fn never_asked(&mut self, block: &str, keys: &[&str], why: &str, help: &str) {
        for key in keys {
            if let Some(place) = self.key(block, key) {
                let message = format!("`{block}.{key}` is never asked: {why}");
                self.say_at(block, Some(place), message, help);
            }
        }
    }

    fn start(&mut self) {
        if self.faults.is_empty() && !self.scenario.flight().state.finite() {
            let message = "`start.attitude` = \"flatness\": the reference asks for no thrust at the start, so for no attitude";
            let help = "write start.attitude = \"level\", or check vehicle.gravity";
            self.say("start", message.to_owned(), help);
        }
    }

    fn disturbances(&mut self) {
        let vehicle = &self.scenario.vehicle.vehicle;
        let rotors = matches!(self.scenario.actuation, ActuationSettings::Propulsion(..));
        let blown = rotors && vehicle.inflow_loss + vehicle.flapping > 0.0;
        let airless = !(vehicle.feels_air() || blown);
        let (actuation, mut hanging) = (self.actuation(), 0);
        for (i, SourceSettings { window, what }) in self.scenario.disturbance.iter().enumerate() {
            let (kind, place) = (what.name(), self.item("disturbance", i));
            let mut say = |message: String, help: &str| {
                self.say_at(
                    "disturbance",
                    place.clone(),
                    format!("`disturbance.{i}` {message}"),
                    help,
                );
            };
            if window.end <= window.start {
                let (start, end) = (window.start, window.end);
                say(
                    format!("ends at {end} s, not after its start at {start} s"),
                    "are the two swapped?",
                );
            }
            match what {
                DisturbanceSettings::RotorEfficiency(..)
                | DisturbanceSettings::RotorStuck(..)
                | DisturbanceSettings::RotorLost(..)
                    if !rotors =>
                {
                    say(
                        format!("({kind}) breaks a rotor: actuation is `{actuation}`"),
                        "choose actuation = { kind = \"propulsion\" }",
                    );
                }
                DisturbanceSettings::Wind(..)
                | DisturbanceSettings::Gust(..)
                | DisturbanceSettings::Shear(..)
                | DisturbanceSettings::Jet(..)
                | DisturbanceSettings::Dryden(..)
                | DisturbanceSettings::RecordedWind(..)
                    if airless =>
                {
                    say(
                        format!("({kind}) has no effect: the vehicle has no drag"),
                        "give vehicle.rotor_drag or vehicle.body_drag, or choose a preset with drag",
                    );
                }
                DisturbanceSettings::Shear(gains, ()) if gains.roughness >= gains.height => {
                    let (rough, high) = (gains.roughness, gains.height);
                    say(
                        format!("has `roughness` = {rough} m, not below `height` = {high} m"),
                        "are the two swapped? grass has a roughness of some centimetres",
                    );
                }
                DisturbanceSettings::SlungMass(..) => hanging += 1,
                _ => {}
            }
            if hanging > 1 {
                hanging = 0;
                say("is a second slung mass: one can hang".into(), "take one of them out");
            }
        }
    }

    fn timing(&mut self) {
        let (timing, step) = (&self.scenario.timing, self.scenario.run.control_step);
        let late = timing.computation_delay + timing.actuator_delay + timing.jitter;
        let most = LATEST as f64 * step;
        if late > most * (1.0 + 1e-9) {
            let message = format!(
                "`timing`: commands up to {late} s late: at most {LATEST} control steps, here {most} s"
            );
            self.say("timing", message, "shorten the delays, or lengthen run.control_step");
        }
    }

    fn sensors(&mut self) {
        if self.scenario.sensor.is_empty() {
            if self.tree.get("estimator").is_some() {
                let message = "`estimator` is never asked: there is no sensor".to_owned();
                self.say("estimator", message, "add [[sensor]] blocks, or take it out");
            }
            return;
        }
        let step = self.scenario.run.control_step;
        match sensor::check(&self.scenario.sensor, step) {
            Err(fault @ sensor::Fault::Crowded { sensor, .. }) => self.crowded(sensor, &fault),
            Err(fault) => {
                let help =
                    "see `stormpetrel list sensor`; without any sensor the laws see the truth";
                self.say("sensor", format!("`sensor`: {fault}"), help);
            }
            Ok(()) => {}
        }
    }

    /// A sensor whose samples are under way for too long.
    fn crowded(&mut self, sensor: usize, fault: &sensor::Fault) {
        let item = match self.tree.get("sensor").map(|node| &node.value) {
            Some(Value::List(items)) => items.get(sensor),
            _ => None,
        };
        let given = |key: &str| match item.map(|node| &node.value) {
            Some(Value::Table(table)) => table.get(key).map(|node| node.place.clone()),
            _ => None,
        };
        let latency = given("latency");
        let default = if latency.is_none() { "; this latency is the default" } else { "" };
        let place = latency.or_else(|| item.map(|node| node.place.clone()));
        let message = format!("`sensor`: {fault}{default}");
        self.say_at("sensor", place, message, "lower `latency` or `jitter`, or lower `rate_hz`");
    }
}

/// Why these flights cannot be logged.
pub fn too_long(scenarios: &[Scenario]) -> Option<Fault> {
    let rows = |scenario: &Scenario| scenario.ticks() as f64 / scenario.run.log_every;
    let fault = |who: &str, rows: f64, most: f64, help: &str| {
        let size = rows * ROW / 1e9;
        let message =
            format!("{who} would have {rows:.1e} rows, about {size:.0} GB: at most {most:e}");
        Some(Fault::general(message).help(help))
    };
    if let Some(long) = scenarios.iter().find(|scenario| rows(scenario) > MOST_ROWS) {
        let who = format!("{}: the log", long.name);
        return fault(&who, rows(long), MOST_ROWS, "raise run.log_every");
    }
    let sum: f64 = scenarios.iter().map(rows).sum();
    if sum <= MOST_ROWS_OF_ALL {
        return None;
    }
    let who = format!("the logs of {} flights", scenarios.len());
    fault(&who, sum, MOST_ROWS_OF_ALL, "raise run.log_every, or fly fewer variants at once")
}
