//! The bridge and the simulated robot over a link that loses, delays and
//! freezes, in virtual time: the figures that a user may count on.

use bridge::lwr::Lwr;
use bridge::session::Phase;
use cell::names::PlantKind;
use cell::scenario::Scenario;
use hil_sim::link::Fault;
use hil_sim::loopback::{self, BridgeClient};
use hil_sim::plant::PlantOptions;
use hil_sim::robot::{LinkFigures, LwrRobot, RobotOptions, RobotSetup};

const SEEDS: std::ops::RangeInclusive<u64> = 1..=5;

/// What a run was.
struct Run {
    /// (t \[s\], error \[mm\] of level 1, torque \[Nm\]) per cycle.
    cycles: Vec<(f64, f64, [f64; 7])>,
    link: LinkFigures,
    phases: Vec<Phase>,
    limits: usize,
    stopped: bool,
}

struct Wish<'a> {
    plant: PlantKind,
    contacts: bool,
    dead_cycles: usize,
    seed: u64,
    faults: &'a [&'a str],
    options: RobotOptions,
}

impl Default for Wish<'_> {
    fn default() -> Self {
        Self {
            plant: PlantKind::Realistic,
            contacts: true,
            dead_cycles: 0,
            seed: 1,
            faults: &[],
            options: RobotOptions::default(),
        }
    }
}

fn run(wish: &Wish<'_>) -> Run {
    let scenario = Scenario::find("two-level").expect("built in");
    let config = scenario.session_config(wish.dead_cycles as u8, scenario.duration_s);
    let config = config.expect("a good scenario");
    let mut client = BridgeClient::new(Lwr::new(), config, &scenario);
    let mut robot = LwrRobot::new(RobotSetup {
        scenario,
        plant: wish.plant,
        contacts: wish.contacts,
        seed: wish.seed,
        plant_options: PlantOptions {
            dead_cycles: wish.dead_cycles,
            ..PlantOptions::default()
        },
        options: wish.options,
    });
    let faults: Vec<Fault> = (wish.faults.iter())
        .map(|spec| spec.parse().expect("a good fault"))
        .collect();
    let (mut cycles, mut phases) = (Vec::new(), Vec::new());
    loopback::run(&mut robot, &mut client, &faults, |instant, session| {
        let error_mm = instant.levels[0].error * 1e3;
        cycles.push((instant.t_s, error_mm, instant.torque.into()));
        phases.push(session.phase());
        Ok(())
    })
    .expect("memory");
    phases.push(client.session.phase());
    let summary = robot.summary();
    let limits = summary.limits.torque + summary.limits.position;
    Run {
        cycles,
        link: summary.link.expect("the robot's side"),
        phases,
        limits,
        stopped: summary.verdict == hil_sim::summary::Verdict::Stopped,
    }
}

impl Run {
    fn rms(&self) -> f64 {
        let squares: f64 = self.cycles.iter().map(|(_, e, _)| e * e).sum();
        (squares / self.cycles.len() as f64).sqrt()
    }

    fn worst_between(&self, from_s: f64, to_s: f64) -> f64 {
        let inside = (self.cycles.iter()).filter(|(t, ..)| (from_s..to_s).contains(t));
        inside.map(|(_, e, _)| *e).fold(0.0, f64::max)
    }

    /// Largest change of a torque from one cycle to the next \[Nm\].
    fn torque_step(&self) -> f64 {
        let pairs = self.cycles.windows(2);
        let steps = pairs.flat_map(|pair| {
            let [(.., before), (.., after)] = [pair[0], pair[1]];
            (0..7).map(move |joint| (after[joint] - before[joint]).abs())
        });
        steps.fold(0.0, f64::max)
    }
}

