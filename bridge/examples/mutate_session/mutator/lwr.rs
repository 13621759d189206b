//! The LWR.

use arms::{LWR_IV, LWR_IV_FLANGE, LWR_IV_STIFFNESS};
use bridge::lwr::Lwr;
use bridge::session::{Session, SessionConfig};
use controller_core::law::null_space::NullDamping;
use controller_core::{Axes, ControllerConfig, NullSpace, Task, TaskGains, TaskSet};
use fri::{
    Command, CommandPacket, ControlScheme, Error, Flags, InterfaceState, Measurement,
    MeasurementPacket, Quality,
};
use hostile::Random;

use super::Robot;

/// Largest torque on the wire: the limit of the strongest joint plus its gravity [Nm].
const TORQUE_MAX: f32 = 176.0 + 70.0;

/// Measurements before command state: until then another cycle makes another controller.
const MONITOR: u16 = 30;

/// A robot that hears what it is sent.
pub struct Kuka(Measurement);

fn put(bytes: &mut [u8], at: usize, value: &[u8]) {
    for (place, byte) in bytes.iter_mut().skip(at).zip(value) {
        *place = *byte;
    }
}

impl Robot for Kuka {
    type Protocol = Lwr;

    const HEADS: &'static [&'static str] = &["LWR"];
    const DAMAGES: &'static [&'static str] = &[
        "length", "counter", "code", "real", "joint", "period", "bits",
    ];
    const ERRORS: &'static [&'static str] = &["length", "id", "size", "code", "not finite"];
    // It gets an answer to everything that counts.
    const IMPOSSIBLE: &'static [usize] = &[3];

    fn new(_: usize) -> (Self, Session<Lwr>) {
        let flange = Task::position(LWR_IV_FLANGE, Axes::XYZ, TaskGains::uniform(400.0, 40.0));
        let controller = ControllerConfig {
            tasks: TaskSet::new(&[flange]).expect("a task that can be"),
            null_space: NullSpace {
                // Too much for the longest cycle that the robot may say.
                damping: NullDamping::Inertia(120.0),
                ..NullSpace::diagonal(LWR_IV_STIFFNESS, [1.0; 7])
            },
            observer_gain: [50.0; 7],
            cycle_s: 0.002,
            dead_cycles: 0,
        };
        let config = SessionConfig {
            doubted_max: 2,
            ..SessionConfig::new(&LWR_IV, controller, LWR_IV_FLANGE, 1e6)
        };
        let mut measurement = Measurement {
            state: InterfaceState::Monitor,
            quality: Quality::Perfect,
            period_s: 0.002,
            command_period_s: 0.002,
            joint_position: [0.0, 0.61, 0.0, -1.40, 0.35, 1.05, 0.0],
            ..Measurement::default()
        };
        measurement.drives.power = 0x7F;
        measurement.drives.control = ControlScheme::JointImpedance;
        (Self(measurement), Session::new(Lwr::new(), config))
    }

    fn report(&mut self, bytes: &mut Vec<u8>, random: &mut Random) {
        self.0.header.counter = self.0.header.counter.wrapping_add(1);
        if self.0.header.counter == MONITOR {
            self.0.state = InterfaceState::Command;
        }
        for q in &mut self.0.joint_position {
            *q += (random.below(2001) as f32 - 1000.0) * 1e-8;
        }
        let mut datagram = [0; Measurement::LEN];
        self.0.emit(&mut datagram);
        bytes.clear();
        bytes.extend(datagram);
    }

    fn damage(&self, bytes: &mut Vec<u8>, random: &mut Random) -> usize {
        let damage = random.pick(&[0, 1, 2, 3, 4, 5, 6, 6]);
        match damage {
            0 => bytes.resize(random.length(bytes.len(), Measurement::LEN + 16), 0),
            // It jumps.
            1 => put(bytes, 0, &(random.bits() as u16).to_le_bytes()),
            // State, quality, power, control scheme; size and id.
            2 => {
                let at = random.pick(&[4, 6, 144, 146, 180, 182]);
                put(bytes, at, &(random.below(5) as u16).to_le_bytes());
            }
            // Any bits: period, positions, models.
            3 => {
                let at = 140 + 4 * random.below((Measurement::LEN - 140) / 4);
                let any = random.bits();
                let bits = random.pick(&[any, any, f32::NAN.to_bits()]);
                put(bytes, at, &bits.to_le_bytes());
            }
            // It has moved more than a little.
            4 => {
                let at = 216 + 4 * random.below(7);
                let q = (random.below(2000) as f32 - 1000.0) * 1e-3;
                put(bytes, at, &q.to_le_bytes());
            }
            5 => {
                let period = random.pick(&[0.0005f32, 0.001, 0.004, 0.02, 0.05, -0.002]);
                put(bytes, 148, &period.to_le_bytes());
            }
            _ => random.flip(bytes),
        }
        damage
    }

    fn attend(&self, _: &mut Session<Lwr>) {}

    fn error(&self, bytes: &[u8]) -> Option<Error> {
        MeasurementPacket::new_checked(bytes).err()
    }

    fn row(error: Error) -> Option<usize> {
        Some(match error {
            Error::Length { .. } => 0,
            Error::Id { .. } => 1,
            Error::Size { .. } => 2,
            Error::Code { .. } => 3,
            Error::NotFinite { .. } => 4,
            _ => return None,
        })
    }

    fn hear(&mut self, answer: &[u8], in_command: bool) -> Result<bool, String> {
        let packet = CommandPacket::new_checked(answer).map_err(|error| error.to_string())?;
        let command = Command::parse(&packet);
        if command.flags != Flags::JOINT_IMPEDANCE {
            return Err(format!("flags {:?}", command.flags));
        }
        let torque = command.joint_torque;
        if torque.iter().any(|torque| torque.abs() > TORQUE_MAX) {
            return Err(format!("torque {torque:?} beyond the limits"));
        }
        let carries = torque.iter().any(|torque| *torque != 0.0);
        if carries && !in_command {
            return Err("torque outside command state".into());
        }
        self.0.header.reflected = command.header.counter;
        Ok(carries)
    }
}
