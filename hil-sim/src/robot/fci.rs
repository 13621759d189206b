//! The control box of Franka's FCI: the robot's end of the crate `fci` on a simulated arm.
//!
//! Nothing moves and no time passes before the first command of a motion: states go out, the same
//! arm in all of them. Scenario time 0 is [`SETTLE_S`] behind the cycle of that command, from whose
//! measurement references start. While no motion runs springs hold the arm where it is.

mod arm;
pub mod figures;
pub mod urdf;

use controller_core::arm::ArmParameters;
use controller_core::joint::JointVector;
use fci::Version;
use fci::robot::{Drive, EndEffector, Ended, Operator, Settings};
use fci::state::LEN_MAX;
use fci::status::MoveStatus;

pub use fci::robot::{Broken, Handled, Received};
pub use figures::FciFigures;

use super::arm::Robot;
use super::control_box::{Answer, ControlBox, Figures, Now, Surroundings, Told, Turn};
use super::counters::Counters;
use super::driving::{Driving, Pipe};
use super::figures::{Counted, Event};
use super::lwr::POSITION_STIFFNESS;
use crate::plant::Impedance;
use cell::invalid::Invalid;
use cell::names::MeasurementKind;
use cell::scenario::{EquippedArm, Scenario};

/// Cycle of the interface \[ms\].
const CYCLE_MS: f64 = 1.0;

/// Cycles that the success rate is about.
const WINDOW: u64 = 100;

/// From the first command to scenario time 0 \[s\].
pub const SETTLE_S: f64 = 1.0;

/// What a control box is told of its arm, besides the tables.
#[derive(Clone, Debug)]
pub struct FciOptions {
    /// Of the interface.
    pub version: Version,
    /// What is on the flange.
    pub end_effector: EndEffector,
    /// URDF of the arm without it.
    pub model: String,
    /// Scenario time during which the stop for users is pressed \[s\].
    pub drives_off_s: Option<[f64; 2]>,
}

impl FciOptions {
    /// Of the arm and the tool of a scenario, by a version of the interface.
    #[must_use]
    pub fn of(scenario: &Scenario, version: Version) -> Self {
        let equipped = scenario.arm();
        let bare = scenario.robot.table().map(EquippedArm::of);
        let bare = bare.unwrap_or_else(|_| equipped.clone());
        let tool = equipped.tool();
        Self {
            version,
            end_effector: tool.map_or(EndEffector::NONE, arm::end_effector),
            model: urdf::text(&bare.parameters),
            drives_off_s: None,
        }
    }

    /// Refuses a scenario with another cycle than that of the interface.
    ///
    /// # Errors
    /// Its cycle.
    pub fn check_cycle(scenario: &Scenario) -> Result<(), Invalid> {
        if scenario.cycle_ms == CYCLE_MS {
            return Ok(());
        }
        let given = format!("{} ms", scenario.cycle_ms);
        let allowed = "1 ms, the only one that the FCI has: --cycle-ms 1";
        Err(Invalid::new("cycle", given, allowed))
    }
}

/// A state as it goes out.
#[derive(Clone, Debug)]
pub struct StateDatagram {
    bytes: [u8; LEN_MAX],
    len: usize,
}

impl AsRef<[u8]> for StateDatagram {
    fn as_ref(&self) -> &[u8] {
        self.bytes.get(..self.len).unwrap_or(&self.bytes)
    }
}

/// The control box.
pub struct FciBox {
    version: Version,
    control: fci::robot::Robot<String>,
    cycle_s: f64,
    gravity: [f64; 3],
    pipe: Pipe,
    /// Where the arm is held \[rad\]; none under torque.
    hold: Option<JointVector<f64>>,
    /// What holds the load that the client has set \[Nm\].
    load: JointVector<f64>,
    /// Torque of the client that arrived in the last cycle \[Nm\].
    arrived: JointVector<f64>,
    /// A first command has come.
    begun: bool,
    /// The robot itself ends a motion, and lets nobody begin another.
    stopped: bool,
    errors: Vec<&'static str>,
    success_rate_min: Option<f64>,
    /// Cycles behind the first command of the present motion.
    answered: u64,
    ended: Option<Ended>,
    messages: Vec<String>,
}

