//! A 1-cosine gust.
//!
//!   w = v/2 (1 - cos(pi t/T)) for t < T                                  (1)
//!   afterwards down the same way until 2 T, then still                   (2)
//!
//! Source: MIL-F-8785C, 3.7.1.3, with the length of the gust divided by the airspeed as T; (2) is the full
//! wave of the airworthiness codes.

use stormpetrel_control::math::{Vec3, World};
use stormpetrel_control::real::Real;
use stormpetrel_control::record;

use super::{Disturb, Reach, Scene, Site};

record! {
    /// Numbers of the gust.
    pub struct Gains {
        /// Velocity of the air at the top, v.
        velocity: Vec3<T, World> [m/s] = 0.0, in -100.0 => 100.0;
        /// Time to the top, T.
        rise: T [s] = 1.0, in 1e-3 => 1e4;
    }
}

/// No choices.
pub type Options = ();

record! {
    /// A 1-cosine gust.
    pub struct Gust {
        /// Numbers.
        gains: Gains<T> [];
    }
}

impl<T: Real> Gust<T> {
    /// The disturbance.
    pub fn new(gains: Gains<T>, _: Options, _: &Site<T>) -> Self {
        Self { gains }
    }
}

impl<T: Real> Disturb<T> for Gust<T> {
    fn reach(&self) -> Reach {
        Reach::Air
    }
    #[inline(always)]
    fn wind(&mut self, scene: &Scene<T>) -> Vec3<T, World> {
        let Gains { velocity, rise } = self.gains;
        let along = (scene.time / rise).clamp(T::zero(), T::lit(2.0));
        let (_, cos) = (along * T::lit(core::f64::consts::PI)).sin_cos();
        velocity * (T::one() - cos).half() // (1), (2)
    }
}
