//! The controller: what is known before the first cycle, validated once.

use super::data::{Data, Input};
use super::measurement::believe_posture;
use super::tasks::Own;
use crate::arm::ArmModel;
use crate::fault::Fault;
use crate::joint::JointVector;
use crate::law::limits::bounds::JointBounds;
use crate::law::null_space::Compliance;
use crate::law::sampling::DampingRate;
use crate::real::Real;
use crate::task::{Capacity, Levels};

/// A stage: reads results above its own, writes its own.
pub type Run<T> = fn(&Controller<T>, &Input<'_, T>, &mut Data<T>);

/// The law of a controller: [`Data::demand`] from what is observed and followed. By a pointer,
/// so that a program has those laws in it that its controllers are made with.
#[derive(Clone, Copy, Debug)]
pub(super) struct Law<T: Real> {
    /// Whether it is the one within limits.
    pub limits: bool,
    pub run: Run<T>,
}

/// The immutable part: arm, tasks, gains and limits, validated once and converted to
/// the precision of the cycle. One controller can drive any number of [`State`](super::State)s.
#[derive(Clone, Debug)]
pub struct Controller<T: Real> {
    pub(super) arm: ArmModel<T>,
    pub(super) law: Law<T>,
    /// Until a change is begun.
    pub(super) levels: Levels<T>,
    pub(super) capacity: Capacity,
    /// Of the law within limits.
    pub(super) bounds: JointBounds<T>,
    /// Until a change is begun.
    pub(super) compliance: Compliance<T>,
    pub(super) observer_gain: JointVector<T>,
    pub(super) cycle_s: T,
    pub(super) dead_cycles: u8,
    /// Largest change of the torque in a cycle that runs \[Nm\].
    pub(super) torque_step: JointVector<T>,
    /// The same in a cycle that brakes \[Nm\].
    pub(super) brake_step: JointVector<T>,
    /// c of the brake \[1/s\].
    pub(super) brake_rate: T,
    pub(super) fastest_mode: DampingRate,
}

impl<T: Real> Controller<T> {
    /// What a state has until a change is begun.
    #[inline(always)]
    pub(super) fn own(&self) -> Own<'_, T> {
        Own {
            levels: &self.levels,
            compliance: &self.compliance,
            releases: self.law.limits,
        }
    }

    /// The arm.
    #[must_use]
    pub fn arm(&self) -> &ArmModel<T> {
        &self.arm
    }

    /// Whether its law is the one within limits.
    #[must_use]
    pub fn has_limits(&self) -> bool {
        self.law.limits
    }

    /// Number of slots: so many targets a [`Reference`](crate::Reference) needs. Without room for
    /// more the number of levels.
    #[must_use]
    pub fn level_count(&self) -> usize {
        self.levels.slots()
    }

    /// Whether a cycle would believe that the arm is at `q` \[rad\]: within the range of every
    /// joint and [`POSITION_MARGIN`](crate::ranges::POSITION_MARGIN).
    ///
    /// # Errors
    /// The fault that it would end in.
    pub fn believe_posture(&self, q: &JointVector<T>) -> Result<(), Fault> {
        believe_posture(&self.arm, q)
    }

    /// Compliance of what the tasks leave.
    #[must_use]
    pub fn compliance(&self) -> &Compliance<T> {
        &self.compliance
    }

    /// The fastest null-space mode that the damping makes anywhere.
    #[must_use]
    pub fn fastest_mode(&self) -> DampingRate {
        self.fastest_mode
    }
}
