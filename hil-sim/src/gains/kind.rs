//! Kinds of levels, and what a level of each asks of the joints in a posture.

use controller_core::arm::dynamics::Dynamics;
use controller_core::arm::{ArmModel, ArmParameters};
use controller_core::joint::{DOF, JointMatrix, JointVector, Matrix3};
use controller_core::ranges::{JUMP, ORIENTATION_LENGTH};
use controller_core::task::LevelLimits;
use controller_core::{Axes, Task, TaskGains};
use nalgebra::{SMatrix, SymmetricEigen};

use crate::model::at_rest::at_rest;
use crate::model::search::highest;

/// What a level controls of the flange, all three axes of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Its position.
    Position,
    /// Its orientation.
    Orientation,
}

impl Kind {
    /// Both, in the order of their gains.
    pub const ALL: [Self; 2] = [Self::Position, Self::Orientation];

    /// "position".
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Orientation => "orientation",
        }
    }

    /// Largest error \[m\], \[rad\] that begins in one cycle: a target farther off is joined.
    #[must_use]
    pub fn jump(self) -> f64 {
        let [position, orientation] = JUMP;
        match self {
            Self::Position => position,
            Self::Orientation => orientation,
        }
    }

    /// Mobility \[1/kg\], \[1/(kg m2)\] below which a first level is driven less.
    fn drive_mobility(self) -> f64 {
        let position = LevelLimits::FIRST.drive_mobility;
        match self {
            Self::Position => position,
            Self::Orientation => position / (ORIENTATION_LENGTH * ORIENTATION_LENGTH),
        }
    }

    /// A task of this kind at the flange.
    #[must_use]
    pub fn task(self, arm: &ArmParameters, gains: TaskGains) -> Task {
        match self {
            Self::Position => Task::position(arm.flange_point(), Axes::XYZ, gains),
            Self::Orientation => Task::orientation(arm.flange_frame(), Axes::XYZ, gains),
        }
    }
}

/// A level of one kind in a posture, by itself and not near a singularity.
#[derive(Clone, Debug)]
pub struct Ask {
    /// The posture \[rad\].
    pub posture: [f64; DOF],
    /// Largest torque \[Nm\] of each joint for an acceleration of 1 m/s2 or 1 rad/s2 in any
    /// direction: |row i of J^T Lambda|.
    pub torque: JointVector<f64>,
    /// What of M the level feels, J^T Lambda J \[kg m2\].
    pub inertia: JointMatrix<f64>,
    /// Largest acceleration \[m/s2\], \[rad/s2\] by 1 Nm of each joint: |column j of J M^-1|.
    pub answer: JointVector<f64>,
    /// g \[Nm\].
    pub gravity: JointVector<f64>,
}

/// Rows of both kinds and M in a posture.
struct Look {
    dynamics: Dynamics<f64>,
    /// In the order of [`Kind::ALL`].
    jacobians: [SMatrix<f64, 3, DOF>; 2],
}

impl Look {
    fn new(model: &ArmModel<f64>, arm: &ArmParameters, q: &[f64; DOF]) -> Self {
        let (kinematics, dynamics) = at_rest(model, q);
        let flange = arm.flange_point();
        let motion = kinematics.point(flange.link, &flange.offset.into());
        let rows = [
            kinematics.point_jacobian(flange.link, &motion),
            kinematics.angular_jacobian(flange.link),
        ];
        let jacobians = rows.map(|rows| {
            let [x, y, z] = rows.jacobian.map(|row| row.transpose());
            SMatrix::from_rows(&[x, y, z])
        });
        Self {
            dynamics,
            jacobians,
        }
    }
}

/// Where position and orientation of the flange together are most mobile \[rad\], turns counted
/// at [`ORIENTATION_LENGTH`].
#[must_use]
pub fn most_mobile(model: &ArmModel<f64>, arm: &ArmParameters) -> [f64; DOF] {
    let mobility = |q: &[f64; DOF]| {
        let look = Look::new(model, arm, q);
        let mut rows = SMatrix::<f64, 6, DOF>::zeros();
        let [position, orientation] = look.jacobians;
        rows.fixed_rows_mut::<3>(0).copy_from(&position);
        let turns = orientation * ORIENTATION_LENGTH;
        rows.fixed_rows_mut::<3>(3).copy_from(&turns);
        let Some(factor) = look.dynamics.mass_matrix.cholesky() else {
            return 0.0;
        };
        let mobility = rows * factor.solve(&rows.transpose());
        SymmetricEigen::new(mobility).eigenvalues.min()
    };
    highest(arm, mobility).1
}

impl Ask {
    /// None where the level loses a direction.
    #[must_use]
    pub fn of(
        kind: Kind,
        model: &ArmModel<f64>,
        arm: &ArmParameters,
        q: &[f64; DOF],
    ) -> Option<Self> {
        let Look {
            dynamics,
            jacobians,
        } = Look::new(model, arm, q);
        let jacobian = jacobians[kind as usize];
        let answer = dynamics
            .mass_matrix
            .cholesky()?
            .solve(&jacobian.transpose())
            .transpose();
        let mobility: Matrix3<f64> = answer * jacobian.transpose();
        let least = SymmetricEigen::new(mobility).eigenvalues.min();
        if least < kind.drive_mobility() {
            return None;
        }
        let force = jacobian.transpose() * mobility.cholesky()?.inverse();
        Some(Self {
            posture: *q,
            torque: JointVector::from_fn(|joint, _| force.row(joint).norm()),
            inertia: force * jacobian,
            answer: JointVector::from_fn(|joint, _| answer.column(joint).norm()),
            gravity: dynamics.gravity,
        })
    }
}