impl FciBox {
    /// What the robot's end has to tell.
    fn listen(&mut self) {
        let Some(ended) = self.control.ended() else {
            return;
        };
        for error in ended.reason.iter() {
            if !self.errors.contains(&error.name()) {
                self.errors.push(error.name());
            }
        }
        let (commands, lost) = (ended.commands, ended.lost);
        let how = described(&ended);
        self.messages
            .push(format!("motion {how}; {commands} commands, {lost} lost"));
        self.ended = Some(ended);
    }
}

/// How a motion has ended.
fn described(ended: &Ended) -> String {
    match ended.reason.is_empty() {
        true => ended.status.to_string(),
        false => format!("{}: {}", ended.status, ended.reason),
    }
}

impl ControlBox for FciBox {
    type Options = FciOptions;
    type Measurement = StateDatagram;

    const EMPTY: StateDatagram = StateDatagram {
        bytes: [0; LEN_MAX],
        len: 0,
    };
    const MEASUREMENT: MeasurementKind = MeasurementKind::Link;
    const CLIENT_ENDS: bool = true;

    fn new(
        options: &FciOptions,
        cycle_s: f64,
        q0: &JointVector<f64>,
        arm: &ArmParameters,
        dead_cycles: usize,
    ) -> Self {
        let mut settings = Settings::new(options.version, arm::limits(arm));
        settings.end_effector = options.end_effector;
        Self {
            version: options.version,
            control: fci::robot::Robot::new(settings, options.model.clone()),
            cycle_s,
            gravity: arm.gravity,
            pipe: Pipe::new(dead_cycles),
            hold: Some(*q0),
            load: JointVector::zeros(),
            arrived: JointVector::zeros(),
            begun: false,
            stopped: false,
            errors: Vec::new(),
            success_rate_min: None,
            answered: 0,
            ended: None,
            messages: Vec::new(),
        }
    }

    fn settle_s(_: &FciOptions) -> f64 {
        SETTLE_S
    }

    fn drives_off_s(options: &FciOptions) -> Option<[f64; 2]> {
        options.drives_off_s
    }

    fn adds_coriolis(&self) -> bool {
        false
    }

    fn as_sent(&self, q: &JointVector<f64>) -> JointVector<f64> {
        match self.version {
            Version::V10 => q.map(|angle| f64::from(angle as f32)),
            _ => *q,
        }
    }

    fn report(&mut self, around: &Surroundings<'_>, out: &mut StateDatagram) {
        let (seen, model) = (around.seen, around.model);
        let q = &seen.measured.q;
        let applied = around.applied.unwrap_or(&seen.gravity);
        let motors = [q, &seen.measured.dq].map(|values| (*values).into());
        let arm = arm::report(model, seen, applied, motors);
        let operator = Operator {
            user_stop: self.stopped || !around.drives_on,
            ..Operator::ABSENT
        };
        let state = self.control.state(&arm, &operator);
        // Its modes are of its version.
        out.len = state
            .emit(self.version, &mut out.bytes)
            .map_or(0, <[u8]>::len);
        let rate = state.control_command_success_rate;
        if self.answered >= WINDOW && self.control.is_driven() {
            let least = self.success_rate_min.get_or_insert(rate);
            *least = least.min(rate);
        }
        let load = self.control.load();
        self.load = if load.m_load > 0.0 {
            let [x, y, z] = load.f_x_cload;
            let body = [load.m_load, x, y, z];
            arm::holding(&model.jacobian(q), &model.frame(q), body, &self.gravity)
        } else {
            JointVector::zeros()
        };
        self.listen();
    }

    fn departed(&mut self, _: u64, _: f64) {}

    fn command(
        &mut self,
        datagram: &[u8],
        _: u64,
        cycle_s: f64,
        since_s: f64,
        _: &JointVector<f64>,
        counters: &mut Counters,
    ) -> Answer {
        let received = self.control.command(datagram);
        self.listen();
        match received {
            Received::Accepted | Received::Last => {
                if !self.begun {
                    self.messages.push("first command".to_string());
                }
                self.begun = true;
                counters.answer(since_s, since_s <= cycle_s);
                Answer::Accepted
            }
            Received::Repeated => Answer::Repeated,
            Received::Late => Answer::Old,
            Received::NoMotion | Received::Unreadable(_) | Received::Reflex(_) => Answer::Rejected,
        }
    }

    fn has_begun(&self) -> bool {
        self.begun
    }

    fn is_driven(&self) -> bool {
        self.control.is_driven()
    }

    fn is_answered(&self) -> bool {
        !self.control.waits()
    }

    fn answers(state: &[u8], command: &[u8]) -> bool {
        let id = state.get(..8);
        id.is_some() && id == command.get(..8)
    }

