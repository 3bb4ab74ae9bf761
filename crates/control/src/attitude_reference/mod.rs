//! From the thrust vector to the attitude that makes it, and the rates of that attitude.

mod rates;

use crate::math::Body;
use crate::math::{Rotation, Vec3, World};
use crate::real::{Mask, Real};
use crate::record;
use crate::record::{RecordExt as _, same};
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

/// Sine and cosine of the heading. Vehicles mostly hold yaw 0, for which nothing need be computed.
#[inline(always)]
fn heading<T: Real>(yaw: T) -> Heading<T> {
    let (sin, cos) = if yaw.eq(T::zero()).all() {
        (T::zero(), T::one())
    } else {
        // Adding zero makes a negative zero positive, as above.
        (yaw + T::zero()).sin_cos()
    };
    Heading { sin, cos }
}

record! {
    /// Sine and cosine of the yaw angle.
    struct Heading {
        /// Sine.
        sin: T [1];
        /// Cosine.
        cos: T [1];
    }
}

/// Attitude with thrust axis along `force` and heading `yaw`, Z-Y-X convention: `b_x` is normal to the
/// world's lateral heading axis `y_c` = (-sin yaw, cos yaw, 0).
pub fn attitude_along<T: Real>(force: Vec3<T, World>, yaw: T) -> Rotation<T, Body, World> {
    let (sin, cos) = yaw.sin_cos();
    attitude_beside(force, &Heading { sin, cos }, Vec3::new(cos, sin, T::zero())).0
}

record! {
    /// Where a reference points: vectors along two of its axes, of any length.
    struct Pointing {
        /// Along `b_z`: the thrust vector.
        force: Vec3<T, World> [m/s^2];
        /// Along `b_x`.
        side: Vec3<T, World> [m/s^2];
        /// Square of the thrust vector's length.
        length_squared: T [m^2/s^4];
    }
}

impl<T: Real> Pointing<T> {
    /// Along `force`, with `b_x` in front.
    #[inline(always)]
    fn new(force: Vec3<T, World>, heading: &Heading<T>) -> Self {
        let Heading { sin, cos } = *heading;
        // y_c x F, without the products with the third component of y_c, which is zero.
        let side = Vec3::new(cos * force.z, sin * force.z, -(sin * force.y + cos * force.x));
        Self { force, side, length_squared: force.norm_squared() }
    }

    /// Upwards where there is no force; with `b_x` on the side of `last`, and along it near the singular
    /// direction.
    #[cold]
    #[inline(never)]
    fn beside(force: Vec3<T, World>, heading: &Heading<T>, last: Vec3<T, World>) -> Self {
        let none = force.norm_squared().lt(T::lit(1e-12));
        let force = Vec3::select(none, Vec3::up(T::one()), force);
        let Self { side, length_squared, .. } = Self::new(force, heading);
        // Closer than 0.06 deg to the singular direction the last axis is held, made normal to b_z.
        let singular = side.norm_squared().lt(T::lit(1e-6) * length_squared);
        let held = last * length_squared - force * last.dot(force);
        let side = Vec3::select(singular, held, side * T::one().with_sign(side.dot(last)));
        Self { force, side, length_squared }
    }

    /// The three axes times a number, and the number.
    #[inline(always)]
    fn axes(&self) -> ([Vec3<T, World>; 3], T) {
        let Self { force, side, length_squared } = *self;
        // b_x = side/|side| and b_z = force/|force|: all three axes times |side| |force| instead, so that
        // the only division is the one that makes the quaternion a unit.
        let (width, length) = (side.norm(), length_squared.sqrt());
        ([side * length, force.cross(side), force * width], width * length)
    }

    /// The attitude, however it lies.
    #[cold]
    #[inline(never)]
    fn attitude(&self) -> Rotation<T, Body, World> {
        let ([x, y, z], one) = self.axes();
        Rotation::from_scaled_axes(x, y, z, one)
    }
}

/// [`attitude_along`] beside the previous `b_x`: near the singular direction `b_z || y_c` that is kept,
/// and passing through it, its side. Also a vector along the new `b_x`, of any length.
#[inline(always)]
fn attitude_beside<T: Real>(
    force: Vec3<T, World>,
    heading: &Heading<T>,
    last: Vec3<T, World>,
) -> (Rotation<T, Body, World>, Vec3<T, World>) {
    let mut pointing = Pointing::<T>::default();
    let (mut width_squared, mut ahead) = (T::zero(), T::zero());
    for i in 0..T::PARTS {
        let one = Pointing::new(force.pick(i), &heading.pick(i));
        width_squared.set_part(i, one.side.norm_squared());
        ahead.set_part(i, one.side.dot(last.pick(i)));
        one.put(&mut pointing, i);
    }
    let none = pointing.length_squared.lt(T::lit(1e-12));
    let singular = width_squared.lt(T::lit(1e-6) * pointing.length_squared);
    // The usual case: the rare one would give the same bits.
    if !(!(none | singular | ahead.lt(T::zero()))).all() {
        pointing = Pointing::beside(same(&force), &same(heading), same(&last));
    }

    let (mut attitude, mut upright) = (Rotation::default(), T::zero());
    for i in 0..T::PARTS {
        let ([x, y, z], one) = pointing.pick(i).axes();
        let (rotation, w4) = Rotation::from_upright_axes(x, y, z, one);
        upright.set_part(i, w4 - T::Part::lit(2.25) * one);
        rotation.put(&mut attitude, i);
    }
    // Again the usual case: 4 w^2 above half of the sum of all four is the largest of them.
    if !T::zero().lt(upright).all() {
        attitude = same(&same(&pointing).attitude());
    }
    (attitude, pointing.side)
}
