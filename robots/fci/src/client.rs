//! The client's end of the conversation over TCP: who says what, in which order, and why it ends.
//!
//! ```text
//!               connected()                    model, a state        start()
//!  Connecting ---------------> Connect -> Reading ----------> Ready ---------> Starting
//!       ^                         |                                               | Move, modes
//!       +--- another version -----+                                               v
//!                                      Stopped <------------- Ending <--------- Running
//!                                               second reply         finish(), the robot ends it
//! ```
//!
//! [`Client`] has no socket, no thread and no clock. Its host owns the connection and tells what
//! happens: [`Client::connected`], bytes that came ([`Client::receive`]), states that came
//! ([`Client::state`]), [`Client::closed`], [`Client::silent`]. It sends what
//! [`Client::transmit`] has, and answers states as the [`Duty`] says. Where something is waited
//! for, states are the clock: the robot sends one each millisecond, and their silence is
//! the host's to notice.
//!
//! Why a conversation has ended is a [`Stop`]; the table of all [`Event`]s says what is seen, what
//! is done, and the exit code of a program.

mod event;
mod facts;
mod machine;
mod outgoing;
mod said;

pub use event::{Awaited, Cause, Event, Stop};
pub use facts::{COMPLIANT, Duty, Facts, ModelSink, Phase, Start};
pub use machine::{Client, MODEL_LEN_MAX, PATIENCE};
