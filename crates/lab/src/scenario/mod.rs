//! A scenario: one line for each block of the control diagram.

mod base;
pub mod document;
pub mod expect;
mod expectations;
pub mod fault;
mod layout;
mod load;
pub mod read;
mod resolve;
mod rows;
mod schema;
mod source;
mod structure;
mod whole;

use stormpetrel_control::attitude::AttitudeLawSettings;
use stormpetrel_control::attitude_reference::{
    AttitudeReferenceSettings, attitude_along, flatness_rates,
};
use stormpetrel_control::estimator::{Eskf, eskf};
use stormpetrel_control::math::{Euler, Rotation, Vec3, World};
use stormpetrel_control::observer::ObserverSettings;
use stormpetrel_control::options::Options;
use stormpetrel_control::position::PositionSettings;
use stormpetrel_control::rate::RateLawSettings;
use stormpetrel_control::record::Record;
use stormpetrel_control::registry::Settings;
use stormpetrel_control::signals::{Model, Thrust};
use stormpetrel_control::stack::{Exit, Laws, Rhythm, Stack};
use stormpetrel_control::{choice, options, record};
use stormpetrel_plant::actuation::propulsion::Supply;
use stormpetrel_plant::actuation::{Actuate, ActuationSettings};
use stormpetrel_plant::disturbance::{Site, SourceSettings};
use stormpetrel_plant::flight::{Flight, Limits};
use stormpetrel_plant::random;
use stormpetrel_plant::reference::{Refer, ReferenceSettings};
use stormpetrel_plant::sensor::SensorSettings;
use stormpetrel_plant::state::State;
use stormpetrel_plant::timing::{Delays, Timing};
use stormpetrel_plant::vehicle::VehicleSettings;

pub use base::Base;
pub use load::{File, load, load_text};
pub use schema::schema;
pub use whole::too_long;

record! {
    /// Times and counts of a flight.
    pub struct Run {
        /// Length of the flight.
        duration: T [s] = 20.0, in 1e-3 => 1e5;
        /// Time between two commands.
        control_step: T [s] = 0.001, in 1e-5 => 0.1;
        /// Integration steps in one control step.
        substeps: T [count] = 2.0, in 1.0 => 1000.0;
        /// Master seed of all random draws.
        seed: T [count] = 1.0, in 0.0 => 9e15;
        /// Begin of the window for the late maximum.
        late: T [s] = 10.0, in 0.0 => 1e5;
        /// One row of the log for this many control steps.
        log_every: T [count] = 1.0, in 1.0 => 1e9;
    }
}

record! {
    /// How often each level acts.
    pub struct Rates {
        /// Control steps from one update of position law and observer to the next.
        position_every: T [count] = 1.0, in 1.0 => 1000.0;
        /// Control steps from one update of the attitude to the next.
        attitude_every: T [count] = 1.0, in 1.0 => 1000.0;
        /// Control steps from one update of the rate law to the next.
        rate_every: T [count] = 1.0, in 1.0 => 1000.0;
    }
}

impl Rates<f64> {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // the ranges are small
    fn rhythm(&self) -> Rhythm {
        Rhythm {
            position: self.position_every as u32,
            attitude: self.attitude_every as u32,
            rate: self.rate_every as u32,
        }
    }
}

record! {
    /// Where the flight begins, relative to the reference.
    pub struct Start {
        /// Distance from the reference's first point.
        offset: Vec3<T, World> [m] = 0.0, in -1e6 => 1e6;
    }
}

choice! {
    /// Attitude at the start.
    pub enum StartAttitude {
        /// Level, at the reference's heading, not turning.
        "level" => Level,
        /// The attitude and rate that the trajectory needs.
        "flatness" => Flatness,
    }
}

options! {
    /// Choices of the start.
    pub struct StartOptions {
        /// Attitude at the start.
        attitude: StartAttitude;
    }
}

choice! {
    /// Whether a flight may fail.
    pub enum Allowed {
        /// A failed flight is an error.
        "false" => No,
        /// A failed flight is a result.
        "true" => Yes,
    }
}

options! {
    /// Choices about failure.
    pub struct FailureOptions {
        /// Whether a failed flight is a result and not an error.
        allowed: Allowed;
    }
}

