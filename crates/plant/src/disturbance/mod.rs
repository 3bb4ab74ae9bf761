//! What pushes the vehicle: true force (N, world) and true torque (N m, body).

use stormpetrel_control::controller::Plain;
use stormpetrel_control::real::Real;
use stormpetrel_control::record::RecordExt as _;
use stormpetrel_control::registry;

use crate::dynamics::Push;
use crate::vehicle::Vehicle;

/// How many disturbances a scenario may combine.
pub const MOST: usize = 4;

/// A source of force and torque.
pub trait Disturb<T: Real>: Plain<T> {
    /// The push at `time` seconds after the start.
    fn at(&self, time: T, vehicle: &Vehicle<T>) -> Push<T>;
}

macro_rules! dispatch_disturb {
    ($name:ident [$($variant:ident)+] ()) => {
        impl<T: Real> Disturb<T> for $name<T> {
            #[inline(always)]
            fn at(&self, time: T, vehicle: &Vehicle<T>) -> Push<T> {
                let mut at = Push::default();
                match self { $( Self::$variant(all) => for i in 0..T::LANES {
                    all.pick(i).at(time.lane(i), &vehicle.pick(i)).put(&mut at, i);
                } )+ }
                at
            }
        }
    };
}

registry! {
    /// Disturbances, under their names in scenario files.
    pub enum Disturbance / DisturbanceSettings keyed "kind" from Vehicle;
    dispatch dispatch_disturb ();
    "none" => Calm in none;
    "harmonic" => Harmonic in harmonic;
}
