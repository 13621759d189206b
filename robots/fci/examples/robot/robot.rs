//! What the robot knows: its state, the motion, the replies that are due.

use fci::request::Load;
use fci::state::{FIELDS, LEN_MAX};
use fci::status::{
    ConnectStatus, LibraryStatus, ModelStatus, MoveStatus, RecoveryStatus, SetterStatus,
    StopMoveStatus,
};
use fci::{
    Command, Controller, ControllerMode, Error, Generator, MotionGeneratorMode, Reply, Request,
    RobotError, RobotErrors, RobotMode, Setter, State, Version,
};

use crate::urdf;

/// States in which one error is shown.
const SHOWN: u64 = 16;
/// Answers in a row that may not come.
const LOST_MAX: u32 = 20;
/// Torque in a cycle \[Nm\].
const STEP_MAX: f64 = 1.0;

struct Motion {
    /// Id of Move.
    id: u32,
    controller: Controller,
    generator: Generator,
    /// The first answer has come.
    armed: bool,
    answered: bool,
    commands: u32,
    lost: u32,
    lost_in_a_row: u32,
}

pub struct Robot {
    version: Version,
    state: State,
    motion: Option<Motion>,
    replies: Vec<Vec<u8>>,
}

impl Robot {
    /// All numbers of the state differ.
    pub fn new(version: Version) -> Self {
        let mut state = State::default();
        let mut number = 0.25;
        for (field, values) in FIELDS.iter().zip(state.reals_mut()) {
            if field.offset(version).is_some() {
                for value in values {
                    *value = number;
                    number += 1.0;
                }
            }
        }
        Self {
            version,
            state,
            motion: None,
            replies: Vec::new(),
        }
    }

    pub fn version(&self) -> Version {
        self.version
    }

    /// A line for each field of reals, one for each enumeration.
    pub fn print_fields(&self) {
        for (field, values) in FIELDS.iter().zip(self.state.reals()) {
            if field.offset(self.version).is_some() {
                let values: Vec<String> = values.iter().map(f64::to_string).collect();
                println!("field {} {}", field.name, values.join(" "));
            }
        }
        let errors: Vec<&str> = RobotError::all().map(RobotError::name).collect();
        println!("errors {}", errors.join(" "));
        println!("shown {SHOWN}");
    }

    /// The messages that are due.
    pub fn replies(&mut self) -> Vec<Vec<u8>> {
        std::mem::take(&mut self.replies)
    }

    fn reply(&mut self, id: u32, reply: &Reply<'_>) {
        let mut room = vec![0; 1 << 16];
        match reply.emit(self.version, id, &mut room) {
            Ok(message) => self.replies.push(message.to_vec()),
            Err(error) => println!("reply: {error}"),
        }
    }

    pub fn request(&mut self, id: u32, request: &Request) {
        let kind = request.kind();
        if let Some(setter) = Setter::of(kind) {
            let status = if self.motion.is_some() {
                SetterStatus::NotPossible
            } else if request.check().is_err() {
                SetterStatus::InvalidArgument
            } else {
                self.set(request);
                SetterStatus::Success
            };
            self.reply(id, &Reply::Setter { setter, status });
            return;
        }
        match *request {
            Request::Connect(connect) => {
                let version = self.version.number();
                let status = if connect.version == version {
                    ConnectStatus::Success
                } else {
                    ConnectStatus::IncompatibleVersion
                };
                self.reply(id, &Reply::Connect { status, version });
            }
            Request::Move(motion) => {
                if self.motion.is_some() || self.state.robot_mode == RobotMode::Reflex {
                    self.reply(id, &Reply::Move(MoveStatus::NotPossible));
                    return;
                }
                self.motion = Some(Motion {
                    id,
                    controller: motion.controller,
                    generator: motion.generator,
                    armed: false,
                    answered: false,
                    commands: 0,
                    lost: 0,
                    lost_in_a_row: 0,
                });
                self.state.tau_j_d = [0.0; 7];
                self.reply(id, &Reply::Move(MoveStatus::MotionStarted));
            }
            Request::StopMove => {
                let status = if self.motion.is_some() {
                    StopMoveStatus::Success
                } else {
                    StopMoveStatus::NotPossible
                };
                self.end(MoveStatus::Preempted);
                self.reply(id, &Reply::StopMove(status));
            }
            Request::AutomaticErrorRecovery => {
                self.state.robot_mode = RobotMode::Idle;
                self.state.errors = RobotErrors::NONE;
                self.reply(id, &Reply::Recovery(RecoveryStatus::Success));
            }
            Request::GetCartesianLimit { .. } => {
                let status = SetterStatus::Success;
                let limit = fci::reply::CartesianLimit {
                    size: [0.25, 0.5, 0.75],
                    frame: self.state.o_t_ee,
                    active: true,
                };
                self.reply(id, &Reply::CartesianLimit { status, limit });
            }
            Request::LoadModelLibrary { .. } => {
                let status = LibraryStatus::Error;
                let library = &[];
                self.reply(id, &Reply::ModelLibrary { status, library });
            }
            Request::GetRobotModel => {
                let urdf = urdf::text();
                let (status, urdf) = (ModelStatus::Success, urdf.as_bytes());
                self.reply(id, &Reply::RobotModel { status, urdf });
            }
            // The setters are above.
            _ => println!("{kind}: no reply"),
        }
    }

