//! The controllers that are compared on equal terms: the product's law and
//! others, all inside the core's cycle with its checks, observer and limits.

use controller_core::arm::dynamics::Dynamics;
use controller_core::cycle::Data;
use controller_core::joint::{JointMatrix, JointVector};
use controller_core::law::control::{Control, TorqueDemand};
use controller_core::law::hierarchy::Hierarchy;
use controller_core::law::motion::MotionSplit;
use controller_core::linalg::Cholesky;
use controller_core::ranges::EXACT_ROWS;

use cell::names::Named;

/// What controls the arm of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ControllerKind {
    /// A torque law.
    Torque(TorqueLaw),
    /// Velocity-level priorities (1)-(5) above the robot's own position controller.
    VelocityLevel,
}

impl From<TorqueLaw> for ControllerKind {
    fn from(law: TorqueLaw) -> Self {
        Self::Torque(law)
    }
}

impl Named for ControllerKind {
    const THING: &'static str = "controller";
    const ALL: &'static [(&'static str, Self)] = &[
        named(0),
        named(1),
        named(2),
        named(3),
        named(4),
        named(5),
        ("velocity-level", Self::VelocityLevel),
    ];
}

const fn named(index: usize) -> (&'static str, ControllerKind) {
    let (name, law) = TorqueLaw::ALL[index];
    (name, ControllerKind::Torque(law))
}

/// A torque law by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TorqueLaw {
    /// The product: strict priorities, compliant null space, residual
    /// compensated on the tasks.
    Hierarchical,
    /// The same with r = 0 in the law.
    NoObserver,
    /// (32)-(34) as printed, without the coupling between moving levels, but
    /// with the stable sign of the null-space stiffness.
    Literal,
    /// (32)-(34) as printed, with the printed sign: the null space is unstable.
    AsPrinted,
    /// Acceleration-level priorities (7)-(9), (12)-(14) with Moore-Penrose
    /// inverses: a null space with rate but without stiffness, and no estimate
    /// of the external torque.
    AccelerationLevel,
    /// The same with tau_est = -r.
    AccelerationLevelEstimate,
}

impl Named for TorqueLaw {
    const THING: &'static str = "controller";
    const ALL: &'static [(&'static str, Self)] = &[
        ("hierarchical", Self::Hierarchical),
        ("no-observer", Self::NoObserver),
        ("literal", Self::Literal),
        ("as-printed", Self::AsPrinted),
        ("acceleration-level", Self::AccelerationLevel),
        (
            "acceleration-level-estimate",
            Self::AccelerationLevelEstimate,
        ),
    ];
}

/// Gains that a law needs besides what the cycle has applied already.
#[derive(Clone, Copy, Debug)]
pub struct LawGains {
    /// K of (14) \[1/s\] per joint, for the acceleration-level laws.
    pub rate: JointVector<f64>,
    /// K_q \[Nm/rad\], for the law that reverses its sign.
    pub stiffness: JointMatrix<f64>,
}

/// A law's demand, split by priority.
#[derive(Clone, Debug)]
pub struct SplitDemand {
    /// Coordinates of the demand less C dq + g and the compensation that no
    /// level owns: task rows in priority order, then the null space.
    coordinates: JointVector<f64>,
    hierarchy: Hierarchy<f64>,
    /// Whether the coordinates are accelerations rather than whitened forces.
    accelerations: bool,
    /// Compensation \[Nm\] that no level owns.
    compensation: JointVector<f64>,
}

impl SplitDemand {
    /// The demanded torque \[Nm\].
    #[must_use]
    pub fn demand(&self, dynamics: &Dynamics<f64>) -> TorqueDemand<f64> {
        let torque =
            self.torque(dynamics, &self.coordinates) + dynamics.coriolis + dynamics.gravity;
        TorqueDemand(torque + self.compensation)
    }

    /// The part of the torque \[Nm\] that the levels below `level` (from 0) and the
    /// null space ask for.
    #[must_use]
    pub fn below(&self, dynamics: &Dynamics<f64>, level: usize) -> JointVector<f64> {
        let end = self.hierarchy.level_range(level).end;
        let mut lower = self.coordinates;
        lower.iter_mut().take(end).for_each(|entry| *entry = 0.0);
        self.torque(dynamics, &lower)
    }

    fn torque(&self, dynamics: &Dynamics<f64>, coordinates: &JointVector<f64>) -> JointVector<f64> {
        let turned = self.hierarchy.rotate_back(coordinates);
        if self.accelerations {
            dynamics.mass_matrix * turned
        } else {
            dynamics.cholesky.lower_times(&turned)
        }
    }
}

impl TorqueLaw {
    /// What this law decides.
    #[must_use]
    pub fn decide(self, data: &Data<f64>, gains: &LawGains) -> SplitDemand {
        match self {
            Self::Hierarchical => SplitDemand::levels(data, &data.control, data.residual()),
            Self::NoObserver => SplitDemand::levels(data, &data.control, &JointVector::zeros()),
            Self::Literal => literal(data, data.control.null_force),
            Self::AsPrinted => {
                let stiffness = gains.stiffness * (data.posture - data.joints.q);
                literal(data, data.control.null_force - stiffness * 2.0)
            }
            Self::AccelerationLevel => acceleration_level(data, gains, JointVector::zeros()),
            Self::AccelerationLevelEstimate => acceleration_level(data, gains, -data.residual()),
        }
    }

