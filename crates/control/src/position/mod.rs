//! Position laws: from the trajectory to the thrust vector.

use crate::signals::Model;
use crate::{dispatch_controller, registry};

registry! {
    /// Position laws, under their names in scenario files.
    pub enum Position / PositionSettings keyed "law" from Model;
    dispatch dispatch_controller (Trajectory => Thrust, each);
    "pid" => Pid in pid;
}
