//! The LWR by KUKA's Fast Research Interface: the one place where binary32 becomes binary64
//! and back.
//!
//! The robot has a stiffness of its own, estimates no speed, sends its model, and mirrors the
//! counter of the last command it has. What it adds is not sent: stiffness and damping are
//! zero and the position mirrors the measured one, so that its own spring and damper do not
//! act until they are to hold the arm.

mod sent;

use core::fmt::Debug;

use controller_core::fault::IndexSet;
use controller_core::joint::{DOF, JointMatrix, JointVector};
use fri::sequence::{self, Receiver, Sender};
use fri::{
    Command, ControlScheme, Error, Flags, Header, InterfaceState, MeasurementPacket, Quality,
    UserData,
};

use crate::audit::RobotModel;
use crate::protocol::{Arrival, Clock, Incoming, Order, Outgoing, Protocol, Report, Sent};
use sent::SentTorques;

/// Bytes of an answer.
pub const ANSWER_LEN: usize = Command::LEN;

/// Cycles that a robot may have \[s\]; another one in a datagram is not believed.
const PERIODS_S: core::ops::RangeInclusive<f64> = 0.5e-3..=20e-3;

/// Strategy that the robot's program is asked for: joint impedance.
const JOINT_IMPEDANCE_STRATEGY: i32 = 30;

/// Stiffness with which the robot holds the arm at the end and in a dry session
/// \[Nm/rad\], and its damping (1 is critical): what robot programs usually set.
const HOLD_STIFFNESS: f64 = 1000.0;
const HOLD_DAMPING: f32 = 0.7;

/// What the robot says of itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RobotState {
    /// Who commands the arm.
    pub state: InterfaceState,
    /// How good the link is, by its own rating.
    pub quality: Quality,
    /// What it does with a command.
    pub control: ControlScheme,
    /// Whether its drives are on.
    pub drives_on: bool,
}

impl RobotState {
    /// Whether an added torque reaches the joints.
    #[must_use]
    pub fn takes_torque(&self) -> bool {
        self.state == InterfaceState::Command
            && self.control == ControlScheme::JointImpedance
            && self.drives_on
    }
}

impl Report for RobotState {
    fn state(&self) -> impl Debug {
        self.state
    }

    fn quality(&self) -> impl Debug {
        self.quality
    }
}

/// Our end of the conversation.
#[derive(Clone, Debug)]
pub struct Lwr {
    sender: Sender,
    sent: SentTorques,
}

impl Lwr {
    /// Nothing sent yet.
    #[must_use]
    pub fn new() -> Self {
        Self {
            sender: Sender::starting_at(1),
            sent: SentTorques::new(),
        }
    }
}

impl Default for Lwr {
    fn default() -> Self {
        Self::new()
    }
}

impl Protocol for Lwr {
    type Robot = RobotState;
    type Error = Error;
    type Packet<'a> = MeasurementPacket<&'a [u8]>;
    type Answer = [u8; ANSWER_LEN];
    type Clock = Receiver;

    const EMPTY: [u8; ANSWER_LEN] = [0; ANSWER_LEN];
    const OWN_STIFFNESS: bool = true;
    const LOST_MAX: Option<u16> = None;