/// Binary32 positions and a speed that is 2.8 ms late cost little, a cycle of dead
/// time little more.
#[test]
fn a_sound_link_keeps_the_circle() {
    for dead_cycles in [0, 1] {
        let wish = |plant, contacts, seed| Wish {
            plant,
            contacts,
            dead_cycles,
            seed,
            ..Wish::default()
        };
        let free = run(&wish(PlantKind::Ideal, false, 1));
        assert!(free.rms() < 0.06, "{dead_cycles}: {}", free.rms());
        let pushed = run(&wish(PlantKind::Ideal, true, 1));
        assert!(pushed.rms() < 0.25, "{dead_cycles}: {}", pushed.rms());
        for seed in SEEDS {
            let real = run(&wish(PlantKind::Realistic, true, seed));
            assert!(real.rms() < 0.6, "{dead_cycles} {seed}: {}", real.rms());
            assert_eq!(real.link.missed, 0);
            assert_eq!(real.phases.last(), Some(&Phase::Finished));
        }
    }
}

/// 2 % lost each way, 2 % overtaken, up to 1 ms late each way in a cycle of 2 ms.
#[test]
fn a_poor_link_keeps_command_state_and_the_circle() {
    for seed in SEEDS {
        let sound = run(&Wish {
            seed,
            ..Wish::default()
        });
        let poor = run(&Wish {
            seed,
            faults: &["both:drop=0.02", "both:reorder=0.02", "both:jitter=1"],
            ..Wish::default()
        });
        assert_eq!(poor.link.fallbacks, 0, "seed {seed}");
        assert!(poor.link.missed > 300 && poor.link.quality_cycles.bad > 1000);
        let (poor, sound) = (poor.rms(), sound.rms());
        assert!(poor < 2.0 * sound, "seed {seed}: {poor} against {sound} mm");
    }
}

/// 15 % lost each way for 3 s: too much to command. The robot falls back and holds,
/// and the motion goes on once the link is good again.
#[test]
fn a_bad_link_falls_back_without_a_jolt_and_recovers() {
    for seed in SEEDS {
        let bad = run(&Wish {
            seed,
            faults: &["both:drop=0.15@5-8"],
            ..Wish::default()
        });
        assert!(!bad.stopped && bad.link.fallbacks >= 1 && bad.link.recoveries >= 1);
        assert!(
            bad.torque_step() < 5.0,
            "seed {seed}: {} Nm",
            bad.torque_step()
        );
        let events = bad.link.events.iter();
        let back = events.filter(|event| event.text.starts_with("command state"));
        let back = back.filter_map(|event| event.t_s).fold(0.0, f64::max);
        assert!(
            (8.0..9.0).contains(&back),
            "seed {seed}: in command at {back} s"
        );
        // Joined at 0.25 m/s from wherever it was held on a circle of 0.1 m radius: 0.8 s.
        let after = bad.worst_between(back + 0.9, 20.0);
        assert!(after < 2.5, "seed {seed}: {after} mm");
    }
}

/// Nothing passes for 100 ms while the arm moves; with a robot that falls back and
/// with one that goes on with the last torque.
#[test]
fn a_frozen_link_holds_the_arm_and_resumes() {
    let mut patient = RobotOptions::default();
    patient.rating.misses_max = 100;
    patient.rating.bad_rate = 0.1;
    for options in [RobotOptions::default(), patient] {
        for faults in [
            ["both:freeze@5-5.1"],
            ["to-robot:drop=1@5-5.1"],
            ["to-client:drop=1@5-5.1"],
        ] {
            let frozen = run(&Wish {
                faults: &faults,
                options,
                ..Wish::default()
            });
            let what = faults[0];
            assert!(!frozen.stopped, "{what}");
            assert_eq!(frozen.limits, 0, "{what}");
            assert!(
                frozen.torque_step() < 5.0,
                "{what}: {}",
                frozen.torque_step()
            );
            let held = frozen.phases.contains(&Phase::Holding);
            assert!(held || frozen.link.fallbacks == 1, "{what}");
            let after = frozen.worst_between(6.5, 20.0);
            assert!(after < 1.8, "{what}: {after} mm");
        }
    }
}

/// The same seed gives the same bytes, another one does not.
#[test]
fn faults_are_those_of_the_seed() {
    let run = |seed| {
        let wish = Wish {
            seed,
            plant: PlantKind::Ideal,
            faults: &["both:drop=0.05"],
            ..Wish::default()
        };
        run(&wish).cycles
    };
    let first = run(3);
    assert_eq!(first, run(3));
    assert_ne!(first, run(4));
}
