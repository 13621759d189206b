//! Changes of tasks and gains that arrive while the arm moves: over UDP beside references, or
//! typed.
//!
//! One line is one change; levels count from 1 as in the scenario, times are in s:
//!
//! ```text
//! add LEVEL [at PLACE]      remove LEVEL      order LEVEL LEVEL ..
//! gains LEVEL K_P K_D       null-space K_1 .. K_7 RATE
//! ```
//!
//! each with ` in SECONDS` behind it, or it takes half a second. A level has the task and, until
//! they are changed, the gains of the scenario. `null-space` is K_q \[Nm/rad\] of the joints and c
//! of D = c M \[1/s\].

use std::io;
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};

use bridge::source::Begin;
use cell::invalid::Invalid;
use cell::ranges::{CHANGE_S, GAIN, Number, Range};
use cell::scenario::Scenario;
use cell::terminal::{next_line, tell};
use controller_core::gain::diagonal;
use controller_core::joint::DOF;
use controller_core::law::null_space::{NullDamping, NullSpace, Posture};
use controller_core::ranges::CHANGE_S as USUAL_S;
use controller_core::{Change, Controller, Order, TaskGains, Transition};

/// Changes that wait for the loop.
const QUEUE: usize = 16;

/// Letters of a line.
const LONGEST: usize = 512;

/// What may be written.
const WORDS: [&str; 5] = ["add", "remove", "order", "gains", "null-space"];

/// A change with the line that asked for it.
type Asked = (String, Box<Transition<f64>>);

/// The loop's end: changes that wait to be begun.
#[derive(Debug)]
pub struct Changes {
    queue: Receiver<Asked>,
}

/// The other end: lines become changes.
#[derive(Clone, Debug)]
pub struct Lines {
    scenario: Scenario,
    controller: Controller<f64>,
    queue: SyncSender<Asked>,
}

/// Both ends, for a loop of `controller`, of this scenario.
#[must_use]
pub fn channel(scenario: &Scenario, controller: &Controller<f64>) -> (Lines, Changes) {
    let (sender, queue) = sync_channel(QUEUE);
    let lines = Lines {
        scenario: scenario.clone(),
        controller: controller.clone(),
        queue: sender,
    };
    (lines, Changes { queue })
}

impl Changes {
    /// Begins what has arrived. What cannot be is told and left out.
    pub fn begin(&self, begin: &mut Begin<'_>) {
        while let Ok((line, change)) = self.queue.try_recv() {
            match begin(&change) {
                Ok(()) => tell(format_args!("begun: {line}")),
                Err(error) => tell(format_args!("refused: {line}: {error}")),
            }
        }
    }
}

impl Lines {
    /// Whether a text is meant as a change: references begin with a number.
    #[must_use]
    pub fn is_change(text: &str) -> bool {
        text.trim_start()
            .starts_with(|first: char| first.is_ascii_alphabetic())
    }

    /// Hands a line to the loop.
    ///
    /// # Errors
    /// Why it is no change.
    pub fn send(&self, line: &str) -> Result<(), Invalid> {
        let (change, duration_s) = parse(line, &self.scenario)?;
        let prepared = self.controller.transition(&change, duration_s);
        let prepared = Box::new(prepared.map_err(Invalid::line)?);
        match self.queue.try_send((line.trim().to_string(), prepared)) {
            Err(TrySendError::Full(_)) => Err(Invalid::new(
                "changes",
                "one more",
                format_args!("{QUEUE} at once"),
            )),
            // A loop that has ended needs none.
            _ => Ok(()),
        }
    }

    /// Takes lines from standard input, in a thread of its own.
    ///
    /// # Errors
    /// There is no thread.
    pub fn listen_to_console(self) -> io::Result<()> {
        let thread = std::thread::Builder::new().name("changes".into());
        thread.spawn(move || {
            let mut input = io::stdin().lock();
            while let Ok(Some(line)) = next_line(&mut input, LONGEST) {
                if line.trim().is_empty() {
                    continue;
                }
                if let Err(error) = self.send(&line) {
                    tell(format_args!("refused: {}: {error}", line.trim()));
                }
            }
        })?;
        Ok(())
    }
}

