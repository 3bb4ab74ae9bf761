//! Wind that grows with the height above the ground.
//!
//!   w = v ln(h/z0)/ln(h_ref/z0),   h = z - ground, at least z0           (1)
//!
//! Source: the logarithmic law of MIL-F-8785C, 3.7.3.4; z0 = 0.046 m over open ground (its category C), `h_ref`
//! = 6.096 m (20 ft).

use stormpetrel_control::math::{Vec3, World};
use stormpetrel_control::real::Real;
use stormpetrel_control::record;

use super::{Disturb, Reach, Scene, Site};

record! {
    /// Numbers of the shear.
    pub struct Gains {
        /// Velocity of the air at the reference height, v.
        velocity: Vec3<T, World> [m/s] = 0.0, in -100.0 => 100.0;
        /// Reference height, `h_ref`.
        height: T [m] = 6.096, in 0.1 => 1e4;
        /// Roughness length z0.
        roughness: T [m] = 0.046, in 1e-5 => 10.0;
        /// Height of the ground.
        ground: T [m] = 0.0, in -1e6 => 1e6;
    }
}

/// No choices.
pub type Options = ();

record! {
    /// Wind that grows with the height above the ground.
    pub struct Shear {
        /// Numbers.
        gains: Gains<T> [];
    }
}

impl<T: Real> Shear<T> {
    /// The disturbance.
    pub fn new(gains: Gains<T>, _: Options, _: &Site<T>) -> Self {
        Self { gains }
    }
}

impl<T: Real> Disturb<T> for Shear<T> {
    fn reach(&self) -> Reach {
        Reach::Air
    }
    #[inline(always)]
    fn wind(&mut self, scene: &Scene<T>) -> Vec3<T, World> {
        let Gains { velocity, height, roughness, ground } = self.gains;
        let h = (scene.state.position.z - ground).max(roughness);
        velocity * ((h / roughness).ln() / (height / roughness).ln()) // (1)
    }
}
