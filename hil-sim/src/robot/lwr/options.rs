//! How the robot controller behaves where the protocol leaves it open. Every
//! number here is an assumption of this simulation, not a fact about a product.

use cell::invalid::Invalid;
use cell::names::Named;
use fri::ControlScheme;

/// Who decides that the answers move the robot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Krl {
    /// The robot, by itself, as soon as the link is good enough.
    #[default]
    Auto,
    /// The client, by user data: int\[1\] = 1 asks for command state with the
    /// strategy in int\[0\], int\[1\] = 0 gives it back.
    Handshake,
}

impl Named for Krl {
    const THING: &'static str = "KRL program";
    const ALL: &'static [(&'static str, Self)] =
        &[("auto", Self::Auto), ("handshake", Self::Handshake)];
}

/// The control schemes that this robot has:
///
/// - joint impedance: tau = k (q_cmd - q) - D dq + added torque + the robot's own dynamics;
/// - position: the arm follows q_cmd by stiff springs.
const SCHEMES: [(&str, ControlScheme); 2] = [
    ("joint-impedance", ControlScheme::JointImpedance),
    ("position", ControlScheme::Position),
];

/// The control scheme with this name.
///
/// # Errors
/// The names of those that this robot has.
pub fn scheme_named(name: &str) -> Result<ControlScheme, Invalid> {
    let found = SCHEMES.iter().find(|(known, _)| *known == name);
    found
        .map(|&(_, scheme)| scheme)
        .ok_or_else(|| Invalid::name("scheme", name, &SCHEMES.map(|(known, _)| known)))
}

/// The control scheme of a strategy number as user data carry it; the error is one line.
pub(super) fn scheme_of_strategy(strategy: i32) -> Result<ControlScheme, String> {
    let what = match strategy {
        10 => return Ok(ControlScheme::Position),
        30 => return Ok(ControlScheme::JointImpedance),
        20 => " (Cartesian impedance)",
        _ => "",
    };
    Err(format!(
        "strategy {strategy}{what} is not supported; allowed: 10 position, 30 joint impedance"
    ))
}

/// Stiffness of the position scheme \[Nm/rad\].
pub const POSITION_STIFFNESS: f64 = 2e4;

/// What the robot adds to the commanded torque from its own model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RobotAdds {
    /// g(q).
    #[default]
    Gravity,
    /// g(q) + C dq, with dq from its own position sensors.
    GravityCoriolis,
}

impl Named for RobotAdds {
    const THING: &'static str = "robot adds";
    const ALL: &'static [(&'static str, Self)] = &[
        ("gravity", Self::Gravity),
        ("gravity-coriolis", Self::GravityCoriolis),
    ];
}

/// From answers to a quality level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RatingOptions {
    /// Least share of answers in time for each level.
    pub perfect_rate: f64,
    /// See `perfect_rate`.
    pub ok_rate: f64,
    /// See `perfect_rate`; below it the link is unacceptable.
    pub bad_rate: f64,
    /// Largest jitter of a perfect link, as a share of the cycle.
    pub perfect_jitter: f64,
    /// More missing answers in a row make the link unacceptable.
    pub misses_max: u32,
}

impl Default for RatingOptions {
    fn default() -> Self {
        Self {
            perfect_rate: 0.99,
            ok_rate: 0.95,
            bad_rate: 0.80,
            perfect_jitter: 0.25,
            misses_max: 10,
        }
    }
}

/// The whole behaviour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RobotOptions {
    /// Who decides on command state.
    pub krl: Krl,
    /// What answers command, unless the client chooses by handshake.
    pub scheme: ControlScheme,
    /// What the robot adds to the commanded torque.
    pub adds: RobotAdds,
    /// How answers are rated.
    pub rating: RatingOptions,
    /// How long the link must be ok before command state \[s\].
    pub good_for_s: f64,
    /// Largest distance of jntPos from the commanded position on entry \[rad\].
    pub entry_position_rad: f64,
    /// Largest added torque on entry \[Nm\].
    pub entry_torque_nm: f64,
    /// Speed limit of jntPos over the data sheet's.
    pub speed_factor: f64,
    /// Largest added torque over the joint's limit: more is damage, not an order.
    pub torque_factor: f64,
    /// Largest jump of jntPos from the measured position on joints without
    /// stiffness, where it moves nothing \[rad\].
    pub jump_rad: f64,
    /// Stiffness where the answer sets none, and of the hold \[Nm/rad\].
    pub stiffness: f64,
    /// Damping ratio where the answer sets none, and of the hold.
    pub damping: f64,
    /// Stiffness of the position scheme \[Nm/rad\].
    pub position_stiffness: f64,
    /// In which one way of driving replaces another \[s\].
    pub fade_s: f64,
    /// From the first datagram with command state to scenario time 0 \[s\].
    pub settle_s: f64,
    /// Scenario time during which the drives are off \[s\].
    pub drives_off_s: Option<[f64; 2]>,
}

impl Default for RobotOptions {
    fn default() -> Self {
        Self {
            krl: Krl::Auto,
            scheme: ControlScheme::JointImpedance,
            adds: RobotAdds::Gravity,
            rating: RatingOptions::default(),
            good_for_s: 0.2,
            entry_position_rad: 5e-3,
            entry_torque_nm: 1.0,
            speed_factor: 1.1,
            torque_factor: 2.0,
            jump_rad: 0.1,
            stiffness: 1000.0,
            damping: 0.7,
            position_stiffness: POSITION_STIFFNESS,
            fade_s: 0.1,
            settle_s: 1.0,
            drives_off_s: None,
        }
    }
}
