//! No disturbance.
//!
//!   d = 0                                                                (1)

use stormpetrel_control::real::Real;
use stormpetrel_control::record::Nothing;

use super::{Disturb, Reach, Site};

/// Nothing to set.
pub type Gains<T> = Nothing<T>;
/// No choices.
pub type Options = ();

stormpetrel_control::record! {
    /// Still air.
    pub struct Calm {
        /// Always zero; a record has at least one number.
        force: T [N];
    }
}

impl<T: Real> Calm<T> {
    /// Still air.
    pub fn new(_: Gains<T>, _: Options, _: &Site<T>) -> Self {
        Self::default()
    }
}

impl<T: Real> Disturb<T> for Calm<T> {
    fn reach(&self) -> Reach {
        Reach::Nothing // (1)
    }
}
