//! The course of a flight, thinned for figures.

use stormpetrel_control::math::{Frame, Vec3};

use stormpetrel_plant::actuation::battery::Gauge;

use crate::fly::Seen;

/// Three components over time.
pub type Axes = [Vec<f64>; 3];

/// Signals over time, every n-th tick.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    stride: u64,
    seen: u64,
    /// Time, s.
    pub time: Vec<f64>,
    /// Position, m.
    pub position: Axes,
    /// Reference position, m.
    pub reference: Axes,
    /// Distance from the reference, m.
    pub error: Vec<f64>,
    /// Rotation angle from the law's own attitude reference, rad.
    pub angle: Vec<f64>,
    /// Lumped disturbance, N.
    pub lumped: Axes,
    /// Its estimate, N.
    pub estimate: Axes,
    /// Thrust that acts, N.
    pub thrust: Vec<f64>,
    /// Torque that acts, N m.
    pub torque: Axes,
    /// Speed of each rotor, rad/s.
    pub rotor_speed: [Vec<f64>; 4],
    /// True force of each disturbance, N.
    pub sources: Vec<Axes>,
    /// Charge (1), voltage (V) and current (A) of the battery; empty without one.
    pub battery: [Vec<f64>; 3],
    /// True torque of each disturbance, N m.
    pub source_torques: Vec<Axes>,
    /// Velocity of the air, m/s.
    pub wind: Axes,
    /// Position that the laws are told less the true one, m.
    pub told: Axes,
    /// First peak of the position error: time (s) and height (m).
    pub first_peak: Option<(f64, f64)>,
    last_error: f64,
}

/// A position error below this is no peak, m.
const PEAK: f64 = 1e-3;

fn push<F: Frame>(axes: &mut Axes, v: Vec3<f64, F>) {
    for (axis, x) in axes.iter_mut().zip([v.x, v.y, v.z]) {
        axis.push(x);
    }
}

impl Trace {
    /// A trace of a flight of `ticks` ticks with about `points` points.
    pub fn new(ticks: u64, points: u64) -> Self {
        Self {
            stride: ticks.div_ceil(points).saturating_add(u64::from(ticks == 0)),
            ..Self::default()
        }
    }

    /// Takes a tick.
    pub fn push(&mut self, seen: &Seen<'_>) {
        let Seen { tick, errors, sources, battery } = *seen;
        if self.first_peak.is_none() && errors.position < self.last_error && self.last_error > PEAK
        {
            self.first_peak = Some((tick.time, self.last_error));
        }
        self.last_error = errors.position;
        if self.seen.is_multiple_of(self.stride) {
            self.time.push(tick.time);
            push(&mut self.position, tick.position);
            push(&mut self.reference, tick.reference.position);
            self.error.push(errors.position);
            self.angle.push(errors.angle);
            push(&mut self.lumped, tick.disturbance.lumped);
            push(&mut self.estimate, tick.estimate.force);
            self.thrust.push(tick.applied.thrust);
            push(&mut self.torque, tick.applied.torque);
            push(&mut self.wind, tick.air.wind);
            push(&mut self.told, tick.estimate.position - tick.position);
            self.sources.resize(sources.len(), Axes::default());
            self.source_torques.resize(sources.len(), Axes::default());
            let axes = self.sources.iter_mut().zip(&mut self.source_torques);
            for ((force, torque), source) in axes.zip(sources) {
                push(force, source.force);
                push(torque, source.torque);
            }
            if let Some(Gauge { charge, voltage, current }) = battery {
                for (line, x) in self.battery.iter_mut().zip([charge, voltage, current]) {
                    line.push(x);
                }
            }
            for (speeds, w) in self.rotor_speed.iter_mut().zip(tick.rotor_speed) {
                speeds.push(w);
            }
        }
        self.seen += 1;
    }
}
