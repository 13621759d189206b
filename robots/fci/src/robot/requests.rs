//! Requests: which the robot serves, and how it refuses the others.

use crate::error::Error;
use crate::kind::Kind;
use crate::modes::{Controller, Generator, RobotMode};
use crate::reply::Setter;
use crate::request::{CollisionBehavior, Connect, Load, Move, Request};
use crate::robot::motion::Motion;
use crate::robot::outcome::{Broken, Handled, Refused};
use crate::robot::replies::Due;
use crate::robot::settings::Motions;
use crate::robot::{Client, Recovery, Robot, pose};
use crate::robot_error::RobotErrors;
use crate::status::{
    ConnectStatus, LibraryStatus, ModelStatus, MoveStatus, RecoveryStatus, SetterStatus,
    StopMoveStatus,
};

impl<M: AsRef<[u8]>> Robot<M> {
    /// Takes bytes of the stream from the front of `bytes` up to the end of a request, which has
    /// its reply then; none where more bytes are needed. Bytes that it leaves without a request wait for
    /// [`Robot::replies`] to go out.
    ///
    /// # Errors
    /// The connection is of no use; every later call says the same, until
    /// [`Robot::disconnect`].
    pub fn receive(&mut self, bytes: &mut &[u8]) -> Result<Option<Handled>, Broken> {
        if let Some(broken) = self.broken {
            return Err(broken);
        }
        if !self.replies.has_room() {
            return Ok(None);
        }
        let handled = self.next_request(bytes);
        self.broken = handled.err();
        handled
    }

    fn next_request(&mut self, bytes: &mut &[u8]) -> Result<Option<Handled>, Broken> {
        let version = self.settings.version;
        let Some(message) = self.stream.next(bytes).map_err(Broken::Stream)? else {
            return Ok(None);
        };
        let id = message.id;
        let kind = Kind::from_code(version, message.code).map_err(Broken::Stream)?;
        let request = match Request::parse(version, &message) {
            // Where the next one begins is known, but hardly what the client means.
            Err(error @ Error::Length { .. }) => return Err(Broken::Stream(error)),
            request => request,
        };
        match (self.client, kind) {
            (Client::Connected(_), Kind::Connect) => return Err(Broken::Connected),
            (Client::Connected(_), _) | (Client::Silent, Kind::Connect) => {}
            _ => return Err(Broken::NotConnected(kind)),
        }
        let refused = match &request {
            Ok(request) => self.serve(id, request),
            Err(error) => {
                let refused = Refused::Argument(*error);
                self.refuse(id, kind, refused);
                Some(refused)
            }
        };
        Ok(Some(Handled {
            id,
            kind,
            request: request.ok(),
            refused,
        }))
    }

    /// Does what is asked for, and replies.
    fn serve(&mut self, id: u32, request: &Request) -> Option<Refused> {
        let refused = match *request {
            Request::Connect(connect) => return self.connect(id, connect),
            Request::Move(wanted) => match self.check_move(&wanted) {
                Ok(()) => {
                    self.begin(id, &wanted);
                    return None;
                }
                Err(refused) => refused,
            },
            Request::StopMove if self.motion.is_some() => {
                self.end(MoveStatus::Preempted, RobotErrors::NONE);
                self.reply(id, Due::StopMove(StopMoveStatus::Success));
                return None;
            }
            Request::StopMove => Refused::NoMotion,
            Request::AutomaticErrorRecovery => match self.check_recovery() {
                Ok(()) => {
                    self.recover(id);
                    return None;
                }
                Err(refused) => refused,
            },
            Request::GetCartesianLimit { limit } => match self.wall(limit) {
                Some(wall) => {
                    self.reply(id, Due::Wall(Some(wall)));
                    return None;
                }
                None => Refused::Wall(limit),
            },
            // Native code for the client's computer: this robot has none.
            Request::LoadModelLibrary { .. } => Refused::Absent(Kind::LoadModelLibrary),
            Request::GetRobotModel if self.model.as_ref().is_empty() => {
                Refused::Absent(Kind::GetRobotModel)
            }
            Request::GetRobotModel => {
                self.reply(id, Due::Model(ModelStatus::Success));
                return None;
            }
            Request::SetCollisionBehavior(_)
            | Request::SetJointImpedance(_)
            | Request::SetCartesianImpedance(_)
            | Request::SetGuidingMode(_)
            | Request::SetEeToK(_)
            | Request::SetNeToEe(_)
            | Request::SetLoad(_)
            | Request::SetFilters(_) => match self.check_setter(request) {
                Ok(()) => {
                    self.set(request);
                    if let Some(setter) = Setter::of(request.kind()) {
                        self.reply(id, Due::Setter(setter, SetterStatus::Success));
                    }
                    return None;
                }
                Err(refused) => refused,
            },
        };
        self.refuse(id, request.kind(), refused);
        Some(refused)
    }

