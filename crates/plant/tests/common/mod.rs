//! What the test files share: flights set up by hand.
#![allow(dead_code)] // no test file needs all of it

use stormpetrel_control::attitude::AttitudeLawSettings;
use stormpetrel_control::attitude_reference::{AttitudeReferenceSettings, Rates, rotation};
use stormpetrel_control::math::{Body, Vec3, World};
use stormpetrel_control::observer::{ObserverSettings, hosm};
use stormpetrel_control::position::{PositionSettings, pid};
use stormpetrel_control::rate::{RateLawSettings, indi};
use stormpetrel_control::record::{Meta, Path, Record, Visitor};
use stormpetrel_control::registry::Settings;
use stormpetrel_control::stack::{Laws, Rhythm, Stack};
use stormpetrel_plant::actuation::{Actuate, ActuationSettings};
use stormpetrel_plant::disturbance::{
    DisturbanceSettings, Site, Source, SourceSettings, Window, harmonic,
};
use stormpetrel_plant::dynamics::{Held, Push, Reciprocals, runge_kutta};
use stormpetrel_plant::flight::Flight;
use stormpetrel_plant::reference::{Refer, ReferenceSettings};
use stormpetrel_plant::state::State;
use stormpetrel_plant::vehicle::{Vehicle, VehicleSettings};

/// A vector in the world's axes.
pub fn world(x: f64, y: f64, z: f64) -> Vec3<f64, World> {
    Vec3::new(x, y, z)
}

/// A vector in the body's axes.
pub fn body(x: f64, y: f64, z: f64) -> Vec3<f64, Body> {
    Vec3::new(x, y, z)
}

/// What one flight is made of. The default is the model behind the golden values of theory 1.4.
#[derive(Clone, Copy)]
pub struct Scene {
    pub vehicle: Vehicle<f64>,
    pub position: pid::Gains<f64>,
    pub observer: ObserverSettings,
    pub attitude_reference: AttitudeReferenceSettings,
    pub attitude: AttitudeLawSettings,
    pub rate: RateLawSettings,
    pub actuation: ActuationSettings,
    pub reference: ReferenceSettings,
    pub disturbance: harmonic::Gains<f64>,
    pub control_step: f64,
    pub substeps: u32,
}

impl Default for Scene {
    fn default() -> Self {
        Self {
            vehicle: VehicleSettings::named("article-corrected").expect("a preset").vehicle,
            position: pid::Gains::default(),
            observer: named("none"),
            attitude_reference: rotation_reference(Rates::Zero),
            attitude: named("tilt-priority"),
            rate: named("indi"),
            actuation: named("lagged-wrench"),
            reference: named("helix"),
            disturbance: harmonic::Gains {
                force: Vec3::splat(0.5),
                torque: Vec3::splat(0.02),
                ..harmonic::Gains::default()
            },
            control_step: 1e-3,
            substeps: 2,
        }
    }
}

/// The settings of that name.
pub fn named<S: Settings>(name: &str) -> S {
    S::named(name).expect("a name in the registry")
}

/// The rotation-matrix reference with that source of rates.
pub fn rotation_reference(rates: Rates) -> AttitudeReferenceSettings {
    AttitudeReferenceSettings::RotationMatrix(
        rotation::Gains::default(),
        rotation::Options { rates },
    )
}

/// The HOSM observer.
pub fn hosm(lipschitz: f64, input: hosm::Input, z2: hosm::Z2) -> ObserverSettings {
    let gains = hosm::Gains { lipschitz, ..hosm::Gains::default() };
    ObserverSettings::Hosm(gains, hosm::Options { input, z2 })
}

/// The position law with one gain for all axes.
pub fn gains(kp: f64, ki: f64, kd: f64) -> pid::Gains<f64> {
    let [kp, ki, kd] = [kp, ki, kd].map(Vec3::splat);
    pid::Gains { kp, ki, kd, ..pid::Gains::default() }
}

