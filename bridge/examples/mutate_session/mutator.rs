//! A session between good and damaged measurements.

use std::fmt;

use arms::{LWR_IV, LWR_IV_FLANGE, LWR_IV_STIFFNESS};
use bridge::lwr::{ANSWER_LEN, Lwr};
use bridge::session::{Outcome, Phase, Session, SessionConfig};
use bridge::source::ReferenceSource;
use controller_core::law::null_space::NullDamping;
use controller_core::{Axes, ControllerConfig, NullSpace, Reference, Task, TaskGains, TaskSet};
use fri::{Command, CommandPacket, ControlScheme, Flags, InterfaceState, Measurement, Quality};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng as _, SeedableRng as _};

/// A session is begun anew after so many datagrams: a fault or a stop ends one.
const SESSION: u64 = 5_000;

/// Largest torque on the wire: the limit of the strongest joint plus its gravity [Nm].
const TORQUE_MAX: f32 = 176.0 + 70.0;

struct Random(ChaCha8Rng);

impl Random {
    fn below(&mut self, limit: usize) -> usize {
        (self.0.next_u32() as usize) % limit
    }
}

/// What became of the datagrams.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Table {
    /// Answered, and how many of them with torque.
    pub answered: u64,
    pub with_torque: u64,
    /// Refused by the codec.
    pub rejected: u64,
    /// Repeated, overtaken, or with a counter that cannot be.
    pub stale: u64,
    /// With a cycle that the controller cannot have.
    pub unusable: u64,
    /// Sessions, and how many ended by a fault or a stop.
    pub sessions: u64,
    pub ended: u64,
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} answered ({} with torque), {} rejected, {} stale, {} unusable; \
             {} sessions, {} ended by what they were told",
            self.answered,
            self.with_torque,
            self.rejected,
            self.stale,
            self.unusable,
            self.sessions,
            self.ended
        )
    }
}

/// Holds where it starts.
struct Rest(Reference<f64>);

impl ReferenceSource for Rest {
    fn start(&mut self, origin: &Reference<f64>) {
        self.0.clone_from(origin);
    }

    fn sample(&mut self, _: f64) -> Option<Reference<f64>> {
        Some(self.0.clone())
    }
}

fn session() -> Session<Lwr> {
    let flange = Task::position(LWR_IV_FLANGE, Axes::XYZ, TaskGains::uniform(400.0, 40.0));
    let controller = ControllerConfig {
        tasks: TaskSet::new(&[flange]).expect("a task that can be"),
        null_space: NullSpace {
            damping: NullDamping::Inertia(10.0),
            ..NullSpace::diagonal(LWR_IV_STIFFNESS, [1.0; 7])
        },
        observer_gain: [50.0; 7],
        cycle_s: 0.002,
        dead_cycles: 0,
    };
    Session::new(
        Lwr::new(),
        SessionConfig {
            doubted_max: 2,
            ..SessionConfig::new(&LWR_IV, controller, LWR_IV_FLANGE, 1e6)
        },
    )
}

fn measurement() -> Measurement {
    let mut measurement = Measurement {
        state: InterfaceState::Command,
        quality: Quality::Perfect,
        period_s: 0.002,
        command_period_s: 0.002,
        joint_position: [0.0, 0.61, 0.0, -1.40, 0.35, 1.05, 0.0],
        ..Measurement::default()
    };
    measurement.drives.power = 0x7F;
    measurement.drives.control = ControlScheme::JointImpedance;
    measurement
}

