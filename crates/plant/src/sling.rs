//! A mass that hangs from the centre of mass on a cable without weight.
//!
//!   q = r/|r|,   r = x_cargo - x,   |r| = L                              (1)
//!   T (1/m + 1/m_c) = |r'|^2/L - q.u                                     (2)
//!   pull on the vehicle: T q/m                                           (3)
//!   r'' = -u - T q (1/m + 1/m_c) - c/m_c (r' - q (q.r')),   T >= 0       (4)
//!
//! | symbol | meaning |
//! |---|---|
//! | T | tension; a cable pulls and never pushes |
//! | u | force on the vehicle per mass, without weight and tension |
//! | m, `m_c` | mass of the vehicle, of what hangs |
//! | c | damping across the cable |
//!
//! (2) is Newton's law for both masses with q.r'' = -|r'|^2/L; it holds while the cable is tight, which is
//! the range of validity. After every step r is put back to its length and r' across it.

use stormpetrel_control::math::{Vec3, World};
use stormpetrel_control::real::Real;
use stormpetrel_control::record;

record! {
    /// What hangs, and on which cable.
    pub struct Sling {
        /// Mass; 0 while nothing hangs.
        mass: T [kg];
        /// Length of the cable.
        length: T [m];
        /// Damping across the cable.
        damping: T [N s/m];
    }
}

record! {
    /// Where it hangs.
    pub struct Hanging {
        /// From the vehicle's centre of mass, r.
        place: Vec3<T, World> [m];
        /// Velocity relative to the vehicle's, r'.
        velocity: Vec3<T, World> [m/s];
    }
}

record! {
    /// What the cable does.
    pub struct Hung {
        /// Its pull on the vehicle, per mass of the vehicle.
        pull: Vec3<T, World> [m/s^2];
        /// Acceleration of what hangs, relative to the vehicle.
        acceleration: Vec3<T, World> [m/s^2];
        /// Tension.
        tension: T [N];
    }
}

/// The cable in this state, (2) to (4); `free` is u, m/s^2.
#[inline(always)]
pub fn hang<T: Real>(
    hanging: &Hanging<T>,
    free: Vec3<T, World>,
    per_mass: T,
    sling: &Sling<T>,
) -> Hung<T> {
    let on = T::zero().lt(sling.mass);
    let per_length = T::one() / T::select(on, sling.length, T::one());
    let per_cargo = T::one() / T::select(on, sling.mass, T::one());
    let (q, turning) = (hanging.place * per_length, hanging.velocity);
    let both = per_mass + per_cargo;
    let tension = (turning.norm_squared() * per_length - q.dot(free)) / both; // (2)
    let tension = T::select(on, tension.max(T::zero()), T::zero());
    let across = turning - q * q.dot(turning);
    let swing = -free - q * (tension * both) - across * (sling.damping * per_cargo); // (4)
    Hung {
        pull: q * (tension * per_mass), // (3)
        acceleration: Vec3::select(on, swing, Vec3::zero()),
        tension,
    }
}

impl<T: Real> Sling<T> {
    /// Puts the cable back to its length (1).
    #[inline(always)]
    pub fn tighten(&self, hanging: &mut Hanging<T>) {
        let on = T::zero().lt(self.mass);
        let q = hanging.place.unit();
        let across = hanging.velocity - q * q.dot(hanging.velocity);
        hanging.place = Vec3::select(on, q * self.length, hanging.place);
        hanging.velocity = Vec3::select(on, across, hanging.velocity);
    }

    /// Hangs straight down what has just been attached, and forgets what has been dropped.
    #[inline(always)]
    pub fn attach(&self, hanging: &Hanging<T>) -> Hanging<T> {
        let new = T::zero().lt(self.mass) & hanging.place.norm_squared().eq(T::zero());
        let gone = self.mass.eq(T::zero());
        let place = Vec3::select(new, Vec3::up(-self.length), hanging.place);
        Hanging {
            place: Vec3::select(gone, Vec3::zero(), place),
            velocity: Vec3::select(gone, Vec3::zero(), hanging.velocity),
        }
    }
}
