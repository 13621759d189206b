//! What the law within limits did in a run, in sentences.

use std::fmt;

use controller_core::arm::ArmParameters;

use super::{LevelEvents, LimitEvents, NEAR_ONE};

/// Most sentences on a run; the most important ones come first.
const SENTENCES: usize = 6;

/// Most joints in a sentence, the longest at their bounds first.
const JOINTS_IN_A_SENTENCE: usize = 3;

/// So many cycles are counted, not timed.
const FEW_CYCLES: f64 = 10.0;

impl LimitEvents {
    /// One sentence per level that is stuck at the end.
    #[must_use]
    pub fn unreached(&self, levels: &[(String, bool)]) -> Vec<String> {
        let events = (1..).zip(self.levels.iter().zip(levels));
        events
            .filter_map(|(number, (events, (name, rotates)))| {
                let error = 1e3 * events.stuck_at_end?;
                let unit = if *rotates { "mrad" } else { "mm" };
                Some(format!(
                    "level {number} ({name}) ends {error:.3} {unit} off its target, stuck in a \
                     singularity that no free motion leads out of"
                ))
            })
            .collect()
    }

    /// A sentence per kind of event, the most important first and no more than can be read; of a
    /// run in cycles of `cycle_s` \[s\].
    #[must_use]
    pub fn sentences(
        &self,
        arm: &ArmParameters,
        levels: &[(String, bool)],
        cycle_s: f64,
    ) -> Vec<String> {
        let lasting = |time_s| Lasting { time_s, cycle_s };
        let mut said = Vec::new();
        if self.unresolved_cycles > 0 {
            said.push(format!(
                "in {} too many joints were at their bounds at once: these were kept, \
                 priorities were not",
                counted(self.unresolved_cycles, "cycle")
            ));
        }
        for (number, (events, (name, rotates))) in (1..).zip(self.levels.iter().zip(levels)) {
            said.extend(events.sentence(number, name, *rotates, lasting));
        }
        for (place, (of_one, of_more)) in [
            ("at the end of its range", "at the ends of their ranges"),
            ("at its speed limit", "at their speed limits"),
            ("at its acceleration limit", "at their acceleration limits"),
        ]
        .into_iter()
        .enumerate()
        {
            let joints = self.joints.iter().zip(&arm.links);
            let times = joints.map(|(events, link)| (link.name, events.times()[place]));
            let mut times: Vec<_> = times.filter(|(_, time)| *time > 0.0).collect();
            times.sort_by(|(_, a), (_, b)| b.total_cmp(a));
            let joint = |(name, time): &(&str, f64)| format!("{name} {}", lasting(*time));
            let mut names: Vec<_> = times.iter().take(JOINTS_IN_A_SENTENCE).map(joint).collect();
            match times.as_slice() {
                [] => continue,
                [(name, time)] => said.push(format!("{name} was {of_one} {}", lasting(*time))),
                more => {
                    if more.len() > names.len() {
                        names.push(format!("{} more", more.len() - names.len()));
                    }
                    said.push(format!("joints {of_more}: {}", names.join(", ")));
                }
            }
        }
        if self.null_scaled_s > 0.0 {
            said.push(format!(
                "the null space was scaled (to {:.0} % at worst) {}",
                (100.0 * self.null_least_share).floor(),
                lasting(self.null_scaled_s)
            ));
        }
        if said.len() > SENTENCES {
            let more = said.split_off(SENTENCES - 1).len();
            said.push(format!(
                "{more} more kinds of limits were met: limit_events of summary.json"
            ));
        }
        said
    }
}

impl LevelEvents {
    /// None where nothing was so.
    fn sentence(
        &self,
        number: usize,
        name: &str,
        rotates: bool,
        lasting: impl Fn(f64) -> Lasting,
    ) -> Option<String> {
        // In a singularity it is near one all the time.
        let near = |what: &str| what == NEAR_ONE && self.released_s > 0.0;
        let times = self.times().into_iter();
        let times = times.filter(|(time, what)| *time > 0.0 && !near(what));
        let mut why: Vec<_> = times
            .map(|(time, what)| format!("{what} {}", lasting(time)))
            .collect();
        if self.scaled_s > 0.0 {
            why.push(format!(
                "scaled (to {:.0} % at worst) {}",
                (100.0 * self.least_share).floor(),
                lasting(self.scaled_s)
            ));
        }
        let unit = if rotates { "mrad" } else { "mm" };
        self.is_any().then(|| {
            format!(
                "level {number} ({name}) gave way by up to {:.3} {unit}: {}",
                1e3 * self.error_max,
                why.join(", ")
            )
        })
    }
}

