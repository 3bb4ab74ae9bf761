//! State estimation: what the laws are told where the vehicle is known only through sensors.
//!
//! [`eskf`] is the filter, [`nominal`] its best guess, [`covariance`] its matrix in [`block`]s, which
//! [`propagation`] moves, [`past`] the state at the time of a delayed sample, and [`aiding`] what each kind
//! of sensor says of that state.

pub mod aiding;
pub mod block;
pub mod covariance;
pub mod eskf;
pub mod nominal;
pub mod past;
pub mod propagation;

pub use eskf::{Eskf, Gains};
pub use nominal::{Imu, Nominal, turn};
pub use past::{Lag, Past, Row};
