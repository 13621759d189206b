//! Datagrams and streams damaged at random, and what codec, client and robot must make of them.
//!
//! Everything follows from the seed. To the codec each case begins as a valid one and is damaged
//! one to three times. The machines are attacked at every place of conversations in good order;
//! what they refuse must not change a byte of what they say in the rest of the conversation. What has to be
//! answered is decided here, from offsets and codes written down again, without the codec.

#[path = "mutator/client.rs"]
mod client;
#[path = "../../tests/data/mod.rs"]
mod data;
#[path = "mutator/datagrams.rs"]
mod datagrams;
#[path = "../../tests/pair/mod.rs"]
mod pair;
#[path = "mutator/robot.rs"]
mod robot;
#[path = "mutator/script.rs"]
mod script;
#[path = "mutator/streams.rs"]
mod streams;

use fci::Error;

pub use client::Clients;
pub use datagrams::Datagrams;
pub use robot::Robots;
pub use streams::Streams;

/// What a reader says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    Accepted,
    Length,
    Code,
    Bool,
    /// Accepted, with a number that is none.
    NotFinite,
}

/// In their order.
const OUTCOMES: [&str; 5] = ["accepted", "length", "code", "bool", "not finite"];

impl Outcome {
    fn of(error: Error) -> Result<Self, String> {
        match error {
            Error::Length { .. } => Ok(Self::Length),
            Error::Code { .. } => Ok(Self::Code),
            Error::Bool { .. } => Ok(Self::Bool),
            Error::NotFinite { .. } => Ok(Self::NotFinite),
            other => Err(format!("unknown error: {other}")),
        }
    }
}
