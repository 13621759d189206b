//! The core's cycle laid open at one state, and the same state as plain numbers
//! for the oracle.

use controller_core::config::ControllerConfig;
use controller_core::dynamics::Dynamics;
use controller_core::hierarchy::Hierarchy;
use controller_core::joint::{DOF, JointState, JointVector, Vector3};
use controller_core::kinematics::{Kinematics, LinkPoint};
use controller_core::law::{Command, Cycle, NullDamping, NullSpace, TaskMotion, TorqueDemand};
use controller_core::model::ArmModel;
use controller_core::real::Real;
use controller_core::task::{Axes, Task, TaskKind, TaskReference, TaskRows};

use super::{LevelTerms, Matrix, Terms};
use crate::config::{ELBOW, FLANGE, Point, WRIST};
use crate::random::States;

/// One level of a split: what it tracks, where, along or about which axes.
pub type Spec = (TaskKind, Point, &'static str);

const POSITION: TaskKind = TaskKind::Position;
const ORIENTATION: TaskKind = TaskKind::Orientation;

/// Splits of 1 to 7 rows into 1 to 7 levels that the arm can follow.
pub const SPLITS: [(&str, &[Spec]); 12] = [
    ("3", &[(POSITION, FLANGE, "xyz")]),
    ("3+2", &[(POSITION, FLANGE, "xyz"), (POSITION, WRIST, "xy")]),
    ("1", &[(POSITION, FLANGE, "y")]),
    ("2", &[(POSITION, WRIST, "xz")]),
    (
        "1+1+1",
        &[
            (POSITION, FLANGE, "x"),
            (POSITION, WRIST, "y"),
            (POSITION, ELBOW, "z"),
        ],
    ),
    ("2+2", &[(POSITION, ELBOW, "xy"), (POSITION, FLANGE, "yz")]),
    (
        "3+1",
        &[(POSITION, FLANGE, "xyz"), (ORIENTATION, FLANGE, "z")],
    ),
    (
        "3+3",
        &[(POSITION, FLANGE, "xyz"), (ORIENTATION, FLANGE, "xyz")],
    ),
    (
        "3+3+1",
        &[
            (POSITION, FLANGE, "xyz"),
            (ORIENTATION, FLANGE, "xyz"),
            (POSITION, ELBOW, "y"),
        ],
    ),
    (
        "2+2+3",
        &[
            (POSITION, ELBOW, "xy"),
            (POSITION, WRIST, "xy"),
            (ORIENTATION, FLANGE, "xyz"),
        ],
    ),
    (
        "2+1+2",
        &[
            (POSITION, WRIST, "yz"),
            (POSITION, FLANGE, "x"),
            (ORIENTATION, FLANGE, "xy"),
        ],
    ),
    (
        "1+1+1+1+1+1+1",
        &[
            (POSITION, FLANGE, "z"),
            (ORIENTATION, FLANGE, "x"),
            (POSITION, FLANGE, "y"),
            (ORIENTATION, FLANGE, "z"),
            (POSITION, ELBOW, "x"),
            (POSITION, FLANGE, "x"),
            (ORIENTATION, FLANGE, "y"),
        ],
    ),
];

/// The reference configuration on a split, with gains that are no multiples of
/// the identity, so that nothing hides behind symmetry.
#[must_use]
pub fn configuration<T: Real>(split: &[Spec]) -> ControllerConfig<T> {
    let mut config = crate::config::two_level();
    config.tasks = split
        .iter()
        .map(|&(kind, (link, offset), axes)| {
            let point = LinkPoint {
                link,
                offset: offset.map(T::from_f64).into(),
            };
            let axes = Axes::from_name(axes).expect("axes of a split");
            let mut task = Task::diagonal(point, axes, [400.0, 250.0, 100.0], [40.0, 30.0, 20.0]);
            for (i, j, coupling) in [(0, 1, 20.0), (1, 2, -15.0)] {
                task.stiffness[(i, j)] = T::from_f64(coupling);
                task.stiffness[(j, i)] = T::from_f64(coupling);
            }
            Task { kind, ..task }
        })
        .collect();
    for i in 1..DOF {
        let coupling = T::from_f64(0.01 * i as f64);
        config.null_space.stiffness[(i, i - 1)] = coupling;
        config.null_space.stiffness[(i - 1, i)] = coupling;
        if let NullDamping::Joint(damping) = &mut config.null_space.damping {
            damping[(i, i - 1)] = -coupling * T::HALF;
            damping[(i - 1, i)] = -coupling * T::HALF;
        }
    }
    config
}

/// One cycle of the core at one state.
#[derive(Clone, Debug)]
pub struct Sample {
    /// q, dq.
    pub state: JointState<f64>,
    /// Of the core.
    pub kinematics: Kinematics<f64>,
    /// Of the core.
    pub dynamics: Dynamics<f64>,
    /// Of the core.
    pub rows: TaskRows<f64>,
    /// Of the core.
    pub hierarchy: Hierarchy<f64>,
    /// Of the core.
    pub motion: TaskMotion<f64>,
    /// q_d.
    pub posture: JointVector<f64>,
    /// Of the core.
    pub command: Command<f64>,
    /// r.
    pub residual: JointVector<f64>,
    null_space: NullSpace<f64>,
}

/// What a cycle is asked to do.
#[derive(Clone, Debug)]
pub struct Wish {
    /// Reference per level.
    pub tasks: Vec<TaskReference<f64>>,
    /// q_d.
    pub posture: JointVector<f64>,
    /// r.
    pub residual: JointVector<f64>,
}

impl Wish {
    /// A reference some centimetres and some cm/s off, a posture 0.5 rad off, a
    /// residual of some Nm.
    #[must_use]
    pub fn random(
        model: &ArmModel<f64>,
        config: &ControllerConfig<f64>,
        state: &JointState<f64>,
        random: &mut States,
    ) -> Self {
        let kinematics = Kinematics::new(model, state);
        let tasks = config.tasks.iter().map(|task| {
            let mut vector = |size: f64| {
                Vector3::from([random.signed(), random.signed(), random.signed()]) * size
            };
            let motion = kinematics.point(&task.point);
            TaskReference {
                dx: motion.dx + vector(0.2),
                ddx: vector(2.0),
                ..TaskReference::rest(motion.x + vector(0.1))
            }
        });
        Self {
            tasks: tasks.collect(),
            posture: state.q + random.vector() * 0.5,
            residual: random.vector() * 5.0,
        }
    }
}

impl Sample {
    /// Runs the stages of the core in the order of its cycle.
    #[must_use]
    pub fn new(
        model: &ArmModel<f64>,
        config: &ControllerConfig<f64>,
        state: JointState<f64>,
        wish: &Wish,
    ) -> Self {
        let (kinematics, dynamics) = crate::evaluate(model, &state);
        let rows = TaskRows::new(&config.tasks, &wish.tasks, &kinematics, &state);
        let hierarchy = Hierarchy::new(&rows, &dynamics.cholesky);
        let motion = TaskMotion::new(&dynamics, &hierarchy, &state);
        let command = Command::new(
            &config.null_space,
            &dynamics,
            &rows,
            &hierarchy,
            &motion,
            &state,
            &wish.posture,
        );
        Self {
            state,
            kinematics,
            dynamics,
            rows,
            hierarchy,
            motion,
            posture: wish.posture,
            command,
            residual: wish.residual,
            null_space: config.null_space,
        }
    }

    /// As the law sees it.
    #[must_use]
    pub fn cycle(&self) -> Cycle<'_, f64> {
        Cycle {
            state: &self.state,
            kinematics: &self.kinematics,
            dynamics: &self.dynamics,
            rows: &self.rows,
            hierarchy: &self.hierarchy,
            motion: &self.motion,
            posture: &self.posture,
            command: &self.command,
            residual: &self.residual,
        }
    }

    /// The core's torque before limits.
    #[must_use]
    pub fn demand(&self) -> JointVector<f64> {
        TorqueDemand::hierarchical(&self.cycle()).0
    }

    /// The same state as numbers.
    #[must_use]
    pub fn terms(&self) -> Terms {
        terms(&self.cycle(), &self.null_space)
    }
}

