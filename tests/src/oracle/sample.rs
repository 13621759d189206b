//! The core's cycle laid open at one state, and the same state as plain numbers
//! for the oracle.

use controller_core::cycle::{Data, Input};
use controller_core::joint::{DOF, JointState, JointVector, Vector3};
use controller_core::law::null_space::{Compliance, Damping, NullDamping};
use controller_core::task::{Tracked, orientation};
use controller_core::{
    Axes, Controller, ControllerConfig, Link, Measurement, Reference, Target, Task, TaskGains,
};

use super::{LevelTerms, Matrix, Terms};
use crate::config::{ELBOW, FLANGE, WRIST, two_level, with_tasks};
use crate::random::States;

/// One level of a split: what it tracks, along or about which axes.
pub type Spec = (Tracked, &'static str);

const FLANGE_POSITION: Tracked = Tracked::Position(FLANGE);
const FLANGE_ORIENTATION: Tracked = Tracked::Orientation(Link::L7.frame());
const WRIST_POSITION: Tracked = Tracked::Position(WRIST);
const ELBOW_POSITION: Tracked = Tracked::Position(ELBOW);

/// Splits of 1 to 7 rows into 1 to 7 levels that the arm can follow.
pub const SPLITS: [(&str, &[Spec]); 12] = [
    ("3", &[(FLANGE_POSITION, "xyz")]),
    ("3+2", &[(FLANGE_POSITION, "xyz"), (WRIST_POSITION, "xy")]),
    ("1", &[(FLANGE_POSITION, "y")]),
    ("2", &[(WRIST_POSITION, "xz")]),
    (
        "1+1+1",
        &[
            (FLANGE_POSITION, "x"),
            (WRIST_POSITION, "y"),
            (ELBOW_POSITION, "z"),
        ],
    ),
    ("2+2", &[(ELBOW_POSITION, "xy"), (FLANGE_POSITION, "yz")]),
    (
        "3+1",
        &[(FLANGE_POSITION, "xyz"), (FLANGE_ORIENTATION, "z")],
    ),
    (
        "3+3",
        &[(FLANGE_POSITION, "xyz"), (FLANGE_ORIENTATION, "xyz")],
    ),
    (
        "3+3+1",
        &[
            (FLANGE_POSITION, "xyz"),
            (FLANGE_ORIENTATION, "xyz"),
            (ELBOW_POSITION, "y"),
        ],
    ),
    (
        "2+2+3",
        &[
            (ELBOW_POSITION, "xy"),
            (WRIST_POSITION, "xy"),
            (FLANGE_ORIENTATION, "xyz"),
        ],
    ),
    (
        "2+1+2",
        &[
            (WRIST_POSITION, "yz"),
            (FLANGE_POSITION, "x"),
            (FLANGE_ORIENTATION, "xy"),
        ],
    ),
    (
        "1+1+1+1+1+1+1",
        &[
            (FLANGE_POSITION, "z"),
            (FLANGE_ORIENTATION, "x"),
            (FLANGE_POSITION, "y"),
            (FLANGE_ORIENTATION, "z"),
            (ELBOW_POSITION, "x"),
            (FLANGE_POSITION, "x"),
            (FLANGE_ORIENTATION, "y"),
        ],
    ),
];

/// Task gains that are no multiples of the identity.
const COUPLED_GAINS: TaskGains = TaskGains {
    stiffness: [
        [400.0, 20.0, 0.0],
        [20.0, 250.0, -15.0],
        [0.0, -15.0, 100.0],
    ],
    ..TaskGains::diagonal([0.0; 3], [40.0, 30.0, 20.0])
};

/// The reference configuration on a split, with gains that are no multiples of
/// the identity, so that nothing hides behind symmetry.
#[must_use]
pub fn configuration(split: &[Spec]) -> ControllerConfig {
    let task = |&(tracked, axes): &Spec| Task {
        tracked,
        axes: Axes::from_name(axes).expect("axes of a split"),
        gains: COUPLED_GAINS,
        limits: None,
        stale: None,
    };
    let tasks: Vec<_> = split.iter().map(task).collect();
    let mut null_space = two_level().null_space;
    for i in 1..DOF {
        let coupling = 0.01 * i as f64;
        null_space.stiffness[i][i - 1] = coupling;
        null_space.stiffness[i - 1][i] = coupling;
        if let NullDamping::Joint(damping) = &mut null_space.damping {
            damping[i][i - 1] = -coupling / 2.0;
            damping[i - 1][i] = -coupling / 2.0;
        }
    }
    ControllerConfig {
        null_space,
        ..with_tasks(&tasks)
    }
}

/// One cycle of the core at one state.
#[derive(Clone, Debug)]
pub struct Sample {
    /// Every result of the core.
    pub data: Data<f64>,
    compliance: Compliance<f64>,
}

/// What a cycle is asked to do.
#[derive(Clone, Debug)]
pub struct Wish {
    /// A target per level, and q_d.
    pub reference: Reference<f64>,
    /// r.
    pub residual: JointVector<f64>,
}

impl Wish {
    /// A reference some centimetres and some cm/s off, orientations any angle off, a
    /// posture 0.5 rad off, a residual of some Nm.
    #[must_use]
    pub fn random(
        controller: &Controller<f64>,
        joints: &JointState<f64>,
        random: &mut States,
    ) -> Self {
        let mut reference = controller.moving_reference(joints);
        for target in reference.targets_mut() {
            let mut vector = |size: f64| {
                Vector3::from([random.signed(), random.signed(), random.signed()]) * size
            };
            match target {
                Target::Position { x, dx, ddx } => {
                    *dx += vector(0.2);
                    *ddx += vector(2.0);
                    *x += vector(0.1);
                }
                Target::Orientation { q, w, dw } => {
                    *w += vector(0.2);
                    *dw += vector(2.0);
                    let turn = vector(3.0);
                    let turn = orientation::about_axis(&turn.normalize(), turn.norm());
                    *q = orientation::product(&turn, q);
                }
                Target::Hold => {}
            }
        }
        reference.posture += random.vector() * 0.5;
        Self {
            reference,
            residual: random.vector() * 5.0,
        }
    }

    /// Levels that hold where they are, q_d = `posture` \[rad\], r = 0.
    #[must_use]
    pub fn rest(controller: &Controller<f64>, posture: JointVector<f64>) -> Self {
        Self {
            reference: Reference::hold(controller.level_count(), posture),
            residual: JointVector::zeros(),
        }
    }
}

impl Sample {
    /// One cycle of the core from nothing remembered, the residual that of the wish.
    #[must_use]
    pub fn new(controller: &Controller<f64>, joints: JointState<f64>, wish: &Wish) -> Self {
        let JointState { q, dq } = joints;
        let mut data = Data::new();
        // An observer that has not started keeps its residual.
        data.observer.residual = wish.residual;
        let measurement = Measurement {
            q,
            dq,
            interval_s: 0.002,
        };
        let input = Input {
            measurement: &measurement,
            reference: &wish.reference,
        };
        controller.evaluate(&input, &mut data);
        Self {
            data,
            compliance: *controller.compliance(),
        }
    }

    /// The same state as numbers.
    #[must_use]
    pub fn terms(&self) -> Terms {
        terms(&self.compliance, &self.data)
    }
}

/// The numbers of a cycle that the paper's formulas start from.
#[must_use]
pub fn terms(compliance: &Compliance<f64>, data: &Data<f64>) -> Terms {
    let (rows, dynamics) = (&data.rows, &data.dynamics);
    let starts: Vec<usize> = (0..rows.count())
        .filter(|&row| rows.level_start[row] == row)
        .chain([rows.count()])
        .collect();
    let levels = starts.windows(2).map(|range| LevelTerms {
        jacobian: Matrix::from_rows(&rows.jacobian[range[0]..range[1]]),
        jacobian_dot: Matrix::from_rows(&rows.jacobian_dot[range[0]..range[1]]),
        commanded: Matrix::column(&rows.commanded[range[0]..range[1]]),
    });
    let mass = Matrix::of(&dynamics.mass_matrix);
    let damping = match compliance.damping {
        Damping::Joint(damping) => Matrix::of(&damping),
        Damping::Inertia(rate) => mass.scaled(rate),
    };
    Terms {
        coriolis: Matrix::of(&dynamics.coriolis_matrix),
        gravity: Matrix::of(&dynamics.gravity),
        dq: Matrix::of(&data.joints.dq),
        posture_error: Matrix::of(&(data.posture - data.joints.q)),
        stiffness: Matrix::of(&compliance.stiffness),
        damping,
        residual: Matrix::of(data.residual()),
        levels: levels.collect(),
        mass,
    }
}