/// Sends `count` datagrams, two thirds of them damaged.
///
/// # Errors
/// An answer that should not be, with the number of the datagram.
pub fn run(count: u64, seed: u64) -> Result<Table, String> {
    let mut random = Random(ChaCha8Rng::seed_from_u64(seed));
    let mut table = Table::default();
    let (mut robot, mut session, mut rest) =
        (measurement(), session(), Rest(Reference::hold(0, [0.0; 7])));
    for number in 0..count {
        if number % SESSION == 0 {
            table.sessions += 1;
            session = self::session();
            robot = measurement();
        }
        robot.header.counter = robot.header.counter.wrapping_add(1);
        // The arm moves a little, and the robot hears what it is sent.
        for q in &mut robot.joint_position {
            *q += (random.below(2001) as f32 - 1000.0) * 1e-8;
        }
        let mut bytes = [0; Measurement::LEN + 16];
        if let Some(datagram) = bytes.first_chunk_mut() {
            robot.emit(datagram);
        }
        let mut length = Measurement::LEN;
        if random.below(3) > 0 {
            length = damage(&mut bytes, &mut random);
        }
        let phase = session.phase();
        let mut answer = [0xAA; ANSWER_LEN];
        let datagram = bytes.get(..length).unwrap_or(&bytes);
        let outcome = session.receive(datagram, &mut rest, &mut answer);
        let failure = |text: &str| Err(format!("datagram {number}, {phase:?}: {text}"));
        match outcome {
            Outcome::Answered => {
                table.answered += 1;
                let Ok(packet) = CommandPacket::new_checked(answer) else {
                    return failure("an answer that is none");
                };
                let command = Command::parse(&packet);
                if command.flags != Flags::JOINT_IMPEDANCE {
                    return failure("other flags");
                }
                let torque = command.joint_torque;
                if torque.iter().any(|torque| torque.abs() > TORQUE_MAX) {
                    return failure("torque beyond the limits");
                }
                let torque = torque.iter().any(|torque| *torque != 0.0);
                if torque && !session.phase().is_in_command() {
                    return failure("torque outside command state");
                }
                table.with_torque += u64::from(torque);
                robot.header.reflected = command.header.counter;
            }
            refused => {
                if answer != [0xAA; ANSWER_LEN] {
                    return failure("an answer to a refused datagram");
                }
                match refused {
                    Outcome::Rejected(_) => table.rejected += 1,
                    Outcome::Unusable(_) => table.unusable += 1,
                    _ => table.stale += 1,
                }
            }
        }
        if session.phase() == Phase::Finished {
            table.ended += 1;
            session = self::session();
            robot = measurement();
        }
    }
    Ok(table)
}

/// Changes bytes, and perhaps the length. Returns the length.
fn damage(bytes: &mut [u8], random: &mut Random) -> usize {
    match random.below(8) {
        0 => random.below(bytes.len() + 1),
        1 => {
            // A counter that jumps.
            let jump = random.0.next_u32() as u16;
            set(bytes, 0, &jump.to_le_bytes());
            Measurement::LEN
        }
        2 => {
            // State, quality, power, control scheme.
            let at = [144, 146, 180, 182][random.below(4)];
            let code = random.below(5) as u16;
            set(bytes, at, &code.to_le_bytes());
            Measurement::LEN
        }
        3 => {
            // A real with any bits: period, positions, models.
            let at = 140 + 4 * random.below((Measurement::LEN - 140) / 4);
            let bits = random.0.next_u32();
            set(bytes, at, &bits.to_le_bytes());
            Measurement::LEN
        }
        4 => {
            // A joint that has moved more than a little.
            let at = 216 + 4 * random.below(7);
            let q = (random.below(2000) as f32 - 1000.0) * 1e-3;
            set(bytes, at, &q.to_le_bytes());
            Measurement::LEN
        }
        5 => {
            set(
                bytes,
                148,
                &[0.0005f32, 0.001, 0.004, 0.02, 0.05, -0.002][random.below(6)].to_le_bytes(),
            );
            Measurement::LEN
        }
        _ => {
            for _ in 0..=random.below(4) {
                let (at, bit) = (random.below(Measurement::LEN), random.below(8));
                if let Some(byte) = bytes.get_mut(at) {
                    *byte ^= 1 << bit;
                }
            }
            Measurement::LEN
        }
    }
}

fn set(bytes: &mut [u8], at: usize, value: &[u8]) {
    for (place, byte) in bytes.iter_mut().skip(at).zip(value) {
        *place = *byte;
    }
}
