//! The client's machine against a robot that does what a test says: conversations in good order,
//! every event of the table, hostile streams.

mod conversation;
mod events;
mod hostile;
mod pair;
mod scripted;
