//! Every named result of one cycle, in the order of the cycle, and what is remembered
//! for the next one.

use super::brake::Brake;
use super::delay::Delay;
use super::measurement::Measurement;
use super::observer::Observer;
use super::tasks::ActiveTasks;
use crate::arm::dynamics::Dynamics;
use crate::arm::kinematics::Kinematics;
use crate::fault::{Fault, IndexSet, Status};
use crate::joint::{JointState, JointVector, zeros};
use crate::law::allocation::Allocation;
use crate::law::control::{Control, TorqueDemand};
use crate::law::hierarchy::Hierarchy;
use crate::law::limits::bounds::AccelerationBounds;
use crate::law::limits::motion::WhitenedMotion;
use crate::law::limits::projection::Projection;
use crate::law::limits::spectrum::Spectrum;
use crate::law::limits::way_out::WayOut;
use crate::law::limits::wish::Wish;
use crate::law::motion::MotionSplit;
use crate::law::null_space::PostureIntegral;
use crate::ranges::MAX_LEVELS;
use crate::real::Real;
use crate::task::rows::TaskRows;
use crate::task::{Followed, Reference};

/// What comes into a cycle from outside.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a, T: Real> {
    /// What the robot reports; believed.
    pub measurement: &'a Measurement<T>,
    /// What the arm should do; usable.
    pub reference: &'a Reference<T>,
}

/// The results of a cycle, one field per stage of
/// [`Controller::STAGES`](super::Controller::STAGES). A stage reads the fields of those before
/// it and writes its own. In the order of the stages but for the three largest, which stand last.
// In this order in memory: most of what a stage reads lies within reach of one base register.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Data<T: Real> {
    /// q, dq as measured.
    pub joints: JointState<T>,
    /// Equation of motion (6).
    pub dynamics: Dynamics<T>,
    /// Torque \[Nm\] that holds the arm if this cycle or a later one ends in a fault: g(q)
    /// within limits.
    pub holding_torque: JointVector<T>,
    /// The observer (30); after its stage `observer.residual` is r of this cycle.
    pub observer: Observer<T>,
    /// J, dJ/dt and what the tasks command, all levels stacked.
    pub rows: TaskRows<T>,
    /// R and Q of J L^-T, of the exact law.
    pub hierarchy: Hierarchy<T>,
    /// Directions and mobilities of J L^-T, of the law within limits.
    pub spectrum: Spectrum<T>,
    /// The motion along them.
    pub whitened_motion: WhitenedMotion<T>,
    /// Task and null-space parts of dq.
    pub motion: MotionSplit<T>,
    /// q_d \[rad\].
    pub posture: JointVector<T>,
    /// Task accelerations and null-space force, of the exact law.
    pub control: Control<T>,
    /// What bends a straight arm.
    pub way_out: WayOut<T>,
    /// What levels and null space ask the joints for, of the law within limits.
    pub wish: Wish<T>,
    /// What acceleration each joint may have.
    pub bounds: AccelerationBounds<T>,
    /// The wish within the bounds.
    pub projection: Projection<T>,
    /// Torque asked for \[Nm\].
    pub demand: TorqueDemand<T>,
    /// Torque allowed \[Nm\].
    pub allocation: Allocation<T>,
    /// The torques of the last cycles.
    pub(super) delay: Delay<T>,
    /// q_d of an integrated posture.
    pub(super) posture_integral: PostureIntegral<T>,
    /// Frames, axes and their rates.
    pub kinematics: Kinematics<T>,
    /// The tasks and gains in force.
    pub tasks: ActiveTasks<T>,
    /// What levels and posture follow: the reference without its jumps.
    pub followed: Followed<T>,
}

impl<T: Real> Data<T> {
    /// Nothing computed, nothing remembered.
    // In the place of the result: a copy on the stack is larger than what a cycle needs.
    #[must_use]
    #[inline(always)]
    pub const fn new() -> Self {
        Self {
            joints: JointState {
                q: zeros(),
                dq: zeros(),
            },
            kinematics: Kinematics::new(),
            dynamics: Dynamics::new(),
            holding_torque: zeros(),
            observer: Observer::new(),
            rows: TaskRows::new(),
            hierarchy: Hierarchy::new(),
            spectrum: Spectrum::new(),
            whitened_motion: WhitenedMotion::new(),
            motion: MotionSplit::new(),
            posture: zeros(),
            control: Control::new(),
            way_out: WayOut::new(),
            wish: Wish::new(),
            bounds: AccelerationBounds::new(),
            projection: Projection::new(),
            demand: TorqueDemand(zeros()),
            allocation: Allocation::new(),
            delay: Delay::new(),
            posture_integral: PostureIntegral::new(),
            tasks: ActiveTasks::new(),
            followed: Followed::new(),
        }
    }

