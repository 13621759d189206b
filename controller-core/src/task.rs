//! Tasks: a point or the orientation of a link, the axes of it that a priority
//! level controls, and its gains; and the stacked rows J, dJ/dt that all levels make together.

use crate::joint::{DOF, JointState, JointVector, Matrix3, Vector3, zeros};
use crate::kinematics::{JacobianRows, Kinematics, LinkPoint};
use crate::orientation::{self, Quaternion};
use crate::real::Real;

/// Most task rows of all levels together.
pub const MAX_ROWS: usize = DOF;

/// Most priority levels: each has at least one row.
pub const MAX_LEVELS: usize = MAX_ROWS;

/// Base-plate axes that a task controls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Axes {
    /// Along x, y and z.
    pub xyz: [bool; 3],
}

impl Axes {
    /// All three axes.
    pub const XYZ: Self = Self { xyz: [true; 3] };
    /// The horizontal plane.
    pub const XY: Self = Self {
        xyz: [true, true, false],
    };

    /// Number of rows.
    #[must_use]
    pub fn count(self) -> usize {
        self.xyz.iter().filter(|&&on| on).count()
    }

    /// From a name such as `xyz`, `xz` or `y`: each letter at most once, in
    /// this order. None for anything else.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        let mut xyz = [false; 3];
        let mut next = 0;
        for letter in name.bytes() {
            let axis = usize::from(letter.checked_sub(b'x')?);
            let flag = xyz.get_mut(axis)?;
            if axis < next {
                return None;
            }
            *flag = true;
            next = axis + 1;
        }
        (next > 0).then_some(Self { xyz })
    }
}

/// What a task tracks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(all(feature = "defmt", target_os = "none"), derive(defmt::Format))]
pub enum TaskKind {
    /// The position of the point.
    #[default]
    Position,
    /// The orientation of the link's DH frame; of the point only the link counts.
    Orientation,
}

/// A tracking task, one priority level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Task<T: Real> {
    /// Position or orientation.
    pub kind: TaskKind,
    /// The controlled point.
    pub point: LinkPoint<T>,
    /// Its controlled axes: along them, or for an orientation about them.
    pub axes: Axes,
    /// K_p of (12) \[1/s2\], symmetric positive definite on the controlled axes;
    /// the other rows and columns are not read.
    pub stiffness: Matrix3<T>,
    /// K_d of (12) \[1/s\], likewise.
    pub damping: Matrix3<T>,
}

impl<T: Real> Task<T> {
    /// A task with the same gain on every axis: `stiffness` \[1/s2\] and
    /// `damping` \[1/s\] act on acceleration.
    #[must_use]
    pub fn uniform(point: LinkPoint<T>, axes: Axes, stiffness: f64, damping: f64) -> Self {
        Self::diagonal(point, axes, [stiffness; 3], [damping; 3])
    }

    /// A task with one gain per axis x, y, z.
    #[must_use]
    pub fn diagonal(
        point: LinkPoint<T>,
        axes: Axes,
        stiffness: [f64; 3],
        damping: [f64; 3],
    ) -> Self {
        let matrix =
            |values: [f64; 3]| Matrix3::from_diagonal(&Vector3::from(values.map(T::from_f64)));
        Self {
            kind: TaskKind::Position,
            point,
            axes,
            stiffness: matrix(stiffness),
            damping: matrix(damping),
        }
    }
}

impl<T: Real> Task<T> {
    /// Where the task's point or its link's orientation is and how it moves, as a
    /// reference without acceleration.
    #[must_use]
    pub fn place(&self, kinematics: &Kinematics<T>) -> TaskReference<T> {
        match self.kind {
            TaskKind::Position => {
                let motion = kinematics.point(&self.point);
                TaskReference {
                    dx: motion.dx,
                    ..TaskReference::rest(motion.x)
                }
            }
            TaskKind::Orientation => {
                let link = kinematics.link(self.point.link);
                TaskReference {
                    dx: link.angular_velocity,
                    ..TaskReference::facing(orientation::of_rotation(&link.rotation))
                }
            }
        }
    }
}

/// Desired motion of one level, base-plate frame. Axes that the task does not
/// control have no influence, but must be finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TaskReference<T: Real> {
    /// x_d \[m\] of a position task.
    pub x: Vector3<T>,
    /// Desired orientation of an orientation task, norm 0.5 to 2; the sign does
    /// not matter.
    pub orientation: Quaternion<T>,
    /// dx_d \[m/s\], or the desired angular velocity \[rad/s\].
    pub dx: Vector3<T>,
    /// ddx_d \[m/s2\], or the desired angular acceleration \[rad/s2\].
    pub ddx: Vector3<T>,
}

impl<T: Real> TaskReference<T> {
    /// Rest at a position \[m\].
    #[must_use]
    pub const fn rest(x: Vector3<T>) -> Self {
        Self {
            x,
            orientation: orientation::identity(),
            dx: zeros(),
            ddx: zeros(),
        }
    }

    /// Rest in an orientation.
    #[must_use]
    pub const fn facing(orientation: Quaternion<T>) -> Self {
        Self {
            x: zeros(),
            orientation,
            dx: zeros(),
            ddx: zeros(),
        }
    }
}

/// Where a task's point or frame is, how it moves, and how the joints move it.
struct Target<T: Real> {
    actual: TaskReference<T>,
    rows: JacobianRows<T>,
}

