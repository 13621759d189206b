//! Velocity-level priorities (1)-(5): joint speeds and positions instead of torques, for
//! robots that take positions (resolved motion rate control, Whitney 1969).
//!
//! ```text
//! dx_i = dx_d + K (x_d - x)                                task velocity of level i
//! dq_i = dq_i-1 + (J_i P_i-1)^# (dx_i - J_i dq_i-1)        (3), P_i-1 of (5), dq_0 = 0
//! q_c(t + h) = q_c(t) + h dq
//! ```
//!
//! The inverses are Moore-Penrose ones, so the joints that the levels leave free rest. As
//! dq holds for a cycle, dx_d is taken at its middle, dx_d(t) + (h / 2) ddx_d(t): that
//! leaves an error of h^2 / 2 (dJ/dt) dq per cycle, of which the feedback K makes a
//! standing h / (2 K) (dJ/dt) dq. A reference with ddx_d = 0 gives plain Euler, with
//! h / (2 K) J ddq in its place.
//!
//! External torque has no part in it: the arm yields as the robot's own position
//! controller lets it.

use crate::arm::kinematics::Kinematics;
use crate::arm::{ArmModel, ArmParameters};
use crate::cycle::config::check_cycle;
use crate::cycle::measurement::{Measurement, within};
use crate::cycle::usable::admit;
use crate::cycle::{Input, check_exact_rows};
use crate::error::ConfigError;
use crate::fault::{Fault, IndexSet, Mode, Quantity, Status};
use crate::joint::{DOF, JointState, JointVector, zeros};
use crate::law::hierarchy::Hierarchy;
use crate::linalg::Cholesky;
use crate::ranges::{COMMAND_LEAD_MAX, EXACT_ROWS, GAIN_MAX, RESOLVER_GAIN_BOUND};
use crate::real::Real;
use crate::task::rows::TaskRows;
use crate::task::{Followed, Levels, Reference, TaskSet};

/// What a resolver is made of, besides the arm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResolverConfig {
    /// The tasks in priority order. Their gains belong to accelerations and have no part
    /// here.
    pub tasks: TaskSet,
    /// K \[1/s\] of every level, above 0; h K at most [`RESOLVER_GAIN_BOUND`].
    pub gain: f64,
    /// Cycle h \[s\].
    pub cycle_s: f64,
}

/// The immutable part: arm, tasks and gain, validated once and converted to the precision
/// of the cycle.
#[derive(Clone, Debug)]
pub struct Resolver<T: Real> {
    arm: ArmModel<T>,
    /// With gains that make the commanded acceleration 2 / h times the task velocity.
    levels: Levels<T>,
    cycle_s: T,
}

/// The part that changes from cycle to cycle, in the caller's storage.
#[derive(Clone, Debug)]
pub struct ResolverState<T: Real> {
    commanded: JointVector<T>,
    fault: Option<Fault>,
    followed: Followed<T>,
    kinematics: Kinematics<T>,
    rows: TaskRows<T>,
    hierarchy: Hierarchy<T>,
}

/// The result of one cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution<T: Real> {
    /// q_c \[rad\], to be reached at the end of the cycle: always finite, within the
    /// limits of the arm and no farther than [`COMMAND_LEAD_MAX`] from where it is.
    pub q: JointVector<T>,
    /// dq \[rad/s\] of the levels, within the speed limits of the arm; zero while a fault
    /// is latched. `q` may move less, where a limit of the position stops it.
    pub dq: JointVector<T>,
    /// What limited or degraded the cycle; `saturated` has the joints whose speed or
    /// position a limit changed. While a fault is latched `q` stays where it was.
    pub status: Status,
}

impl<T: Real> ResolverState<T> {
    /// Before the first cycle. `commanded` \[rad\] is the position that the robot has been
    /// commanded last, from which the motion goes on; usually the one measured.
    #[must_use]
    pub const fn new(commanded: JointVector<T>) -> Self {
        Self {
            commanded,
            fault: None,
            followed: Followed::new(),
            kinematics: Kinematics::new(),
            rows: TaskRows::new(),
            hierarchy: Hierarchy::new(),
        }
    }

    /// The latched fault, if any.
    #[must_use]
    pub fn fault(&self) -> Option<Fault> {
        self.fault
    }

    /// Clears a latched fault and forgets what was followed; the commanded position stays.
    pub fn reset(&mut self) {
        self.fault = None;
        self.followed = Followed::new();
    }

    /// The next reference is followed as it is: a jump is not joined.
    pub fn follow_at_once(&mut self) {
        self.followed.follow_at_once();
    }

    fn held(&mut self, fault: Fault) -> Resolution<T> {
        self.fault = Some(fault);
        Resolution {
            q: self.commanded,
            dq: zeros(),
            status: Status {
                mode: Mode::Resting,
                fault: Some(fault),
                ..Status::CLEAR
            },
        }
    }
}