/// How long something was so: few cycles by their number.
#[derive(Clone, Copy)]
struct Lasting {
    time_s: f64,
    cycle_s: f64,
}

impl fmt::Display for Lasting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let cycles = (self.time_s / self.cycle_s).round();
        if cycles < FEW_CYCLES {
            write!(f, "for {}", counted(cycles as usize, "cycle"))
        } else if self.time_s < 0.9995 {
            write!(f, "for {:.0} ms", 1e3 * self.time_s)
        } else {
            write!(f, "for {:.2} s", self.time_s)
        }
    }
}

fn counted(number: usize, what: &str) -> String {
    let ending = if number == 1 { "" } else { "s" };
    format!("{number} {what}{ending}")
}

#[cfg(test)]
mod tests {
    use super::super::JointEvents;
    use super::*;
    use arms::LWR_IV;
    use controller_core::joint::DOF;

    fn joint(at_range_s: f64, at_speed_s: f64) -> JointEvents {
        JointEvents {
            at_range_s,
            at_speed_s,
            at_acceleration_s: 0.0,
        }
    }

    fn said(events: &LimitEvents) -> Vec<String> {
        let levels = [("flange xyz".into(), false), ("flange xyz".into(), true)];
        events.sentences(&LWR_IV, &levels, 0.002)
    }

    #[test]
    fn times_read_in_cycles_milliseconds_or_seconds() {
        for (cycles, text) in [
            (1, "for 1 cycle"),
            (2, "for 2 cycles"),
            (9, "for 9 cycles"),
            (10, "for 20 ms"),
            (499, "for 998 ms"),
            (500, "for 1.00 s"),
            (2617, "for 5.23 s"),
        ] {
            // Added up as in a run.
            let time_s = (0..cycles).map(|_| 0.002).sum();
            let lasting = Lasting {
                time_s,
                cycle_s: 0.002,
            };
            assert_eq!(lasting.to_string(), text);
        }
    }

    #[test]
    fn nothing_met_is_nothing_said() {
        let mut events = LimitEvents {
            joints: vec![JointEvents::default(); DOF],
            levels: vec![LevelEvents::default(); 2],
            ..LimitEvents::default()
        };
        assert!(!events.is_any() && said(&events).is_empty());
        events.joints[3].at_speed_s = 0.002;
        assert!(events.is_any());
        let name = LWR_IV.links[3].name;
        assert_eq!(
            said(&events),
            [format!("{name} was at its speed limit for 1 cycle")]
        );
    }

    #[test]
    fn what_matters_most_is_said_first_and_not_too_much() {
        let level = LevelEvents {
            released_s: 0.5,
            degraded_s: 0.6,
            disturbed_s: 1.25,
            error_max: 0.0315,
            ..LevelEvents::default()
        };
        let mut events = LimitEvents {
            joints: (0..7).map(|i| joint(0.1 * f64::from(i), 0.0)).collect(),
            levels: vec![level; 2],
            null_scaled_s: 0.004,
            null_least_share: 0.42,
            unresolved_cycles: 1,
            ..LimitEvents::default()
        };
        let names = LWR_IV.links.map(|link| link.name);
        assert_eq!(
            said(&events),
            [
                "in 1 cycle too many joints were at their bounds at once: these were kept, \
                 priorities were not",
                "level 1 (flange xyz) gave way by up to 31.500 mm: disturbed by the bounds of \
                 joints for 1.25 s, in a singularity for 500 ms",
                "level 2 (flange xyz) gave way by up to 31.500 mrad: disturbed by the bounds of \
                 joints for 1.25 s, in a singularity for 500 ms",
                &format!(
                    "joints at the ends of their ranges: {} for 600 ms, {} for 500 ms, {} for \
                     400 ms, 3 more",
                    names[6], names[5], names[4]
                ),
                "the null space was scaled (to 42 % at worst) for 2 cycles",
            ]
        );
        for events in &mut events.joints {
            (events.at_speed_s, events.at_acceleration_s) = (1.0, 1.0);
        }
        let said = said(&events);
        assert_eq!(said.len(), SENTENCES);
        assert_eq!(
            said[SENTENCES - 1],
            "2 more kinds of limits were met: limit_events of summary.json"
        );
    }
}
