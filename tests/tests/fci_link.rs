//! The bridge and the simulated robot with Franka's interface over a link that loses commands and
//! states, in virtual time: the figures that a user may count on.

use bridge::session::Phase;
use cell::names::{PlantKind, RobotInterface};
use cell::scenario::Scenario;
use controller_core::joint::JointVector;
use fci::client::{Cause, Event, Stop};
use fci::status::RecoveryStatus;
use fci::{RobotError, RobotMode, Version};
use hil_sim::link::Fault;
use hil_sim::loopback::{self, FciClient, Local as _};
use hil_sim::plant::PlantOptions;
use hil_sim::robot::{FciFigures, FciOptions, FciRobot, RobotSetup};
use hil_sim::summary::{Summary, Verdict};

/// The longest change of a joint's torque in a cycle that the robot bears \[Nm\].
const STEP_MAX_NM: f64 = 1.0;

struct Wish<'a> {
    plant: PlantKind,
    version: Version,
    seed: u64,
    duration_s: f64,
    faults: &'a [&'a str],
    recover: bool,
}

impl Default for Wish<'_> {
    fn default() -> Self {
        Self {
            plant: PlantKind::Realistic,
            version: Version::V10,
            seed: 1,
            duration_s: 12.0,
            faults: &[],
            recover: false,
        }
    }
}

/// What a run was.
struct Run {
    robot: FciRobot,
    client: FciClient,
    /// Cycles of the scenario, and those of them in which the session led the arm.
    cycles: usize,
    moving: usize,
    /// Largest change of what the client sent from one command to the next \[Nm\].
    sent_step_nm: f64,
}

fn run(wish: &Wish<'_>) -> Run {
    let mut scenario = Scenario::find("two-level-fr3").expect("built in");
    scenario.duration_s = wish.duration_s;
    let config = scenario.session_config_for(RobotInterface::Fci, 0, scenario.duration_s);
    let config = config.expect("a good scenario");
    let mut client = FciClient::new(config, &scenario, wish.recover);
    let options = FciOptions::of(&scenario, wish.version);
    let mut robot = FciRobot::new(RobotSetup {
        scenario,
        plant: wish.plant,
        contacts: true,
        seed: wish.seed,
        plant_options: PlantOptions::default(),
        options,
    });
    let faults: Vec<Fault> = (wish.faults.iter())
        .map(|spec| spec.parse().expect("a good fault"))
        .collect();
    let (mut cycles, mut moving, mut sent_step_nm) = (0, 0, 0.0_f64);
    let mut last: Option<(u64, JointVector<f64>)> = None;
    loopback::run(&mut robot, &mut client, &faults, |_, session| {
        cycles += 1;
        moving += usize::from(session.phase() == Phase::Moving);
        if let Some(cycle) = session.last() {
            if let Some((counter, sent)) = last
                && counter + 1 == cycle.counter
                && session.phase() != Phase::Ready
            {
                sent_step_nm = sent_step_nm.max((cycle.sent - sent).amax());
            }
            last = Some((cycle.counter, cycle.sent));
        }
        Ok(())
    })
    .expect("memory");
    Run {
        robot,
        client,
        cycles,
        moving,
        sent_step_nm,
    }
}

impl Run {
    fn summary(&self) -> Summary {
        self.robot.summary()
    }

    fn figures(&self) -> FciFigures {
        self.summary().fci.expect("a robot with the FCI")
    }

    fn limited(&self) -> u64 {
        self.client.session().protocol().limited_cycles()
    }

    fn stop(&self) -> Stop {
        self.client.machine().stopped().expect("an end")
    }

    /// It came to its end in good order.
    fn is_in_order(&self) -> bool {
        let figures = self.figures();
        self.stop().cause == Cause::Finished
            && self.client.session().phase() == Phase::Finished
            && self.summary().verdict != Verdict::Fail
            && (figures.motions, figures.reflexes) == (1, 0)
            && figures.command_share == Some(1.0)
    }

    /// Error of the flange \[mm\]: rms and largest.
    fn error(&self) -> (f64, f64) {
        let level = &self.summary().levels[0];
        (level.rms().expect("samples"), level.max().expect("samples"))
    }
}

/// Speeds are measured and torques are binary64 or 32: the link costs nothing that the scenario
/// without it does not show.
#[test]
fn a_sound_link_keeps_the_circle() {
    for version in [Version::V5, Version::V10] {
        for (plant, most) in [(PlantKind::Ideal, 0.07), (PlantKind::Realistic, 0.13)] {
            let sound = run(&Wish {
                plant,
                version,
                ..Wish::default()
            });
            let figures = sound.figures();
            let (rms, max) = sound.error();
            println!(
                "{version:?} {plant:?}: rms {rms:.4} mm, max {max:.3} mm, largest step {:.3} Nm",
                figures.largest_torque_step_nm
            );
            assert!(sound.is_in_order(), "{:?}", sound.stop());
            assert_eq!(figures.version, version.number());
            assert_eq!((figures.lost, figures.late, figures.repeated), (0, 0, 0));
            assert_eq!((sound.cycles, sound.moving), (12_000, 12_000));
            assert_eq!(sound.limited(), 0);
            // Without the link 0.061 and 0.111 mm over the seeds of the README, and what is
            // rounded on the way.
            assert!(rms < most, "{version:?} {plant:?}: {rms} mm");
        }
    }
}