    /// What a setter changes in the state.
    fn set(&mut self, request: &Request) {
        match *request {
            Request::SetEeToK(pose) => self.state.ee_t_k = pose,
            Request::SetNeToEe(pose) => self.state.ne_t_ee = pose,
            Request::SetLoad(Load {
                m_load,
                f_x_cload,
                i_load,
            }) => {
                self.state.m_load = m_load;
                self.state.f_x_cload = f_x_cload;
                self.state.i_load = i_load;
            }
            _ => {}
        }
    }

    /// A datagram of the client.
    pub fn command(&mut self, bytes: &[u8]) {
        let command = match Command::parse(self.version, bytes) {
            Ok(command) => command,
            Err(error) => return println!("command: {error}"),
        };
        let Some(motion) = &mut self.motion else {
            return;
        };
        // One for an older state is late.
        if command.message_id != self.state.message_id {
            return;
        }
        motion.armed = true;
        motion.answered = true;
        motion.commands += 1;
        motion.lost_in_a_row = 0;
        let before = self.state.tau_j_d;
        let step = |(now, before): (&f64, f64)| (now - before).abs() <= STEP_MAX;
        if command.check().is_err() || !command.tau_j_d.iter().zip(before).all(step) {
            self.reflex(RobotError::ControllerTorqueDiscontinuity);
        } else if command.is_last() {
            println!("last {command:?}");
            self.end(MoveStatus::Success);
        } else {
            self.state.tau_j_d = command.tau_j_d;
        }
    }

    fn reflex(&mut self, error: RobotError) {
        self.state.robot_mode = RobotMode::Reflex;
        self.state.errors = RobotErrors::NONE.with(error);
        self.state.reflex_reason = self.state.errors;
        self.end(MoveStatus::ReflexAborted);
    }

    fn end(&mut self, status: MoveStatus) {
        if let Some(motion) = self.motion.take() {
            let (commands, lost) = (motion.commands, motion.lost);
            println!("motion {commands} commands, {lost} lost: {status}");
            self.reply(motion.id, &Reply::Move(status));
        }
    }

    /// The client has gone.
    pub fn leave(&mut self) {
        self.end(MoveStatus::Aborted);
        self.replies.clear();
        self.state.robot_mode = RobotMode::Idle;
    }

    /// Whether the answer to the last state is still to come.
    pub fn waits(&self) -> bool {
        let motion = self.motion.as_ref();
        motion.is_some_and(|motion| motion.armed && !motion.answered)
    }

    /// The next state.
    pub fn state<'a>(&mut self, bytes: &'a mut [u8; LEN_MAX]) -> Result<&'a [u8], Error> {
        if self.waits()
            && let Some(motion) = &mut self.motion
        {
            motion.lost += 1;
            motion.lost_in_a_row += 1;
            if motion.lost_in_a_row == LOST_MAX {
                self.reflex(RobotError::CommunicationConstraintsViolation);
            }
        }
        self.state.message_id += 1;
        if let Some(motion) = &mut self.motion {
            motion.answered = false;
            self.state.robot_mode = RobotMode::Move;
            self.state.motion_generator_mode = motion.generator.into();
            self.state.controller_mode = motion.controller.into();
            self.state.errors = RobotErrors::NONE;
            self.state.reflex_reason = RobotErrors::NONE;
        } else {
            self.state.motion_generator_mode = MotionGeneratorMode::Idle;
            self.state.controller_mode = ControllerMode::Other;
            if self.state.robot_mode != RobotMode::Reflex {
                self.show();
            }
        }
        self.state.emit(self.version, bytes)
    }

    /// Error i in the states i * `SHOWN` and behind, 40 - i as the reason; modes likewise.
    fn show(&mut self) {
        let count = RobotError::all().count();
        let i = (self.state.message_id / SHOWN) as usize % count;
        let one = |i| RobotError::all().skip(i).take(1).collect();
        self.state.errors = one(i);
        self.state.reflex_reason = one(count - 1 - i);
        let modes = || RobotMode::all().filter(|&mode| mode != RobotMode::Reflex);
        self.state.robot_mode = modes().nth(i % modes().count()).unwrap_or_default();
    }
}