/// One flight, completely described.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// `article/consistent`, with `:name` for a variant.
    pub name: String,
    /// Name of the variant, where it is one.
    pub variant: Option<String>,
    /// One line.
    pub title: String,
    /// What it shows.
    pub about: String,
    /// Times and counts.
    pub run: Run<f64>,
    /// The vehicle.
    pub vehicle: VehicleSettings,
    /// What the laws believe of it.
    pub model: Model<f64>,
    /// Where to fly.
    pub reference: ReferenceSettings,
    /// Where the flight begins.
    pub start: Start<f64>,
    /// Choices of the start.
    pub start_options: StartOptions,
    /// Position law.
    pub position: PositionSettings,
    /// Disturbance observer.
    pub observer: ObserverSettings,
    /// Attitude reference.
    pub attitude_reference: AttitudeReferenceSettings,
    /// Attitude law.
    pub attitude: AttitudeLawSettings,
    /// Rate law.
    pub rate: RateLawSettings,
    /// Between laws and body.
    pub actuation: ActuationSettings,
    /// What the laws see through; perfect where there is none.
    pub sensor: Vec<SensorSettings>,
    /// What the filter believes of the sensors.
    pub estimator: eskf::Gains<f64>,
    /// How often each level acts.
    pub rates: Rates<f64>,
    /// When commands reach the rotors.
    pub timing: Delays<f64>,
    /// What pushes.
    pub disturbance: Vec<SourceSettings>,
    /// When the flight counts as failed.
    pub failure: Limits<f64>,
    /// Choices about failure.
    pub failure_options: FailureOptions,
    /// Numbers that the flight must show.
    pub expect: Vec<expect::Expectation>,
}

/// Walks over the blocks of a scenario: loading, schema and manifest are one walk each.
pub trait BlockVisitor {
    /// Whether it fills the blocks in: a block may then take its defaults from the ones before.
    fn fills(&self) -> bool {
        false
    }
    /// A block that names its law.
    fn block<S: Settings>(&mut self, key: &'static str, doc: &'static str, settings: &mut S);
    /// A list of such blocks.
    fn list<S: Settings>(&mut self, key: &'static str, doc: &'static str, settings: &mut Vec<S>);
    /// A block without a law to choose.
    fn plain<R: Record<f64>, O: Options>(
        &mut self,
        key: &'static str,
        doc: &'static str,
        numbers: &mut R,
        options: &mut O,
    );
}

/// The keys that only a stack down to the wrench has.
pub const ATTITUDE_LEVELS: [&str; 3] = ["attitude_reference", "attitude", "rate"];

impl Scenario {
    /// Shows every block to the visitor, in the order of the control diagram.
    pub fn blocks(&mut self, v: &mut impl BlockVisitor) {
        v.plain("run", "Times and counts of the flight.", &mut self.run, &mut ());
        v.block("vehicle", "The vehicle.", &mut self.vehicle);
        if v.fills() {
            self.model = self.vehicle.vehicle.model();
        }
        v.plain(
            "model",
            "What the laws believe of the vehicle, where it differs.",
            &mut self.model,
            &mut (),
        );
        v.block("reference", "Where to fly.", &mut self.reference);
        v.plain("start", "Where the flight begins.", &mut self.start, &mut self.start_options);
        v.block("position", "Position law.", &mut self.position);
        v.block("observer", "Disturbance observer.", &mut self.observer);
        v.block(
            "attitude_reference",
            "From thrust vector to attitude.",
            &mut self.attitude_reference,
        );
        v.block("attitude", "Attitude law.", &mut self.attitude);
        v.block("rate", "Rate law.", &mut self.rate);
        v.block("actuation", "Between laws and body.", &mut self.actuation);
        v.list("sensor", "What the laws see through; the truth without any.", &mut self.sensor);
        v.plain(
            "estimator",
            "What the error-state Kalman filter believes of the sensors.",
            &mut self.estimator,
            &mut (),
        );
        v.plain("rates", "How often each level acts.", &mut self.rates, &mut ());
        v.plain("timing", "When commands reach the rotors.", &mut self.timing, &mut ());
        v.list("disturbance", "What pushes the vehicle.", &mut self.disturbance);
        v.plain(
            "failure",
            "When the flight counts as failed.",
            &mut self.failure,
            &mut self.failure_options,
        );
    }

