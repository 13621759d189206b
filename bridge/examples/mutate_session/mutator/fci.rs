//! The FR3, in both layouts of its state.

use arms::FR3;
use bridge::fci::Fci;
use bridge::session::{Session, SessionConfig};
use controller_core::law::null_space::NullDamping;
use controller_core::{Axes, ControllerConfig, NullSpace, Task, TaskGains, TaskSet};
use fci::client::Duty;
use fci::state::{self, field};
use fci::{Command, Error, RobotMode, State, StatePacket, Version};
use hostile::Random;

use super::Robot;

const START_DEG: [f64; 7] = [0.0, -45.0, 0.0, -135.0, 0.0, 90.0, 45.0];

/// Largest change of a torque from what the robot used last \[Nm\].
const STEP_MAX_NM: f64 = 1.0;

/// Cycles without a motion, and of the motion until its end is asked for.
const STILL: u32 = 30;
const MOTION: u32 = 1_500;

/// Times of the session \[s\]: short, for all of it to be there in a conversation of the harness.
const SETTLE_S: f64 = 0.1;
const DURATION_S: f64 = 0.3;

/// Places of a state: number, positions, speeds, last torque; codes and truth values.
struct Layout {
    version: Version,
    real: usize,
    q: usize,
    dq: usize,
    tau_j_d: usize,
    codes: [usize; 3],
    errors: usize,
}

const LAYOUTS: [Layout; 2] = [
    Layout {
        version: Version::V5,
        real: 8,
        q: 1184,
        dq: 1296,
        tau_j_d: 1072,
        codes: [2280, 2281, 2364],
        errors: 2282,
    },
    Layout {
        version: Version::V10,
        real: 4,
        q: 596,
        dq: 652,
        tau_j_d: 540,
        codes: [1288, 1289, 1372],
        errors: 1290,
    },
];

/// An arm that stands still but for noise, and uses what it is sent.
pub struct Franka {
    layout: &'static Layout,
    state: State,
    cycle: u32,
}

impl Franka {
    fn duty(&self) -> Duty {
        match self.cycle {
            ..STILL => Duty::Listen,
            STILL..MOTION => Duty::Answer,
            _ => Duty::Finish,
        }
    }

    /// Overwrites a real of a block of 7.
    fn put(&self, bytes: &mut [u8], block: usize, value: f64, random: &mut Random) {
        let at = block + self.layout.real * random.below(7);
        let (double, single) = (value.to_le_bytes(), (value as f32).to_le_bytes());
        let value: &[u8] = match self.layout.real {
            4 => &single,
            _ => &double,
        };
        for (place, byte) in bytes.iter_mut().skip(at).zip(value) {
            *place = *byte;
        }
    }
}

impl Robot for Franka {
    type Protocol = Fci;

