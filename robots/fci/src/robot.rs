//! The robot's end of the interface as a state machine: no socket, no clock, no arm.
//!
//! In come the bytes of the stream, commands, and in every cycle of 1 ms what the arm does and what
//! the person at the robot does; out come the bytes of replies, a state, and what the arm is to do:
//!
//! ```text
//! loop {
//!     robot.receive(&mut bytes)?;      // requests, one by one
//!     robot.replies(&mut room);        // and their replies, before the state
//!     robot.state(&arm, &operator);    // state k
//!     // ... commands, as they come
//!     robot.command(&datagram);        // the one to state k acts until state k + 1
//!     robot.advance();                 // what the arm does until then
//! }
//! ```
//!
//! States go to the port of [`Robot::client`] while a client is connected; commands are taken from
//! where they go to. A connection that [`Robot::receive`] calls broken is closed, and
//! [`Robot::disconnect`] told. Only one client is served at a time.
//!
//! # A motion
//!
//! It begins when Move is accepted; states show it from the moment that the reply *motion started*
//! is out. Until the first command the torque is 0 and nothing counts as lost: clients read some
//! states first. From then on a cycle without its command uses the last one again, and the 20th
//! in a row is a reflex. It ends by a command that says so (*success*), StopMove (*preempted*), a
//! reflex (*aborted by a reflex*), the person at the robot (*aborted by the emergency stop*) or the
//! end of the connection. Behind a reflex, and behind a motion that a stop has ended, only
//! AutomaticErrorRecovery leads back to idle.
//!
//! # What is watched, and by which error it is told
//!
//! | what | error |
//! |---|---|
//! | torque of a joint goes further than 1 Nm in a cycle | `controller_torque_discontinuity` |
//! | 20 commands in a row are missing | `communication_constraints_violation` |
//! | a joint beyond its range | `joint_position_limits_violation` |
//! | a joint too fast, or too fast so near the end of its range | `joint_velocity_violation` |
//! | end effector too fast | `cartesian_velocity_violation` |
//! | torque beyond the range of its sensor | `tau_J_range_violation` |
//! | external torque of a joint above its upper threshold | `joint_reflex` |
//! | external force above its upper threshold | `cartesian_reflex` |
//!
//! Not watched: self collision, power, virtual walls, instability, and whatever concerns motion
//! generators. Thresholds are the nominal ones, as the client's torque has no phase of
//! acceleration; forces are compared in the axes of the base.
//!
//! # What the vendor does not say
//!
//! How its robot does these is not documented; here: setters and another Move are *not possible* in
//! a motion; a pressed stop for users is left by a recovery if it has ended a motion; recovery with a
//! joint beyond its range asks for a hand; a request that nothing means closes the connection; a
//! command with a number that is none is dropped.

mod arm;
mod motion;
mod outcome;
mod pose;
mod replies;
mod requests;
mod settings;

pub use arm::Arm;
pub use outcome::{Broken, Counters, Drive, Ended, Handled, Operator, Received, Refused};
pub use pose::IDENTITY;
pub use settings::{
    Approach, EndEffector, LOST_MAX, Limits, Motions, Settings, TORQUE_STEP_MAX, WALLS,
};

use crate::command::Command;
use crate::modes::{ControllerMode, MotionGeneratorMode, RobotMode};
use crate::request::{CollisionBehavior, Connect, Load};
use crate::robot_error::{RobotError, RobotErrors};
use crate::state::{DOF, State};
use crate::status::{MoveStatus, RecoveryStatus};
use crate::stream::{REQUEST_LEN_MAX, Stream};
use crate::version::Version;
use motion::Motion;
use replies::{Due, Replies};

/// A difference of torques may be rounded by so much \[Nm\].
const ROUNDING: f64 = 1e-9;

/// The connection.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Client {
    /// Connect has not come.
    Silent,
    /// It had another version.
    Refused,
    Connected(Connect),
}

/// A recovery under way.
#[derive(Clone, Copy, Debug)]
struct Recovery {
    /// Of the request, while its client is there.
    id: Option<u32>,
    /// Cycles that it still takes.
    left: u32,
}

/// The robot's end. `M` is the text of its model, a URDF; empty: it has none.
#[derive(Clone, Debug)]
pub struct Robot<M> {
    settings: Settings,
    model: M,
    stream: Stream<[u8; REQUEST_LEN_MAX]>,
    replies: Replies,
    client: Client,
    broken: Option<Broken>,
    operator: Operator,
    motion: Option<Motion>,
    recovery: Option<Recovery>,
    /// The mode that only a recovery leads out of.
    aborted: Option<RobotMode>,
    collision: CollisionBehavior,
    /// The last state, and what clients have set of it.
    state: State,
    /// The arm is to stay where it is from the next state on.
    settles: bool,
    ended: Option<Ended>,
    counters: Counters,
}

