//! Incremental nonlinear dynamic inversion (INDI) of the angular acceleration.
//!
//!   nu  = alpha - K_omega (omega - omega_des)                            (1)
//!   tau = H(tau_achieved) + I (nu - H(omega_dot)),  omega_dot = (omega_k - omega_(k-1))/dt   (2)
//!       = I nu + H(tau_achieved - I omega_dot)                           (3)
//!
//! with alpha = alpha_ref - K_theta e from the attitude law. The same filter H stands on both signals:
//! only then does their difference show the disturbance and not the filter. As it is linear, (3) filters
//! that difference, once. `filter = "none"` is the article's form (H = 1, the torque of the previous step).
//!
//! | article | here                 | unit    | frame |
//! |---------|----------------------|---------|-------|
//! | tau_f   | `achieved.torque`    | N m     | body  |
//! | omega_f'| `omega_dot`          | rad/s^2 | body  |
//!
//! Source: Sieberling, Chu and Mulder, JGCD 33 (2010) 1732-1742; Smeur, Chu and de Croon, JGCD 39 (2016)
//! 450-461; Tal and Karaman, TCST 29 (2021) 1203-1218. Valid while the torque follows within the
//! bandwidth that `K_omega` asks for.

use crate::controller::Controller;
use crate::filter::{Butterworth, Clock};
use crate::math::{Body, Vec3};
use crate::real::Real;
use crate::record::Record as _;
use crate::signals::{Measurement, Model, Rate, Wrench};
use crate::{choice, options, record};

record! {
    /// Gains of the INDI law.
    pub struct Gains {
        /// Angular acceleration per rate error, `K_omega`.
        k_omega: Vec3<T, Body> [1/s] = 25.0, in 0.0 => 1e6;
        /// Cut-off frequency of both filters.
        cutoff_hz: T [Hz] = 50.0, in 0.1 => 1e4;
        /// Bound on the magnitude of thrust and torque.
        limit: T [1] = 1e6, in 0.0 => 1e6;
    }
}

choice! {
    /// The filter on angular acceleration and torque.
    pub enum Filter {
        /// Second-order Butterworth on both.
        "butterworth" => Butterworth,
        /// None: previous step against previous step, as printed.
        "none" => Absent,
    }
}

options! {
    /// Choices of the INDI law.
    pub struct Options {
        /// The filter on angular acceleration and torque.
        filter: Filter;
    }
}

record! {
    /// INDI rate law.
    pub struct Indi {
        /// Gains.
        gains: Gains<T> [];
        /// What the law believes of the vehicle.
        model: Model<T> [];
        /// Angular velocity of the previous tick.
        previous: Vec3<T, Body> [rad/s];
        /// Time between two ticks.
        clock: Clock<T> [];
        /// Filter of the achieved torque less what the angular acceleration shows of it.
        filter: Butterworth<T> [];
        structure {
            /// Choices.
            options: Options;
        }
    }
}

impl<T: Real> Indi<T> {
    /// The law at rest.
    pub fn new(gains: Gains<T>, options: Options, model: &Model<T>) -> Self {
        Self { gains, options, model: *model, ..Self::default() }
    }
}

impl<T: Real> Controller<T> for Indi<T> {
    type Reference = Rate<T>;
    type Command = Wrench<T>;

    #[inline(always)]
    fn tune(&mut self, dt: T) {
        self.clock.tune(dt);
        if self.options.filter == Filter::Butterworth {
            self.filter.tune(self.gains.cutoff_hz, dt);
        }
    }

    #[inline(always)]
    fn update(&mut self, measurement: &Measurement<T>, reference: &Rate<T>, _: T) -> Wrench<T> {
        let omega = measurement.rate;
        let omega_dot = (omega - self.previous) * self.clock.per_step; // (2)
        self.previous = omega;
        let inertia = self.model.inertia;
        let beside = measurement.achieved.torque - omega_dot.scale(inertia);
        let beside = match self.options.filter {
            Filter::Absent => beside,
            Filter::Butterworth => self.filter.update(beside),
        };
        let nu = reference.acceleration - (omega - reference.rate).scale(self.gains.k_omega); // (1)
        Wrench { thrust: reference.thrust, torque: nu.scale(inertia) + beside } // (3)
    }

    #[inline(always)]
    fn hidden(&self) -> T {
        match self.options.filter {
            Filter::Absent => self.sum(|x| x),
            // The coefficients and the clock are in the command or in what the filter keeps.
            Filter::Butterworth => self.filter.kept(),
        }
    }

    fn reset(&mut self, measurement: &Measurement<T>) {
        self.previous = measurement.rate;
        self.clock = Clock::default();
        self.filter = Butterworth::default();
    }

    fn limit(&self) -> T {
        self.gains.limit
    }
}