    const HEADS: &'static [&'static str] = &["FCI 5", "FCI 10"];
    const DAMAGES: &'static [&'static str] = &[
        "length",
        "number",
        "code or bool",
        "not finite",
        "position",
        "speed",
        "torque",
        "bits",
    ];
    const ERRORS: &'static [&'static str] = &["length", "code", "bool", "not finite"];
    // Its cycle is the same everywhere.
    const IMPOSSIBLE: &'static [usize] = &[2];

    fn new(column: usize) -> (Self, Session<Fci>) {
        let layout = &LAYOUTS[column];
        let flange = FR3.flange_point();
        let task = Task::position(flange, Axes::XYZ, TaskGains::uniform(400.0, 40.0));
        let controller = ControllerConfig {
            tasks: TaskSet::new(&[task]).expect("a task that can be"),
            null_space: NullSpace {
                damping: NullDamping::Inertia(10.0),
                ..NullSpace::diagonal([10.0; 7], [1.0; 7])
            },
            observer_gain: [50.0; 7],
            cycle_s: 0.001,
            dead_cycles: 0,
        };
        let config = SessionConfig {
            doubted_max: 2,
            settle_s: SETTLE_S,
            ramp_s: SETTLE_S,
            ..SessionConfig::new(&FR3, controller, flange, DURATION_S)
        };
        let robot = Self {
            layout,
            state: State {
                message_id: 1_000_000,
                robot_mode: RobotMode::Move,
                q: START_DEG.map(f64::to_radians),
                ..State::default()
            },
            cycle: 0,
        };
        (robot, Session::new(Fci::new(layout.version), config))
    }

    fn report(&mut self, bytes: &mut Vec<u8>, random: &mut Random) {
        self.cycle += 1;
        self.state.message_id += 1;
        for q in &mut self.state.q {
            *q += (random.below(2001) as f64 - 1000.0) * 1e-9;
        }
        for dq in &mut self.state.dq {
            *dq = (random.below(2001) as f64 - 1000.0) * 1e-6;
        }
        let mut room = [0; state::LEN_MAX];
        let datagram = self.state.emit(self.layout.version, &mut room);
        bytes.clear();
        bytes.extend(datagram.expect("modes of all versions"));
    }

    fn damage(&self, bytes: &mut Vec<u8>, random: &mut Random) -> usize {
        let layout = self.layout;
        let damage = random.below(Self::DAMAGES.len());
        match damage {
            0 => bytes.resize(random.length(bytes.len(), state::LEN_MAX + 16), 0),
            1 => {
                let now = self.state.message_id;
                let any = u64::from(random.bits()) << 32 | u64::from(random.bits());
                let ids = [
                    0,
                    now - 1,
                    now - 2,
                    now + 7,
                    now + 500,
                    now + 5000,
                    u64::MAX,
                    any,
                ];
                let id = random.pick(&ids).to_le_bytes();
                for (place, byte) in bytes.iter_mut().zip(id) {
                    *place = byte;
                }
            }
            2 => {
                let [generator, controller, mode] = layout.codes;
                let error = layout.errors + random.below(82);
                let at = random.pick(&[generator, controller, mode, error]);
                if let Some(place) = bytes.get_mut(at) {
                    *place = random.below(9) as u8;
                }
            }
            3 => {
                let block = random.pick(&[layout.q, layout.dq, layout.tau_j_d]);
                let none = random.pick(&[f64::NAN, f64::INFINITY, f64::NEG_INFINITY]);
                self.put(bytes, block, none, random);
            }
            4 => {
                let q = (random.below(4000) as f64 - 2000.0) * 1e-3;
                self.put(bytes, layout.q, q, random);
            }
            5 => {
                let dq = (random.below(4000) as f64 - 2000.0) * 1e-2;
                self.put(bytes, layout.dq, dq, random);
            }
            6 => {
                let torque = (random.below(4000) as f64 - 2000.0) * 0.1;
                self.put(bytes, layout.tau_j_d, torque, random);
            }
            _ => random.flip(bytes),
        }
        damage
    }

    fn attend(&self, session: &mut Session<Fci>) {
        session.protocol_mut().attend(self.duty());
    }

    fn error(&self, bytes: &[u8]) -> Option<Error> {
        const USED: [state::Field; 7] = [
            field::Q,
            field::DQ,
            field::TAU_J_D,
            field::TAU_J,
            field::O_T_EE,
            field::F_T_EE,
            field::CONTROL_COMMAND_SUCCESS_RATE,
        ];
        let packet = StatePacket::new_checked(self.layout.version, bytes);
        match packet {
            Ok(packet) => packet.check_finite(&USED).err(),
            Err(error) => Some(error),
        }
    }

    fn row(error: Error) -> Option<usize> {
        Some(match error {
            Error::Length { .. } => 0,
            Error::Code { .. } => 1,
            Error::Bool { .. } => 2,
            Error::NotFinite { .. } => 3,
            _ => return None,
        })
    }

    fn hear(&mut self, answer: &[u8], _: bool) -> Result<bool, String> {
        let command = Command::parse(self.layout.version, answer);
        let command = command.map_err(|error| error.to_string())?;
        command.check().map_err(|error| error.to_string())?;
        if command.is_last() != (self.duty() == Duty::Finish) {
            return Err(format!("{:?} in a motion that goes on", command.is_last()));
        }
        let steps = command.tau_j_d.iter().zip(self.state.tau_j_d);
        let step_nm = steps.fold(0.0_f64, |most, (now, last)| most.max((now - last).abs()));
        if step_nm > STEP_MAX_NM {
            return Err(format!("a step of {step_nm} Nm; allowed: {STEP_MAX_NM} Nm"));
        }
        self.state.tau_j_d = command.tau_j_d;
        Ok(command.tau_j_d.iter().any(|torque| *torque != 0.0))
    }
}
