//! `run` with a Franka robot.

use std::collections::BTreeMap;
use std::time::Duration;

use bridge::fci::{Fci, RobotState};
use bridge::protocol::Protocol;
use bridge::session::{Outcome, Phase, Session, SessionConfig};
use cell::invalid::Invalid;
use cell::realtime::Realtime;
use cell::scenario::Scenario;
use cell::terminal::tell;
use controller_core::TaskSet;
use controller_core::arm::{ArmParameters, Tool};
use controller_core::joint::JointVector;
use fci::client::{COMPLIANT, Cause, Client, Duty, Start, Stop};
use fci::{StatePacket, Version};

use super::options::{RunOptions, stop_flag, wrong_start};
use super::source::Source;
use super::telling::{Flight, Teller, unwritable};
use crate::fci::link::{self, Endpoint, PORT, Wish, converse};
use crate::fci::load::of_tool;
use crate::fci::model::UrdfAudit;
use crate::recorder::Recorder;
use crate::run::Counts;
use crate::summary::{FciSummary, wished_end};

/// Answers behind which the success rate is that of 100 commands.
const RATED: u64 = 100;

/// The session, and all that sees its cycles.
struct Host<'a> {
    config: SessionConfig,
    session: Session<Fci>,
    answer: <Fci as Protocol>::Answer,
    source: Source,
    tasks: TaskSet,
    /// The arm without its tool, for the robot's URDF.
    table: &'a ArmParameters,
    tool: Option<&'a Tool>,
    /// Thresholds, and the load where the robot has no end effector.
    start: Start,
    /// Start posture and how far it may be away \[rad\].
    required: Option<(JointVector<f64>, f64)>,
    /// A start posture that is too far away \[rad\].
    refused: Option<JointVector<f64>>,
    /// The session cannot work with this robot.
    unusable: Option<Invalid>,
    counts: Counts,
    rejected: BTreeMap<String, u64>,
    recorder: Option<Recorder<RobotState>>,
    flight: Flight<RobotState>,
    teller: Teller,
    urdf: Option<UrdfAudit>,
    /// Mass of the robot's own end effector \[kg\].
    m_ee: f64,
    success_rate_min: Option<f64>,
    answers: u64,
}

impl link::Host for Host<'_> {
    fn connected(&mut self, version: Version) {
        self.session = Session::new(Fci::new(version), self.config.clone());
    }

    fn ready(&mut self, version: Version, urdf: Option<&[u8]>) -> Option<Start> {
        tell(format_args!("connected, version {}", version.number()));
        match urdf.map(|urdf| UrdfAudit::of(urdf, self.table)) {
            None => tell("robot's URDF: none"),
            Some(Err(error)) => tell(format_args!("robot's URDF: not compared: {error}")),
            Some(Ok(audit)) => {
                tell(format_args!("robot's {audit}"));
                self.urdf = Some(audit);
            }
        }
        if let (Some((start, tolerance)), Some(cycle)) = (&self.required, self.session.last())
            && (cycle.joints.q - start).amax() > *tolerance
        {
            self.refused = Some(cycle.joints.q);
            return None;
        }
        if self.config.dry {
            return None;
        }
        // An end effector that the robot knows of is the tool: the audit compares it at rest.
        let tool = self.tool.filter(|_| self.m_ee == 0.0);
        let load = tool.map_or(self.start.load, of_tool);
        Some(Start { load, ..self.start })
    }

    fn state(&mut self, state: &StatePacket<&[u8]>, bytes: &[u8], duty: Duty) -> Option<&[u8]> {
        self.m_ee = state.m_ee();
        self.session.protocol_mut().attend(duty);
        let outcome = (self.session).receive(bytes, &mut self.source, &mut self.answer);
        match outcome {
            Outcome::Answered | Outcome::Heard => {}
            Outcome::Stale => return None,
            Outcome::Rejected(error) => return self.reject(&error.to_string()),
            Outcome::Doubted => return self.reject("a position or speed too far from the last"),
            Outcome::Unusable(error) => {
                self.unusable = Some(Invalid::line(error).within("the robot's cycle"));
                return None;
            }
        }
        let cycle = self.session.last()?;
        self.counts.add(&self.session, cycle, &self.tasks);
        if let Some(recorder) = &mut self.recorder {
            recorder.push(cycle);
        }
        self.flight.push(cycle);
        self.teller.tell(&self.session, cycle, None);
        if outcome == Outcome::Heard {
            return None;
        }
        self.answers += 1;
        if self.answers > RATED && duty == Duty::Answer {
            let rate = cycle.robot.success_rate;
            let lowest = self.success_rate_min.get_or_insert(rate);
            *lowest = lowest.min(rate);
        }
        Some(self.answer.as_ref())
    }

    fn wish(&mut self, stop: bool) -> Wish {
        if stop {
            self.session.stop();
        }
        let over = self.session.phase() == Phase::Finished;
        if over || self.refused.is_some() || self.unusable.is_some() {
            Wish::Finish
        } else {
            Wish::GoOn
        }
    }
}

