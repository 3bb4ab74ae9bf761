//! Experiments with quadrotor controllers: scenario files, metrics, logs, figures, and the article
//! reproduced.

mod batch;
pub mod campaign;
pub mod catalogue;
pub mod curve;
pub mod feasible;
pub mod figures;
pub mod fly;
pub mod log;
pub mod metric;
pub mod output;
pub mod page;
pub mod plot;
pub mod preview;
pub mod reproduce;
pub mod scenario;
pub mod sensitivity;
pub mod shipped;
pub mod trace;
