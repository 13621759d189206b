//! Choices that have a name on the command line and in files.

use controller_core::arm::ArmParameters;

use crate::invalid::Invalid;
use crate::ranges::NAME_LETTERS;

/// Checks a name that may become one of a folder, a point or a constant.
///
/// # Errors
/// It is empty, too long, or has other letters than those.
pub fn simple(key: &str, given: &str) -> Result<(), Invalid> {
    let letter = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    if NAME_LETTERS.contains(given.len()) && given.chars().all(letter) {
        return Ok(());
    }
    Err(Invalid::new(key, given, letters()))
}

/// What such a name is made of.
#[must_use]
pub fn letters() -> String {
    format!("{NAME_LETTERS} letters, digits, '-' and '_'")
}

/// A closed set of named choices.
pub trait Named: Copy + 'static {
    /// What the choice is called, for messages.
    const THING: &'static str;
    /// Every choice with its name.
    const ALL: &'static [(&'static str, Self)];

    /// The choice called `name`.
    ///
    /// # Errors
    /// The known names, the nearest first.
    fn from_name(name: &str) -> Result<Self, Invalid> {
        let found = Self::ALL.iter().find(|(known, _)| *known == name);
        found.map(|&(_, choice)| choice).ok_or_else(|| {
            let known: Vec<_> = Self::ALL.iter().map(|(known, _)| *known).collect();
            Invalid::name(Self::THING, name, &known)
        })
    }

    /// The name of the choice.
    fn name(self) -> &'static str
    where
        Self: PartialEq,
    {
        Self::ALL
            .iter()
            .find(|(_, choice)| *choice == self)
            .map_or("", |(name, _)| name)
    }
}

/// How much of a real arm the plant imitates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlantKind {
    /// Exact model, no friction, no noise, true state measured.
    Ideal,
    /// Friction, mismatched masses, torque noise, encoders.
    Realistic,
}

impl Named for PlantKind {
    const THING: &'static str = "plant";
    const ALL: &'static [(&'static str, Self)] =
        &[("ideal", Self::Ideal), ("realistic", Self::Realistic)];
}

/// How stiff the null space is, relative to the scenario.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NullStiffness {
    /// A fifth.
    Low,
    /// As in the scenario.
    Normal,
    /// Four times.
    High,
}

impl NullStiffness {
    /// Factor on K_q.
    #[must_use]
    pub fn factor(self) -> f64 {
        match self {
            Self::Low => 0.2,
            Self::Normal => 1.0,
            Self::High => 4.0,
        }
    }
}

impl Named for NullStiffness {
    const THING: &'static str = "null stiffness";
    const ALL: &'static [(&'static str, Self)] = &[
        ("low", Self::Low),
        ("normal", Self::Normal),
        ("high", Self::High),
    ];
}

/// How the controller sees the arm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MeasurementKind {
    /// Position and speed as the plant gives them.
    #[default]
    Direct,
    /// The same under the conditions of the link: the arm is held before time 0, speeds are
    /// estimated from positions, and the robot adds gravity by itself.
    LikeFri,
    /// Positions in the datagrams of FRI, whatever the arm; speeds are estimated.
    Fri,
    /// What the robot that has this arm sends: Panda and FR3 states of the FCI, with speeds; any
    /// other as over FRI.
    Link,
}

impl MeasurementKind {
    /// The same with the link of `arm` by its name: [`MeasurementKind::Link`] is left where that is
    /// the FCI.
    #[must_use]
    pub fn of_arm(self, arm: &ArmParameters) -> Self {
        match self {
            Self::Link if RobotInterface::of(arm) == RobotInterface::Lwr => Self::Fri,
            other => other,
        }
    }
}

impl Named for MeasurementKind {
    const THING: &'static str = "measurement";
    const ALL: &'static [(&'static str, Self)] = &[
        ("direct", Self::Direct),
        ("like-fri", Self::LikeFri),
        ("fri", Self::Fri),
        ("link", Self::Link),
    ];
}

/// Which robot is at the other end of the link, by its interface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RobotInterface {
    /// KUKA's LWR, by the Fast Research Interface.
    #[default]
    Lwr,
    /// A Panda or FR3, by the Franka Control Interface.
    Fci,
}

impl RobotInterface {
    /// That of an arm, by the name of its table: arms without one of their own are led by FRI in
    /// simulation.
    #[must_use]
    pub fn of(arm: &ArmParameters) -> Self {
        let franka = [&arms::PANDA, &arms::PANDA_IDENTIFIED, &arms::FR3];
        if franka.iter().any(|own| own.name == arm.name) {
            Self::Fci
        } else {
            Self::Lwr
        }
    }
}

impl Named for RobotInterface {
    const THING: &'static str = "robot";
    const ALL: &'static [(&'static str, Self)] = &[("lwr", Self::Lwr), ("fci", Self::Fci)];
}

/// On or off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Switch(pub bool);

impl Named for Switch {
    const THING: &'static str = "switch";
    const ALL: &'static [(&'static str, Self)] = &[("on", Self(true)), ("off", Self(false))];
}