    fn reply(&mut self, id: u32, due: Due) {
        self.replies.push(id, due);
    }

    /// Says no, as far as the reply has a status for the reason.
    fn refuse(&mut self, id: u32, kind: Kind, refused: Refused) {
        let argument = matches!(refused, Refused::Argument(_) | Refused::Wall(_));
        let setter_status = if argument {
            SetterStatus::InvalidArgument
        } else {
            SetterStatus::NotPossible
        };
        if let Some(setter) = Setter::of(kind) {
            return self.reply(id, Due::Setter(setter, setter_status));
        }
        let due = match kind {
            Kind::Connect => Due::Connect(ConnectStatus::IncompatibleVersion),
            Kind::Move if argument => Due::Move(MoveStatus::InvalidArgument),
            Kind::Move => Due::Move(MoveStatus::NotPossible),
            Kind::StopMove => Due::StopMove(StopMoveStatus::NotPossible),
            Kind::GetCartesianLimit => Due::Wall(None),
            Kind::LoadModelLibrary => Due::Library(LibraryStatus::Error),
            Kind::GetRobotModel => Due::Model(ModelStatus::NotPossible),
            // The setters are above.
            _ => Due::Recovery(match refused {
                Refused::Mode(RobotMode::UserStopped) => RecoveryStatus::EmergencyAborted,
                Refused::Beyond { .. } => RecoveryStatus::ManualRecoveryRequired,
                _ => RecoveryStatus::NotPossible,
            }),
        };
        self.reply(id, due);
    }

    fn connect(&mut self, id: u32, connect: Connect) -> Option<Refused> {
        let expected = self.settings.version.number();
        let found = connect.version;
        if found == expected {
            self.client = Client::Connected(connect);
            self.reply(id, Due::Connect(ConnectStatus::Success));
            return None;
        }
        self.client = Client::Refused;
        let refused = Refused::Version { found, expected };
        self.refuse(id, Kind::Connect, refused);
        Some(refused)
    }

    fn check_move(&self, wanted: &Move) -> Result<(), Refused> {
        self.check_idle(&[RobotMode::Idle])?;
        let request = Request::Move(*wanted);
        request.check().map_err(Refused::Argument)?;
        if wanted.use_async_motion_generator {
            return Err(Refused::Asynchronous);
        }
        let torque = wanted.controller == Controller::External
            && matches!(wanted.generator, Generator::None | Generator::JointVelocity);
        if !torque && self.settings.motions == Motions::Torque {
            return Err(Refused::Motion(wanted.controller, wanted.generator));
        }
        self.check_range()
    }

    /// No motion runs, and the robot is in one of these modes.
    fn check_idle(&self, modes: &[RobotMode]) -> Result<(), Refused> {
        if self.motion.is_some() {
            return Err(Refused::InMotion);
        }
        let mode = self.mode();
        if modes.contains(&mode) {
            return Ok(());
        }
        Err(Refused::Mode(mode))
    }

    /// The arm as the last state has it is within its ranges.
    fn check_range(&self) -> Result<(), Refused> {
        let limits = &self.settings.limits;
        let beyond = limits.beyond(&self.state.q).filter(|_| self.has_seen_arm());
        match beyond {
            Some(index) => Err(Refused::Beyond { joint: index + 1 }),
            None => Ok(()),
        }
    }

    /// Whether a state has been made: before that no joint has an angle.
    fn has_seen_arm(&self) -> bool {
        self.state.message_id != self.settings.message_id
    }

    fn begin(&mut self, id: u32, wanted: &Move) {
        self.counters.motions += 1;
        self.state.errors = RobotErrors::NONE;
        self.state.reflex_reason = RobotErrors::NONE;
        self.motion = Some(Motion::new(id, wanted.controller, wanted.generator));
        self.reply(id, Due::Move(MoveStatus::MotionStarted));
    }

