//! A sensor with all that does not depend on its kind: sampling, random numbers, way and delay.

use stormpetrel_control::estimator::{Eskf, Lag};
use stormpetrel_control::real::{Mask, Real};
use stormpetrel_control::record;

use super::link::{Link, Sample};
use super::{Draw, Moment, Rows, Sense as _, Sensor, Truth};

record! {
    /// A sensor and the way of its samples.
    pub struct Channel {
        /// The sensor.
        sensor: Sensor<T> [];
        /// When it samples, and the way of the samples.
        link: Link<T> [];
        /// The motion while a sample is under way.
        lag: Lag<T> [];
    }
}

impl<T: Real> From<Sensor<T>> for Channel<T> {
    fn from(sensor: Sensor<T>) -> Self {
        Self { sensor, link: Link::new(sensor.timing()), lag: Lag::default() }
    }
}

impl<T: Real> Channel<T> {
    /// Whether the place is empty.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        matches!(self.sensor, Sensor::Unused(_))
    }

    /// The flight begins with this truth.
    pub fn begin(&mut self, truth: &Truth<T>) {
        self.link.begin();
        self.lag = Lag::default();
        self.sensor.begin(truth, self.link.once());
    }

    /// One tick: what arrives at its end.
    #[cfg_attr(debug_assertions, inline(never))] // a frame of its own without optimisation
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn sense(&mut self, truth: &Truth<T>, moment: &Moment<T>) -> Sample<T> {
        self.sensor.settle(truth, moment);
        let due = self.link.due(moment);
        // Without a sample nothing is drawn.
        let values =
            if (!due).all() { [T::zero(); 7] } else { self.sample(due, truth, moment.tick) };
        self.link.pass(due, values, moment)
    }

    #[cfg_attr(debug_assertions, inline(never))] // a frame of its own without optimisation
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn sample(&mut self, due: T::Mask, truth: &Truth<T>, tick: T) -> [T; 7] {
        let normal = self.link.normals(tick, self.sensor.pairs());
        self.sensor.sample(truth, &Draw { due, interval: self.link.interval(), normal })
    }

    /// What the filter has gone through in the last tick of `dt` seconds.
    #[inline(always)]
    pub fn follow(&mut self, filter: &Eskf<T>, dt: T) {
        self.lag.update(&filter.motion, self.link.mean_delay(), dt);
    }

    /// What the sample says of the filter's state.
    #[cfg_attr(debug_assertions, inline(never))] // a frame of its own without optimisation
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn rows(&self, sample: &Sample<T>, filter: &Eskf<T>) -> Rows<T> {
        self.sensor.rows(&sample.values, &filter.past(sample.age, &self.lag))
    }
}
