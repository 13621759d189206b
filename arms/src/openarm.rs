//! What both versions of OpenArm share: the points that have a name, their motors, and how one
//! side becomes the other.

use controller_core::arm::{ArmParameters, Link, LinkParameters, LinkPoint, NamedPoint, Pose};

use crate::realistic::MotorRanges;

/// Elbow and wrist are origins of DH frames.
pub(crate) const fn points(flange: &Pose) -> [NamedPoint; 3] {
    const fn named(name: &'static str, link: Link, offset: [f64; 3]) -> NamedPoint {
        NamedPoint {
            name,
            point: LinkPoint { link, offset },
        }
    }
    [
        named("elbow", Link::L3, [0.0; 3]),
        named("wrist", Link::L5, [0.0; 3]),
        named("flange", Link::L7, flange.shift),
    ]
}

/// PMAX, VMAX, TMAX of Damiao's motors, registers 21 to 23 as they come from the factory:
/// enactic/openarm_can, table of motor types. TMAX is a scale, not a limit.
const fn motor(position: f64, speed: f64, torque: f64) -> MotorRanges {
    MotorRanges {
        position,
        speed,
        torque,
    }
}
pub(crate) const DM3507: MotorRanges = motor(12.5, 50.0, 5.0);
pub(crate) const DM4310: MotorRanges = motor(12.5, 30.0, 10.0);
pub(crate) const DM4340: MotorRanges = motor(12.5, 10.0, 28.0);
pub(crate) const DM8009: MotorRanges = motor(12.5, 45.0, 54.0);

/// Signs of the axes of a frame that is mirrored in y, and in z.
const IN_Y: [f64; 3] = [1.0, -1.0, 1.0];
const IN_Z: [f64; 3] = [1.0, 1.0, -1.0];

/// A zero stays +0.
const fn signed(sign: f64, x: f64) -> f64 {
    if sign < 0.0 { 0.0 - x } else { x }
}

const fn vector(signs: [f64; 3], [x, y, z]: [f64; 3]) -> [f64; 3] {
    [
        signed(signs[0], x),
        signed(signs[1], y),
        signed(signs[2], z),
    ]
}

const fn row(sign: f64, [x, y, z]: [f64; 3]) -> [f64; 3] {
    // The columns are mirrored in y.
    [signed(sign, x), signed(-sign, y), signed(sign, z)]
}

/// The image of a pose, mirrored in y as its parent is.
pub(crate) const fn pose(pose: &Pose) -> Pose {
    let [first, second, third] = pose.rotation;
    Pose {
        rotation: [row(1.0, first), row(-1.0, second), row(1.0, third)],
        shift: vector(IN_Y, pose.shift),
    }
}

/// The other side of an arm: its image in the plane y = 0 of the base plate.
///
/// The maker turns every joint but the fourth the other way round; so frames 0 to 2 and 4 to 7
/// are mirrored in y, and twist, offset and range change their sense there. Frame 3, of joint 4,
/// is mirrored in z: its range stays. `same_parts` are links whose part is the same on both sides,
/// not an image, with the signs of its axes in the other frame.
pub(crate) const fn mirrored(
    arm: &ArmParameters,
    name: &'static str,
    points: &'static [NamedPoint],
    same_parts: &[(usize, [f64; 3])],
) -> ArmParameters {
    let mut other = *arm;
    other.name = name;
    other.base = pose(&arm.base);
    other.gravity = vector(IN_Y, arm.gravity);
    other.flange = pose(&arm.flange);
    other.points = points;
    let mut i = 0;
    while i < other.links.len() {
        let number = i + 1;
        let mut body = if number == 3 { IN_Z } else { IN_Y };
        let mut part = 0;
        while part < same_parts.len() {
            if same_parts[part].0 == number {
                body = same_parts[part].1;
            }
            part += 1;
        }
        other.links[i] = link(&arm.links[i], number, body);
        i += 1;
    }
    other
}

/// The image of a link, with the signs of the axes of its body.
const fn link(link: &LinkParameters, number: usize, signs: [f64; 3]) -> LinkParameters {
    let mut other = *link;
    let [xx, xy, xz, yy, yz, zz] = link.inertia;
    other.com = vector(signs, link.com);
    other.inertia = [
        xx,
        signed(signs[0] * signs[1], xy),
        signed(signs[0] * signs[2], xz),
        yy,
        signed(signs[1] * signs[2], yz),
        zz,
    ];
    if number == 4 {
        // From z to y: the joint keeps its sense, its axis is turned round.
        other.d = 0.0 - link.d;
    } else {
        other.angle_offset = 0.0 - link.angle_offset;
        let [least, greatest] = link.position_range;
        other.position_range = [0.0 - greatest, 0.0 - least];
    }
    if number != 3 && number != 4 {
        // Between frames that are mirrored alike; else a right angle is its own image.
        other.alpha = 0.0 - link.alpha;
    }
    other
}