/// INDI without filter.
pub fn unfiltered() -> RateLawSettings {
    let options = indi::Options { filter: indi::Filter::Absent };
    RateLawSettings::Indi(indi::Gains::default(), options)
}

impl Scene {
    /// The flight, on its reference and level, rotors at hover speed, air calm where nothing pushes.
    pub fn flight(&self) -> Flight<f64> {
        let vehicle = self.vehicle;
        let model = vehicle.model();
        let laws = Laws {
            position: PositionSettings::Pid(self.position, ()).build(&model),
            observer: self.observer.build(&model),
            attitude_reference: self.attitude_reference.build(&model),
            attitude: self.attitude.build(&model),
            rate: self.rate.build(&model),
        };
        let actuation = self.actuation.build(&vehicle);
        let mut flight = Flight {
            vehicle,
            model,
            stack: Stack::new(laws, actuation.exit(), Rhythm::default()),
            actuation,
            reference: self.reference.build(&vehicle),
            control_step: self.control_step,
            substeps: self.substeps,
            ..Flight::default()
        };
        flight.disturbance[0] =
            source(DisturbanceSettings::Harmonic(self.disturbance, ()), &vehicle);
        let start = flight.reference.at(0.0);
        flight.start(State {
            position: start.position,
            velocity: start.velocity,
            rotor_speed: [vehicle.hover_speed(); 4],
            ..State::default()
        });
        flight
    }

    /// The same without disturbance.
    pub fn calm(mut self) -> Self {
        self.disturbance = harmonic::Gains::default();
        self
    }
}

/// The disturbance over the whole flight, at 1 kHz.
pub fn source(what: DisturbanceSettings, vehicle: &Vehicle<f64>) -> Source<f64> {
    let site = Site { vehicle: *vehicle, step: 0.001, key: 1 };
    SourceSettings { window: Window::default(), what }.build(&site)
}

/// One tick.
pub fn step(flight: &mut Flight<f64>) {
    let tick = flight.decide();
    flight.advance(&tick);
}

/// A body without thrust, gravity or torque but those given.
pub struct Free {
    pub vehicle: Vehicle<f64>,
    pub push: Push<f64>,
}

impl Free {
    pub fn new(inertia: Vec3<f64, Body>) -> Self {
        let vehicle = Vehicle { inertia, gravity: 0.0, mass: 1.0, ..Vehicle::default() };
        Self { vehicle, push: Push::default() }
    }

    /// The state after so many steps of `h` seconds; `see` is shown each.
    pub fn fly(
        &self,
        start: State<f64>,
        h: f64,
        steps: u32,
        mut see: impl FnMut(&State<f64>),
    ) -> State<f64> {
        let actuation =
            ActuationSettings::named("wrench").expect("an actuation").build(&self.vehicle);
        let held = Held::new(&Reciprocals::new(&self.vehicle), &self.push);
        (0..steps).fold(start, |state, _| {
            let next = runge_kutta(&state, h, &self.vehicle, &actuation, &held);
            see(&next);
            next
        })
    }
}

struct Bits(Vec<u64>);

impl Visitor<f64> for Bits {
    fn number(&mut self, _: &Path<'_>, _: &Meta, value: f64) {
        self.0.push(value.to_bits());
    }
}

/// The bits of all numbers of the record.
pub fn bits(record: &impl Record<f64>) -> Vec<u64> {
    let mut all = Bits(Vec::new());
    record.visit(&Path::ROOT, &Meta::signal("", ""), &mut all);
    all.0
}

/// Slope of the straight line through the points, by least squares.
pub fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let mean = |f: fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>() / n;
    let (mx, my) = (mean(|p| p.0), mean(|p| p.1));
    points.iter().map(|p| (p.0 - mx) * (p.1 - my)).sum::<f64>()
        / points.iter().map(|p| (p.0 - mx) * (p.0 - mx)).sum::<f64>()
}
