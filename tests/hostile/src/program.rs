//! Cases on all processors, and the command line around them.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;
use std::sync::Mutex;
use std::thread;
use std::time::Instant;

use crate::random::Random;
use crate::table::{Table, missing};

/// The cases are so many sequences, whatever the number of processors: the same seed gives the
/// same cases everywhere.
const LANES: u64 = 16;

/// Fewer cases may miss a kind of answer.
const COUNT_MIN: u64 = 10_000;

/// What is damaged, and what must be made of it.
pub trait Cases {
    /// The next case.
    ///
    /// # Errors
    /// What was not treated as it must be, and how.
    fn case(&mut self, random: &mut Random) -> Result<(), String>;

    /// The bytes of the last case.
    fn bytes(&self) -> &[u8];

    /// What was answered so far.
    fn tables(self) -> Vec<Table>;
}

/// Gives a reader `count` cases, lane by lane, each lane with what `new` makes.
///
/// # Errors
/// The first case of a lane that panics or is not treated as it must be: lane, number, reason,
/// bytes.
pub fn run<C: Cases>(
    count: u64,
    seed: u64,
    new: impl Fn() -> C + Sync,
) -> Result<Vec<Table>, String> {
    let next = Mutex::new(0..LANES);
    let take = || next.lock().map_or(None, |mut lanes| lanes.next());
    let work = || -> Result<Vec<Table>, String> {
        let mut sum = Vec::new();
        while let Some(lane) = take() {
            let cases = count / LANES + u64::from(lane < count % LANES);
            add(&mut sum, self::lane(cases, seed, lane, new())?);
        }
        Ok(sum)
    };
    let workers = thread::available_parallelism().map_or(1, usize::from);
    thread::scope(|scope| {
        let workers: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
        let mut sum = Vec::new();
        for worker in workers {
            let tables = worker.join().map_err(|_| "a lane without its cases")?;
            add(&mut sum, tables?);
        }
        Ok(sum)
    })
}

fn lane<C: Cases>(count: u64, seed: u64, lane: u64, mut cases: C) -> Result<Vec<Table>, String> {
    let mut random = Random::new(seed, lane);
    for number in 0..count {
        let outcome = catch_unwind(AssertUnwindSafe(|| cases.case(&mut random)));
        outcome
            .unwrap_or_else(|_| Err("panic".into()))
            .map_err(|why| {
                let hex: String = (cases.bytes().iter())
                    .map(|byte| format!("{byte:02x}"))
                    .collect();
                format!("lane {lane}, case {number}: {why}; bytes: {hex}")
            })?;
    }
    Ok(cases.tables())
}

fn add(sum: &mut Vec<Table>, tables: Vec<Table>) {
    if sum.is_empty() {
        *sum = tables;
    } else {
        for (sum, table) in sum.iter_mut().zip(&tables) {
            sum.add(table);
        }
    }
}

/// A part of a program: what it damages, and [`run`] with a count and a seed.
pub type Part<'a> = (&'a str, &'a dyn Fn(u64, u64) -> Result<Vec<Table>, String>);

fn arguments(given: impl IntoIterator<Item = String>) -> Result<(u64, u64), String> {
    let mut given = given.into_iter();
    let mut number = |name: &str, min: u64, default: u64| {
        let Some(text) = given.next() else {
            return Ok(default);
        };
        let number = text.parse().ok().filter(|&number| number >= min);
        let most = u64::MAX;
        number
            .ok_or_else(|| format!("{name}: {text:?}; allowed: whole numbers from {min} to {most}"))
    };
    let count = number("COUNT", COUNT_MIN, 10_000_000)?;
    let seed = number("SEED", 0, 1)?;
    match given.next() {
        Some(more) => Err(format!("argument {more:?}; allowed: [COUNT [SEED]]")),
        None => Ok((count, seed)),
    }
}

/// `[COUNT [SEED]]`: COUNT cases for each part, 10000000 and seed 1 unless given. Exit code 0:
/// everything is treated as it must be, and every kind of answer that there is occurred; 1: not
/// so, with the bytes; 2: bad arguments.
#[must_use]
pub fn main(parts: &[Part<'_>]) -> ExitCode {
    let given = std::env::args_os().skip(1);
    let given = given.map(|text| text.to_string_lossy().into_owned());
    let (count, seed) = match arguments(given) {
        Ok(arguments) => arguments,
        Err(error) => {
            eprintln!("{error}");
            return ExitCode::from(2);
        }
    };
    let mut fine = true;
    for (what, run) in parts {
        let start = Instant::now();
        let tables = match run(count, seed) {
            Ok(tables) => tables,
            Err(failure) => {
                eprintln!("{what}: seed {seed}, {failure}");
                return ExitCode::FAILURE;
            }
        };
        let elapsed_s = start.elapsed().as_secs_f64();
        let rate = count as f64 / elapsed_s / 1e6;
        println!(
            "{what}: {count} cases, seed {seed}, {elapsed_s:.1} s, {rate:.2} million per second"
        );
        for table in &tables {
            println!("{table}");
        }
        if let Some(missing) = missing(&tables) {
            eprintln!("{what}: {missing}; expected: more than 0 of what can be, 0 of the rest");
            fine = false;
        }
    }
    u8::from(!fine).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Counts, and fails at one case or panics there.
    struct Counted {
        table: Table,
        until: Option<u64>,
        panics: bool,
    }

    impl Cases for Counted {
        fn case(&mut self, random: &mut Random) -> Result<(), String> {
            self.table.count(random.below(2), 0);
            match &mut self.until {
                Some(0) if self.panics => panic!("on purpose"),
                Some(0) => return Err("wrong".into()),
                Some(left) => *left -= 1,
                None => {}
            }
            Ok(())
        }

        fn bytes(&self) -> &[u8] {
            &[0xAB, 0x01]
        }

        fn tables(self) -> Vec<Table> {
            vec![self.table]
        }
    }

    fn counted(until: Option<u64>, panics: bool) -> Counted {
        let table = Table::new("answer", &["yes", "no"]).with("cases", &[]);
        Counted {
            table,
            until,
            panics,
        }
    }

    #[test]
    fn every_case_is_counted_and_the_seed_decides() {
        let tables = |seed| run(1003, seed, || counted(None, false)).expect("no failure");
        let text = tables(1)[0].to_string();
        let numbers = text
            .split_whitespace()
            .filter_map(|word| word.parse::<u64>().ok());
        assert_eq!(numbers.sum::<u64>(), 1003, "{text}");
        assert_eq!(tables(1), tables(1));
        assert_ne!(tables(1), tables(2));
    }

    #[test]
    fn a_failure_has_its_place_and_its_bytes() {
        for (panics, why) in [(false, "wrong"), (true, "panic")] {
            let failure = run(1600, 1, || counted(Some(5), panics)).expect_err("a failure");
            assert!(
                failure.ends_with(&format!(", case 5: {why}; bytes: ab01")),
                "{failure}"
            );
        }
    }

    #[test]
    fn arguments_are_count_and_seed() {
        let parsed = |text: &str| arguments(text.split_whitespace().map(String::from));
        assert_eq!(parsed(""), Ok((10_000_000, 1)));
        assert_eq!(parsed("20000 7"), Ok((20_000, 7)));
        assert_eq!(
            parsed("9999"),
            Err(
                "COUNT: \"9999\"; allowed: whole numbers from 10000 to 18446744073709551615".into()
            )
        );
        assert_eq!(
            parsed("20000 1 2"),
            Err("argument \"2\"; allowed: [COUNT [SEED]]".into())
        );
    }
}
