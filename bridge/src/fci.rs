//! Franka's arms (Panda, FR3) by the Franka Control Interface: its real-time part, states and
//! commands. Connecting, Move and its end are affairs of the connection beside it.
//!
//! The robot reports speed and the torque that acted, adds gravity and leaves C dq to us,
//! refuses steps of torque, and has no stiffness to give back: at the end the arm is held
//! until the robot has taken over. Outside a motion it gets no answer.

use core::fmt::Debug;

use controller_core::arm::Pose;
use controller_core::cycle::delay::Delay;
use controller_core::fault::IndexSet;
use controller_core::joint::{JointVector, zeros};
use controller_core::ranges::RESTING_SPEED;
use controller_core::real::Real;
use fci::client::Duty;
use fci::state::{Field, field};
use fci::{
    Command, Error, RobotErrors, RobotMode, Sequence, StatePacket, Version, command, sequence,
};
use heapless::HistoryBuf;

use crate::audit::{EndEffector, RobotModel};
use crate::protocol::{Arrival, Clock, Incoming, Order, Outgoing, Protocol, Report, Sent};

/// A cycle \[s\].
const CYCLE_S: f64 = 1e-3;

/// Largest change of a joint's torque from one command to the next \[Nm\]. The robot bears
/// 1 Nm; what a state says of the last command is rounded to 4e-6 Nm in version 10.
const STEP_MAX_NM: f64 = 0.999;

/// Torques that differ by less are one: rounding in a state of version 10 \[Nm\].
const SAME_NM: f64 = 1e-5;

/// More than any joint gives: the robot cuts at 87 Nm \[Nm\].
const REPORTED_MAX_NM: f64 = 100.0;

/// Commands remembered: more than may be lost in a row before the robot ends the motion.
const MEMORY: usize = 32;

/// Reals of a state that are used.
const USED: [Field; 7] = [
    field::Q,
    field::DQ,
    field::TAU_J_D,
    field::TAU_J,
    field::O_T_EE,
    field::F_T_EE,
    field::CONTROL_COMMAND_SUCCESS_RATE,
];

/// What the robot says of itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RobotState {
    /// What it is doing.
    pub mode: RobotMode,
    /// Errors now.
    pub errors: RobotErrors,
    /// Share of the last 100 commands that came in time, 0 to 1; 0 without a motion.
    pub success_rate: f64,
}

impl Report for RobotState {
    fn state(&self) -> impl Debug {
        self.mode
    }

    fn quality(&self) -> impl Debug {
        self.success_rate
    }
}

/// Our end of the real-time conversation.
#[derive(Clone, Debug)]
pub struct Fci {
    version: Version,
    duty: Duty,
    /// Torque \[Nm\] of the last commands, by the state that they answer.
    sent: HistoryBuf<(u64, JointVector<f64>), MEMORY>,
    /// From where the next step counts: what the robot used until the last state \[Nm\].
    used: JointVector<f64>,
    way: Delay<f64>,
    limited_cycles: u64,
}

impl Fci {
    /// On a connection of `version`.
    #[must_use]
    pub fn new(version: Version) -> Self {
        Self {
            version,
            duty: Duty::Listen,
            sent: HistoryBuf::new(),
            used: zeros(),
            way: Delay::new(),
            limited_cycles: 0,
        }
    }

    /// What is due to the next state: before each [`Session::receive`](crate::session::Session::receive).
    pub fn attend(&mut self, duty: Duty) {
        if duty == Duty::Listen {
            self.sent.clear();
        }
        self.duty = duty;
    }

    /// Commands whose torque was limited to the step that the robot bears.
    #[must_use]
    pub fn limited_cycles(&self) -> u64 {
        self.limited_cycles
    }

    /// The newest command that carried this torque, but for rounding.
    fn sent_as(&self, reported: &JointVector<f64>) -> Option<&(u64, JointVector<f64>)> {
        let same = |(_, torque): &&(u64, JointVector<f64>)| (torque - reported).amax() <= SAME_NM;
        self.sent.oldest_ordered().rfind(same)
    }

    /// `wanted` \[Nm\] within a step of the torque that the robot used last.
    fn stepped(&mut self, wanted: &JointVector<f64>) -> Sent {
        let change = wanted - self.used;
        let too_far = |set: u8, change: &f64| {
            // The first joint is the lowest bit.
            set >> 1 | u8::from(change.magnitude() > STEP_MAX_NM) << 6
        };
        let limited = IndexSet(change.iter().fold(0, too_far));
        self.limited_cycles += u64::from(limited.any());
        let torque = if !limited.any() {
            *wanted
        } else {
            self.used + change.map(|change| change.limited(-STEP_MAX_NM, STEP_MAX_NM))
        };
        Sent { torque, limited }
    }
}

