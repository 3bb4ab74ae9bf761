//! No observer: the estimate is zero.
//!
//!   d_hat = 0                                                           (1)
//!
//! The baseline of every comparison.

use crate::controller::Observer;
use crate::math::{Vec3, World};
use crate::real::Real;
use crate::record::Nothing;
use crate::signals::{Applied, Measurement, Model};

/// No gains.
pub type Gains<T> = Nothing<T>;
/// No choices.
pub type Options = ();
/// The observer that sees nothing.
pub type Absent<T> = Nothing<T>;

impl<T: Real> Absent<T> {
    /// The observer that sees nothing.
    pub fn new(_: Gains<T>, _: Options, _: &Model<T>) -> Self {
        Self::default()
    }
}

impl<T: Real> Observer<T> for Absent<T> {
    #[inline(always)]
    fn estimate(&self) -> Vec3<T, World> {
        Vec3::zero() // (1)
    }
    #[inline(always)]
    fn correct(&mut self, _: &Measurement<T>, _: T) {}
    #[inline(always)]
    fn advance(&mut self, _: &Applied<T>, _: T) {}
    fn reset(&mut self, _: &Measurement<T>) {}
    #[inline(always)]
    fn limit(&self) -> T {
        T::one()
    }
}
