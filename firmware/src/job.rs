//! The two experiments that the target runs, as constants: the same as the
//! built-in scenarios of that name, which a test checks.

use controller_core::config::{ConfigError, ControllerConfig};
use controller_core::controller::Controller;
use controller_core::joint::{DOF, JointVector, Vector3, diagonal};
use controller_core::kinematics::LinkPoint;
use controller_core::law::{NullDamping, NullSpace, Posture};
use controller_core::measurement::Reference;
use controller_core::model::{ArmModel, LWR_IV};
use controller_core::real::Real;
use controller_core::task::{Axes, Task};
use controller_core::trajectory::{Plane, Trajectory};
use heapless::Vec;

/// Nominal cycle of both \[s\].
pub const CYCLE_S: f64 = 0.002;

/// A built-in experiment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum JobKind {
    /// The flange follows a circle.
    TwoLevel = 0,
    /// The flange follows a circle, below it the wrist holds its place.
    Case1 = 1,
}

impl JobKind {
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

    /// The job with this number.
    #[must_use]
    pub fn from_number(number: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|&kind| kind as u8 == number)
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

/// An experiment ready to run.
#[derive(Clone, Debug)]
pub struct Job<T: Real> {
    /// The controller.
    pub controller: Controller<T>,
    /// The arm at the start: where the motions begin, and q_d.
    pub origin: Reference<T>,
    circle: Trajectory<T>,
}

/// The configuration of an experiment, made in the caller's place for it.
#[must_use]
#[inline(never)]
pub fn config<T: Real>(kind: JobKind) -> ControllerConfig<T> {
    let task = |link, offset: [f64; 3], axes| {
        let offset = Vector3::from(offset.map(T::from_f64));
        Task::uniform(LinkPoint { link, offset }, axes, 400.0, 40.0)
    };
    let mut config = ControllerConfig {
        tasks: Vec::new(),
        null_space: NullSpace {
            stiffness: diagonal([20.0, 20.0, 15.0, 15.0, 3.0, 2.0, 0.2]),
            damping: NullDamping::Joint(diagonal([4.0, 4.0, 3.0, 3.0, 0.4, 0.3, 0.03])),
            posture: Posture::Constant,
        },
        observer_gain: JointVector::from([T::from_f64(50.0); DOF]),
        cycle_s: T::from_f64(CYCLE_S),
        dead_cycles: 0,
    };
    // There is a place for every level.
    let flange = task(7, [0.0, 0.0, LWR_IV.flange], Axes::XYZ);
    let _ = config.tasks.push(flange);
    if kind == JobKind::Case1 {
        let _ = config.tasks.push(task(5, [0.0; 3], Axes::XY));
    }
    config
}

/// The controller of an experiment, from the arm's tables on.
///
/// # Errors
/// Never for these constants.
pub fn controller<T: Real>(kind: JobKind) -> Result<Controller<T>, ConfigError> {
    // The model stays in the result that brought it: taken out, it would lie on the
    // stack twice.
    match &ArmModel::new(&LWR_IV) {
        Ok(model) => Controller::new(model, &config(kind)),
        Err(error) => Err((*error).into()),
    }
}

impl<T: Real> Job<T> {
    /// Builds the controller.
    ///
    /// # Errors
    /// Never for these constants.
    pub fn new(kind: JobKind) -> Result<Self, ConfigError> {
        let controller = controller(kind)?;
        let start = kind.start_deg().map(f64::to_radians).map(T::from_f64);
        let (radius_m, period_s) = kind.flange_circle();
        Ok(Self {
            origin: controller.rest(&JointVector::from(start)),
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
        if let Some(flange) = reference.tasks.first_mut() {
            *flange = self.circle.sample(&flange.x, t_s);
        }
        reference
    }
}
