//! Damages datagrams and streams at random and checks what codec, client and robot make of them:
//!
//! ```sh
//! cargo run --release -p fci --example mutate -- [COUNT [SEED]]
//! ```
//!
//! COUNT cases for each of four: datagrams and streams into the codec, both into either machine.
//! It is 10000000 and SEED is 1 unless given. Exit code 0: no panic, every answer is
//! the right one, all that was accepted comes back byte by byte, nothing that a machine refuses changes
//! a byte of what it says later, every kind of damage and of answer occurred. 1: not so, with the bytes.
//! 2: bad arguments.

mod mutator;

use std::process::ExitCode;

use mutator::{Clients, Datagrams, Robots, Streams};

fn main() -> ExitCode {
    hostile::main(&[
        ("datagrams into the codec", &|count, seed| {
            hostile::run(count, seed, Datagrams::new)
        }),
        ("streams into the codec", &|count, seed| {
            hostile::run(count, seed, Streams::new)
        }),
        ("states and streams into the client", &|count, seed| {
            hostile::run(count, seed, Clients::new)
        }),
        ("commands and streams into the robot", &|count, seed| {
            hostile::run(count, seed, Robots::new)
        }),
    ])
}
