//! `run` with an LWR.

use std::net::{IpAddr, Ipv4Addr, SocketAddr, UdpSocket};
use std::sync::atomic::Ordering;
use std::time::Duration;

use bridge::lwr::Lwr;
use bridge::session::{Phase, RobotAdds, Session, SessionConfig};
use cell::invalid::Invalid;
use cell::realtime::Realtime;
use cell::scenario::Scenario;
use cell::terminal::tell;

use super::options::{RunOptions, stop_flag, wrong_start};
use super::telling::{Flight, Teller, unwritable};
use crate::recorder::Recorder;
use crate::run::{Endpoint, converse};
use crate::summary::{Obstacle, ending};

/// Where the robot sends unless something else is said.
const LISTEN: SocketAddr = SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), 49_938);

impl RunOptions {
    /// Answers an LWR until the motion is over: the exit code.
    pub(super) fn run_lwr(&self, scenario: &Scenario) -> Result<u8, Invalid> {
        let config = self.lwr_config(scenario)?;
        let listen = self.listen.unwrap_or(LISTEN);
        let required = self.required_start(scenario);
        let wait = Duration::from_secs_f64(self.wait);
        let tasks = config.controller.tasks;
        let mut source = self.source(scenario, &config)?;
        let socket = UdpSocket::bind(listen).map_err(|error| {
            let allowed = format!("an address of this PC and a free port ({error})");
            Invalid::new("--listen", listen, allowed)
        })?;
        self.prepare_files()?;
        let mut recorder = match &self.record {
            Some(path) => Some(Recorder::create(path).map_err(|error| unwritable(path, &error))?),
            None => None,
        };
        let stop = stop_flag();
        let realtime = Realtime::ask(self.cpu);
        tell(realtime.line());
        tell(format_args!("waiting for the robot at {listen}"));
        let mut session = Session::new(Lwr::new(), config);
        let mut end = Endpoint {
            socket,
            peer: self.peer,
            wait,
            silence: Duration::from_secs(2),
            stop: &stop,
            tasks,
        };
        let mut flight = Flight::new();
        let mut teller = Teller::new();
        let mut refused = None;
        let counts = converse(
            &mut end,
            &mut session,
            &mut source,
            recorder.as_mut(),
            |session, cycle| {
                flight.push(cycle);
                teller.tell(session, cycle, Obstacle::of(&cycle.robot));
                if let (Some((start, tolerance)), Phase::Ready) = (&required, cycle.phase)
                    && refused.is_none()
                    && (cycle.joints.q - start).amax() > *tolerance
                {
                    refused = Some(cycle.joints.q);
                    stop.store(true, Ordering::Relaxed);
                }
            },
        )
        .map_err(Invalid::line)?;
        if let (Some(q), Some((_, tolerance))) = (refused, &required) {
            return Err(wrong_start(&q, *tolerance, scenario));
        }

        if session.phase() == Phase::Waiting {
            let (at, wait) = (listen, self.wait);
            let until = if stop.load(Ordering::Relaxed) {
                "before it was interrupted".to_string()
            } else {
                format!("within {wait} s")
            };
            tell(format_args!(
                "error: no robot: no measurement came to {at} {until}{}",
                counts.refusals()
            ));
            return Ok(4);
        }
        self.tell_dry(&session)?;
        let names: Vec<_> = scenario.levels.iter().map(|level| level.label()).collect();
        let mut summary = counts.summary(
            &session,
            ending(&session),
            self.scenario(),
            &names,
            &realtime,
        );
        let mut recorded = Ok(0);
        if let (Some(recorder), Some(path)) = (recorder.take(), &self.record) {
            recorded = recorder.finish().map_err(|error| unwritable(path, &error));
        }
        summary.references = source.figures();
        summary.recorder_dropped = *recorded.as_ref().unwrap_or(&0);
        // A record that failed does not take the rest with it.
        self.report(&summary, &flight)?;
        recorded?;
        Ok(summary.exit_code)
    }

    fn lwr_config(&self, scenario: &Scenario) -> Result<SessionConfig, Invalid> {
        let mut config = self.config(scenario)?;
        config.robot_adds = match self.robot_adds.as_deref() {
            None | Some("gravity") => RobotAdds::Gravity,
            Some("gravity-coriolis") => RobotAdds::GravityAndCoriolis,
            Some(other) => {
                let known = ["gravity", "gravity-coriolis"];
                return Err(Invalid::name("--robot-adds", other, &known));
            }
        };
        Ok(config)
    }
}