impl<T: Real> Target<T> {
    #[inline]
    fn position(task: &Task<T>, kinematics: &Kinematics<T>) -> Self {
        let motion = kinematics.point(&task.point);
        Self {
            actual: TaskReference {
                dx: motion.dx,
                ..TaskReference::rest(motion.x)
            },
            rows: kinematics.point_jacobian(task.point.link, &motion),
        }
    }

    #[inline]
    fn orientation(task: &Task<T>, kinematics: &Kinematics<T>) -> Self {
        let motion = kinematics.link(task.point.link);
        Self {
            actual: TaskReference {
                dx: motion.angular_velocity,
                ..TaskReference::facing(orientation::of_rotation(&motion.rotation))
            },
            rows: kinematics.angular_jacobian(task.point.link),
        }
    }
}

/// The stacked rows of all levels in priority order, first level first.
///
/// Rows beyond `count` are zero.
#[derive(Clone, Copy, Debug)]
pub struct TaskRows<T: Real> {
    /// Number of rows m.
    pub count: usize,
    /// First row of the level that row k belongs to.
    pub level_start: [usize; MAX_ROWS],
    /// Rows of J \[m\].
    pub jacobian: [JointVector<T>; MAX_ROWS],
    /// Rows of dJ/dt \[m/s\].
    pub jacobian_dot: [JointVector<T>; MAX_ROWS],
    /// (dJ/dt) dq \[m/s2\].
    pub bias: [T; MAX_ROWS],
    /// Task acceleration wanted, (12) without the bias:
    /// ddx_d + K_d (dx_d - dx) + K_p (x_d - x) \[m/s2\].
    pub wanted: [T; MAX_ROWS],
    /// x_d - x \[m\], or the orientation error \[rad\] of [`orientation::error`].
    pub error: [T; MAX_ROWS],
}

impl<T: Real> TaskRows<T> {
    /// Rows of all `tasks` with their `references`, level by level.
    ///
    /// A level without a reference is held where it is. Rows beyond
    /// [`MAX_ROWS`] are dropped: [`crate::config::ControllerConfig`] never has any.
    #[must_use]
    #[inline]
    pub fn new(
        tasks: &[Task<T>],
        references: &[TaskReference<T>],
        kinematics: &Kinematics<T>,
        state: &JointState<T>,
    ) -> Self {
        let mut rows = Self {
            count: 0,
            level_start: [0; MAX_ROWS],
            jacobian: [zeros(); MAX_ROWS],
            jacobian_dot: [zeros(); MAX_ROWS],
            bias: [T::ZERO; MAX_ROWS],
            wanted: [T::ZERO; MAX_ROWS],
            error: [T::ZERO; MAX_ROWS],
        };
        let mut references = references.iter();
        for task in tasks {
            let target = match task.kind {
                TaskKind::Position => Target::position(task, kinematics),
                TaskKind::Orientation => Target::orientation(task, kinematics),
            };
            let reference = references.next().unwrap_or(&target.actual);
            rows.push(task, reference, &target, state);
        }
        rows
    }

    #[inline]
    fn push(
        &mut self,
        task: &Task<T>,
        reference: &TaskReference<T>,
        target: &Target<T>,
        state: &JointState<T>,
    ) {
        let Target {
            actual,
            rows: point,
        } = target;
        let selected = |v: Vector3<T>| task.axes.select(&v);
        let error = selected(match task.kind {
            TaskKind::Position => reference.x - actual.x,
            TaskKind::Orientation => {
                orientation::error(&reference.orientation, &actual.orientation)
            }
        });
        let error_rate = selected(reference.dx - actual.dx);
        let wanted = reference.ddx + task.damping * error_rate + task.stiffness * error;
        let level_start = self.count;
        for axis in 0..3 {
            let row = self.count;
            if task.axes.xyz[axis] && row < MAX_ROWS {
                let mut bias = T::ZERO;
                for i in 0..DOF {
                    bias += point.jacobian_dot[axis][i] * state.dq[i];
                }
                self.level_start[row] = level_start;
                self.jacobian[row] = point.jacobian[axis];
                self.jacobian_dot[row] = point.jacobian_dot[axis];
                self.bias[row] = bias;
                self.wanted[row] = wanted[axis];
                self.error[row] = error[axis];
                self.count = row + 1;
            }
        }
    }

    /// b of (12): the wanted acceleration less (dJ/dt) dq \[m/s2\].
    #[must_use]
    #[inline]
    pub fn acceleration(&self) -> [T; MAX_ROWS] {
        let mut b = self.wanted;
        for (b, &bias) in b.iter_mut().zip(&self.bias) {
            *b -= bias;
        }
        b
    }
}

impl Axes {
    /// `v` with the uncontrolled axes set to zero.
    #[inline(always)]
    fn select<T: Real>(self, v: &Vector3<T>) -> Vector3<T> {
        let mut selected = *v;
        for (value, on) in selected.iter_mut().zip(self.xyz) {
            if !on {
                *value = T::ZERO;
            }
        }
        selected
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_have_names() {
        assert_eq!(Axes::from_name("xyz"), Some(Axes::XYZ));
        assert_eq!(Axes::from_name("xy"), Some(Axes::XY));
        assert_eq!(Axes::from_name("z").unwrap().xyz, [false, false, true]);
        for wrong in ["", "yx", "xx", "xw", "a", "xyzx", "XY"] {
            assert_eq!(Axes::from_name(wrong), None, "{wrong}");
        }
    }
}
