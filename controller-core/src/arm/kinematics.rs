//! Frames, joint axes and their rates, from one pass over the chain; points on
//! any link with position, velocity and Jacobian rows.

use crate::arm::exchange::AxisExchange;
use crate::arm::link::Link;
use crate::arm::model::ArmModel;
use crate::joint::{DOF, JointState, JointVector, Matrix3, Vector3, sines_cosines, zeros};
use crate::linalg::for_each_joint;
use crate::real::Real;

/// Frames 0 (fixed) to 7 (flange side).
const FRAMES: usize = DOF + 1;

/// Where everything is and how fast it moves: base-plate frame, SI units.
///
/// Index i of the arrays is DH frame i, which moves with link i (0 is fixed).
#[derive(Clone, Copy, Debug)]
pub struct Kinematics<T: Real> {
    /// Axes of the joints, unit vectors (z of frame i for joint i + 1), by rows x, y, z.
    pub axis: [JointVector<T>; 3],
    /// Time derivatives of the axes \[1/s\], by rows x, y, z.
    pub axis_rate: [JointVector<T>; 3],
    /// `origin` of the frames of the joints' axes and its velocity, by rows.
    joint_origin: [JointVector<T>; 3],
    joint_velocity: [JointVector<T>; 3],
    /// Orientation of frame i: its axes are the columns, in base-plate axes.
    pub rotation: [Matrix3<T>; FRAMES],
    /// Origin of frame i \[m\].
    pub origin: [Vector3<T>; FRAMES],
    /// Angular velocity of link i \[rad/s\].
    pub angular_velocity: [Vector3<T>; FRAMES],
    /// Velocity of the origin of frame i, carried by link i \[m/s\].
    pub origin_velocity: [Vector3<T>; FRAMES],
    /// Sine and cosine of the DH angles, for the dynamics.
    pub(crate) sine: JointVector<T>,
    pub(crate) cosine: JointVector<T>,
}

/// A point of the arm at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointMotion<T: Real> {
    /// Position \[m\], base-plate frame.
    pub x: Vector3<T>,
    /// Velocity \[m/s\], base-plate axes.
    pub dx: Vector3<T>,
}

/// Orientation and angular velocity of a link at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkMotion<T: Real> {
    /// Axes of its DH frame in the columns, base-plate axes.
    pub rotation: Matrix3<T>,
    /// Angular velocity \[rad/s\], base-plate axes.
    pub angular_velocity: Vector3<T>,
}

/// J (3 x 7, dx = J dq) and dJ/dt of a point, stored by rows x, y, z; of a link's
/// angular velocity where that is asked for, then without the unit m.
#[derive(Clone, Copy, Debug)]
pub struct JacobianRows<T: Real> {
    /// Rows of J \[m\], base-plate axes.
    pub jacobian: [JointVector<T>; 3],
    /// Rows of dJ/dt \[m/s\], base-plate axes.
    pub jacobian_dot: [JointVector<T>; 3],
}