    fn read<'a>(&self, datagram: &'a [u8]) -> Result<Incoming<'a, Self>, Error> {
        let packet = MeasurementPacket::new_checked(datagram)?;
        let Header { counter, reflected } = packet.header();
        let robot = RobotState {
            state: packet.state(),
            quality: packet.quality(),
            control: packet.control(),
            drives_on: packet.power() != 0,
        };
        Ok(Incoming {
            counter: counter.into(),
            // 0 is what a robot mirrors that has no command, or mirrors none.
            mirrored: (reflected != 0).then_some(reflected.into()),
            robot,
            takes_torque: robot.takes_torque(),
            q: wide(packet.joint_position()),
            dq: None,
            // 2 ms is not a binary32 number: the nearest microsecond is meant.
            period_s: Some(nearest_microsecond(packet.period_s()))
                .filter(|period| PERIODS_S.contains(period)),
            packet,
        })
    }

    fn model(&self, incoming: &Incoming<'_, Self>) -> RobotModel {
        let packet = &incoming.packet;
        let [x, y, z, rz, ry, rx] = packet.jacobian().map(wide);
        let rows = packet.mass_matrix().map(|row| wide(row).transpose());
        RobotModel {
            q: incoming.q,
            mass_matrix: Some(JointMatrix::from_rows(&rows)),
            gravity: Some(wide(packet.gravity())),
            jacobian: Some([x, y, z, rx, ry, rz]),
            end_effector: None,
            holding: None,
        }
    }

    fn acted(&mut self, incoming: &Incoming<'_, Self>, dead_cycles: u8) -> JointVector<f64> {
        let reflected = incoming.packet.header().reflected;
        self.sent.acted(reflected, dead_cycles)
    }

    fn answer(
        &mut self,
        incoming: &Incoming<'_, Self>,
        outgoing: &Outgoing,
        answer: &mut [u8; ANSWER_LEN],
    ) -> Option<Sent> {
        let counter = self.sender.advance();
        let fields = Fields::of(&incoming.packet, &outgoing.order);
        let header = Header {
            counter,
            reflected: incoming.packet.header().counter,
        };
        let command = Command {
            header,
            user: user_data(outgoing),
            flags: Flags::JOINT_IMPEDANCE,
            joint_position: fields.position,
            joint_torque: fields.torque,
            joint_stiffness: [fields.stiffness; DOF],
            joint_damping: [fields.damping; DOF],
            ..Command::default()
        };
        command.emit(answer);
        let torque = wide(fields.torque);
        self.sent.send(counter, torque);
        Some(Sent {
            torque,
            limited: IndexSet::NONE,
        })
    }
}

/// What an answer carries.
struct Fields {
    position: [f32; DOF],
    torque: [f32; DOF],
    stiffness: f32,
    damping: f32,
}

impl Fields {
    fn of(packet: &MeasurementPacket<&[u8]>, order: &Order) -> Self {
        match order {
            Order::Nothing => Self::mirror(packet),
            // The robot keeps its own stiffness.
            Order::LookOn => Self {
                stiffness: HOLD_STIFFNESS as f32,
                damping: HOLD_DAMPING,
                ..Self::mirror(packet)
            },
            Order::Torque {
                torque,
                hold,
                share,
            } => Self {
                position: match hold {
                    Some(hold) => narrow(hold),
                    None => packet.joint_position(),
                },
                torque: narrow(torque),
                stiffness: (HOLD_STIFFNESS * share) as f32,
                damping: if *share > 0.0 { HOLD_DAMPING } else { 0.0 },
            },
        }
    }

    /// The position that the robot commands itself.
    fn mirror(packet: &MeasurementPacket<&[u8]>) -> Self {
        let mut position = packet.commanded_position();
        for (position, offset) in position.iter_mut().zip(packet.fri_offset()) {
            *position += offset;
        }
        Self {
            position,
            torque: [0.0; DOF],
            stiffness: 0.0,
            damping: 0.0,
        }
    }
}

/// For the robot's program, and for whoever looks on.
fn user_data(outgoing: &Outgoing) -> UserData {
    let mut user = UserData::default();
    let [strategy, wish, mode, ..] = &mut user.int;
    *strategy = JOINT_IMPEDANCE_STRATEGY;
    *wish = i32::from(outgoing.wish);
    if let Some(step) = &outgoing.step {
        // 0 is for no controller.
        *mode = 1 + i32::from(step.status.mode.number());
        let residual = narrow(&step.residual);
        for (real, residual) in user.real.iter_mut().zip(residual) {
            *real = residual;
        }
    }
    user
}

impl Clock for Receiver {
    fn receive(&mut self, counter: u64) -> Arrival {
        // It was widened from 16 bits.
        match Receiver::receive(self, counter as u16) {
            sequence::Arrival::First => Arrival::First,
            sequence::Arrival::Next { lost } => Arrival::Next { lost: lost.into() },
            sequence::Arrival::Repeated => Arrival::Repeated,
            sequence::Arrival::Old => Arrival::Old,
        }
    }

    fn reset(&mut self) {
        Receiver::reset(self);
    }
}

fn nearest_microsecond(period_s: f32) -> f64 {
    use controller_core::real::Real;
    let period = f64::from(period_s);
    // Of anything that is no period the limits take care.
    (period.limited(0.0, 1.0) * 1e6 + 0.5).floor_small() / 1e6
}

fn wide(values: [f32; DOF]) -> JointVector<f64> {
    JointVector::from(values.map(f64::from))
}

fn narrow(values: &JointVector<f64>) -> [f32; DOF] {
    let values: [f64; DOF] = (*values).into();
    values.map(|value| value as f32)
}