impl<M: AsRef<[u8]>> Robot<M> {
    /// A robot that nobody has connected to.
    #[must_use]
    pub fn new(settings: Settings, model: M) -> Self {
        let Settings {
            end_effector, load, ..
        } = &settings;
        let state = State {
            message_id: settings.message_id,
            f_t_ne: end_effector.f_t_ne,
            m_ee: end_effector.m_ee,
            f_x_cee: end_effector.f_x_cee,
            i_ee: end_effector.i_ee,
            ne_t_ee: settings.ne_t_ee,
            ee_t_k: settings.ee_t_k,
            m_load: load.m_load,
            f_x_cload: load.f_x_cload,
            i_load: load.i_load,
            o_ddp_o: [0.0, 0.0, -9.81],
            ..State::default()
        };
        Self {
            model,
            stream: Stream::with_room(REQUEST_LEN_MAX),
            replies: Replies::new(),
            client: Client::Silent,
            broken: None,
            operator: Operator::ABSENT,
            motion: None,
            recovery: None,
            aborted: None,
            collision: settings.collision,
            state,
            settles: true,
            ended: None,
            counters: Counters::default(),
            settings,
        }
    }

    /// Its version.
    #[must_use]
    pub fn version(&self) -> Version {
        self.settings.version
    }

    /// The Connect of a client of the same version: states go to its port.
    #[must_use]
    pub fn client(&self) -> Option<Connect> {
        match self.client {
            Client::Connected(connect) => Some(connect),
            Client::Silent | Client::Refused => None,
        }
    }

    /// What it is doing.
    #[must_use]
    pub fn mode(&self) -> RobotMode {
        if self.recovery.is_some() {
            RobotMode::AutomaticErrorRecovery
        } else if !self.operator.ready {
            RobotMode::Other
        } else if self.operator.stops() {
            RobotMode::UserStopped
        } else if let Some(mode) = self.aborted {
            mode
        } else if self.shown().is_some() {
            RobotMode::Move
        } else if self.operator.guiding && self.motion.is_none() {
            RobotMode::Guiding
        } else {
            RobotMode::Idle
        }
    }

    /// The load that its gravity is of, besides the end effector.
    #[must_use]
    pub fn load(&self) -> Load {
        let State {
            m_load,
            f_x_cload,
            i_load,
            ..
        } = self.state;
        Load {
            m_load,
            f_x_cload,
            i_load,
        }
    }

    /// What came, and what did not.
    #[must_use]
    pub fn counters(&self) -> &Counters {
        &self.counters
    }

    /// A motion that has ended since the last call; of several the last one.
    pub fn ended(&mut self) -> Option<Ended> {
        self.ended.take()
    }

    /// Whether the command to the last state is still to come: a robot that waits for its client
    /// waits now. Before the first command of a motion it is not.
    #[must_use]
    pub fn waits(&self) -> bool {
        self.shown().is_some_and(Motion::waits)
    }

    /// Whether a motion is under way whose first command has come.
    #[must_use]
    pub fn is_driven(&self) -> bool {
        self.shown().is_some_and(|motion| motion.armed)
    }

    /// The motion that states show.
    fn shown(&self) -> Option<&Motion> {
        self.motion.as_ref().filter(|motion| motion.shown)
    }

    /// The next bytes of replies: how many are written; 0 when nothing is due.
    pub fn replies(&mut self, room: &mut [u8]) -> usize {
        let model = self.model.as_ref();
        let Settings { version, walls, .. } = &self.settings;
        self.replies.take(*version, walls, model, room)
    }

    /// The connection is closed: the arm is stopped, what is due is void.
    pub fn disconnect(&mut self) {
        self.end(MoveStatus::Aborted, RobotErrors::NONE);
        self.stream.reset();
        self.replies.clear();
        self.client = Client::Silent;
        self.broken = None;
        if let Some(recovery) = &mut self.recovery {
            recovery.id = None;
        }
    }

    /// The next state. What the arm or the person at the robot does may end a motion.
    pub fn state(&mut self, arm: &Arm, operator: &Operator) -> &State {
        self.state.message_id = self.state.message_id.wrapping_add(1);
        self.attend(operator);
        if let Some(motion) = &mut self.motion
            && !motion.shown
            && !self.replies.waits(motion.id)
        {
            motion.shown = true;
            self.settles = true;
        }
        let watched = self.shown().is_some();
        self.state.f_t_ee = pose::product(&self.state.f_t_ne, &self.state.ne_t_ee);
        let gain = self.settings.external_gain;
        let twist = arm::report(&mut self.state, arm, &self.collision, gain, watched);
        if watched {
            let errors = self.settings.limits.violated(arm, &self.state, &twist);
            if !errors.is_empty() {
                self.abort(errors);
            }
        }
        if core::mem::take(&mut self.settles) {
            arm::stay(&mut self.state);
        }
        self.show();
        &self.state
    }

