//! A rigid load that is attached at the onset and dropped at the end.
//!
//!   m' = m + m_p,   mu = m m_p/m'                                        (1)
//!   I' = I + mu (|r|^2 1 - r r^T), its diagonal                          (2)
//!   the centre of mass moves by r m_p/m'                                 (3)
//!
//! r is the place of the load. The state is that of the common centre of mass, which is left where the
//! vehicle's was when the load comes and goes; (2) is exact for a load on one of the body's axes.
//! Source: parallel axes (Steiner).

use stormpetrel_control::math::{Body, Vec3};
use stormpetrel_control::real::Real;
use stormpetrel_control::record;

use super::{Cargo, Disturb, Reach, Site};

record! {
    /// Numbers of the payload.
    pub struct Gains {
        /// Mass, `m_p`.
        mass: T [kg] = 0.1, in 0.0 => 100.0;
        /// Place from the centre of mass, r.
        place: Vec3<T, Body> [m] = 0.0, in -2.0 => 2.0;
    }
}

/// No choices.
pub type Options = ();

record! {
    /// A rigid load that is attached at the onset and dropped at the end.
    pub struct Payload {
        /// Numbers.
        gains: Gains<T> [];
    }
}

impl<T: Real> Payload<T> {
    /// The disturbance.
    pub fn new(gains: Gains<T>, _: Options, _: &Site<T>) -> Self {
        Self { gains }
    }
}

impl<T: Real> Disturb<T> for Payload<T> {
    fn reach(&self) -> Reach {
        Reach::Cargo
    }
    fn cargo(&self) -> Cargo<T> {
        let Gains { mass, place } = self.gains;
        Cargo { mass, place }
    }
}
