//! Where the vehicle should be.

use stormpetrel_control::controller::Plain;
use stormpetrel_control::real::Real;
use stormpetrel_control::record::RecordExt as _;
use stormpetrel_control::registry;
use stormpetrel_control::signals::Trajectory;

use crate::vehicle::Vehicle;

pub mod phase;
pub mod piecewise;

/// A trajectory with all derivatives.
pub trait Refer<T: Real>: Plain<T> {
    /// The reference `time` seconds after the start.
    fn at(&self, time: T) -> Trajectory<T>;
}

macro_rules! dispatch_refer {
    ($name:ident [$($variant:ident)+] ()) => {
        impl<T: Real> Refer<T> for $name<T> {
            #[inline(always)]
            fn at(&self, time: T) -> Trajectory<T> {
                match self { $( Self::$variant(all) => {
                    let mut at = Trajectory::default();
                    for i in 0..T::PARTS {
                        all.pick(i).at(time.part(i)).put(&mut at, i);
                    }
                    at
                } )+ }
            }
        }
    };
}

registry! {
    /// References, under their names in scenario files.
    pub enum Reference / ReferenceSettings keyed "shape" from Vehicle;
    dispatch dispatch_refer ();
    "hover" => Hover in hover;
    "helix" => Helix in helix;
    "line" => Line in line;
    "circle" => Circle in circle;
    "lemniscate" => Lemniscate in lemniscate;
    "lissajous" => Lissajous in lissajous;
    "minimum-snap" => MinimumSnap in minimum_snap;
    "race" => Race in race;
    "table" => Table in table;
}
