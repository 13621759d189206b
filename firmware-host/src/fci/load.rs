//! The tool of a scenario as the load of the robot.

use controller_core::arm::Tool;
use controller_core::joint::{Matrix3, Vector3};
use fci::request::Load;

/// What SetLoad says of a tool on the flange.
#[must_use]
pub fn of_tool(tool: &Tool) -> Load {
    let rotation = Matrix3::from_fn(|i, j| tool.pose.rotation[i][j]);
    let shift = Vector3::from(tool.pose.shift);
    let [xx, xy, xz, yy, yz, zz] = tool.inertia;
    let inertia = Matrix3::from_rows(&[
        [xx, xy, xz].into(),
        [xy, yy, yz].into(),
        [xz, yz, zz].into(),
    ]);
    let center = shift + rotation * Vector3::from(tool.com);
    let turned = rotation * inertia * rotation.transpose();
    let mut i_load = [0.0; 9];
    // Symmetric: by columns is by rows.
    for (to, from) in i_load.iter_mut().zip(&turned) {
        *to = *from;
    }
    Load {
        m_load: tool.mass,
        f_x_cload: center.into(),
        i_load,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use controller_core::arm::Pose;

    #[test]
    fn a_turned_tool_is_turned_into_the_flange() {
        // A quarter turn about z: x of the tool is y of the flange.
        let tool = Tool {
            pose: Pose {
                rotation: [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
                shift: [0.0, 0.0, 0.1],
            },
            mass: 0.7,
            com: [0.02, 0.0, 0.05],
            inertia: [1e-3, 1e-4, 2e-4, 2e-3, 3e-4, 3e-3],
        };
        let load = of_tool(&tool);
        assert_eq!(load.m_load, 0.7);
        let expected = [0.0, 0.02, 0.1 + 0.05];
        for (one, other) in load.f_x_cload.iter().zip(expected) {
            assert!((one - other).abs() < 1e-15);
        }
        let [xx, xy, xz, yx, yy, yz, zx, zy, zz] = load.i_load;
        assert_eq!([xx, yy, zz], [2e-3, 1e-3, 3e-3]);
        assert_eq!([xy, yx], [-1e-4; 2]);
        assert_eq!([xz, zx], [-3e-4; 2]);
        assert_eq!([yz, zy], [2e-4; 2]);
    }
}
