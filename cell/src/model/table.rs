//! A chain as a standard DH table.
//!
//! At q = 0 every joint is a line. Frame i has its origin where the common normal of axes i and
//! i + 1 meets axis i + 1, z along axis i + 1, x along the normal; where the axes cross, along
//! their cross product; where they are parallel, through the frame before. Signs of x are such
//! that angle offsets lie in (-90, 90] deg and x of frame 0 points forward, so that an upright arm
//! gets no turn of its base. Frame 7 is frame 6 turned about axis 7; what is left to the tip is
//! the flange.

use std::f64::consts::{FRAC_PI_2, PI};

use controller_core::arm::{ArmParameters, Friction, Link, LinkParameters, LinkPoint, NamedPoint};
use controller_core::joint::{DOF, Matrix3, Vector3};

use super::chain::{Chain, RIGHT_ANGLE_ERROR};
use super::frame::Frame;
use crate::arm::file::GRAVITY;
use crate::arm::joint::{BRAKE_RATE, TORQUE_RATE};

/// Axes that are nearer cross \[m\]: a thousandth of a hair, a thousand roundings.
const CROSSING: f64 = 1e-9;

/// A length this near to whole picometres is meant to be so: some roundings of a metre.
const ROUNDING: f64 = 1e-14;

/// Points that every arm has beside its flange: origins of DH frames.
const POINTS: [NamedPoint; 2] = [origin("elbow", Link::L3), origin("wrist", Link::L5)];

const fn origin(name: &'static str, link: Link) -> NamedPoint {
    let offset = [0.0; 3];
    NamedPoint {
        name,
        point: LinkPoint { link, offset },
    }
}

impl Chain {
    /// The table, without names.
    #[must_use]
    pub fn table(&self) -> ArmParameters {
        let frames = self.frames();
        let links = std::array::from_fn(|i| self.link(i, &frames[i], &frames[i + 1]));
        ArmParameters {
            name: "",
            base: cleaned(&frames[0]).pose(),
            gravity: GRAVITY,
            links,
            flange: cleaned(&frames[DOF].inverse().carrying(&self.tip)).pose(),
            points: &POINTS,
            limits: None,
            damping_postures: &[],
        }
    }

    /// DH frames 0 to 7 at q = 0, in the base.
    fn frames(&self) -> [Frame; DOF + 1] {
        let joints = &self.joints;
        let axis = |i: usize| joints[i.min(DOF - 1)].axis;
        let mut x = [Vector3::zeros(); DOF + 1];
        let mut origins = [Vector3::zeros(); DOF + 1];
        origins[0] = self.feet(0, &joints[0].point)[0];
        for i in 1..DOF {
            let [near, far] = self.feet(i - 1, &origins[i - 1]);
            let (normal, crossed) = (far - near, axis(i - 1).cross(&axis(i)));
            let along = if normal.norm() > CROSSING {
                normal
            } else if crossed.norm() > RIGHT_ANGLE_ERROR {
                crossed
            } else if i > 1 {
                x[i - 1]
            } else {
                across(&axis(0))
            };
            // Axes that count as parallel need not be so to the last bit.
            x[i] = (along - axis(i) * axis(i).dot(&along)).normalize();
            origins[i] = far;
        }
        if x[1].x < -CROSSING {
            x[1] = -x[1];
        }
        x[0] = (x[1] - axis(0) * axis(0).dot(&x[1])).normalize();
        for i in 2..DOF {
            let turned = x[i - 1]
                .cross(&x[i])
                .dot(&axis(i - 1))
                .atan2(x[i - 1].dot(&x[i]));
            if turned > FRAC_PI_2 + RIGHT_ANGLE_ERROR || turned <= -FRAC_PI_2 + RIGHT_ANGLE_ERROR {
                x[i] = -x[i];
            }
        }
        (x[DOF], origins[DOF]) = (x[DOF - 1], origins[DOF - 1]);
        std::array::from_fn(|i| Frame {
            rotation: Matrix3::from_columns(&[x[i], axis(i).cross(&x[i]), axis(i)]),
            shift: origins[i],
        })
    }

