//! What the state has while no motion runs: numbers that all differ, one error after the other.

use fci::reply::CartesianLimit;
use fci::request::Load;
use fci::robot::{Arm, EndEffector, IDENTITY, Limits, Motions, Settings};
use fci::state::FIELDS;
use fci::{RobotError, RobotMode, State, Version};

/// States in which one error is shown.
const SHOWN: u64 = 16;

/// The wall that there is.
const WALL: usize = 3;

/// The posture while a motion runs \[rad\].
const POSTURE: [f64; 7] = [0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785];

pub struct Shown {
    version: Version,
    state: State,
}

impl Shown {
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
        Self { version, state }
    }

    /// What clients set begins with these numbers too.
    pub fn settings(&self, version: Version) -> Settings {
        let state = &self.state;
        let limits = match version {
            Version::V5 => Limits::PANDA,
            _ => Limits::FR3,
        };
        let mut settings = Settings::new(version, limits);
        settings.motions = Motions::All;
        settings.end_effector = EndEffector {
            m_ee: state.m_ee,
            f_x_cee: state.f_x_cee,
            i_ee: state.i_ee,
            f_t_ne: IDENTITY,
        };
        settings.load = Load {
            m_load: state.m_load,
            f_x_cload: state.f_x_cload,
            i_load: state.i_load,
        };
        settings.ne_t_ee = state.ne_t_ee;
        settings.ee_t_k = state.ee_t_k;
        settings.walls[WALL] = Some(CartesianLimit {
            size: [0.25, 0.5, 0.75],
            frame: state.o_t_ee,
            active: true,
        });
        settings
    }

    /// A line for each field of reals, one for each enumeration.
    pub fn print(&self) {
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

    /// An arm at rest.
    pub fn arm(&self) -> Arm {
        Arm {
            q: POSTURE,
            dq: [0.0; 7],
            tau_j: [0.0; 7],
            tau_ext: [0.0; 7],
            wrench: [0.0; 6],
            o_t_f: IDENTITY,
            twist: [0.0; 6],
            theta: POSTURE,
            dtheta: [0.0; 7],
        }
    }

    /// The numbers, but for what clients have set; error i in the states i * `SHOWN` and behind,
    /// 40 - i as the reason; modes likewise.
    pub fn show(&self, state: &mut State) {
        let count = RobotError::all().count();
        let i = (state.message_id / SHOWN) as usize % count;
        let one = |i| RobotError::all().skip(i).take(1).collect();
        let modes = || RobotMode::all().filter(|&mode| mode != RobotMode::Reflex);
        *state = State {
            message_id: state.message_id,
            ne_t_ee: state.ne_t_ee,
            ee_t_k: state.ee_t_k,
            m_load: state.m_load,
            f_x_cload: state.f_x_cload,
            i_load: state.i_load,
            errors: one(i),
            reflex_reason: one(count - 1 - i),
            robot_mode: modes().nth(i % modes().count()).unwrap_or_default(),
            ..self.state
        };
    }
}