    /// The next reference is followed as it is, whatever jump it is.
    pub fn follow_at_once(&mut self) {
        self.followed.follow_at_once();
    }

    /// r \[Nm\], tends to -tau_ext.
    #[must_use]
    #[inline(always)]
    pub fn residual(&self) -> &JointVector<T> {
        &self.observer.residual
    }

    /// Writes what the law within limits has met in the cycle.
    #[inline(always)]
    pub(super) fn tell_limits(&self, status: &mut Status) {
        let (spectrum, wish, projection) = (&self.spectrum, &self.wish, &self.projection);
        status.degraded = spectrum.degraded;
        status.released = spectrum.released;
        status.shaped = wish.shaped;
        status.scaled = wish.scaled;
        [status.at_least, status.at_greatest] = projection.at_bound;
        status.unresolved = projection.unresolved;
        status.stuck = self.way_out.stuck;
        status.pivots = projection.pivots;
    }

    /// Forgets what is remembered: observer, delay, integrated posture, what was followed. Tasks
    /// and gains that were changed are what was wanted.
    pub(super) fn forget(&mut self) {
        self.observer = Observer::new();
        self.delay = Delay::new();
        self.posture_integral = PostureIntegral::new();
        self.projection.forget();
        self.followed = Followed::new();
        self.tasks.arrive();
    }

    /// Forgets what is remembered of the levels of `slots`: they came or went.
    pub(super) fn forget_levels(&mut self, slots: IndexSet) {
        for slot in (0..MAX_LEVELS).filter(|&slot| slots.contains(slot)) {
            self.followed.forget(slot);
            self.projection.forget_level(slot);
        }
    }
}

impl<T: Real> Default for Data<T> {
    fn default() -> Self {
        Self::new()
    }
}

/// The part that changes from cycle to cycle, in the caller's storage.
/// Const-constructed, so that it can be a `static`.
#[derive(Clone, Debug)]
pub struct State<T: Real> {
    pub(super) data: Data<T>,
    pub(super) fault: Option<Fault>,
    pub(super) brake: Brake<T>,
    /// Whether a measurement was ever followed.
    pub(super) seen: bool,
    rate_limited_cycles: u32,
}

impl<T: Real> State<T> {
    /// Before the first cycle: nothing observed, no fault, zero torque held.
    #[must_use]
    #[inline(always)]
    pub const fn new() -> Self {
        Self {
            data: Data::new(),
            fault: None,
            brake: Brake::new(),
            seen: false,
            rate_limited_cycles: 0,
        }
    }

    /// Cycles in which the change of a torque was cut, since the state was made.
    #[must_use]
    pub fn rate_limited_cycles(&self) -> u32 {
        self.rate_limited_cycles
    }

    pub(super) fn count_limits(&mut self) {
        let limited = u32::from(self.data.allocation.rate_limited.any());
        self.rate_limited_cycles = self.rate_limited_cycles.saturating_add(limited);
    }

    /// Every result of the last cycle.
    #[must_use]
    pub fn data(&self) -> &Data<T> {
        &self.data
    }

    /// The latched fault, if any.
    #[must_use]
    pub fn fault(&self) -> Option<Fault> {
        self.fault
    }

    /// Tells the observer that `torque` \[Nm\] has acted on the joints since the
    /// last cycle instead of the one it assumes: the torque of that cycle, or
    /// with dead time of so many cycles before. For links that round, scale or
    /// lose torques; to be called before the next cycle, whose torque starts from it.
    pub fn set_applied_torque(&mut self, torque: &JointVector<T>) {
        self.data.observer.set_applied_torque(torque);
        self.data.allocation.start_from(torque);
    }

    /// The next cycle comes after a gap that is too long to be an interval: the
    /// observer keeps its residual and takes the momentum anew.
    pub fn resume_after_gap(&mut self) {
        self.data.observer.started = false;
        self.data.projection.forget();
    }

    /// The next reference is followed as it is: a jump is not joined
    /// ([`JUMP`](crate::ranges::JUMP)). For callers whose references start where the arm is,
    /// or who join them themselves.
    pub fn follow_at_once(&mut self) {
        self.data.follow_at_once();
    }

    /// What the levels followed is forgotten: the next targets are joined from how the arm
    /// moves. The posture goes on.
    pub fn join_from_the_arm(&mut self) {
        self.data.followed.forget_levels();
    }

    /// Clears a latched fault. Observer, integrated posture and what was followed start
    /// anew, changes of tasks and gains that were begun are at their end; the torque that holds the arm stays until the next cycle.
    pub fn reset(&mut self) {
        self.data.forget();
        self.fault = None;
    }
}

impl<T: Real> Default for State<T> {
    fn default() -> Self {
        Self::new()
    }
}
