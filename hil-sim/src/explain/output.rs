//! Everything the law computed, as JSON.

use controller_core::cycle::Data;
use controller_core::joint::{DOF, JointMatrix, JointVector, Matrix3};
use controller_core::task::{Tracked, orientation};
use controller_core::{LinkPoint, Task};
use serde::Serialize;

use super::limits::WithinLimits;
use cell::scenario::EquippedArm;

/// A matrix as an array of rows.
type Rows = Vec<Vec<f64>>;

/// Every quantity of one cycle. SI units, base-plate frame.
#[derive(Clone, Debug, Serialize)]
#[expect(
    missing_docs,
    reason = "the fields bear the names of the glossary, docs/notation.md"
)]
pub struct Output {
    pub mass_matrix: Rows,
    pub coriolis_matrix: Rows,
    pub coriolis: Vec<f64>,
    pub gravity: Vec<f64>,
    pub levels: Vec<LevelOutput>,
    pub null_space: NullSpaceOutput,
    pub conditioning: Vec<f64>,
    pub residual: Vec<f64>,
    pub residual_compensation: Vec<f64>,
    pub torque_demand: Vec<f64>,
    pub torque: Vec<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub within_limits: Option<WithinLimits>,
}

/// One level.
#[derive(Clone, Debug, Serialize)]
pub struct LevelOutput {
    pub x: Vec<f64>,
    pub jacobian: Rows,
    pub jacobian_dot: Rows,
    pub jacobian_dot_dq: Vec<f64>,
    pub jbar: Rows,
    pub jbar_pinv: Rows,
    pub lambda: Rows,
    pub command: Vec<f64>,
}

/// What the levels leave free.
#[derive(Clone, Debug, Serialize)]
pub struct NullSpaceOutput {
    pub projector: Rows,
    pub basis: Rows,
    pub velocity: Vec<f64>,
}

impl Output {
    /// Collects the quantities.
    #[must_use]
    pub fn new(data: &Data<f64>, tasks: &[Task], residual_compensation: &JointVector<f64>) -> Self {
        let (dynamics, hierarchy) = (&data.dynamics, &data.hierarchy);
        let cholesky = &dynamics.cholesky;
        let levels = (0..)
            .zip(tasks)
            .map(|(level, task)| LevelOutput::new(data, level, task));
        Self {
            mass_matrix: square(&dynamics.mass_matrix),
            coriolis_matrix: square(&dynamics.coriolis_matrix),
            coriolis: list(&dynamics.coriolis),
            gravity: list(&dynamics.gravity),
            levels: levels.collect(),
            null_space: NullSpaceOutput {
                projector: square(&hierarchy.null_projector(cholesky)),
                basis: hierarchy.null_basis(cholesky).iter().map(list).collect(),
                velocity: hierarchy.null_velocity(cholesky, &data.joints.dq).to_vec(),
            },
            conditioning: hierarchy.conditioning()[..hierarchy.count()].to_vec(),
            residual: list(data.residual()),
            residual_compensation: list(residual_compensation),
            torque_demand: list(&data.demand.0),
            torque: list(&data.allocation.torque),
            within_limits: None,
        }
    }

    /// The same with torques, and all that leads to them, of the law within limits.
    #[must_use]
    pub fn within_limits(self, data: &Data<f64>, tasks: &[Task], arm: &EquippedArm) -> Self {
        Self {
            torque_demand: list(&data.demand.0),
            torque: list(&data.allocation.torque),
            within_limits: Some(WithinLimits::new(data, tasks, arm)),
            ..self
        }
    }
}

impl LevelOutput {
    fn new(data: &Data<f64>, level: usize, task: &Task) -> Self {
        let (rows, hierarchy) = (&data.rows, &data.hierarchy);
        let cholesky = &data.dynamics.cholesky;
        let range = hierarchy.level_range(level);
        let x = match task.tracked {
            Tracked::Position(LinkPoint { link, offset }) => {
                let position = data.kinematics.point(link, &offset.into()).x;
                (0..3)
                    .filter(|&axis| task.axes.contains(axis))
                    .map(|axis| position[axis])
                    .collect()
            }
            Tracked::Orientation(frame) => {
                let rotation = data.kinematics.link(frame.link).rotation
                    * Matrix3::from(frame.rotation).transpose();
                orientation::of_rotation(&rotation).as_slice().to_vec()
            }
        };
        let lambda = hierarchy.task_inertia(level);
        let pinv = hierarchy.jbar_pinv(level, cholesky);
        Self {
            x,
            jacobian: rows.jacobian[range.clone()].iter().map(list).collect(),
            jacobian_dot: rows.jacobian_dot[range.clone()].iter().map(list).collect(),
            jacobian_dot_dq: rows.bias[range.clone()].to_vec(),
            jbar: hierarchy.jbar(level, cholesky).iter().map(list).collect(),
            jbar_pinv: (0..DOF)
                .map(|i| pinv.iter().map(|column| column[i]).collect())
                .collect(),
            lambda: (0..range.len())
                .map(|i| (0..range.len()).map(|j| lambda[(i, j)]).collect())
                .collect(),
            command: rows.commanded[range].to_vec(),
        }
    }
}

fn list(vector: &JointVector<f64>) -> Vec<f64> {
    vector.iter().copied().collect()
}

fn square(matrix: &JointMatrix<f64>) -> Rows {
    matrix
        .row_iter()
        .map(|row| row.iter().copied().collect())
        .collect()
}