impl Host<'_> {
    fn reject(&mut self, reason: &str) -> Option<&[u8]> {
        *self.rejected.entry(reason.to_string()).or_default() += 1;
        None
    }
}

impl RunOptions {
    /// Leads a Franka robot through the motion: the exit code.
    pub(super) fn run_fci(&self, scenario: &Scenario) -> Result<u8, Invalid> {
        let Some(robot) = self.address else {
            let allowed = "the address of the robot, such as 172.16.0.2";
            return Err(Invalid::new("--address", "none", allowed));
        };
        let config = self.config(scenario)?;
        let tasks = config.controller.tasks;
        let arm = scenario.arm();
        self.prepare_files()?;
        let recorder = match &self.record {
            Some(path) => Some(Recorder::create(path).map_err(|error| unwritable(path, &error))?),
            None => None,
        };
        let source = self.source(scenario, &config)?;
        let mut host = Host {
            session: Session::new(Fci::new(Version::V10), config.clone()),
            config,
            answer: Fci::EMPTY,
            source,
            tasks,
            table: scenario.robot.table()?,
            tool: arm.tool(),
            start: Start::uniform(
                self.collision_torque.unwrap_or(COMPLIANT),
                self.collision_force.unwrap_or(COMPLIANT),
            ),
            required: self.required_start(scenario),
            refused: None,
            unusable: None,
            counts: Counts::default(),
            rejected: BTreeMap::new(),
            recorder,
            flight: Flight::new(),
            teller: Teller::new(),
            urdf: None,
            m_ee: 0.0,
            success_rate_min: None,
            answers: 0,
        };
        let stop = stop_flag();
        let realtime = Realtime::ask(self.cpu);
        tell(realtime.line());
        tell(format_args!("connecting to {robot}:{PORT}"));
        let end = Endpoint {
            robot,
            wait: Duration::from_secs_f64(self.wait),
            stop: &stop,
        };
        let mut client = Client::new(self.recover);
        let counted = match converse(&end, &mut client, &mut host) {
            Ok(counted) => counted,
            Err(error) => {
                tell(format_args!("error: no robot at {robot}:{PORT}: {error}"));
                return Ok(4);
            }
        };
        if let Some(error) = host.unusable {
            return Err(error);
        }
        if let (Some(q), Some((_, tolerance))) = (host.refused, &host.required) {
            return Err(wrong_start(&q, *tolerance, scenario));
        }
        self.tell_dry(&host.session)?;
        self.tell_end(scenario, host, &client, counted, &realtime)
    }

    /// Files and closing lines: the exit code.
    fn tell_end(
        &self,
        scenario: &Scenario,
        mut host: Host<'_>,
        client: &Client,
        counted: link::Counts,
        realtime: &Realtime,
    ) -> Result<u8, Invalid> {
        let cause = Cause::Closed;
        let in_motion = false;
        let stop = client.stopped().unwrap_or(Stop { cause, in_motion });
        if let Some(error) = counted.last_rejected {
            *host.rejected.entry(error.to_string()).or_default() += counted.rejected;
        }
        host.counts
            .set_link(counted.commands, host.rejected, counted.strangers);
        host.counts.set_times(counted.compute, counted.latency);
        let names: Vec<_> = scenario.levels.iter().map(|level| level.label()).collect();
        let mut summary = host.counts.summary(
            &host.session,
            ending(&host.session, &stop),
            self.scenario(),
            &names,
            realtime,
        );
        summary.fci = Some(FciSummary {
            version: client.version().number(),
            event: stop.cause.event().name(),
            limited_cycles: host.session.protocol().limited_cycles(),
            success_rate_min: host.success_rate_min,
            overtaken: counted.overtaken,
            strays: client.strays(),
            recovery: client.recovery().map(|status| status.name()),
            urdf: host.urdf,
        });
        let mut recorded = Ok(0);
        if let (Some(recorder), Some(path)) = (host.recorder.take(), &self.record) {
            recorded = recorder.finish().map_err(|error| unwritable(path, &error));
        }
        summary.references = host.source.figures();
        summary.recorder_dropped = *recorded.as_ref().unwrap_or(&0);
        // A record that failed does not take the rest with it.
        self.report(&summary, &host.flight)?;
        recorded?;
        Ok(summary.exit_code)
    }
}

/// Exit code and reason: what the robot did counts more than what was wished, a fault of the
/// controller more than both.
fn ending(session: &Session<Fci>, stop: &Stop) -> (u8, String) {
    let fault = session.fault().is_some();
    let wished = wished_end(session).filter(|_| fault || stop.cause == Cause::Finished);
    match wished {
        Some((code, reason)) if stop.cause == Cause::Finished => (code, reason),
        Some((code, reason)) => (code, format!("{reason}; the robot: {stop}")),
        None => (stop.exit_code(), stop.to_string()),
    }
}
