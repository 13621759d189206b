//! A client of Franka's FCI in this process: the machine of its stream and the session beside it.

use std::io;

use bridge::fci::Fci;
use bridge::session::{Phase as SessionPhase, Session, SessionConfig};
use fci::StatePacket;
use fci::client::{Client, Duty, Facts, Phase, Start};

use super::{BridgeClient, Local};
use crate::link::{Expect, Peer};
use crate::robot::{FciBox, FciRobot};
use cell::scenario::{Scenario, TimedTransition};

/// Where it says that it takes states: any port will do, as no socket is there.
const PORT: u16 = 1;

/// What `firmware-host run --robot fci` is over sockets.
#[derive(Debug)]
pub struct FciClient {
    machine: Client,
    /// What every connection begins with.
    config: SessionConfig,
    bridge: BridgeClient<Fci>,
    start: Start,
    connected: bool,
}

impl FciClient {
    /// A client that follows the motion of `scenario`, with the thresholds of a compliant arm and no
    /// load: the simulated robot knows the tool of its scenario. `recover`: it asks once for
    /// AutomaticErrorRecovery.
    #[must_use]
    pub fn new(config: SessionConfig, scenario: &Scenario, recover: bool) -> Self {
        let machine = Client::new(recover);
        let protocol = Fci::new(machine.version());
        Self {
            bridge: BridgeClient::new(protocol, config.clone(), scenario),
            machine,
            config,
            start: Start::COMPLIANT,
            connected: false,
        }
    }

    /// With changes of tasks and gains on the way.
    #[must_use]
    pub fn changing(self, changes: Vec<TimedTransition>) -> Self {
        Self {
            bridge: self.bridge.changing(changes),
            ..self
        }
    }

    /// Its end of the stream.
    #[must_use]
    pub fn machine(&self) -> &Client {
        &self.machine
    }

    /// Opens and closes the connection, as the machine wants it.
    fn connect(&mut self, robot: &mut FciRobot) {
        let over = self.machine.stopped().is_some();
        if self.connected && (over || self.machine.wants_new_connection()) {
            robot.disconnect(None);
            self.connected = false;
        }
        if !self.connected && !over {
            self.connected = true;
            self.machine.connected(PORT);
            let protocol = Fci::new(self.machine.version());
            self.bridge.session = Session::new(protocol, self.config.clone());
        }
    }

    /// Passes the bytes of the stream on, both ways: whether there were any.
    fn pass_on(&mut self, robot: &mut FciRobot) -> io::Result<bool> {
        let requests = self.machine.transmit();
        let mut rest = requests;
        let heard = robot.hear_requests(&mut rest);
        let taken = requests.len() - rest.len();
        self.machine.transmitted(taken);
        let mut room = [0; 4096];
        let count = robot.control().replies(&mut room);
        // Its model is the table of the scenario: nobody has to look at it.
        self.machine
            .receive(room.get(..count).unwrap_or_default(), &mut ());
        heard.map_err(|broken| io::Error::other(broken.to_string()))?;
        Ok(taken + count > 0)
    }

    /// A state: the command to it, if there is one.
    fn state(&mut self, datagram: &[u8]) -> Option<Vec<u8>> {
        let packet = StatePacket::new_checked(self.machine.version(), datagram).ok()?;
        let duty = self.machine.state(&Facts::of(&packet));
        self.bridge.session.protocol_mut().attend(duty);
        let command = self.bridge.answer(datagram);
        command.filter(|_| duty != Duty::Listen)
    }
}

impl Peer<FciBox> for FciClient {
    fn exchange(
        &mut self,
        robot: &mut FciRobot,
        state: &[u8],
        _: Expect,
        commands: &mut Vec<Vec<u8>>,
    ) -> io::Result<bool> {
        if robot.control().client().is_some() {
            commands.extend(self.state(state));
        }
        if self.machine.phase() == Phase::Ready {
            self.machine.start(&self.start);
        }
        if self.bridge.session.phase() == SessionPhase::Finished {
            self.machine.finish();
        }
        // What it doubts it leaves without command: it is not gone.
        Ok(true)
    }

    fn talk(&mut self, robot: &mut FciRobot) -> io::Result<()> {
        self.connect(robot);
        while self.connected && self.pass_on(robot)? {}
        Ok(())
    }

    fn tell(&self, robot: &mut FciRobot) {
        self.bridge.tell(robot);
    }

    fn has_left(&self) -> bool {
        !self.connected && self.machine.stopped().is_some()
    }
}

impl Local<FciBox> for FciClient {
    type Protocol = Fci;

    fn session(&self) -> &Session<Fci> {
        &self.bridge.session
    }

    fn why_left(&self) -> Option<String> {
        let stop = self.machine.stopped()?;
        Some(format!("the robot: {stop}"))
    }
}
