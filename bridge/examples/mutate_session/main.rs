//! Sends a session good and damaged measurements and checks every answer:
//!
//! ```sh
//! cargo run --release -p bridge --example mutate_session -- [COUNT [SEED]]
//! ```
//!
//! COUNT is 1000000 and SEED is 1 unless given. Exit code 0: no panic, nothing
//! written for a refused datagram, every answer a good one with torques within the limits.
//! 1: not so. 2: bad arguments. A session has no memory but its own value.

mod mutator;

use std::process::ExitCode;

fn number(text: Option<&String>, default: u64) -> Option<u64> {
    text.map_or(Some(default), |text| text.parse().ok())
}

fn main() -> ExitCode {
    let arguments: Vec<_> = std::env::args().skip(1).collect();
    let count = number(arguments.first(), 1_000_000).filter(|&count| count >= 10_000);
    let seed = number(arguments.get(1), 1);
    let (Some(count), Some(seed), true) = (count, seed, arguments.len() <= 2) else {
        eprintln!("{arguments:?}; allowed: [COUNT [SEED]], COUNT from 10000, SEED from 0");
        return ExitCode::from(2);
    };
    match mutator::run(count, seed) {
        Ok(table) => {
            println!("{count} datagrams, seed {seed}\n{table}");
            ExitCode::SUCCESS
        }
        Err(failure) => {
            eprintln!("seed {seed}: {failure}");
            ExitCode::FAILURE
        }
    }
}
