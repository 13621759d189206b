//! Sends sessions good and damaged measurements and checks every answer:
//!
//! ```sh
//! cargo run --release -p bridge --example mutate_session -- [COUNT [SEED]]
//! ```
//!
//! COUNT datagrams for each of two robots, LWR and Panda or FR3. It is 10000000 and SEED is 1
//! unless given. Exit code 0: no panic, nothing written for a refused datagram, nothing that is refused
//! changes a byte of a later answer, every answer a good one with torques within the limits, every kind
//! of damage and of outcome occurred. 1: not so. 2: bad arguments. A session has no memory but its
//! own value.

mod mutator;

use std::process::ExitCode;

use mutator::{Franka, Kuka, Sessions};

fn main() -> ExitCode {
    hostile::main(&[
        ("session with the LWR", &|count, seed| {
            hostile::run(count, seed, Sessions::<Kuka>::new)
        }),
        ("session with a Franka arm", &|count, seed| {
            hostile::run(count, seed, Sessions::<Franka>::new)
        }),
    ])
}