    /// Number of control ticks.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // checked on loading
    pub fn ticks(&self) -> u64 {
        (self.run.duration / self.run.control_step).round() as u64
    }

    /// Whether a failed flight is a result and not an error.
    pub fn may_fail(&self) -> bool {
        self.failure_options.allowed == Allowed::Yes
    }

    /// Whether the attitude levels of the stack run.
    pub fn has_attitude(&self) -> bool {
        !matches!(self.actuation, ActuationSettings::ThrustVector(..))
    }

    /// Whether real rotors with limits fly it.
    pub fn has_rotors(&self) -> bool {
        matches!(self.actuation, ActuationSettings::Rotors(..) | ActuationSettings::Propulsion(..))
    }

    /// Whether a battery feeds the rotors.
    pub fn has_battery(&self) -> bool {
        matches!(&self.actuation, ActuationSettings::Propulsion(_, o) if o.supply == Supply::Battery)
    }

    /// A line on each disturbance that never acts in this flight.
    pub fn idle(&self) -> Vec<String> {
        let duration = self.run.duration;
        let idle = self.disturbance.iter().enumerate().filter(|(_, s)| !s.window.meets(duration));
        let line = |(i, source): (usize, &SourceSettings)| {
            let (kind, start) = (source.name(), source.window.start);
            format!(
                "`disturbance.{i}` ({kind}) never acts: it starts at {start} s, the flight ends at {duration} s"
            )
        };
        idle.map(line).collect()
    }

    /// Key of all random draws of the flight.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // whole and below 2^53
    fn key(&self) -> u64 {
        random::key(self.run.seed as u64, 0)
    }

    /// The flight, ready to start its first tick.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // checked on loading
    pub fn flight(&self) -> Flight<f64> {
        let (vehicle, model) = (self.vehicle.vehicle, self.model);
        let laws = Laws {
            position: self.position.build(&model),
            observer: self.observer.build(&model),
            attitude_reference: self.attitude_reference.build(&model),
            attitude: self.attitude.build(&model),
            rate: self.rate.build(&model),
        };
        let actuation = self.actuation.build(&vehicle);
        let exit: Exit = actuation.exit();
        let mut flight = Flight {
            vehicle,
            model,
            stack: Stack::new(laws, exit, self.rates.rhythm()),
            actuation,
            reference: self.reference.build(&vehicle),
            limits: self.failure,
            control_step: self.run.control_step,
            substeps: self.run.substeps as u32,
            ..Flight::default()
        };
        let site = Site { vehicle, step: self.run.control_step, key: self.key() };
        flight.timing = Timing::new(self.timing, site.at("timing", 0).key);
        flight.sensing.estimate = !self.sensor.is_empty();
        flight.sensing.filter = Eskf::new(self.estimator, &model);
        for (channel, sensor) in flight.sensing.channels.iter_mut().zip(&self.sensor) {
            *channel = sensor.build(&vehicle).into();
        }
        flight.sensing.seed(site.at("sensor", 0).key);
        for (i, slot) in flight.disturbance.iter_mut().take(self.disturbance.len()).enumerate() {
            let kind = self.disturbance[i].name();
            let twins = self.disturbance[..i].iter().filter(|other| other.name() == kind).count();
            *slot = self.disturbance[i].build(&site.at(kind, twins));
        }
        flight.start(self.first_state(&flight));
        flight
    }

    fn first_state(&self, flight: &Flight<f64>) -> State<f64> {
        let first = flight.reference.at(0.0);
        let hover = self.vehicle.vehicle.hover_speed();
        let level = State {
            position: first.position + self.start.offset,
            velocity: first.velocity,
            attitude: Rotation::from_euler(Euler { roll: 0.0, pitch: 0.0, yaw: first.yaw }),
            rotor_speed: [hover; 4],
            ..State::default()
        };
        if self.start_options.attitude == StartAttitude::Level {
            return level;
        }
        let thrust = Thrust {
            force: first.acceleration + Vec3::up(self.model.gravity),
            force_rate: first.jerk,
            force_acceleration: first.snap,
            yaw: first.yaw,
            yaw_rate: first.yaw_rate,
            yaw_acceleration: first.yaw_acceleration,
        };
        let attitude = attitude_along(thrust.force, first.yaw);
        let (rate, _) = flatness_rates(attitude, &thrust);
        State { attitude, rate, ..level }
    }
}
