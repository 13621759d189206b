//! Damages valid datagrams and streams at random and checks what the codec makes of them:
//!
//! ```sh
//! cargo run --release -p fci --example mutate -- [COUNT [SEED]]
//! ```
//!
//! COUNT is 10000000 and SEED is 1 unless given. Exit code 0: no panic, every answer is
//! the right one, all that was accepted comes back byte by byte, every kind of
//! answer occurred. 1: not so, with the bytes. 2: bad arguments.

mod mutator;

use std::process::ExitCode;
use std::time::Instant;

/// Fewer cases may miss a kind of answer.
const COUNT_MIN: u64 = 10_000;

fn arguments() -> Result<(u64, u64), String> {
    let mut given = std::env::args_os().skip(1);
    let mut number = |name: &str, min: u64, default: u64| {
        let Some(text) = given.next() else {
            return Ok(default);
        };
        let number = text.to_str().and_then(|text| text.parse().ok());
        number.filter(|&number| number >= min).ok_or_else(|| {
            format!(
                "{name}: {text:?}; allowed: whole numbers from {min} to {}",
                u64::MAX
            )
        })
    };
    let count = number("COUNT", COUNT_MIN, 10_000_000)?;
    let seed = number("SEED", 0, 1)?;
    match given.next() {
        Some(more) => Err(format!("argument {more:?}; allowed: [COUNT [SEED]]")),
        None => Ok((count, seed)),
    }
}

fn main() -> ExitCode {
    let (count, seed) = match arguments() {
        Ok(arguments) => arguments,
        Err(error) => {
            eprintln!("{error}");
            return ExitCode::from(2);
        }
    };
    let start = Instant::now();
    let table = match mutator::run(count, seed) {
        Ok(table) => table,
        Err(failure) => {
            eprintln!("seed {seed}, {failure}");
            return ExitCode::FAILURE;
        }
    };
    let elapsed_s = start.elapsed().as_secs_f64();
    println!("{count} datagrams and streams, seed {seed}");
    println!("{table}");
    println!(
        "{elapsed_s:.1} s, {:.2} million per second",
        count as f64 / elapsed_s / 1e6
    );
    if let Some(missing) = table.missing() {
        eprintln!("{missing}; expected: more than 0, of what can be");
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}
