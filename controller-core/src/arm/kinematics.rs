//! Frames, joint axes and their rates, from one pass over the chain; points on
//! any link with position, velocity and Jacobian rows.

use crate::arm::link::Link;
use crate::arm::model::ArmModel;
use crate::joint::{
    ALIKE, DOF, JointState, JointVector, Matrix3, Padded, Vector3, joints_behind, joints_up_to,
    zeros,
};
use crate::linalg::for_each_joint;
use crate::real::Real;

/// Frames 0 (fixed) to 7 (flange side).
const FRAMES: usize = DOF + 1;

/// Where everything is and how fast it moves: base-plate frame, SI units.
///
/// What stands by rows x, y, z has one entry per DH frame; frame i moves with link i, 0 is fixed.
/// Its z axis is that of joint i + 1.
// In this order in memory: what has an entry per joint lies within reach of one base register.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Kinematics<T: Real> {
    /// Sine and cosine of the DH angles, for the dynamics.
    pub(crate) sine: Padded<T>,
    pub(crate) cosine: Padded<T>,
    /// z axes of the frames, unit vectors, by rows.
    axis: [[T; FRAMES]; 3],
    /// Time derivatives of the joints' axes \[1/s\], by rows.
    axis_rate: [JointVector<T>; 3],
    /// Origins of the frames \[m\] and their velocities \[m/s\], by rows.
    origin: [[T; FRAMES]; 3],
    velocity: [[T; FRAMES]; 3],
    /// x and y axes of the frame of each link.
    sides: [[Vector3<T>; 2]; DOF],
    /// Angular velocity of each link \[rad/s\].
    spin: [Vector3<T>; DOF],
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
            axis: [[T::ZERO; FRAMES]; 3],
            axis_rate: [zeros(); 3],
            origin: [[T::ZERO; FRAMES]; 3],
            velocity: [[T::ZERO; FRAMES]; 3],
            sides: [[zeros(); 2]; DOF],
            spin: [zeros(); DOF],
            sine: [T::ZERO; ALIKE],
            cosine: [T::ZERO; ALIKE],
        }
    }

    /// One pass from base to flange.
    #[inline]
    pub fn update(&mut self, arm: &ArmModel<T>, joints: &JointState<T>) {
        let k = self;
        for i in 0..DOF {
            k.sine[i] = joints.q[i] - arm.zero_angle[i];
        }
        for (sine, cosine) in k.sine.iter_mut().zip(&mut k.cosine) {
            (*sine, *cosine) = sine.sine_cosine();
        }
        let [mut x, mut y, mut z] = arm.base_axes;
        for row in 0..3 {
            (k.axis[row][0], k.origin[row][0]) = (z[row], arm.base_shift[row]);
        }
        let mut spin = Vector3::from([T::ZERO; 3]);
        for_each_joint!(i, {
            let link = &arm.links[i];
            let axis_rate = spin.cross(&z);
            spin += z * joints.dq[i];
            let (sin, cos) = (k.sine[i], k.cosine[i]);
            let turned_y = y * cos - x * sin;
            x = x * cos + y * sin;
            // From entry to entry in memory: with the axes they do not fit into registers.
            for row in 0..3 {
                k.axis_rate[row][i] = axis_rate[row];
                k.origin[row][i + 1] = k.origin[row][i];
                k.velocity[row][i + 1] = k.velocity[row][i];
            }
            if link.a != T::ZERO || link.d != T::ZERO {
                let shift = x * link.a + z * link.d;
                let rate = spin.cross(&shift);
                for row in 0..3 {
                    k.origin[row][i + 1] += shift[row];
                    k.velocity[row][i + 1] += rate[row];
                }
            }
            (y, z) = (
                turned_y * link.cos_alpha + z * link.sin_alpha,
                z * link.cos_alpha - turned_y * link.sin_alpha,
            );
            for row in 0..3 {
                k.axis[row][i + 1] = z[row];
            }
            (k.sides[i], k.spin[i]) = ([x, y], spin);
        });
    }

    /// Position and velocity of the point with this `offset` \[m\] in the DH frame of
    /// `link`.
    #[must_use]
    #[inline]
    pub fn point(&self, link: Link, offset: &Vector3<T>) -> PointMotion<T> {
        let frame = link.number();
        let LinkMotion {
            rotation,
            angular_velocity,
        } = self.link(link);
        let lever = rotation * offset;
        PointMotion {
            x: column(&self.origin, frame) + lever,
            dx: column(&self.velocity, frame) + angular_velocity.cross(&lever),
        }
    }

    /// Axis of joint `i`, counted from 0: a unit vector.
    #[inline(always)]
    pub(crate) fn joint_axis(&self, i: usize) -> Vector3<T> {
        column(&self.axis, i)
    }

    /// A place on the axis of joint `i`, counted from 0 \[m\].
    #[inline(always)]
    pub(crate) fn joint_place(&self, i: usize) -> Vector3<T> {
        column(&self.origin, i)
    }

    /// J and dJ/dt of a point whose motion is `motion`: columns z x (x - o) and
    /// dz x (x - o) + z x (dx - do) for the joints up to its link, else zero.
    #[must_use]
    #[inline]
    pub fn point_jacobian(&self, link: Link, motion: &PointMotion<T>) -> JacobianRows<T> {
        let mut rows = JacobianRows::new();
        self.set_point_rows(link, motion, &mut rows.jacobian, &mut rows.jacobian_dot);
        rows
    }

    /// The same in the place of the rows. Behind a call: a loop over levels would read all it needs
    /// in advance, which does not fit into registers.
    #[inline(never)]
    pub(crate) fn set_point_rows(
        &self,
        link: Link,
        motion: &PointMotion<T>,
        rows: &mut [JointVector<T>; 3],
        rates: &mut [JointVector<T>; 3],
    ) {
        let PointMotion { x, dx } = *motion;
        for i in joints_up_to(link.number()) {
            let (z, dz) = (self.joint_axis(i), rows_at(&self.axis_rate, i));
            let lever = x - self.joint_place(i);
            let lever_rate = dx - column(&self.velocity, i);
            set_rows_at(rows, i, &z.cross(&lever));
            set_rows_at(rates, i, &(dz.cross(&lever) + z.cross(&lever_rate)));
        }
        self.cut(link, rows, rates);
    }

    /// Velocity of the base: zeros that the compiler does not know, because constant ones are
    /// written by calls.
    #[inline(always)]
    pub(crate) fn at_rest(&self) -> Vector3<T> {
        column(&self.velocity, 0)
    }

    /// Joints behind `link` do not move it.
    #[inline(always)]
    fn cut(&self, link: Link, rows: &mut [JointVector<T>; 3], rates: &mut [JointVector<T>; 3]) {
        let zero = self.at_rest();
        for i in joints_behind(link.number()) {
            set_rows_at(rows, i, &zero);
            set_rows_at(rates, i, &zero);
        }
    }

    /// Orientation and angular velocity of a link.
    #[must_use]
    #[inline]
    pub fn link(&self, link: Link) -> LinkMotion<T> {
        let [x, y] = self.sides[link as usize];
        LinkMotion {
            rotation: Matrix3::from_columns(&[x, y, column(&self.axis, link.number())]),
            angular_velocity: self.spin[link as usize],
        }
    }

    /// J and dJ/dt of a link's angular velocity: columns z and dz for the joints
    /// up to its own, else zero.
    #[must_use]
    #[inline]
    pub fn angular_jacobian(&self, link: Link) -> JacobianRows<T> {
        let mut rows = JacobianRows::new();
        self.set_angular_rows(link, &mut rows.jacobian, &mut rows.jacobian_dot);
        rows
    }

    /// The same in the place of the rows, likewise.
    #[inline(never)]
    pub(crate) fn set_angular_rows(
        &self,
        link: Link,
        rows: &mut [JointVector<T>; 3],
        rates: &mut [JointVector<T>; 3],
    ) {
        for i in joints_up_to(link.number()) {
            set_rows_at(rows, i, &self.joint_axis(i));
            set_rows_at(rates, i, &rows_at(&self.axis_rate, i));
        }
        self.cut(link, rows, rates);
    }
}

impl<T: Real> JacobianRows<T> {
    /// Nothing set yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            jacobian: [zeros(); 3],
            jacobian_dot: [zeros(); 3],
        }
    }
}

impl<T: Real> Default for JacobianRows<T> {
    fn default() -> Self {
        Self::new()
    }
}

/// Column `i` of rows.
#[inline(always)]
fn rows_at<T: Real>([x, y, z]: &[JointVector<T>; 3], i: usize) -> Vector3<T> {
    Vector3::from([x[i], y[i], z[i]])
}

/// Sets column `i` of rows.
#[inline(always)]
fn set_rows_at<T: Real>([x, y, z]: &mut [JointVector<T>; 3], i: usize, column: &Vector3<T>) {
    (x[i], y[i], z[i]) = (column.x, column.y, column.z);
}

/// A vector by rows.
#[inline(always)]
fn column<T: Real, const N: usize>([x, y, z]: &[[T; N]; 3], i: usize) -> Vector3<T> {
    Vector3::from([x[i], y[i], z[i]])
}

impl<T: Real> Default for Kinematics<T> {
    fn default() -> Self {
        Self::new()
    }
}
