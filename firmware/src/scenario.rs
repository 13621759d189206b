//! The two scenarios that the target runs, as constants: the same as the
//! built-in scenarios of that name, which a test checks.

use arms::{LWR_IV, LWR_IV_DAMPING, LWR_IV_FLANGE, LWR_IV_STIFFNESS};
use controller_core::joint::{DOF, JointVector};
use controller_core::real::Real;
use controller_core::task::trajectory::{Plane, Trajectory};
use controller_core::{
    Axes, ConfigError, Controller, ControllerConfig, Link, LinkPoint, NullSpace, Reference, Target,
    Task, TaskGains, TaskSet,
};

/// Nominal cycle of both \[s\].
pub const CYCLE_S: f64 = 0.002;

/// One of the two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum FixedScenario {
    /// The flange follows a circle.
    TwoLevel = 0,
    /// The flange follows a circle, below it the wrist holds its place.
    Case1 = 1,
}

impl FixedScenario {
    /// Both.
    pub const ALL: [Self; 2] = [Self::TwoLevel, Self::Case1];

    /// The name of the scenario.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::TwoLevel => "two-level",
            Self::Case1 => "case-1",
        }
    }

    /// The scenario with this number.
    #[must_use]
    pub fn from_number(number: u8) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|&scenario| scenario as u8 == number)
    }

    /// Posture at the start \[deg\].
    #[must_use]
    pub fn start_deg(self) -> [f64; DOF] {
        match self {
            Self::TwoLevel => [0.0, 35.0, 0.0, -80.0, 20.0, 60.0, 0.0],
            Self::Case1 => [10.0, 30.0, 5.0, -85.0, 25.0, 50.0, 0.0],
        }
    }

    fn flange_circle(self) -> (f64, f64) {
        match self {
            Self::TwoLevel => (0.1, 6.0),
            Self::Case1 => (0.04, 5.0),
        }
    }
}

/// A scenario ready to run.
#[derive(Clone, Debug)]
pub struct ReadyScenario<T: Real> {
    /// The controller.
    pub controller: Controller<T>,
    /// The arm at the start: where the motions begin, and q_d.
    pub origin: Reference<T>,
    circle: Trajectory<T>,
}

/// Gains of both levels.
const GAINS: TaskGains = TaskGains::uniform(400.0, 40.0);

/// Flange, wrist.
const LEVELS: [Task; 2] = [
    Task::position(LWR_IV_FLANGE, Axes::XYZ, GAINS),
    Task::position(WRIST, Axes::XY, GAINS),
];

const WRIST: LinkPoint = LinkPoint {
    link: Link::L5,
    offset: [0.0; 3],
};

/// The configuration of a scenario, made in the caller's place for it.
///
/// # Errors
/// Never for these constants.
#[inline(never)]
pub fn config(scenario: FixedScenario) -> Result<ControllerConfig, ConfigError> {
    let tasks: &[Task] = match (scenario, &LEVELS) {
        (FixedScenario::TwoLevel, [flange, _]) => core::slice::from_ref(flange),
        (FixedScenario::Case1, both) => both,
    };
    Ok(ControllerConfig {
        tasks: TaskSet::new(tasks)?,
        null_space: NullSpace::diagonal(LWR_IV_STIFFNESS, LWR_IV_DAMPING),
        observer_gain: [50.0; DOF],
        cycle_s: CYCLE_S,
        dead_cycles: 0,
    })
}

/// The controller of a scenario, from the arm's tables on.
///
/// # Errors
/// Never for these constants.
pub fn controller<T: Real>(scenario: FixedScenario) -> Result<Controller<T>, ConfigError> {
    // The configuration stays in the result that brought it: taken out, it would lie on
    // the stack twice.
    match &config(scenario) {
        Ok(config) => Controller::new(&LWR_IV, config),
        Err(error) => Err(*error),
    }
}

impl<T: Real> ReadyScenario<T> {
    /// Builds the controller.
    ///
    /// # Errors
    /// Never for these constants.
    pub fn new(scenario: FixedScenario) -> Result<Self, ConfigError> {
        let controller = controller(scenario)?;
        let start = scenario.start_deg().map(f64::to_radians).map(T::from_f64);
        let (radius_m, period_s) = scenario.flange_circle();
        Ok(Self {
            origin: controller.rest_reference(&JointVector::from(start)),
            circle: Trajectory::Turn {
                plane: Plane::Yz,
                radius_m: T::from_f64(radius_m),
                period_s: T::from_f64(period_s),
                growth_s: T::from_f64(2.0),
            },
            controller,
        })
    }

    /// The reference of cycle `number`: circle at the first level, rest below it.
    #[must_use]
    pub fn reference(&self, number: u32) -> Reference<T> {
        self.moved(&self.origin, T::from_f64(f64::from(number) * CYCLE_S))
    }

    /// The reference at `t_s` \[s\] of the motion that begins at `origin`.
    #[must_use]
    pub fn moved(&self, origin: &Reference<T>, t_s: T) -> Reference<T> {
        let mut reference = origin.clone();
        if let Some(flange) = reference.targets_mut().first_mut()
            && let Target::Position { x, .. } = *flange
        {
            *flange = self.circle.sample(&x, t_s);
        }
        reference
    }
}
