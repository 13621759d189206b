//! Between the session and the datagrams: the one place where binary32 becomes
//! binary64 and back.

use controller_core::Step;
use controller_core::joint::{DOF, JointMatrix, JointVector};
use fri::{
    Command, ControlScheme, Error, Flags, Header, InterfaceState, MeasurementPacket, Quality,
    UserData,
};

use crate::audit::RobotModel;

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

/// A measurement as the session needs it.
pub(crate) struct Incoming<'a> {
    packet: MeasurementPacket<&'a [u8]>,
    pub counter: u16,
    pub reflected: u16,
    pub robot: RobotState,
    /// Measured joint angles \[rad\].
    pub q: JointVector<f64>,
    /// The robot's cycle \[s\], if it states one that can be.
    pub period_s: Option<f64>,
}

impl<'a> Incoming<'a> {
    pub fn read(datagram: &'a [u8]) -> Result<Self, Error> {
        let packet = MeasurementPacket::new_checked(datagram)?;
        let Header { counter, reflected } = packet.header();
        Ok(Self {
            counter,
            reflected,
            robot: RobotState {
                state: packet.state(),
                quality: packet.quality(),
                control: packet.control(),
                drives_on: packet.power() != 0,
            },
            q: wide(packet.joint_position()),
            // 2 ms is not a binary32 number: the nearest microsecond is meant.
            period_s: Some(nearest_microsecond(packet.period_s()))
                .filter(|period| PERIODS_S.contains(period)),
            packet,
        })
    }

    /// The robot's model in this posture.
    pub fn model(&self) -> RobotModel {
        let [x, y, z, rz, ry, rx] = self.packet.jacobian().map(wide);
        let mass = self.packet.mass_matrix();
        let rows = mass.map(|row| wide(row).transpose());
        RobotModel {
            q: self.q,
            mass_matrix: JointMatrix::from_rows(&rows),
            gravity: wide(self.packet.gravity()),
            jacobian: [x, y, z, rx, ry, rz],
        }
    }
}

/// An answer, before it is bytes.
pub(crate) struct Outgoing {
    /// The controller's cycle behind it.
    pub step: Option<Step<f64>>,
    position: [f32; DOF],
    torque: [f32; DOF],
    stiffness: f32,
    damping: f32,
}

impl Outgoing {
    /// Outside command state: the position that the robot commands itself.
    pub fn mirror(incoming: &Incoming<'_>) -> Self {
        let own = incoming.packet.commanded_position();
        let offset = incoming.packet.fri_offset();
        let mut position = own;
        for (position, offset) in position.iter_mut().zip(offset) {
            *position += offset;
        }
        Self {
            step: None,
            position,
            torque: [0.0; DOF],
            stiffness: 0.0,
            damping: 0.0,
        }
    }

    /// Nothing is to move, `step` is what would have been. The robot keeps its own
    /// stiffness: a robot program that enters command state unasked must not find
    /// a limp arm.
    pub fn look_on(incoming: &Incoming<'_>, step: Step<f64>) -> Self {
        Self {
            step: Some(step),
            stiffness: HOLD_STIFFNESS as f32,
            damping: HOLD_DAMPING,
            ..Self::mirror(incoming)
        }
    }

    /// In command state: `torque` \[Nm\], and a share of the robot's own stiffness
    /// at `hold` \[rad\]; without one the position mirrors the measured one.
    pub fn command(
        incoming: &Incoming<'_>,
        step: Step<f64>,
        torque: &JointVector<f64>,
        hold: Option<&[f32; DOF]>,
        stiffness_share: f64,
    ) -> Self {
        Self {
            step: Some(step),
            position: *hold.unwrap_or(&incoming.packet.joint_position()),
            torque: narrow(torque),
            stiffness: (HOLD_STIFFNESS * stiffness_share) as f32,
            damping: if stiffness_share > 0.0 {
                HOLD_DAMPING
            } else {
                0.0
            },
        }
    }

    /// The torque as the robot will read it \[Nm\].
    pub fn torque(&self) -> JointVector<f64> {
        wide(self.torque)
    }

    pub fn write(
        &self,
        answer: &mut [u8; ANSWER_LEN],
        counter: u16,
        incoming: &Incoming<'_>,
        start_wish: bool,
    ) {
        let mut user = UserData::default();
        let [strategy, wish, mode, ..] = &mut user.int;
        *strategy = JOINT_IMPEDANCE_STRATEGY;
        *wish = i32::from(start_wish);
        if let Some(step) = &self.step {
            // 0 is for no controller.
            *mode = 1 + i32::from(step.status.mode.number());
            let residual = narrow(&step.residual);
            for (real, residual) in user.real.iter_mut().zip(residual) {
                *real = residual;
            }
        }
        let command = Command {
            header: Header {
                counter,
                reflected: incoming.counter,
            },
            user,
            flags: Flags::JOINT_IMPEDANCE,
            joint_position: self.position,
            joint_torque: self.torque,
            joint_stiffness: [self.stiffness; DOF],
            joint_damping: [self.damping; DOF],
            ..Command::default()
        };
        command.emit(answer);
    }
}

/// Measured positions as the robot sent them.
pub(crate) fn measured(incoming: &Incoming<'_>) -> [f32; DOF] {
    incoming.packet.joint_position()
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