    /// The joint torque \[Nm\] by which the residual changes the demand.
    #[must_use]
    pub fn residual_compensation(self, data: &Data<f64>) -> JointVector<f64> {
        match self {
            Self::Hierarchical | Self::Literal | Self::AsPrinted => {
                let (hierarchy, cholesky) = (&data.hierarchy, &data.dynamics.cholesky);
                let whitened = hierarchy.rotate(&cholesky.solve_lower(data.residual()));
                let task = hierarchy.rotate_back(&hierarchy.task_part(&whitened));
                -cholesky.lower_times(&task)
            }
            Self::NoObserver | Self::AccelerationLevel => JointVector::zeros(),
            Self::AccelerationLevelEstimate => -data.residual(),
        }
    }
}

impl SplitDemand {
    /// The product's law with `residual` compensated on the tasks.
    fn levels(data: &Data<f64>, control: &Control<f64>, residual: &JointVector<f64>) -> Self {
        let (dynamics, hierarchy) = (&data.dynamics, &data.hierarchy);
        Self {
            coordinates: TorqueDemand::whitened(dynamics, hierarchy, control, residual),
            hierarchy: *hierarchy,
            accelerations: false,
            compensation: JointVector::zeros(),
        }
    }
}

/// (34) as printed: every level is given d(Jbar_i dq)/dt = its command, as if
/// the levels above it stood still.
fn literal(data: &Data<f64>, null_force: JointVector<f64>) -> SplitDemand {
    let mut acceleration = jbar_dot_dq(data);
    for (acceleration, commanded) in acceleration.iter_mut().zip(&data.rows.commanded) {
        *acceleration = commanded - *acceleration;
    }
    let control = Control {
        task_acceleration: data.hierarchy.solve_uncoupled(&acceleration),
        null_force,
    };
    SplitDemand::levels(data, &control, data.residual())
}

/// (dJbar_i/dt) dq per row \[m/s2\].
///
/// Jbar_i = J_i N with N = 1 - P the projector that the levels above leave, and
/// P = M^-1 J^T Lambda J of their stacked rows J. Differentiating P gives, with
/// F = Lambda J dq, w = P dq, n = N dq and u = M^-1 ((dJ/dt)^T F - (dM/dt) w),
/// (dN/dt) dq = -N u - J^# (dJ/dt) n, and dM/dt = C + C^T.
fn jbar_dot_dq(data: &Data<f64>) -> [f64; EXACT_ROWS] {
    let (rows, dynamics, dq) = (&data.rows, &data.dynamics, &data.joints.dq);
    let cholesky = &dynamics.cholesky;
    let mut bias = [0.0; EXACT_ROWS];
    bias.copy_from_slice(&rows.bias[..EXACT_ROWS]);
    for row in 0..rows.count() {
        let mut above = *rows;
        above.truncate(rows.level_start[row]);
        if above.count() == 0 {
            continue;
        }
        let (mut hierarchy, mut motion) = (Hierarchy::new(), MotionSplit::new());
        hierarchy.update(&above, cholesky);
        motion.update(dynamics, &hierarchy, &data.joints);
        let (w, n) = (motion.task_velocity, motion.null_velocity);
        let mut transport = -(dynamics.coriolis_matrix * w + dynamics.coriolis_transpose_times(&w));
        let mut turning = [0.0; EXACT_ROWS];
        for k in 0..above.count() {
            transport += rows.jacobian_dot[k] * motion.task_momentum[k];
            turning[k] = rows.jacobian_dot[k].dot(&n);
        }
        // N u in whitened coordinates is the null part of L^-1 (...).
        let free = hierarchy.null_part(&hierarchy.rotate(&cholesky.solve_lower(&transport)));
        let seen = hierarchy.solve(&turning);
        let projector_rate = -cholesky.solve_upper(&hierarchy.rotate_back(&(free + seen)));
        bias[row] = rows.jacobian_dot[row].dot(&(dq - w)) + rows.jacobian[row].dot(&projector_rate);
    }
    bias
}

/// (8) with the null space of (13), (14), dq_d = 0, for the stack J of all levels and
/// P = 1 - J^# J:
///
/// ```text
/// ddq = sum of (J_i P_i-1)^# (b_i - J_i sum ddq_j) - P K dq - P (dP/dt) dq
/// tau = M ddq + C dq + g
/// ```
///
/// P J^# = 0 leaves of the last term P (dJ/dt)^T (J J^T)^-1 J dq. The hierarchy of
/// Moore-Penrose inverses is the same row-ordered factorisation, of J = R Q_t instead of
/// J L^-T, so (J J^T)^-1 J dq = R^-T Q_t dq.
fn acceleration_level(
    data: &Data<f64>,
    gains: &LawGains,
    compensation: JointVector<f64>,
) -> SplitDemand {
    let mut hierarchy = Hierarchy::new();
    hierarchy.update(&data.rows, &Cholesky::identity());
    let dq = &data.joints.dq;
    let tasks = hierarchy.solve(&data.rows.acceleration());
    let turning = hierarchy.solve_transposed(&hierarchy.rotate(dq));
    let free = data.rows.rate_transposed_times(&turning) - gains.rate.component_mul(dq);
    SplitDemand {
        coordinates: hierarchy.joined(&tasks, &hierarchy.rotate(&free)),
        hierarchy,
        accelerations: true,
        compensation,
    }
}