    /// What the person at the robot does, and how far a recovery is.
    fn attend(&mut self, operator: &Operator) {
        self.operator = *operator;
        let trouble = if operator.stops() {
            Some((
                MoveStatus::EmergencyAborted,
                RecoveryStatus::EmergencyAborted,
            ))
        } else if !operator.ready {
            Some((MoveStatus::Aborted, RecoveryStatus::Aborted))
        } else {
            None
        };
        if let Some((status, _)) = trouble
            && self.motion.is_some()
        {
            if operator.stops() {
                self.aborted = Some(RobotMode::UserStopped);
            }
            self.end(status, RobotErrors::NONE);
        }
        let Some(mut recovery) = self.recovery.take() else {
            return;
        };
        let status = match trouble {
            Some((_, status)) => status,
            None if recovery.left > 0 => {
                recovery.left -= 1;
                self.recovery = Some(recovery);
                return;
            }
            None => {
                self.recovered();
                RecoveryStatus::Success
            }
        };
        if let Some(id) = recovery.id {
            self.replies.push(id, Due::Recovery(status));
        }
    }

    /// Idle again.
    fn recovered(&mut self) {
        self.aborted = None;
        self.state.errors = RobotErrors::NONE;
        self.state.joint_collision = [0.0; DOF];
        self.state.cartesian_collision = [0.0; 6];
    }

    /// Modes, success rate and what is commanded.
    fn show(&mut self) {
        let mode = self.mode();
        let motion = self.motion.as_ref().filter(|motion| motion.shown);
        let state = &mut self.state;
        state.robot_mode = mode;
        let Some(motion) = motion else {
            state.motion_generator_mode = MotionGeneratorMode::Idle;
            state.controller_mode = ControllerMode::Other;
            state.control_command_success_rate = 0.0;
            return;
        };
        state.motion_generator_mode = motion.generator.into();
        state.controller_mode = motion.controller.into();
        state.control_command_success_rate = motion.success_rate();
        if motion.armed {
            motion.desire(state);
        }
    }

    /// A datagram of the client.
    pub fn command(&mut self, datagram: &[u8]) -> Received {
        let command = Command::parse(self.settings.version, datagram);
        let command = match command.and_then(|command| command.check().map(|()| command)) {
            Ok(command) => command,
            Err(error) => {
                self.counters.unreadable += 1;
                return Received::Unreadable(error);
            }
        };
        let Some(motion) = self.motion.as_mut().filter(|motion| motion.shown) else {
            self.counters.idle += 1;
            return Received::NoMotion;
        };
        if command.message_id != self.state.message_id {
            self.counters.late += 1;
            return Received::Late;
        }
        if motion.answered {
            self.counters.repeated += 1;
            return Received::Repeated;
        }
        let mut command = command;
        if motion.is_torque() {
            let limits = &self.settings.limits.torque;
            for (torque, &limit) in command.tau_j_d.iter_mut().zip(limits) {
                *torque = torque.max(-limit).min(limit);
            }
            let steps = command.tau_j_d.iter().zip(motion.torque());
            let step = steps.fold(0.0_f64, |most, (now, last)| most.max((now - last).abs()));
            let largest = &mut self.counters.largest_torque_step_nm;
            *largest = largest.max(step);
            if step > TORQUE_STEP_MAX + ROUNDING {
                let error = RobotError::ControllerTorqueDiscontinuity;
                self.abort(RobotErrors::NONE.with(error));
                return Received::Reflex(error);
            }
        }
        self.counters.commands += 1;
        motion.answer(&command);
        if command.is_last() {
            self.end(MoveStatus::Success, RobotErrors::NONE);
            return Received::Last;
        }
        Received::Accepted
    }

    /// Ends the cycle: what the arm does until the next state.
    pub fn advance(&mut self) -> Drive {
        if let Some(motion) = self.motion.as_mut().filter(|motion| motion.shown) {
            self.counters.lost += u64::from(motion.waits());
            if motion.end_cycle() {
                let error = RobotError::CommunicationConstraintsViolation;
                self.abort(RobotErrors::NONE.with(error));
            }
        }
        let drive = match self.shown() {
            Some(motion) if motion.is_torque() => Drive::Torque(motion.torque()),
            Some(motion) => Drive::Follow(motion.command),
            None => Drive::Hold,
        };
        // The next state says what acted.
        self.state.tau_j_d = match drive {
            Drive::Torque(torque) => torque,
            Drive::Hold | Drive::Follow(_) => [0.0; DOF],
        };
        drive
    }

    /// A reflex.
    fn abort(&mut self, errors: RobotErrors) {
        self.counters.reflexes += 1;
        self.aborted = Some(RobotMode::Reflex);
        self.state.errors = errors;
        self.state.reflex_reason = errors;
        self.end(MoveStatus::ReflexAborted, errors);
    }

    /// The motion is over, if there is one.
    fn end(&mut self, status: MoveStatus, reason: RobotErrors) {
        let Some(motion) = self.motion.take() else {
            return;
        };
        self.settles = true;
        self.replies.push(motion.id, Due::Move(status));
        self.ended = Some(Ended {
            status,
            reason,
            commands: motion.commands,
            lost: motion.lost,
        });
    }
}