impl<T: Real> Kinematics<T> {
    /// Nothing computed yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            rotation: [zeros(); FRAMES],
            origin: [zeros(); FRAMES],
            angular_velocity: [zeros(); FRAMES],
            origin_velocity: [zeros(); FRAMES],
            axis: [zeros(); 3],
            axis_rate: [zeros(); 3],
            joint_origin: [zeros(); 3],
            joint_velocity: [zeros(); 3],
            sine: zeros(),
            cosine: zeros(),
        }
    }

    /// One pass from base to flange.
    #[inline]
    pub fn update(&mut self, arm: &ArmModel<T>, joints: &JointState<T>) {
        let zero = Vector3::from([T::ZERO; 3]);
        let k = self;
        (k.sine, k.cosine) = sines_cosines(&joints.q, &arm.zero_angle);
        let [mut x, mut y, mut z] = arm.base_axes;
        k.rotation[0] = Matrix3::from_columns(&[x, y, z]);
        k.origin[0] = arm.base_shift;
        let (mut origin, mut velocity, mut spin) = (k.origin[0], zero, zero);
        for_each_joint!(i, {
            let link = &arm.links[i];
            let (sin, cos) = (k.sine[i], k.cosine[i]);
            // The base does not turn.
            let axis_rate = if i == 0 { zero } else { spin.cross(&z) };
            for row in 0..3 {
                k.axis[row][i] = z[row];
                k.axis_rate[row][i] = axis_rate[row];
                k.joint_origin[row][i] = origin[row];
                k.joint_velocity[row][i] = velocity[row];
            }
            spin += z * joints.dq[i];
            let turned_y = y * cos - x * sin;
            x = x * cos + y * sin;
            // The way to the next origin, most often none.
            if link.a != T::ZERO || link.d != T::ZERO {
                let shift = x * link.a + z * link.d;
                origin += shift;
                velocity += spin.cross(&shift);
            }
            (y, z) = match AxisExchange::turn(link.exchange.0) {
                AxisExchange::NONE => (turned_y, z),
                AxisExchange::RIGHT => (z, -turned_y),
                AxisExchange::LEFT => (-z, turned_y),
                _ => (
                    turned_y * link.cos_alpha + z * link.sin_alpha,
                    z * link.cos_alpha - turned_y * link.sin_alpha,
                ),
            };
            k.rotation[i + 1] = Matrix3::from_columns(&[x, y, z]);
            k.origin[i + 1] = origin;
            k.angular_velocity[i + 1] = spin;
            k.origin_velocity[i + 1] = velocity;
        });
    }

    /// Position and velocity of the point with this `offset` \[m\] in the DH frame of
    /// `link`.
    #[must_use]
    #[inline]
    pub fn point(&self, link: Link, offset: &Vector3<T>) -> PointMotion<T> {
        let frame = link.number();
        let lever = self.rotation[frame] * offset;
        PointMotion {
            x: self.origin[frame] + lever,
            dx: self.origin_velocity[frame] + self.angular_velocity[frame].cross(&lever),
        }
    }

    /// Axis of joint `i`, counted from 0: a unit vector.
    #[inline(always)]
    pub(crate) fn joint_axis(&self, i: usize) -> Vector3<T> {
        let [x, y, z] = &self.axis;
        Vector3::from([x[i], y[i], z[i]])
    }

    /// A place on the axis of joint `i`, counted from 0 \[m\].
    #[inline(always)]
    pub(crate) fn joint_place(&self, i: usize) -> Vector3<T> {
        let [x, y, z] = &self.joint_origin;
        Vector3::from([x[i], y[i], z[i]])
    }

    /// J and dJ/dt of a point whose motion is `motion`: columns z x (x - o) and
    /// dz x (x - o) + z x (dx - do) for the joints up to its link, else zero.
    #[must_use]
    #[inline]
    pub fn point_jacobian(&self, link: Link, motion: &PointMotion<T>) -> JacobianRows<T> {
        let mut rows = JacobianRows {
            jacobian: [zeros(); 3],
            jacobian_dot: [zeros(); 3],
        };
        for axis in 0..3 {
            let (row, rate) = (&mut rows.jacobian[axis], &mut rows.jacobian_dot[axis]);
            self.set_point_row(axis, link, motion, row, rate);
        }
        rows
    }

    /// Row `axis`, counted from 0, of [`Kinematics::point_jacobian`].
    #[inline(always)]
    pub(crate) fn set_point_row(
        &self,
        axis: usize,
        link: Link,
        motion: &PointMotion<T>,
        row: &mut JointVector<T>,
        rate: &mut JointVector<T>,
    ) {
        // The entries that a cross product has in this row, y and z in row x.
        let [b, c] = [(axis + 1) % 3, (axis + 2) % 3];
        for i in 0..DOF {
            let (z_b, z_c) = (self.axis[b][i], self.axis[c][i]);
            let (dz_b, dz_c) = (self.axis_rate[b][i], self.axis_rate[c][i]);
            let lever_b = motion.x[b] - self.joint_origin[b][i];
            let lever_c = motion.x[c] - self.joint_origin[c][i];
            let lever_rate_b = motion.dx[b] - self.joint_velocity[b][i];
            let lever_rate_c = motion.dx[c] - self.joint_velocity[c][i];
            row[i] = z_b * lever_c - z_c * lever_b;
            rate[i] = (dz_b * lever_c - dz_c * lever_b) + (z_b * lever_rate_c - z_c * lever_rate_b);
        }
        self.cut(link, row);
        self.cut(link, rate);
    }

    /// Joints behind `link` do not move it.
    #[inline(always)]
    fn cut(&self, link: Link, row: &mut JointVector<T>) {
        // The base does not turn; as a number, because constant zeros are written by a call.
        let zero = self.angular_velocity[0][0];
        for i in link.number()..DOF {
            row[i] = zero;
        }
    }

    /// Orientation and angular velocity of a link.
    #[must_use]
    #[inline]
    pub fn link(&self, link: Link) -> LinkMotion<T> {
        let frame = link.number();
        LinkMotion {
            rotation: self.rotation[frame],
            angular_velocity: self.angular_velocity[frame],
        }
    }

    /// J and dJ/dt of a link's angular velocity: columns z and dz for the joints
    /// up to its own, else zero.
    #[must_use]
    #[inline]
    pub fn angular_jacobian(&self, link: Link) -> JacobianRows<T> {
        let mut rows = JacobianRows {
            jacobian: [zeros(); 3],
            jacobian_dot: [zeros(); 3],
        };
        for axis in 0..3 {
            let (row, rate) = (&mut rows.jacobian[axis], &mut rows.jacobian_dot[axis]);
            self.set_angular_row(axis, link, row, rate);
        }
        rows
    }

    /// Row `axis`, counted from 0, of [`Kinematics::angular_jacobian`].
    #[inline(always)]
    pub(crate) fn set_angular_row(
        &self,
        axis: usize,
        link: Link,
        row: &mut JointVector<T>,
        rate: &mut JointVector<T>,
    ) {
        (*row, *rate) = (self.axis[axis % 3], self.axis_rate[axis % 3]);
        self.cut(link, row);
        self.cut(link, rate);
    }
}

impl<T: Real> Default for Kinematics<T> {
    fn default() -> Self {
        Self::new()
    }
}
