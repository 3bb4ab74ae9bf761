//! What is wrong with a set of sensors, decided once when it is loaded.

use stormpetrel_control::real::Real;
use stormpetrel_control::registry::Settings as _;

use super::link::{SLOTS, period};
use super::{Sense as _, SensorSettings};
use crate::vehicle::Vehicle;

/// Why a set of sensors cannot be flown with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// More samples would be under way than find room.
    Crowded {
        /// Position of the sensor in the list.
        sensor: usize,
        /// Its kind.
        kind: &'static str,
        /// Its latency and jitter, s.
        late: [f64; 2],
        /// The longest allowed sum of the two, s.
        longest: f64,
    },
    /// The filter needs this kind, and it is not there.
    Missing(&'static str),
    /// There may be one of this kind, and there are more.
    Twice(&'static str),
    /// The filter has nothing that tells the position.
    Unaided,
}

impl core::fmt::Display for Fault {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Crowded { sensor, kind, late: [latency, jitter], longest } => write!(
                f,
                "sensor {sensor} ({kind}): latency {latency} s and jitter {jitter} s together must not exceed {} sampling periods, here {} s",
                SLOTS - 1,
                // To the nanosecond: a product of periods has rounding errors.
                Real::round(longest * 1e9) / 1e9
            ),
            Self::Missing(kind) => write!(f, "estimation needs a sensor of kind {kind}"),
            Self::Twice(kind) => write!(f, "there may be only one sensor of kind {kind}"),
            Self::Unaided => write!(f, "estimation needs motion-capture, gnss or optical-flow"),
        }
    }
}

/// Whether the filter can be flown with these sensors at this control step, s.
///
/// # Errors
/// The first thing that is wrong.
pub fn check(sensors: &[SensorSettings], control_step: f64) -> Result<(), Fault> {
    let count = |kind: &str| sensors.iter().filter(|sensor| sensor.name() == kind).count();
    for kind in ["gyro", "accelerometer"] {
        if count(kind) == 0 {
            return Err(Fault::Missing(kind));
        }
    }
    for kind in ["gyro", "accelerometer", "rotor-speed"] {
        if count(kind) > 1 {
            return Err(Fault::Twice(kind));
        }
    }
    if ["motion-capture", "gnss", "optical-flow"].iter().all(|kind| count(kind) == 0) {
        return Err(Fault::Unaided);
    }
    for (sensor, settings) in sensors.iter().enumerate() {
        let timing = settings.build(&Vehicle::default()).timing();
        let longest = (SLOTS - 1) as f64 * period(timing.rate_hz, control_step) * control_step;
        // A rounding error must not refuse seven periods that are meant.
        if timing.latency + timing.jitter > longest * (1.0 + 1e-9) {
            return Err(Fault::Crowded {
                sensor,
                kind: settings.name(),
                late: [timing.latency, timing.jitter],
                longest,
            });
        }
    }
    Ok(())
}
