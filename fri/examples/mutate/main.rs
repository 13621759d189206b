//! Damages valid datagrams at random and checks what the codec makes of them:
//!
//! ```sh
//! cargo run --release -p fri --example mutate -- [COUNT [SEED]]
//! ```
//!
//! COUNT is 10000000 and SEED is 1 unless given. Exit code 0: no panic, every answer is
//! the right one, all that was accepted comes back byte by byte, every kind of damage and of
//! error occurred. 1: not so, with the datagram. 2: bad arguments.

mod mutator;

use std::process::ExitCode;

use mutator::Datagrams;

fn main() -> ExitCode {
    hostile::main(&[("codec of FRI", &|count, seed| {
        hostile::run(count, seed, Datagrams::new)
    })])
}
