//! Roll and pitch reference from the thrust vector, as the article prints it.
//!
//!   phi_ref   = arcsin((f1 sin psi - f2 cos psi)/|F|)                    (1)
//!   theta_ref = arctan((f1 cos psi + f2 sin psi)/(f3 + g))               (2)
//!   T = m F . (R e_z)                                                    (3)
//!
//! with F = f + g e_z. The arctangent of (2) takes the wrong branch where F points downwards: the
//! thrust axis comes out mirrored. `pitch = "atan2"` repairs the branch; the Euler singularity at 90
//! deg stays. Both make the reference as a rotation; the angles are read from it again where a law
//! works on angles.
//!
//! Source: the article, attitude computation. Valid for F upwards (`arctan`) or |theta| < 90 deg.

use super::{RateMemory, Rates, projected_thrust};
use crate::controller::Controller;
use crate::math::{Body, Euler, Rotation, World};
use crate::real::Real;
use crate::record::RecordExt as _;
use crate::signals::{Attitude, Measurement, Model, Thrust};
use crate::{choice, options, record};

record! {
    /// Numbers of the Euler-angle reference.
    pub struct Gains {
        /// Bound on the magnitude of thrust (N) and rates (rad/s).
        limit: T [1] = 1e6, in 0.0 => 1e6;
    }
}

choice! {
    /// The inverse tangent in the pitch reference.
    pub enum Pitch {
        /// Arctangent of the quotient, as printed: wrong where F points downwards.
        "arctan" => Arctan,
        /// The angle of the point, right in all quadrants.
        "atan2" => Atan2,
    }
}

options! {
    /// Choices of the Euler-angle reference.
    pub struct Options {
        /// The inverse tangent in the pitch reference.
        pitch: Pitch;
        /// Where the angular velocity of the reference comes from.
        rates: Rates;
    }
}

record! {
    /// Euler-angle reference.
    pub struct EulerAngles {
        /// Numbers.
        gains: Gains<T> [];
        /// What the law believes of the vehicle.
        model: Model<T> [];
        /// The previous reference.
        memory: RateMemory<T> [];
        structure {
            /// Choices.
            options: Options;
        }
    }
}

impl<T: Real> EulerAngles<T> {
    /// The law at rest.
    pub fn new(gains: Gains<T>, options: Options, model: &Model<T>) -> Self {
        Self { gains, options, model: *model, memory: RateMemory::default() }
    }
}

/// The attitude with the angles (1) and (2).
#[inline(always)]
fn angles<T: Real>(thrust: &Thrust<T>, pitch: Pitch) -> Rotation<T, Body, World> {
    let f = thrust.force;
    let (sin, cos) = thrust.yaw.sin_cos();
    let roll = ((f.x * sin - f.y * cos) / f.norm()).asin(); // (1)
    let forward = f.x * cos + f.y * sin;
    let (y, x) = match pitch {
        Pitch::Arctan => (forward * T::one().with_sign(f.z), f.z.abs()), // (2)
        Pitch::Atan2 => (forward, f.z),
    };
    Rotation::from_euler(Euler { roll, pitch: y.atan2(x), yaw: thrust.yaw })
}

impl<T: Real> Controller<T> for EulerAngles<T> {
    type Reference = Thrust<T>;
    type Command = Attitude<T>;

    #[inline(always)]
    fn tune(&mut self, dt: T) {
        self.memory.tune(dt);
    }

    #[inline(always)]
    fn update(&mut self, measurement: &Measurement<T>, thrust: &Thrust<T>, _: T) -> Attitude<T> {
        let mut attitude = Attitude::<T>::default();
        for i in 0..T::PARTS {
            let thrust = thrust.pick(i);
            angles(&thrust, self.options.pitch).put(&mut attitude.rotation, i);
            let thrust = projected_thrust(&thrust, &measurement.pick(i), &self.model.pick(i)); // (3)
            attitude.thrust.set_part(i, thrust);
        }
        let rotation = &attitude.rotation;
        let (rate, acceleration) = self.memory.update(self.options.rates, rotation, thrust);
        Attitude { rate, acceleration, ..attitude }
    }

    fn reset(&mut self, _: &Measurement<T>) {
        self.memory = RateMemory::default();
    }

    fn limit(&self) -> T {
        self.gains.limit
    }
}
