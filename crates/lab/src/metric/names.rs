//! Names, units and definitions of the metrics.

use std::sync::LazyLock;

/// How a metric is shown and what it means.
#[derive(Clone, Copy, Debug)]
pub struct About {
    /// Flat name; `*` stands for an error signal.
    pub name: &'static str,
    /// Unit; `*` stands for the signal's.
    pub unit: &'static str,
    /// Definition.
    pub doc: &'static str,
}

/// Error signals: name, unit, meaning.
pub const SIGNALS: [About; 8] = [
    About { name: "position", unit: "m", doc: "distance |x - x_ref| from the reference" },
    About { name: "position.x", unit: "m", doc: "position error along the world's x axis" },
    About { name: "position.y", unit: "m", doc: "position error along the world's y axis" },
    About { name: "position.z", unit: "m", doc: "position error along the world's z axis" },
    About {
        name: "attitude.angle",
        unit: "rad",
        doc: "rotation angle of R_e = R_ref^T R, against the law's own reference",
    },
    About {
        name: "attitude.euler",
        unit: "rad",
        doc: "norm of the roll, pitch and yaw differences, not wrapped, against the law's own reference (the article's metric)",
    },
    About {
        name: "tilt",
        unit: "rad",
        doc: "angle between the vehicle's thrust axis and the one the trajectory needs (flatness)",
    },
    About {
        name: "yaw",
        unit: "rad",
        doc: "angle between the vehicle's heading and the trajectory's",
    },
];

/// Metrics of every error signal.
pub const OF_SIGNALS: [About; 7] = [
    About { name: "*.iae", unit: "* s", doc: "integral of the absolute error: sum |e| dt" },
    About { name: "*.ise", unit: "*^2 s", doc: "integral of the squared error: sum e^2 dt" },
    About {
        name: "*.itae",
        unit: "* s^2",
        doc: "integral of time times absolute error: sum t |e| dt",
    },
    About {
        name: "*.rmse",
        unit: "*",
        doc: "root mean square error: sqrt(ISE/T), T the time flown",
    },
    About { name: "*.max", unit: "*", doc: "largest absolute error" },
    About {
        name: "*.late_max",
        unit: "*",
        doc: "largest absolute error from `run.late` on; absent where no sample lies there",
    },
    About {
        name: "*.p95",
        unit: "*",
        doc: "95th percentile of the absolute error (nearest bin of a logarithmic histogram: within 0.8 %)",
    },
];

/// Metrics of the whole flight.
pub const OF_FLIGHT: [About; 12] = [
    About { name: "time.flown", unit: "s", doc: "time until the end or the failure" },
    About {
        name: "thrust.effort",
        unit: "N^2 s",
        doc: "control effort: sum T^2 dt of the acting thrust",
    },
    About {
        name: "thrust.variation",
        unit: "N",
        doc: "total variation of the acting thrust: sum of the absolute steps (chatter)",
    },
    About { name: "thrust.max", unit: "N", doc: "largest magnitude of the acting thrust" },
    About {
        name: "torque.effort",
        unit: "N^2 m^2 s",
        doc: "control effort: sum |tau|^2 dt of the commanded torque",
    },
    About {
        name: "torque.variation",
        unit: "N m",
        doc: "total variation of the commanded torque, all axes (chatter)",
    },
    About {
        name: "saturation.share",
        unit: "1",
        doc: "share of rotor time asked to run at a speed limit",
    },
    About {
        name: "estimate.rmse",
        unit: "N",
        doc: "root mean square of estimate - lumped disturbance",
    },
    About {
        name: "estimate.lag",
        unit: "s",
        doc: "lag of the estimate: -sum(e . d')/sum(d' . d'), least squares of e = -lag d'",
    },
    About {
        name: "estimate.variation",
        unit: "N",
        doc: "total variation of the estimate error, all axes (chatter)",
    },
    About {
        name: "flags.ticks",
        unit: "count",
        doc: "ticks at which a law held its last good value",
    },
    About {
        name: "tilt.inverted_at",
        unit: "s",
        doc: "time at which the tilt first passed 90 deg; absent while it did not",
    },
];

/// The flat name of every metric that a flight can have: those of each signal, then those of the flight.
pub fn names() -> &'static [String] {
    static NAMES: LazyLock<Vec<String>> = LazyLock::new(|| {
        let of = |signal: &About| OF_SIGNALS.map(|metric| metric.name.replace('*', signal.name));
        let of_flight = OF_FLIGHT.map(|metric| metric.name.to_owned());
        SIGNALS.iter().flat_map(of).chain(of_flight).collect()
    });
    &NAMES
}

/// Unit and definition of the metric of that flat name; empty for an unknown one.
pub fn describe(name: &str) -> Option<(String, String)> {
    if let Some(about) = OF_FLIGHT.iter().find(|about| about.name == name) {
        return Some((about.unit.to_owned(), about.doc.to_owned()));
    }
    let pairs = SIGNALS.iter().flat_map(|signal| OF_SIGNALS.iter().map(move |of| (signal, of)));
    let named = |(signal, of): &(&About, &About)| of.name.replace('*', signal.name) == name;
    let (signal, of) = pairs.into_iter().find(named)?;
    Some((of.unit.replace('*', signal.unit), format!("{}, of the {}", of.doc, signal.doc)))
}

/// Whether the metric needs the attitude levels of the stack.
pub fn of_attitude(name: &str) -> bool {
    ["attitude.", "tilt.", "yaw."].iter().any(|signal| name.starts_with(signal))
}