    fn check_recovery(&self) -> Result<(), Refused> {
        if self.operator.stops() {
            return Err(Refused::Mode(RobotMode::UserStopped));
        }
        self.check_idle(&[
            RobotMode::Idle,
            RobotMode::Guiding,
            RobotMode::Reflex,
            RobotMode::UserStopped,
        ])?;
        self.check_range()
    }

    fn recover(&mut self, id: u32) {
        if self.aborted.is_none() {
            return self.reply(id, Due::Recovery(RecoveryStatus::Success));
        }
        self.recovery = Some(Recovery {
            id: Some(id),
            left: self.settings.recovery_cycles,
        });
    }

    /// Place of a wall.
    fn wall(&self, number: i32) -> Option<usize> {
        let index = usize::try_from(number).ok()?;
        self.settings.walls.get(index)?.as_ref()?;
        Some(index)
    }

    fn check_setter(&self, request: &Request) -> Result<(), Refused> {
        self.check_idle(&[
            RobotMode::Idle,
            RobotMode::Guiding,
            RobotMode::Reflex,
            RobotMode::UserStopped,
        ])?;
        let checked = request.check().and_then(|()| match request {
            Request::SetEeToK(frame) => pose::check("EE_T_K", frame),
            Request::SetNeToEe(frame) => pose::check("NE_T_EE", frame),
            Request::SetLoad(load) => check_load(load),
            Request::SetCollisionBehavior(behavior) => check_thresholds(behavior),
            Request::SetFilters(frequencies) => {
                least("cut-off frequency", frequencies, &[f64::MIN_POSITIVE; 5])
            }
            _ => Ok(()),
        });
        checked.map_err(Refused::Argument)
    }

    /// What a setter changes. Stiffness and filters are of controllers that are not here, and
    /// the guiding mode of hands.
    fn set(&mut self, request: &Request) {
        match *request {
            Request::SetCollisionBehavior(behavior) => self.collision = behavior,
            Request::SetEeToK(frame) => self.state.ee_t_k = frame,
            Request::SetNeToEe(frame) => self.state.ne_t_ee = frame,
            Request::SetLoad(load) => {
                self.state.m_load = load.m_load;
                self.state.f_x_cload = load.f_x_cload;
                self.state.i_load = load.i_load;
            }
            _ => {}
        }
    }
}

/// Whether numbers are at least others.
fn least(field: &'static str, values: &[f64], least: &[f64]) -> Result<(), Error> {
    let mut pairs = values.iter().zip(least);
    let wrong = pairs.position(|(value, least)| value < least);
    let Some(index) = wrong else {
        return Ok(());
    };
    let at = |values: &[f64]| values.get(index).copied().unwrap_or_default();
    Err(Error::Range {
        field,
        index,
        found: at(values),
        min: at(least),
        max: f64::MAX,
    })
}

fn check_load(load: &Load) -> Result<(), Error> {
    const ANY: f64 = f64::MIN;
    least("m_load", &[load.m_load], &[0.0])?;
    let moments = [0.0, ANY, ANY, ANY, 0.0, ANY, ANY, ANY, 0.0];
    least("I_load", &load.i_load, &moments)
}

/// Contact is reported before a collision is.
fn check_thresholds(behavior: &CollisionBehavior) -> Result<(), Error> {
    let CollisionBehavior {
        lower_torque_acceleration,
        upper_torque_acceleration,
        lower_torque_nominal,
        upper_torque_nominal,
        lower_force_acceleration,
        upper_force_acceleration,
        lower_force_nominal,
        upper_force_nominal,
    } = behavior;
    let (torques, forces) = (&[0.0; 7], &[0.0; 6]);
    least(
        "lower_torque_acceleration",
        lower_torque_acceleration,
        torques,
    )?;
    least(
        "upper_torque_acceleration",
        upper_torque_acceleration,
        lower_torque_acceleration,
    )?;
    least("lower_torque_nominal", lower_torque_nominal, torques)?;
    least(
        "upper_torque_nominal",
        upper_torque_nominal,
        lower_torque_nominal,
    )?;
    least("lower_force_acceleration", lower_force_acceleration, forces)?;
    least(
        "upper_force_acceleration",
        upper_force_acceleration,
        lower_force_acceleration,
    )?;
    least("lower_force_nominal", lower_force_nominal, forces)?;
    least(
        "upper_force_nominal",
        upper_force_nominal,
        lower_force_nominal,
    )
}
