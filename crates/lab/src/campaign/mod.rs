//! Campaigns: one scenario flown many times with drawn inputs.
//!
//! A [`result::Row`] is what one flight came to. Rows are made in any order on any thread, kept in a
//! journal, and written in the order of their index: the files do not depend on how they were made.

pub mod ahead;
pub mod disk;
pub mod drive;
#[cfg(feature = "parquet")]
pub mod files;
pub mod journal;
#[cfg(feature = "parquet")]
pub mod parquet;
pub mod plan;
pub mod random;
mod replay;
pub mod report;
pub mod result;
#[cfg(feature = "parquet")]
mod spool;
pub mod summary;
pub mod sweep;
mod tables;
mod units;
mod worker;
