//! Tasks: a point or the orientation of a link, the axes of it that a priority
//! level controls, and its gains; and the stacked rows J, dJ/dt that all levels make together.

use heapless::Vec;

use crate::joint::{DOF, JointState, JointVector, Matrix3, Vector3, zeros};
use crate::kinematics::{JacobianRows, Kinematics, LinkMotion, LinkPoint};
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

/// The stacked rows of all levels in priority order, first level first.
///
/// There are as many rows as `jacobian` has; behind them the arrays are zero.
#[derive(Clone, Debug)]
pub struct TaskRows<T: Real> {
    /// First row of the level that row k belongs to.
    pub level_start: [usize; MAX_ROWS],
    /// Rows of J \[m\].
    pub jacobian: Vec<JointVector<T>, MAX_ROWS>,
    /// Rows of dJ/dt \[m/s\].
    pub jacobian_dot: Vec<JointVector<T>, MAX_ROWS>,
    /// (dJ/dt) dq \[m/s2\].
    pub bias: [T; MAX_ROWS],
    /// Task acceleration wanted, (12) without the bias:
    /// ddx_d + K_d (dx_d - dx) + K_p (x_d - x) \[m/s2\].
    pub wanted: [T; MAX_ROWS],
    /// x_d - x \[m\], or the orientation error \[rad\] of [`orientation::error`].
    pub error: [T; MAX_ROWS],
}

impl<T: Real> TaskRows<T> {
    /// No rows yet.
    #[must_use]
    #[inline]
    pub const fn empty() -> Self {
        Self {
            level_start: [0; MAX_ROWS],
            jacobian: Vec::new(),
            jacobian_dot: Vec::new(),
            bias: [T::ZERO; MAX_ROWS],
            wanted: [T::ZERO; MAX_ROWS],
            error: [T::ZERO; MAX_ROWS],
        }
    }

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
        let mut rows = Self::empty();
        rows.stack(tasks, references, kinematics, state);
        rows
    }

    /// Adds the rows of all `tasks`, as [`TaskRows::new`] but without a copy of the whole.
    #[inline]
    pub fn stack(
        &mut self,
        tasks: &[Task<T>],
        references: &[TaskReference<T>],
        kinematics: &Kinematics<T>,
        state: &JointState<T>,
    ) {
        let mut references = references.iter();
        for task in tasks {
            match task.kind {
                TaskKind::Position => self.position(task, references.next(), kinematics, state),
                TaskKind::Orientation => {
                    self.orientation(task, references.next(), kinematics, state);
                }
            }
        }
    }

    #[inline(always)]
    fn position(
        &mut self,
        task: &Task<T>,
        reference: Option<&TaskReference<T>>,
        kinematics: &Kinematics<T>,
        state: &JointState<T>,
    ) {
        let motion = kinematics.point(&task.point);
        let level = Level::new(self.count(), task, reference, &motion.dx, |reference| {
            reference.x - motion.x
        });
        self.push(
            &level,
            state,
            &kinematics.point_jacobian(task.point.link, &motion),
        );
    }

    #[inline(always)]
    fn orientation(
        &mut self,
        task: &Task<T>,
        reference: Option<&TaskReference<T>>,
        kinematics: &Kinematics<T>,
        state: &JointState<T>,
    ) {
        let LinkMotion {
            rotation,
            angular_velocity,
        } = kinematics.link(task.point.link);
        let level = Level::new(
            self.count(),
            task,
            reference,
            &angular_velocity,
            |reference| {
                orientation::error(&reference.orientation, &orientation::of_rotation(&rotation))
            },
        );
        self.push(&level, state, &kinematics.angular_jacobian(task.point.link));
    }

    /// The rows of the axes that the level controls.
    #[inline(always)]
    fn push(&mut self, level: &Level<T>, state: &JointState<T>, all: &JacobianRows<T>) {
        for axis in 0..3 {
            let place = self.count();
            if level.axes.xyz[axis] && place < MAX_ROWS {
                let mut bias = T::ZERO;
                for i in 0..DOF {
                    bias += all.jacobian_dot[axis][i] * state.dq[i];
                }
                self.level_start[place] = level.start;
                // Never full: there is a place.
                let _ = self.jacobian.push(all.jacobian[axis]);
                let _ = self.jacobian_dot.push(all.jacobian_dot[axis]);
                self.bias[place] = bias;
                self.wanted[place] = level.wanted[axis];
                self.error[place] = level.error[axis];
            }
        }
    }

    /// Number of rows m.
    #[must_use]
    #[inline]
    pub fn count(&self) -> usize {
        self.jacobian.len()
    }

    /// Drops the rows from `count` on.
    pub fn truncate(&mut self, count: usize) {
        self.jacobian.truncate(count);
        self.jacobian_dot.truncate(count);
        for row in count..MAX_ROWS {
            self.level_start[row] = 0;
            self.bias[row] = T::ZERO;
            self.wanted[row] = T::ZERO;
            self.error[row] = T::ZERO;
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

/// What one task asks for, before it becomes rows.
struct Level<T: Real> {
    /// Index of its first row.
    start: usize,
    axes: Axes,
    /// As in [`TaskRows::error`].
    error: Vector3<T>,
    /// As in [`TaskRows::wanted`].
    wanted: Vector3<T>,
}

impl<T: Real> Level<T> {
    /// `error` is asked for the deviation from the reference; without one there is none.
    #[inline(always)]
    fn new(
        start: usize,
        task: &Task<T>,
        reference: Option<&TaskReference<T>>,
        velocity: &Vector3<T>,
        error: impl FnOnce(&TaskReference<T>) -> Vector3<T>,
    ) -> Self {
        let mut level = Self {
            start,
            axes: task.axes,
            error: zeros(),
            wanted: zeros(),
        };
        if let Some(reference) = reference {
            let rate = task.axes.select(&(reference.dx - velocity));
            level.error = task.axes.select(&error(reference));
            level.wanted = reference.ddx + task.damping * rate + task.stiffness * level.error;
        }
        level
    }
}

impl Axes {
    /// `v` with the uncontrolled axes set to zero.
    #[inline(always)]
    fn select<T: Real>(self, v: &Vector3<T>) -> Vector3<T> {
        let mut selected = *v;
        for axis in 0..3 {
            if !self.xyz[axis] {
                selected[axis] = T::ZERO;
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
