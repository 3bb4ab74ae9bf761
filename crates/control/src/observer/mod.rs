//! Disturbance observers: the acceleration that the model does not explain.

use crate::signals::Model;
use crate::{dispatch_observer, registry};

registry! {
    /// Disturbance observers, under their names in scenario files.
    pub enum Observer / ObserverSettings keyed "law" from Model;
    dispatch dispatch_observer ();
    "none" => Absent in none;
    "hosm" => Hosm in hosm;
}