/// A change as a line says it, and how long it takes \[s\].
fn parse(line: &str, scenario: &Scenario) -> Result<(Change, f64), Invalid> {
    let mut words: Vec<_> = line.split_whitespace().collect();
    let mut duration_s = USUAL_S;
    if let [.., "in", seconds] = words.as_slice() {
        duration_s = number("seconds", seconds, CHANGE_S)?;
        words.truncate(words.len() - 2);
    }
    let levels = Range::new(1, scenario.levels.len());
    let level = |word: &str| Ok::<_, Invalid>(number("level", word, levels)? - 1);
    let change = match words.as_slice() {
        ["add", number_of, rest @ ..] => {
            let slot = level(number_of)?;
            let place = match rest {
                [] => None,
                ["at", place] => Some(number("place", place, Range::new(1, levels.max))? - 1),
                other => return Err(Invalid::new("add", other.join(" "), "at PLACE, or nothing")),
            };
            Change::Add {
                slot,
                task: scenario.levels[slot].task(slot, &scenario.arm()),
                place: place.unwrap_or(Change::BELOW_ALL),
            }
        }
        ["remove", number_of] => Change::Remove {
            slot: level(number_of)?,
        },
        ["order", numbers @ ..] => {
            let slots: Vec<_> = numbers
                .iter()
                .map(|word| level(word))
                .collect::<Result<_, _>>()?;
            let order = Order::new(&slots);
            Change::Reorder(
                order
                    .ok_or_else(|| Invalid::new("order", numbers.join(" "), "levels, each once"))?,
            )
        }
        ["gains", number_of, stiffness, damping] => {
            let stiffness = number("K_P", stiffness, GAIN)?;
            let damping = number("K_D", damping, GAIN)?;
            Change::Gains {
                slot: level(number_of)?,
                gains: TaskGains::uniform(stiffness, damping),
            }
        }
        ["null-space", numbers @ ..] if numbers.len() == DOF + 1 => {
            let mut values = [0.0; DOF + 1];
            for (value, word) in values.iter_mut().zip(numbers) {
                *value = number("null-space", word, GAIN)?;
            }
            let [stiffness @ .., rate] = values;
            Change::NullSpace(NullSpace {
                stiffness: diagonal(stiffness),
                damping: NullDamping::Inertia(rate),
                posture: Posture::Constant,
            })
        }
        [word, ..] if WORDS.contains(word) => {
            let allowed = "add LEVEL [at PLACE], remove LEVEL, order LEVEL .., gains LEVEL K_P K_D, \
                           null-space K_1 .. K_7 RATE; behind it: in SECONDS";
            return Err(Invalid::new("change", line.trim(), allowed));
        }
        [word, ..] => return Err(Invalid::name("change", word, &WORDS)),
        [] => return Err(Invalid::name("change", "", &WORDS)),
    };
    Ok((change, duration_s))
}

fn number<T: Number>(thing: &str, word: &str, range: Range<T>) -> Result<T, Invalid> {
    match word.parse() {
        Ok(value) => range.check(thing, value),
        Err(_) => Err(Invalid::new(thing, word, range)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scenario() -> Scenario {
        Scenario::find("case-1").expect("built in")
    }

    #[test]
    fn lines_are_changes() {
        let scenario = scenario();
        let of = |line: &str| parse(line, &scenario).expect(line);
        assert_eq!(of("remove 2"), (Change::Remove { slot: 1 }, 0.5));
        assert_eq!(of(" order 2 1  in 0.3 ").1, 0.3);
        let (change, duration_s) = of("gains 1 100 20 in 2");
        assert_eq!(duration_s, 2.0);
        let gains = TaskGains::uniform(100.0, 20.0);
        assert_eq!(change, Change::Gains { slot: 0, gains });
        let Change::Add { slot, place, task } = of("add 2 at 1").0 else {
            panic!("an addition");
        };
        assert_eq!((slot, place), (1, 0));
        assert_eq!(task, scenario.levels[1].task(1, &scenario.arm()));
        assert!(matches!(
            of("null-space 1 1 1 1 1 1 1 5").0,
            Change::NullSpace(_)
        ));
    }

    #[test]
    fn others_say_what_is_allowed() {
        let scenario = scenario();
        for (line, words) in [
            ("", "allowed: add, remove, order, gains, null-space"),
            ("jump 1", "allowed: add, remove, order, gains, null-space"),
            ("remove", "remove LEVEL"),
            ("remove 3", "1 to 2"),
            ("remove x", "1 to 2"),
            ("add 1 on 2", "at PLACE"),
            ("add 1 at 9", "1 to 2"),
            ("gains 1 -4 20", "above 0"),
            ("gains 1 nan 20", "above 0"),
            ("order 1 1", "each once"),
            ("null-space 1 2 3", "K_7 RATE"),
            ("remove 1 in 0.01", "0.05 to 60"),
        ] {
            let error = parse(line, &scenario).expect_err(line).to_string();
            assert!(error.contains(words), "{line}: {error}");
        }
    }

    #[test]
    fn what_the_core_refuses_is_refused_here() {
        let scenario = scenario();
        let config = scenario.session_config(0, 1.0).expect("valid");
        let controller = Controller::new(&config.arm, &config.controller).expect("valid");
        let (lines, changes) = channel(&scenario, &controller);
        assert!(lines.send("gains 1 400 40").is_ok());
        assert!(lines.send("null-space 1 1 1 1 1 1 1 900").is_err());
        let mut begun = 0;
        changes.begin(&mut |_| {
            begun += 1;
            Ok(())
        });
        assert_eq!(begun, 1);
    }
}