/// The numbers of a cycle that the paper's formulas start from.
#[must_use]
pub fn terms(cycle: &Cycle<'_, f64>, null_space: &NullSpace<f64>) -> Terms {
    let (rows, dynamics) = (cycle.rows, cycle.dynamics);
    let starts: Vec<usize> = (0..rows.count())
        .filter(|&row| rows.level_start[row] == row)
        .chain([rows.count()])
        .collect();
    let levels = starts.windows(2).map(|range| LevelTerms {
        jacobian: Matrix::from_rows(&rows.jacobian[range[0]..range[1]]),
        jacobian_dot: Matrix::from_rows(&rows.jacobian_dot[range[0]..range[1]]),
        wanted: Matrix::column(&rows.wanted[range[0]..range[1]]),
    });
    let mass = Matrix::of(&dynamics.mass_matrix);
    let damping = match null_space.damping {
        NullDamping::Joint(damping) => Matrix::of(&damping),
        NullDamping::Inertia(rate) => mass.scaled(rate),
    };
    Terms {
        coriolis: Matrix::of(&dynamics.coriolis_matrix),
        gravity: Matrix::of(&dynamics.gravity),
        dq: Matrix::of(&cycle.state.dq),
        posture_error: Matrix::of(&(cycle.posture - cycle.state.q)),
        stiffness: Matrix::of(&null_space.stiffness),
        damping,
        residual: Matrix::of(cycle.residual),
        levels: levels.collect(),
        mass,
    }
}
