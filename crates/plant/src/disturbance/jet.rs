//! A round jet, such as an indoor fan blows.
//!
//!   x = (p - o).n,   r = |p - o - x n|                                   (1)
//!   u = u0 min(1, B d/x),   r_half = max(S x, d/2)                       (2)
//!   w = n u exp(-ln 2 (r/r_half)^2) for x > 0, else 0                    (3)
//!
//! | symbol | meaning |
//! |---|---|
//! | o, n, d | place, direction and diameter of the outlet |
//! | B, S | decay 5.8 and spreading rate 0.096 of the self-similar round jet |
//!
//! Source: Pope, Turbulent Flows, 2000, section 5.1, table 5.1. Valid beyond some thirty diameters; nearer (2)
//! is a smooth stand-in for the potential core.

use stormpetrel_control::math::{Vec3, World};
use stormpetrel_control::real::Real;
use stormpetrel_control::record;

use super::{Disturb, Reach, Scene, Site};

record! {
    /// Numbers of the jet.
    pub struct Gains {
        /// Place of the outlet, o.
        outlet: Vec3<T, World> [m] = 0.0, in -1e6 => 1e6;
        /// Velocity of the air at the outlet; its direction is n.
        velocity: Vec3<T, World> [m/s] = 1.0, in -100.0 => 100.0;
        /// Diameter of the outlet, d.
        diameter: T [m] = 0.5, in 1e-3 => 100.0;
    }
}

/// No choices.
pub type Options = ();

/// Decay constant B.
const DECAY: f64 = 5.8;
/// Spreading rate S.
const SPREAD: f64 = 0.096;

record! {
    /// A round jet, such as an indoor fan blows.
    pub struct Jet {
        /// Numbers.
        gains: Gains<T> [];
    }
}

impl<T: Real> Jet<T> {
    /// The disturbance.
    pub fn new(gains: Gains<T>, _: Options, _: &Site<T>) -> Self {
        Self { gains }
    }
}

impl<T: Real> Disturb<T> for Jet<T> {
    fn reach(&self) -> Reach {
        Reach::Air
    }
    #[inline(always)]
    fn wind(&mut self, scene: &Scene<T>) -> Vec3<T, World> {
        let Gains { outlet, velocity, diameter } = self.gains;
        let speed = velocity.norm();
        let n = velocity * (T::one() / speed.max(T::lit(1e-9)));
        let away = scene.state.position - outlet;
        let x = away.dot(n); // (1)
        let across = away - n * x;
        let reach = x.max(T::lit(1e-9));
        let axis = (T::lit(DECAY) * diameter / reach).min(T::one());
        let half = (T::lit(SPREAD) * reach).max(diameter.half()); // (2)
        let fall = (across.norm_squared() / half.sq() * T::lit(-core::f64::consts::LN_2)).exp();
        Vec3::select(T::zero().lt(x), velocity * (axis * fall), Vec3::zero()) // (3)
    }
}