impl Protocol for Fci {
    type Robot = RobotState;
    type Error = Error;
    type Packet<'a> = StatePacket<&'a [u8]>;
    type Answer = Answer;
    type Clock = Sequence;

    const EMPTY: Answer = Answer::EMPTY;
    const OWN_STIFFNESS: bool = false;
    const LOST_MAX: Option<u16> = Some(20);

    fn read<'a>(&self, datagram: &'a [u8]) -> Result<Incoming<'a, Self>, Error> {
        let packet = StatePacket::new_checked(self.version, datagram)?;
        packet.check_finite(&USED)?;
        let mirrored = self.sent_as(&packet.tau_j_d().into());
        Ok(Incoming {
            counter: packet.message_id(),
            mirrored: mirrored.map(|(id, _)| *id),
            robot: RobotState {
                mode: packet.robot_mode(),
                errors: packet.errors(),
                success_rate: packet.control_command_success_rate(),
            },
            takes_torque: self.duty != Duty::Listen,
            q: packet.q().into(),
            dq: Some(packet.dq().into()),
            period_s: Some(CYCLE_S),
            packet,
        })
    }

    fn model(&self, incoming: &Incoming<'_, Self>) -> RobotModel {
        let packet = &incoming.packet;
        let resting = packet.dq().iter().all(|dq| dq.magnitude() < RESTING_SPEED);
        RobotModel {
            q: incoming.q,
            mass_matrix: None,
            gravity: None,
            jacobian: None,
            end_effector: Some(EndEffector {
                base: pose(&packet.o_t_ee()),
                flange: pose(&packet.f_t_ee()),
            }),
            holding: resting.then(|| packet.tau_j().into()),
        }
    }

    fn acted(&mut self, incoming: &Incoming<'_, Self>, dead_cycles: u8) -> JointVector<f64> {
        let reported = JointVector::from(incoming.packet.tau_j_d());
        let can_be = reported.amax() <= REPORTED_MAX_NM;
        let newest = self.sent.recent().map(|(_, own)| *own);
        let own = self.sent_as(&reported).map(|(_, own)| *own);
        // A torque that is none of ours has been cut by the robot, or damaged on its way.
        // A motion begins without torque, whatever a damaged state says.
        self.used = own.or(newest).unwrap_or_else(zeros);
        let acted = match own {
            None if can_be => reported,
            _ => self.used,
        };
        self.way.send(dead_cycles, &acted, &zeros())
    }

    fn answer(
        &mut self,
        incoming: &Incoming<'_, Self>,
        outgoing: &Outgoing,
        answer: &mut Answer,
    ) -> Option<Sent> {
        if self.duty == Duty::Listen {
            return None;
        }
        let wanted = match outgoing.order {
            Order::Torque { torque, .. } => torque,
            // The robot waits for a torque all the same.
            Order::Nothing | Order::LookOn => zeros(),
        };
        let sent = self.stepped(&wanted);
        let finished = self.duty == Duty::Finish;
        let command = Command::torque(self.version, incoming.counter, sent.torque.into(), finished);
        answer.length = command.emit(self.version, &mut answer.bytes).len();
        self.sent.write((incoming.counter, sent.torque));
        Some(sent)
    }
}

/// Room for a command of any version.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Answer {
    bytes: [u8; command::LEN_MAX],
    length: usize,
}

impl Answer {
    /// No bytes.
    pub const EMPTY: Self = Self {
        bytes: [0; command::LEN_MAX],
        length: 0,
    };
}

impl AsRef<[u8]> for Answer {
    fn as_ref(&self) -> &[u8] {
        self.bytes.get(..self.length).unwrap_or(&[])
    }
}

impl Clock for Sequence {
    fn receive(&mut self, counter: u64) -> Arrival {
        let repeated = self.newest() == Some(counter);
        match Sequence::receive(self, counter) {
            sequence::Arrival::First => Arrival::First,
            sequence::Arrival::Next { lost } => Arrival::Next { lost },
            sequence::Arrival::Old if repeated => Arrival::Repeated,
            sequence::Arrival::Old => Arrival::Old,
        }
    }

    fn reset(&mut self) {
        *self = Self::new();
    }
}

/// A pose of the wire, which comes column by column.
fn pose(columns: &fci::Pose) -> Pose {
    let [
        [xx, xy, xz, _],
        [yx, yy, yz, _],
        [zx, zy, zz, _],
        [x, y, z, _],
    ] = [0, 4, 8, 12]
        .map(|at| core::array::from_fn(|i| columns.get(at + i).copied().unwrap_or(0.0)));
    Pose {
        rotation: [[xx, yx, zx], [xy, yy, zy], [xz, yz, zz]],
        shift: [x, y, z],
    }
}
