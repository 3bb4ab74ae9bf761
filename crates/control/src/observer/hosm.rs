//! Third-order sliding-mode (HOSM) disturbance observer from position, explicit Euler.
//!
//!   v0  = -lambda2 L^(1/3) [z0 - x]^(2/3) + z1,    z0' = v0             (1)
//!   v1  = -lambda1 L^(1/2) [z1 - v0]^(1/2) + z2,   z1' = v1 + u         (2)
//!   z2' = -lambda0 L [z2 - v1]^0                                        (3)
//!
//! with `[a]^p` = |a|^p sign(a). z0, z1, z2 estimate position, velocity and disturbance. What (2) and (3)
//! take the root and the sign of is known from (1), without subtracting it out of sums again:
//!
//!   z1 - v0 = lambda2 L^(1/3) [z0 - x]^(2/3)
//!   z2 - v1 = lambda1 L^(1/2) (lambda2 L^(1/3))^(1/2) [z0 - x]^(1/3)    (4)
//!
//! | article | here      | unit  | frame |
//! |---------|-----------|-------|-------|
//! | x1      | `x`       | m     | world |
//! | tau_f'  | `u`       | m/s^2 | world |
//! | `z2`      | `z2`        | m/s^2 | world |
//! | L0      | lipschitz | m/s^3 | world |
//!
//! The article prints z1' = v1 + tau_f' + z2, but v1 ends in + z2 already: with the doubled z2 the
//! estimate converges to half of the disturbance. It is kept as `z2 = "doubled"`.
//!
//! Source: Levant, Int. J. Control 76 (2003) 924-941; Shtessel, Shkolnikov and Levant, Automatica 43
//! (2007) 1470-1476. Valid while |d'| <= L. Explicit Euler chatters in proportion to L.

use crate::controller::Observer;
use crate::math::{Vec3, World};
use crate::real::Real;
use crate::record::each;
use crate::signals::{Applied, Measurement, Model};
use crate::{choice, options, record};

record! {
    /// Gains of the HOSM observer.
    pub struct Gains {
        /// Bound L on the rate of the disturbance.
        lipschitz: T [m/s^3] = 1.5, in 0.0 => 1e6;
        /// Innermost gain lambda0.
        lambda0: T [1] = 1.1, in 0.0 => 1e3;
        /// Middle gain lambda1.
        lambda1: T [1] = 1.5, in 0.0 => 1e3;
        /// Outer gain lambda2.
        lambda2: T [1] = 2.0, in 0.0 => 1e3;
        /// Bound on each component of the estimate.
        limit: T [m/s^2] = 1e6, in 0.0 => 1e6;
    }
}

choice! {
    /// Which acceleration the observer takes as known.
    pub enum Input {
        /// The thrust that the rotors give, along the real body axis.
        "measured" => Measured,
        /// The thrust vector that the position loop asks for.
        "commanded" => Commanded,
    }
}

choice! {
    /// How often `z2` enters the velocity equation.
    pub enum Z2 {
        /// Once, as Levant has it.
        "single" => Single,
        /// Twice, as the article prints it: converges to half of the disturbance.
        "doubled" => Doubled,
    }
}

options! {
    /// Choices of the HOSM observer.
    pub struct Options {
        /// Which acceleration the observer takes as known.
        input: Input;
        /// How often `z2` enters the velocity equation.
        z2: Z2;
    }
}

record! {
    /// HOSM observer.
    pub struct Hosm {
        /// Gains.
        gains: Gains<T> [];
        /// lambda0 L, prepared for (3).
        gain0: T [m/s^3];
        /// lambda1 L^(1/2) (lambda2 L^(1/3))^(1/2), prepared for (4).
        gain1: T [];
        /// lambda2 L^(1/3), prepared for (1).
        gain2: T [];
        /// Measured position.
        x: Vec3<T, World> [m];
        /// Estimated position.
        z0: Vec3<T, World> [m];
        /// Estimated velocity.
        z1: Vec3<T, World> [m/s];
        /// Estimated disturbance.
        z2: Vec3<T, World> [m/s^2];
        structure {
            /// Choices.
            options: Options;
        }
    }
}

impl<T: Real> Hosm<T> {
    /// The observer at rest in the origin; `reset` moves it to the vehicle.
    pub fn new(gains: Gains<T>, options: Options, _: &Model<T>) -> Self {
        let mut observer = Self { gains, options, ..Self::default() };
        observer.prepare();
        observer
    }

    /// Sum of all that is estimated. The measured position is as good as the measurement.
    #[inline(always)]
    fn estimates(&self) -> T {
        let Vec3 { x, y, z, .. } = self.z0 + self.z1 + self.z2;
        x + y + z
    }

    /// What (1) to (3) need of the gains.
    fn prepare(&mut self) {
        let Gains { lipschitz, lambda0, lambda1, lambda2, .. } = self.gains;
        self.gain0 = lambda0 * lipschitz;
        self.gain2 = lambda2 * lipschitz.cbrt();
        self.gain1 = lambda1 * lipschitz.sqrt() * self.gain2.sqrt();
    }
}

impl<T: Real> Observer<T> for Hosm<T> {
    #[inline(always)]
    fn estimate(&self) -> Vec3<T, World> {
        self.z2
    }

    #[inline(always)]
    fn correct(&mut self, measurement: &Measurement<T>, _: T) {
        self.x = measurement.position;
    }

    #[inline(always)]
    fn correct_summed(&mut self, measurement: &Measurement<T>, dt: T) -> T {
        self.correct(measurement, dt);
        self.estimates() + (self.gain0 + self.gain1 + self.gain2)
    }

    #[inline(always)]
    fn advance_summed(&mut self, applied: &Applied<T>, dt: T) -> T {
        self.advance(applied, dt);
        // A lost gain shows in what it moves.
        self.estimates()
    }

    #[inline(always)]
    fn advance(&mut self, applied: &Applied<T>, dt: T) {
        let u = match self.options.input {
            Input::Measured => applied.measured,
            Input::Commanded => applied.commanded,
        };
        let Self { gain0, gain1, gain2, x, z0, z1, z2, .. } = *self;

        let [third, two_thirds] = thirds(z0 - x);
        let v0 = z1 - two_thirds * gain2; // (1)
        let slide = third * gain1; // (4)
        let v1 = z2 - slide; // (2)
        let z1_dot = match self.options.z2 {
            Z2::Single => v1 + u,
            Z2::Doubled => v1 + u + z2,
        };
        let z2_dot = -slide.map(T::sign) * gain0; // (3)

        self.z0 += v0 * dt;
        self.z1 += z1_dot * dt;
        self.z2 += z2_dot * dt;
    }

    fn reset(&mut self, measurement: &Measurement<T>) {
        // Prepared again, or a number broken in memory would break every estimate to come.
        self.prepare();
        self.x = measurement.position;
        self.z0 = measurement.position;
        self.z1 = measurement.velocity;
        self.z2 = Vec3::zero();
    }

    fn limit(&self) -> T {
        self.gains.limit
    }
}

/// `[e]^(1/3)` and `[e]^(2/3)`.
#[inline(always)]
fn thirds<T: Real>(e: Vec3<T, World>) -> [Vec3<T, World>; 2] {
    let [x, y, z] = each([e.x, e.y, e.z], T::thirds);
    [Vec3::new(x[0], y[0], z[0]), Vec3::new(x[1], y[1], z[1])]
}
