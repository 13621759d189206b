//! A model with the names that the vendor's client looks for; its numbers are of no arm.

use std::fmt::Write as _;

/// Axis of joint i + 1 in the frame before: turned about x by so much \[rad\], moved by x y z \[m\].
const JOINTS: [(f64, [f64; 3]); 7] = {
    use std::f64::consts::FRAC_PI_2 as Q;
    [
        (0.0, [0.0, 0.0, 0.333]),
        (-Q, [0.0, 0.0, 0.0]),
        (Q, [0.0, -0.316, 0.0]),
        (Q, [0.0825, 0.0, 0.0]),
        (-Q, [-0.0825, 0.384, 0.0]),
        (Q, [0.0, 0.0, 0.0]),
        (Q, [0.088, 0.0, 0.0]),
    ]
};

/// The URDF.
pub fn text() -> String {
    let mut text = String::from("<?xml version=\"1.0\"?>\n<robot name=\"arm\">\n");
    for i in 0..=8 {
        text += &format!("<link name=\"link{i}\">");
        if (1..8).contains(&i) {
            text += "<inertial><origin xyz=\"0 0 0\" rpy=\"0 0 0\"/><mass value=\"1\"/>\
                     <inertia ixx=\"0.1\" ixy=\"0\" ixz=\"0\" iyy=\"0.1\" iyz=\"0\" izz=\"0.1\"/></inertial>";
        }
        text += "</link>\n";
    }
    for (i, (roll, [x, y, z])) in (1..).zip(JOINTS) {
        let before = i - 1;
        let _ = writeln!(
            text,
            "<joint name=\"joint{i}\" type=\"revolute\"><parent link=\"link{before}\"/><child link=\"link{i}\"/>\
             <origin xyz=\"{x} {y} {z}\" rpy=\"{roll} 0 0\"/><axis xyz=\"0 0 1\"/>\
             <limit lower=\"-2.7\" upper=\"2.7\" velocity=\"2.6\" effort=\"87\"/>\
             <position_based_velocity_limits velocity_offset=\"0.3\" deceleration_limit=\"6\"/></joint>"
        );
    }
    text + "<joint name=\"joint8\" type=\"fixed\"><parent link=\"link7\"/><child link=\"link8\"/>\
            <origin xyz=\"0 0 0.107\" rpy=\"0 0 0\"/></joint>\n</robot>\n"
}
