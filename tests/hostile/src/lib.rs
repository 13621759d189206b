//! The frame of the programs that give damaged bytes to a reader: codec, machine or session.
//!
//! A program has its [`Cases`]: how bytes are damaged, and what has to be made of them. The rest is
//! here: choices that follow from a seed ([`Random`]), tables of what was answered
//! ([`Table`]), as many cases as asked for on all processors ([`run`]), and the command line
//! ([`main`]).

mod program;
mod random;
mod table;

pub use program::{Cases, Part, main, run};
pub use random::Random;
pub use table::{Table, missing};
