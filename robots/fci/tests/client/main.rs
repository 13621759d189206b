//! The client's machine against a robot that does what a test says: conversations in good order,
//! every event of the table, what is kept of a stream.

mod conversation;
mod events;
mod memory;
mod pair;
mod scripted;