    fn cycle(&mut self, now: &Now<'_>) -> Turn {
        if let Some(motion) = &now.unsafe_motion
            && !self.stopped
        {
            self.stopped = true;
            self.messages.push(format!("stopped: {motion}"));
        }
        let driven = self.control.is_driven();
        let drive = self.control.advance();
        self.listen();
        self.answered = if driven { self.answered + 1 } else { 0 };
        let before = self.arrived;
        self.arrived = JointVector::zeros();
        let commanded = matches!(drive, Drive::Torque(_));
        let impedance = match drive {
            Drive::Torque(torque) => {
                self.hold = None;
                self.arrived = self.pipe.pass(&torque.into());
                Impedance::NONE
            }
            // No motion of another kind is taken.
            Drive::Hold | Drive::Follow(_) => {
                if self.hold.is_none() {
                    self.pipe.void();
                }
                let hold = self.hold.get_or_insert(*now.q);
                let [stiffness, ratio] = [POSITION_STIFFNESS, 1.0].map(JointVector::repeat);
                let way = [&*hold, &*hold];
                Impedance::moving(&stiffness, &ratio, now.mass_matrix, way, self.cycle_s)
            }
        };
        Turn {
            driving: Driving {
                torque: self.arrived + self.load,
                impedance,
            },
            ordered_change: self.arrived - before,
            bridging: false,
            commanded,
        }
    }

    fn commands(&self) -> bool {
        // Until the first command the arm is the same: references start from any of its states.
        self.control.mode() == fci::RobotMode::Move
    }

    fn has_never_commanded(&self) -> bool {
        !self.begun
    }

    fn leave(&mut self) {
        self.control.disconnect();
        self.listen();
    }

    fn told(&self) -> Told {
        Told::default()
    }

    fn take_messages(&mut self) -> Vec<String> {
        std::mem::take(&mut self.messages)
    }

    fn refused(&self) -> Option<(u64, String)> {
        let counters = self.control.counters();
        let count = counters.late + counters.repeated + counters.idle + counters.unreadable;
        (count > 0).then(|| (count, "no command to the last state".to_string()))
    }

    fn link(&self) -> String {
        format!("robot mode {}", self.control.mode())
    }

    fn failure(&self) -> Option<String> {
        let ended = self.ended.as_ref()?;
        let failed = ended.status != MoveStatus::Success;
        failed.then(|| format!("the last motion {}", described(ended)))
    }

    fn figures(&self, counted: Counted) -> Figures {
        let counters = self.control.counters();
        Figures::Fci(FciFigures {
            version: self.version.number(),
            motions: counters.motions,
            reflexes: counters.reflexes,
            errors: self.errors.clone(),
            command_share: counted.command_share,
            commands: counters.commands,
            lost: counters.lost,
            success_rate_min: self.success_rate_min,
            late: counters.late,
            repeated: counters.repeated,
            idle: counters.idle,
            unreadable: counters.unreadable,
            largest_torque_step_nm: counters.largest_torque_step_nm,
            own_lateness: counted.own_lateness,
            realtime: None,
            events: counted.events,
        })
    }
}

impl Robot<FciBox> {
    /// The robot's end of the interface: its stream.
    pub fn control(&mut self) -> &mut fci::robot::Robot<String> {
        &mut self.control_box.control
    }

    /// Takes the requests of the stream as far as they are whole and replies do not wait.
    ///
    /// # Errors
    /// Nothing that can be understood: the connection is to be closed.
    pub fn hear_requests(&mut self, bytes: &mut &[u8]) -> Result<(), Broken> {
        while let Some(handled) = self.control_box.control.receive(bytes)? {
            if let Some(refused) = handled.refused {
                self.say(format!("{} refused: {refused}", handled.kind));
            }
            self.control_box.listen();
        }
        Ok(())
    }

    /// The connection is closed; why, if that is worth knowing.
    pub fn disconnect(&mut self, why: Option<String>) {
        self.control_box.leave();
        self.say(match why {
            Some(why) => format!("connection closed: {why}"),
            None => "connection closed by the client".to_string(),
        });
    }

    fn say(&mut self, text: String) {
        let messages = self.control_box.take_messages();
        for text in messages.into_iter().chain([text]) {
            self.counters.event(Event {
                t_s: self.time_s(),
                robot_t_s: self.robot_time_s(),
                text,
            });
        }
    }
}
