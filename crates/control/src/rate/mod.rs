//! Rate laws: from the angular motion asked for to thrust and torque.

use crate::signals::Model;
use crate::{dispatch_controller, registry};

registry! {
    /// Rate laws, under their names in scenario files.
    pub enum RateLaw / RateLawSettings keyed "law" from Model;
    dispatch dispatch_controller (Rate => Wrench, each);
    "indi" => Indi in indi;
    "pid" => Pid in pid;
}