impl<T: Real> Resolver<T> {
    /// Validates arm and configuration and converts them to the precision `T`.
    ///
    /// # Errors
    /// [`ConfigError`] names the first thing that cannot be.
    pub fn new(arm: &ArmParameters, config: &ResolverConfig) -> Result<Self, ConfigError> {
        let arm = ArmModel::new(arm)?;
        let &ResolverConfig {
            ref tasks,
            gain,
            cycle_s,
        } = config;
        check_cycle(cycle_s)?;
        check_exact_rows(tasks)?;
        let bound = RESOLVER_GAIN_BOUND / cycle_s;
        if !(gain > 0.0 && gain <= bound) {
            return Err(ConfigError::ResolverGain { value: gain, bound });
        }
        let damping = T::from_f64(2.0 / cycle_s);
        let mut levels = Levels::new(tasks, &arm, false);
        levels.set_gains(damping * T::from_f64(gain), damping);
        Ok(Self {
            levels,
            arm,
            cycle_s: T::from_f64(cycle_s),
        })
    }

    /// One cycle, from what the robot reports and the reference of now. Never fails and
    /// never panics: with a measurement or reference that cannot be true it latches a
    /// fault and commands the position of the cycle before.
    #[must_use]
    pub fn step(
        &self,
        state: &mut ResolverState<T>,
        measurement: &Measurement<T>,
        reference: &Reference<T>,
    ) -> Resolution<T> {
        let input = Input {
            measurement,
            reference,
        };
        let admitted = admit(state.fault, &self.arm, &self.levels, self.cycle_s, &input);
        let resolved = admitted.and_then(|()| self.resolve(state, &input));
        match resolved {
            Ok(dq) => self.answer(state, &measurement.q, &dq),
            Err(fault) => state.held(fault),
        }
    }

    /// dq of (3) \[rad/s\], before limits.
    fn resolve(
        &self,
        state: &mut ResolverState<T>,
        input: &Input<'_, T>,
    ) -> Result<JointVector<T>, Fault> {
        // Seen at rest, what a level commands is ddx_d + 2/h (dx_d + K (x_d - x)).
        let Measurement { q, interval_s, .. } = input.measurement;
        let at_rest = JointState { q: *q, dq: zeros() };
        let (rows, hierarchy) = (&mut state.rows, &mut state.hierarchy);
        state.kinematics.update(&self.arm, &at_rest);
        let (followed, kinematics) = (&mut state.followed, &state.kinematics);
        let none = IndexSet::NONE;
        followed.update(
            &self.levels,
            input.reference,
            none,
            kinematics,
            q,
            *interval_s,
        );
        rows.update(&self.levels, &state.followed, &state.kinematics, &at_rest);
        let half = T::from_f64(0.5) * self.cycle_s;
        let mut velocity = [T::ZERO; EXACT_ROWS];
        for (velocity, &acceleration) in velocity.iter_mut().zip(&rows.commanded) {
            *velocity = acceleration * half;
        }
        hierarchy.update(rows, &Cholesky::identity());
        let dq = hierarchy.rotate_back(&hierarchy.solve(&velocity));
        for (joint, speed) in (1..).zip(&dq) {
            let (min, max) = (T::from_f64(-GAIN_MAX), T::from_f64(GAIN_MAX));
            within(Quantity::SpeedCommand, joint, *speed, min, max)?;
        }
        Ok(dq)
    }

    /// dq is shortened as a whole to the speed limits, so that every level keeps its
    /// direction; each joint of q_c is kept within its range and near the arm.
    fn answer(
        &self,
        state: &mut ResolverState<T>,
        q: &JointVector<T>,
        dq: &JointVector<T>,
    ) -> Resolution<T> {
        let (speeds, [least, greatest]) = (self.arm.speed_limit(), self.arm.position_range());
        let lead = T::from_f64(COMMAND_LEAD_MAX);
        let mut saturated = IndexSet::NONE;
        let mut excess = T::ONE;
        for i in 0..DOF {
            let share = dq[i].magnitude() / speeds[i];
            saturated.insert_if(i, share > T::ONE);
            excess = excess.most(share);
        }
        let dq = dq * (T::ONE / excess);
        for i in 0..DOF {
            let wanted = state.commanded[i] + self.cycle_s * dq[i];
            let near = wanted.limited(q[i] - lead, q[i] + lead);
            let reached = near.limited(least[i], greatest[i]);
            saturated.insert_if(i, reached != wanted);
            state.commanded[i] = reached;
        }
        Resolution {
            q: state.commanded,
            dq,
            status: Status {
                saturated,
                rank: state.hierarchy.deficient(),
                joining: state.followed.joining(),
                ..Status::CLEAR
            }
            .without_fault(),
        }
    }
}