/// 3 % lost each way.
#[test]
fn losses_of_three_percent_are_borne() {
    for seed in 1..=12 {
        let poor = run(&Wish {
            seed,
            faults: &["both:drop=0.03"],
            ..Wish::default()
        });
        let figures = poor.figures();
        let (rms, max) = poor.error();
        println!(
            "seed {seed}: {} of {} commands lost, success rate at least {:.2}, {} cycles limited, \
             largest step {:.3} Nm, rms {rms:.4} mm, max {max:.3} mm",
            figures.lost,
            figures.lost + figures.commands,
            figures.success_rate_min.unwrap_or_default(),
            poor.limited(),
            figures.largest_torque_step_nm
        );
        assert!(poor.is_in_order(), "seed {seed}: {:?}", poor.stop());
        // 1 - 0.97^2 of 13,500, within six standard deviations.
        assert!(
            (630..970).contains(&figures.lost),
            "seed {seed}: {figures:?}"
        );
        assert!(figures.largest_torque_step_nm <= STEP_MAX_NM, "{figures:?}");
        assert!(poor.sent_step_nm <= STEP_MAX_NM, "{}", poor.sent_step_nm);
        // A torque that acts a cycle longer in one of 17 cycles: a tenth above the sound link, which
        // has the 0.111 mm of the scenario without it.
        assert!(rms < 1.1 * 0.111, "seed {seed}: {rms} mm");
    }
}

/// Up to 15 in a row: what was wanted meanwhile is further away than a step.
#[test]
fn behind_gaps_the_torque_goes_on_by_steps_that_are_counted() {
    let mut limited = 0;
    for seed in 1..=10 {
        let gaps = run(&Wish {
            seed,
            faults: &["to-robot:burst=0.002x15@2-11"],
            ..Wish::default()
        });
        let figures = gaps.figures();
        let (rms, max) = gaps.error();
        println!(
            "seed {seed}: {} commands lost, {} cycles limited, largest step {:.4} Nm, rms {rms:.3} \
             mm, max {max:.3} mm: {}",
            figures.lost,
            gaps.limited(),
            figures.largest_torque_step_nm,
            gaps.stop()
        );
        assert!(figures.largest_torque_step_nm <= STEP_MAX_NM, "{figures:?}");
        // Neither a step that the robot refuses nor 20 in a row.
        assert!(gaps.is_in_order(), "seed {seed}: {:?}", gaps.stop());
        limited += gaps.limited();
    }
    assert!(limited > 0);
}

/// 20 commands in a row are missing in the middle of the motion, lost themselves or with the states
/// that they answer.
#[test]
fn the_twentieth_lost_command_in_a_row_ends_the_motion() {
    for (faults, recover) in [
        ("to-robot:drop=1@1-1.02", false),
        ("to-robot:drop=1@1-1.02", true),
        ("to-client:drop=1@1-1.02", false),
        ("to-client:drop=1@1-1.02", true),
        ("both:freeze@1-1.05", true),
    ] {
        let broken = run(&Wish {
            duration_s: 2.0,
            faults: &[faults],
            recover,
            ..Wish::default()
        });
        let (figures, stop) = (broken.figures(), broken.stop());
        let events: Vec<_> = figures.events.iter().map(|event| &event.text).collect();
        println!("{faults}, recover {recover}: {stop}; {events:?}");
        let error = RobotError::CommunicationConstraintsViolation;
        assert_eq!(stop.cause.event(), Event::Lost, "{stop:?}");
        assert_eq!((stop.exit_code(), stop.in_motion), (3, true));
        assert!(
            stop.to_string()
                .starts_with(&format!("reflex: {}", error.name()))
        );
        assert_eq!(figures.errors, [error.name()]);
        assert_eq!(
            (figures.motions, figures.reflexes, figures.lost),
            (1, 1, 20)
        );
        assert!(figures.largest_torque_step_nm <= STEP_MAX_NM, "{figures:?}");
        let (recovery, mode) = match recover {
            false => (None, RobotMode::Reflex),
            true => (Some(RecoveryStatus::Success), RobotMode::Idle),
        };
        assert_eq!(broken.client.machine().recovery(), recovery);
        let mut robot = broken.robot;
        assert_eq!(robot.control().mode(), mode);
        let summary = robot.summary();
        assert_eq!(summary.verdict, Verdict::Fail);
        let reason = summary.reason.expect("a reason");
        assert!(reason.contains(error.name()), "{reason}");
    }
}

/// The same seed gives the same commands, another one does not.
#[test]
fn faults_are_those_of_the_seed() {
    let run = |seed| {
        let wish = Wish {
            seed,
            duration_s: 2.0,
            plant: PlantKind::Ideal,
            faults: &["both:drop=0.05"],
            ..Wish::default()
        };
        serde_json::to_string(&run(&wish).summary()).expect("JSON")
    };
    let first = run(3);
    assert_eq!(first, run(3));
    // The seed itself is part of the summary.
    assert_ne!(
        first.replace("\"seed\":3", ""),
        run(4).replace("\"seed\":4", "")
    );
}
