//! Records of a cycle.
//!
//! What is recorded stands once, as a list of channels: [`run::CHANNELS`] and
//! [`run::LEVEL_CHANNELS`] of a simulated run, [`session::channels`] of a session with a
//! robot. Headers and rows of CSV files ([`csv`]), the series of a report and the tables of
//! docs/files.md are made from these lists. A new channel is one line.

pub mod channel;
pub mod csv;
mod decimal;
pub mod run;
pub mod session;
