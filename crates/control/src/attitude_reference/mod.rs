//! From the thrust vector to the attitude that makes it, and the rates of that attitude.

mod rates;

use crate::math::Body;
use crate::math::{Rotation, Vec3, World};
use crate::real::Real;
use crate::signals::{Measurement, Model, Thrust};
use crate::{dispatch_controller, registry};

pub use rates::{RateMemory, Rates, flatness_rates};

registry! {
    /// Attitude references, under their names in scenario files.
    pub enum AttitudeReference / AttitudeReferenceSettings keyed "law" from Model;
    dispatch dispatch_controller (Thrust => Attitude, whole);
    "euler" => EulerAngles in euler;
    "rotation" => RotationMatrix in rotation;
}

/// The total thrust that projects the wanted vector on the real thrust axis: T = m F . (R e_z), N.
/// (Mellinger and Kumar, ICRA 2011; Lee, Leok and McClamroch, CDC 2010.)
#[inline(always)]
fn projected_thrust<T: Real>(
    thrust: &Thrust<T>,
    measurement: &Measurement<T>,
    model: &Model<T>,
) -> T {
    model.mass * thrust.force.dot(measurement.attitude.z_axis())
}

/// Attitude with thrust axis along `force` and heading `yaw`, Z-Y-X convention: `b_x` is normal to the
/// world's lateral heading axis `y_c` = (-sin yaw, cos yaw, 0). `last` is the `b_x` to keep near the
/// singular direction `b_z || y_c` and the side to stay on when passing through it; without it the
/// heading side is taken.
#[inline(always)]
pub fn attitude_along<T: Real>(
    force: Vec3<T, World>,
    yaw: T,
    last: Option<Vec3<T, World>>,
) -> Rotation<T, Body, World> {
    let (sin, cos) = yaw.sin_cos();
    let y_c = Vec3::new(-sin, cos, T::zero());
    let heading = Vec3::new(cos, sin, T::zero());
    let none = force.norm_squared().lt(T::lit(1e-12));
    let force = Vec3::select(none, Vec3::up(T::one()), force);
    let length_squared = force.norm_squared();
    // From the force itself and not from b_z: the two roots below need not wait for each other.
    let side = y_c.cross(force);
    let last = last.unwrap_or(heading);
    // Closer than 0.06 deg to the singular direction the last axis is held, made normal to b_z.
    let singular = side.norm_squared().lt(T::lit(1e-6) * length_squared);
    let held = last * length_squared - force * last.dot(force);
    let side = Vec3::select(singular, held, side * T::one().with_sign(side.dot(last)));
    let (b_x, b_z) = (side.unit(), force.unit());
    Rotation::from_axes(b_x, b_z.cross(b_x), b_z)
}
