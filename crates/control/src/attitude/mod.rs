//! Attitude laws: from the attitude error to the angular motion asked for.

use crate::math::{Body, Vec3};
use crate::real::Real;
use crate::signals::{Attitude, Model, Rate};
use crate::{dispatch_controller, registry};

registry! {
    /// Attitude laws, under their names in scenario files.
    pub enum AttitudeLaw / AttitudeLawSettings keyed "law" from Model;
    dispatch dispatch_controller (Attitude => Rate, each);
    "euler" => EulerError in euler;
    "tilt-priority" => TiltPriority in tilt_priority;
}

/// omega_des = omega_ref - K1 e and alpha = alpha_ref - K_theta e, for an attitude error in body axes.
#[inline(always)]
fn rate_command<T: Real>(
    e: Vec3<T, Body>,
    k1: Vec3<T, Body>,
    k_theta: Vec3<T, Body>,
    to_body: crate::math::Rotation<T, Body, Body>,
    reference: &Attitude<T>,
) -> Rate<T> {
    Rate {
        rate: to_body * reference.rate - e.scale(k1),
        acceleration: to_body * reference.acceleration - e.scale(k_theta),
        thrust: reference.thrust,
    }
}
