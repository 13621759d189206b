//! The robot's model as a URDF: what it answers to GetRobotModel. Without meshes, with the names of
//! links and joints that the vendor's client looks for.

use std::fmt::Write as _;

use controller_core::arm::{ArmParameters, LinkParameters, Pose};

/// What joint i + 1 turns is its link's frame before the lengths of its row: this far it is to the
/// DH frame behind them.
fn lengths(link: &LinkParameters) -> Pose {
    let (sin, cos) = link.alpha.sin_cos();
    Pose {
        rotation: [[1.0, 0.0, 0.0], [0.0, cos, -sin], [0.0, sin, cos]],
        shift: [link.a, 0.0, link.d],
    }
}

/// Cosine of an angle that is a right one.
const UPRIGHT: f64 = 1e-9;

/// `xyz` and `rpy` of a pose.
fn origin(pose: &Pose) -> String {
    let [x, y, z] = pose.shift;
    let [[xx, xy, _], [yx, yy, _], [zx, zy, zz]] = pose.rotation;
    // Fixed axes x, y, z. With a right angle about y the other two turn about the same line.
    let level = xx.hypot(yx);
    let pitch = (-zx).atan2(level);
    let (roll, yaw) = if level > UPRIGHT {
        (zy.atan2(zz), yx.atan2(xx))
    } else {
        ((xy * pitch.signum()).atan2(yy), 0.0)
    };
    // -0 is written without its sign.
    let [x, y, z, roll, pitch, yaw] = [x, y, z, roll, pitch, yaw].map(|value| value + 0.0);
    format!("<origin xyz=\"{x} {y} {z}\" rpy=\"{roll} {pitch} {yaw}\"/>")
}

fn inertial(link: &LinkParameters) -> String {
    let frame = lengths(link);
    let at = Pose {
        shift: frame.place(link.com),
        ..frame
    };
    let [xx, xy, xz, yy, yz, zz] = link.inertia;
    format!(
        "<inertial>{}<mass value=\"{}\"/><inertia ixx=\"{xx}\" ixy=\"{xy}\" ixz=\"{xz}\" iyy=\"{yy}\" \
         iyz=\"{yz}\" izz=\"{zz}\"/></inertial>",
        origin(&at),
        link.mass
    )
}

/// A turn about z.
fn turned(angle: f64) -> Pose {
    let (sin, cos) = angle.sin_cos();
    Pose {
        rotation: [[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]],
        shift: [0.0; 3],
    }
}

/// The URDF of an arm without what is on its flange: `link0` to `link8`, `joint1` to `joint7`, the
/// flange by a fixed `joint8`.
#[must_use]
pub fn text(arm: &ArmParameters) -> String {
    let mut text = format!("<?xml version=\"1.0\"?>\n<robot name=\"{}\">\n", arm.name);
    let mut line = |line: String| {
        text += &line;
        text.push('\n');
    };
    line("<link name=\"link0\"/>".to_string());
    let mut before = arm.base;
    for (i, link) in (1..).zip(&arm.links) {
        line(format!("<link name=\"link{i}\">{}</link>", inertial(link)));
        let place = before.carrying(&turned(link.angle_offset));
        let [lower, upper] = link.position_range;
        let mut joint = format!(
            "<joint name=\"joint{i}\" type=\"revolute\"><parent link=\"link{}\"/><child \
             link=\"link{i}\"/>{}<axis xyz=\"0 0 1\"/><limit lower=\"{lower}\" upper=\"{upper}\" \
             velocity=\"{}\" effort=\"{}\"/>",
            i - 1,
            origin(&place),
            link.speed_limit,
            link.torque_limit
        );
        if let Some(approach) = &link.end_approach {
            let _ = write!(
                joint,
                "<position_based_velocity_limits velocity_offset=\"{}\" deceleration_limit=\"{}\"/>",
                approach.margin, approach.deceleration
            );
        }
        line(joint + "</joint>");
        before = lengths(link);
    }
    line("<link name=\"link8\"/>".to_string());
    let place = before.carrying(&arm.flange);
    line(format!(
        "<joint name=\"joint8\" type=\"fixed\"><parent link=\"link7\"/><child link=\"link8\"/>{}</joint>",
        origin(&place)
    ));
    text + "</robot>\n"
}
