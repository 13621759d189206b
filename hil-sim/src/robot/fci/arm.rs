//! The simulated arm as the robot's end of the FCI sees it, and what that end is set to for it.

use controller_core::arm::{ArmParameters, Tool};
use controller_core::joint::{JointVector, Vector3};
use fci::robot::{Approach, Arm, EndEffector, Limits};
use fci::state::Pose;

use crate::robot::control_box::Seen;
use crate::robot::model::{Frame, Jacobian, RobotModel};

/// What is watched: as the table says; range of the torque sensors as of the interface.
pub fn limits(arm: &ArmParameters) -> Limits {
    let links = &arm.links;
    Limits {
        position: links.map(|link| link.position_range),
        speed: links.map(|link| link.speed_limit),
        approach: links.map(|link| {
            link.end_approach.map(|approach| Approach {
                offset: approach.margin,
                deceleration: approach.deceleration,
                ends: approach.ends,
            })
        }),
        torque: links.map(|link| link.torque_limit),
        ..if links.iter().any(|link| link.end_approach.is_some()) {
            Limits::FR3
        } else {
            Limits::PANDA
        }
    }
}

/// The tool of a scenario, as the vendor's web interface would say it.
pub fn end_effector(tool: &Tool) -> EndEffector {
    let turned = |[a, b, c]: [f64; 3]| {
        let column = tool
            .pose
            .rotation
            .map(|row| row[0] * a + row[1] * b + row[2] * c);
        Vector3::from(column)
    };
    let [xx, xy, xz, yy, yz, zz] = tool.inertia;
    // R I R^T, column by column: both are symmetric.
    let half = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]].map(turned);
    let rows: [[f64; 3]; 3] = std::array::from_fn(|i| half.map(|column| column[i]));
    let inertia = rows.map(|row| <[f64; 3]>::from(turned(row)));
    let mut i_ee = [0.0; 9];
    i_ee.copy_from_slice(inertia.as_flattened());
    let [x, y, z] = tool.pose.shift;
    let [[a, d, g], [b, e, h], [c, f, i]] = tool.pose.rotation;
    EndEffector {
        m_ee: tool.mass,
        f_x_cee: tool.pose.place(tool.com),
        i_ee,
        f_t_ne: [a, b, c, 0.0, d, e, f, 0.0, g, h, i, 0.0, x, y, z, 1.0],
    }
}

/// Rows of a frame, column by column.
fn pose(frame: &Frame) -> Pose {
    std::array::from_fn(|i| match (i % 4, i / 4) {
        (3, column) => f64::from(u8::from(column == 3)),
        (row, column) => frame[4 * row + column],
    })
}

/// X Y Z of the velocity or force, then about Z, Y, X, as the model has them: about X, Y, Z.
fn in_order(six: impl Fn(usize) -> f64) -> [f64; 6] {
    [0, 1, 2, 5, 4, 3].map(six)
}

/// What sensors and the robot's model say; `applied` \[Nm\] is what the motors gave.
pub fn report(
    model: &RobotModel,
    seen: &Seen,
    applied: &JointVector<f64>,
    motors: [[f64; 7]; 2],
) -> Arm {
    let (q, dq) = (seen.measured.q, seen.measured.dq);
    let jacobian = model.jacobian(&q);
    let wrench = RobotModel::flange_wrench(&jacobian, &seen.contact);
    let twist = jacobian * dq;
    let [theta, dtheta] = motors;
    Arm {
        q: q.into(),
        dq: dq.into(),
        tau_j: (*applied).into(),
        // What the arm exerts on others, not they on it.
        tau_ext: (-seen.contact).into(),
        wrench: in_order(|i| -wrench[i]),
        o_t_f: pose(&model.frame(&q)),
        twist: in_order(|i| twist[i]),
        theta,
        dtheta,
    }
}

/// What holds a load of `mass` \[kg\] whose centre is at `com` in the flange frame \[m\] against
/// `gravity` \[m/s2\]: joint torque \[Nm\].
pub fn holding(
    jacobian: &Jacobian,
    frame: &Frame,
    [mass, x, y, z]: [f64; 4],
    gravity: &[f64; 3],
) -> JointVector<f64> {
    let force = Vector3::from(*gravity) * -mass;
    let arm = Vector3::from_fn(|row, _| {
        let row = &frame[4 * row..];
        row[0] * x + row[1] * y + row[2] * z
    });
    let moment = arm.cross(&force);
    let wrench = [force.x, force.y, force.z, moment.z, moment.y, moment.x];
    jacobian.transpose() * nalgebra::SVector::<f64, 6>::from(wrench)
}

#[cfg(test)]
mod tests {
    use super::*;
    use controller_core::arm::Pose as Frame3;

    /// What holds a load is what the weight of a tool with that mass adds.
    #[test]
    fn a_load_weighs_as_a_tool_does() {
        let tool = Tool {
            pose: Frame3::IDENTITY,
            mass: 1.5,
            com: [0.02, -0.03, 0.05],
            inertia: [0.01, 0.0, 0.0, 0.01, 0.0, 0.01],
        };
        let q = JointVector::from([0.3, -0.6, 0.2, -2.0, 0.4, 1.4, 0.5]);
        let bare = RobotModel::new(&arms::FR3);
        let loaded = RobotModel::new(&arms::FR3.with_tool(&tool));
        let load = [1.5, 0.02, -0.03, 0.05];
        let added = holding(
            &bare.jacobian(&q),
            &bare.frame(&q),
            load,
            &arms::FR3.gravity,
        );
        let expected = loaded.gravity(&q) - bare.gravity(&q);
        assert!((added - expected).amax() < 1e-12, "{added} {expected}");
    }

    #[test]
    fn a_tool_is_turned_into_the_flange() {
        // A quarter turn about z.
        let tool = Tool {
            pose: Frame3 {
                rotation: [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
                shift: [0.0, 0.0, 0.1],
            },
            mass: 0.7,
            com: [0.01, 0.0, 0.02],
            inertia: [1.0, 0.5, 0.25, 2.0, 0.125, 3.0],
        };
        let seen = end_effector(&tool);
        // To rounding: a shift is added to it.
        for (place, expected) in seen.f_x_cee.iter().zip([0.0, 0.01, 0.12]) {
            assert!((place - expected).abs() < 1e-15, "{:?}", seen.f_x_cee);
        }
        // x becomes y, y becomes -x.
        let expected = [2.0, -0.5, -0.125, -0.5, 1.0, 0.25, -0.125, 0.25, 3.0];
        assert_eq!(seen.i_ee, expected);
        assert_eq!(seen.f_t_ne[..3], [0.0, 1.0, 0.0]);
        assert_eq!(seen.f_t_ne[12..], [0.0, 0.0, 0.1, 1.0]);
    }
}