    /// Where the common normal of axes i and i + 1, counted from 0, meets them; of parallel ones
    /// the normal through `through`.
    fn feet(&self, i: usize, through: &Vector3<f64>) -> [Vector3<f64>; 2] {
        let [one, other] = [&self.joints[i], &self.joints[i + 1]];
        let (u, v, w) = (one.axis, other.axis, other.point - one.point);
        let (c, sine) = (u.dot(&v), u.cross(&v).norm());
        if sine < RIGHT_ANGLE_ERROR {
            let foot = one.point + u * (through - one.point).dot(&u);
            return [foot, other.point + v * (foot - other.point).dot(&v)];
        }
        let s = (w.dot(&u) - c * w.dot(&v)) / (sine * sine);
        let t = (c * w.dot(&u) - w.dot(&v)) / (sine * sine);
        [one.point + u * s, other.point + v * t]
    }

    /// Link i, counted from 0, between two DH frames.
    fn link(&self, i: usize, before: &Frame, own: &Frame) -> LinkParameters {
        let step = before.inverse().carrying(own);
        let turn = |sine: (usize, usize), cosine: (usize, usize)| {
            exact(step.rotation[sine].atan2(step.rotation[cosine]))
        };
        let (joint, body) = (&self.joints[i], self.bodies[i].carried(&own.inverse()));
        let entries = body.inertia.amax();
        let [xx, xy, xz, yy, yz, zz] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];
        let inertia = [xx, xy, xz, yy, yz, zz].map(|at| {
            let entry = body.inertia[at];
            if entry.abs() < 1e-14 * entries {
                0.0
            } else {
                entry
            }
        });
        let [coulomb, viscous] = joint.friction;
        LinkParameters {
            name: "",
            a: length((own.shift - before.shift).dot(&own.rotation.column(0))),
            alpha: turn((2, 1), (2, 2)),
            d: length(step.shift.z),
            angle_offset: turn((1, 0), (0, 0)),
            mass: body.mass,
            com: body.com.map(length).into(),
            inertia,
            rotor_inertia: 0.0,
            friction: Friction {
                coulomb,
                viscous,
                ..Friction::NONE
            },
            position_range: joint.range,
            speed_limit: joint.speed,
            end_approach: None,
            torque_limit: joint.torque,
            torque_rate_limit: TORQUE_RATE,
            brake_rate_limit: BRAKE_RATE,
        }
    }
}

/// A right angle where it is near one; of half a turn the positive one.
fn exact(angle: f64) -> f64 {
    let right = (angle / FRAC_PI_2).round() * FRAC_PI_2;
    if (angle - right).abs() > RIGHT_ANGLE_ERROR {
        angle
    } else if right < -PI + 1.0 {
        PI
    } else {
        // Never -0.
        right + 0.0
    }
}

/// Without what turns there and back have added in the last digits.
fn length(value: f64) -> f64 {
    let short = (value * 1e12).round() / 1e12;
    // Never -0.
    let short = short + 0.0;
    if (value - short).abs() < ROUNDING {
        short
    } else {
        value
    }
}

/// Without what rounding left of zeros.
fn cleaned(frame: &Frame) -> Frame {
    Frame {
        rotation: frame
            .rotation
            .map(|entry| if entry.abs() < 1e-15 { 0.0 } else { entry }),
        shift: frame.shift.map(length),
    }
}

/// A unit vector across `axis`, forward where that goes.
fn across(axis: &Vector3<f64>) -> Vector3<f64> {
    let ahead = if axis.x.abs() < 0.9 {
        Vector3::x()
    } else {
        Vector3::z()
    };
    (ahead - axis * axis.dot(&ahead)).normalize()
}
